"""One hand goes to the other: onto its palm, or to a place that is said from it."""

from typing import Any

from specs.english.context import Context, Hands
from specs.english.doing import limb, quoted, shown, step_of
from specs.english.places import OPPOSITE, VECTORS, facing, metres
from specs.english.problems import Problem
from specs.english.roles import Roles
from specs.english.sentences import Phrase
from specs.english.steps import Step, opposite, plain
from specs.english.vocabulary import vocabulary

NOT_THE_HAND = ("arm", "forearm")  # parts of an arm on which there is no landmark
PLACES = "hand, wrist, elbow, upper arm, shoulder"
OWN_SIDE = ("near", "from", "to")  # beside it, with a distance


def is_hand(where: Phrase) -> bool:
    """Whether a place is an arm, a hand or "it"."""
    noun = where.noun
    return noun is not None and (noun.what in ("arm", "palm") or noun.pronoun is not None)


def to_other_hand(roles: Roles, where: Phrase, hands: Hands, side: str, context: Context) -> Step:
    """A palm onto the other one: follow; or to a place above, below, beside … that one.

    Such a place is known if the other palm faces it or away from it (follow, out from the palm),
    or if the other hand was brought to a place of the body (go-to-point, near the same).

    Raises:
        Problem: it is the same hand, no place, or not known where.
    """
    noun = where.noun
    assert noun is not None
    goal = context.hands(noun)
    other = opposite(side)
    if goal.sides != (other,):
        raise Problem.of(f"the {side} hand cannot go to itself", where.words)
    if noun.noun is not None and noun.noun.entry.key in NOT_THE_HAND:
        raise Problem.of(
            f"{quoted(noun.words)} is no place that a hand can go to (on an arm there are:"
            f" {PLACES})",
            noun.words,
        )
    if noun.part not in (None, "top"):
        raise Problem.of(f"{quoted(noun.words)}: of a hand only the palm is a place", noun.words)
    way, away, assumed = _beside(where, side, context)
    if noun.part is not None:
        assumed = [*assumed, f"{quoted(where.words)} is onto the palm of the {other} hand"]
    primitive, to = _place(where, way, away, other, context)
    step = limb(hands, step_of(roles, primitive, side, to=to), side)
    step.because(where.words, "to", shown(to) if way else f"{other} hand")
    if noun.noun is not None and noun.noun.entry.key == "wrist":
        step.assume(f"{quoted(noun.words)} is the palm of the {other} hand")
    for said in assumed:
        step.assume(said)
    if roles.palm:
        step.parameters["palm"] = facing(roles.palm[-1], side, context)
        step.because(roles.palm[-1].words, "palm", str(step.parameters["palm"]))
    return step


def _beside(where: Phrase, side: str, context: Context) -> tuple[str, float, list[str]]:
    """Which way from the other hand and how far, and what was assumed; "" is onto it."""
    relation = where.preposition.entry.key if where.preposition else "to"
    meaning = where.preposition.entry.meaning if where.preposition else {}
    distance, assumed, defaults = metres(where), [], vocabulary().defaults
    if relation == "to" and distance is None:
        return "", 0.0, []
    own: dict[str, str] = {"over": "up", "behind": "back", **dict.fromkeys(OWN_SIDE, side)}
    way = context.side(str(meaning["way"])) if "way" in meaning else own.get(relation, "")
    if not way:
        raise Problem.of(
            f"{where.text!r} is no place (from the other hand there are: above, below, in front of,"
            " behind, to the left of, to the right of, near)",
            where.words,
        )
    if relation in OWN_SIDE:
        assumed.append(f"to the {side} of it")
    if distance is None:
        distance = float(defaults["away"])
        assumed.append(f"{100 * distance:g} cm")
    return way, distance, assumed


def _place(
    where: Phrase, way: str, away: float, other: str, context: Context
) -> tuple[str, dict[str, Any]]:
    """How a task says that place: the primitive, and its `to`."""
    palm = str((context.arms[other] or {}).get("palm"))
    at = context.at[other]
    if not way:
        return "follow", {"hand": f"{other}_arm"}
    if palm in (way, OPPOSITE[way]):
        return "follow", {"hand": f"{other}_arm", "away": plain(away if palm == way else -away)}
    if at is None:
        raise Problem.of(
            f"{where.text!r}: where that hand is, is not known here: first bring it to a place,"
            f" such as 'Hold your {other} hand in front of your belly'",
            where.words,
        )
    near = {"near": at} if isinstance(at, str) else at
    offset = near.get("offset", [0, 0, 0])
    out = [plain(o + away * c) for o, c in zip(offset, VECTORS[way], strict=True)]
    return "go-to-point", {**near, "offset": out}

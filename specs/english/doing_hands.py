"""Verbs that bring hands somewhere: to a place, to each other, to and fro. See `doing_arms`."""

from collections.abc import Mapping
from typing import Any

from specs.english.context import Context, Hands
from specs.english.doing import (
    Sense,
    Stages,
    hands_of,
    limb,
    moved,
    quoted,
    shown,
    step_of,
    times_of,
)
from specs.english.other_hand import is_hand, to_other_hand
from specs.english.places import facing, place
from specs.english.problems import Problem
from specs.english.roles import Roles
from specs.english.sentences import Noun, Phrase
from specs.english.steps import SIDES, Step, opposite, plain
from specs.english.vocabulary import vocabulary

TAP_AWAY = 0.08  # [m] off the surface between two taps
CLAP: Mapping[str, Any] = {"near": "chest.front", "away": 0.25}  # where hands meet
OVERHEAD: Mapping[str, Any] = {"near": "head.top", "away": 0.15}  # and where, if they are up
APART, TOGETHER = 0.12, 0.012  # of each palm from the middle [m]


def _goers(roles: Roles, context: Context, where: Noun) -> Hands:
    """The hands that go somewhere; if none is named, those that suit the place."""
    if (
        roles.places
        and roles.object is not None
        and roles.object.what in ("arm", "palm", "elbow", "")
    ):
        return hands_of(roles, context)
    if roles.hand is not None:
        return context.hands(roles.hand)
    if where.what in ("arm", "palm") and not where.plural:
        return context.hands(None, default=opposite(context.hands(where).sides[0]), place=True)
    meaning = where.noun.entry.meaning if where.noun else {}
    if where.plural and "side" in meaning:
        return context.hands(None, both=True)
    if where.side and "side" in meaning and "head" not in str(meaning.get("place")):
        side = context.side(where.side)
        return context.hands(
            None, default=side if meaning["side"] == "own" else opposite(side), place=True
        )
    return context.hands(None, place=True)


def _target(roles: Roles) -> Phrase:
    """The one place of a clause: after a preposition, or what is touched."""
    if len(roles.places) > 1:
        raise Problem.of(
            f"two places: {roles.places[0].text!r} and {roles.places[1].text!r}; name one",
            roles.places[1].words,
        )
    if roles.places:
        return roles.places[0]
    assert roles.object is not None
    return Phrase("place", roles.object.words, noun=roles.object)


def reach(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Bring a palm to a place: go-to-point; to another hand: follow."""
    where = _target(roles)
    assert where.noun is not None
    hands = _goers(roles, context, where.noun)
    steps = []
    for side in hands.sides:
        if is_hand(where):
            steps.append(to_other_hand(roles, where, hands, side, context))
            continue
        across = bool(sense.get("across"))
        to, assumed = place(where, side, context, both=hands.both, across=across)
        step = limb(hands, step_of(roles, "go-to-point", side, to=to), side)
        step.because(where.words, "to", shown(to))
        for said in assumed:
            step.assume(said)
        if roles.palm:
            step.parameters["palm"] = facing(roles.palm[-1], side, context)
            step.because(roles.palm[-1].words, "palm", str(step.parameters["palm"]))
        steps.append(step)
    _two_places(steps, where)
    moved(context, hands, steps)
    return [steps]


def _two_places(steps: list[Step], where: Phrase) -> None:
    """Two hands do not fit on one place; near one, they are side by side."""
    if len(steps) == 2 and isinstance(steps[0].parameters["to"], dict):
        for step in steps:
            out = APART if step.parameters["limb"] == "left_arm" else -APART
            to = step.parameters["to"]
            if steps[0].parameters["to"]["near"] == steps[1].parameters["to"]["near"]:
                x, y, z = to.get("offset", [0, 0, 0])
                step.parameters["to"] = {**to, "offset": [x, plain(y + out), z]}
                step.assume(f"side by side, {200 * APART:g} cm apart")
    elif len(steps) == 2 and steps[0].parameters["to"] == steps[1].parameters["to"]:
        raise Problem.of(
            f"both hands do not fit on one place ({shown(steps[0].parameters['to'])}): say one"
            " hand, or a place for each",
            where.words,
        )


def tap(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Touch a place so many times, the hand a little off it between."""
    stages = reach(roles, sense, context)
    for step in stages[0]:
        where = _target(roles)
        if is_hand(where):
            side = str(step.parameters["limb"]).removesuffix("_arm")
            raise Problem.of(
                f"{roles.verb!r} is done on places of head and trunk, on shoulders and elbows, not"
                f" on a hand: say 'Clap', or 'Touch your {opposite(side)} hand with your {side}"
                " hand'",
                where.words,
            )
        if not isinstance(step.parameters["to"], str):
            raise Problem.of(
                f"{where.text!r}: {roles.verb!r} touches a place: say 'on'", where.words
            )
        off = {"near": step.parameters["to"], "away": TAP_AWAY, "at": 0.5}
        step.parameters["via"] = [off]
        times = times_of(roles, 1)
        if times > 1:
            step.own["repeat"] = times
    return stages


def gather(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Bring hands in: to the front of the chest, side by side."""
    hands = hands_of(roles, context)
    away = float(vocabulary().defaults["away"])
    (way,) = roles.ways
    steps = []
    for side in hands.sides:
        out = 0.0 if not hands.both else APART if side == "left" else -APART
        to: dict[str, Any] = {"near": CLAP["near"], "away": away}
        to |= {"offset": [0, out, 0]} if out else {}
        step = limb(hands, step_of(roles, "go-to-point", side, to=to), side)
        step.because(way.words, "to", shown(to))
        step.assume(f"{100 * away:g} cm in front of the chest")
        if out:
            step.assume(f"side by side, {200 * APART:g} cm apart")
        if roles.palm:
            step.parameters["palm"] = facing(roles.palm[-1], side, context)
            step.because(roles.palm[-1].words, "palm", str(step.parameters["palm"]))
        steps.append(step)
    moved(context, hands, steps)
    return [steps]


def reach_to(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Bring a palm to the place that the verb means."""
    hands = hands_of(roles, context)
    steps = []
    for side in hands.sides:
        to = str(sense["to"]).format(hand=side, other=opposite(side))
        step = limb(hands, step_of(roles, "go-to-point", side, to=to), side)
        steps.append(step.assume(f"to {to}"))
    moved(context, hands, steps)
    return [steps]


def cross(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Both palms to the other side, the right one first: they cannot pass through each other."""
    where = roles.places[0] if roles.places else None
    to = str(sense["to"])
    if where is not None and where.noun is not None:
        meaning = where.noun.noun.entry.meaning if where.noun.noun else {}
        said = str(meaning.get("across") or meaning.get("place")).replace("{side}", "{other}")
        if "{other}" not in said:
            raise Problem.of(f"arms cannot be crossed {where.text!r}", where.words)
        to = said if meaning.get("side") else to
    steps = reach_to(roles, {"to": to}, context)[0]
    for step in steps:
        step.assume("the right one first")
        if where is not None and where.preposition and where.preposition.entry.key == "front":
            step.because(where.words, "no effect", "arms are crossed on the body")
        elif where is not None:
            step.because(where.words, "to", str(step.parameters["to"]))
    return [[step] for step in steps]


def press(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Both palms together, in front of the chest or of what is said."""
    hands = hands_of(roles, context)
    way = next(way for way in roles.ways if way.key == "together")
    for other in roles.ways:
        if other is not way:
            raise Problem.of(f"{quoted(other.words)} and together?", other.words)
    near, assumed = _middle(roles, context)
    steps = [_meeting(roles, hands, side, near) for side in hands.sides]
    for step in steps:
        step.because(way.words, "to", "palm to palm")
        for phrase in roles.places:
            step.because(phrase.words, "to", shown(near))
        step.assume(assumed)
    moved(context, hands, steps)
    return [steps]


def _middle(roles: Roles, context: Context) -> tuple[Mapping[str, Any], str]:
    """Where palms meet, and what was assumed of it: where it is said, or in front of the chest."""
    if not roles.places:
        return CLAP, f"{100 * CLAP['away']:g} cm in front of the chest"
    to, assumed = place(_target(roles), "right", context, both=True)
    if isinstance(to, str) or "offset" in to:
        raise Problem.of(
            f"{roles.places[0].text!r}: hands come together in front of a place or above it",
            roles.places[0].words,
        )
    return to, "; ".join(assumed)


def _between(context: Context) -> Mapping[str, Any] | None:
    """The place between two hands that are side by side near one, or up; None if they are not."""
    right, left = (context.at[side] for side in SIDES)
    if isinstance(right, dict) and isinstance(left, dict):
        (x, _, z), near = right.get("offset", (0, 0, 0)), _without_offset(right)
        return near if (x, z) == (0, 0) and near == _without_offset(left) else None
    up = all((context.arms[side] or {}).get("arm") == "up" for side in SIDES)
    return OVERHEAD if up else None


def _without_offset(at: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in at.items() if key != "offset"}


def _meeting(roles: Roles, hands: Hands, side: str, near: Mapping[str, Any]) -> Step:
    """One palm beside the middle, facing the other."""
    out = TOGETHER if side == "left" else -TOGETHER
    to = {**near, "offset": [0, out, 0]}
    return limb(hands, step_of(roles, "go-to-point", side, to=to, palm=opposite(side)), side)


def clap(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Palms apart and together so many times: where it is said, or where the hands are."""
    named = roles.object is not None or roles.hand is not None
    hands = hands_of(roles, context) if named else Hands(SIDES)
    if not hands.both:
        raise Problem.of(f"{roles.verb!r} needs both hands", hands.words)
    between = None if roles.places else _between(context)
    near, assumed = (between, "where the hands are") if between else _middle(roles, context)
    steps = []
    for side in SIDES:
        step = _meeting(roles, hands, side, near)
        for phrase in roles.places:
            step.because(phrase.words, "to", shown(near))
        for way in roles.ways:
            if way.key == "together":
                step.because(way.words, "to", "palm to palm")
        out = APART if side == "left" else -APART
        step.parameters["via"] = [{**near, "offset": [0, out, 0], "at": 0.5}]
        times = times_of(roles, 1)
        if times > 1:
            step.own["repeat"] = times
        steps.append(step.assume(assumed))
    moved(context, hands, steps)
    return [steps]

"""Places and directions, as a task writes them."""

from collections.abc import Sequence
from typing import Any

from specs.english.context import Context
from specs.english.problems import Problem
from specs.english.roles import Way
from specs.english.sentences import Noun, Phrase, Word
from specs.english.steps import SIDES, opposite, plain
from specs.english.vocabulary import vocabulary

VECTORS = {
    "forward": (1, 0, 0),
    "back": (-1, 0, 0),
    "left": (0, 1, 0),
    "right": (0, -1, 0),
    "up": (0, 0, 1),
    "down": (0, 0, -1),
}
FACES = {"up": "top", "forward": "front", "back": "back", "left": "side", "right": "side"}
OPPOSITE = {
    "up": "down",
    "down": "up",
    "forward": "back",
    "back": "forward",
    "left": "right",
    "right": "left",
}
ACROSS = {"right": [0.65, 0.76, 0.0], "left": [0.65, -0.76, 0.0]}  # as far as a straight arm goes
MOST_AWAY = 2.0  # [m]


def landmark(noun: Noun, hand: str, context: Context, *, both: bool = False) -> tuple[str, str]:
    """The landmark that a noun phrase means to a hand, and what was assumed.

    Raises:
        Problem: it is no place, or could be two.
    """
    if noun.noun is None:
        raise Problem.of(f"{_text(noun)!r} is no place of the body", noun.words)
    meaning = noun.noun.entry.meaning
    if noun.part is not None:
        parts = meaning.get("parts", {})
        if noun.part not in parts:
            known = ", ".join(f"{part} of" for part in parts) or "none"
            said = f"there is no known {noun.part} of the {noun.noun.text} (there are: {known})"
            raise Problem.of(said, noun.words)
        template = parts[noun.part]
    else:
        template = meaning.get("pair") if both else None
        template = template or meaning.get("place")
        if noun.side and "side" in meaning.get("parts", {}):
            template = meaning["parts"]["side"]
    if template is None:
        raise Problem.of(
            f"{_text(noun)!r} is no place that a hand can go to"
            f" (there are: {', '.join(_places())})",
            noun.words,
        )
    side, assumed = "", ""
    if "{side}" in template:
        side, assumed = _side(noun, hand, context, both)
        if "elbow" in template and side == hand:
            raise Problem.of(f"the {hand} hand cannot reach its own elbow", noun.words)
        if noun.part is None and side != hand and "opposite" in meaning:
            template = meaning["opposite"]
            assumed = assumed or f"the {hand} hand touches the front of it"
    name = template.format(side=side, hand=hand, other=opposite(hand))
    if noun.part is None and name.split(".")[0].removeprefix(f"{side}_") != noun.noun.entry.key:
        told = f"{_text(noun)!r} is {name}"
        assumed = told if not assumed or noun.side else f"{told}, for the {hand} hand"
    return name, assumed


def _places() -> list[str]:
    return [key for key, noun in vocabulary().data["nouns"].items() if "place" in noun]


def _side(noun: Noun, hand: str, context: Context, both: bool) -> tuple[str, str]:
    """Which of two, and what was assumed."""
    assert noun.noun is not None
    word, meaning = noun.noun.text, noun.noun.entry.meaning
    if noun.other:
        return opposite(hand), ""
    if noun.side:
        return context.side(noun.side), ""
    rule = meaning.get("side", "ask")
    if rule == "ask" and both:
        rule = meaning.get("pair_side", rule)
    if rule == "ask":
        raise Problem.of(
            f"{_text(noun)!r} could be the right or the left one: say 'right {word}' or"
            f" 'left {word}'",
            noun.words,
        )
    side = hand if rule == "own" else opposite(hand)
    return side, f"{_text(noun)!r} is the {side} one, for the {hand} hand"


def place(
    phrase: Phrase, hand: str, context: Context, *, both: bool = False, across: bool = False
) -> tuple[str | dict[str, Any], list[str]]:
    """Where a place phrase sends a hand: a landmark, or a place near one; and what was assumed.

    Args:
        phrase: the place.
        hand: the side of the hand that goes there.
        context: what was said before.
        both: whether the other hand goes there too.
        across: whether "over" means to the other side.

    Raises:
        Problem: it cannot be a place.
    """
    noun = phrase.noun
    assert noun is not None
    relation = phrase.preposition.entry.key if phrase.preposition else "to"
    meaning = noun.noun.entry.meaning if noun.noun else {}
    distance = metres(phrase)
    if relation == "over" and across:
        relation = "across"
    if relation == "over":
        relation = "to" if meaning.get("over") == "touch" and distance is None else "above"
    if relation == "across":
        if "across" in meaning:
            return str(meaning["across"]).format(other=opposite(hand)), []
        relation = "to"
    if relation == "behind" and distance is None and "back" in meaning.get("parts", {}):
        template = str(meaning["parts"]["back"])
        return template.format(hand=hand), [f"{phrase.text!r}: the back of it is touched"]
    if relation == "to" and distance is None:
        name, assumed = landmark(noun, hand, context, both=both)
        return name, [assumed] if assumed else []
    if relation in ("with", "of", "for"):
        raise Problem.of(f"{phrase.text!r} is no place", phrase.words)
    return _near(phrase, noun, relation, distance, hand, context, both)


def _near(
    phrase: Phrase,
    noun: Noun,
    relation: str,
    distance: float | None,
    hand: str,
    context: Context,
    both: bool,
) -> tuple[dict[str, Any], list[str]]:
    """A place that is not touched: out from a surface, or beside a landmark."""
    defaults, assumed = vocabulary().defaults, []
    way = phrase.preposition.entry.meaning.get("way") if phrase.preposition else None
    way = "back" if relation == "behind" else context.side(way) if way else None
    if distance is None:
        distance = float(defaults["away" if way or relation == "toward" else "beside"])
        assumed.append(f"{100 * distance:g} cm")
    parts = noun.noun.entry.meaning.get("parts", {}) if noun.noun else {}
    face = FACES.get(way or "")
    if face == "side" and "{side}" in str(parts.get("side", "")):
        template = str(parts["side"])
        return {"near": template.format(side=way), "away": plain(distance)}, assumed
    if face in parts and noun.part is None and "{" not in str(parts[face]).replace("{side}", ""):
        whole = Noun(
            noun.words, noun.noun, side=noun.side, both=noun.both, other=noun.other, part=face
        )
        name, more = landmark(whole, hand, context, both=both)
        return {"near": name, "away": plain(distance)}, [*assumed, *filter(None, [more])]
    name, more = landmark(noun, hand, context, both=both)
    assumed += filter(None, [more])
    if way is None or FACES.get(way) == name.partition(".")[2]:
        return {"near": name, "away": plain(distance)}, assumed
    return {"near": name, "offset": [plain(distance * c) for c in VECTORS[way]]}, assumed


def metres(phrase: Phrase) -> float | None:
    """The distance that is said of a place [m]; None if none is."""
    if not phrase.numbers or phrase.unit is None:
        return None
    if "metres" not in phrase.unit.entry.meaning:
        raise Problem.of(f"{phrase.text!r}: expected a length, such as '10 cm'", phrase.words)
    away = phrase.numbers[0] * float(phrase.unit.entry.meaning["metres"])
    if away > MOST_AWAY:
        raise Problem.of(f"{away:g} m is farther than an arm is long", phrase.words)
    return away


def convert(phrase: Phrase) -> str | None:
    """The direction that a place stands for: "above your head" is up, to raise an arm."""
    noun = phrase.noun.noun if phrase.noun else None
    if noun is None or phrase.numbers or phrase.noun is None or phrase.noun.part:
        return None
    relation = phrase.preposition.entry.key if phrase.preposition else "to"
    ways: dict[str, str] = noun.entry.meaning.get("as", {})
    return ways.get(relation)


def direction(ways: Sequence[Way], hand: str, context: Context) -> tuple[str | list[float], str]:
    """A direction as a word, or a vector for several; and what was assumed.

    Raises:
        Problem: a word that is no direction of an arm, or words that cancel each other.
    """
    keys: list[str] = []
    for way in ways:
        key = context.side(way.key)
        if key == "side":
            key = hand
        elif key == "across" and len(ways) == 1:
            return ACROSS[hand], "as far across as a straight arm goes"
        elif key == "in" and len(ways) == 1:
            raise Problem.of(
                f"{' '.join(map(str, way.words))!r} is no direction for a straight arm: say 'across"
                " your body', or a place, such as 'in front of your chest'",
                way.words,
            )
        elif key in ("in", "across"):
            key = opposite(hand)
        if key in ("out", "level") and len(ways) > 1:
            continue
        if key not in (*VECTORS, "out", "level"):
            said = " ".join(map(str, way.words))
            raise Problem.of(f"{said!r} is no direction for an arm", way.words)
        if key not in keys:
            keys.append(key)
    if not keys:
        keys = ["out"]
    if keys in (["out"], ["level"]):
        return "forward", "forward, since no other direction is said"
    if len(keys) == 1:
        return keys[0], ""
    vector = [float(sum(VECTORS[key][k] for key in keys if key in VECTORS)) for k in range(3)]
    if not any(vector):
        raise Problem.of(
            f"{' and '.join(keys)} cancel each other: name one direction",
            [word for way in ways for word in way.words],
        )
    return vector, ""


def facing(way: Way, hand: str, context: Context) -> str:
    """Which way a palm faces.

    Raises:
        Problem: it is no such direction.
    """
    key = context.side(way.key)
    key = {"in": opposite(hand), "out": hand, "side": hand}.get(key, key)
    said = " ".join(map(str, way.words))
    if key == "together":
        raise Problem.of(
            f"{said!r}: where they are to touch is not said: say 'palms facing each other', or"
            " 'Bring your palms together in front of your chest'",
            way.words,
        )
    if key not in VECTORS:
        raise Problem.of(
            f"a palm cannot face {said!r} (but {', '.join(VECTORS)}, in or out)", way.words
        )
    return key


def _text(noun: Noun) -> str:
    return " ".join(word.text for word in noun.words)


__all__ = ["SIDES", "Word", "convert", "direction", "facing", "landmark", "place"]

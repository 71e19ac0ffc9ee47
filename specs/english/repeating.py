"""Repeating: sentences that were danced are danced again, as they stand or with the other hand."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from specs.english.context import Context, Named
from specs.english.problems import Problem
from specs.english.roles import Roles
from specs.english.sentences import Parsed, Phrase
from specs.english.steps import Step

STANDING = ("get-posture", "go-to-point")  # where their goal is reached, nothing moves
MOST_TIMES = 10_000
MOST_STEPS = 2_000  # that repeating may add to a lesson


@dataclass
class Played:
    """A sentence that was danced; one that repeats others knows which."""

    number: int | None
    line: int
    parsed: Parsed
    text: str = ""
    named: Named = field(default_factory=Named)  # before it
    steps: list[Step] = field(default_factory=list)
    plays: "list[tuple[Played, bool]]" = field(default_factory=list)


def repeated(roles: Roles, played: Sequence[Played], context: Context) -> list[tuple[Played, bool]]:
    """What is danced again, and whether with left and right exchanged.

    Raises:
        Problem: it is not said what, or there is no such sentence.
    """
    words = roles.clause.words
    if not played:
        raise Problem.of("there is nothing before it to repeat", words)
    chosen = _chosen(roles, played)
    for more in roles.unused({"object", "places", "steps", "count", "hand", "together"}):
        raise Problem.of(f"{' '.join(map(str, more))!r} has no meaning with {roles.verb!r}", more)
    times = roles.count.number if roles.count is not None else 1.0
    if times != int(times) or not 1 <= times <= MOST_TIMES:
        raise Problem.of(f"expected a whole number of times, not {times:g}", words)
    mirrored = _mirrored(roles, chosen, context)
    flat: list[tuple[Played, bool]] = []
    for one in chosen:
        flat += [(p, m != mirrored) for p, m in one.plays] if one.plays else [(one, mirrored)]
    if sum(len(one.steps) for one, _ in flat) * int(times) > MOST_STEPS:
        raise Problem.of(f"repeating makes more than {MOST_STEPS} steps", words)
    return flat * int(times)


def told(again: Sequence[tuple[Played, bool]], roles: Roles, before: int) -> str:
    """What is repeated and how often, in words; of one sentence, how to have more of them."""
    lines = list(dict.fromkeys(one.line for one, _ in again))
    texts = list(dict.fromkeys(one.text for one, _ in again))
    times = int(roles.count.number) if roles.count is not None else 1
    where = f"line {lines[0]}" if len(lines) == 1 else f"lines {lines[0]} to {lines[-1]}"
    said = f"{where}, {texts[0]!r}" if len(texts) == 1 else where
    rounds = "once more" if times == 1 else f"{times} times more"
    several = f"{len(again)} sentences more, " if len(again) > times else ""
    more = len(texts) == 1 and before > 1
    rest = (
        "; for more sentences say 'Repeat the last 2 sentences' or 'Repeat everything'"
        if more
        else ""
    )
    return f"repeats {said}, {rounds}: {several}{times + 1} passes with the first{rest}"


def without_side(again: Played, roles: Roles) -> Problem | None:
    """What is wrong where left and right are exchanged and nothing comes out otherwise."""
    before = [(step.primitive, step.parameters) for one, _ in again.plays for step in one.steps]
    if before != [(step.primitive, step.parameters) for step in again.steps]:
        return None
    words = tuple(word for p in roles.places if _other_side(p) for word in p.words)
    words = words or (roles.hand.words if roles.hand is not None else roles.clause.words)
    said = " ".join(map(str, words))
    return Problem.of(f"{said!r}: left and right are the same in what is repeated", words)


def stands_still(again: Played, before: Played) -> bool:
    """Whether repeating only brings the same arms to where the sentence before brought them."""
    if any(one is not before or mirrored for one, mirrored in again.plays):
        return False
    goals = [(step.primitive, step.parameters) for step in before.steps]
    parts = [part for step in before.steps for part in step.moves]
    same = [(step.primitive, step.parameters) for step in again.steps] == goals * len(again.plays)
    stands = all(kind in STANDING and "via" not in given for kind, given in goals)
    return same and stands and len(parts) == len(set(parts))


def _chosen(roles: Roles, played: Sequence[Played]) -> Sequence[Played]:
    """The sentences that are meant."""
    whole = [p for p in roles.places if p.noun is not None and p.noun.what == "start"]
    everything = roles.object is not None and roles.object.what == "all"
    rest = [p for p in roles.places if p not in whole and not _other_side(p)]
    if rest:
        raise Problem.of(f"{rest[0].text!r} cannot be repeated", rest[0].words)
    if roles.steps:
        return _numbered(roles.steps, played)
    if whole or everything:
        return played
    if roles.object is not None and roles.object.pronoun is not None:
        return played[-1:]
    if roles.object is not None:
        raise Problem.of(
            f"{' '.join(map(str, roles.object.words))!r} cannot be repeated", roles.object.words
        )
    if roles.clause.verb is not None and roles.clause.verb.text.lower() not in (
        "repeat",
        "repeating",
    ):
        return played[-1:]
    if roles.hand is not None or any(map(_other_side, roles.places)):
        return played[-1:]
    last = played[-1].line
    raise Problem.of(
        f"{roles.verb!r} what? It could be 'Repeat that' (line {last}), 'Repeat lines"
        f" {played[max(0, len(played) - 4)].line} to {last}', or 'Repeat everything'"
        f" (lines {played[0].line} to {last})",
        roles.clause.words,
    )


def _other_side(phrase: Phrase) -> bool:
    noun = phrase.noun
    return (
        noun is not None and noun.other and noun.noun is not None and noun.noun.entry.key == "side"
    )


def _numbered(phrases: Sequence[Phrase], played: Sequence[Played]) -> Sequence[Played]:
    """Lines or steps by number: one, from one on, or from one to another; or the last few."""
    words = tuple(word for phrase in phrases for word in phrase.words)
    if phrases[0].kind == "last":
        number = phrases[0].numbers[0] if phrases[0].numbers else 1.0
        if number != int(number) or not 1 <= number <= len(played):
            raise Problem.of(f"there are {len(played)} sentences before it, not {number:g}", words)
        return played[-int(number) :]
    numbers = [number for phrase in phrases for number in phrase.numbers]
    unit = next((w for w in words if w.kind == "STEP"), None)
    by_line = unit is not None and unit.entry.key == "line"
    relations = [p.preposition.entry.key if p.preposition else "" for p in phrases]
    last: float | None = numbers[1] if len(numbers) > 1 else None
    if last is None and "from" not in relations:
        last = numbers[0]
    known = [one.line if by_line else one.number for one in played]
    for asked in (numbers[0], last):
        if asked is not None and asked not in known:
            what = "line" if by_line else "step"
            shown = sorted({k for k in known if k is not None})
            raise Problem.of(
                f"there is no {what} {asked:g} to repeat here (there are: {_few(shown)})", words
            )
    found = [
        one
        for one, number in zip(played, known, strict=True)
        if number is not None and number >= numbers[0] and (last is None or number <= last)
    ]
    if not found or len(numbers) > 2:
        raise Problem.of("expected one number, or a range such as 'lines 3 to 5'", words)
    return found


def _few(numbers: list[int]) -> str:
    shown = [str(number) for number in numbers]
    return ", ".join(shown if len(shown) <= 8 else [*shown[:3], "…", shown[-1]])


def _mirrored(roles: Roles, chosen: Sequence[Played], context: Context) -> bool:
    """Whether "with the other hand" or a named one means to exchange left and right."""
    if any(map(_other_side, roles.places)):
        return True
    noun = roles.hand
    if noun is None:
        return False
    moved = {part for one in chosen for step in one.steps for part in step.moves}
    arms = {part.removesuffix("_arm") for part in moved if part.endswith("_arm")}
    if len(arms) != 1:
        moved_ = "both arms move" if arms else "no arm moves"
        raise Problem.of(
            f"{moved_} there: say 'on the other side' to exchange left and right", noun.words
        )
    if noun.other:
        return True
    return {context.side(noun.side or "")} != arms

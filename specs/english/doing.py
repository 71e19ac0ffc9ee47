"""What verbs have in common: which arm a step moves, and how its reasons are told."""

from collections.abc import Iterable, Mapping
from typing import Any

from specs.english.context import Context, Hands
from specs.english.problems import Problem
from specs.english.roles import Roles
from specs.english.sentences import Noun, Word
from specs.english.steps import Step

Sense = Mapping[str, Any]
Stages = list[list[Step]]
MOST_TIMES = 1000


def limb(hands: Hands, step: Step, side: str) -> Step:
    """Say which arm a step moves, and why."""
    step.parameters["limb"] = f"{side}_arm"
    if hands.words:
        step.because(hands.words, "limb", f"{side}_arm")
    if hands.assumed:
        step.assume(hands.assumed)
    return step


def step_of(roles: Roles, primitive: str, side: str, **parameters: Any) -> Step:
    """A step of an arm, done because of the verb."""
    step = Step(
        roles.clause, primitive, {"limb": f"{side}_arm", **parameters}, frozenset({f"{side}_arm"})
    )
    if roles.clause.verb is not None:
        step.because([roles.clause.verb], "primitive", primitive)
    return step


def hands_of(roles: Roles, context: Context) -> Hands:
    """The arms that a clause moves: its object, or what it is done with."""
    noun = (
        roles.object
        if roles.object is not None and roles.object.what in ("arm", "palm", "elbow", "")
        else None
    )
    if noun is not None and roles.hand is not None:
        raise Problem.of(
            f"{quoted_noun(noun)} or {quoted_noun(roles.hand)}: which of them moves?",
            roles.hand.words,
        )
    return context.hands(noun or roles.hand)


def size_of(roles: Roles) -> float:
    """How much wider or less wide it is than usual."""
    size = 1.0
    for word in roles.manners:
        size *= float(word.entry.meaning.get("size", 1.0))
    return size


def moved(context: Context, hands: Hands, steps: Iterable[Step]) -> None:
    """Note that hands went to places: how their arms are held is not known any more."""
    for step in steps:
        at = step.parameters.get("to") if step.primitive == "go-to-point" else None
        context.put(str(step.parameters["limb"]).removesuffix("_arm"), at=at)
    context.last = hands.sides


def quoted_noun(noun: Noun) -> str:
    """A noun phrase in quotes."""
    return quoted(noun.words)


def quoted(words: tuple[Word, ...]) -> str:
    """Words in quotes."""
    return repr(" ".join(word.text for word in words))


def shown(value: object) -> str:
    """A value as a task file has it."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {item}" for key, item in value.items()) + "}"
    return str(value)


def times_of(roles: Roles, default: int) -> int:
    """How often something is done.

    Raises:
        Problem: not a whole number of times.
    """
    if roles.count is None:
        return default
    number = roles.count.number
    if number != int(number) or not 1 <= number <= MOST_TIMES:
        raise Problem.of(
            f"expected a whole number of times up to {MOST_TIMES}, not {number:g}",
            roles.count.words,
        )
    return int(number)

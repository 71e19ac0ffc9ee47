"""How long steps take, how often they are done, and what they wait for."""

from typing import Any

from specs.english.context import Context
from specs.english.doing import MOST_TIMES
from specs.english.doing_body import ease
from specs.english.places import landmark
from specs.english.problems import Problem
from specs.english.roles import Amount, Roles
from specs.english.sentences import Condition, said
from specs.english.steps import Step, plain
from specs.english.vocabulary import vocabulary

LONGEST = 10_000.0  # beats or seconds
ROUNDS = 100  # of what is repeated until something happens


def set_times(roles: Roles, stages: list[list[Step]], does: str, context: Context) -> None:
    """Write into the steps how long they take; what comes first takes its one beat.

    Raises:
        Problem: a time or number that cannot be meant.
    """
    if roles.most is not None and roles.until is None:
        raise Problem.of("'at most' goes with 'until'", roles.most.words)
    several = {"cross": 2, "turns": len(stages)}  # stages that are what is said
    for step in (step for stage in stages[-several.get(does, 1) :] for step in stage):
        if step.primitive == "oscillate":
            _of_rhythm(roles, step)
        else:
            _of_movement(roles, step, does)
        if roles.until is not None:
            _until(roles, step, context)
    _in_turn(roles, stages)


def _of_rhythm(roles: Roles, step: Step) -> None:
    """A time given beside a number of swings says how fast they are."""
    cycles = step.own.pop("_cycles", None)
    if roles.time is None:
        return
    key, length = _length(roles.time)
    step.because(roles.time.words, key, f"{length:g} {key}")
    step.own[key] = plain(length)
    if cycles is not None and key == "beats":
        step.parameters["beats_per_cycle"] = plain(length / cycles)
    elif cycles is not None:
        step.parameters.pop("beats_per_cycle")
        step.parameters["frequency"] = plain(cycles / length)
    if key == "beats":
        ease(step)


def _of_movement(roles: Roles, step: Step, does: str) -> None:
    if does in ("tap", "clap"):
        _on_the_beat(roles, step)
    rounds = step.own.get("repeat", 1)
    if roles.count is not None:
        if does in ("tap", "clap"):
            step.because(roles.count.words, "repeat", _often(rounds))
        elif roles.count.number != 1:
            raise Problem.of(
                f"{roles.verb!r} ends in a posture, and {roles.count.number:g} times of it would"
                " stand still: say there and back in one sentence, such as 'Bend your right elbow,"
                " then straighten it', and after it 'Repeat that twice'",
                roles.count.words,
            )
        else:
            step.because(roles.count.words, "repeat", "once")
    factor = 1.0
    for word in roles.manners:
        if "time" in word.entry.meaning:
            factor *= float(word.entry.meaning["time"])
            takes = f"takes {factor:g} times as long" if roles.time is None else "as the time says"
            step.because([word], "beats", takes)
    if roles.rate is not None:
        if does not in ("tap", "clap") and roles.rate.number != 1.0:
            raise Problem.of(f"{roles.verb!r} is no rhythm", roles.rate.words)
        factor *= roles.rate.number
        step.because(roles.rate.words, "beats", f"{roles.rate.number:g} beats each")
    if roles.time is not None:
        key, length = _length(roles.time)
        step.own[key] = plain(length / rounds)
        step.because(roles.time.words, key, f"{length:g} {key}")
        step.lasting = False
    elif factor != 1.0:
        step.own["beats"] = plain(factor)
    elif roles.until is None and roles.rate is None:
        step.assume("one beat")
    if does in ("tap", "clap") and rounds == 1 and roles.count is None and roles.until is None:
        step.assume("once" + _for_more(roles))


def _on_the_beat(roles: Roles, step: Step) -> None:
    """Taps or claps at a rate are as many as there is time for."""
    if roles.rate is None or roles.until is not None:
        return
    if roles.time is None:
        if roles.count is None:
            raise Problem.of(
                f"{said(roles.rate.words)!r}: how often? say 'four times' or 'for four beats'",
                roles.rate.words,
            )
        return
    key, length = _length(roles.time)
    times = length / roles.rate.number
    if key != "beats" or times != int(times) or times > MOST_TIMES:
        raise Problem.of(
            f"{said(roles.time.words)!r} and {said(roles.rate.words)!r}: say so many beats that a"
            " whole number of times fits in",
            roles.time.words,
        )
    if roles.count is not None and roles.count.number != times:
        raise Problem.of(
            f"{said(roles.count.words)!r} or {said(roles.time.words)!r}: which of them?",
            roles.count.words,
        )
    if times > 1:
        step.own["repeat"] = int(times)
    step.because(roles.time.words, "repeat", _often(times))


def _often(times: float) -> str:
    return "once" if times == 1 else f"{times:g} times"


def _for_more(roles: Roles) -> str:
    """Where a time is said and no number, how to have more than one in it."""
    if roles.time is None or roles.rate is not None:
        return ""
    key, length = _length(roles.time)
    how = "on every beat" if key == "beats" and length == int(length) else "four times"
    if length <= 1:
        return ""
    time = said(roles.time.words)
    return f", which takes all of that time: for more say '{roles.verb} {how} {time}'"


def _length(time: Amount) -> tuple[str, float]:
    """The key and the length of a time."""
    meaning = time.unit.entry.meaning if time.unit else {}
    key = "seconds" if "seconds" in meaning else "beats"
    length = time.number * float(meaning.get(key, 1.0))
    if not 0.0 < length <= LONGEST:
        raise Problem.of(
            f"expected a time between 0 and {LONGEST:g} {key}, not {length:g}", time.words
        )
    return key, length


def _until(roles: Roles, step: Step, context: Context) -> None:
    """Over when something happens; gives up after a while."""
    condition = roles.until
    assert condition is not None
    wanted = condition_of(condition, context)
    step.because(condition.words, "done", f"until {wanted}")
    if "repeat" in step.own or step.parameters.get("via"):
        step.own["repeat"] = {"until": wanted, "times": ROUNDS}
        step.assume(f"at most {ROUNDS} times")
        return
    timeout = float(vocabulary().defaults["timeout"])
    if roles.most is not None:
        key, timeout = _length(roles.most)
        if key == "beats":
            raise Problem.of("a time to wait at most is given in seconds", roles.most.words)
        step.because(roles.most.words, "timeout", f"{timeout:g} s")
    else:
        step.assume(f"gives up after {timeout:g} s")
    step.own |= {"done": wanted, "timeout": plain(timeout)}
    if step.primitive == "oscillate":
        step.own.pop("beats", None)
        step.own.setdefault("seconds", plain(timeout))
        step.parameters.pop("ease", None)
    step.lasting = False


def condition_of(condition: Condition, context: Context) -> dict[str, Any]:
    """A condition as a task writes it.

    Raises:
        Problem: it is about something else than a hand near a place.
    """
    if condition.signal is not None:
        return {"event": condition.signal.entry.key}
    if (
        condition.hand is None
        or condition.hand.what not in ("arm", "palm", "")
        or condition.place is None
    ):
        raise Problem.of(
            'expected a signal in quotes, such as "go", or a hand that is near a place',
            condition.words,
        )
    hands = context.hands(condition.hand)
    if hands.both:
        raise Problem.of("one hand at a time can be waited for", condition.words)
    name, _ = landmark(condition.place, hands.sides[0], context)
    distance = float(vocabulary().defaults["distance"])
    if condition.distance is not None:
        number, unit = condition.distance
        metres = unit.entry.meaning.get("metres")
        if metres is None or not 0 < number * metres <= 2:
            raise Problem.of("expected a length up to 2 m, such as '5 cm'", condition.words)
        distance = number * float(metres)
    return {"near": name, "limb": f"{hands.sides[0]}_arm", "distance": plain(distance)}


def _in_turn(roles: Roles, stages: list[list[Step]]) -> None:
    if not roles.in_turn or any(step.primitive == "oscillate" for step in stages[-1]):
        return
    if len(stages[-1]) < 2:
        raise Problem.of(f"{' '.join(map(str, roles.in_turn))!r} goes with two arms", roles.in_turn)
    last = stages.pop()
    stages += [[step] for step in last]
    for step in last:
        step.because(roles.in_turn, "after", "one after the other")

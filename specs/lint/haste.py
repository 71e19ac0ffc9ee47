"""too-fast: movements that the body cannot do in the time that they are given."""

from collections.abc import Sequence

import numpy as np

from primitives.primitive import FloatArray
from sim import Haste, Lag
from specs.binding import BoundTask
from specs.lint.course import Move
from specs.lint.finding import Finding, Places, Severity

SPARE = 1.15  # of the shortest time that the model gives: it is a model
FASTER = 1.05  # than a joint's limit may be foreseen: the limits are no walls
LONGEST = 64.0  # times the given one are tried
HALVINGS = 7


def too_fast(task: BoundTask, places: Places, moves: Sequence[Move]) -> list[Finding]:
    """Movements that miss their goal for lack of time, or that pass the joints' speeds."""
    found = []
    known: dict[int, tuple[Lag, float, float] | None] = {}
    for move in moves:
        if move.haste is None:
            continue
        key = id(move.haste)
        if key not in known:
            known[key] = _short_of_time(move, move.haste)
        short = known[key]
        if short is None:
            continue
        lag, miss, shortest = short
        said = _why(task, move, lag, miss)
        misses = miss > 1.0 and not lag.lost
        grave = misses or task.spec.safety == "filter"
        severity: Severity = "error" if grave else "warning"
        beats = shortest * task.spec.tempo / 60.0
        found.append(
            places.finding(
                severity, "too-fast", move.name,
                f"{move.duration:.2f} s are too short: {said}",
                f"give it {shortest:.2f} s ({beats:.2g} beats) or more",
                shortest=shortest, miss=miss, speed=float(lag.speed.max()),
                torque=float(lag.torque.max()),
            )
        )  # fmt: skip
    return found


def attempt(move: Move, haste: Haste, duration: float) -> tuple[Lag, float]:
    """What becomes of a movement in a time [s], and how far it misses, 1 being allowed."""
    fade = min(move.hand_over, duration)
    lag = haste.in_time(move.travel * duration, duration, move.hold, fade)
    return lag, move.miss(lag.off)


def shortest_time(move: Move, haste: Haste, fails: float) -> float:
    """The shortest time that works [s], above one that does not; infinite if none does."""
    works = 2.0 * fails
    while not _works(*attempt(move, haste, works)):
        fails, works = works, 2.0 * works
        if works > LONGEST * move.duration:
            return np.inf
    for _ in range(HALVINGS):
        middle = np.sqrt(fails * works)
        if _works(*attempt(move, haste, middle)):
            works = middle
        else:
            fails = middle
    return float(np.ceil(100.0 * SPARE * works) / 100.0)


def _short_of_time(move: Move, haste: Haste) -> tuple[Lag, float, float] | None:
    lag, miss = attempt(move, haste, move.duration)
    if _works(lag, miss):
        return None
    shortest = shortest_time(move, haste, move.duration)
    return None if np.isinf(shortest) else (lag, miss, shortest)


def _works(lag: Lag, miss: float) -> bool:
    return not lag.lost and miss <= 1.0 and float(lag.speed.max()) <= FASTER


def _why(task: BoundTask, move: Move, lag: Lag, miss: float) -> str:
    body = task.body

    def joint(shares: FloatArray) -> str:
        return body.dof_name(int(move.dofs[int(np.argmax(shares))]))

    if lag.torque.max() > 1.0:
        said = (
            f"the way takes {lag.torque.max():.1f} times the torque that the motor of"
            f" {joint(lag.torque)} has"
        )
    elif lag.speed.max() > 1.0:
        worst = int(move.dofs[int(np.argmax(lag.speed))])
        limit = np.rad2deg(body.speed_limit[worst])
        said = (
            f"{joint(lag.speed)} would move at {lag.speed.max() * limit:.0f} degrees per second,"
            f" and {limit:.0f} is the most"
        )
    else:
        said = "its springs lag behind"
    if lag.lost:
        said += "; whether it gets to its goal all the same, only a run can tell"
    elif miss > 1.0:
        said += f"; it will miss its goal by {miss:.1f} times what is allowed"
    return said

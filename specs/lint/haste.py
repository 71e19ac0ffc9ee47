"""too-fast, stuck: movements that do not come to their goal in the time that they are given.

Those that would with more time are told the shortest; those that would not in any are stuck.
"""

from collections.abc import Sequence

import numpy as np

from primitives import GetPosture
from primitives.primitive import FloatArray
from sim import moved
from specs.binding import BoundTask
from specs.lint.finding import Finding, Places, Severity, cm
from specs.lint.move import Move
from specs.lint.together import Together
from specs.lint.touching import touches

SPARE = 1.05  # of the shortest time that is foreseen
AMPLE = 4.0  # for anything that Adonis can do at all, or twice the given one [s]
HALVINGS = 6


def too_fast(
    task: BoundTask, places: Places, moves: Sequence[Move], together: Together
) -> list[Finding]:
    """Movements that miss their goal for lack of time, or that pass the joints' speeds."""
    found = []
    known: dict[object, float] = {}
    for move in moves:
        if not move.timed or move.works(move.foreseen, move.duration):
            continue
        key = together.key(move)
        if key not in known:
            known[key] = shortest_time(move, together)
        shortest = known[key]
        miss = move.missed(move.foreseen, move.duration)
        if np.isinf(shortest):
            longest = _longest(move)
            if miss > 1.0 and move.missed(move.in_time(longest), longest) > 1.0:
                found.append(_stuck(places, move))
            continue
        grave = miss > 1.0 or task.spec.safety == "filter"
        severity: Severity = "error" if grave else "warning"
        beats = shortest * task.spec.tempo / 60.0
        found.append(
            places.finding(
                severity, "too-fast", move.name,
                f"{move.duration:.2f} s are too short: {_why(task, move, miss)}",
                f"give it {shortest:.2f} s ({beats:.2g} beats) or more",
                shortest=shortest, miss=miss, speed=float(move.foreseen.speed.max()),
                torque=float(move.foreseen.torque.max()),
            )
        )  # fmt: skip
    return found


def shortest_time(move: Move, together: Together) -> float:
    """The shortest time that works [s], above one that does not; infinite if none does.

    If some time works in which nothing is run into, it is one of those.
    """
    time, bumps = move.duration, np.inf
    while time < _longest(move):
        fails, time = time, min(2.0 * time, _longest(move))
        foreseen = move.in_time(time)
        if move.works(foreseen, time):
            if not touches(move, foreseen, together):
                return _narrowed(move, fails, time, together)
            bumps = min(bumps, time)
    return bumps if np.isinf(bumps) else _narrowed(move, 0.5 * bumps, bumps)


def _longest(move: Move) -> float:
    """The longest time that is tried [s]."""
    return max(AMPLE * move.body.map.time_scale, 2.0 * move.duration)


def _narrowed(move: Move, fails: float, good: float, together: Together | None = None) -> float:
    """The shortest time between one that fails and one that is good [s], with some to spare.

    If the movements beside it are given, nothing may be run into.
    """
    for _ in range(HALVINGS):
        middle = float(np.sqrt(fails * good))
        foreseen = move.in_time(middle)
        fit = move.works(foreseen, middle)
        fit = fit and (together is None or not touches(move, foreseen, together))
        fails, good = (fails, middle) if fit else (middle, good)
    return float(np.ceil(100.0 * SPARE * good) / 100.0)


def _stuck(places: Places, move: Move) -> Finding:
    body, time = move.body, _longest(move)
    seen = move.in_time(time)
    why = [f"{_said(body.dof_name(int(dof)))} is at the end of its range" for dof in seen.at_end]
    for pair in seen.leans:
        one, other = sorted(pair, key=lambda link: -int(body.ancestors[body.link(link)].sum()))
        why.append(f"the {_said(one)} leans on the {_said(other)}")
    if not move.foresight.carried:
        why.append("nothing carries the weight of the limb")
    short = move.short(seen)
    off = f"{cm(short)} short of its goal"
    if isinstance(move.does, GetPosture):
        miss = move.missed(seen, time)
        off = f"{miss:.1f} times as far from its posture as is allowed"
    return places.finding(
        "warning", "stuck", move.name,
        f"however long it takes, it comes to rest {off}: {', '.join(why) or 'its springs give'}",
        "lead it round by via points, or by a direction of 'upper_arm'",
        short=short,
    )  # fmt: skip


def _said(name: str) -> str:
    return name.replace("_", " ")


def _why(task: BoundTask, move: Move, miss: float) -> str:
    body, seen = task.body, move.foreseen

    def worst(shares: FloatArray) -> tuple[str, int]:
        dof = int(moved(body, move.dofs)[int(np.argmax(shares))])
        return body.dof_name(dof), dof

    if miss > 1.0 and seen.torque.max() > 1.0:
        joint, dof = worst(seen.torque)
        said = f"the motor of {joint} gives all that it has, {body.torque_limit[dof]:.3g} N m"
    elif seen.speed.max() > 1.0:
        joint, dof = worst(seen.speed)
        limit = np.rad2deg(body.speed_limit[dof])
        said = (
            f"{joint} would move at {seen.speed.max() * limit:.0f} degrees per second,"
            f" and {limit:.0f} is the most"
        )
    else:
        said = "its springs lag behind"
    if miss > 1.0:
        said += f"; it will miss its goal by {miss:.1f} times what is allowed"
    return said

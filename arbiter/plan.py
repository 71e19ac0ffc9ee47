"""The task graph as arrays that compiled code can walk.

A sub-task's number is its place in the graph's order. Walking touches only sub-tasks that
are on and their successors, so the size of the graph does not matter to a step.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records
from specs import BoundTask, Condition
from specs.graph import OTHERWISE, WHILE
from specs.groups import together
from specs.ordering import members, order_of
from specs.repeating import chains

ALL, ANY, FIRST = range(3)  # how many of its predecessors a sub-task waits for
NODE = np.dtype(
    [
        ("duration", np.float64),  # [s]
        ("fade", np.float64),  # [s] of the hand-over to this sub-task
        ("tolerance", np.float64),  # what counts as reached; 0 when it does not matter
        ("timeout", np.float64),  # [s]
        *(("given", np.int32), ("done", np.int32), ("until", np.int32)),  # conditions, or -1
        ("times", np.int32),  # it is done
        ("join", np.int8),  # ALL, ANY or FIRST
        ("claims", np.bool_),  # whether it claims any joint
        ("beside", np.bool_),  # whether it is on as long as another is
        ("otherwise", np.int32),  # what begins when it gives up, or -1
        ("successors", np.int32),  # first of them in the array of others
        ("count", np.int32),
        ("company", np.int32),  # those that are on as long as it is, likewise
        ("companions", np.int32),
        ("ended", np.int32),  # those that it ends when it begins, likewise
        ("ends", np.int32),
        ("waits", np.int32),  # for so many predecessors
        ("again", np.int32),  # what a new round of it begins with
        ("chain", np.int32),  # those that are done over with it, likewise
        ("links", np.int32),
        ("mate", np.int32),  # those of its groups that may be on at once with it, likewise
        ("mates", np.int32),
    ],
    align=True,
)
CONDITION = np.dtype(
    [
        ("event", np.int32),  # which event, or -1 if a palm is to be near a landmark
        *(("hand", np.int32), ("link", np.int32)),
        *(("palm", np.float64, 3), ("landmark", np.float64, 3)),  # in the frames of those links
        ("distance", np.float64),  # [m]
    ],
    align=True,
)

# How far a sub-task has come in one simulation. From DONE on it will not run again.
PENDING, RUNNING, DONE, TIMED_OUT, ENDED, SKIPPED = range(6)
OUTCOMES = ("pending", "running", "done", "timed out", "ended", "skipped")
GO_ON, OTHER_WAY, NO_WAY = range(3)  # where the walk goes from one that is over
LOG = np.dtype(
    [
        # Times are of the task, which stands still in a pause; the lags are what it stood still.
        ("start", np.float64),  # [s] of its latest round
        ("began", np.float64),  # [s] its first round, pauses included
        ("end", np.float64),  # [s] when it was over; its goal is held on
        ("start_lag", np.float64),  # [s]
        ("end_lag", np.float64),  # [s]
        ("waits", np.int32),  # for so many predecessors
        ("rounds", np.int32),  # it was done
        ("next", np.int32),  # in the queue
        ("on", np.int32),  # in how many slots it makes torque
        ("outcome", np.int8),
        ("way", np.int8),
        ("queued", np.bool_),
        ("called", np.bool_),  # whether a way leads to it
        ("fresh", np.bool_),  # begun in this step
    ],
    align=True,
)
SLOT = np.dtype(
    [
        ("start", np.float64),  # [s]
        ("end", np.float64),  # [s] when it was over, or released
        ("share", np.float64),  # of what is left of its joints
        ("node", np.int32),
        ("over", np.bool_),
        ("covered", np.bool_),
        ("released", np.bool_),  # whether it fades away instead of holding its goal
    ],
    align=True,
)
ROUND = np.dtype(  # one that a sub-task has done, and was to do over
    [
        *(("start", np.float64), ("end", np.float64)),  # [s] of the simulation
        *(("node", np.int32), ("outcome", np.int8)),
    ],
    align=True,
)
MOST_ROUNDS = 256  # that are kept of a simulation; of more the latest
# Per simulation: the clock of the task, and the queue of those that begin or have ended.
COURSE = np.dtype(
    [
        ("lag", np.float64),  # [s] for which the task stood still
        ("pace", np.float64),  # of the task's time: 1, or 0 in a pause
        ("wanted", np.float64),  # pace
        ("last", np.float64),  # [s] time of the last step
        ("head", np.int32),
        ("tail", np.int32),
        ("rounds", np.int32),  # that were kept
        ("stop", np.bool_),
    ],
    align=True,
)


@dataclass(frozen=True)
class Plan:
    """The graph's nodes, who comes after whom, and those that begin at once."""

    nodes: Records  # NODE (N,)
    others: NDArray[np.int32]
    roots: NDArray[np.int32]
    waits: NDArray[np.int32]  # (N,) number of predecessors
    conditions: Records  # CONDITION
    slots: int  # how many sub-tasks can make torque at once
    rounds: int  # how many earlier rounds are kept


def make_plan(task: BoundTask) -> Plan:
    """The plan of a bound task."""
    graph, spec = task.graph, task.spec
    number = {name: k for k, name in enumerate(graph.order)}
    place = {condition: c for c, condition in enumerate(task.conditions)}
    nodes = np.zeros(len(number), dtype=NODE)
    others: list[int] = []
    waits = np.zeros(len(number), dtype=np.int32)

    def at(condition: Condition | None) -> int:
        return -1 if condition is None else place[condition]

    def kept(found: list[int]) -> tuple[int, int]:
        others.extend(found)
        return len(others) - len(found), len(found)

    ended: dict[int, list[int]] = {}
    if any(s.policy == "first" for s in spec.subtasks):
        ended = {k: members(known.ended) for k, known in enumerate(order_of(graph)) if known.ended}
    repeated, mates = chains(graph.graph, spec.subtasks), _mates(task)
    for name, k in number.items():
        subtask, field = graph.subtasks[name], task.fields[k]
        ways: dict[str, list[int]] = {}
        for other in sorted(number[s] for s in graph.graph.successors(name)):
            kind = graph.graph.edges[name, graph.order[other]]["kind"]
            ways.setdefault(kind, []).append(other)
        given = subtask.conditions
        nodes[k] = (
            graph.lasts(name),
            graph.fade(name),
            subtask.tolerance or 0.0,
            subtask.timeout or 0.0,
            *(at(given.get(key)) for key in ("if", "done", "repeat")),
            subtask.times,
            ("all", "any", "first").index(subtask.policy),
            len(field.claims) > 0,
            subtask.while_ is not None,
            ways.get(OTHERWISE, [-1])[0],
            *kept(ways.get("after", [])),
            *kept(ways.get(WHILE, [])),
            *kept(ended.get(k, [])),
            graph.graph.in_degree(name),
            k if subtask.first is None else number[subtask.first],
            *kept(sorted(number[other] for other in repeated.get(name, ()))),
            *kept(sorted(mates.get(k, ()))),
        )
        waits[k] = graph.graph.in_degree(name)
    return Plan(
        nodes=nodes,
        others=np.array(others, dtype=np.int32),
        roots=np.flatnonzero(waits == 0).astype(np.int32),
        waits=waits,
        conditions=_conditions(task),
        slots=_slots(task) + len(mates),
        rounds=_rounds(task),
    )


def _conditions(task: BoundTask) -> Records:
    rows = np.zeros(len(task.conditions), dtype=CONDITION)
    for row, condition in zip(rows, task.conditions.values(), strict=True):
        row["event"], row["distance"] = condition.event, condition.distance
        if condition.palm is not None and condition.landmark is not None:
            row["hand"], row["palm"] = condition.palm.link, condition.palm.point
            row["link"], row["landmark"] = condition.landmark.link, condition.landmark.point
    return rows


def _mates(task: BoundTask) -> dict[int, set[int]]:
    """Of each sub-task in a group, those beside it there that do not come before or after it."""
    found: dict[int, set[int]] = {}
    if not task.spec.groups:
        return found
    order = task.graph.order
    for b, known in enumerate(order_of(task.graph)):
        for a in range(b if order[b] in task.grouped else 0):
            free = not known.over >> a & 1 and order[a] in task.grouped
            if free and together(order[a], order[b], task.spec.groups):
                found.setdefault(a, set()).add(b)
                found.setdefault(b, set()).add(a)
    return found


def _rounds(task: BoundTask) -> int:
    """How many rounds there are at most beside the last of each sub-task."""
    found, repeated = 0, chains(task.graph.graph, task.spec.subtasks)
    for name, subtask in task.graph.subtasks.items():
        around = [task.graph.subtasks[last].times for last, own in repeated.items() if name in own]
        own = subtask.times if subtask.first is None else 1
        found += min(int(np.prod([own, *around], dtype=float)) - 1, MOST_ROUNDS)
    return min(found, MOST_ROUNDS)


def _slots(task: BoundTask) -> int:
    """Room for sub-tasks that are on at once: per joint one that holds it and one that fades.

    Where something can be cut short, more of them may fade at once; if that is ever too many,
    the next waits for room.
    """
    claimed = {int(dof) for field in task.fields for dof in field.claims}
    adding = sum(1 for field in task.fields if not len(field.claims))
    if any(s.depends or s.while_ or s.times > 1 for s in task.spec.subtasks):
        return min(2 * len(task.fields), 3 * len(claimed) + 2 * adding) + 1
    return min(len(task.fields), 2 * len(claimed) + adding)

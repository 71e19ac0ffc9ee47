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
from specs.ordering import members, order_of

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
        ("start", np.float64),  # [s]
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
        ("node", np.int32),
        ("over", np.bool_),
        ("covered", np.bool_),
        ("released", np.bool_),  # whether it fades away instead of holding its goal
    ],
    align=True,
)
# Per simulation: the clock of the task, and the queue of those that begin or have ended.
COURSE = np.dtype(
    [
        ("lag", np.float64),  # [s] for which the task stood still
        ("pace", np.float64),  # of the task's time: 1, or 0 in a pause
        ("wanted", np.float64),  # pace
        ("last", np.float64),  # [s] time of the last step
        ("head", np.int32),
        ("tail", np.int32),
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
        )
        waits[k] = graph.graph.in_degree(name)
    return Plan(
        nodes=nodes,
        others=np.array(others, dtype=np.int32),
        roots=np.flatnonzero(waits == 0).astype(np.int32),
        waits=waits,
        conditions=_conditions(task),
        slots=_slots(task),
    )


def _conditions(task: BoundTask) -> Records:
    rows = np.zeros(len(task.conditions), dtype=CONDITION)
    for row, condition in zip(rows, task.conditions.values(), strict=True):
        row["event"], row["distance"] = condition.event, condition.distance
        if condition.palm is not None and condition.landmark is not None:
            row["hand"], row["palm"] = condition.palm.link, condition.palm.point
            row["link"], row["landmark"] = condition.landmark.link, condition.landmark.point
    return rows


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

"""The task graph as arrays that compiled code can walk.

A sub-task's number is its place in the graph's order. Walking touches only sub-tasks that
are on and their successors, so the size of the graph does not matter to a step.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records
from specs import BoundTask

NODE = np.dtype(
    [
        ("duration", np.float64),  # [s]
        ("fade", np.float64),  # [s] of the hand-over to this sub-task
        ("tolerance", np.float64),  # what counts as reached; 0 when it is over on time
        ("timeout", np.float64),  # [s]
        ("successors", np.int32),  # first of them in the array of successors
        ("count", np.int32),
        ("claims", np.bool_),  # whether it claims any joint
    ],
    align=True,
)

# How far a sub-task has come in one simulation.
PENDING, RUNNING, DONE, TIMED_OUT = range(4)
LOG = np.dtype(
    [
        ("start", np.float64),  # [s]
        ("end", np.float64),  # [s] when it was done or timed out; its goal is held on
        ("waits", np.int32),  # for so many predecessors
        ("outcome", np.int8),
        ("on", np.bool_),  # whether it makes torque
    ],
    align=True,
)
SLOT = np.dtype([("node", np.int32), ("over", np.bool_), ("covered", np.bool_)], align=True)


@dataclass(frozen=True)
class Plan:
    """The graph's nodes, their successors, and those that begin at once."""

    nodes: Records  # NODE (N,)
    successors: NDArray[np.int32]
    roots: NDArray[np.int32]
    waits: NDArray[np.int32]  # (N,) number of predecessors
    slots: int  # how many sub-tasks can make torque at once


def make_plan(task: BoundTask) -> Plan:
    """The plan of a bound task."""
    graph, spec = task.graph, task.spec
    number = {name: k for k, name in enumerate(graph.order)}
    nodes = np.zeros(len(number), dtype=NODE)
    successors: list[int] = []
    waits = np.zeros(len(number), dtype=np.int32)
    for name, k in number.items():
        subtask, field = graph.subtasks[name], task.fields[k]
        after = sorted(number[s] for s in graph.graph.successors(name))
        nodes[k] = (
            spec.duration(subtask),
            spec.fade(subtask),
            subtask.tolerance or 0.0,
            subtask.timeout or 0.0,
            len(successors),
            len(after),
            len(field.claims) > 0,
        )
        successors += after
        waits[k] = graph.graph.in_degree(name)
    return Plan(
        nodes=nodes,
        successors=np.array(successors, dtype=np.int32),
        roots=np.flatnonzero(waits == 0).astype(np.int32),
        waits=waits,
        slots=_slots(task),
    )


def _slots(task: BoundTask) -> int:
    """Most sub-tasks that can be on at once: per joint one that holds it and one that fades."""
    claimed = {int(dof) for field in task.fields for dof in field.claims}
    adding = sum(1 for field in task.fields if not len(field.claims))
    return min(len(task.fields), 2 * len(claimed) + adding)

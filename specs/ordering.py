"""What is known before a task runs: which sub-tasks are over, or never begin, when one begins.

Sets of sub-tasks are integers, one bit for each place in the graph's order. They follow the graph:

    over(v) = union over p of over(p) + p          `all`, `first`
            = intersection over p of over(p) + p   `any`: it may have been either
    branches(v) = intersection over p of branches(p) + the way out of p

Two sub-tasks never run at once if one is over when the other begins, or if they are on
different ways out of the same branching.
"""

from collections.abc import Iterator
from functools import reduce
from operator import and_, or_
from typing import NamedTuple

from specs.graph import AFTER, OTHERWISE, WHILE, TaskGraph


class Known(NamedTuple):
    """What is known of a sub-task."""

    over: int  # what is over, or was passed by, when it begins
    taken: int  # branchings that went their usual way
    otherwise: int  # branchings that went their other way
    ended: int  # what it may have to end, if it comes after the first of several

    def excludes(self, other: "Known") -> bool:
        """Whether only one of the two ever runs."""
        return bool(self.taken & other.otherwise | self.otherwise & other.taken)


class _Done(NamedTuple):
    """What the successors of a sub-task need to know."""

    above: int  # all that leads to it
    closed: int  # all that is over when it is
    known: Known


def order_of(task: TaskGraph) -> Iterator[Known]:
    """What is known of each sub-task, in the graph's order."""
    graph, number = task.graph, {name: k for k, name in enumerate(task.order)}
    left = {name: graph.out_degree(name) for name in number}
    done: dict[str, _Done] = {}
    for name, k in number.items():
        before = {p: graph.edges[p, name]["kind"] for p in graph.predecessors(name)}
        above = reduce(or_, (done[p].above | 1 << number[p] for p in before), 0)
        if WHILE in before.values():
            (one,) = (done[p] for p in before)
            known, closed = one.known._replace(ended=0), one.closed
        else:
            known = _known(before, done, number, task.subtasks[name].policy, above)
            beside = (n for n in graph.successors(name) if graph.edges[name, n]["kind"] == WHILE)
            closed = reduce(or_, (1 << number[n] for n in beside), known.over | 1 << k)
        yield known
        for p in before:  # of a large graph only what is still needed is kept
            left[p] -= 1
            if not left[p]:
                del done[p]
        if left[name]:
            done[name] = _Done(above, closed, known)


def _known(
    before: dict[str, str], done: dict[str, _Done], number: dict[str, int], policy: str, above: int
) -> Known:
    """From what is known of those that it comes after."""
    if not before:
        return Known(0, 0, 0, 0)
    either = reduce(or_, (done[p].closed for p in before))
    both = reduce(and_, (done[p].closed for p in before))
    over = {"all": either, "any": both, "first": either | above}[policy]
    taken, otherwise = (
        reduce(
            and_, (_row(done[p], way) | (kind == way) << number[p] for p, kind in before.items())
        )
        for way in (AFTER, OTHERWISE)
    )
    return Known(over, taken, otherwise, above & ~both if policy == "first" else 0)


def _row(done: _Done, way: str) -> int:
    return done.known.taken if way == AFTER else done.known.otherwise


def members(mask: int) -> list[int]:
    """The places in a set."""
    found = []
    while mask:
        low = mask & -mask
        found.append(low.bit_length() - 1)
        mask ^= low
    return found

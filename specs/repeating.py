"""Chains that are repeated: `repeat: {from: NAME, …}` at the last of them.

A round goes from the first to the last along every way between them, with whatever is on beside
them (`while`). It has one way in and one way out, so that the next round can begin as the first
did; of two chains one holds the other, or they have nothing in common.
"""

from collections.abc import Iterable, Mapping

import networkx as nx

from sim import unknown
from specs.errors import SpecError
from specs.reading import Document
from specs.task import SubTask

WHILE = "while"


def chains(graph: "nx.DiGraph[str]", subtasks: Iterable[SubTask]) -> dict[str, frozenset[str]]:
    """The sub-tasks of each repeated chain, by the last of them."""
    firsts = {s.name: s.first for s in subtasks if s.first is not None}
    ways = _ways(graph) if firsts else graph
    return {last: _between(ways, graph, first, last) for last, first in firsts.items()}


def check_chains(
    graph: "nx.DiGraph[str]",
    subtasks: Iterable[SubTask],
    places: Mapping[str, int],
    document: Document,
) -> None:
    """Refuse chains that cannot be repeated.

    Args:
        graph: of a task.
        subtasks: its own.
        places: of the sub-tasks in the file.
        document: what the task was read from.

    Raises:
        SpecError: no such sub-task, or none before this one; a way in or out in the middle; a
            chain that is half in another.
    """
    repeating = [s for s in subtasks if s.first is not None]
    known: dict[str, frozenset[str]] = {}
    ways = _ways(graph) if repeating else graph
    for subtask in repeating:
        first, last = subtask.first or "", subtask.name

        def wrong(said: str, last: str = last) -> SpecError:
            return document.error(said, ("subtasks", places[last], "repeat", "from"))

        if first not in ways:
            raise wrong(unknown("sub-task", first, places))
        if first == last:
            raise wrong(f"{last!r} repeats itself: write repeat: {subtask.times}")
        own = _between(ways, graph, first, last)
        if not own:
            raise wrong(f"{last!r} does not come after {first!r}: nothing lies between them")
        for name in own:
            for before in ways.predecessors(name):
                if before not in own and name != first:
                    raise wrong(
                        f"{name!r} would be repeated with {first!r}, but it comes after {before!r},"
                        " which would not: repeat from further ahead, or let it wait for neither"
                    )
            for after in ways.successors(name):
                if after not in own and name != last:
                    raise wrong(
                        f"{after!r} comes after {name!r}, which is not over before {last!r} was"
                        f" repeated: let it come after {last!r}"
                    )
        for other, theirs in known.items():
            if own & theirs and not (own < theirs or theirs < own):
                raise wrong(f"what {last!r} repeats and what {other!r} repeats overlap")
        known[last] = own


def _ways(graph: "nx.DiGraph[str]") -> "nx.DiGraph[str]":
    """The graph without what is on beside others."""
    ways: nx.DiGraph[str] = nx.DiGraph()
    ways.add_nodes_from(graph)
    ways.add_edges_from((a, b) for a, b, kind in graph.edges(data="kind") if kind != WHILE)
    return ways


def _between(
    ways: "nx.DiGraph[str]", graph: "nx.DiGraph[str]", first: str, last: str
) -> frozenset[str]:
    """Everything on a way from the first to the last, and what is on beside it."""
    own = (nx.descendants(ways, first) | {first}) & (nx.ancestors(ways, last) | {last})
    if not {first, last} <= own:
        return frozenset()
    beside = {
        other for name in own for other in graph.successors(name)
        if graph.edges[name, other]["kind"] == WHILE
    }  # fmt: skip
    return frozenset(own | beside)


__all__ = ["SpecError", "chains", "check_chains"]

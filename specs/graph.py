"""The task graph: which sub-task comes after which, and when each is planned."""

from dataclasses import dataclass
from functools import cached_property

import networkx as nx

from sim import unknown
from specs.conditions import Join
from specs.reading import Document, Path_
from specs.repeating import check_chains
from specs.task import SubTask, TaskSpec

AFTER, OTHERWISE, WHILE = "after", "otherwise", "while"  # kinds of edges


@dataclass(frozen=True)
class TaskGraph:
    """A task as a directed acyclic graph; nodes are the names of its sub-tasks."""

    spec: TaskSpec
    graph: "nx.DiGraph[str]"

    @cached_property
    def subtasks(self) -> dict[str, SubTask]:
        """The sub-tasks by name."""
        return {s.name: s for s in self.spec.subtasks}

    @cached_property
    def order(self) -> tuple[str, ...]:
        """Names in an order in which each comes after all that it waits for."""
        place = {s.name: i for i, s in enumerate(self.spec.subtasks)}
        return tuple(nx.lexicographical_topological_sort(self.graph, key=place.__getitem__))

    @cached_property
    def planned(self) -> dict[str, tuple[float, float]]:
        """Planned start and end of each sub-task [s], all on time and no branch left out."""
        times: dict[str, tuple[float, float]] = {}
        for name in self.order:
            subtask = self.subtasks[name]
            if subtask.while_ is not None:
                times[name] = times[subtask.while_]
                continue
            ends = [self._leaves(p, name, times[p]) for p in self.graph.predecessors(name)]
            start = (max if subtask.policy == "all" else min)(ends, default=0.0)
            lasts, again = self.spec.duration(subtask), subtask.times - 1
            whole = lasts if subtask.first is None else start + lasts - times[subtask.first][0]
            times[name] = start, start + lasts + again * whole
        return times

    def _leaves(self, name: str, to: str, planned: tuple[float, float]) -> float:
        """When a sub-task lets another begin: if it gives up, at the end of its patience."""
        subtask, (start, end) = self.subtasks[name], planned
        if self.graph.edges[name, to]["kind"] == AFTER:
            return end
        return start if subtask.if_ else max(end, start + (subtask.timeout or 0.0))

    @cached_property
    def edges(self) -> tuple[tuple[str, str, str], ...]:
        """From, to and meaning: `after`, `any`, `first`, `otherwise` or `while`."""
        place = {name: i for i, name in enumerate(self.order)}
        ordered = sorted(self.graph.edges, key=lambda e: (place[e[0]], place[e[1]]))
        return tuple((one, then, self._kind(one, then)) for one, then in ordered)

    def _kind(self, one: str, then: str) -> str:
        kind: str = self.graph.edges[one, then]["kind"]
        policy = self.subtasks[then].policy
        return policy if kind == AFTER and policy != "all" else kind

    @property
    def duration(self) -> float:
        """Planned duration with the coda [s]."""
        end = max(end for _, end in self.planned.values())
        return end + self.spec.seconds(self.spec.coda)


def build_graph(spec: TaskSpec, document: Document | None = None) -> TaskGraph:
    """Compile a task to its graph.

    Args:
        spec: the task.
        document: what it was read from, so that errors can say where.

    Raises:
        SpecError: a sub-task waits for one that does not exist, or for itself, is to begin for
            two reasons, or repeats what cannot be repeated.
    """
    document = document or Document(None, "")
    names = {s.name: i for i, s in enumerate(spec.subtasks)}
    graph: nx.DiGraph[str] = nx.DiGraph()
    spared = {s.otherwise for s in spec.subtasks}  # these begin when another gives up
    previous: SubTask | None = None
    for i, subtask in enumerate(spec.subtasks):
        graph.add_node(subtask.name)
        if subtask.name in spared and subtask.after is not None:
            giver = next(s.name for s in spec.subtasks if s.otherwise == subtask.name)
            said = f"{subtask.name!r} is the 'otherwise' of {giver!r}, and so takes no 'after'"
            raise document.error(said, ("subtasks", i, "after"), key=True)
        for other, path in _awaited(subtask, i, previous, subtask.name in spared):
            _join(graph, names, other, subtask.name, AFTER, document, path)
        if (one := subtask.while_) is not None:
            _join(graph, names, one, subtask.name, WHILE, document, ("subtasks", i, WHILE))
        if (then := subtask.otherwise) is not None:
            place = ("subtasks", i, OTHERWISE)
            _join(graph, names, subtask.name, then, OTHERWISE, document, place)
        previous = subtask
    if not nx.is_directed_acyclic_graph(graph):
        cycle = [a for a, _ in nx.find_cycle(graph)]
        shown = " -> ".join([*cycle, cycle[0]])
        place = ("subtasks", names[cycle[0]], "after")
        raise document.error(f"these sub-tasks wait for each other: {shown}", place)
    check_chains(graph, spec.subtasks, names, document)
    return TaskGraph(spec, graph)


def _awaited(
    subtask: SubTask, i: int, previous: SubTask | None, spared: bool
) -> list[tuple[str, Path_]]:
    """What a sub-task comes after, and where the file says so."""
    here = ("subtasks", i, "after")
    if isinstance(subtask.after, Join):
        policy = subtask.policy
        return [(name, (*here, policy, j)) for j, name in enumerate(subtask.after.names)]
    if subtask.after is not None:
        return [(name, (*here, j)) for j, name in enumerate(subtask.after)]
    if previous is None or spared or subtask.while_ is not None:
        return []
    return [(previous.name, here)]


def _join(
    graph: "nx.DiGraph[str]",
    names: dict[str, int],
    one: str,
    then: str,
    kind: str,
    document: Document,
    place: Path_,
) -> None:
    """Add an edge."""
    for name in (one, then):
        if name not in names:
            raise document.error(unknown("sub-task", name, names), place)
    if kind != AFTER and graph.has_node(then) and graph.in_degree(then):
        (giver, *_) = graph.predecessors(then)
        said = f"{then!r} begins because of {giver!r} already"
        raise document.error(said, place)
    graph.add_edge(one, then, kind=kind)

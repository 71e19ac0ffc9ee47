"""The task graph: which sub-task comes after which, and when each is planned."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import networkx as nx

from primitives import Primitive
from sim import unknown
from specs.conditions import Join
from specs.reading import Document, Path_
from specs.repeating import check_chains
from specs.task import SubTask, TaskSpec
from specs.tempo import Clock, clock_of

Does = TypeVar("Does", bound=Primitive)
AFTER, OTHERWISE, WHILE = "after", "otherwise", "while"  # kinds of edges


@dataclass(frozen=True)
class Timing:
    """When what is planned [s]."""

    clock: Clock
    planned: dict[str, tuple[float, float]]  # start and end of each sub-task
    lasts: dict[str, float]  # of each, or of one round of it


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
    def timing(self) -> "Timing":
        """When what is planned, all on time and no branch left out.

        The tempo may change where a sub-task begins, which depends on the tempo before: of the
        changes that are not settled yet the earliest is where it seems to be.
        """
        left = {step.subtask for step in self.spec.tempo_map if step.subtask is not None}
        begins: dict[str, float] = {}  # at which beat
        while True:
            clock = clock_of(self.spec.tempo, self.spec.tempo_map, begins)
            timing = self._plan(clock)
            if not left:
                return timing
            first = min(timing.planned[name][0] for name in left)
            now = {name for name in left if timing.planned[name][0] == first}
            begins |= dict.fromkeys(now, clock.beat(first))
            left -= now

    @property
    def planned(self) -> dict[str, tuple[float, float]]:
        """Planned start and end of each sub-task [s]."""
        return self.timing.planned

    def lasts(self, name: str) -> float:
        """How long a sub-task takes, or one round of it [s]."""
        return self.timing.lasts[name]

    def fade(self, name: str) -> float:
        """How long the hand-over to a sub-task takes [s]: never longer than the sub-task."""
        asked = self.subtasks[name].hand_over
        return min(self.spec.hand_over if asked is None else asked, self.lasts(name))

    def paced(self, does: Does, start: float = 0.0, lasts: float = math.inf) -> Does:
        """A primitive that begins then [s] with all that it says in beats said in seconds."""
        clock = self.timing.clock
        tempo, changes = clock.tempo(start), clock.changes(start, start + lasts)
        return does.at_tempo(tempo, changes) if changes else does.at_tempo(tempo)

    def _plan(self, clock: Clock) -> "Timing":
        times: dict[str, tuple[float, float]] = {}
        lasts: dict[str, float] = {}
        for name in self.order:
            subtask = self.subtasks[name]
            if subtask.while_ is not None:
                start, end = times[subtask.while_]
            else:
                ends = [self._leaves(p, name, times[p]) for p in self.graph.predecessors(name)]
                start, end = (max if subtask.policy == "all" else min)(ends, default=0.0), None
            beats = 1.0 if subtask.beats is None else subtask.beats
            lasts[name] = subtask.seconds or clock.lasts(start, beats)
            if end is None:
                over = start + lasts[name]
                whole = lasts[name] if subtask.first is None else over - times[subtask.first][0]
                end = over + (subtask.times - 1) * whole
            times[name] = start, end
        return Timing(clock, times, lasts)

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
        return max(end for _, end in self.planned.values()) + self.coda

    @property
    def coda(self) -> float:
        """How long the last goals are held [s]."""
        end = max(end for _, end in self.planned.values())
        return self.timing.clock.lasts(end, self.spec.coda)


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
    for i, step in enumerate(spec.tempo_map):
        if step.subtask is not None and step.subtask not in names:
            place = ("tempo_map", i, "subtask")
            raise document.error(unknown("sub-task", step.subtask, names), place)
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

"""The task graph: which sub-task comes after which, and when each is planned."""

import json
from dataclasses import dataclass
from functools import cached_property

import networkx as nx

from sim import unknown
from specs.reading import Document
from specs.task import SubTask, TaskSpec


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
        """Planned start and end of each sub-task [s], all of them on time."""
        times: dict[str, tuple[float, float]] = {}
        for name in self.order:
            start = max((times[p][1] for p in self.graph.predecessors(name)), default=0.0)
            times[name] = start, start + self.spec.duration(self.subtasks[name])
        return times

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
        SpecError: a sub-task waits for one that does not exist, or for itself.
    """
    document = document or Document(None, "")
    names = {s.name: i for i, s in enumerate(spec.subtasks)}
    graph: nx.DiGraph[str] = nx.DiGraph()
    previous: SubTask | None = None
    for i, subtask in enumerate(spec.subtasks):
        graph.add_node(subtask.name)
        waits = subtask.after
        if waits is None:
            waits = (previous.name,) if previous else ()
        for j, other in enumerate(waits):
            if other not in names:
                message = unknown("sub-task", other, names)
                raise document.error(message, ("subtasks", i, "after", j))
            graph.add_edge(other, subtask.name)
        previous = subtask
    if not nx.is_directed_acyclic_graph(graph):
        cycle = [a for a, _ in nx.find_cycle(graph)]
        shown = " -> ".join([*cycle, cycle[0]])
        place = ("subtasks", names[cycle[0]], "after")
        raise document.error(f"these sub-tasks wait for each other: {shown}", place)
    return TaskGraph(spec, graph)


def to_mermaid(task: TaskGraph) -> str:
    """The graph as a Mermaid flowchart."""
    ids = {name: f"s{i}" for i, name in enumerate(task.order)}
    lines = ["flowchart TD"]
    lines += [f'    {ids[name]}["{_label(task, name, "<br>")}"]' for name in task.order]
    lines += [f"    {ids[a]} --> {ids[b]}" for a, b in _edges(task)]
    return "\n".join(lines) + "\n"


def to_dot(task: TaskGraph) -> str:
    """The graph in Graphviz' DOT language."""
    ids = {name: f"s{i}" for i, name in enumerate(task.order)}
    lines = [f"digraph {json.dumps(task.spec.task)} {{", "    node [shape=box];"]
    for name in task.order:
        label = json.dumps(_label(task, name, "\n"), ensure_ascii=False)
        lines.append(f"    {ids[name]} [label={label}];")
    lines += [f"    {ids[a]} -> {ids[b]};" for a, b in _edges(task)]
    return "\n".join([*lines, "}"]) + "\n"


def to_json(task: TaskGraph) -> str:
    """The graph as JSON: nodes with their primitive, planned times and words; edges."""
    nodes = []
    for name in task.order:
        does, (start, end) = task.subtasks[name].does, task.planned[name]
        nodes.append(
            {
                "name": name,
                "words": task.subtasks[name].words,
                "primitive": does.kind,
                "controller": getattr(does, "controller", None),
                "limb": getattr(does, "limb", None),
                "start": round(start, 6),
                "end": round(end, 6),
            }
        )
    edges = [{"from": a, "to": b} for a, b in _edges(task)]
    whole = {"task": task.spec.task, "tempo": task.spec.tempo, "nodes": nodes, "edges": edges}
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def _edges(task: TaskGraph) -> list[tuple[str, str]]:
    place = {name: i for i, name in enumerate(task.order)}
    return sorted(task.graph.edges, key=lambda e: (place[e[0]], place[e[1]]))


def _label(task: TaskGraph, name: str, newline: str) -> str:
    subtask = task.subtasks[name]
    said = subtask.words or name
    start, end = task.planned[name]
    label = f"{said}{newline}{subtask.does.kind}, {start:.2f}-{end:.2f} s"
    return label.replace('"', "'")

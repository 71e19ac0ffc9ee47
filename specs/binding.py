"""Binding: a task meets a body. Every name becomes an index here, and every error is raised."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from primitives import Field, Primitive, PrimitiveError
from primitives.go_to_point import ReachField
from sim import Body, BodyError
from specs.errors import SpecError
from specs.graph import TaskGraph, build_graph
from specs.reading import Document, Path_
from specs.task import TaskSpec


@dataclass(frozen=True)
class BoundTask:
    """A task on a body: what the arbiter runs.

    `fields[k]` does the k-th sub-task of `graph.order`.
    """

    body: Body
    graph: TaskGraph
    background: tuple[Field, ...]
    fields: tuple[Field, ...]
    start: NDArray[np.float64]  # posture (nq,) to begin in

    @property
    def spec(self) -> TaskSpec:
        """The task as written."""
        return self.graph.spec

    @property
    def may_wait(self) -> bool:
        """Whether a sub-task may take longer than planned, until something is reached."""
        return any(s.done != "on-time" for s in self.spec.subtasks)


def bind_task(spec: TaskSpec, body: Body, document: Document | None = None) -> BoundTask:
    """Compile a task to its graph and bind every primitive of it to a body.

    Args:
        spec: the task.
        body: the body that is to do it.
        document: what the task was read from, so that errors can say where.

    Raises:
        SpecError: anything in the task that does not fit: names, order, claims.
    """
    document = document or Document(None, "")
    graph = build_graph(spec, document)
    background = tuple(
        _bind(b.does, body, np.inf, document, ("background", i), b.name)
        for i, b in enumerate(spec.background)
    )
    places = {s.name: ("subtasks", i) for i, s in enumerate(spec.subtasks)}
    fields = tuple(
        _bind(
            graph.subtasks[name].does,
            body,
            spec.duration(graph.subtasks[name]),
            document,
            places[name],
            name,
        )
        for name in graph.order
    )
    _check_claims(graph, fields, body, document, places)
    start = body.home.copy()
    if spec.start is not None:
        try:
            angles = body.posture(spec.start)
        except BodyError as problem:
            raise document.error(str(problem), ("start",)) from None
        given = ~np.isnan(angles)
        start[body.qpos_of_dof[given]] = angles[given]
    return BoundTask(body, graph, background, fields, start)


def doubts(task: BoundTask) -> list[str]:
    """What can be known to fail without simulating, one sentence each."""
    found = []
    for name, field in zip(task.graph.order, task.fields, strict=True):
        far = field.too_far() if isinstance(field, ReachField) else 0.0
        if far > 0.0:
            found.append(
                f"{name}: the goal is {100 * far:.0f} cm farther from the shoulder than"
                f" the arm of {task.body.map.name} is long"
            )
    return found


def _bind(
    primitive: Primitive, body: Body, duration: float, document: Document, path: Path_, name: str
) -> Field:
    try:
        return primitive.bind(body, duration)
    except (BodyError, PrimitiveError) as problem:
        raise document.error(f"{name}: {problem}", path) from None


def _check_claims(
    graph: TaskGraph,
    fields: Sequence[Field],
    body: Body,
    document: Document,
    places: dict[str, tuple[str, int]],
) -> None:
    """Whatever claims a joint must do so one after the other.

    For each joint, `depth` counts its claimants along the longest chain that leads to a
    sub-task; the k-th claimant in the order must be the k-th of one chain.
    """
    depth: dict[str, NDArray[np.int64]] = {}
    claimed = np.zeros(body.nv, dtype=np.int64)
    last: dict[int, str] = {}
    for name, field in zip(graph.order, fields, strict=True):
        above = [depth[p] for p in graph.graph.predecessors(name)]
        mine = np.max(above, axis=0) if above else np.zeros(body.nv, dtype=np.int64)
        mine = mine.copy()
        mine[field.claims] += 1
        claimed[field.claims] += 1
        for dof in field.claims:
            if mine[dof] != claimed[dof]:
                other = last[int(dof)]
                raise document.error(
                    f"{name!r} and {other!r} both claim {body.dof_name(int(dof))}, and neither"
                    " comes after the other: name one in the other's 'after'",
                    places[name],
                )
            last[int(dof)] = name
        depth[name] = mine


__all__ = ["BoundTask", "SpecError", "bind_task", "doubts"]

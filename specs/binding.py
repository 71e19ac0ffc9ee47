"""Binding: a task meets a body. Every name becomes an index here, and every error is raised."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from primitives import (
    AvoidCollisions,
    CompensateGravity,
    Field,
    Primitive,
    PrimitiveError,
    Relax,
)
from sim import BeyondRange, Body, BodyError, pushed_apart, standing
from specs.blame import told
from specs.conditions import BoundCondition, Condition, bind_condition
from specs.definitions import define
from specs.errors import SpecError
from specs.firmness import firm
from specs.fitting import fitted
from specs.graph import TaskGraph, build_graph
from specs.groups import check_groups, together
from specs.ordering import Known, members, order_of
from specs.quoting import quoted_place
from specs.reading import Document, Path_
from specs.scene import check_room, furnish
from specs.task import Background, SubTask, TaskSpec, keys_of

FIELD = ("claims", "unit", "begin", "torque", "error")  # the parts of a field
OWN_KEYS = {*keys_of(SubTask), "primitive"}  # of a step of a task; the rest is its primitive's


@dataclass(frozen=True)
class BoundTask:
    """A task on a body: what the arbiter runs.

    `fields[k]` does the k-th sub-task of `graph.order`.
    """

    on: Body  # the body as it was given
    body: Body  # with the objects, landmarks and postures of the task, as firm as it says
    graph: TaskGraph
    background: tuple[Field, ...]
    fields: tuple[Field, ...]
    start: NDArray[np.float64]  # posture (nq,) to begin in
    conditions: dict[Condition, BoundCondition]
    events: tuple[str, ...]  # that may be sent from outside

    @property
    def spec(self) -> TaskSpec:
        """The task as written."""
        return self.graph.spec

    def body_for(self, name: str) -> Body:
        """The body beside the objects as they are planned to stand when a sub-task ends."""
        return standing(self.body, self.graph.planned[name][1])

    @cached_property
    def grouped(self) -> frozenset[str]:
        """Names that are in a group; in the background they do not give way, they co-act."""
        return frozenset(member for group in self.spec.groups for member in group.members)

    @property
    def may_wait(self) -> bool:
        """Whether it depends on what happens how long the task takes."""
        return any(s.depends for s in self.spec.subtasks)


def bind_task(spec: TaskSpec, body: Body, document: Document | None = None) -> BoundTask:
    """Compile a task to its graph and bind every primitive of it to a body.

    Args:
        spec: the task; written for another body, it is made to fit: see `fitted`.
        body: the body that is to do it.
        document: what the task was read from, so that errors can say where.

    Raises:
        SpecError: anything in the task that does not fit: names, order, claims.
    """
    document = document or Document(None, "")
    spec = fitted(spec, body, document)
    graph = build_graph(spec, document)
    on, body = body, firm(defined(graph, body, document), spec.gains)
    background = tuple(
        _bind(graph, b.does, 0.0, body, np.inf, document, ("background", i), b.name)
        for i, b in enumerate(spec.background)
    )
    places: dict[str, Path_] = {s.name: ("subtasks", i) for i, s in enumerate(spec.subtasks)}
    fields = tuple(
        _bind(
            graph,
            graph.subtasks[name].does,
            graph.planned[name][0],
            standing(body, graph.planned[name][1]),
            graph.lasts(name),
            document,
            places[name],
            name,
        )
        for name in graph.order
    )
    named = dict(zip((b.name for b in spec.background), background, strict=True))
    named |= zip(graph.order, fields, strict=True)
    check_groups(spec.groups, named, document)
    _check_claims(graph, fields, body, document, places)
    _check_goals(graph, fields, document, places)
    _check_limp(spec, document)
    if spec.safety == "filter":
        _check_safety(spec, body, document)
    start = body.home.copy()
    if spec.start is not None:
        try:
            angles = body.posture(spec.start)
        except BodyError as problem:
            raise document.error(str(problem), ("start",)) from None
        given = ~np.isnan(angles)
        start[body.qpos_of_dof[given]] = angles[given]
    check_room(body, start, document)
    conditions, events = _conditions(spec, body, document)
    return BoundTask(on, body, graph, background, fields, start, conditions, events)


def defined(graph: TaskGraph, body: Body, document: Document) -> Body:
    """The body with all that a task says of it and of the scene.

    Raises:
        SpecError: at what makes no sense on this body.
    """
    spec = graph.spec
    beside = furnish(spec.scene, body, graph.timing.clock, document)
    return define(spec.landmarks, spec.postures, beside, document)


def _conditions(
    spec: TaskSpec, body: Body, document: Document
) -> tuple[dict[Condition, BoundCondition], tuple[str, ...]]:
    """The conditions of a task and the events that they name."""
    found: dict[Condition, BoundCondition] = {}
    events: list[str] = []
    for i, subtask in enumerate(spec.subtasks):
        for key, condition in subtask.conditions.items():
            place: Path_ = ("subtasks", i, key, *(("until",) if key == "repeat" else ()))
            try:
                found[condition] = bind_condition(condition, body, events)
            except BodyError as problem:
                wrong = "limb" if condition.limb not in body.map.limbs else "near"
                said = f"{subtask.name}: {problem}"
                raise document.error(said, (*place, wrong)) from None
    return found, tuple(events)


def _bind(
    graph: TaskGraph,
    primitive: Primitive,
    start: float,
    body: Body,
    duration: float,
    document: Document,
    path: Path_,
    name: str,
) -> Field:
    """The field of a primitive; whatever is wrong with it is said at its place in the file."""
    try:
        field = graph.paced(primitive, start, duration).bind(body, duration)
        wrong = _no_field(field, body)
    except (BodyError, PrimitiveError) as problem:
        where, key = quoted_place(document, path, str(problem), apart_from=OWN_KEYS)
        code = "joint-limit" if isinstance(problem, BeyondRange) else "refused"
        raise document.error(f"{name}: {problem}", where, key=key, code=code) from None
    except (Exception, SystemExit) as problem:  # whatever the user's own code raises
        said = f"{name}: bind of {type(primitive).__name__} raised {told(problem)}"
        raise document.error(said, path) from problem
    if wrong:
        raise document.error(f"{name}: bind of {type(primitive).__name__} {wrong}", path)
    if np.isfinite(duration) and (lacks := nothing_to_move(primitive, body)):
        raise document.error(f"{name}: {lacks}", (*path, "joints"))
    return field


def nothing_to_move(primitive: Primitive, body: Body) -> str:
    """Why a sub-task moves nothing: the body has none of its joints; nothing if it has some."""
    joints = getattr(primitive, "joints", None)
    if not joints or not isinstance(joints, tuple):
        return ""
    try:
        none = not len(body.joints(joints))
    except (BodyError, TypeError):  # somebody's own primitive, whose joints mean something else
        return ""
    return f"there is nothing to move: {body.map.name} has no {', '.join(joints)}" if none else ""


def _no_field(field: object, body: Body) -> str:
    """What is wrong with something that a `bind` returned as a field; nothing if it is one."""
    lacks = [part for part in FIELD if not hasattr(field, part)]
    lacks += [
        part for part in FIELD[2:] if part not in lacks and not callable(getattr(field, part))
    ]
    if lacks:
        return (
            f"returned {_called(field)}, which lacks {', '.join(lacks)}"
            f" (a field has {', '.join(FIELD[:-1])} and {FIELD[-1]})"
        )
    claims, unit = getattr(field, FIELD[0]), getattr(field, FIELD[1])
    if not isinstance(unit, str):
        return f"returned {_called(field)} whose unit is {unit!r}; expected a word such as 'rad'"
    if not isinstance(claims, np.ndarray) or claims.ndim != 1 or claims.dtype.kind not in "iu":
        return (
            f"returned {_called(field)} whose claims are {claims!r}; expected an array of"
            " integers, as body.joints(…) returns"
        )
    if len(claims) and (claims.min() < 0 or claims.max() >= body.nv):
        return f"returned {_called(field)} that claims joints beyond 0 to {body.nv - 1}: {claims}"
    return ""


def _called(made: object) -> str:
    return "None" if made is None else f"an object of type {type(made).__name__}"


def _check_goals(
    graph: TaskGraph, fields: Sequence[Field], document: Document, places: Mapping[str, Path_]
) -> None:
    """Who is over when its goal is reached must have one."""
    for name, field in zip(graph.order, fields, strict=True):
        subtask = graph.subtasks[name]
        if subtask.done == "reached" and field.unit == "":
            raise document.error(
                f"{name}: 'done: reached' needs a goal, and {subtask.does.kind} has none: the unit"
                " of its error is empty",
                (*places[name], "done"),
            )


def _check_limp(spec: TaskSpec, document: Document) -> None:
    """A limp limb takes its weight back from compensate-gravity, so there must be that."""
    if any(isinstance(b.does, CompensateGravity) for b in spec.background):
        return
    steps: list[tuple[Path_, Background | SubTask]] = [
        *((("background", i), b) for i, b in enumerate(spec.background)),
        *((("subtasks", i), s) for i, s in enumerate(spec.subtasks)),
    ]
    for path, step in steps:
        if isinstance(step.does, Relax) and step.does.limp:
            raise document.error(
                f"{step.name}: 'limp' takes back the weight that compensate-gravity carries, and"
                " nothing in the background does: leave it out, the limb falls by itself",
                (*path, "limp"),
            )


def _check_safety(spec: TaskSpec, body: Body, document: Document) -> None:
    """The filter needs shapes whose distances it knows, and its name for itself."""
    try:
        if pushed_apart(body):
            AvoidCollisions().bind(body, np.inf)
    except (BodyError, PrimitiveError) as problem:
        raise document.error(f"safety: {problem}", ("safety",)) from None
    for part, steps in (("background", spec.background), ("subtasks", spec.subtasks)):
        for i, step in enumerate(steps):
            if step.name == "safety":
                message = "with safety: filter nothing else can be called 'safety'"
                raise document.error(message, (part, i))


def _check_claims(
    graph: TaskGraph,
    fields: Sequence[Field],
    body: Body,
    document: Document,
    places: Mapping[str, Path_],
) -> None:
    """Who claims a joint does so one at a time: in order or on other branches; or in a group."""
    masks: dict[int, int] = {}  # per joint, who claims it
    branches: dict[int, Known] = {}
    uncertain = any(s.depends or s.while_ for s in graph.spec.subtasks)
    for b, (name, field, known) in enumerate(
        zip(graph.order, fields, order_of(graph), strict=True)
    ):
        if known.taken or known.otherwise:
            branches[b] = known._replace(over=0)
        for dof in (int(dof) for dof in field.claims):
            for a in members(masks.get(dof, 0) & ~known.over):
                if a in branches and branches[a].excludes(known):
                    continue
                other, joint = graph.order[a], body.dof_name(dof)
                if together(name, other, graph.spec.groups):
                    continue  # both act, and a rule decides
                if graph.subtasks[name].policy == "any" and nx.has_path(graph.graph, other, name):
                    raise document.error(
                        f"{name!r} begins when any of those before it is over, and {other!r} may"
                        f" still run then, but both claim {joint}: 'after: {{first: …}}' ends the"
                        " others",
                        (*places[name], "after"),
                    )
                neither = "they may run at once" if uncertain else "neither comes after the other"
                raise document.error(
                    f"{name!r} and {other!r} both claim {joint}, and {neither}: name one in the"
                    " other's 'after'",
                    places[name],
                    code="claims",
                )
            masks[dof] = masks.get(dof, 0) | 1 << b


__all__ = ["BoundTask", "SpecError", "bind_task"]

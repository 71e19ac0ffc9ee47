"""What a body can do of a task, sub-task by sub-task, told before anything moves.

A task speaks anatomy, and bodies differ: one has no neck, another's wrist turns half as far. Each
sub-task is `reachable`; or `partly`, with how far short it stays at best, which joint is to blame,
and what would come nearest; or `impossible`, because the body lacks what it names or is too weak.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from primitives import GetPosture, GoToPoint, Place, Primitive, PrimitiveError
from primitives.get_posture import arm_words, said_angles
from primitives.primitive import FloatArray, IntArray
from sim import (
    BeyondRange,
    Body,
    BodyError,
    Unposable,
    inverse_dynamics,
    joint_to_blame,
    load_body,
    moving_dofs,
    off_words,
    places_of,
    reach,
)
from sim.posing import posed
from specs.binding import bind_task
from specs.conditions import bind_condition
from specs.definitions import define
from specs.errors import SpecError
from specs.graph import TaskGraph, build_graph
from specs.reading import Document
from specs.task import SubTask, TaskSpec
from specs.tolerances import TOUCH_BEFORE_NEXT, size_of

Possible = Literal["reachable", "partly", "impossible"]

STRONG = 1.0  # share of its limit that a motor may need to hold a posture
DEGREE = float(np.rad2deg(1.0))
REFERENCE = "adonis"  # the body that lacks nothing
METRES, RADIANS = 0.02, 0.05  # what a radian of a joint has to save to be to blame


@dataclass(frozen=True)
class Fitness:
    """What a body can do of one sub-task."""

    subtask: str
    verdict: Possible
    why: str = ""
    short: float | None = None  # of the goal at best
    unit: str = ""  # of that: m, deg or N m
    joint: str | None = None  # which is to blame
    instead: Primitive | None = None  # what comes nearest

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        given = {key: getattr(self, key) for key in ("subtask", "verdict", "why", "short", "unit")}
        return {**given, "joint": self.joint}


def fitness_of(spec: TaskSpec, body: Body, document: Document | None = None) -> list[Fitness]:
    """What a body can do of each sub-task, in the order of the graph.

    Args:
        spec: the task, fitted to the body.
        body: that is to do it.
        document: what the task was read from, so that errors can say where.

    Raises:
        SpecError: the task makes no sense on any body.
    """
    document = document or Document(None, "")
    graph = build_graph(spec, document)
    body = define(spec.landmarks, spec.postures, body, document)
    found = []
    for name in graph.order:
        subtask = graph.subtasks[name]
        try:
            found.append(_fitness(graph, subtask, body))
        except (BodyError, PrimitiveError) as problem:
            _check_elsewhere(spec, subtask, document)
            found.append(Fitness(name, "impossible", str(problem)))
    return found


def _check_elsewhere(spec: TaskSpec, subtask: SubTask, document: Document) -> None:
    """What no body has is no lack of this one.

    Raises:
        SpecError: the task cannot be bound to its own body either, because of this sub-task.
    """
    own = load_body(spec.body if spec.body else REFERENCE)
    if own.map.name == REFERENCE or spec.body:
        try:
            bind_task(_alone(spec, subtask), own)
        except SpecError:
            bind_task(spec, own, document)


def _alone(spec: TaskSpec, subtask: SubTask) -> TaskSpec:
    only = SubTask(name=subtask.name, does=subtask.does)
    return spec.model_copy(update={"subtasks": (only,), "background": (), "groups": ()})


def _fitness(graph: TaskGraph, subtask: SubTask, body: Body) -> Fitness:
    """Of one sub-task.

    Raises:
        BodyError, PrimitiveError: the body lacks something that it names.
    """
    for condition in subtask.conditions.values():
        bind_condition(condition, body, [])
    does, name = subtask.does, subtask.name
    posture = None
    try:
        field = graph.paced(does, graph.planned[name][0], graph.lasts(name)).bind(
            body, graph.lasts(name)
        )
    except Unposable as problem:
        return _unposable(name, does, body, problem)
    except BeyondRange as problem:
        return _beyond(name, does, body, problem)
    if isinstance(does, GoToPoint):
        short, posture = _short(does, body)
        if short is not None:
            return _out_of_reach(name, does, body, short, posture)
    elif isinstance(does, GetPosture) and hasattr(field, "goal"):
        posture = field.goal
    return _strong(name, body, posture, field.claims)


def _short(does: GoToPoint, body: Body) -> tuple[float | None, FloatArray]:
    """By how much a palm misses its goal at best [m], None if not; and the posture (nv,) then.

    Where the goal moves with joints of another limb, nobody can tell.
    """
    arm, goal = body.arm(does.limb), does.palm_goal(body)
    best, least = body.home[body.qpos_of_dof], np.inf
    between = moving_dofs(body, goal.place.link) ^ moving_dofs(body, arm.root)
    limbs = {int(dof) for limb in body.map.limbs for dof in body.joints(limb)}
    if between & limbs:
        return None, best
    for wanted in (goal, None):
        tried = goal if wanted is not None else _facing_anywhere(goal)
        (angles,), _ = reach(body, arm, [tried])
        posture = np.where(np.isnan(angles), body.home[body.qpos_of_dof], angles)
        miss = _distance(body, does, posture)
        if miss < least - 1e-3:
            best, least = posture, miss
        if least <= TOUCH_BEFORE_NEXT * size_of(body):
            return None, best
    return least, best

"""What a body can do of a task, sub-task by sub-task, told before anything moves.

A task speaks anatomy, and bodies differ: one has no neck, another's wrist turns half as far. Each
sub-task is `reachable`; or `partly`, with how far short it stays at best, which joint is to blame,
and what would come nearest; or `impossible`, because the body lacks what it names or is too weak.
"""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from primitives import GetPosture, GoToPoint, Place, Primitive, PrimitiveError
from primitives.get_posture import arm_words
from primitives.primitive import FloatArray
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
    posed,
    standing,
)
from specs.binding import bind_task, defined
from specs.conditions import bind_condition
from specs.errors import SpecError
from specs.graph import TaskGraph, build_graph
from specs.lint.nearest import nearest
from specs.reading import Document
from specs.task import SubTask, TaskSpec
from specs.tolerances import TOUCH_BEFORE_NEXT, size_of

Possible = Literal["reachable", "partly", "impossible"]

REFERENCE = "adonis"  # the body that lacks nothing
METRES, RADIANS = 0.02, 0.05  # what a radian of a joint has to save to be to blame [m], [rad]


@dataclass(frozen=True)
class Fitness:
    """What a body can do of one sub-task."""

    subtask: str
    verdict: Possible
    why: str = ""
    short: float | None = None  # of the goal at best
    unit: str = ""  # of that: m or deg
    joint: str | None = None  # which is to blame
    instead: Primitive | None = None  # what comes nearest

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        names = ("subtask", "verdict", "why", "short", "unit", "joint")
        return {name: getattr(self, name) for name in names}


def fitness_of(spec: TaskSpec, body: Body, document: Document | None = None) -> list[Fitness]:
    """What a body can do of each sub-task, in the order of the graph.

    Args:
        spec: the task, fitted to the body.
        body: that is to do it.
        document: what the task was read from, so that errors can say where.

    Raises:
        SpecError: a sub-task makes no sense on any body.
    """
    document = document or Document(None, "")
    graph = build_graph(spec, document)
    body = defined(graph, body, document)
    found = []
    for name in graph.order:
        try:
            beside = standing(body, graph.planned[name][1])
            found.append(_fitness(graph, graph.subtasks[name], beside))
        except (BodyError, PrimitiveError) as problem:
            _check_elsewhere(spec, graph.subtasks[name], document)
            found.append(Fitness(name, "impossible", str(problem)))
    return found


def _check_elsewhere(spec: TaskSpec, subtask: SubTask, document: Document) -> None:
    """What a body that lacks nothing cannot do either is no lack of this one.

    Raises:
        SpecError: that body cannot do it.
    """
    whole = load_body(REFERENCE)
    only = SubTask(name=subtask.name, does=subtask.does)
    alone = {"subtasks": (only,), "background": (), "groups": (), "tempo_map": (), "body": None}
    try:
        bind_task(spec.model_copy(update=alone), whole)
    except SpecError:
        bind_task(spec.model_copy(update={"body": None}), whole, document)


def _fitness(graph: TaskGraph, subtask: SubTask, body: Body) -> Fitness:
    """Of one sub-task.

    Raises:
        BodyError, PrimitiveError: the body lacks something that it names.
    """
    does, name = subtask.does, subtask.name
    for condition in subtask.conditions.values():
        bind_condition(condition, body, [])
    lasts = graph.lasts(name)
    try:
        field = graph.paced(does, graph.planned[name][0], lasts).bind(body, lasts)
    except Unposable as problem:
        return _unposable(name, does, body, problem)
    except BeyondRange as problem:
        return _beyond(name, does, body, problem)
    if isinstance(does, GoToPoint):
        return _reaching(name, does, body)
    if isinstance(does, GetPosture) and hasattr(field, "goal"):
        return _strong(name, body, field.goal, field.claims)
    return Fitness(name, "reachable")


def _reaching(name: str, does: GoToPoint, body: Body) -> Fitness:
    """Of a palm that goes somewhere; where another limb carries the goal, nobody can tell."""
    arm, goal = body.arm(does.limb), does.palm_goal(body)
    limbs = {int(dof) for limb in body.map.limbs for dof in body.joints(limb)}
    if moving_dofs(body, goal.place.link) & limbs:
        return Fitness(name, "reachable")
    tries = [nearest(body, arm, goal.place, way, goal.touched) for way in (goal.normal, None)]
    enough = TOUCH_BEFORE_NEXT * size_of(body)
    if tries[0][0] <= enough:
        return _strong(name, body, tries[0][2][body.qpos_of_dof], arm.dofs)
    short, place, posture = min(tries, key=lambda tried: tried[0])
    if short <= enough:
        return _strong(name, body, posture[body.qpos_of_dof], arm.dofs)
    target = body.at_home(goal.place.link, goal.place.point)

    def miss(angles: FloatArray) -> float:
        qpos = posture.copy()
        qpos[body.qpos_of_dof] = angles
        return float(np.linalg.norm(places_of(body, qpos, [arm.palm])[0] - target))

    joint = joint_to_blame(body, arm.dofs, posture[body.qpos_of_dof], miss, least=METRES)
    x, y, z = (round(float(c), 3) + 0.0 for c in place)
    instead = does.model_copy(update={"to": Place(point=(x, y, z)), "palm": None})
    why = _in_the_way(joint) if joint else f"the arm is {100 * short:.1f} cm too short"
    return Fitness(name, "partly", why, short, "m", joint, instead)


def _unposable(name: str, does: Primitive, body: Body, problem: Unposable) -> Fitness:
    """Of an arm that cannot be held as is said."""
    if not isinstance(does, GetPosture) or isinstance(does.posture, str) or does.limb is None:
        return Fitness(name, "impossible", str(problem))
    arm, words = body.arm(does.limb), arm_words(body, does.posture)
    home = body.home[body.qpos_of_dof]

    def miss(angles: FloatArray) -> float:
        return off_words(body, arm, posed(body, angles), words)

    angles = np.where(np.isnan(problem.nearest), home, problem.nearest)
    joint = joint_to_blame(body, arm.dofs, angles, miss, least=RADIANS)
    degrees = {
        body.dof_name(int(d)): round(float(np.rad2deg(angles[d])), 1) + 0.0 for d in arm.dofs
    }
    instead = does.model_copy(update={"posture": degrees, "via": ()})
    short = float(np.rad2deg(problem.off))
    why = _in_the_way(joint) if joint else "the joints of this arm do not turn it so"
    return Fitness(name, "partly", why, short, "deg", joint, instead)


def _beyond(name: str, does: Primitive, body: Body, problem: BeyondRange) -> Fitness:
    """Of a joint that is to go past the end of its range."""
    if not isinstance(does, GetPosture) or isinstance(does.posture, str) or does.via:
        return Fitness(name, "impossible", str(problem))
    low, high = (np.rad2deg(limit) for limit in body.range)
    within, worst, blamed = dict(does.posture), 0.0, None
    for joint, angle in does.posture.items():
        if not isinstance(angle, float | int):
            continue
        own = joint
        if does.limb is not None and f"{body.arm(does.limb).limb.side}_{joint}" in (
            body.arm(does.limb).limb.joints
        ):
            own = f"{body.arm(does.limb).limb.side}_{joint}"
        dofs = body.joints(own)
        held = float(np.clip(angle, low[dofs].max(), high[dofs].min()))
        within[joint] = held
        if abs(held - angle) > worst:
            worst, blamed = abs(held - angle), own
    instead = does.model_copy(update={"posture": within})
    return Fitness(name, "partly", str(problem), worst, "deg", blamed, instead)


def _strong(name: str, body: Body, angles: FloatArray, claims: Any) -> Fitness:
    """Of a posture (nv,) [rad]: whether the motors of some joints can hold it up."""
    still = np.zeros((1, body.nv))
    _, weight = inverse_dynamics(body, angles[None], still, still)
    share = np.abs(weight[0, claims]) / np.maximum(body.torque_limit[claims], 1e-9)
    if not len(share) or share.max() <= 1.0:
        return Fitness(name, "reachable")
    dof = int(claims[int(share.argmax())])
    joint = body.dof_name(dof)
    needed, has = abs(weight[0, dof]), body.torque_limit[dof]
    why = f"{joint} has {has:.3g} of the {needed:.3g} N m that hold it up: it will sink"
    return Fitness(name, "partly", why, joint=joint)


def _in_the_way(joint: str) -> str:
    return f"{joint} is at its end"

"""What a body can do of a task, sub-task by sub-task, told before anything moves.

A task speaks anatomy, and bodies differ: one has no neck, another's wrist turns half as far. Each
sub-task is `reachable`, within what the judge allows; or `partly`, with how far short it stays at
best, which joint is to blame, and what would come nearest; or `impossible`, because the body lacks
what it names.
"""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from primitives import GetPosture, GoToPoint, Place, Primitive, PrimitiveError
from primitives.get_posture import arm_words
from primitives.primitive import FloatArray
from sim import (
    Arm,
    BeyondRange,
    Body,
    BodyError,
    Unposable,
    inverse_dynamics,
    joint_to_blame,
    load_body,
    off_words,
    places_of,
    posed,
    standing,
)
from specs.binding import bind_task, defined, nothing_to_move
from specs.conditions import bind_condition
from specs.errors import SpecError
from specs.graph import TaskGraph, build_graph
from specs.lint.nearest import best, inside
from specs.reading import Document
from specs.task import SubTask, TaskSpec
from specs.tolerances import ANGLE, PALM_ANGLE, TOUCH_BEFORE_NEXT, size_of

Possible = Literal["reachable", "partly", "impossible"]

REFERENCE = "adonis"  # the body that lacks nothing
ALLOWED = {"arm": ANGLE, "elbow": ANGLE, "palm": PALM_ANGLE}  # of a posture, by the judge [deg]
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
    if lacks := nothing_to_move(does, body):
        return Fitness(name, "impossible", lacks)
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
    arm, goal = body.arm(does.limb), does.palm_goal(body).place
    enough = TOUCH_BEFORE_NEXT * size_of(body)
    limbs = {int(dof) for limb in body.map.limbs for dof in body.joints(limb)}
    sunk, link = inside(body, arm, goal, limbs)
    found = best(body, does, limbs, link if sunk <= enough else "")
    if found.posture is None:  # it is on the arm itself, or on another limb
        if found.miss <= enough:
            return Fitness(name, "reachable")
        return Fitness(name, "partly", "no arm bends so far onto itself", found.miss, "m")
    posture = found.posture[body.qpos_of_dof]
    if found.miss <= enough or found.place is None:
        return _strong(name, body, posture, arm.dofs)
    target = body.at_home(goal.link, goal.point)

    def miss(angles: FloatArray) -> float:
        qpos = body.home.copy()
        qpos[body.qpos_of_dof] = angles
        return float(np.linalg.norm(places_of(body, qpos, [arm.palm])[0] - target))

    joint = joint_to_blame(body, arm.dofs, posture, miss, least=METRES)
    _, palm, _, upper_arm = body.palm_goal(arm, posture)
    held = {"palm": _rounded(palm), "upper_arm": _rounded(upper_arm)}
    instead = does.model_copy(update={"to": Place(point=_rounded(found.place)), **held})
    why = _in_the_way(joint) if joint else _no_joint(body, arm, target, found.miss)
    return Fitness(name, "partly", why, found.miss, "m", joint, instead)


def _rounded(vector: FloatArray) -> tuple[float, float, float]:
    """As one would write it."""
    x, y, z = (round(float(c), 3) + 0.0 for c in vector)
    return x, y, z


def _no_joint(body: Body, arm: Arm, target: FloatArray, short: float) -> str:
    """Why a palm stays short if no end of a joint is in the way."""
    shoulder = body.at_home(arm.upper_arm, np.zeros(3))
    lacks = float(np.linalg.norm(target - shoulder)) - body.reach(arm)
    if lacks > 0.5 * short:
        return f"the arm is {100 * lacks:.1f} cm too short"
    return "its own body is in the way"


def _unposable(name: str, does: Primitive, body: Body, problem: Unposable) -> Fitness:
    """Of an arm that cannot be held as is said."""
    if not isinstance(does, GetPosture) or isinstance(does.posture, str) or does.limb is None:
        return Fitness(name, "impossible", str(problem))
    arm, words = body.arm(does.limb), arm_words(body, does.posture)
    home = body.home[body.qpos_of_dof]

    def off(angles: FloatArray) -> dict[str, float]:
        return off_words(body, arm, posed(body, angles), words)

    def miss(angles: FloatArray) -> float:
        return max(off(angles).values())

    angles = np.where(np.isnan(problem.nearest), home, problem.nearest)
    joint = joint_to_blame(body, arm.dofs, angles, miss, least=RADIANS)
    degrees = {
        body.dof_name(int(d)): round(float(np.rad2deg(angles[d])), 1) + 0.0 for d in arm.dofs
    }
    instead = does.model_copy(update={"posture": degrees, "via": ()})
    parts = {part: float(np.rad2deg(by)) for part, by in off(angles).items()}
    over = {part: by for part, by in parts.items() if by > ALLOWED[part]}
    why = _in_the_way(joint) if joint else "the joints of this arm do not turn it so"
    if not over:
        said = _within(why, max(parts, key=lambda part: parts[part]))
        return Fitness(name, "reachable", said, max(parts.values()), "deg", joint, instead)
    worst = max(over, key=lambda part: over[part])
    return Fitness(name, "partly", f"{worst}: {why}", over[worst], "deg", joint, instead)


def _within(why: str, part: str) -> str:
    return f"{why}; within the {ALLOWED[part]:.0f}° that are allowed"


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
    verdict: Possible = "partly" if worst > ANGLE else "reachable"
    why = str(problem) if worst > ANGLE else _within(str(problem), "elbow")
    return Fitness(name, verdict, why, worst, "deg", blamed, instead)


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

"""How near a palm comes to a place at best, by inverse kinematics and by leaning on the body."""

import numpy as np

from primitives import GoToPoint, Place
from primitives.posture_field import PostureField
from primitives.primitive import FloatArray
from sim import (
    Arm,
    Body,
    PalmGoal,
    Spot,
    World,
    axes_of,
    moving_dofs,
    origin,
    places_of,
    reach,
)
from specs.binding import BoundTask
from specs.lint.move import from_posture
from specs.tolerances import TOUCH_BEFORE_NEXT, size_of

ANGLE = 1e-3  # [rad] as good as at home
SAMPLES, ROUNDS = 256, 12  # postures that are tried at once, and how often the search narrows

ORIGIN: FloatArray = np.zeros(3)
Best = tuple[float, FloatArray | None]  # miss [m], and the nearest place (3,), if it is known
AT_EASE = 1.0  # [s] in which a palm that is held at its goal comes to rest


def best(body: Body, does: GoToPoint, away: set[int], pressed: str) -> Best:
    """By how much a palm misses its goal at best, and where it then is, seen from the trunk.

    A link that is `pressed`, the goal being a little inside it, may be touched.
    Where the goal moves with joints that the task moves away from home, nobody can tell: 0.
    """
    arm = body.arm(does.limb)
    goal = does.hand_goal(body, arm).places[-1]
    between = moving_dofs(body, goal.link) ^ moving_dofs(body, arm.root)
    if between & set(arm.dofs.tolist()):
        return miss_itself(body, arm, goal), None
    if between & away:
        return 0.0, None
    touched = body.link(pressed) if pressed else -1
    least, where, allowed = np.inf, None, TOUCH_BEFORE_NEXT * size_of(body)
    for normal in _facings(body, does, goal):
        miss, there, posture = nearest(body, arm, goal, normal, touched)
        if miss <= allowed and not body.is_free(posture):
            miss, there = held_there(body, does, normal, posture)
        if miss < least:
            least, where = miss, there
        if least <= allowed:
            break
    return least, where


def _facings(body: Body, does: GoToPoint, goal: Spot) -> list[FloatArray | None]:
    """Ways in which a palm may face (3,): onto the landmark that is named, or any."""
    mark = does.to if isinstance(does.to, str) else does.to.near
    if mark is None:
        return [None]
    return [body.from_link(goal.link, -body.landmark(mark).normal), None]


def held_there(
    body: Body, does: GoToPoint, normal: FloatArray | None, posture: FloatArray
) -> tuple[float, FloatArray]:
    """By how much a palm misses that springs hold at its goal, and where it is from the trunk (3,).

    Inverse kinematics keeps apart what must not touch, and lets an upper arm into the ribs.

    Args:
        body: whose palm.
        does: what it is to do.
        normal: where it faces (3,); None leaves that open.
        posture: (nq,) in which it would be at its goal.
    """
    to = Place(near=does.to) if isinstance(does.to, str) else does.to
    facing = None if normal is None else (float(normal[0]), float(normal[1]), float(normal[2]))
    held = GoToPoint(limb=does.limb, to=to, palm=facing)
    move, arm = from_posture(body, held, posture, AT_EASE), body.arm(does.limb)
    if move is None:
        return 0.0, ORIGIN
    rest = move.foreseen.qpos[-1]
    palm, trunk = places_of(body, rest, [arm.palm, origin(arm.root)])
    return move.short(move.foreseen), axes_of(body, rest, arm.root).T @ (palm - trunk)


def nearest(
    body: Body, arm: Arm, goal: Spot, normal: FloatArray | None, touched: int = -1
) -> tuple[float, FloatArray, FloatArray]:
    """By how much a palm misses, where it is from the trunk (3,), and the posture (nq,).

    All other joints are at home.

    Args:
        body: whose palm.
        arm: its arm.
        goal: where it is to be.
        normal: where it faces (3,); None leaves that open.
        touched: the link that it may touch.
    """
    place, shoulder = body.at_home(goal.link, goal.point), body.at_home(arm.upper_arm, ORIGIN)
    far, long = float(np.linalg.norm(place - shoulder)), body.reach(arm)
    if far > long:  # no farther out than the arm is long, in the same direction
        within = shoulder + (place - shoulder) * long / far
        goal = Spot(
            arm.root, body.to_link(arm.root, within - body.at_home(arm.root, ORIGIN)), ORIGIN
        )
    postures, _ = reach(body, arm, [PalmGoal(goal, normal=normal, touched=touched)])
    qpos = body.home.copy()
    qpos[body.qpos_of_dof[arm.dofs]] = postures[0, arm.dofs]
    palm = places_of(body, qpos, [arm.palm])[0]
    miss = float(np.linalg.norm(palm - place))
    return miss, palm - body.at_home(arm.root, ORIGIN), qpos


def miss_itself(body: Body, arm: Arm, goal: Spot) -> float:
    """By how much a palm misses a place on its own arm at best [m]: a search that narrows."""
    rng = np.random.default_rng(0)
    world, columns = World(body, SAMPLES), body.qpos_of_dof[arm.dofs]
    low, high = (np.clip(limit[arm.dofs], -np.pi, np.pi) for limit in body.range)
    tried = rng.uniform(low, high, (SAMPLES, len(columns)))
    best, least = tried[0], np.inf
    for narrowing in range(ROUNDS):
        qpos = np.tile(body.home, (SAMPLES, 1))
        qpos[:, columns] = tried
        world.reset(qpos)
        palm, place = (
            world.state.xpos[:, spot.link]
            + world.state.xmat[:, spot.link].reshape(-1, 3, 3) @ spot.point
            for spot in (arm.palm, goal)
        )
        misses = np.linalg.norm(palm - place, axis=1)
        if misses.min() < least:
            best, least = tried[misses.argmin()], float(misses.min())
        spread = 0.5 ** (narrowing + 1) * (high - low)
        tried = np.clip(rng.normal(best, spread, tried.shape), low, high)
    return least


def moved_from_home(task: BoundTask) -> set[int]:
    """The degrees of freedom that the task moves away from home, or may."""
    body = task.body
    home = body.home[body.qpos_of_dof]
    away = {int(dof) for field in task.fields for dof in field.claims}
    away |= set(np.flatnonzero(task.start[body.qpos_of_dof] != home).tolist())
    for field in task.background:
        if isinstance(field, PostureField):
            off = np.abs(field.goal - home)[field.claims] > ANGLE
            away |= set(field.claims[off].tolist())
    return away

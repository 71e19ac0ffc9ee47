"""How near a palm comes to a place at best, by inverse kinematics and by leaning on the body."""

from typing import NamedTuple

import numpy as np

from primitives import GoToPoint, Place
from primitives.posture_field import PostureField
from primitives.primitive import FloatArray
from sim import (
    Arm,
    Body,
    BodyError,
    PalmGoal,
    Spot,
    World,
    axes_of,
    depth_inside,
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
AT_EASE = 1.0  # [s] in which a palm that is held at its goal comes to rest


class Best(NamedTuple):
    """How near a palm comes to its goal."""

    miss: float  # [m]
    place: FloatArray | None = None  # where it then is, seen from the trunk (3,), if it is known
    posture: FloatArray | None = None  # in which it is there (nq,)


def best(body: Body, does: GoToPoint, away: set[int], pressed: str) -> Best:
    """How near a palm comes to its goal at best.

    A link that is `pressed`, the goal being a little inside it, may be touched.
    Where the goal moves with joints that may be `away` from home, nobody can tell: it misses by 0.
    """
    arm = body.arm(does.limb)
    goal = does.hand_goal(body, arm).places[-1]
    between = moving_dofs(body, goal.link) ^ moving_dofs(body, arm.root)
    if between & set(arm.dofs.tolist()):
        return Best(miss_itself(body, arm, goal))
    if between & away:
        return Best(0.0)
    touched = body.link(pressed) if pressed else -1
    found, allowed = Best(np.inf), TOUCH_BEFORE_NEXT * size_of(body)
    for normal in _facings(body, does, goal):
        near = nearest(body, arm, goal, normal, touched)
        if near.miss <= allowed and near.posture is not None and not body.is_free(near.posture):
            near = held_there(body, does, normal, near.posture)
        if near.miss < found.miss:
            found = near
        if found.miss <= allowed:
            break
    return found


def inside(body: Body, arm: Arm, goal: Spot, away: set[int]) -> tuple[float, str]:
    """How deep a goal lies in a link that the hand cannot enter [m], and in which."""
    own = {body.model.body(link).name for link in arm.links}
    pairs = [pair for pair in body.map.keep_apart if arm.limb.hand in pair]
    links = {link for pair in pairs for link in pair} - own
    links |= {body.model.body(goal.link).name} - own - {"world"}
    fixed = [
        link for link in sorted(links)
        if not (moving_dofs(body, body.link(link)) ^ moving_dofs(body, goal.link)) & away
    ]  # fmt: skip
    try:
        return depth_inside(body, body.home, body.at_home(goal.link, goal.point), fixed)
    except BodyError:
        return 0.0, ""


def _facings(body: Body, does: GoToPoint, goal: Spot) -> list[FloatArray | None]:
    """Ways in which a palm may face (3,): onto the landmark that is named, or any."""
    mark = does.to if isinstance(does.to, str) else does.to.near
    if mark is None:
        return [None]
    return [body.from_link(goal.link, -body.landmark(mark).normal), None]


def held_there(body: Body, does: GoToPoint, normal: FloatArray | None, posture: FloatArray) -> Best:
    """How near a palm comes that springs hold at its goal.

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
        return Best(0.0, ORIGIN, posture)
    rest = move.foreseen.qpos[-1]
    palm, trunk = places_of(body, rest, [arm.palm, origin(arm.root)])
    place = axes_of(body, rest, arm.root).T @ (palm - trunk)
    return Best(move.short(move.foreseen), place, rest)


def nearest(body: Body, arm: Arm, goal: Spot, normal: FloatArray | None, touched: int = -1) -> Best:
    """How near a palm comes, all other joints being at home.

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
    return Best(miss, palm - body.at_home(arm.root, ORIGIN), qpos)


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

"""out-of-reach, inside-body: goals that no posture of the body brings the palm to."""

from collections.abc import Sequence

import numpy as np

from primitives import GoToPoint
from primitives.posture_field import PostureField
from primitives.primitive import FloatArray
from sim import (
    Arm,
    Body,
    BodyError,
    PalmGoal,
    Spot,
    World,
    depth_inside,
    moving_dofs,
    places_of,
    reach,
)
from specs.binding import BoundTask
from specs.lint.collisions import is_free
from specs.lint.course import Move
from specs.lint.finding import Finding, Places, cm, point
from specs.tolerances import TOUCH_BEFORE_NEXT, size_of

ANGLE = 1e-3  # [rad] as good as at home
ARRIVED = 0.005  # [m] from the goal
SAMPLES, ROUNDS = 256, 12  # postures that are tried at once, and how often the search narrows

ORIGIN: FloatArray = np.zeros(3)
Best = tuple[float, FloatArray | None]  # miss [m], and the nearest place (3,), if it is known


def out_of_reach(task: BoundTask, places: Places, moves: Sequence[Move]) -> list[Finding]:
    """Goals of go-to-point that lie inside the body, or where the arm cannot go.

    A way that was found and ends at the goal, beside the body, needs no further search.
    """
    arrive = {m.name for m in moves if m.short < ARRIVED and is_free(task.body, m, m.way[-1:])}
    body, found = task.body, []
    away, allowed = moved_from_home(task), TOUCH_BEFORE_NEXT * size_of(task.body)
    known: dict[object, tuple[float, str, Best]] = {}
    for name in task.graph.order:
        does = task.graph.subtasks[name].does
        if not isinstance(does, GoToPoint) or name in arrive:
            continue
        arm = body.arm(does.limb)
        goal = does.hand_goal(body, arm).places[-1]
        key = arm.name, repr(does.to), does.palm
        if key not in known:
            sunk, link = _inside(body, arm, goal, away)
            fits = (0.0, None) if sunk > allowed else best(task, does, away, link)
            known[key] = sunk, link, fits
        sunk, link, (miss, nearest) = known[key]
        if sunk > allowed:
            found.append(
                places.finding(
                    "error", "inside-body", name,
                    f"the goal is {cm(sunk)} inside the {link} of {body.map.name}",
                    f"move it out by {cm(sunk)} or more, or name a landmark of the surface",
                    "to", depth=sunk, link=link,
                )
            )  # fmt: skip
        elif miss > allowed:
            said = "bring the goal nearer, or let the waist help"
            if nearest is not None:
                said = f"the nearest place that it reaches is {point(nearest)}"
            found.append(
                places.finding(
                    "error", "out-of-reach", name,
                    f"at best the palm of {body.map.name} stays {cm(miss)} short of the goal",
                    said, "to", short=miss,
                    nearest=None if nearest is None else [round(float(x), 4) for x in nearest],
                )
            )  # fmt: skip
    return found


def best(task: BoundTask, does: GoToPoint, away: set[int], pressed: str) -> Best:
    """By how much a palm misses its goal at best, and where it then is, seen from the trunk.

    A link that is `pressed`, the goal being a little inside it, may be touched.
    Where the goal moves with joints that the task moves away from home, nobody can tell: 0.
    """
    body, arm = task.body, task.body.arm(does.limb)
    goal = does.hand_goal(body, arm).places[-1]
    between = moving_dofs(body, goal.link) ^ moving_dofs(body, arm.root)
    if between & set(arm.dofs.tolist()):
        return miss_itself(body, arm, goal), None
    if between & away:
        return 0.0, None
    touched = body.link(pressed) if pressed else -1
    return nearest(body, arm, goal, does.to if isinstance(does.to, str) else None, touched)


def nearest(body: Body, arm: Arm, goal: Spot, faced: str | None, touched: int = -1) -> Best:
    """The same with all other joints at home; a landmark is faced if possible."""
    normals: list[FloatArray | None] = [None]
    if faced is not None:
        normals = [body.from_link(goal.link, -body.landmark(faced).normal), None]
    place, shoulder = body.at_home(goal.link, goal.point), body.at_home(arm.upper_arm, ORIGIN)
    far, long = float(np.linalg.norm(place - shoulder)), body.reach(arm)
    if far > long:  # no farther out than the arm is long, in the same direction
        within = shoulder + (place - shoulder) * long / far
        goal = Spot(
            arm.root, body.to_link(arm.root, within - body.at_home(arm.root, ORIGIN)), ORIGIN
        )
    least, where = np.inf, None
    for normal in normals:
        postures, _ = reach(body, arm, [PalmGoal(goal, normal=normal, touched=touched)])
        qpos = body.home.copy()
        qpos[body.qpos_of_dof[arm.dofs]] = postures[0, arm.dofs]
        palm = places_of(body, qpos, [arm.palm])[0]
        miss = float(np.linalg.norm(palm - place))
        if miss < least:
            least, where = miss, palm - body.at_home(arm.root, ORIGIN)
        if least <= TOUCH_BEFORE_NEXT * size_of(body):
            break
    return least, where


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


def _inside(body: Body, arm: Arm, goal: Spot, away: set[int]) -> tuple[float, str]:
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

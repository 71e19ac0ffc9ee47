"""Doubts: what can be known to fail without simulating."""

import numpy as np

from primitives import GoToPoint, Place
from primitives.posture_field import PostureField
from primitives.primitive import FloatArray
from primitives.reach_field import ReachField
from sim import Arm, Body, PalmGoal, Spot, World, moving_dofs, reach
from specs.binding import BoundTask

MISS = 0.015  # a palm that stays farther than this from its goal does not reach it [m]
ANGLE = 1e-3  # [rad] as good as at home
SAMPLES, ROUNDS = 256, 12  # postures that are tried at once, and how often the search narrows


def doubts(task: BoundTask) -> list[str]:
    """Goals that the arm cannot reach, one sentence each."""
    found: list[str] = []
    known: dict[object, float] = {}
    for name, field in zip(task.graph.order, task.fields, strict=True):
        far = field.too_far() if isinstance(field, ReachField | PostureField) else 0.0
        if far > MISS or (far > 0.0 and isinstance(field, PostureField)):
            found.append(
                f"{name}: the goal is {_cm(far)} farther from the shoulder than"
                f" the arm of {task.body.map.name} is long"
            )
            continue
        does = task.graph.subtasks[name].does
        if not isinstance(field, ReachField) or not isinstance(does, GoToPoint):
            continue
        goal, arm = field.places[-1], task.body.arm(does.limb)
        key = arm.name, does.to, goal.link, tuple(goal.point)
        if key not in known:
            known[key] = _miss(task, arm, goal, does.to)
        if known[key] > MISS:
            found.append(
                f"{name}: at best the palm of {task.body.map.name} stays {_cm(known[key])} short of"
                " the goal"
            )
    return found


def _miss(task: BoundTask, arm: Arm, goal: Spot, to: str | Place) -> float:
    """By how much a palm misses a goal at best [m]; 0 where that depends on other joints."""
    body = task.body
    between = moving_dofs(body, goal.link) ^ moving_dofs(body, arm.root)
    if between & set(arm.dofs.tolist()):
        return _miss_itself(body, arm, goal)
    if between & _away(task):
        return 0.0
    normals: list[FloatArray | None] = [None]
    if isinstance(to, str):  # facing the surface as it should; else just anyhow
        normals = [body.from_link(goal.link, -body.landmark(to).normal), None]
    least = np.inf
    for normal in normals:
        _, misses = reach(body, arm, [PalmGoal(goal, normal=normal)])
        least = min(least, float(misses[0]))
        if least <= MISS:
            break
    return least


def _away(task: BoundTask) -> set[int]:
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


def _miss_itself(body: Body, arm: Arm, goal: Spot) -> float:
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


def _cm(distance: float) -> str:
    return f"{100.0 * distance:.1f} cm"

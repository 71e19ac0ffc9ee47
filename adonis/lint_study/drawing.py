"""What the tries of the lint share: tasks that are drawn at random, and what became of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from adonis.dancing import random_start, run_task
from primitives import CompensateGravity, GetPosture, GoToPoint, Place, Primitive
from sim import Body, Recording
from specs import Background, BoundTask, Finding, Group, SubTask, TaskSpec, bind_task

FloatArray = NDArray[np.float64]

STARTS = 8
AMPLE = 4.0  # [s]
CALM = 1.5  # [s] for ways that are looked at for collisions
MARKS = ("head.back", "head.right", "head.front", "chest.front", "belly.front", "left_ribs",
         "right_ribs", "left_hip", "right_hip", "left_shoulder.top",
         "right_shoulder.top")  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One task: what the lint said, and what was true."""

    kind: str
    seed: int
    said: bool
    true: bool
    # Of a finding that says what to do instead: whether that works, and (of a time) whether
    # less does not.
    advice: tuple[bool, ...] = ()


def task_of(
    body: Body,
    subtasks: Sequence[SubTask],
    beside: Sequence[Background] = (),
    groups: tuple[Group, ...] = (),
) -> BoundTask:
    """Sub-tasks on a body that stands upright, its weight being carried, with more beside."""
    upright = "waist" if any(b.name == "stays" for b in beside) else ("waist", "neck")
    names = (upright,) if isinstance(upright, str) else upright
    background = (
        Background(name="upright", does=GetPosture(joints=names, posture="upright")),
        Background(name="arms", does=GetPosture(joints=("right_arm", "left_arm"), posture="rest")),
        Background(name="weight", does=CompensateGravity()),
        *beside,
    )
    spec = TaskSpec(
        task="lint", coda=0.5, background=background, groups=groups, subtasks=tuple(subtasks)
    )
    return bind_task(spec, body)


def posture(body: Body, rng: np.random.Generator, group: str = "right_arm") -> GetPosture:
    """Anywhere within nine tenths of the ranges."""
    low, high = (np.rad2deg(limit) for limit in body.range)
    dofs = body.joints(group).tolist()
    posture = {body.dof_name(d): float(0.9 * rng.uniform(low[d], high[d])) for d in dofs}
    return (
        GetPosture(joints=tuple(posture), posture=dict(posture))
        if group == "neck"
        else (GetPosture(limb=group, posture=dict(posture)))
    )


def several_starts(task: BoundTask, seed: int) -> FloatArray:
    """Home, and some postures of the arms that touch nothing."""
    others = random_start(task.body, task.start, STARTS - 1, seed)
    whole: FloatArray = np.vstack([task.start, others])
    return whole


def run(task: BoundTask, start: FloatArray | None = None) -> tuple[Recording, ...]:
    """Recordings of a task from the task's own start, or from others (nq,) or (n, nq)."""
    n = 1 if start is None or start.ndim == 1 else len(start)
    return run_task(task, n=n, threads=min(n, 2), start=start, contributions=False)


def has(findings: Sequence[Finding], *codes: str) -> bool:
    """Whether any of them is of one of these kinds."""
    return any(f.code in codes for f in findings)


def _vector(values: FloatArray) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z


def timed(body: Body, does: Primitive, seconds: float) -> BoundTask:
    """One sub-task that takes so long."""
    return task_of(body, [SubTask(name="go", does=does, seconds=seconds)])


def goal(body: Body, rng: np.random.Generator) -> GoToPoint:
    """A goal of the right hand: near a landmark, or anywhere in front."""
    arm = body.arm("right_arm")
    if rng.random() < 0.4:
        place = Place(near=str(rng.choice(MARKS)), away=float(rng.uniform(-0.08, 0.12)))
        return GoToPoint(limb=arm.name, to=place)
    shoulder = body.at_home(arm.upper_arm, np.zeros(3)) - body.at_home(arm.root, np.zeros(3))
    way = rng.standard_normal(3)
    way[0] = abs(way[0])
    far = rng.uniform(0.6, 1.15) * body.reach(arm) * way / np.linalg.norm(way)
    return GoToPoint(limb=arm.name, to=Place(point=_vector(shoulder + far)))

"""Goals of a hand, near and beyond its reach, or in the body."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from adonis.judging import judge
from adonis.lint_study.drawing import AMPLE, Case, goal, has, run, several_starts, task_of
from primitives import GoToPoint, Place, ViaPlace
from sim import Body, Recording
from specs import BoundTask, SubTask, TaskSpec, bind_task, lint_task
from specs.tolerances import TOUCH_BEFORE_NEXT

FloatArray = NDArray[np.float64]

OUTSIDE = 0.20  # [m] from the surface, a via point


def try_goal(body: Body, seed: int) -> Case:
    """A goal of the right hand, near and beyond its reach, or in the body."""
    rng = np.random.default_rng(seed)
    task = task_of(body, [SubTask(name="go", does=goal(body, rng), seconds=AMPLE)])
    said = has(lint_task(task), "out-of-reach", "inside-body")
    return Case("out of reach", seed, said, not _reached(task, seed))


def _reached(task: BoundTask, seed: int) -> bool:
    """Whether any of several starts and ways of doing it brings the palm to its goal."""
    starts, does = several_starts(task, seed), task.spec.subtasks[0].does
    assert isinstance(does, GoToPoint)
    ways: list[dict[str, Any]] = [{}, {"controller": "pd-servo"}]
    if isinstance(does.to, Place) and does.to.near is not None:  # from outside, and facing it
        outside = ViaPlace(near=does.to.near, away=OUTSIDE)
        inwards = tuple(-task.body.from_link(*_normal(task.body, does.to.near)))
        ways.append({"via": (outside,), "palm": inwards})
    for way in ways:
        changed = does.model_copy(update=way)
        subtask = task.spec.subtasks[0].model_copy(update={"does": changed})
        spec = task.spec.model_copy(update={"subtasks": (subtask,)})
        runs = run(bind_task(spec, task.body), starts)
        if min(_last_measure(r, spec) for r in runs) <= TOUCH_BEFORE_NEXT:
            return True
    return False


def _normal(body: Body, landmark: str) -> tuple[int, FloatArray]:
    spot = body.landmark(landmark)
    return spot.link, spot.normal


def _last_measure(recording: Recording, spec: TaskSpec) -> float:
    """How far the palm is from its goal in the end [m]."""
    (verdict,) = judge(recording, spec).verdicts
    return float(verdict.measures[-1].value)

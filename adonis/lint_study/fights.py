"""Postures in the background that do not give way to that of a sub-task."""

from typing import Any

import numpy as np

from adonis.lint_study.drawing import AMPLE, Case, has, posture, run, task_of
from primitives import GetPosture
from sim import Body, Replay
from specs import Background, Group, SubTask, lint_task

SETTLED = 0.5  # [deg] off where a joint was asked to be


def try_fight(body: Body, seed: int) -> Case:
    """A posture in the background that does not give way to that of a sub-task."""
    rng = np.random.default_rng(seed)
    wanted = posture(body, rng, "neck")
    assert isinstance(wanted.posture, dict)
    off = float(rng.choice((0.3, 5.0, 15.0)))
    other = {k: float(a) - off * np.sign(float(a)) for k, a in wanted.posture.items()
             if not isinstance(a, str | tuple)}  # fmt: skip
    stays = Background(name="stays", does=GetPosture(joints=("neck",), posture=dict(other)))
    rule = str(rng.choice(("sum", "dominant", "none")))
    groups: tuple[Group, ...] = ()
    if rule != "none":
        weights: dict[str, Any] = {"weights": {"go": 2.0}} if rule == "dominant" else {}
        group = {"name": "both", "rule": rule, "members": ("go", "stays"), **weights}
        groups = (Group.model_validate(group),)
    task = task_of(body, [SubTask(name="go", does=wanted, seconds=AMPLE)], (stays,), groups)
    said = has(lint_task(task), "fight")
    (recording,) = run(task)
    replay, end = Replay(recording), recording.row(AMPLE)
    missed = [abs(np.rad2deg(replay.angle(j)[end]) - float(a)) for j, a in wanted.posture.items()
              if not isinstance(a, str | tuple)]  # fmt: skip
    return Case("fight", seed, said, max(missed) > SETTLED)

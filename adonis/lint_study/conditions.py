"""Sub-tasks that begin only near a landmark, to which the hand is sent before."""

import numpy as np

from adonis.lint_study.drawing import AMPLE, Case, run, several_starts, task_of
from primitives import GetPosture, GoToPoint, Place, Primitive
from sim import Body, World
from specs import Condition, SubTask, lint_task

DRAWN, ROUNDS = 256, 8  # postures that are drawn at a time, and how often


def try_condition(body: Body, seed: int) -> Case:
    """A sub-task that begins only near a landmark, to which the hand is sent before."""
    rng = np.random.default_rng(seed)
    own = bool(rng.random() < 0.6)
    mark = "right_elbow.inside" if own else str(rng.choice(("left_hip", "right_hip", "head.back")))
    distance = float(rng.uniform(0.1, 0.4) if own else rng.uniform(0.02, 0.2))
    near = Condition(near=mark, limb="right_arm", distance=distance)
    send: Primitive = GoToPoint(limb="right_arm", to=Place(near=mark))
    if own:
        send = GetPosture(limb="right_arm", posture=_folded(body, mark, rng))
    rest = GetPosture(limb="right_arm", posture="rest")
    subtasks = [
        SubTask(name="send", does=send, seconds=AMPLE),
        SubTask(name="then", does=rest, seconds=1.0, if_=near),
    ]
    task = task_of(body, subtasks)
    said = any(f.subtask == "then" and f.code == "never" for f in lint_task(task))
    runs = run(task, several_starts(task, seed))
    begun = any(s.outcome == "done" for r in runs for s in r.spans if s.name == "then")
    return Case("never", seed, said, not begun)


def _folded(body: Body, mark: str, rng: np.random.Generator) -> dict[str, float]:
    """Angles [deg] that bring the right palm as near to a mark on its own arm as it gets.

    They are drawn at random, then ever nearer to the best so far.
    """
    arm, spot = body.arm("right_arm"), body.landmark(mark)
    dofs, world = body.joints("right_arm"), World(body, DRAWN)
    low, high = (side[dofs] for side in body.range)
    best, spread = 0.5 * (low + high), 0.5 * (high - low)
    for _ in range(ROUNDS):
        drawn = np.clip(best + spread * rng.uniform(-1.0, 1.0, (DRAWN, len(dofs))), low, high)
        drawn[0] = best
        qpos = np.tile(body.home, (DRAWN, 1))
        qpos[:, body.qpos_of_dof[dofs]] = drawn
        world.reset(qpos)
        palm, place = (
            world.state.xpos[:, on.link] + world.state.xmat[:, on.link].reshape(-1, 3, 3) @ on.point
            for on in (arm.palm, spot)
        )
        best = drawn[np.argmin(np.linalg.norm(palm - place, axis=1))]
        spread = 0.5 * spread
    return {body.dof_name(int(j)): float(np.rad2deg(q)) for j, q in zip(dofs, best, strict=True)}

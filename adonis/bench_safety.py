"""What the safety filter costs: a step of a task with it against one without, in turns."""

import time
from collections.abc import Callable

import numpy as np

from adonis.safety_study import Safety, attack
from arbiter import Arbiter
from primitives import CompensateGravity, GetPosture
from sim import Body, World
from specs import Background, SubTask, TaskSpec, bind_task, load_task

TURN = 50  # steps
SEED = 1  # of the attack


def safety(body: Body, tell: Callable[[str], None]) -> dict[str, dict[str, float]]:
    """Three tasks, at n = 1: nothing is near, a dance, an attack on all limits.

    Args:
        body: who does them.
        tell: told what is being measured.
    """
    dance, _ = load_task("macarena")
    tasks = {
        "nothing near": _far(),
        "the Macarena": dance,
        "an attack": attack(body, SEED, "filter"),
    }
    found = {}
    for name, spec in tasks.items():
        tell(f"the safety filter: {name}")
        found[name] = _in_turns(body, spec)
    return found


def _far() -> TaskSpec:
    """An arm that moves where it meets nothing."""
    arms = {
        side: GetPosture(limb=f"{side}_arm", posture={f"{side}_arm": 20.0})
        for side in ("right", "left")
    }
    upright = GetPosture(joints=("waist", "neck"), posture="upright")
    return TaskSpec(
        task="far",
        background=(
            Background(name="weight", does=CompensateGravity()),
            Background(name="upright", does=upright),
            Background(name="left", does=arms["left"]),
        ),
        subtasks=(SubTask(name="right", does=arms["right"], seconds=2.0),),
    )


def _in_turns(body: Body, spec: TaskSpec) -> dict[str, float]:
    """Both kinds, in turns of a few steps: [us per step] and the median of the turns' ratios."""
    kinds: tuple[Safety, ...] = ("none", "filter")
    pairs = []
    for kind in kinds:
        task = bind_task(spec.model_copy(update={"safety": kind}), body)
        world = World(body)
        world.reset(task.start)
        pairs.append((Arbiter(task), world))
        duration = task.graph.duration
    spent: list[list[float]] = [[], []]
    for _ in range(int(duration / body.timestep / TURN)):
        for k, (arbiter, world) in enumerate(pairs):
            began = time.perf_counter()
            for _ in range(TURN):
                world.step(arbiter.torque(world.state))
            spent[k].append(time.perf_counter() - began)
    without, with_it = np.array(spent)
    filtered = pairs[1][0]
    return {
        "without_us": round(float(np.median(without)) / TURN * 1e6, 2),
        "with_us": round(float(np.median(with_it)) / TURN * 1e6, 2),
        "ratio": round(float(np.median(with_it / without)), 3),
        "steps_changed": round(filtered.changes / (len(without) * TURN), 3),
    }

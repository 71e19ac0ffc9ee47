"""Ways of a hand from anywhere: what they run into, and whether they come to their goal."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from adonis.dancing import random_start
from adonis.judging import judge
from adonis.lint_study.drawing import CALM, MARKS, Case, has, posture, run, timed
from primitives import GoToPoint, Place, Primitive, ViaPlace, ViaPosture
from sim import Body, clearance, clearances
from specs import BoundTask, Finding, lint_task

LOOK_EVERY = 3  # rows from one look at the distances to the next


def try_way(body: Body, seed: int) -> Case:
    """A way of the right hand from anywhere to a place beside the body, or to a posture."""
    task, found = _way(body, seed)
    hits = [f for f in found if f.code == "collision"]
    advice: tuple[bool, ...] = ()
    round_ = _advised(body, task, hits[0]) if hits else None
    if round_ is not None:
        advice = (not _touches(round_),)
    return Case("collision", seed, bool(hits), _touches(task), advice)


def try_end(body: Body, seed: int) -> Case:
    """The same, and whether it comes to its goal."""
    task, found = _way(body, seed)
    (recording,) = run(task, task.start)
    (verdict,) = judge(recording, task.spec).verdicts
    return Case("stuck", seed, has(found, "stuck"), not verdict.success)


def _way(body: Body, seed: int) -> tuple[BoundTask, Sequence[Finding]]:
    """A way with time enough to a goal that can be reached, and what the lint says of it."""
    rng = np.random.default_rng(seed)
    left = body.qpos_of_dof[body.joints("left_arm")]
    while True:
        task = timed(body, _beside(body, rng), CALM)
        task = replace(task, start=random_start(body, task.start, 1, int(rng.integers(1 << 30)))[0])
        task.start[left] = body.home[left]
        if clearance(body, task.start) <= 0.0:
            continue
        if not has(found := lint_task(task), "out-of-reach", "inside-body", "too-fast"):
            return task, found


def _beside(body: Body, rng: np.random.Generator) -> Primitive:
    if rng.random() < 0.3:
        return posture(body, rng)
    away = float(rng.uniform(0.06, 0.15))
    return GoToPoint(limb="right_arm", to=Place(near=str(rng.choice(MARKS)), away=away))


def _advised(body: Body, task: BoundTask, hit: Finding) -> BoundTask | None:
    """The task with the via point that a finding names."""
    via = dict(hit.numbers).get("via")
    if via is None:
        return None
    does = task.spec.subtasks[0].does
    kind = ViaPlace if isinstance(does, GoToPoint) else ViaPosture
    changed = does.model_copy(update={"via": (kind.model_validate(via),)})
    return replace(timed(body, changed, CALM), start=task.start)


def _touches(task: BoundTask) -> bool:
    (recording,) = run(task, task.start)
    body = task.body
    mine = {body.map.limbs["right_arm"].upper_arm, *_links(body)}
    pairs = [pair for pair in body.map.keep_apart if set(pair) & mine]
    return bool(clearances(body, recording.qpos[::LOOK_EVERY], pairs).min() < 0.0)


def _links(body: Body) -> tuple[str, str]:
    limb = body.map.limbs["right_arm"]
    return limb.forearm, limb.hand

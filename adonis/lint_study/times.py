"""Postures and reaches in times drawn at random."""

import numpy as np

from adonis.judging import judge
from adonis.lint_study.drawing import CALM, Case, goal, posture, run, timed
from sim import Body
from specs import BoundTask, lint_task

ENOUGH = 0.7  # of the shortest time does not work


def try_time(body: Body, seed: int) -> Case:
    """A posture or a reach of the right arm that is done in 1.5 s, in a time drawn at random."""
    rng = np.random.default_rng(seed)
    while True:
        does = posture(body, rng) if rng.random() < 0.5 else goal(body, rng)
        if _in_time(timed(body, does, CALM)):  # so that nothing but time is short
            break
    task = timed(body, does, float(np.exp(rng.uniform(np.log(0.1), np.log(1.0)))))
    short = [f for f in lint_task(task) if f.code == "too-fast"]
    advice: tuple[bool, ...] = ()
    if short:
        time = dict(short[0].numbers)["shortest"]
        advice = (
            _in_time(timed(body, does, time)),
            not _in_time(timed(body, does, ENOUGH * time)),
        )
    return Case("too fast", seed, bool(short), not _in_time(task), advice)


def _in_time(task: BoundTask) -> bool:
    (recording,) = run(task)
    fastest = np.abs(recording.qvel).max(axis=0) <= task.body.speed_limit
    (verdict,) = judge(recording, task.spec).verdicts
    return verdict.success and bool(fastest.all())

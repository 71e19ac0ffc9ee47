"""Postures and swings of one joint about the end of its range."""

from dataclasses import replace

import numpy as np

from adonis.lint_study.drawing import AMPLE, Case, has, run, timed
from primitives import GetPosture, Oscillate, Primitive, Swing
from sim import Body, Replay, adonis
from specs import SpecError, lint_task


def try_range(body: Body, seed: int) -> Case:
    """A posture or a swing of one joint about the end of its range."""
    rng = np.random.default_rng(seed)
    names = [body.dof_name(int(d)) for d in body.joints(["right_arm", "neck"])]
    joint = str(rng.choice([n for n in names if "neck" in n or "elbow" in n or "wrist_z" in n]))
    (dof,) = body.joints(joint)
    low, high = (float(np.rad2deg(limit[dof])) for limit in body.range)
    past = float(rng.uniform(-20.0, 20.0))
    swings = rng.random() < 0.4
    asked = high + past
    does: Primitive = GetPosture(joints=(joint,), posture={joint: asked})
    if swings:
        amplitude = 0.3 * (high - low)
        centre = asked - amplitude
        does = Oscillate(joints={joint: Swing(amplitude=amplitude)}, frequency=0.5,
                         centre={joint: centre}, ease=0.5)  # fmt: skip
    try:
        said = has(lint_task(timed(body, does, AMPLE)), "joint-limit")
    except SpecError as problem:
        said = problem.code == "joint-limit"
    # The same on a body that is told of no limits, moved in the world of one that has them.
    free = adonis(limits=False)
    task = replace(timed(free, does, AMPLE), body=body)
    (recording,) = run(task)
    angle = np.rad2deg(Replay(recording).angle(joint))
    reached = float(angle.max()) if swings else float(angle[recording.row(AMPLE)])
    return Case("joint limit", seed, said, reached >= high)

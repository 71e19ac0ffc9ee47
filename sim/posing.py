"""Postures said in words: which joint angles hold an arm so?

"Arm forward, elbow straight, palm down" is a set of directions; the angles that come
nearest to them, within the joint limits, are found by bounded least squares.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import minimize
from numpy.typing import NDArray

from sim.body import Arm, Body
from sim.errors import Unposable

FloatArray = NDArray[np.float64]

COMFORT = 0.02  # weight of staying near the home posture, which settles what is left open
TOLERANCE = np.deg2rad(3.0)


@dataclass(frozen=True)
class ArmWords:
    """How an arm is to be held; what is None is left to the least effort."""

    direction: FloatArray | None = None  # (3,) from shoulder to wrist, in the body's frame
    elbow: float | None = None  # [rad], 0 is straight
    palm: FloatArray | None = None  # (3,) normal out of the palm, in the body's frame


def measure(body: Body, arm: Arm, data: mujoco.MjData) -> ArmWords:
    """How an arm is held in the present kinematics of `data`."""
    along = data.xpos[arm.hand] - data.xpos[arm.upper_arm]
    elbow = body.joints(arm.limb.elbow)[0]
    return ArmWords(
        direction=along / np.linalg.norm(along),
        elbow=float(data.qpos[body.qpos_of_dof[elbow]]),
        palm=data.xmat[arm.hand].reshape(3, 3) @ arm.palm.normal,
    )


def pose(body: Body, arm: Arm, words: ArmWords) -> FloatArray:
    """Joint angles (nv,) [rad] that hold `arm` as the words say; NaN for all other joints.

    Raises:
        Unposable: no posture within the joint limits comes within 3 degrees of the words.
    """
    model, data = body.model, mujoco.MjData(body.model)
    data.qpos[:] = body.home
    places = body.qpos_of_dof[arm.dofs]
    low, high = (limit[arm.dofs] for limit in body.range)
    low, high = np.maximum(low, -np.pi), np.minimum(high, np.pi)
    home = np.clip(body.home[places], low, high)

    def misses() -> list[FloatArray]:
        held = measure(body, arm, data)
        parts = []
        for wanted, now in ((words.direction, held.direction), (words.palm, held.palm)):
            if wanted is not None and now is not None:
                parts.append(now - wanted)
        if words.elbow is not None and held.elbow is not None:
            parts.append(np.array([held.elbow - words.elbow]))
        return parts

    def residual(columns: FloatArray) -> FloatArray:
        results = []
        for q in columns.T:
            data.qpos[places] = q
            mujoco.mj_kinematics(model, data)
            results.append(np.concatenate([*misses(), COMFORT * (q - home)]))
        return np.array(results).T

    best, least = home, np.inf
    for start in (home, 0.5 * (low + high), 0.25 * low + 0.75 * high):
        solution, _ = minimize.least_squares(
            start, residual, bounds=(low, high), verbose=minimize.Verbosity.SILENT
        )
        cost = float(np.sum(residual(solution.reshape(-1, 1)) ** 2))
        if cost < least - 1e-9:
            best, least = solution.ravel(), cost
    residual(best.reshape(-1, 1))
    worst = max(off_words(body, arm, data, words).values(), default=0.0)
    angles = np.full(body.nv, np.nan)
    angles[arm.dofs] = best
    if worst > TOLERANCE:
        raise Unposable(
            f"{arm.name} cannot be held so: {np.rad2deg(worst):.0f} degrees off at best,"
            " within the joint limits",
            angles,
            worst,
        )
    return angles


def posed(body: Body, angles: FloatArray) -> mujoco.MjData:
    """The kinematics of a body whose joints are at some angles (nv,) [rad]."""
    data = mujoco.MjData(body.model)
    data.qpos[:] = body.home
    data.qpos[body.qpos_of_dof] = angles
    mujoco.mj_kinematics(body.model, data)
    return data


def off_words(body: Body, arm: Arm, data: mujoco.MjData, words: ArmWords) -> dict[str, float]:
    """By how much an arm is off from what is said of it, in the kinematics of `data` [rad].

    Returns:
        For each that is said of `arm`, `elbow` and `palm`, the angle between it and what is.
    """
    held, off = measure(body, arm, data), dict[str, float]()
    for part, wanted, now in (
        ("arm", words.direction, held.direction),
        ("palm", words.palm, held.palm),
    ):
        if wanted is not None and now is not None:
            half_chord = min(float(np.linalg.norm(now - wanted)) / 2.0, 1.0)
            off[part] = float(2.0 * np.arcsin(half_chord))
    if words.elbow is not None and held.elbow is not None:
        off["elbow"] = abs(held.elbow - words.elbow)
    return off

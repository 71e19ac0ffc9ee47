"""Gains by rule: as brisk and as well damped as Adonis, by the inertia that a joint or hand moves.

A joint's servo has the natural frequency of its part and one damping ratio (`sim.briskness`). The
springs of a hand have, against the inertia that the hand feels, the frequencies and damping
that Adonis' have against his:

    k = w^2 m,  b = 2 zeta w m,    m = 3 / trace(J M^-1 J^T)

m being the effective mass at the palm (Khatib 1987), averaged over all directions, with the arm
half raised and half bent; likewise the effective moments of inertia of hand and upper arm. What
keeps links apart pushes as hard against that mass as Adonis' does against his, within the same
share of the arm's length.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body_map import Guard, Servo, Spring

FloatArray = NDArray[np.float64]

# Of Adonis' springs against what his hand feels; the test computes them anew.
HAND, HAND_DAMPING = 6.51, 1.16  # natural frequency [Hz], damping ratio
TURN, TURN_DAMPING = 9.54, 1.35
UPPER_ARM, UPPER_ARM_DAMPING = 3.09, 0.97
SHOULDER_DAMPING = 12.6  # per moment of inertia of the upper arm [1/s]
APPROACH = -112.0  # per mass of the hand [1/(m s)]
JOINT_DAMPING = 50.4  # per moment of inertia of the upper arm [1/s]
GUARD, GUARD_DAMPING = 4.76, 0.374
GUARD_RANGE = 0.0272  # per length of upper arm and forearm
RAISED, BENT = np.deg2rad(60.0), np.deg2rad(30.0)  # while inertia is measured


def half_out(model: Any) -> Any:
    """An `MjData` in which the arms are half raised and half bent, as far as they go."""
    data = mujoco.MjData(model)
    for j in range(model.njnt):
        name = model.joint(j).name
        wanted = RAISED if name.endswith("shoulder_y") else BENT if name.endswith("elbow") else 0.0
        low, high = model.jnt_range[j] if model.jnt_limited[j] else (-np.inf, np.inf)
        data.qpos[model.jnt_qposadr[j]] = np.clip(wanted, low, high)
    mujoco.mj_forward(model, data)
    return data


def moved_inertia(model: Any, data: Any) -> FloatArray:
    """The inertia that each joint moves (nv,) [kg m^2]."""
    mass = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return np.diag(mass).copy()


def servos(
    model: Any,
    parts: Mapping[str, str],
    frequency: Mapping[str, float],
    damping_ratio: float,
) -> dict[str, Servo]:
    """k = (2 pi f)^2 I and k_d = 2 zeta sqrt(k I) for each joint, by the part that it is of."""
    inertia = moved_inertia(model, half_out(model))
    found = {}
    for j in range(model.njnt):
        name = model.joint(j).name
        rate, moved = 2.0 * np.pi * frequency[parts[name]], inertia[model.jnt_dofadr[j]]
        found[name] = Servo(
            stiffness=float(rate**2 * moved),
            damping=float(2.0 * damping_ratio * rate * moved),
        )
    return found


def felt_inertia(
    model: Any, joints: Sequence[str], bend: int, palm: str
) -> tuple[float, float, float]:
    """What a hand feels: its mass [kg], its moment of inertia, and the upper arm's [kg m^2].

    Args:
        model: compiled.
        joints: of the arm, from the trunk outwards.
        bend: which of them is the elbow.
        palm: site.
    """
    data = half_out(model)
    dofs = [int(model.jnt_dofadr[model.joint(name).id]) for name in joints]
    mass = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    place, turn = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jacSite(model, data, place, turn, model.site(palm).id)

    def felt(jacobian: FloatArray, own: list[int]) -> float:
        j = jacobian[:, own]
        return float(3.0 / np.trace(j @ np.linalg.solve(mass[np.ix_(own, own)], j.T)))

    return felt(place, dofs), felt(turn, dofs), felt(turn, dofs[:bend])


def hand_spring(model: Any, joints: Sequence[str], bend: int, palm: str) -> Spring:
    """The springs of a hand; see `felt_inertia` for the arguments."""
    mass, moment, upper = felt_inertia(model, joints, bend, palm)
    stiffness, damping = _spring(HAND, HAND_DAMPING, mass)
    turn_stiffness, turn_damping = _spring(TURN, TURN_DAMPING, moment)
    upper_stiffness, upper_damping = _spring(UPPER_ARM, UPPER_ARM_DAMPING, upper)
    return Spring(
        stiffness=stiffness,
        damping=damping,
        turn_stiffness=turn_stiffness,
        turn_damping=turn_damping,
        upper_arm_stiffness=upper_stiffness,
        upper_arm_damping=upper_damping,
        shoulder_damping=SHOULDER_DAMPING * upper,
        approach=APPROACH * mass,
        joint_damping=JOINT_DAMPING * upper,
    )


def guard(mass: float, length: float) -> Guard:
    """What keeps the links of a body apart.

    Args:
        mass: that a hand feels [kg].
        length: of upper arm and forearm [m].
    """
    stiffness, damping = _spring(GUARD, GUARD_DAMPING, mass)
    return Guard(range=GUARD_RANGE * length, stiffness=stiffness, damping=damping)


def _spring(frequency: float, ratio: float, inertia: float) -> tuple[float, float]:
    """Stiffness and damping that give an inertia a frequency [Hz] and a damping ratio."""
    rate = 2.0 * np.pi * frequency
    return rate**2 * inertia, 2.0 * ratio * rate * inertia

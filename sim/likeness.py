"""How one body compares with another, so that what suits the one can be scaled to the other.

L is the ratio of their arms. Each joint has an I of its own, that of what it moves, and each hand
an M and an I, those of the arm as it is felt at the palm: the "mass scaling" of Hodgins & Pollard
(1997), in which gains are scaled by what they move and all share one length and one time.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Arm, Body
from sim.errors import BodyError
from sim.laws import Law

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Likeness:
    """What one body is to another."""

    length: float  # L
    joints: Mapping[str, Law]  # of the joints that both have
    hands: Mapping[str, Law]  # of the limbs that both have, at the palm

    @property
    def whole(self) -> Law:
        """As if the one were a scale model of the other."""
        return Law.geometric(self.length)

    @property
    def geometric(self) -> "Likeness":
        """The same by lengths alone: every joint and hand as in a scale model."""
        joints, hands = (dict.fromkeys(names, self.whole) for names in (self.joints, self.hands))
        return replace(self, joints=joints, hands=hands)

    def joint(self, name: str) -> Law:
        """Of a joint; of one that only one of them has, as in a scale model."""
        return self.joints.get(name, self.whole)

    def hand(self, limb: str) -> Law:
        """Of a hand; of one that only one of them has, as in a scale model."""
        return self.hands.get(limb, self.whole)


def likeness(one: Body, other: Body, length: float | None = None) -> Likeness:
    """What `other` is to `one`.

    Args:
        one: the body that something suits.
        other: the body that it is to suit as well.
        length: L; default: how much longer its arms are.

    Raises:
        BodyError: one of them has no arm whose length could be compared.
    """
    limbs = [name for name in one.map.limbs if name in other.map.limbs]
    if length is None:
        length = _arm_of(other) / _arm_of(one)
    moved, more = (moved_inertia(body.model) for body in (one, other))
    joints = {
        name: Law(length, length**3, more[name] / moved[name]) for name in moved if name in more
    }
    hands = {}
    for limb in limbs:
        (mass, turn), (heavier, harder) = (_at_palm(b, b.arm(limb)) for b in (one, other))
        hands[limb] = Law(length, heavier / mass, harder / turn)
    return Likeness(length, joints, hands)


def _arm_of(body: Body) -> float:
    """How long the arms of a body are [m]."""
    if not body.map.limbs:
        raise BodyError(f"{body.map.name!r} has no arm: how much larger it is cannot be told")
    return float(np.mean([body.reach(body.arm(limb)) for limb in body.map.limbs]))


def moved_inertia(model: Any, *, rigid: bool = False) -> dict[str, float]:
    """The inertia that each hinge moves, its joints halfway between their ends [kg m^2].

    Args:
        model: whose hinges.
        rigid: without the armature of the motors.
    """
    mass = _mass_matrix(model)[1]
    if rigid:
        mass = mass - np.diag(model.dof_armature)
    return {
        model.joint(j).name: float(mass[d, d])
        for j, d in enumerate(model.jnt_dofadr)
        if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE.value
    }


def _at_palm(body: Body, arm: Arm) -> tuple[float, float]:
    """Mass [kg] and moment of inertia [kg m^2] of an arm, as they are felt at its palm.

    The geometric mean over the three directions of (J M^-1 J^T)^-1 (Khatib 1987).
    """
    data, mass = _mass_matrix(body.model)
    place = data.xpos[arm.hand] + data.xmat[arm.hand].reshape(3, 3) @ arm.palm.point
    moving, turning = np.zeros((2, 3, body.nv))
    mujoco.mj_jac(body.model, data, moving, turning, place, arm.hand)
    own = np.linalg.inv(mass[np.ix_(arm.dofs, arm.dofs)])
    felt = []
    for jacobian in (moving[:, arm.dofs], turning[:, arm.dofs]):
        # an arm with fewer joints than directions is felt in those that it can move in
        mobility = np.linalg.eigvalsh(jacobian @ own @ jacobian.T)
        felt.append(float(np.exp(-np.mean(np.log(mobility[mobility > 1e-9 * mobility.max()])))))
    return felt[0], felt[1]


def _mass_matrix(model: Any) -> tuple[Any, FloatArray]:
    """Kinematics and mass matrix (nv, nv) with every joint halfway between its ends."""
    data = mujoco.MjData(model)
    for j in range(model.njnt):
        low, high = model.jnt_range[j]
        if low < high:
            data.qpos[model.jnt_qposadr[j]] = 0.5 * (low + high)
    mujoco.mj_forward(model, data)
    mass = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return data, mass

"""The springs that pull a hand: its palm to a place, and hand and upper arm to directions.

    tau = J_h^T [K (x_d - x) + B (x_d' - x'), k_n n x n_d + k_f f x f_d] + J_e^T [0, k_e u x u_d]

with the dampers of hand, upper arm and shoulder (Mataric et al. 1999, eq 7 to 9), on the joints of
the arm alone. What they want moves with the link that carries the arm; directions that are not
asked for stay as they are on the forearm.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Arm, Body
from sim.kinematics import along, axes_of, place_of, turn, turned, turned_by_way_of, unit
from sim.springs import Pull, SetPoint

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

LOOSE = 0.8  # share of their firmness that fingers which are free lose
NEARLY_OPPOSITE = -0.7  # cosine of an angle of 134 degrees
EYE = np.eye(3)


@dataclass(frozen=True)
class HandPath:
    """What springs want of a hand, at k even shares of the time, seen from the carrying link."""

    place: FloatArray  # (k, 3) of the palm [m]
    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    # How far the hand has turned (k,), from 0, as it was on the forearm, to 1, as it is to be.
    late: FloatArray
    normal: FloatArray | None = (
        None  # (3,) unit, out of the palm in the end; None: as on the forearm
    )
    # (3,) in the frame of the forearm: the palm's normal by way of which it turns half round.
    neutral: FloatArray | None = None
    fingers: FloatArray | None = None  # (3,) in the end; None: loosely in line with the forearm
    upper_arm: FloatArray | None = None  # (k, 3) from shoulder to elbow
    turn_stiffness: float = 0.0  # of normal and fingers [N m/rad]
    turn_damping: float = 0.0  # of the hand [N m s/rad]
    upper_arm_stiffness: float = 0.0  # [N m/rad]
    upper_arm_damping: float = 0.0  # [N m s/rad]
    shoulder_damping: float = 0.0  # [N m s/rad]


class HandSprings:
    """An arm that is pulled by its hand.

    Args:
        body: whose arm it is.
        arm: the arm.
        moved: the joints (j,) that may move, those of the arm and those that carry it.
        start: posture (nq,) in which the movement begins.
        path: of the hand.
    """

    def __init__(
        self, body: Body, arm: Arm, moved: IntArray, start: FloatArray, path: HandPath
    ) -> None:
        self._body, self._arm, self._moved, self._path = body, arm, moved, path
        self._place = SetPoint(path.place)
        self._late = SetPoint(path.late[:, None])
        self._upper_arm = None if path.upper_arm is None else SetPoint(path.upper_arm)
        self._jacobian = np.zeros((2, 3, body.nv))
        self._own = np.isin(moved, arm.dofs).astype(float)
        # Which joints of the arm turn the forearm and the upper arm with the hand.
        self._carry, self._swing = (
            body.ancestors[link, moved] * self._own for link in (arm.forearm, arm.upper_arm)
        )
        hand, forearm, root = (axes_of(body, start, k) for k in (arm.hand, arm.forearm, arm.root))
        # The palm's normal and the fingers as they are on the forearm when it begins.
        self._kept = forearm.T @ hand @ arm.palm.normal, forearm.T @ hand @ arm.fingers
        self._half_turn = (
            path.neutral is not None
            and path.normal is not None
            and float(hand @ arm.palm.normal @ root @ path.normal) < NEARLY_OPPOSITE
        )
        shoulder = np.isin(moved, arm.shoulder_dofs).astype(float)
        self._shoulder = np.diag(path.shoulder_damping * shoulder)

    def pull(self, data: mujoco.MjData, share: float, travel: float) -> Pull:
        """See `Springs.pull`."""
        path, arm, root = self._path, self._arm, data.xmat[self._arm.root].reshape(3, 3)
        place, speed = self._place.at(share)
        palm = place_of(data, arm.palm)
        linear, angular = self._jacobians(data, palm)
        wanted = data.xpos[arm.root] + root @ place
        force = path.stiffness * (wanted - palm) + path.damping / travel * (root @ speed)
        torque = linear.T @ force
        spread, turning = linear.T @ linear, angular.T @ angular
        stiffness = path.stiffness * spread
        damping = path.damping * spread + path.turn_damping * turning + self._shoulder
        for firmness, own, goal, carried in self._turns(data, root, share):
            relative = angular - angular * (carried * self._carry)
            torque = torque + firmness * angular.T @ turn(own, goal)
            stiffness = stiffness + firmness * angular.T @ (_across(own) @ relative)
        if self._upper_arm is not None:
            own, swing = along(data, arm.upper_arm, arm.forearm), angular * self._swing
            goal = root @ unit(self._upper_arm.at(share)[0])
            turning = swing.T @ (_across(own) @ swing)
            torque = torque + path.upper_arm_stiffness * swing.T @ turn(own, goal)
            stiffness = stiffness + path.upper_arm_stiffness * turning
            damping = damping + path.upper_arm_damping * turning
        rows = self._own[:, None]
        return Pull(self._own * torque, rows * stiffness * self._own, rows * damping)

    def _turns(
        self, data: mujoco.MjData, root: FloatArray, share: float
    ) -> list[tuple[float, FloatArray, FloatArray, float]]:
        """Of palm and fingers: firmness [N m/rad], where they point and where to, (3,) each, and
        how far that turns with the forearm, from 0 to 1.
        """  # noqa: D205
        path, arm, late = self._path, self._arm, float(self._late.at(share)[0][0])
        forearm, hand = (data.xmat[link].reshape(3, 3) for link in (arm.forearm, arm.hand))
        normal, ahead = (forearm @ kept for kept in self._kept)
        free = path.fingers is None
        goal = along(data, arm.forearm, arm.hand) if path.fingers is None else root @ path.fingers
        if path.normal is not None:
            facing = root @ path.normal
            if self._half_turn and path.neutral is not None:
                normal = turned_by_way_of(normal, forearm @ path.neutral, facing, late)
            else:
                normal = turned(normal, facing, late)
        ahead = turned(ahead, goal, late)
        ahead = unit(ahead - (ahead @ normal) * normal)
        firm = path.turn_stiffness * (1.0 - LOOSE * late if free else 1.0)
        return [
            (path.turn_stiffness, hand @ arm.palm.normal, normal,
             1.0 if path.normal is None else 1.0 - late),
            (firm, hand @ arm.fingers, ahead, 1.0 if free else 1.0 - late),
        ]  # fmt: skip

    def _jacobians(self, data: mujoco.MjData, palm: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Of the palm: linear and angular, (3, j) each."""
        linear, angular = self._jacobian
        mujoco.mj_jac(self._body.model, data, linear, angular, palm, self._arm.hand)
        return linear[:, self._moved], angular[:, self._moved]


def _across(direction: FloatArray) -> FloatArray:
    """What of a rotation turns a direction: (3, 3), all but the part about itself."""
    across: FloatArray = EYE - np.outer(direction, direction)
    return across

"""What springs ask of joints, as functions of posture, velocity and time.

About a posture q a spring's torques are those of a linear one: what it asks there at rest, less
its stiffness times the way on, less its damping times the velocity.
"""

from dataclasses import dataclass
from typing import Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]


@dataclass(frozen=True)
class Pull:
    """What springs ask of j joints in a posture."""

    torque: FloatArray  # (j,) at rest [N m]
    stiffness: FloatArray  # (j, j) by which it falls as the joints go on [N m/rad]
    damping: FloatArray  # (j, j) by which it falls with their velocity [N m s/rad]

    def faded(self, share: FloatArray, other: "Pull") -> "Pull":
        """Of each joint this one's share (j,), and of another what is left."""
        left = 1.0 - share
        return Pull(
            share * self.torque + left * other.torque,
            share[:, None] * self.stiffness + left[:, None] * other.stiffness,
            share[:, None] * self.damping + left[:, None] * other.damping,
        )


class Springs(Protocol):
    """Springs whose set points travel."""

    def pull(self, data: mujoco.MjData, share: float, travel: float) -> Pull:
        """What they ask in the present kinematics.

        Args:
            data: with kinematics and centres of mass as they are now.
            share: of the time that the set point travels; past 1 it rests.
            travel: that time [s].
        """
        ...


class SetPoint:
    """A set point that travels.

    Args:
        values: where it is at even shares of the time (k, m).
    """

    def __init__(self, values: FloatArray) -> None:
        self._last = len(values) - 1
        self._values, self._speeds = values, np.gradient(values, 1.0 / self._last, axis=0)

    def at(self, share: float) -> tuple[FloatArray, FloatArray]:
        """Where it is (m,), and its speed (m,) per whole of the time; past the end it rests."""
        if share >= 1.0:
            return self._values[-1], np.zeros_like(self._values[-1])
        k = int(share * self._last)
        part = share * self._last - k
        value, speed = (
            (1.0 - part) * rows[k] + part * rows[k + 1] for rows in (self._values, self._speeds)
        )
        return value, speed


class JointSprings:
    """Each joint on a spring of its own: a servo (Mataric et al. 1999, eq 1).

    Args:
        body: whose joints.
        dofs: which of them (j,).
        set_point: angles (k, j) [rad].
        stiffness: (j,) [N m/rad].
        damping: (j,), of the difference from the set point's speed [N m s/rad].
    """

    def __init__(
        self,
        body: Body,
        dofs: IntArray,
        set_point: FloatArray,
        stiffness: FloatArray,
        damping: FloatArray,
    ) -> None:
        self._columns, self._set_point = body.qpos_of_dof[dofs], SetPoint(set_point)
        self._stiffness, self._damping = stiffness, damping
        self._matrices = np.diag(stiffness), np.diag(damping)

    def pull(self, data: mujoco.MjData, share: float, travel: float) -> Pull:
        """See `Springs.pull`."""
        wanted, speed = self._set_point.at(share)
        torque = self._stiffness * (wanted - data.qpos[self._columns])
        return Pull(torque + self._damping * speed / travel, *self._matrices)

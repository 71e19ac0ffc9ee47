"""rubber-band: pull joints to where they are at home, softly, with no set point on the way.

tau = k (theta_home - theta) - b theta'
"""

from typing import Literal

import numpy as np

from primitives import Primitive, PrimitiveError
from primitives.primitive import BoolArray, FloatArray, IntArray
from sim import Body, State


class RubberBand(Primitive):
    """Pull joints home as rubber bands do."""

    kind: Literal["rubber-band"] = "rubber-band"
    joints: tuple[str, ...]  # joints, joint groups or limbs
    stiffness: float = 20.0  # [N m/rad]
    damping: float = 3.0  # [N m s/rad]

    def bind(self, body: Body, duration: float) -> "BandField":
        """Turn names into indices; every mistake is found here, before anything moves."""
        if self.stiffness <= 0.0:
            raise PrimitiveError(f"stiffness must be positive, not {self.stiffness:g}")
        return BandField(body, body.joints(self.joints), self.stiffness, self.damping)


class BandField:
    """A spring and a damper at each joint, for n simulations at once."""

    unit = "rad"  # of the error
    passive = True  # it only stores and dissipates energy

    def __init__(self, body: Body, dofs: IntArray, stiffness: float, damping: float) -> None:
        self.claims = dofs
        self._columns = body.qpos_of_dof[dofs]
        self._home = body.home[self._columns]
        self._stiffness, self._damping = stiffness, damping

    def begin(self, state: State, who: BoolArray) -> None:
        """Nothing to remember."""

    def torque(self, state: State, t: FloatArray) -> FloatArray:
        """Torques (n, nv) [N m]."""
        torque = np.zeros_like(state.qvel)
        off = self._home - state.qpos[:, self._columns]
        torque[:, self.claims] = self._stiffness * off - self._damping * state.qvel[:, self.claims]
        return torque

    def error(self, state: State) -> FloatArray:
        """Largest angle (n,) from home [rad]."""
        off: FloatArray = np.abs(self._home - state.qpos[:, self._columns]).max(axis=1)
        return off

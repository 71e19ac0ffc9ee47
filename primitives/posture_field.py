"""The field of a posture: a servo or a torque field in the joints of a limb or group."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from primitives.goal_field import GoalField
from primitives.primitive import FloatArray, IntArray
from primitives.set_point import Profile, weights_at
from primitives.table import PD_SERVO, TORQUE_FIELD, TableBuilder
from sim import Body

JointController = Literal["pd-servo", "torque-field"]


@dataclass(frozen=True)
class JointGains:
    """Gains of joints, (nv,) each; joints that are not moved have none."""

    stiffness: FloatArray  # k of eq 1, A of eq 3 [N m/rad]
    damping: FloatArray  # k_d [N m s/rad]
    width: FloatArray  # s of eq 3 [rad]
    coupled: bool = False  # whether the wells of a torque field are coupled


def joint_gains(
    body: Body,
    dofs: IntArray,
    *,
    stiffness: float | None = None,
    damping: float | None = None,
    width: float | None = None,
    coupled: bool = False,
) -> JointGains:
    """Gains of the joints `dofs`: what is not given is the body's.

    A stiffness without a width means the pair of eq 3, s = 1 / sqrt(k).
    """
    gains = JointGains(np.zeros(body.nv), np.zeros(body.nv), np.ones(body.nv), coupled)
    for dof in (int(d) for d in dofs):
        servo = body.servo(dof)
        gains.stiffness[dof] = servo.stiffness if stiffness is None else stiffness
        gains.damping[dof] = servo.damping if damping is None else damping
        paired = servo.width if stiffness is None else stiffness**-0.5
        gains.width[dof] = paired if width is None else width
    return gains


class PostureField(GoalField):
    """Moves joints through postures to a last one: see `pd_servo` and `torque_field`.

    Args:
        body: whose joints.
        claims: which of them.
        postures: via postures and goal (p, nv) [rad]; only the claimed joints mean anything.
        times: of start, via postures and goal, as shares of the duration (p + 1,).
        duration: of the movement [s].
        controller: how the torque is made.
        gains: of the joints.
        profile: of the set point; a torque field has none.
        pulses: sizes of the pulses of a torque field, one for each via posture.
        touch: the hand and the link that the movement brings together; -1 for none.
        miss: by how much the last posture misses a goal that was given as a place [m].
    """

    def __init__(
        self,
        body: Body,
        claims: IntArray,
        postures: FloatArray,
        times: tuple[float, ...],
        duration: float,
        controller: JointController,
        gains: JointGains,
        *,
        profile: Profile = "spline",
        pulses: tuple[float, ...] = (),
        touch: tuple[int, int] = (-1, -1),
        miss: float = 0.0,
    ) -> None:
        super().__init__(body, claims, unit="rad")
        self.passive = not gains.coupled  # coupled wells are no gradient unless all are alike
        self.goal = postures[-1]  # (nv,) [rad]
        self._postures = np.nan_to_num(postures)
        self.controller = controller
        self._gains, self._profile = gains, profile
        self._pulses = np.array(pulses, dtype=float)
        self._times, self._duration = times, duration
        self._touch, self._miss = touch, miss

    def too_far(self) -> float:
        """By how much the goal is out of reach [m]; 0 if it is not."""
        return self._miss if self._miss > CLOSE_ENOUGH else 0.0

    def set_point(self, t: FloatArray, start: FloatArray, dofs: Sequence[int]) -> FloatArray:
        """Where a servo wants some joints to be, for the record.

        Args:
            t: times since the movement began (k,) [s].
            start: angles in which it began (len(dofs),) [rad].
            dofs: the joints.

        Returns:
            (k, len(dofs)) [rad]
        """
        knots = np.vstack([start, self._postures[:, list(dofs)]])
        return weights_at(self._profile, self._times, t / self._duration) @ knots

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        gains = self._gains
        numbers = [gains.stiffness, gains.damping, self._postures]
        kind = PD_SERVO
        if self.controller == "torque-field":
            kind = TORQUE_FIELD
            coupled = np.array([float(gains.coupled)])
            numbers += [0.5 / gains.width**2, coupled, self._pulses]
        return table.field(
            kind,
            table.numbers(*numbers),
            self.claims,
            duration=self._duration,
            curve=table.curve(self._profile, self._times),
            knots=len(self._times),
            touch=self._touch,
        )


CLOSE_ENOUGH = 0.005  # [m]

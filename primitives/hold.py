"""hold: stay where you are when it begins.

The servo of get-posture (`pd_servo`: Mataric et al. 1999, eq 1) with the posture of that moment as
its goal:

    tau = k (theta_0 - theta) - k_d theta'
"""

from typing import Literal, Self

from pydantic import model_validator

from primitives.parameters import Damping, Stiffness
from primitives.posture_field import joint_gains
from primitives.primitive import Primitive
from primitives.stay_field import StayField
from sim import Body


class Hold(Primitive):
    """Stay where you are now: keep joints as they are when it begins."""

    kind: Literal["hold"] = "hold"
    limb: str | None = None  # an arm of the body, or
    joints: tuple[str, ...] | None = None  # joints and joint groups; `all` is every joint
    stiffness: Stiffness | None = None  # [N m/rad]; default: of each joint's servo
    damping: Damping | None = None  # [N m s/rad]; the same

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.limb is None) == (self.joints is None):
            raise ValueError("give either limb or joints")
        return self

    def bind(self, body: Body, duration: float) -> StayField:
        """See `Primitive.bind`."""
        claims = body.arm(self.limb).dofs if self.limb else body.joints(self.joints or ())
        gains = joint_gains(body, claims, stiffness=self.stiffness, damping=self.damping)
        return StayField(body, claims, gains)

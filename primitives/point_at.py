"""point-at: stretch an arm towards a place, and keep pointing while it moves.

The law is in `pointing`.
"""

from typing import Literal

from primitives.compiled_field import CompiledField
from primitives.look_at import flat
from primitives.parameters import SETTLE, Damping, Stiffness, Time, settling
from primitives.pointing import Pointing
from primitives.primitive import Primitive
from primitives.table import POINT_ARM, TableBuilder
from primitives.target import Target, locate, refuse_own
from sim import Arm, Body


class PointAt(Primitive):
    """Stretch an arm towards a place, and keep pointing while it moves."""

    kind: Literal["point-at"] = "point-at"
    limb: str  # an arm
    at: str | Target  # a landmark, or {hand: LIMB}, {near: LANDMARK, away: …}, {point: […]}
    settle: Time = SETTLE  # time in which the arm gets there [s]
    stiffness: Stiffness | None = None  # [N m/rad]; default: that of the shoulder's stiffest servo
    damping: Damping | None = None  # [N m s/rad]; the same

    def bind(self, body: Body, duration: float) -> "PointingField":
        """See `Primitive.bind`."""
        arm = body.arm(self.limb)
        spot = locate(body, self.at, arm.root)
        refuse_own(body, spot, arm.dofs, "point-at", self.at)
        servos = [body.servo(int(dof)) for dof in arm.shoulder_dofs]
        elbow = int(body.joints(arm.limb.elbow)[0])
        straight, spring = body.servo(elbow), arm.limb.spring
        pointing = Pointing(
            upper_arm=arm.upper_arm,
            forearm=arm.forearm,
            hand=arm.hand,
            root=arm.root,
            elbow=elbow,
            goal_link=spot.link,
            goal=tuple(spot.point),
            fingers=tuple(arm.fingers),
            stiffness=self.stiffness or max(s.stiffness for s in servos),
            damping=max(s.damping for s in servos) if self.damping is None else self.damping,
            elbow_stiffness=straight.stiffness,
            elbow_damping=straight.damping,
            turn_stiffness=spring.turn_stiffness,
            turn_damping=spring.turn_damping,
            shoulder_damping=spring.shoulder_damping,
        )
        return PointingField(body, arm, pointing, settling(self.settle, duration))


class PointingField(CompiledField):
    """Points an arm: see `pointing`."""

    passive = True

    def __init__(self, body: Body, arm: Arm, pointing: Pointing, settle: float) -> None:
        super().__init__(body, arm.dofs, unit="rad")
        self._pointing, self._settle = pointing, settle

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        row = table.numbers(flat(self._pointing))
        return table.field(POINT_ARM, row, self.claims, duration=self._settle)

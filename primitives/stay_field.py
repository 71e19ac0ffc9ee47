"""The field of a posture that is kept: that of the moment in which it is switched on."""

import numpy as np

from primitives.goal_field import GoalField
from primitives.posture_field import JointGains
from primitives.primitive import IntArray
from primitives.table import PD_SERVO, TableBuilder
from sim import Body


class StayField(GoalField):
    """A servo whose movement never ends, so that its set point stays where it began."""

    passive = True

    def __init__(self, body: Body, claims: IntArray, gains: JointGains) -> None:
        super().__init__(body, claims, unit="rad")
        self._gains = gains

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        times, nowhere = (0.0, 1.0), np.zeros(table.nv)
        return table.field(
            PD_SERVO,
            table.numbers(self._gains.stiffness, self._gains.damping, nowhere),
            self.claims,
            duration=np.inf,
            curve=table.curve("linear", times),
            knots=len(times),
        )

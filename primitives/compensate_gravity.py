"""compensate-gravity: carry the body's own weight, once, for all other primitives.

The g(theta) of Mataric et al. 1999, eq 9; see `gravity`. It claims no joints.
"""

from typing import Literal

import numpy as np

from primitives.compiled_field import CompiledField
from primitives.primitive import NO_JOINTS, Primitive
from primitives.table import WEIGHT, TableBuilder
from sim import Body


class CompensateGravity(Primitive):
    """Add the torques that hold the body up against gravity."""

    kind: Literal["compensate-gravity"] = "compensate-gravity"

    def bind(self, body: Body, duration: float) -> "WeightField":
        """See `Primitive.bind`."""
        return WeightField(body, NO_JOINTS, unit="")


class WeightField(CompiledField):
    """The body's weight: see `gravity`."""

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        gravity = np.array(self._body.gravity)
        return table.field(WEIGHT, table.numbers(gravity), self.claims)

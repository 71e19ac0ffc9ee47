"""relax: let a limb or joints hang loose.

    tau = - b theta'                    and, if it is limp,  - g(theta)

There is no stiffness. Whoever carries the weight of the body (compensate-gravity: Mataric et al.
1999, eq 9) goes on carrying that of the limb, which then floats where it is let go and can be moved
with a finger. A limp limb is not carried: g is taken back, and it falls and swings until it hangs.
"""

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from primitives.compiled_field import CompiledField
from primitives.parameters import Damping
from primitives.primitive import FloatArray, IntArray, Primitive
from primitives.table import LOOSE, TableBuilder
from sim import Body

LOW = 0.1  # damping, as a share of that of the body's servos


class Relax(Primitive):
    """Let a limb hang loose: low damping, no stiffness."""

    kind: Literal["relax"] = "relax"
    limb: str | None = None  # an arm of the body, or
    joints: tuple[str, ...] | None = None  # joints and joint groups; `all` is every joint
    # Whether it falls; else compensate-gravity carries it on. Without compensate-gravity
    # everything falls, and this is refused.
    limp: bool = False
    damping: Damping | None = None  # [N m s/rad]; default: a tenth of that of each servo

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.limb is None) == (self.joints is None):
            raise ValueError("give either limb or joints")
        return self

    def bind(self, body: Body, duration: float) -> "LooseField":
        """See `Primitive.bind`."""
        claims = body.arm(self.limb).dofs if self.limb else body.joints(self.joints or ())
        damping = np.zeros(body.nv)
        for dof in (int(d) for d in claims):
            given = self.damping
            damping[dof] = LOW * body.servo(dof).damping if given is None else given
        return LooseField(body, claims, damping, body.gravity if self.limp else np.zeros(3))


class LooseField(CompiledField):
    """Lets joints hang loose: see `hang_loose`."""

    passive = True

    def __init__(
        self, body: Body, claims: IntArray, damping: FloatArray, gravity: FloatArray
    ) -> None:
        super().__init__(body, claims, unit="")
        self._damping, self._gravity = damping, gravity

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        return table.field(LOOSE, table.numbers(self._damping, self._gravity), self.claims)

"""avoid-collisions: keep links that must not touch apart, whatever else moves them.

Mataric, Zordan & Williamson (1999), section 9, run it beside any get-posture or go-to-point
"in order to generate safe, collision-free movement". It claims no joints: its torques are
added to those of whatever moves the body. A hand that is to touch a link is let through to
that one link as its set point arrives there.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records
from primitives.compiled_field import CompiledField
from primitives.errors import PrimitiveError
from primitives.get_posture import NonNegative, Positive
from primitives.primitive import NO_JOINTS, FloatArray, Primitive
from primitives.repulsion import CAPSULE, GUARD, PAIR
from primitives.table import GUARDING, TableBuilder
from sim import Body, Capsules


class AvoidCollisions(Primitive):
    """Push links apart before they touch."""

    kind: Literal["avoid-collisions"] = "avoid-collisions"
    pairs: tuple[tuple[str, str], ...] | None = None  # of links; default: the body's keep_apart
    range: Positive = 0.015  # distance of the surfaces at which it begins to push [m]
    stiffness: Positive = 800.0  # force at contact, per metre of range [N/m]
    damping: NonNegative = 60.0  # of drawing nearer [N s/m]

    def bind(self, body: Body, duration: float) -> "GuardField":
        """See `Primitive.bind`."""
        names = body.map.keep_apart if self.pairs is None else self.pairs
        if not names:
            raise PrimitiveError(
                f"the body map of {body.map.name!r} keeps no links apart; name pairs of links"
            )
        capsules = body.capsules({name for pair in names for name in pair})
        pairs = np.concatenate([_pair(body, capsules, a, b) for a, b in names])
        guard = np.zeros(1, dtype=GUARD)
        guard["count"] = len(pairs)
        guard["range"], guard["stiffness"], guard["damping"] = (
            self.range,
            self.stiffness,
            self.damping,
        )
        rows = np.zeros(len(capsules.link), dtype=CAPSULE)
        for column in ("link", "start", "end", "radius"):
            rows[column] = getattr(capsules, column)
        return GuardField(body, guard, pairs, rows)


def _pair(body: Body, capsules: Capsules, one: str, other: str) -> Records:
    """A row of PAIR."""
    row = np.zeros(1, dtype=PAIR)
    for end, name in (("a", one), ("b", other)):
        link = body.link(name)
        own = np.flatnonzero(capsules.link == link)  # capsules are sorted by link
        if not own.size:
            raise PrimitiveError(f"link {name!r} has no geom that collides, so nothing to avoid")
        centre, radius = _ball(capsules, own)
        row[f"link_{end}"], row[f"first_{end}"], row[f"count_{end}"] = link, own[0], own.size
        row[f"centre_{end}"], row[f"radius_{end}"] = centre, radius
    return row


def _ball(capsules: Capsules, own: NDArray[np.intp]) -> tuple[FloatArray, float]:
    """A ball around some capsules of one link."""
    ends = np.concatenate([capsules.start[own], capsules.end[own]])
    thick = np.concatenate([capsules.radius[own]] * 2)
    centre: FloatArray = 0.5 * (ends.min(axis=0) + ends.max(axis=0))
    return centre, float(np.max(np.linalg.norm(ends - centre, axis=1) + thick))


class GuardField(CompiledField):
    """Repulsion between pairs of links: see `repulsion`."""

    def __init__(self, body: Body, guard: Records, pairs: Records, rows: Records) -> None:
        super().__init__(body, NO_JOINTS, unit="")
        self._guard, self._pairs, self._capsules = guard, pairs, rows

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        first = table.records(self._capsules)
        pairs = self._pairs.copy()
        pairs["first_a"] += first
        pairs["first_b"] += first
        guard = self._guard.copy()
        guard["pairs"] = table.records(pairs)
        return table.field(GUARDING, table.records(guard), self.claims)

"""avoid-collisions: keep links that must not touch apart, whatever else moves them.

Mataric, Zordan & Williamson (1999), section 9, run it beside any get-posture or go-to-point
"in order to generate safe, collision-free movement". It claims no joints: its torques are
added to those of whatever moves the body. A hand that is to touch a link is let through to
that one link as its set point arrives there.
"""

from typing import Annotated, Literal

import numpy as np

from primitives.compiled import Records
from primitives.compiled_field import CompiledField
from primitives.errors import PrimitiveError
from primitives.parameters import Damping, Positive, Stiffness
from primitives.primitive import NO_JOINTS, Primitive
from primitives.quantity import Quantity
from primitives.repulsion import CAPSULE, GUARD, GUARDED, PAIR
from primitives.table import GUARDING, TableBuilder
from sim import Body, pushed_apart

Range = Annotated[Positive, Quantity.LENGTH]


class AvoidCollisions(Primitive):
    """Push links apart before they touch."""

    kind: Literal["avoid-collisions"] = "avoid-collisions"
    pairs: tuple[tuple[str, str], ...] | None = None  # of links; default: the body's keep_apart
    range: Range | None = None  # distance at which it begins to push [m]; default: the body's
    stiffness: Stiffness | None = None  # force at contact, per metre of range [N/m]; the same
    damping: Damping | None = None  # of drawing nearer [N s/m]; the same

    def bind(self, body: Body, duration: float) -> "GuardField":
        """See `Primitive.bind`."""
        names = pushed_apart(body) if self.pairs is None else self.pairs
        if not names:
            raise PrimitiveError(
                f"the body map of {body.map.name!r} keeps no links apart; name pairs of links"
            )
        links = tuple(dict.fromkeys(name for pair in names for name in pair))
        shapes = body.capsules(links)
        capsules = np.zeros(len(shapes.link), dtype=CAPSULE)
        capsules["link"], capsules["radius"] = shapes.link, shapes.radius
        capsules["middle"] = 0.5 * (shapes.start + shapes.end)
        capsules["half"] = 0.5 * (shapes.end - shapes.start)
        capsules["squared"] = np.sum(capsules["half"] ** 2, axis=1)
        capsules["reach"] = np.linalg.norm(capsules["half"], axis=1) + shapes.radius
        guarded = np.concatenate([_guarded(body, capsules, name) for name in links])
        pairs = np.array([(links.index(a), links.index(b)) for a, b in names], dtype=PAIR)
        guard = np.zeros(1, dtype=GUARD)
        guard["link_count"], guard["pair_count"] = len(links), len(pairs)
        for name, usual in body.map.guard:
            given = getattr(self, name)
            guard[name] = usual if given is None else given
        return GuardField(body, guard, guarded, pairs, capsules)


def _guarded(body: Body, capsules: Records, name: str) -> Records:
    """A row of GUARDED; the capsules are sorted by link."""
    row = np.zeros(1, dtype=GUARDED)
    own = np.flatnonzero(capsules["link"] == body.link(name))
    if not own.size:
        raise PrimitiveError(f"link {name!r} has no geom that collides, so nothing to avoid")
    mine = capsules[own]
    ends = np.concatenate([mine["middle"] - mine["half"], mine["middle"] + mine["half"]])
    centre = 0.5 * (ends.min(axis=0) + ends.max(axis=0))
    thick = np.concatenate([mine["radius"]] * 2)
    row["link"], row["first"], row["count"] = body.link(name), own[0], own.size
    row["centre"] = centre
    row["reach"] = np.max(np.linalg.norm(ends - centre, axis=1) + thick)
    return row


class GuardField(CompiledField):
    """Repulsion between pairs of links: see `repulsion`."""

    def __init__(
        self, body: Body, guard: Records, guarded: Records, pairs: Records, capsules: Records
    ) -> None:
        super().__init__(body, NO_JOINTS, unit="")
        self._guard, self._guarded, self._pairs = guard, guarded, pairs
        self._capsules = capsules

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        guarded, guard = self._guarded.copy(), self._guard.copy()
        guarded["first"] += table.records(self._capsules)
        guard["links"] = table.records(guarded)
        guard["pairs"] = table.records(self._pairs)
        return table.field(GUARDING, table.records(guard), self.claims)

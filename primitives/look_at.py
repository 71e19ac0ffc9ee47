"""look-at: turn the head until it faces a place, and keep facing it while it moves.

The law is in `gaze`. What a head is, the body map says.
"""

from typing import Literal

import numpy as np

from primitives.compiled_field import CompiledField
from primitives.errors import PrimitiveError
from primitives.gaze import Looking
from primitives.parameters import SETTLE, Damping, Stiffness, Time, settling
from primitives.primitive import FloatArray, IntArray, Primitive
from primitives.table import GAZE, TableBuilder
from primitives.target import Target, locate, refuse_own
from sim import Body, Spot, carrier, find_gaze, moving_dofs

LEVEL = 0.5  # stiffness that keeps the ears level, as a share of the stiffness of the gaze


class LookAt(Primitive):
    """Turn the head to a place, and keep facing it while it moves."""

    kind: Literal["look-at"] = "look-at"
    at: str | Target  # a landmark, or {hand: LIMB}, {near: LANDMARK, away: …}, {point: […]}
    joints: tuple[str, ...] | None = None  # that turn it; default: the head's, without the waist
    settle: Time = SETTLE  # time in which it turns there [s]
    stiffness: Stiffness | None = None  # [N m/rad]; default: that of the joints' stiffest servo
    damping: Damping | None = None  # [N m s/rad]; the same

    def bind(self, body: Body, duration: float) -> "GazeField":
        """See `Primitive.bind`."""
        head = find_gaze(body)
        dofs = head.dofs if self.joints is None else body.joints(self.joints)
        if not len(dofs):
            raise PrimitiveError("joints is empty: name those that turn the head, or leave it out")
        for dof in (int(d) for d in dofs):
            if dof not in moving_dofs(body, head.link):
                raise PrimitiveError(f"{body.dof_name(dof)!r} does not turn the head")
        root = carrier(body, dofs)
        spot = locate(body, self.at, head.root)
        if spot.link == head.root != root:  # a point stays behind when the waist turns too
            place = body.at_home(spot.link, spot.point) - body.at_home(root, np.zeros(3))
            if isinstance(self.at, Target) and self.at.point is not None:
                spot = Spot(root, body.to_link(root, place), spot.normal)
        refuse_own(body, spot, dofs, "look-at", self.at)
        servos = [body.servo(int(dof)) for dof in head.dofs]
        stiffness = self.stiffness or max(s.stiffness for s in servos)
        damping = max(s.damping for s in servos) if self.damping is None else self.damping
        up = np.array([0.0, 0.0, 1.0])
        left = np.cross(body.to_link(head.link, up), head.forward)
        looking = Looking(
            link=head.link,
            root=root,
            goal_link=spot.link,
            goal=tuple(spot.point),
            eyes=tuple(head.eyes),
            forward=tuple(head.forward),
            left=tuple(left / np.linalg.norm(left)),
            up=tuple(body.to_link(root, up)),
            stiffness=stiffness,
            damping=damping,
            level=LEVEL * stiffness,
        )
        return GazeField(body, dofs, looking, settling(self.settle, duration))


class GazeField(CompiledField):
    """Turns a head: see `gaze`."""

    passive = True

    def __init__(self, body: Body, claims: IntArray, looking: Looking, settle: float) -> None:
        super().__init__(body, claims, unit="rad")
        self._looking, self._settle = looking, settle

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        row = table.numbers(flat(self._looking))
        return table.field(GAZE, row, self.claims, duration=self._settle)


def flat(parts: tuple[object, ...]) -> FloatArray:
    """Numbers and vectors, one after the other."""
    return np.concatenate([np.ravel(np.asarray(part, dtype=float)) for part in parts])

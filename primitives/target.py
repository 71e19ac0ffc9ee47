"""What look-at, point-at and follow are aimed at: a place that may move with the body."""

from typing import Self

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator

from primitives.errors import PrimitiveError
from primitives.parameters import Length, Offset
from primitives.primitive import IntArray
from sim import Body, Spot, moving_dofs


class Target(BaseModel):
    """A landmark, the palm of a hand, or a point in the frame of the link that carries the limb."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    near: str | None = None  # a landmark
    hand: str | None = None  # a limb: the centre of its palm
    away: Length = 0.0  # this far out along the normal of the landmark or palm [m]
    point: Offset | None = None  # forward, left, up of the trunk's origin [m]
    offset: Offset = (0.0, 0.0, 0.0)  # added: forward, left, up at home; it turns with the link [m]

    @model_validator(mode="after")
    def _one_of(self) -> Self:
        if sum(given is not None for given in (self.near, self.hand, self.point)) != 1:
            raise ValueError("give one of near (a landmark), hand (a limb) and point")
        if self.point is not None and self.away != 0.0:
            raise ValueError("away goes with near or hand: a point has no surface")
        return self


def target_of(said: str | Target) -> Target:
    """A target; a word is a landmark."""
    return Target(near=said) if isinstance(said, str) else said


def locate(body: Body, said: str | Target, root: int) -> Spot:
    """A target as a point of a link.

    Args:
        body: where its names are looked up.
        said: the target; a word is a landmark.
        root: the link in whose frame a `point` is given.

    Raises:
        BodyError: a name that the body lacks.
    """
    target = target_of(said)
    if target.point is not None:
        return Spot(root, body.to_link(root, np.add(target.point, target.offset)), np.zeros(3))
    spot = body.arm(target.hand).palm if target.hand else body.landmark(target.near or "")
    out = target.away * spot.normal + body.to_link(spot.link, np.array(target.offset))
    return Spot(spot.link, spot.point + out, spot.normal)


def refuse_own(body: Body, spot: Spot, dofs: IntArray, what: str, said: object) -> None:
    """Refuse a target that moves with the joints that are to be turned towards it.

    Raises:
        PrimitiveError: naming one of the joints.
    """
    carried = [int(dof) for dof in dofs if int(dof) in moving_dofs(body, spot.link)]
    if carried:
        name = said if isinstance(said, str) else "the target"
        raise PrimitiveError(
            f"{what} cannot be aimed at {name!r}: {body.dof_name(carried[0])}, which it turns,"
            " carries that along"
        )

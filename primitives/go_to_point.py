"""go-to-point: bring the palm of a hand to a place on or near the body.

Mataric, Zordan & Williamson (1999) propose it as the generic primitive for sub-tasks that
are said in a body-centred Cartesian frame ("touch right hand to the back of your head").
Its controller is the impedance of their section 7.
"""

from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator
from pydantic import Field as Parameter

from primitives.compiled import Records
from primitives.compiled_field import CompiledField
from primitives.get_posture import (
    BACKGROUND_SETTLING,
    Direction,
    NonNegative,
    Positive,
    Share,
    via_times,
)
from primitives.impedance import POINT, REACH
from primitives.primitive import FloatArray, Primitive
from primitives.set_point import MOST_KNOTS, Profile
from primitives.table import REACHING, TableBuilder
from sim import Arm, Body

Vector = tuple[float, float, float]


class Place(BaseModel):
    """A point: near a landmark of the body, or in the frame of the link that carries the arm."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    near: str | None = None  # a landmark
    away: float = 0.0  # this far out along its normal [m]
    point: Vector | None = None  # forward, left, up of the trunk's origin [m]
    offset: Vector = (0.0, 0.0, 0.0)  # added: forward, left, up [m]

    @model_validator(mode="after")
    def _one_of(self) -> "Place":
        if (self.near is None) == (self.point is None):
            raise ValueError("give either near (a landmark) or point")
        return self


class ViaPlace(Place):
    """A place that the hand passes on its way."""

    at: Share | None = None  # when, as a share of the movement; evenly spread by default


class GoToPoint(Primitive):
    """Bring the palm to a place and hold it there; to a landmark means touching it."""

    kind: Literal["go-to-point"] = "go-to-point"
    controller: Literal["impedance"] = "impedance"
    limb: str
    to: str | Place  # a landmark, which is touched, or a place
    via: Annotated[tuple[ViaPlace, ...], Parameter(max_length=MOST_KNOTS - 2)] = ()
    palm: Direction | None = None  # where it faces; default: onto the landmark
    fingers: Direction | None = None  # where they point; default: free
    upper_arm: Direction | None = None  # where the elbow is, seen from the shoulder
    profile: Profile = "minimum-jerk"  # of the set point
    travel: Annotated[float, Parameter(gt=0, le=1)] = 0.85  # share of the time it moves
    # Gains of the springs; default: the body's.
    stiffness: Positive | None = None  # [N/m]
    damping: NonNegative | None = None  # [N s/m]
    turn_stiffness: Positive | None = None  # [N m/rad]
    turn_damping: NonNegative | None = None  # [N m s/rad]
    upper_arm_stiffness: Positive | None = None  # [N m/rad]
    upper_arm_damping: NonNegative | None = None  # [N m s/rad]
    shoulder_damping: NonNegative | None = None  # [N m s/rad]

    def bind(self, body: Body, duration: float) -> "ReachField":
        """See `Primitive.bind`."""
        arm = body.arm(self.limb)
        goal = Place(near=self.to) if isinstance(self.to, str) else self.to
        points = np.concatenate([_locate(body, arm, place) for place in (*self.via, goal)])
        reach = np.zeros(1, dtype=REACH)
        reach["hand"], reach["upper_arm"], reach["forearm"] = arm.hand, arm.upper_arm, arm.forearm
        reach["root"], reach["palm"], reach["palm_normal"] = (
            arm.root,
            arm.palm.point,
            arm.palm.normal,
        )
        reach["fingers"] = arm.fingers
        reach["touched"] = body.landmark(self.to).link if isinstance(self.to, str) else -1
        if self.palm is not None:
            reach["turns_palm"], reach["normal_link"] = True, arm.root
            reach["normal_goal"] = body.to_link(arm.root, body.direction(self.palm))
        elif isinstance(self.to, str):
            surface = body.landmark(self.to)
            reach["turns_palm"], reach["normal_link"] = True, surface.link
            reach["normal_goal"] = -surface.normal
        for part in ("fingers", "upper_arm"):
            wanted = getattr(self, part)
            if wanted is not None:
                reach[f"turns_{part}"] = True
                reach[f"{part}_goal"] = body.to_link(arm.root, body.direction(wanted))
        for gain, default in arm.limb.spring.model_dump().items():
            given = getattr(self, gain)
            reach[gain] = default if given is None else given
        moving = self.travel * duration if np.isfinite(duration) else BACKGROUND_SETTLING
        times = via_times([v.at for v in self.via])
        return ReachField(body, arm, reach, points, self.profile, times, moving)


def _locate(body: Body, arm: Arm, place: Place) -> Records:
    """A row of POINT."""
    row = np.zeros(1, dtype=POINT)
    if place.near is not None:
        mark = body.landmark(place.near)
        row["link"] = mark.link
        point = mark.point + place.away * mark.normal
    else:
        row["link"] = arm.root
        point = body.to_link(arm.root, np.array(place.point))
    row["point"] = point + body.to_link(int(row["link"][0]), np.array(place.offset))
    return row


class ReachField(CompiledField):
    """Springs on a hand and an upper arm: see `impedance`."""

    def __init__(
        self,
        body: Body,
        arm: Arm,
        reach: Records,
        points: Records,
        profile: Profile,
        times: tuple[float, ...],
        duration: float,
    ) -> None:
        super().__init__(body, arm.dofs, unit="m")
        self._arm, self._reach, self._points = arm, reach, points
        self._profile, self._times, self._duration = profile, times, duration

    def too_far(self) -> float:
        """By how much the goal is out of reach in the home posture [m]; 0 if it is not."""
        goal = self._points[-1]
        place = self._body.at_home(int(goal["link"]), goal["point"])
        shoulder = self._body.at_home(self._arm.upper_arm, np.zeros(3))
        return max(0.0, float(np.linalg.norm(place - shoulder)) - self._body.reach(self._arm))

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        reach = self._reach.copy()
        reach["points"] = table.records(self._points)
        return table.field(
            REACHING,
            table.records(reach),
            self.claims,
            duration=self._duration,
            curve=table.curve(self._profile, self._times),
            knots=len(self._times),
        )


__all__ = ["FloatArray", "GoToPoint", "Place", "ReachField", "ViaPlace"]

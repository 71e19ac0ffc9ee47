"""go-to-point: bring the palm of a hand to a place on or near the body.

Mataric, Zordan & Williamson (1999) propose it as the generic primitive for sub-tasks that
are said in a body-centred Cartesian frame ("touch right hand to the back of your head"). The
controller is a choice: the impedance of their section 7, or the force on the hand that they
set aside. A joint-space controller can do it too: inverse kinematics then turns the places
into postures when the task is bound.
"""

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator
from pydantic import Field as Parameter

from primitives.parameters import (
    PROFILES,
    Approach,
    Controller,
    Damping,
    Direction,
    Length,
    Offset,
    Positive,
    Share,
    Stiffness,
    background_settling,
    check_own,
    via_times,
)
from primitives.posture_field import PostureField, joint_gains
from primitives.primitive import FloatArray, Primitive
from primitives.reach_field import HandGoal, ReachField
from primitives.set_point import MOST_KNOTS, Profile
from sim import Arm, Body, PalmGoal, Spot, reach


class Place(BaseModel):
    """A point: near a landmark of the body, or in the frame of the link that carries the arm."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    near: str | None = None  # a landmark
    away: Length = 0.0  # this far out along its normal [m]
    point: Offset | None = None  # forward, left, up of the trunk's origin [m]
    offset: Offset = (0.0, 0.0, 0.0)  # added: forward, left, up at home; it turns with the link [m]

    @model_validator(mode="after")
    def _one_of(self) -> "Place":
        if (self.near is None) == (self.point is None):
            raise ValueError("give either near (a landmark) or point")
        return self


class ViaPlace(Place):
    """A place that the hand passes on its way."""

    at: Share | None = None  # when, as a share of the movement; evenly spread by default
    pulse: Positive = 0.5  # size of its pulse (torque-field): at 0.5 it peaks at a step's weight


class GoToPoint(Primitive):
    """Bring the palm to a place and hold it there; to a landmark means touching it."""

    kind: Literal["go-to-point"] = "go-to-point"
    controller: Controller = "impedance"  # how it makes torque: see docs/controllers.md
    limb: str  # an arm
    to: str | Place  # a landmark, which is touched, or a place
    # places on the way
    via: Annotated[tuple[ViaPlace, ...], Parameter(max_length=MOST_KNOTS - 2)] = ()
    palm: Direction | None = None  # where it faces; default: onto the landmark
    fingers: Direction | None = None  # where they point; default: free
    upper_arm: Direction | None = None  # where the elbow is, seen from the shoulder
    profile: Profile | None = None  # of the set point; default: what suits the controller
    travel: Annotated[float, Parameter(gt=0, le=1)] = 0.85  # share of the time it moves
    # Gains; default: the body's. Of the palm [N/m, N s/m], in joints [N m/rad, N m s/rad].
    stiffness: Stiffness | None = None
    damping: Damping | None = None
    # Further gains of the impedance.
    turn_stiffness: Stiffness | None = None  # [N m/rad]
    turn_damping: Damping | None = None  # [N m s/rad]
    upper_arm_stiffness: Stiffness | None = None  # [N m/rad]
    upper_arm_damping: Damping | None = None  # [N m s/rad]
    shoulder_damping: Damping | None = None  # [N m s/rad]
    # Of the force on the hand.
    approach: Approach | None = None  # c of eq 10 [N s/m^2]
    joint_damping: Damping | None = None  # [N m s/rad]
    # Of a torque field.
    width: Positive | None = None  # of its wells [rad]; eq 3: 1 / sqrt(stiffness)
    coupled: bool = False  # whether its wells are coupled

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_own(self.controller, self.model_fields_set)
        return self

    def bind(self, body: Body, duration: float) -> ReachField | PostureField:
        """See `Primitive.bind`."""
        arm = body.arm(self.limb)
        goal = self.hand_goal(body, arm)
        times = via_times([v.at for v in self.via])
        moving = self.travel * duration if np.isfinite(duration) else background_settling(body)
        profile = self.profile or PROFILES[self.controller]
        match self.controller:
            case "impedance" | "endpoint-force" as controller:
                gains = {name: getattr(self, name) for name in type(arm.limb.spring).model_fields}
                return ReachField(
                    body, arm, goal, times, moving, controller, gains, profile=profile
                )
            case controller:
                postures, misses = _postures(body, arm, goal)
                gained = joint_gains(
                    body, arm.dofs, stiffness=self.stiffness, damping=self.damping,
                    width=self.width, coupled=self.coupled,
                )  # fmt: skip
                return PostureField(
                    body, arm.dofs, postures, times, moving, controller, gained,
                    profile=profile,
                    pulses=tuple(v.pulse for v in self.via),
                    touch=(arm.hand, goal.touched),
                    miss=float(misses[-1]),
                )  # fmt: skip

    def palm_goal(self, body: Body) -> PalmGoal:
        """Where the palm is to be in the end, as inverse kinematics wants it."""
        arm = body.arm(self.limb)
        return _palm_goal(body, arm, self.hand_goal(body, arm))

    def hand_goal(self, body: Body, arm: Arm) -> HandGoal:
        """The places that the palm is to pass, and how it is to be turned in the end."""
        to = Place(near=self.to) if isinstance(self.to, str) else self.to
        normal, touched = None, -1
        if isinstance(self.to, str):
            surface = body.landmark(self.to)
            touched, normal = surface.link, (surface.link, -surface.normal)
        if self.palm is not None:
            normal = (arm.root, body.to_link(arm.root, body.direction(self.palm)))
        fingers, upper_arm = (
            None if said is None else body.to_link(arm.root, body.direction(said))
            for said in (self.fingers, self.upper_arm)
        )
        places = tuple(_locate(body, arm, place) for place in (*self.via, to))
        return HandGoal(places, normal, fingers, upper_arm, touched)


def _locate(body: Body, arm: Arm, place: Place) -> Spot:
    """A place as a point of a link."""
    if place.near is not None:
        mark = body.landmark(place.near)
        link, point = mark.link, mark.point + place.away * mark.normal
    else:
        link, point = arm.root, body.to_link(arm.root, np.array(place.point))
    return Spot(link, point + body.to_link(link, np.array(place.offset)), np.zeros(3))


def _palm_goal(body: Body, arm: Arm, goal: HandGoal) -> PalmGoal:
    """The last place of a goal, directions being in the body's frame."""

    def in_body(part: tuple[int, FloatArray] | None) -> FloatArray | None:
        return None if part is None else body.from_link(*part)

    return PalmGoal(
        goal.places[-1],
        normal=in_body(goal.normal),
        fingers=in_body(None if goal.fingers is None else (arm.root, goal.fingers)),
        upper_arm=in_body(None if goal.upper_arm is None else (arm.root, goal.upper_arm)),
        touched=goal.touched,
    )


def _postures(body: Body, arm: Arm, goal: HandGoal) -> tuple[FloatArray, FloatArray]:
    """Postures (places, nv) for the places of a goal, and by how much each misses [m]."""
    on_the_way = [PalmGoal(place, touched=goal.touched) for place in goal.places[:-1]]
    return reach(body, arm, [*on_the_way, _palm_goal(body, arm, goal)])

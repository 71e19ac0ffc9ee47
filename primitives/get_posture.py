"""get-posture: bring joints into a posture and hold them there.

Mataric, Zordan & Williamson (1999) propose it as the generic primitive for sub-tasks that
are postures ("extend right arm straight out, palm down"). The controller is a choice: the PD
servo of their section 5, whose set point runs through via postures on a spline, or the torque
field of section 6. A posture of an arm can also be left to a Cartesian controller, which then
brings the palm where the posture has it, turned as the posture turns it.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator
from pydantic import Field as Parameter

from primitives.errors import PrimitiveError
from primitives.parameters import (
    PROFILES,
    Controller,
    Damping,
    Direction,
    Positive,
    Share,
    Stiffness,
    background_settling,
    check_own,
    via_times,
)
from primitives.posture_field import PostureField, joint_gains
from primitives.primitive import FloatArray, IntArray, Primitive
from primitives.reach_field import HandGoal, ReachField
from primitives.set_point import MOST_KNOTS, Profile
from sim import Arm, ArmWords, Body, BodyError, Spot, pose, unknown

# The name of a posture of the body, or what to do with each part: for an arm `arm` and
# `palm` take a direction, `elbow` is `straight` or degrees; joints take degrees.
Posture = str | dict[str, float | Direction]


class ViaPosture(BaseModel):
    """A posture that the movement passes through on its way."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    posture: Posture  # a name, or what to do with each part of an arm and each joint
    at: Share | None = None  # when, as a share of the movement; evenly spread by default
    pulse: Positive = 0.5  # size of its pulse (torque-field): at 0.5 it peaks at a step's weight


class GetPosture(Primitive):
    """Bring a limb or joints into a posture and hold them there."""

    kind: Literal["get-posture"] = "get-posture"
    controller: Controller = "pd-servo"  # how it makes torque: see docs/controllers.md
    limb: str | None = None  # an arm of the body, or
    joints: tuple[str, ...] | None = None  # joints and joint groups; `all` is every joint
    posture: Posture  # a name, or what to do with each part of an arm and each joint
    # postures on the way
    via: Annotated[tuple[ViaPosture, ...], Parameter(max_length=MOST_KNOTS - 2)] = ()
    profile: Profile | None = None  # of the set point; default: what suits the controller
    travel: Annotated[float, Parameter(gt=0, le=1)] = 1.0  # share of the time it moves
    # Gains; default: the body's. In joints [N m/rad, N m s/rad], of the palm [N/m, N s/m].
    stiffness: Stiffness | None = None
    damping: Damping | None = None
    width: Positive | None = None  # of a torque field's wells [rad]; eq 3: 1 / sqrt(stiffness)
    coupled: bool = False  # whether the wells of a torque field are coupled
    # Gains of the Cartesian controllers.
    turn_stiffness: Stiffness | None = None  # [N m/rad]
    turn_damping: Damping | None = None  # [N m s/rad]

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.limb is None) == (self.joints is None):
            raise ValueError("give either limb or joints")
        if self.limb is None and self.controller in ("impedance", "endpoint-force"):
            raise ValueError(f"the controller {self.controller} moves an arm: give limb")
        check_own(self.controller, self.model_fields_set)
        return self

    def bind(self, body: Body, duration: float) -> PostureField | ReachField:
        """See `Primitive.bind`."""
        claims = body.arm(self.limb).dofs if self.limb else body.joints(self.joints or ())
        postures = np.array(
            [self._angles(body, claims, p) for p in (*(v.posture for v in self.via), self.posture)]
        )
        times = via_times([v.at for v in self.via])
        moving = self.travel * duration if np.isfinite(duration) else background_settling(body)
        profile = self.profile or PROFILES[self.controller]
        match self.controller:
            case "impedance" | "endpoint-force" as controller:
                arm = body.arm(self.limb or "")
                gains = {name: getattr(self, name) for name in CARTESIAN_GAINS}
                goal = _hand_goal(body, arm, postures)
                return ReachField(
                    body, arm, goal, times, moving, controller, gains, profile=profile
                )
            case controller:
                gained = joint_gains(
                    body, claims, stiffness=self.stiffness, damping=self.damping,
                    width=self.width, coupled=self.coupled,
                )  # fmt: skip
                return PostureField(
                    body, claims, postures, times, moving, controller, gained,
                    profile=profile,
                    pulses=tuple(v.pulse for v in self.via),
                )  # fmt: skip

    def _angles(self, body: Body, claims: IntArray, posture: Posture) -> FloatArray:
        """The posture as joint angles (nv,), complete over the claimed joints."""
        if isinstance(posture, str):
            angles = body.posture(posture).copy()
        else:
            angles = said_angles(body, self.limb, tuple(posture.items())).copy()
        missing = [body.dof_name(int(d)) for d in claims if np.isnan(angles[d])]
        if missing:
            raise PrimitiveError(
                f"posture {posture!r} says nothing about {', '.join(missing)},"
                f" which {self.limb or list(self.joints or ())} includes"
            )
        angles[np.isnan(angles)] = 0.0
        return angles


ARM_PARTS = ("arm", "palm", "elbow")  # what can be said of an arm besides its joints
CARTESIAN_GAINS = ("stiffness", "damping", "turn_stiffness", "turn_damping")


def _hand_goal(body: Body, arm: Arm, postures: FloatArray) -> HandGoal:
    """Where postures (p, nv) put the palm, and how the last of them turns it."""
    of_arm = np.full(postures.shape, np.nan)
    of_arm[:, arm.dofs] = postures[:, arm.dofs]
    held = [body.palm_goal(arm, angles) for angles in of_arm]
    _, normal, fingers, upper_arm = held[-1]
    return HandGoal(
        places=tuple(Spot(arm.root, place, normal) for place, *_ in held),
        normal=(arm.root, normal),
        fingers=fingers,
        upper_arm=upper_arm,
        by_neutral=True,
    )


@lru_cache(maxsize=4096)
def said_angles(
    body: Body, limb: str | None, words: tuple[tuple[str, float | Direction], ...]
) -> FloatArray:
    """Angles (nv,) [rad] of a posture said part by part; NaN where it says nothing.

    Args:
        body: where its names are looked up.
        limb: the arm that it is of; None for a posture of joints alone.
        words: the parts and what is said of each, see `Posture`.

    Raises:
        BodyError: a name that the body lacks, or nothing within the joint limits comes near.
        PrimitiveError: a part that means nothing here, or that is given twice.
    """
    said = dict(words)
    about_arm = {part: said.pop(part) for part in ARM_PARTS if part in said}
    angles, given = np.full(body.nv, np.nan), dict[int, str]()
    if limb is None and about_arm:
        raise PrimitiveError(f"{', '.join(about_arm)}: only a posture of a limb can say this")
    arm = None if limb is None else body.arm(limb)
    if arm is not None and about_arm:
        if about_arm.keys() - {"elbow"}:
            angles = pose(body, arm, arm_words(body, about_arm))
        else:
            angles = body.angles({arm.limb.elbow: _elbow(about_arm["elbow"])})
        if "elbow" in about_arm:
            given[int(body.joints(arm.limb.elbow)[0])] = "elbow"
    for key, value in said.items():
        joint = key if arm is None else _own_joint(body, arm, key)
        if isinstance(value, str | tuple):
            raise PrimitiveError(f"{joint} takes an angle in degrees, not {value!r}")
        for dof in body.joints(joint).tolist():
            if dof in given:
                twice = body.dof_name(dof)
                raise PrimitiveError(f"{twice} is given twice: by {given[dof]!r} and by {key!r}")
            given[dof] = key
        added = body.angles({joint: value})
        angles = np.where(np.isnan(added), angles, added)
    return angles


def _own_joint(body: Body, arm: Arm, name: str) -> str:
    """`wrist_z` of the right arm is `right_wrist_z`.

    Raises:
        PrimitiveError: it is neither a part of the arm nor one of its joints.
    """
    side, joints = f"{arm.limb.side}_", arm.limb.joints
    if side + name in joints:
        return side + name
    try:
        moved = set(body.joints(name).tolist())
    except BodyError:
        moved = set()
    if not moved or not moved <= set(arm.dofs.tolist()):
        parts = {*ARM_PARTS, *joints, *(joint.removeprefix(side) for joint in joints)}
        raise PrimitiveError(unknown(f"joint or part of {arm.name}", name, parts))
    return name


def _elbow(value: float | Direction) -> float:
    if value == "straight":
        return 0.0
    if isinstance(value, str | tuple):
        raise PrimitiveError(f"elbow is straight or an angle in degrees, not {value!r}")
    return float(value)


def arm_words(body: Body, words: Mapping[str, float | Direction]) -> ArmWords:
    """What is said of an arm as a whole, in the body's terms.

    Args:
        body: whose directions they are.
        words: what is said of each part; what is not about the arm as a whole is left aside.

    Raises:
        BodyError, PrimitiveError: there is no such direction, or no such angle.
    """

    def direction(part: str) -> FloatArray | None:
        value = words.get(part)
        if value is None:
            return None
        if isinstance(value, float | int):
            raise PrimitiveError(f"{part} takes a direction such as forward, not {value!r}")
        return body.direction(value)

    elbow = np.deg2rad(_elbow(words["elbow"])) if "elbow" in words else None
    return ArmWords(direction=direction("arm"), palm=direction("palm"), elbow=elbow)

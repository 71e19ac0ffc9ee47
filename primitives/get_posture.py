"""get-posture: bring joints into a posture and hold them there.

Mataric, Zordan & Williamson (1999) propose it as the generic primitive for sub-tasks that
are postures ("extend right arm straight out, palm down"). Its controller is the PD servo of
their section 5, whose set point runs through via postures on a spline.
"""

from functools import lru_cache
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator
from pydantic import Field as Parameter

from primitives.compiled_field import CompiledField
from primitives.errors import PrimitiveError
from primitives.primitive import FloatArray, IntArray, Primitive
from primitives.set_point import MOST_KNOTS, Profile
from primitives.table import POSTURE, TableBuilder
from sim import ArmWords, Body, BodyError, pose

Direction = str | tuple[float, float, float]
Share = Annotated[float, Parameter(gt=0, lt=1)]
Positive = Annotated[float, Parameter(gt=0)]
NonNegative = Annotated[float, Parameter(ge=0)]
# The name of a posture of the body, or what to do with each part: for an arm `arm` and
# `palm` take a direction, `elbow` is `straight` or degrees; joints take degrees.
Posture = str | dict[str, float | Direction]


class ViaPosture(BaseModel):
    """A posture that the movement passes through on its way."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    posture: Posture
    at: Share | None = None  # when, as a share of the movement; evenly spread by default


class GetPosture(Primitive):
    """Bring a limb or joints into a posture and hold them there."""

    kind: Literal["get-posture"] = "get-posture"
    controller: Literal["pd-servo"] = "pd-servo"
    limb: str | None = None  # an arm of the body, or
    joints: tuple[str, ...] | None = None  # joints and joint groups; `all` is every joint
    posture: Posture
    via: Annotated[tuple[ViaPosture, ...], Parameter(max_length=MOST_KNOTS - 2)] = ()
    profile: Profile = "spline"  # of the set point
    travel: Annotated[float, Parameter(gt=0, le=1)] = 1.0  # share of the time it moves
    stiffness: Positive | None = None  # k of every joint [N m/rad]; default: the body's
    damping: NonNegative | None = None  # k_d of every joint [N m s/rad]; default: the body's

    @model_validator(mode="after")
    def _one_of(self) -> "GetPosture":
        if (self.limb is None) == (self.joints is None):
            raise ValueError("give either limb or joints")
        return self

    def bind(self, body: Body, duration: float) -> "PostureField":
        """See `Primitive.bind`."""
        claims = body.arm(self.limb).dofs if self.limb else body.joints(self.joints or ())
        postures = [
            self._angles(body, claims, p) for p in (*(v.posture for v in self.via), self.posture)
        ]
        stiffness, damping = np.zeros(body.nv), np.zeros(body.nv)
        for dof in claims:
            servo = body.servo(int(dof))
            stiffness[dof] = servo.stiffness if self.stiffness is None else self.stiffness
            damping[dof] = servo.damping if self.damping is None else self.damping
        times = via_times([v.at for v in self.via])
        moving = self.travel * duration if np.isfinite(duration) else BACKGROUND_SETTLING
        return PostureField(
            body, claims, np.array(postures), stiffness, damping, self.profile, times, moving
        )

    def _angles(self, body: Body, claims: IntArray, posture: Posture) -> FloatArray:
        """The posture as joint angles (nv,), complete over the claimed joints."""
        if isinstance(posture, str):
            angles = body.posture(posture).copy()
        else:
            angles = _said(body, self.limb, tuple(posture.items())).copy()
        missing = [body.dof_name(int(d)) for d in claims if np.isnan(angles[d])]
        if missing:
            raise PrimitiveError(
                f"posture {posture!r} says nothing about {', '.join(missing)},"
                f" which {self.limb or list(self.joints or ())} includes"
            )
        angles[np.isnan(angles)] = 0.0
        return angles


# Time in which a background posture moves its set point from where the body is [s].
BACKGROUND_SETTLING = 0.5


def via_times(given: list[float | None]) -> tuple[float, ...]:
    """Times of start, via points and goal as shares of the movement.

    Raises:
        PrimitiveError: they do not rise.
    """
    count = len(given)
    times = [(k + 1) / (count + 1) if at is None else float(at) for k, at in enumerate(given)]
    whole = (0.0, *times, 1.0)
    if any(b <= a for a, b in pairwise(whole)):
        shown = ", ".join(f"{t:.2g}" for t in times)
        raise PrimitiveError(f"the times of via points must rise between 0 and 1, not {shown}")
    return whole


@lru_cache(maxsize=4096)
def _said(
    body: Body, limb: str | None, words: tuple[tuple[str, float | Direction], ...]
) -> FloatArray:
    """Angles (nv,) [rad] of a posture said part by part; NaN where it says nothing."""
    said = dict(words)
    parts = ("arm", "palm", "elbow")
    about_arm: dict[str, float | Direction] = {p: said.pop(p) for p in parts if p in said}
    angles = np.full(body.nv, np.nan)
    if limb is None and about_arm:
        raise PrimitiveError(f"{', '.join(about_arm)}: only a posture of a limb can say this")
    if limb is not None:
        arm = body.arm(limb)
        if about_arm.keys() - {"elbow"}:
            angles = pose(body, arm, _arm_words(body, about_arm))
        elif "elbow" in about_arm:
            said[arm.limb.elbow] = _elbow(about_arm["elbow"])
        said = {_own_joint(arm.limb.joints, arm.limb.side, key): v for key, v in said.items()}
    for joint, value in said.items():
        if isinstance(value, str | tuple):
            raise PrimitiveError(f"{joint} takes an angle in degrees, not {value!r}")
        given = body.angles({joint: value})
        angles = np.where(np.isnan(given), angles, given)
    return angles


def _own_joint(joints: tuple[str, ...], side: str, name: str) -> str:
    """`wrist_z` of the right arm is `right_wrist_z`."""
    return f"{side}_{name}" if f"{side}_{name}" in joints else name


def _elbow(value: float | Direction) -> float:
    if value == "straight":
        return 0.0
    if isinstance(value, str | tuple):
        raise PrimitiveError(f"elbow is straight or an angle in degrees, not {value!r}")
    return float(value)


def _arm_words(body: Body, words: dict[str, float | Direction]) -> ArmWords:
    def direction(part: str) -> FloatArray | None:
        value = words.get(part)
        if value is None:
            return None
        if isinstance(value, float | int):
            raise PrimitiveError(f"{part} takes a direction such as forward, not {value!r}")
        return body.direction(value)

    elbow = np.deg2rad(_elbow(words["elbow"])) if "elbow" in words else None
    return ArmWords(direction=direction("arm"), palm=direction("palm"), elbow=elbow)


class PostureField(CompiledField):
    """A servo towards a posture: see `pd_servo`."""

    def __init__(
        self,
        body: Body,
        claims: IntArray,
        postures: FloatArray,
        stiffness: FloatArray,
        damping: FloatArray,
        profile: Profile,
        times: tuple[float, ...],
        duration: float,
    ) -> None:
        super().__init__(body, claims, unit="rad")
        self.goal = postures[-1]  # (nv,) [rad]; only the claimed joints mean anything
        self._postures, self._gains = postures, (stiffness, damping)
        self._profile, self._times, self._duration = profile, times, duration

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        return table.field(
            POSTURE,
            table.numbers(*self._gains, self._postures),
            self.claims,
            duration=self._duration,
            curve=table.curve(self._profile, self._times),
            knots=len(self._times),
        )


__all__ = ["BodyError", "GetPosture", "PostureField", "ViaPosture", "via_times"]

"""The body map: what the parts of a model are called in anatomy.

A task file says "right arm", "left_shoulder.top", "rest". The map says which joints,
frames and sites of one particular model those words mean. Angles are in degrees, as
people write them; everything else is in SI units.
"""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Angle = Annotated[float, Field(allow_inf_nan=False)]


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Servo(_Frozen):
    """Gains with which a joint is moved when a task does not say otherwise (eq 1 and 3)."""

    stiffness: Positive  # k of a servo, A of a torque field [N m/rad]
    damping: NonNegative  # k_d [N m s/rad]
    width: Positive = 1.0  # s of a torque field [rad]


class Spring(_Frozen):
    """Gains of the springs that pull a hand, when a task does not say otherwise (eq 7-9)."""

    stiffness: Positive  # hand translation [N/m]
    damping: NonNegative  # [N s/m]
    turn_stiffness: Positive  # hand rotation [N m/rad]
    turn_damping: NonNegative  # [N m s/rad]
    upper_arm_stiffness: Positive  # rotation of the upper arm [N m/rad]
    upper_arm_damping: NonNegative  # [N m s/rad]
    shoulder_damping: NonNegative  # b_shoulder [N m s/rad]
    approach: Annotated[float, Field(le=0, allow_inf_nan=False)] = -100.0  # c of eq 10 [N s/m^2]
    joint_damping: NonNegative = 4.0  # of all joints, where a force holds only the hand [N m s/rad]


class Guard(_Frozen):
    """How links that must not touch are kept apart, when a task does not say otherwise."""

    range: Positive = 0.015  # distance of the surfaces at which it begins to push [m]
    stiffness: Positive = 800.0  # force at contact, per metre of range [N/m]
    damping: NonNegative = 20.0  # of drawing nearer [N s/m]


class Limb(_Frozen):
    """An arm: its joints from the trunk outwards, its links, and the frame of its palm."""

    side: Annotated[str, Field(pattern="^(left|right)$")]
    joints: Annotated[tuple[str, ...], Field(min_length=1)]
    shoulder: tuple[str, ...]  # those of the joints that move the upper arm
    elbow: str  # joint; 0 degrees is straight
    upper_arm: str  # link, with its origin at the shoulder
    forearm: str  # link, with its origin at the elbow
    hand: str  # link, with its origin at the wrist
    palm: str  # site on the surface of the palm: +x out of the palm, +z to the fingertips
    spring: Spring


class Head(_Frozen):
    """What looks: the link of the head, the way it faces, and the joints that turn it."""

    link: str
    forward: tuple[float, float, float]  # where the face points, in the link's frame
    eyes: tuple[float, float, float] = (0.0, 0.0, 0.0)  # between them, in the link's frame [m]
    joints: Annotated[tuple[str, ...], Field(min_length=1)]  # joints or joint groups


class Carry(_Frozen):
    """A movement of an object of the scene, which stands still before and after."""

    start: NonNegative  # [s]
    lasts: Positive  # [s]
    to: tuple[float, float, float]  # where its middle then is, in the world [m]


class BodyMap(_Frozen):
    """The names a task may use, and what they mean in the model."""

    name: str
    limbs: dict[str, Limb]
    groups: dict[str, tuple[str, ...]] = {}  # further joint groups: waist, neck
    head: Head | None = None  # for a body that can look at something
    landmarks: tuple[str, ...] = ()  # sites on the surface: +x is the outward normal
    postures: dict[str, dict[str, Angle]] = {}  # joint -> angle [deg]
    home: str = "rest"  # the posture a simulation starts in
    servos: dict[str, Servo]
    speed_limits: dict[str, Positive] = {}  # joint -> its largest speed [deg/s]; else no limit
    keep_apart: tuple[tuple[str, str], ...] = ()  # pairs of links that must not touch
    guard: Guard = Guard()
    objects: dict[str, tuple[Carry, ...]] = {}  # links that are of the scene: how they are carried
    upright: tuple[str, ...] = ()  # joint groups that stay at home unless a task moves them
    time_scale: Positive = 1.0  # how long its movements last, against those of Adonis

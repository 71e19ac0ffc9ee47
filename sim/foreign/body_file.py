"""What a body file says: which parts of somebody's model are what in anatomy.

Joints and links are called here as in the model; everything below `limbs` that is a place is in the
frame of an anatomical link: forward, left and up when the arms hang straight, from the link's
origin (the shoulder, the elbow, the wrist, ...), in metres.
"""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from sim.body_map import Angle, NonNegative, Positive, Spring
from sim.briskness import DAMPING_RATIO, FREQUENCY

Number = Annotated[float, Field(allow_inf_nan=False)]
Place = tuple[Number, Number, Number]
Word = Annotated[str, Field(min_length=1)]


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class JointOf(_Frozen):
    """A joint of the model that moves; what is not said is the model's own."""

    joint: Word  # of the model
    zero: Angle = 0.0  # its angle in the model where the anatomical one is 0 [deg]
    flipped: bool = False  # whether the anatomical angle grows as the model's falls
    range: tuple[Angle, Angle] | None = None  # anatomical [deg]
    torque: Positive | None = None  # largest [N m]
    armature: NonNegative | None = None  # [kg m^2]
    damping: NonNegative | None = None  # [N m s/rad]
    speed: Positive | None = None  # largest [deg/s]


class Base(_Frozen):
    """How the model stands: its base is fixed to the world."""

    forward: Word | Place = "+x"  # where it faces, in the axes of the model
    up: Word | Place = "+z"
    height: Number = 0.0  # of the origin of the model's world above the floor [m]


class PalmOf(_Frozen):
    """The middle of the palm, in the frame of the hand."""

    point: Place
    normal: Place  # out of the palm
    fingers: Place = (0.0, 0.0, -1.0)


class LimbOf(_Frozen):
    """An arm."""

    side: Annotated[str, Field(pattern="^(left|right)$")]
    joints: Annotated[dict[Word, JointOf], Field(min_length=2)]  # from the trunk outwards
    palm: PalmOf
    spring: Spring | None = None  # of the hand; else by rule


class HeadOf(_Frozen):
    """What looks."""

    link: Word  # of the model
    eyes: Place  # between them, in the frame of the head
    forward: Place = (1.0, 0.0, 0.0)


class LandmarkOf(_Frozen):
    """A place on the surface."""

    link: Word  # anatomical, or of the model if it has no anatomical name
    point: Place
    normal: Place  # outward


class ShapeOf(_Frozen):
    """A capsule that collides; a sphere if both ends are the same."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    start: Place = Field(alias="from")
    end: Place = Field(alias="to")
    radius: Positive


class BodyFile(_Frozen):
    """A body: a model, and what its parts are."""

    body: Word  # its name
    model: Word  # the file, as seen from the body file
    base: Base = Base()
    trunk: Word  # link of the model that carries the arms
    waist: dict[Word, JointOf] = {}
    neck: dict[Word, JointOf] = {}
    head: HeadOf | None = None
    limbs: Annotated[dict[Word, LimbOf], Field(min_length=1)]
    locked: dict[Word, Number] = {}  # where other joints stay [deg or m]; else as at home
    masses: dict[Word, Positive] = {}  # of links that the model gives none [kg]
    frequency: dict[Word, Positive] = FREQUENCY  # of the joints' servos [Hz]
    damping_ratio: Positive = DAMPING_RATIO
    postures: dict[Word, dict[Word, Angle]] = {}  # joint -> angle [deg]
    home: Word = "rest"
    landmarks: dict[Word, LandmarkOf] = {}
    shapes: dict[Word, tuple[ShapeOf, ...]] = {}  # link -> its capsules
    may_overlap: tuple[tuple[Word, Word], ...] = ()  # pairs of links that touch anyhow
    keep_apart: tuple[tuple[Word, Word], ...] | None = None  # else arms and what is not theirs

"""Floor 2: primitives, their controllers, and the compiled code that makes their torques."""

from primitives.avoid_collisions import AvoidCollisions
from primitives.compensate_gravity import CompensateGravity
from primitives.errors import PrimitiveError
from primitives.follow import Follow, Trajectory
from primitives.get_posture import GetPosture, ViaPosture
from primitives.go_to_point import GoToPoint, Place, ViaPlace
from primitives.hold import Hold
from primitives.look_at import LookAt
from primitives.oscillate import Oscillate, Swing, TempoChange
from primitives.point_at import PointAt
from primitives.primitive import Field, Primitive
from primitives.quantity import Quantity
from primitives.relax import Relax
from primitives.target import Target

__all__ = [
    "AvoidCollisions",
    "CompensateGravity",
    "Field",
    "Follow",
    "GetPosture",
    "GoToPoint",
    "Hold",
    "LookAt",
    "Oscillate",
    "Place",
    "PointAt",
    "Primitive",
    "PrimitiveError",
    "Quantity",
    "Relax",
    "Swing",
    "Target",
    "TempoChange",
    "Trajectory",
    "ViaPlace",
    "ViaPosture",
]

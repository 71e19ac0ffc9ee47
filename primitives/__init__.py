"""Floor 2: primitives, their controllers, and the compiled code that makes their torques."""

from primitives.avoid_collisions import AvoidCollisions
from primitives.compensate_gravity import CompensateGravity
from primitives.errors import PrimitiveError
from primitives.get_posture import GetPosture, ViaPosture
from primitives.go_to_point import GoToPoint, Place, ViaPlace
from primitives.oscillate import Oscillate, Swing, TempoChange
from primitives.primitive import Field, Primitive

__all__ = [
    "AvoidCollisions",
    "CompensateGravity",
    "Field",
    "GetPosture",
    "GoToPoint",
    "Oscillate",
    "Place",
    "Primitive",
    "PrimitiveError",
    "Swing",
    "TempoChange",
    "ViaPlace",
    "ViaPosture",
]

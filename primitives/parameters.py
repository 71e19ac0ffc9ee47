"""What the parameters of several primitives have in common."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field as Parameter

from primitives.errors import PrimitiveError
from primitives.posture_field import JointController
from primitives.quantity import Quantity
from primitives.reach_field import CartesianController
from primitives.set_point import Profile
from sim import Body

Vector = tuple[float, float, float]
Direction = str | Vector
Share = Annotated[float, Parameter(gt=0, lt=1)]
Positive = Annotated[float, Parameter(gt=0, le=1e9)]
NonNegative = Annotated[float, Parameter(ge=0, le=1e9)]
NonPositive = Annotated[float, Parameter(le=0)]
# What depends on the size of the body: see `quantity`.
Length = Annotated[float, Quantity.LENGTH]  # [m]
Offset = Annotated[Vector, Quantity.LENGTH]  # [m]
Time = Annotated[Positive, Quantity.TIME]  # [s]
Frequency = Annotated[Positive, Quantity.FREQUENCY]  # [Hz]
Stiffness = Annotated[Positive, Quantity.GAIN]
Damping = Annotated[NonNegative, Quantity.GAIN]
Approach = Annotated[NonPositive, Quantity.GAIN]
Controller = Literal["pd-servo", "torque-field", "impedance", "endpoint-force"]

JOINT_CONTROLLERS: tuple[JointController, ...] = ("pd-servo", "torque-field")
CARTESIAN_CONTROLLERS: tuple[CartesianController, ...] = ("impedance", "endpoint-force")
PROFILES: Mapping[Controller, Profile] = {
    "pd-servo": "spline",
    "torque-field": "spline",
    "impedance": "minimum-jerk",
    "endpoint-force": "minimum-jerk",
}
# What only some of the controllers can be given.
OWN_PARAMETERS: Mapping[str, tuple[Controller, ...]] = {
    "width": ("torque-field",),
    "coupled": ("torque-field",),
    "profile": ("pd-servo", *CARTESIAN_CONTROLLERS),
    "turn_stiffness": ("impedance",),
    "turn_damping": ("impedance",),
    "upper_arm_stiffness": ("impedance",),
    "upper_arm_damping": ("impedance",),
    "shoulder_damping": ("impedance",),
    "approach": ("endpoint-force",),
    "joint_damping": ("endpoint-force",),
}

GAINS = ("stiffness", "damping")  # of every controller, in units of its own

BACKGROUND_SETTLING = 0.5  # on a body of the size of Adonis [s]

SETTLE = 0.5  # time in which look-at, point-at and follow set in, unless told otherwise [s]
MOST_OF_IT = 0.85  # and the share of their own time that this may take


def background_settling(body: Body) -> float:
    """Time in which something in the background moves its set point from where the body is [s]."""
    return BACKGROUND_SETTLING * body.map.time_scale


def settling(asked: float, duration: float) -> float:
    """Time in which something sets in that has `duration` in all [s]."""
    return min(asked, MOST_OF_IT * duration)


def check_own(controller: Controller, given: set[str]) -> None:
    """Refuse parameters that the controller does not have.

    Raises:
        ValueError: naming the first of them, and the controllers that have it.
    """
    for name, controllers in OWN_PARAMETERS.items():
        if name in given and controller not in controllers:
            whose = " and ".join(controllers)
            raise ValueError(f"{name} belongs to the controller {whose}, not to {controller}")


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

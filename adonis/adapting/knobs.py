"""The few things about a whole task that a search may turn when it is adapted to another body.

Each is a factor, 1 being what the laws of scaling say. Numbers are rounded as they are applied, so
that what is written into a file is what was tried.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from primitives import GoToPoint, Primitive, ViaPlace
from specs import Firmness, SubTask, TaskSpec, slowed

FloatArray = NDArray[np.float64]
DIGITS = 3  # after the point


@dataclass(frozen=True)
class Knob:
    """A factor, and within what it may be turned."""

    name: str
    low: float
    high: float
    about: str


KNOBS = (
    Knob("joints", 0.4, 2.5, "stiffness of joints"),
    Knob("hands", 0.4, 2.5, "stiffness of hands' springs"),
    Knob("damping", 0.6, 1.8, "damping ratio of both"),
    Knob("guard", 0.4, 3.0, "force that keeps links apart"),
    Knob("travel", 0.8, 1.2, "share of its time in which a hand travels"),
    Knob("detour", 0.8, 1.4, "how far out hands go round the body"),
    Knob("time", 1.0, 1.5, "how long everything takes"),
)
TIME = "time"


def turned(spec: TaskSpec, factors: Mapping[str, float]) -> TaskSpec:
    """A task with its knobs turned.

    Args:
        spec: the task, as the laws have it.
        factors: by the names of `KNOBS`; what is missing is 1.
    """
    own = spec.gains or Firmness()
    firmness = {
        name: round(getattr(own, name) * factors.get(name, 1.0), DIGITS)
        for name in Firmness.model_fields
    }
    gains = Firmness(**firmness)
    travel, detour = factors.get("travel", 1.0), factors.get("detour", 1.0)
    subtasks = tuple(_led(subtask, travel, detour) for subtask in spec.subtasks)
    spec = spec.model_copy(
        update={"gains": None if gains == Firmness() else gains, "subtasks": subtasks}
    )
    time = round(factors.get(TIME, 1.0), DIGITS)
    return spec if time == 1.0 else slowed(spec, time)


def factors_of(point: FloatArray, knobs: tuple[Knob, ...]) -> dict[str, float]:
    """Factors of a point of the search, whose numbers are logarithms."""
    return {
        knob.name: round(float(np.clip(np.exp(x), knob.low, knob.high)), DIGITS)
        for knob, x in zip(knobs, point, strict=True)
    }


def bounds(knobs: tuple[Knob, ...]) -> FloatArray:
    """Lower and upper logarithm of each (k, 2)."""
    return np.log([[knob.low, knob.high] for knob in knobs])


def _led(subtask: SubTask, travel: float, detour: float) -> SubTask:
    does: Primitive = subtask.does
    if not isinstance(does, GoToPoint):
        return subtask
    more: dict[str, object] = {}
    share = round(min(does.travel * travel, 1.0), DIGITS)
    if share != does.travel:
        more["travel"] = share
    via = tuple(_farther(place, detour) for place in does.via)
    if via != does.via:
        more["via"] = via
    return subtask.model_copy(update={"does": does.model_copy(update=more)}) if more else subtask


def _farther(place: ViaPlace, detour: float) -> ViaPlace:
    away = round(place.away * detour, 1 + DIGITS) if detour != 1.0 else place.away
    return place if away == place.away else place.model_copy(update={"away": away})

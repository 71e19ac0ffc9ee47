"""Lines in space: where axes of joints meet, and angles between directions."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

PARALLEL = 0.97  # cosine of axes that count as parallel


def unit(vector: FloatArray) -> FloatArray:
    """A vector (3,) of length one; itself if it has none."""
    length = float(np.linalg.norm(vector))
    return vector / length if length > 1e-9 else vector


def foot(point: FloatArray, anchor: FloatArray, axis: FloatArray) -> FloatArray:
    """The point of a line that is nearest to a point (3,)."""
    nearest: FloatArray = anchor + axis * ((point - anchor) @ axis)
    return nearest


def distance_to_line(point: FloatArray, anchor: FloatArray, axis: FloatArray) -> float:
    """How far a point (3,) is from a line."""
    return float(np.linalg.norm(point - foot(point, anchor, axis)))


def nearest_on_line(
    anchor: FloatArray, axis: FloatArray, other_anchor: FloatArray, other_axis: FloatArray
) -> FloatArray:
    """The point of the first line that is nearest to the second; they must not be parallel."""
    between, share = other_anchor - anchor, float(axis @ other_axis)
    along = (between @ axis - (between @ other_axis) * share) / (1.0 - share**2)
    nearest: FloatArray = anchor + along * axis
    return nearest


def turn_about(axis: FloatArray, start: FloatArray, end: FloatArray) -> float:
    """Angle [rad] about an axis that turns `start` into the direction of `end`, seen along it."""
    a, b = (v - axis * (v @ axis) for v in (start, end))
    return float(np.arctan2(np.cross(a, b) @ axis, a @ b))


def angle_between(a: FloatArray, b: FloatArray) -> float:
    """Angle of two vectors [rad]."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def nearest_turn(angle: float, low: float, high: float) -> float:
    """An angle [rad] plus whole turns, within a range if that can be, else nearest to it."""
    middle = 0.5 * (low + high) if np.isfinite(low + high) else 0.0
    turned = (angle - middle + np.pi) % (2.0 * np.pi) - np.pi + middle
    return float(turned)

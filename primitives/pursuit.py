"""The law of follow: a spring and a damper pull the palm after a moving point.

    F = K (x_d - x) + B (x_d' - x')                        (Mataric et al. 1999, eq 7)

x_d is the moving point itself, and x_d' its velocity, so that the damper does not hold the hand
back. At first x_d goes over from where the palm was, along the minimum-jerk profile (Flash &
Hogan 1985). The hand and the arm are turned as in `impedance`.

A trajectory is the clamped cubic spline through its points: at rest at both ends, and as smooth
as can be between them.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Record, Records, compiled
from primitives.impedance import REMEMBERED, palm_position
from primitives.mechanics import (
    Row,
    Vector,
    add,
    dot,
    point_velocity,
    rotate,
    scale,
    subtract,
    to_world,
    vector,
)
from primitives.profiles import minimum_jerk

FloatArray = NDArray[np.float64]

SINCE = REMEMBERED  # where the memory keeps the time since the pursuit began
KNOT = 7  # numbers of a trajectory's point: time, place, velocity


def spline_velocities(times: FloatArray, points: FloatArray) -> FloatArray:
    """Velocities (k, 3) at the points (k, 3) of a clamped cubic spline."""
    count = len(times)
    h = np.diff(times)
    pace = np.diff(points, axis=0) / h[:, None]
    matrix: FloatArray = np.eye(count)
    right: FloatArray = np.zeros((count, 3))
    for k in range(1, count - 1):
        matrix[k, k - 1 : k + 2] = h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1]
        right[k] = 3.0 * (h[k] * pace[k - 1] + h[k - 1] * pace[k])
    velocities: FloatArray = np.linalg.solve(matrix, right).astype(np.float64)
    return velocities


@compiled
def on_trajectory(knots: FloatArray, count: int, t: float) -> tuple[Vector, Vector]:
    """Place and velocity at time t [s] of a trajectory: `count` rows of KNOT numbers, flat."""
    last = (count - 1) * KNOT
    if t <= knots[0]:
        return vector(knots[1:]), (0.0, 0.0, 0.0)
    if t >= knots[last]:
        return vector(knots[last + 1 :]), (0.0, 0.0, 0.0)
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if t >= knots[middle * KNOT]:
            low = middle
        else:
            high = middle
    a, b = knots[low * KNOT : (low + 1) * KNOT], knots[high * KNOT : (high + 1) * KNOT]
    h = b[0] - a[0]
    s = (t - a[0]) / h
    p, v, q, w = vector(a[1:]), vector(a[4:]), vector(b[1:]), vector(b[4:])
    rest = 1.0 - s
    place = add(
        add(scale((1.0 + 2.0 * s) * rest * rest, p), scale(s * rest * rest * h, v)),
        subtract(scale(s * s * (3.0 - 2.0 * s), q), scale(s * s * rest * h, w)),
    )
    velocity = add(
        scale(6.0 * s * rest / h, subtract(q, p)),
        add(scale(rest * (1.0 - 3.0 * s), v), scale(s * (3.0 * s - 2.0), w)),
    )
    return place, velocity


@compiled
def moving_point(
    x: Row, r: Record, points: Records, knots: FloatArray, count: int, t: float
) -> tuple[Vector, Vector]:
    """The point that the palm follows in the world [m], and its velocity [m/s].

    Args:
        x: the simulation.
        r: a row of REACH; its point is the row r.points of POINT, unless there is a trajectory.
        points: rows of POINT.
        knots: of a trajectory, in the frame of the link that carries the arm.
        count: how many of them; 0 for none.
        t: time since the pursuit began [s].
    """
    if count:
        place, velocity = on_trajectory(knots, count, t)
        place = to_world(x, r.root, place)
        return place, add(rotate(x, r.root, velocity), point_velocity(x, r.root, place))
    p = points[r.points]
    place = to_world(x, p.link, vector(p.point))
    return place, point_velocity(x, p.link, place)


@compiled
def catch_up(
    x: Row, r: Record, place: Vector, velocity: Vector, memory: FloatArray, t: float, settle: float
) -> tuple[Vector, Vector]:
    """A point on its way from where the palm was to a moving place [m], and its velocity [m/s].

    It is there after `settle` seconds.
    """
    s = min(t / settle, 1.0) if settle > 0.0 else 1.0
    late = minimum_jerk(s)
    rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / settle if s < 1.0 else 0.0
    start = to_world(x, r.root, (memory[0], memory[1], memory[2]))
    gap = subtract(place, start)
    carried = point_velocity(x, r.root, start)
    speed = add(carried, add(scale(late, subtract(velocity, carried)), scale(rate, gap)))
    return add(start, scale(late, gap)), speed


@compiled
def pull_to(x: Row, r: Record, wanted: Vector, speed: Vector) -> Vector:
    """Force on the palm [N] of the spring and the damper that hold it to a moving point."""
    palm = palm_position(x, r)
    return add(
        scale(r.stiffness, subtract(wanted, palm)),
        scale(r.damping, subtract(speed, point_velocity(x, r.hand, palm))),
    )


@compiled
def pursuit_error(x: Row, r: Record, place: Vector) -> float:
    """Distance of the palm from a place [m]."""
    gap = subtract(place, palm_position(x, r))
    return float(np.sqrt(dot(gap, gap)))

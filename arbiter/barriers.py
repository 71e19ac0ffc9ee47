"""Control barrier functions: which limits the torque asked for would run into, compiled.

Everything that has a limit has a distance h to it: a joint from the end of its range, two
links from their margin. h is kept from closing faster than

    alpha(h) = s (sqrt(1 + 2 w h / s) - 1),    s = A / w,

which is w h near the limit, where it makes h'' + 2 w h' + w^2 h >= 0, the exponential barrier
of second order with damping ratio 1 (Nguyen & Sreenath 2016, "Exponential control barrier
functions"), and sqrt(2 A h) far away, where a motor that brakes with A could stop in time. As
torques act on h'', what is asked for is

    h'' >= -alpha'(h) h' - w (h' + alpha(h)),    q'' = M^-1 (tau - bias - D q' + r),

linear in tau. r is what acts on the body besides, contacts and pushes: what the last step did
that its torque does not explain, smoothed. Where r would help to keep a limit it is not counted on.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records, compiled
from primitives.mechanics import Row

FloatArray = NDArray[np.float64]

MARGIN = 0.002  # kept between links that must not touch [m]
SPARE = 0.002  # aimed at beyond the margin, for what is left out: steps, edges, impacts [m]
SPARE_ANGLE = 0.01  # likewise before the end of a joint's range [rad]
PACE = 20.0  # w: how fast the way that is left to a limit may shrink [1/s]
BRAKING = 60.0  # A of two links [m/s^2]; that of a joint follows from its motor
SPEED_PACE = 50.0  # how fast the speed that is left to a joint may shrink [1/s]
FAR = 40.0  # two links that may draw nearer with so much more are not looked at [m/s^2]
MOST_ROWS = 300  # pairs of geoms that one simulation can be near to
MOST_OF_TWO = 20  # pairs of geoms of any two links
SMOOTHING = 0.8  # share of the newest in what acts besides

JOINT = np.dtype(
    [
        *(("armature", np.float64), ("damping", np.float64)),
        *(("low", np.float64), ("high", np.float64), ("speed", np.float64)),
        *(("braking", np.float64), ("limit", np.float64)),  # A [rad/s^2], torque [N m]
    ],
    align=True,
)
NEAR = 15  # of a limit: what is left, joint, links, points on them, direction, what it may, row


@compiled
def may_fall(h: float, rate: float, braking: float) -> float:
    """The right side: by how much h'' may be negative at distance h, which changes at a rate."""
    least = braking / PACE
    if h <= 0.0:
        slope, alpha = PACE, PACE * h
    else:
        root = np.sqrt(1.0 + 2.0 * PACE * h / least)
        slope, alpha = PACE / root, least * (root - 1.0)
    return float(slope * rate + PACE * (rate + alpha))


@compiled
def look_from(speed: float) -> float:
    """The distance at which two links that approach with a speed first come into view [m]."""
    y = FAR / PACE + 2.0 * speed
    return y / PACE + y * y / (2.0 * BRAKING)


@compiled
def note(may: float, first: int, count: int, near: FloatArray) -> int:
    """Where to write a pair of geoms of two links: a new row, or that of the least urgent; or -1.

    Args:
        may: by how much their distance may be accelerated; the less the more urgent.
        first: row of the first pair of the same two links.
        count: how many rows there are.
        near: the rows.
    """
    if count < min(first + MOST_OF_TWO, near.shape[0]):
        return count
    k = first
    for n in range(first + 1, count):
        if near[n, 13] > near[k, 13]:
            k = n
    return k if k < count and near[k, 13] > may else -1


@compiled
def look_at_joints(
    x: Row, joints: Records, acceleration: FloatArray, help_: FloatArray, near: FloatArray
) -> int:
    """Rows of `near` for the joints; returns how many, at most one for each joint's side."""
    count = 0
    for j in range(joints.shape[0]):
        at, rate = x.dofs[j].qpos, x.qvel[j]
        if at < 0 or joints[j].limit == 0.0:
            continue
        braking = joints[j].braking
        for side in range(2):
            sign = 1.0 if side == 0 else -1.0
            may = SPEED_PACE * (joints[j].speed - sign * rate)
            room = joints[j].high - x.qpos[at] if side == 0 else x.qpos[at] - joints[j].low
            if room < np.inf:
                may = min(may, may_fall(room - SPARE_ANGLE, -sign * rate, braking))
            if may < 2.0 * braking:
                left = may - sign * acceleration[j] - max(0.0, -sign * help_[j])
                near[count, 0], near[count, 1], near[count, 2] = left, j, -sign
                count += 1
    return count

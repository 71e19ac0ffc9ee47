"""Where points and directions of links are in a posture, and how directions turn."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body, Spot

FloatArray = NDArray[np.float64]

SAME = 1e-6  # [rad] directions that are so near are one, or opposite: any way round is as short
ACROSS = 0.1  # what a direction needs across another to turn by way of it


def places_of(body: Body, qpos: FloatArray, spots: list[Spot]) -> FloatArray:
    """Where points that are fixed to links are [m] (spots, 3) in a posture (nq,)."""
    data = _posed(body, qpos)
    return np.array([place_of(data, spot) for spot in spots])


def place_of(data: mujoco.MjData, spot: Spot) -> FloatArray:
    """Where a point that is fixed to a link is (3,) [m], in the present kinematics."""
    place: FloatArray = data.xpos[spot.link] + data.xmat[spot.link].reshape(3, 3) @ spot.point
    return place


def origin(link: int) -> Spot:
    """The origin of a link, as a point of it."""
    return Spot(link, np.zeros(3), np.zeros(3))


def axes_of(body: Body, qpos: FloatArray, link: int) -> FloatArray:
    """The axes of a link (3, 3), as columns, in a posture (nq,)."""
    axes: FloatArray = _posed(body, qpos).xmat[link].reshape(3, 3).copy()
    return axes


def along(data: mujoco.MjData, one: int, other: int) -> FloatArray:
    """Unit vector (3,) from the origin of a link to that of another, in the present kinematics."""
    return unit(data.xpos[other] - data.xpos[one])


def unit(vector: FloatArray) -> FloatArray:
    """A vector (3,) at length one; nothing stays nothing."""
    one: FloatArray = vector / max(float(np.sqrt(vector @ vector)), 1e-9)
    return one


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """The vector product (3,); `np.cross` takes ten times as long for one."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def turned(start: FloatArray, goal: FloatArray, share: float) -> FloatArray:
    """The unit vector so far on the great circle from one to another."""
    cosine = min(max(float(start @ goal), -1.0), 1.0)
    angle = float(np.arccos(cosine))
    if share >= 1.0 or angle < SAME:
        return goal
    aside = goal - cosine * start
    if np.pi - angle < SAME:  # the way that is nearest to up
        up, forward = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
        aside = forward if abs(start[2]) > 1.0 - SAME else up - start[2] * start
    between: FloatArray = np.cos(share * angle) * start + np.sin(share * angle) * unit(aside)
    return between


def turned_by_way_of(
    start: FloatArray, way: FloatArray, goal: FloatArray, share: float
) -> FloatArray:
    """Like `turned`, by way of a third unit vector, a quarter of a turn from the first."""
    aside = way - (way @ start) * start
    if float(np.linalg.norm(aside)) < ACROSS:
        return turned(start, goal, share)
    middle = unit(aside)
    quarter, rest = 0.5 * np.pi, float(np.arccos(np.clip(middle @ goal, -1.0, 1.0)))
    done = share * (quarter + rest)
    if done < quarter:
        return turned(start, middle, done / quarter)
    return turned(middle, goal, min((done - quarter) / max(rest, SAME), 1.0))


def turn(own: FloatArray, wanted: FloatArray) -> FloatArray:
    """Rotation vector (3,) that takes one unit vector to another, its length held to at most 1."""
    axis = cross(own, wanted)
    return unit(axis) if float(own @ wanted) < 0.0 else axis


def _posed(body: Body, qpos: FloatArray) -> mujoco.MjData:
    data = mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(body.model, data)
    return data

"""How near links come to each other on a way, and how deep a point lies in the body."""

from collections.abc import Iterable

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body, Capsules
from sim.errors import BodyError

FloatArray = NDArray[np.float64]
FAR = 0.10  # distances beyond this are not measured [m]


def clearances(body: Body, way: FloatArray, pairs: Iterable[tuple[str, str]]) -> FloatArray:
    """Smallest distances (k, pairs) [m] of pairs of links in postures (k, nq), at most 0.1 m.

    Negative is how deep they are in each other.
    """
    model, data = body.model, mujoco.MjData(body.model)
    couples = [
        (body.colliding(body.link(one)), body.colliding(body.link(other))) for one, other in pairs
    ]
    found = np.full((len(way), len(couples)), FAR)
    for k, q in enumerate(way):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        for p, (own, others) in enumerate(couples):
            least = FAR
            for a in own:
                for b in others:
                    least = min(least, mujoco.mj_geomDistance(model, data, a, b, least, None))
            found[k, p] = least
    return found


def clearance(body: Body, qpos: FloatArray) -> float:
    """Smallest distance [m] of links that must not touch, in a posture (nq,), at most 0.1 m."""
    return float(clearances(body, qpos[None], body.map.keep_apart).min(initial=FAR))


def depth_inside(
    body: Body, qpos: FloatArray, point: FloatArray, links: Iterable[str]
) -> tuple[float, str]:
    """How deep a point (3,) of the world lies in one of some links [m], and in which; 0 if in none.

    Geoms that are neither spheres nor capsules are not looked at.
    """
    data = mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(body.model, data)
    deepest, where = 0.0, ""
    for link in links:
        index = body.link(link)
        axes = data.xmat[index].reshape(3, 3)
        try:
            shapes = body.capsules([link])
        except BodyError:
            continue
        inside = _depth(shapes, axes.T @ (point - data.xpos[index]))
        if inside > deepest:
            deepest, where = inside, link
    return deepest, where


def _depth(shapes: Capsules, point: FloatArray) -> float:
    """How deep a point (3,) in the frame of a link lies in its capsules [m]; negative outside."""
    if not len(shapes.radius):
        return -np.inf
    along = shapes.end - shapes.start
    share = np.einsum("ci,ci->c", point - shapes.start, along)
    share = np.clip(share / np.maximum(np.einsum("ci,ci->c", along, along), 1e-12), 0.0, 1.0)
    nearest = shapes.start + share[:, None] * along
    return float(np.max(shapes.radius - np.linalg.norm(point - nearest, axis=1)))

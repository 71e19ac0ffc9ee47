"""Landmarks are found by casting rays: a point of the surface and its outward normal."""

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.errors import BodyError


@dataclass(frozen=True)
class Ray:
    """A landmark is where the ray from `origin` along `direction` leaves the link."""

    name: str
    link: str
    origin: NDArray[np.float64]  # (3,) in the frame of the link [m]
    direction: NDArray[np.float64]  # (3,) need not be normalised


def place_landmarks(spec: Any, rays: list[Ray]) -> None:
    """Add a site for each ray to `spec`: on the surface, +x along the outward normal.

    Raises:
        BodyError: a ray misses every colliding geom of its link.
    """
    model = spec.compile()
    for ray in rays:
        hit = leave(model, ray)
        if hit is None:
            raise BodyError(f"landmark {ray.name!r}: its ray misses every geom of {ray.link!r}")
        point, normal = hit
        spec.body(ray.link).add_site(
            name=ray.name, pos=point, quat=x_along(normal), size=[0.006] * 3, group=4
        )


def leave(model: Any, ray: Ray) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Outermost point of the link along the ray and the normal there, in the link's frame."""
    direction = ray.direction / np.linalg.norm(ray.direction)
    start = ray.origin + direction  # one metre out, looking back
    link = model.body(ray.link).id
    best: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
    nearest = np.inf
    for geom in np.flatnonzero((model.geom_bodyid == link) & (model.geom_contype > 0)):
        matrix = np.empty(9)
        mujoco.mju_quat2Mat(matrix, model.geom_quat[geom])
        normal = np.empty(3)
        distance = mujoco.mju_rayGeom(
            model.geom_pos[geom],
            matrix,
            model.geom_size[geom],
            start,
            -direction,
            model.geom_type[geom],
            normal,
        )
        if 0.0 <= distance < nearest:
            nearest = distance
            best = start - distance * direction, normal
    return best


def x_along(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """A rotation (wxyz) that takes +x to `normal` and keeps +z as far up as it can."""
    up = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    y = np.cross(up, normal)
    y /= np.linalg.norm(y)
    matrix = np.column_stack([normal, y, np.cross(normal, y)])
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, matrix.ravel())
    return quat

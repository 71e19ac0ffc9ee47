"""The surface of a link: triangles of its meshes and shapes, and points spread over them."""

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

COVERED = 0.45  # of the box around what is drawn: what collides fills less of it, and is not used
ROUND = 12  # points round a cylinder, sphere or capsule


@dataclass(frozen=True)
class Shape:
    """One geom of a link as triangles, in the frame of its MuJoCo body."""

    points: FloatArray  # (k, 3) [m]
    faces: IntArray  # (f, 3) rows of `points`
    rgba: FloatArray  # (4,)
    collides: bool


def shapes_of(model: Any, body: int) -> list[Shape]:
    """The geoms of a MuJoCo body; planes and height fields are no part of a body."""
    first, count = model.body_geomadr[body], model.body_geomnum[body]
    found = []
    for geom in range(first, first + count):
        made = _mesh(model, geom) if model.geom_dataid[geom] >= 0 else _primitive(model, geom)
        if made is None:
            continue
        points, faces = made
        axes = np.empty(9)
        mujoco.mju_quat2Mat(axes, model.geom_quat[geom])
        placed = points @ axes.reshape(3, 3).T + model.geom_pos[geom]
        collides = bool(model.geom_contype[geom] or model.geom_conaffinity[geom])
        found.append(Shape(placed, faces, _colour(model, geom), collides))
    return found


def solid(shapes: list[Shape]) -> list[Shape]:
    """Those that collide; those that are drawn if none does, or if they are much more than that."""
    colliding = [shape for shape in shapes if shape.collides]
    seen = [shape for shape in shapes if not shape.collides]
    if not colliding or not seen:
        return colliding or seen
    (low, high), (seen_low, seen_high) = _box(colliding), _box(seen)
    common = np.prod(np.maximum(np.minimum(high, seen_high) - np.maximum(low, seen_low), 0.0))
    return seen if common < COVERED * np.prod(seen_high - seen_low) else colliding


def _box(shapes: list[Shape]) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest corner (3,) of some shapes."""
    points = np.concatenate([shape.points for shape in shapes])
    return points.min(axis=0), points.max(axis=0)


def drawn(shapes: list[Shape]) -> list[Shape]:
    """Those that are only drawn; those that collide if there are no others."""
    return [shape for shape in shapes if not shape.collides] or shapes


def spread(shapes: list[Shape], count: int, seed: int = 0) -> FloatArray:
    """Points (count, 3) spread evenly over the surfaces of some shapes; none of no shapes."""
    triangles = [shape.points[shape.faces] for shape in shapes if len(shape.faces)]
    if not triangles:
        return np.zeros((0, 3))
    corners = np.concatenate(triangles)
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.linalg.norm(np.cross(a, b), axis=1)
    if area.sum() <= 0.0:
        return corners.reshape(-1, 3)[:count]
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(corners), count, p=area / area.sum())
    u, v = rng.random(count), rng.random(count)
    over = u + v > 1.0
    u[over], v[over] = 1.0 - u[over], 1.0 - v[over]
    points: FloatArray = corners[chosen, 0] + u[:, None] * a[chosen] + v[:, None] * b[chosen]
    return points


def _mesh(model: Any, geom: int) -> tuple[FloatArray, IntArray] | None:
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_HFIELD.value:
        return None
    mesh = model.geom_dataid[geom]
    if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH.value:
        return _primitive(model, geom)  # a shape fitted to a mesh
    points, faces = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
    return (
        model.mesh_vert[points : points + model.mesh_vertnum[mesh]].astype(np.float64),
        model.mesh_face[faces : faces + model.mesh_facenum[mesh]].astype(np.int32),
    )


def _primitive(model: Any, geom: int) -> tuple[FloatArray, IntArray] | None:
    """A box, sphere, ellipsoid, cylinder or capsule as the hull of points on it."""
    size = model.geom_size[geom]
    kind = mujoco.mjtGeom(int(model.geom_type[geom]))
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T * size
    elif kind in (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_ELLIPSOID):
        radii = size if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID else size[0]
        corners = _ball() * radii
    elif kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        ball = _ball() * size[0]
        shift = np.where(ball[:, 2:] >= 0.0, size[1], -size[1]) * [0.0, 0.0, 1.0]
        corners = ball + shift
    elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        turn = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
        rim = size[0] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        corners = np.concatenate(
            [np.column_stack([rim, np.full(ROUND, z)]) for z in (-size[1], size[1])]
        )
    else:
        return None
    return hull(corners)


def _ball() -> FloatArray:
    """Points (k, 3) of a unit sphere, ring by ring."""
    rings = np.linspace(0.0, np.pi, ROUND // 2 + 2)
    turn = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
    across = [np.outer(np.sin(rings), f(turn)).ravel() for f in (np.cos, np.sin)]
    along = np.repeat(np.cos(rings), ROUND)
    return np.unique(np.round(np.column_stack([*across, along]), 9), axis=0)


def hull(points: FloatArray) -> tuple[FloatArray, IntArray] | None:
    """The convex hull of points (k, 3): its corners and triangles; None if they are flat."""
    from scipy.spatial import ConvexHull, QhullError  # noqa: PLC0415  (not at import)

    try:
        found = ConvexHull(points)
    except (QhullError, ValueError):
        return None
    kept = found.vertices
    place = np.full(len(points), -1, dtype=np.int32)
    place[kept] = np.arange(len(kept), dtype=np.int32)
    corners = points[kept]
    faces = place[found.simplices]
    inside = corners.mean(axis=0)
    a, b, c = (corners[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - inside) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return corners, faces


def _colour(model: Any, geom: int) -> FloatArray:
    material = model.geom_matid[geom]
    rgba = model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom]
    return np.array(rgba, dtype=np.float64)

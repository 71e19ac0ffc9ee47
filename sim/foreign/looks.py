"""What a link looks like: its meshes, coarse enough to travel inside a recording."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.foreign.surface import IntArray, Shape, hull, spread

FloatArray = NDArray[np.float64]

FINEST = 0.006  # cells in which corners of a mesh become one [m]
CELLS = 16  # of those, across the size of a shape
COLOURS = 3  # of a link at most; the smaller shapes take the colour of the largest
SEEN = 250  # points of a hull that are compared with what it is the hull of
BULGE = 0.028  # mean distance between them, of its size, up to which it is good enough
FEWEST = 4  # triangles that make a body
DARKEST = 0.15  # black shows no shape
DECIMALS = 4  # of coordinates [m]


@dataclass(frozen=True)
class Look:
    """A mesh of one colour, in the frame of its link."""

    points: FloatArray  # (k, 3) [m]
    faces: IntArray  # (f, 3)
    rgba: tuple[float, ...]


def looks_of(shapes: list[Shape]) -> list[Look]:
    """The shapes of a link, coarsened, with one mesh for each colour."""
    by_colour: dict[tuple[float, ...], list[tuple[FloatArray, IntArray]]] = {}
    for shape in shapes:
        if shape.rgba[3] < 0.1 or not len(shape.faces):
            continue
        colour = tuple(round(DARKEST + (1.0 - DARKEST) * float(c), 2) for c in shape.rgba[:3])
        points, faces = _plain(shape)
        by_colour.setdefault(colour, []).append(_coarse(points, faces))
    largest = sorted(by_colour, key=lambda c: -sum(len(f) for _, f in by_colour[c]))
    for extra in largest[COLOURS:]:
        by_colour[largest[0]] += by_colour.pop(extra)
    found = []
    for colour, parts in by_colour.items():
        corners, offset = [], 0
        for own, triangles in parts:
            corners.append(triangles + offset)
            offset += len(own)
        whole = np.concatenate(corners).astype(np.int32)
        if len(whole) >= FEWEST:
            together = np.round(np.concatenate([own for own, _ in parts]), DECIMALS)
            found.append(Look(together, whole, (*colour, 1.0)))
    return found


def _plain(shape: Shape) -> tuple[FloatArray, IntArray]:
    """The hull of a shape, if that is nearly what it looks like: it has no holes and no inside."""
    from scipy.spatial import cKDTree  # noqa: PLC0415  (not at import)

    whole = hull(shape.points)
    if whole is None or len(shape.faces) < len(whole[1]):
        return shape.points, shape.faces
    outside = spread([Shape(*whole, shape.rgba, shape.collides)], SEEN)
    surface = spread([shape], 8 * SEEN)
    apart, _ = cKDTree(surface).query(outside)
    size = float(np.linalg.norm(np.ptp(shape.points, axis=0)))
    return whole if np.mean(apart) < BULGE * size else (shape.points, shape.faces)


def _coarse(points: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """A mesh whose corners within a cell of a grid are one (Rossignac & Borrel 1993)."""
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    cell = max(FINEST, size / CELLS)
    keys = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
    _, owner = np.unique(keys, axis=0, return_inverse=True)
    owner = owner.reshape(-1)
    count = int(owner.max()) + 1
    total = np.zeros((count, 3))
    np.add.at(total, owner, points)
    merged = total / np.bincount(owner, minlength=count)[:, None]
    corners = owner[faces]
    whole = (
        (corners[:, 0] != corners[:, 1])
        & (corners[:, 1] != corners[:, 2])
        & (corners[:, 2] != corners[:, 0])
    )
    corners = corners[whole]
    _, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
    corners = corners[np.sort(first)]
    used, place = np.unique(corners, return_inverse=True)
    return merged[used], place.reshape(-1, 3).astype(np.int32)

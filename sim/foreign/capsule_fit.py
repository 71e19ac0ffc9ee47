"""Capsules that fit a cloud of points on a surface: what collides in place of a mesh.

Points are shared out among capsules by whose surface is nearest (Lloyd's way of clustering), each
capsule is then laid along the longest direction of its points with their mean distance from
that line as its radius. As few capsules are taken as come near enough.
"""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

NEAR = 0.035  # mean distance of points from the capsules, of the size of the link: near enough
FINE, COARSE = 0.004, 0.015  # the same, in any case and at most [m]
GAIN = 0.85  # another capsule must bring the distance down to so much of it
ROUNDS = 12
INSIDE = 0.5  # weight in the mean of points that a capsule swallows, beside those that stick out
LEAST = 0.006  # radius [m]

Capsule = tuple[FloatArray, FloatArray, float]  # start, end (3,), radius


def fit_capsules(points: FloatArray, most: int) -> list[Capsule]:
    """Capsules near points (k, 3) of a surface; none of fewer than four points."""
    if len(points) < 4:
        return []
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    best, off = _fit(points, 1)
    for count in range(2, most + 1):
        if off < near_enough(size):
            break
        found, less = _fit(points, count)
        if less < GAIN * off:
            best, off = found, less
    return best


def near_enough(size: float) -> float:
    """How far off capsules may be on average, of a link of a size [m]."""
    return float(np.clip(NEAR * size, FINE, COARSE))


def distances(points: FloatArray, capsules: list[Capsule]) -> FloatArray:
    """Distances (k, capsules) of points from the surfaces, negative inside [m]."""
    return np.stack([_distance(points, capsule) for capsule in capsules], axis=1)


def misfit(points: FloatArray, capsules: list[Capsule]) -> float:
    """How far the nearest surface is from points on average [m]."""
    nearest = distances(points, capsules).min(axis=1)
    weighed = np.where(nearest < 0.0, INSIDE * -nearest, nearest)
    return float(weighed.mean())


def fit_symmetric(points: FloatArray, most: int) -> list[Capsule]:
    """Capsules near points that are the same left and right of y = 0, and themselves are so.

    Either all of them lie across or in the middle plane, or they come in pairs.
    """
    flat = points * [1.0, 0.0, 1.0]
    options: list[list[Capsule]] = []
    for count in range(1, most + 1):
        options.append(_fit(points, count, _parted(flat, count))[0])
        if count % 2 == 0:
            half, _ = _fit(points[points[:, 1] >= 0.0], count // 2)
            flip = np.array([1.0, -1.0, 1.0])
            options.append([*half, *((a * flip, b * flip, r) for a, b, r in half)])
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    best, off = options[0], misfit(points, options[0])
    for found in options[1:]:
        less = misfit(points, found)
        fewer = len(found) <= len(best)
        if less < off * (1.0 if fewer else GAIN ** (len(found) - len(best))):
            best, off = found, less
        if off < near_enough(size) and len(found) > len(best):
            break
    return best


def _fit(
    points: FloatArray, count: int, owner: NDArray[np.int64] | None = None
) -> tuple[list[Capsule], float]:
    """So many capsules, and how far they are off; `owner` is whose each point is at first."""
    if owner is None:
        owner = _parted(points, count)
    best: tuple[float, list[Capsule]] = (np.inf, [])
    for _ in range(ROUNDS):
        capsules = [_around(points[owner == k]) for k in range(count) if np.sum(owner == k) > 3]
        off = misfit(points, capsules)
        if off < best[0] - 1e-6:
            best = off, capsules
        again = np.abs(distances(points, capsules)).argmin(axis=1)
        if np.array_equal(again, owner):
            break
        owner = again
    return best[1], best[0]


def _parted(points: FloatArray, count: int) -> NDArray[np.int64]:
    """The points in so many heaps: by k-means, begun with points far from each other."""
    centres = [points[np.argmax(points @ _main(points))]]
    while len(centres) < count:
        apart = np.min([np.linalg.norm(points - c, axis=1) for c in centres], axis=0)
        centres.append(points[np.argmax(apart)])
    middle = np.array(centres)
    owner = np.zeros(len(points), dtype=np.int64)
    for _ in range(ROUNDS):
        owner = np.linalg.norm(points[:, None] - middle[None], axis=2).argmin(axis=1)
        middle = np.array(
            [points[owner == k].mean(axis=0) if np.any(owner == k) else middle[k]
             for k in range(count)]
        )  # fmt: skip
    return owner


def _around(points: FloatArray) -> Capsule:
    """The capsule along the longest direction of some points."""
    along = _main(points)
    across = points - np.outer(points @ along, along)
    centre = 0.5 * (np.quantile(across, 0.02, axis=0) + np.quantile(across, 0.98, axis=0))
    centre = centre - along * (centre @ along)
    t = points @ along
    low, high = np.quantile(t, [0.01, 0.99])
    far = np.linalg.norm(across - centre, axis=1)
    side = (t > low + 0.15 * (high - low)) & (t < high - 0.15 * (high - low))
    chosen = far[side] if side.sum() > 0.3 * len(points) else far
    radius = max(float(np.quantile(chosen, 0.6)), LEAST)
    radius = min(radius, max(0.5 * float(high - low), LEAST))
    start, end = low + radius, max(high - radius, low + radius)
    return centre + start * along, centre + end * along, radius


def _main(points: FloatArray) -> FloatArray:
    """The direction (3,) in which points are spread farthest."""
    _, _, main = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    along: FloatArray = main[0]
    return along if along[np.argmax(np.abs(along))] > 0.0 else -along


def _distance(points: FloatArray, capsule: Capsule) -> FloatArray:
    start, end, radius = capsule
    along = end - start
    share = np.clip((points - start) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
    distance: FloatArray = np.linalg.norm(points - start - share[:, None] * along, axis=1) - radius
    return distance

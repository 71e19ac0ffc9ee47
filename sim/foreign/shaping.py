"""Capsules for every link that an arm can reach: fitted to its surface, or guessed without one."""

import numpy as np
from numpy.typing import NDArray

from sim.foreign.body_file import ShapeOf
from sim.foreign.capsule_fit import Capsule, fit_capsules, fit_symmetric, misfit
from sim.foreign.layout import Layout, Link
from sim.foreign.surface import solid, spread

FloatArray = NDArray[np.float64]

POINTS = 1500  # of the surface of a link
MOST = {"trunk": 6, "head": 4, "pelvis": 2, "hand": 4}  # capsules
FEW = 2  # of any other link
DENSITY = 1000.0  # of a link without a shape [kg/m^3]
BEYOND = 0.1  # what lies so far outside the reach of the arms does not collide [m]
MIRROR_FIT = 1.3  # a capsule of the other arm in a mirror fits this one, too, if no worse than so
SMALL = 0.15  # of upper arm and forearm: what is smaller on a base is left out
ENOUGH = 0.2  # of a surface must be within reach
TWIN = 0.03  # between what is on the left and what is on the right in a mirror [m]
NECK = 0.1  # of upper arm and forearm: so far above the shoulders begins a head
FEWEST = 10  # points that make a surface
FLIP = np.array([1.0, -1.0, 1.0])  # left to right
SLIM = 0.11  # radius of a segment of which neither shape nor mass is known, of its length


def shapes_for(layout: Layout) -> tuple[dict[str, tuple[ShapeOf, ...]], list[str]]:
    """Capsules by link, and the links whose shape is guessed without a surface."""
    found: dict[str, list[Capsule]] = {}
    guessed = []
    for link in layout.links:
        capsules = _fitted(layout, link)
        if not capsules and _matters(layout, link.name):
            capsules = _guess(layout, link)
            guessed += [link.name] if capsules else []
        if capsules:
            found[link.name] = capsules
    found = _mirrored(layout, found)
    return {name: tuple(_said(c) for c in capsules) for name, capsules in found.items()}, guessed


def surface_of(layout: Layout, link: Link) -> FloatArray:
    """Points (k, 3) of the surface of a link, in its frame; of one that is cut its own part."""
    return _own_part(layout, link, spread(layout.shapes(link, solid), POINTS))


def head_from(layout: Layout) -> float:
    """The height from which on a trunk is the head, if that has no link of its own [m]."""
    shoulders = [layout.places(limb)[0][2] for limb in layout.arms]
    arm = float(np.mean([layout.length(limb) for limb in layout.arms]))
    return float(np.mean(shoulders)) + NECK * arm


def _own_part(layout: Layout, link: Link, points: FloatArray) -> FloatArray:
    """A hand that is cut off a forearm has what is beyond the wrist, the forearm the rest."""
    if link.beyond is not None:
        return points[points @ link.beyond > 0.0]
    for other in layout.links:
        if other.beyond is not None and other.parent == link.name:
            points = points[(points - (other.origin - link.origin)) @ other.beyond <= 0.0]
    return points


def _fitted(layout: Layout, link: Link) -> list[Capsule]:
    """Capsules that fit the surface of a link."""
    parts = [surface_of(layout, link)]
    if not link.joints and link.beyond is None:  # of a base: torso, legs, pedestal
        small = SMALL * max(layout.length(limb) for limb in layout.arms)
        parts = [spread(layout.shapes(link, solid, body), POINTS // 2) for body in link.bodies]
        parts = [part for part in parts if len(part) and np.ptp(part, axis=0).max() > small]
        return _of_base(layout, link, parts)
    if link.name in ("trunk", "head"):
        return _fitted_to_both_sides(layout, link, parts)
    most = MOST["hand"] if link.name.endswith("_hand") else MOST.get(link.name, FEW)
    capsules: list[Capsule] = []
    for points in parts:
        near = _within_reach(layout, link, points)
        if len(near) > ENOUGH * max(len(points), 1):
            capsules += fit_capsules(near, most)
    return capsules


def _of_base(layout: Layout, link: Link, parts: list[FloatArray]) -> list[Capsule]:
    """Capsules of what stands still, body by body, a left one as the right one in a mirror."""
    aside = link.origin * [0.0, 1.0, 0.0]
    found: list[Capsule] = []
    done: list[tuple[FloatArray, list[Capsule]]] = []  # in the mirror: middles and capsules
    for part in parts:
        middle, size = part.mean(axis=0) + aside, np.ptp(part, axis=0)
        if abs(middle[1]) < 0.15 * size[1]:
            found += _fitted_to_both_sides(layout, link, [part])
            continue
        twins = [capsules for place, capsules in done if np.allclose(place, middle, atol=TWIN)]
        near = _within_reach(layout, link, part)
        if twins:
            found += twins[0]
        elif len(near) > ENOUGH * len(part):
            own = fit_capsules(part, FEW)
            found += own
            done.append((middle * FLIP, [_flipped(capsule, aside) for capsule in own]))
    return found


def _flipped(capsule: Capsule, aside: FloatArray) -> Capsule:
    """A capsule in the mirror between left and right."""
    start, end, radius = capsule
    return (start + aside) * FLIP - aside, (end + aside) * FLIP - aside, radius


def _fitted_to_both_sides(layout: Layout, link: Link, parts: list[FloatArray]) -> list[Capsule]:
    """Capsules of a trunk or a head, the same left and right."""
    aside = link.origin * [0.0, 1.0, 0.0]  # from the plane between left and right
    found: list[Capsule] = []
    for part in parts:
        seen = _within_reach(layout, link, part) + aside
        heaps = [seen]
        if layout.head == link.name == "trunk":  # a head that is part of it has its own capsules
            high = seen[:, 2] + link.origin[2] > head_from(layout)
            heaps = [seen[~high], seen[high]]
        for heap in heaps:
            if len(heap) >= FEWEST:
                both = fit_symmetric(np.concatenate([heap, heap * FLIP]), MOST[link.name])
                found += [(start - aside, end - aside, radius) for start, end, radius in both]
    return found


def _within_reach(layout: Layout, link: Link, points: FloatArray) -> FloatArray:
    """The points that a hand can come to."""
    near = np.zeros(len(points), dtype=bool)
    for limb in layout.arms:
        shoulder, _, wrist = layout.places(limb)
        hand = _hand_length(layout, limb, wrist)
        reach = layout.length(limb) + hand + BEYOND
        near |= np.linalg.norm(points + link.origin - shoulder, axis=1) < reach
    return points[near]


def _hand_length(layout: Layout, limb: str, wrist: FloatArray) -> float:
    """From the wrist to the fingertips, as far as that is to be seen [m]."""
    hand = next(x for x in layout.links if x.name == layout.chains[limb][-1])
    points = surface_of(layout, hand) + hand.origin - wrist
    return float(np.linalg.norm(points, axis=1).max(initial=0.25 * layout.length(limb)))


def _matters(layout: Layout, name: str) -> bool:
    """Whether a link must have a shape: trunk, and segments of arms of which nothing is seen."""
    if name == "trunk":
        return True
    for chain in layout.chains.values():
        if name in chain and name.endswith(("_upper_arm", "_forearm", "_hand")):
            k = chain.index(name)
            segment = [name]
            if name.endswith("_forearm"):  # up to the wrist, and what rolls there
                segment = list(chain[k : len(chain) - 1])
            if name.endswith("_upper_arm"):
                segment = list(chain[: k + 1])
            return not any(len(surface_of(layout, layout.link(x))) for x in segment if x in
                           {link.name for link in layout.links})  # fmt: skip
    return False


def _guess(layout: Layout, link: Link) -> list[Capsule]:
    """A capsule along a segment, as thick as its mass makes it."""
    tree = layout.tree
    mass = sum(float(tree.model.body_mass[body]) for body in link.bodies)
    start, end = np.zeros(3), _end_of(layout, link)
    length = float(np.linalg.norm(end - start))
    if length < 1e-3:
        return []
    radius = np.sqrt(mass / (DENSITY * np.pi * length)) if mass > 1e-3 else SLIM * length
    radius = float(np.clip(radius, 0.05 * length, 0.45 * length))
    along = (end - start) / length
    return [(start + radius * along, end - radius * along, radius)]


def _end_of(layout: Layout, link: Link) -> FloatArray:
    """Where a segment without a surface ends, in its frame."""
    for limb in layout.arms:
        side = "left" if layout.sides[limb] > 0 else "right"
        _, elbow, wrist = layout.places(limb)
        ends = {"upper_arm": elbow, "forearm": wrist}
        for part, end in ends.items():
            if link.name == f"{side}_{part}":
                return end - link.origin
        if link.name == f"{side}_hand":
            return np.array(0.35 * (wrist - elbow))
    shoulders = np.mean([layout.places(limb)[0] for limb in layout.arms], axis=0)
    return np.array(shoulders - link.origin)


def _mirrored(layout: Layout, found: dict[str, list[Capsule]]) -> dict[str, list[Capsule]]:
    """The left arm has the capsules of the right one in a mirror, where those fit as well."""
    if len(layout.arms) < 2:
        return found
    right, left = (
        next(layout.chains[limb] for limb, side in layout.sides.items() if side == sign)
        for sign in (-1.0, 1.0)
    )
    for one, other in zip(right, left, strict=False):
        if one not in found or other not in found:
            continue
        mirrored = [(FLIP * a, FLIP * b, r) for a, b, r in found[one]]
        points = surface_of(layout, layout.link(other))
        if not len(points) or misfit(points, mirrored) < MIRROR_FIT * misfit(points, found[other]):
            found[other] = mirrored
    return found


def _said(capsule: Capsule) -> ShapeOf:
    start, end, radius = capsule
    return ShapeOf(start=_place(start), end=_place(end), radius=round(float(radius), 4))


def _place(point: FloatArray) -> tuple[float, float, float]:
    x, y, z = (round(float(v), 4) + 0.0 for v in point)
    return x, y, z


__all__ = ["shapes_for", "surface_of"]

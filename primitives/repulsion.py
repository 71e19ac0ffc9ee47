"""Repulsion between capsules, from the closest points of the two.

A pair whose surfaces are d < d_0 apart pushes itself apart with the potential
k (d_0 - d)^3 / (3 d_0), that is with the force

    f = k (d_0 - d)^2 / d_0,    and c (1 - d/d_0) |d'| more while the two draw nearer,

an artificial potential field (Khatib 1986, "Real-time obstacle avoidance for manipulators
and mobile robots", IJRR 5(1)) that is zero at the range d_0 and grows smoothly from there.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Record, Records, compiled
from primitives.mechanics import (
    Row,
    add,
    cross,
    dot,
    point_velocity,
    push_link,
    rotate,
    scale,
    subtract,
    to_link,
    to_world,
    tree_centre,
    vector,
)

FloatArray = NDArray[np.float64]
Vector = tuple[float, float, float]

_VECTOR = (np.float64, (3,))
CAPSULE = np.dtype(
    [
        *(("link", np.int32), ("radius", np.float64)),
        *(("middle", *_VECTOR), ("half", *_VECTOR)),  # half is from the middle to one end
        *(("squared", np.float64), ("reach", np.float64)),  # |half|^2; of a ball around it
    ],
    align=True,
)
# A link that is kept apart from others: its capsules, and a ball around all of them.
GUARDED = np.dtype(
    [
        *(("link", np.int32), ("first", np.int32), ("count", np.int32)),
        *(("centre", *_VECTOR), ("reach", np.float64)),
    ],
    align=True,
)
PAIR = np.dtype([("a", np.int32), ("b", np.int32)], align=True)  # two rows of GUARDED
GUARD = np.dtype(
    [
        *(("links", np.int32), ("link_count", np.int32)),  # its rows of GUARDED
        *(("pairs", np.int32), ("pair_count", np.int32)),  # its rows of PAIR
        *(("range", np.float64), ("stiffness", np.float64), ("damping", np.float64)),
    ],
    align=True,
)
# A hand that is on its way to touch a link, and how far it has been let through.
TOUCH = np.dtype([("hand", np.int32), ("link", np.int32), ("share", np.float64)], align=True)


@compiled
def within_one(s: float) -> float:
    """s held within [-1, 1]; unlike min and max, with no thought for NaN."""
    return 1.0 if s > 1.0 else (-1.0 if s < -1.0 else s)


@compiled
def closest_on_segments(
    u: Vector, uu: float, v: Vector, vv: float, w: Vector
) -> tuple[float, float]:
    """Where on two segments their closest points are.

    One runs from m - u to m + u, the other from n - v to n + v; w = m - n, uu = u . u and
    vv = v . v. The closest points are m + s u and n + t v, with s and t in [-1, 1]. The first
    s is that of the lines; t answers it, and s answers t (after Ericson 2005, Real-Time
    Collision Detection, 5.1.9).
    """
    uv, uw, vw = dot(u, v), dot(u, w), dot(v, w)
    gap = uu * vv - uv * uv
    s = within_one((uv * vw - uw * vv) / gap) if gap > 1e-9 * uu * vv else 0.0
    t = within_one((uv * s + vw) / vv) if vv > 1e-12 else 0.0
    s = within_one((uv * t - uw) / uu) if uu > 1e-12 else 0.0
    return s, t


@compiled
def let_through(touches: Records, one: int, other: int) -> float:
    """Share of the repulsion that is kept between two links, if a hand is to touch the other."""
    kept = 1.0
    for m in range(touches.shape[0]):
        hand, link = touches[m].hand, touches[m].link
        if (hand == one and link == other) or (hand == other and link == one):
            kept -= touches[m].share
    return kept


@compiled
def place(x: Row, capsules: Records, m: int, placed: FloatArray) -> None:
    """Middle and half of a capsule in the world, worked out once per step: placed[m]."""
    if placed[m, 6] == 0.0:
        link = capsules[m].link
        store_row(placed, m, 0, to_world(x, link, vector(capsules[m].middle)))
        store_row(placed, m, 3, rotate(x, link, vector(capsules[m].half)))
        placed[m, 6] = 1.0


@compiled
def store_row(array: FloatArray, row: int, at: int, a: Vector) -> None:
    """Write a vector into a row of an array."""
    array[row, at], array[row, at + 1], array[row, at + 2] = a


@compiled
def add_wrench(
    x: Row, link: int, point: Vector, force: Vector, g: int, wrenches: FloatArray
) -> None:
    """wrenches[g] += that of a force on a point of a link: moment about c, then force."""
    moment = cross(subtract(point, tree_centre(x, link)), force)
    for axis in range(3):
        wrenches[g, axis] += moment[axis]
        wrenches[g, 3 + axis] += force[axis]


@compiled
def press_apart(
    x: Row,
    guard: Record,
    a: Record,
    b: Record,
    placed: FloatArray,
    m: int,
    n: int,
    kept: float,
    ga: int,
    gb: int,
    wrenches: FloatArray,
) -> None:
    """Add the wrenches that push capsules a and b apart, which are placed in rows m and n."""
    middle_a = placed[m, 0], placed[m, 1], placed[m, 2]
    middle_b = placed[n, 0], placed[n, 1], placed[n, 2]
    half_a = placed[m, 3], placed[m, 4], placed[m, 5]
    half_b = placed[n, 3], placed[n, 4], placed[n, 5]
    between = subtract(middle_a, middle_b)
    near = a.reach + b.reach + guard.range
    if dot(between, between) >= near * near:
        return
    s, t = closest_on_segments(half_a, a.squared, half_b, b.squared, between)
    apart = add(between, subtract(scale(s, half_a), scale(t, half_b)))
    squared = dot(apart, apart)
    near = a.radius + b.radius + guard.range
    if squared >= near * near or squared < 1e-12:
        return
    centres = np.sqrt(squared)
    normal = scale(1.0 / centres, apart)
    on_a = subtract(add(middle_a, scale(s, half_a)), scale(a.radius, normal))
    on_b = add(add(middle_b, scale(t, half_b)), scale(b.radius, normal))
    moving = subtract(point_velocity(x, a.link, on_a), point_velocity(x, b.link, on_b))
    opening = dot(normal, moving)
    depth = (near - centres) / guard.range
    force = guard.stiffness * guard.range * depth * depth
    if opening < 0.0:
        force -= guard.damping * min(depth, 1.0) * opening
    add_wrench(x, a.link, on_a, scale(kept * force, normal), ga, wrenches)
    add_wrench(x, b.link, on_b, scale(-kept * force, normal), gb, wrenches)


@compiled
def closer(a: Vector, b: Vector, distance: float) -> bool:
    """Whether two points are closer than a distance [m]."""
    between = subtract(a, b)
    return dot(between, between) < distance * distance


@compiled
def repel(
    x: Row,
    guard: Record,
    guarded: Records,
    pairs: Records,
    capsules: Records,
    touches: Records,
    balls: FloatArray,
    wrenches: FloatArray,
    placed: FloatArray,
    out: FloatArray,
) -> None:
    """out += the torques [N m] that keep the guarded links apart.

    Far pairs are told by balls: around links in the world, then around capsules in the frame
    of their link, where they stand still; only what is near is placed in the world.

    Args:
        x: the simulation.
        guard: a row of GUARD, naming rows of `guarded` and `pairs`.
        guarded: rows of GUARDED.
        pairs: rows of PAIR.
        capsules: rows of CAPSULE.
        touches: rows of TOUCH: hands that are meant to arrive at a link.
        balls: (guarded, 3) to work in.
        wrenches: (guarded, 6) to work in.
        placed: (capsules, 7) to work in.
        out: (nv,) [N m]
    """
    links = guard.links
    for g in range(links, links + guard.link_count):
        one = guarded[g]
        store_row(balls, g, 0, to_world(x, one.link, vector(one.centre)))
        for axis in range(6):
            wrenches[g, axis] = 0.0
        for m in range(one.first, one.first + one.count):
            placed[m, 6] = 0.0
    for p in range(guard.pairs, guard.pairs + guard.pair_count):
        ga, gb = links + pairs[p].a, links + pairs[p].b
        a, b = guarded[ga], guarded[gb]
        ball_a = balls[ga, 0], balls[ga, 1], balls[ga, 2]
        ball_b = balls[gb, 0], balls[gb, 1], balls[gb, 2]
        if not closer(ball_a, ball_b, a.reach + b.reach + guard.range):
            continue
        kept = let_through(touches, a.link, b.link)
        if kept <= 0.0:
            continue
        ball_a = to_link(x, b.link, ball_a)
        for n in range(b.first, b.first + b.count):
            near = a.reach + capsules[n].reach + guard.range
            if closer(ball_a, vector(capsules[n].middle), near):
                place(x, capsules, n, placed)
                for m in range(a.first, a.first + a.count):
                    place(x, capsules, m, placed)
                    press_apart(
                        x, guard, capsules[m], capsules[n], placed, m, n, kept, ga, gb, wrenches
                    )
    for g in range(links, links + guard.link_count):
        moment = wrenches[g, 0], wrenches[g, 1], wrenches[g, 2]
        force = wrenches[g, 3], wrenches[g, 4], wrenches[g, 5]
        if dot(force, force) > 0.0:
            push_link(x, guarded[g].link, moment, force, out)

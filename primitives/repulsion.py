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
    dot,
    point_velocity,
    push_point,
    scale,
    subtract,
    to_world,
    vector,
)

FloatArray = NDArray[np.float64]
Vector = tuple[float, float, float]

_VECTOR = (np.float64, (3,))
CAPSULE = np.dtype(
    [("link", np.int32), ("start", *_VECTOR), ("end", *_VECTOR), ("radius", np.float64)],
    align=True,
)
# Two links that must not touch: their capsules, and a ball around the capsules of each.
PAIR = np.dtype(
    [
        *(("link_a", np.int32), ("first_a", np.int32), ("count_a", np.int32)),
        *(("link_b", np.int32), ("first_b", np.int32), ("count_b", np.int32)),
        *(("centre_a", *_VECTOR), ("radius_a", np.float64)),
        *(("centre_b", *_VECTOR), ("radius_b", np.float64)),
    ],
    align=True,
)
GUARD = np.dtype(
    [
        *(("pairs", np.int32), ("count", np.int32)),
        *(("range", np.float64), ("stiffness", np.float64), ("damping", np.float64)),
    ],
    align=True,
)
# A hand that is on its way to touch a link, and how far it has been let through.
TOUCH = np.dtype([("hand", np.int32), ("link", np.int32), ("share", np.float64)], align=True)


@compiled
def closest_points(a0: Vector, a1: Vector, b0: Vector, b1: Vector) -> tuple[Vector, Vector]:
    """Closest points of two segments (Ericson 2005, Real-Time Collision Detection, 5.1.9)."""
    u, v, w = subtract(a1, a0), subtract(b1, b0), subtract(a0, b0)
    uu, vv, uv, uw, vw = dot(u, u), dot(v, v), dot(u, v), dot(u, w), dot(v, w)
    s, t = 0.0, 0.0
    if uu > 1e-12 and vv > 1e-12:
        gap = uu * vv - uv * uv
        if gap > 1e-12 * uu * vv:
            s = min(max((uv * vw - uw * vv) / gap, 0.0), 1.0)
        t = (uv * s + vw) / vv
        if t < 0.0:
            t = 0.0
            s = min(max(-uw / uu, 0.0), 1.0)
        elif t > 1.0:
            t = 1.0
            s = min(max((uv - uw) / uu, 0.0), 1.0)
    elif uu > 1e-12:
        s = min(max(-uw / uu, 0.0), 1.0)
    elif vv > 1e-12:
        t = min(max(vw / vv, 0.0), 1.0)
    return add(a0, scale(s, u)), add(b0, scale(t, v))


@compiled
def repel(
    x: Row,
    guard: Record,
    pairs: Records,
    capsules: Records,
    touches: Records,
    out: FloatArray,
) -> None:
    """out += the torques [N m] that keep the guarded links apart.

    Args:
        x: the simulation.
        guard: a row of GUARD, naming rows of `pairs`.
        pairs: rows of PAIR.
        capsules: rows of CAPSULE.
        touches: rows of TOUCH: hands that are meant to arrive at a link.
        out: (nv,) [N m]
    """
    for p in range(guard.pairs, guard.pairs + guard.count):
        pair = pairs[p]
        between = subtract(
            to_world(x, pair.link_a, vector(pair.centre_a)),
            to_world(x, pair.link_b, vector(pair.centre_b)),
        )
        reach = pair.radius_a + pair.radius_b + guard.range
        if dot(between, between) > reach * reach:
            continue
        kept = 1.0
        for m in range(touches.shape[0]):
            if touches[m].hand == pair.link_a and touches[m].link == pair.link_b:
                kept -= touches[m].share
        if kept <= 0.0:
            continue
        for a in range(pair.first_a, pair.first_a + pair.count_a):
            a0 = to_world(x, pair.link_a, vector(capsules[a].start))
            a1 = to_world(x, pair.link_a, vector(capsules[a].end))
            for b in range(pair.first_b, pair.first_b + pair.count_b):
                b0 = to_world(x, pair.link_b, vector(capsules[b].start))
                b1 = to_world(x, pair.link_b, vector(capsules[b].end))
                pa, pb = closest_points(a0, a1, b0, b1)
                apart = subtract(pa, pb)
                squared = dot(apart, apart)
                thick = capsules[a].radius + capsules[b].radius
                if squared >= (thick + guard.range) ** 2 or squared < 1e-12:
                    continue
                centres = np.sqrt(squared)
                distance = centres - thick
                normal = scale(1.0 / centres, apart)
                on_a = subtract(pa, scale(capsules[a].radius, normal))
                on_b = add(pb, scale(capsules[b].radius, normal))
                opening = dot(
                    normal,
                    subtract(
                        point_velocity(x, pair.link_a, on_a), point_velocity(x, pair.link_b, on_b)
                    ),
                )
                depth = 1.0 - distance / guard.range
                force = guard.stiffness * guard.range * depth * depth
                if opening < 0.0:
                    force -= guard.damping * min(depth, 1.0) * opening
                force *= kept
                push_point(x, pair.link_a, on_a, scale(force, normal), out)
                push_point(x, pair.link_b, on_b, scale(-force, normal), out)

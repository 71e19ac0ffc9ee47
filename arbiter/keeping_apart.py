"""The limits of links that must not touch: which capsules are near, and how h'' follows, compiled.

h is the distance of two capsules less their margin, see `barriers`. It is that of the closest
points of two segments; these slide along them as the links move, which takes something off h'',
and where segments are nearly parallel they jump from end to end, so that the ends are watched too.
"""

import numpy as np
from numpy.typing import NDArray

from arbiter.barriers import BRAKING, FAR, MARGIN, SPARE, look_from, may_fall, note
from arbiter.dynamics import acceleration_at, help_at, velocity_at
from primitives.compiled import Record, Records, compiled
from primitives.mechanics import (
    Row,
    Vector,
    add,
    cross,
    dot,
    scale,
    subtract,
    to_link,
    to_world,
    vector,
)
from primitives.repulsion import (
    closer,
    closest_on_segments,
    let_through,
    place,
    store_row,
    within_one,
)

FloatArray = NDArray[np.float64]

BRUSH = 0.003  # what may touch but is no hand's goal may press in so far; so it lands softly [m]
YIELD = 0.03  # by so much a margin is lowered below contact where a hand is to touch [m]
AHEAD = 0.004  # a point that leaves its segment's end so soon counts as on its way [s]
PARALLEL = 0.25  # sin^2 of the angle of two segments below which their ends are watched too


@compiled
def spin(moving: FloatArray, j: int) -> Vector:
    """Angular velocity of what joint j moves [rad/s]."""
    if j < 0:
        return 0.0, 0.0, 0.0
    return moving[j, 0], moving[j, 1], moving[j, 2]


@compiled
def slides(at: float, rate: float) -> bool:
    """Whether a closest point moves along its segment now or soon, rather than stay at its end.

    Args:
        at: where on its line it is, the segment being from -1 to 1.
        rate: how fast it moves there [1/s].
    """
    return abs(at) < 1.0 or abs(at + AHEAD * rate) < 1.0 or at * (at + AHEAD * rate) < 0.0


@compiled
def by_sliding(
    apart: Vector,
    normal: Vector,
    passing: Vector,
    distance: float,
    u: Vector,
    uu: float,
    s: float,
    slide_u: bool,
    spin_u: Vector,
    v: Vector,
    vv: float,
    t: float,
    slide_v: bool,
    spin_v: Vector,
) -> float:
    """What the closest points of two segments take off h'' by moving along them [m/s^2].

    h is the least of f(s, t, time) over the points m + s u and n + t v, so that
    h'' = f'' - g . F^-1 g with g and F the derivatives of f' and f by s and t. Points that
    stay at the end of their segment do not count; one that is about to leave it does, or h
    would close faster than foreseen whenever it leaves. F of nearly parallel segments is held
    off zero: there the ends are watched.
    """
    free_u, free_v, gu, gv = False, False, 0.0, 0.0
    if slide_u and uu > 1e-9:
        gu = dot(u, passing) / distance + dot(normal, cross(spin_u, u))
        free_u = slides(s - dot(u, apart) / uu, -gu * distance / uu)
    if slide_v and vv > 1e-9:
        gv = -dot(v, passing) / distance - dot(normal, cross(spin_v, v))
        free_v = slides(t + dot(v, apart) / vv, -gv * distance / vv)
    if free_u and free_v:
        uv = -dot(u, v)
        gap = max(uu * vv - uv * uv, PARALLEL * uu * vv)
        return float(distance * (vv * gu * gu - 2.0 * uv * gu * gv + uu * gv * gv) / gap)
    if free_u:
        return float(distance * gu * gu / uu)
    return float(distance * gv * gv / vv) if free_v else 0.0


@compiled
def look_at_points(
    x: Row,
    a: Record,
    b: Record,
    u: Vector,
    v: Vector,
    middle_a: Vector,
    middle_b: Vector,
    s: float,
    t: float,
    slide_u: bool,
    slide_v: bool,
    margin: float,
    moving: FloatArray,
    first: int,
    count: int,
    near: FloatArray,
) -> int:
    """One more row of `near` if two points of capsules are near; returns how many there are.

    The points are s and t on their segments; those that slide are the closest to the other.
    """
    on_a, on_b = add(middle_a, scale(s, u)), add(middle_b, scale(t, v))
    apart = subtract(on_a, on_b)
    distance = np.sqrt(dot(apart, apart))
    if distance < 1e-6:
        return count
    normal = scale(1.0 / distance, apart)
    passing = subtract(velocity_at(x, moving, a.link, on_a), velocity_at(x, moving, b.link, on_b))
    rate = dot(normal, passing)
    may = may_fall(distance - a.radius - b.radius - margin, rate, BRAKING)
    if may > FAR:
        return count
    left = may + dot(
        normal,
        subtract(
            acceleration_at(x, moving, a.link, on_a), acceleration_at(x, moving, b.link, on_b)
        ),
    )
    left -= max(
        0.0,
        dot(
            normal,
            subtract(help_at(x, moving, a.link, on_a), help_at(x, moving, b.link, on_b)),
        ),
    )
    left += (dot(passing, passing) - rate * rate) / distance
    left -= by_sliding(
        apart, normal, passing, distance,
        u, a.squared, s, slide_u, spin(moving, x.links[a.link].last_dof),
        v, b.squared, t, slide_v, spin(moving, x.links[b.link].last_dof),
    )  # fmt: skip
    k = note(may, first, count, near)
    if k >= 0:
        near[k, 0], near[k, 1], near[k, 13] = left, -1.0, may
        near[k, 2], near[k, 3] = a.link, b.link
        store_row(near, k, 4, on_a)
        store_row(near, k, 7, on_b)
        store_row(near, k, 10, normal)
        count = max(count, k + 1)
    return count


@compiled
def look_at_capsules(
    x: Row,
    a: Record,
    b: Record,
    placed: FloatArray,
    m: int,
    n: int,
    margin: float,
    view: float,
    moving: FloatArray,
    first: int,
    count: int,
    near: FloatArray,
) -> int:
    """More rows of `near` if two capsules are near; returns how many there are.

    One is for their closest points. Where segments are nearly parallel those jump from end to
    end, so that the ends are watched as well.

    Args:
        x: the simulation.
        a: a capsule of one link.
        b: a capsule of another.
        placed: where all are.
        m: which a is.
        n: which b is.
        margin: distance that they are to keep [m].
        view: what is farther from that is not looked at [m].
        moving: how every joint's far side moves.
        first: row of the first pair of the same two links.
        count: how many rows there are.
        near: the rows.
    """
    u, v = (placed[m, 3], placed[m, 4], placed[m, 5]), (placed[n, 3], placed[n, 4], placed[n, 5])
    uu, vv = a.squared, b.squared
    middle_a = placed[m, 0], placed[m, 1], placed[m, 2]
    middle_b = placed[n, 0], placed[n, 1], placed[n, 2]
    between = subtract(middle_a, middle_b)
    s, t = closest_on_segments(u, uu, v, vv, between)
    apart = add(between, subtract(scale(s, u), scale(t, v)))
    far = a.radius + b.radius + margin + view
    if dot(apart, apart) > far * far:
        return count
    uv = dot(u, v)
    for k in range(5 if uu * vv - uv * uv < PARALLEL * uu * vv else 1):
        end = 1.0 if k % 2 else -1.0
        if 0 < k < 3:
            s, t = end, within_one((dot(v, between) + end * uv) / vv)
        elif k > 2:
            s, t = within_one((end * uv - dot(u, between)) / uu), end
        count = look_at_points(
            x, a, b, u, v, middle_a, middle_b, s, t, k == 0 or k > 2, k < 3, margin, moving,
            first, count, near,
        )  # fmt: skip
    return count


@compiled
def look_at_pairs(
    x: Row,
    guarded: Records,
    pairs: Records,
    brushing: Records,
    capsules: Records,
    touches: Records,
    moving: FloatArray,
    balls: FloatArray,
    placed: FloatArray,
    count: int,
    near: FloatArray,
) -> int:
    """Rows of `near` for the links that must not touch, and for capsules that may brush.

    Returns:
        How many rows there are then.
    """
    for g in range(guarded.shape[0]):
        link = guarded[g].link
        centre = to_world(x, link, vector(guarded[g].centre))
        store_row(balls, g, 0, centre)
        store_row(balls, g, 3, velocity_at(x, moving, link, centre))
        turning = spin(moving, x.links[link].last_dof)
        balls[g, 6] = guarded[g].reach * np.sqrt(dot(turning, turning))
        for m in range(guarded[g].first, guarded[g].first + guarded[g].count):
            placed[m, 6] = 0.0
    for p in range(pairs.shape[0]):
        ga, gb = pairs[p].a, pairs[p].b
        a, b = guarded[ga], guarded[gb]
        ball_a = balls[ga, 0], balls[ga, 1], balls[ga, 2]
        ball_b = balls[gb, 0], balls[gb, 1], balls[gb, 2]
        passing = subtract(
            (balls[ga, 3], balls[ga, 4], balls[ga, 5]), (balls[gb, 3], balls[gb, 4], balls[gb, 5])
        )
        view = look_from(np.sqrt(dot(passing, passing)) + balls[ga, 6] + balls[gb, 6])
        if not closer(ball_a, ball_b, a.reach + b.reach + MARGIN + SPARE + view):
            continue
        kept = min(let_through(touches, a.link, b.link), let_through(touches, b.link, a.link))
        if kept <= 0.0:
            continue
        margin = MARGIN + SPARE - (1.0 - kept) * (MARGIN + SPARE + YIELD)
        first = count
        ball_a = to_link(x, b.link, ball_a)
        for n in range(b.first, b.first + b.count):
            if not closer(
                ball_a, vector(capsules[n].middle), a.reach + capsules[n].reach + margin + view
            ):
                continue
            place(x, capsules, n, placed)
            for m in range(a.first, a.first + a.count):
                place(x, capsules, m, placed)
                count = look_at_capsules(
                    x,
                    capsules[m],
                    capsules[n],
                    placed,
                    m,
                    n,
                    margin,
                    view,
                    moving,
                    first,
                    count,
                    near,
                )
    last, link, view, in_link = -1, -1, 0.0, (0.0, 0.0, 0.0)
    for p in range(brushing.shape[0]):
        m, n = brushing[p].a, brushing[p].b
        a, b = capsules[m], capsules[n]
        if n != last or a.link != link:
            last, link = n, a.link
            centre = to_world(x, b.link, vector(b.middle))
            in_link = to_link(x, link, centre)
            passing = subtract(
                velocity_at(x, moving, b.link, centre), velocity_at(x, moving, link, centre)
            )
            turning = subtract(
                spin(moving, x.links[b.link].last_dof), spin(moving, x.links[link].last_dof)
            )
            view = look_from(
                np.sqrt(dot(passing, passing)) + b.reach * np.sqrt(dot(turning, turning))
            )
        if closer(in_link, vector(a.middle), a.reach + b.reach + view):
            place(x, capsules, m, placed)
            place(x, capsules, n, placed)
            count = look_at_capsules(
                x, a, b, placed, m, n, -BRUSH, view, moving, count, count, near
            )  # fmt: skip
    return count

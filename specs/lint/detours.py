"""A way round what a movement runs into: one via point, if one is soon found."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from primitives import GetPosture, GoToPoint, ViaPlace, ViaPosture
from sim import axes_of, origin, places_of
from specs.lint.finding import point
from specs.lint.move import Move, led_by
from specs.lint.together import Together
from specs.lint.touching import distances, looked
from specs.tolerances import size_of

Via = dict[str, Any] | None  # as a task file writes it

# [m] left by a way round on Adonis, but for so much of its time at either end
ROOM, APART = 0.015, 0.15
FARTHEST = (0.08, 0.16, 0.24, 0.32)  # [m] of a via point from the middle of the way, on Adonis
OUTWARDS = (  # forward, to the arm's own side, up
    *((1, 0, 0), (1, 1, 0), (0, 1, 0), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    *((1, 0, -1), (1, 1, -1), (0, 0, 1), (1, -1, 0)),
)
SWINGS = (25.0, 50.0, 75.0)  # [deg] of a via posture from the middle of the way


def way_round(move: Move, at: float, together: Together, search: bool) -> tuple[str, Via]:
    """What to do about a collision, and a via point that avoids it.

    Args:
        move: the movement.
        at: where it collides, as a share of the time in which its set point travels.
        together: it and the others.
        search: whether there is time to look for a via point.
    """
    if at >= 1.0:
        return "choose another goal, or turn the hand or the elbow another way", None
    does = move.does
    if does.via:
        return "move its via points away from there", None
    tries = _via_places(move, does) if isinstance(does, GoToPoint) else _via_postures(move, does)
    for said, changed in tries if search else ():
        other = led_by(changed, move)
        if other is not None and _leads_there(other, together):
            via = changed.via[0].model_dump(exclude_defaults=True)
            return f"go round it: via: [{said}]", via
    return "go round it by way of via points; one alone was not found", None


def _leads_there(move: Move, together: Together) -> bool:
    """Whether a movement comes to its goal with ease, and keeps its distance but near its ends."""
    seen = move.foreseen
    if seen.time[-1] < seen.travel:  # it ran into something
        return False
    if not move.works(seen, move.duration) or seen.torque.max() > 1.0:
        return False
    left = distances(move, seen, together)
    share = seen.time[looked(len(seen.time))] / seen.travel
    inner = left[(share > APART) & (share < 1.0 - APART)]
    return bool(left.min() >= 0.0 and inner.min() > ROOM * size_of(move.body))


def _via_places(move: Move, does: GoToPoint) -> Iterator[tuple[str, GoToPoint]]:
    body, arm = move.body, move.body.arm(does.limb)
    first, last = move.foreseen.qpos[[0, -1]]
    start, end = (places_of(body, q, [arm.palm])[0] for q in (first, last))
    (trunk,) = places_of(body, first, [origin(arm.root)])
    middle = axes_of(body, first, arm.root).T @ (0.5 * (start + end) - trunk)
    side = 1.0 if arm.limb.side == "left" else -1.0
    for far in FARTHEST:
        for ahead, aside, up in OUTWARDS:
            way = np.array([ahead, aside * side, up], dtype=float)
            x, y, z = np.round(middle + far * size_of(body) * way / np.linalg.norm(way), 2).tolist()
            via = ViaPlace(point=(x, y, z))
            yield point((x, y, z)), does.model_copy(update={"via": (via,)})


def _via_postures(move: Move, does: GetPosture) -> Iterator[tuple[str, GetPosture]]:
    body = move.body
    if does.limb is None:
        return
    arm = body.arm(does.limb)
    columns = body.qpos_of_dof[arm.dofs]
    middle = np.rad2deg(0.5 * move.foreseen.qpos[[0, -1]].sum(axis=0)[columns])
    low, high = (np.rad2deg(limit[arm.dofs]) for limit in body.range)
    names = [body.dof_name(int(d)) for d in arm.dofs]
    swung = [k for k, d in enumerate(arm.dofs) if d in arm.shoulder_dofs]
    for far in SWINGS:
        for k in swung:
            for sign in (1.0, -1.0):
                angles = middle.copy()
                angles[k] += sign * far
                angles = np.clip(angles, low, high).round()
                posture = dict(zip(names, angles.tolist(), strict=True))
                said = ", ".join(f"{name}: {angle:g}" for name, angle in posture.items())
                via = ViaPosture(posture=dict(posture))
                yield f"{{posture: {{{said}}}}}", does.model_copy(update={"via": (via,)})

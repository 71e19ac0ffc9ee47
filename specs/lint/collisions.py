"""collision: ways on which links go into each other that must not touch, and a way round."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from primitives import GetPosture, GoToPoint, ViaPlace, ViaPosture
from primitives.primitive import FloatArray
from sim import Body, axes_of, clearances, origin, places_of
from specs.binding import BoundTask
from specs.lint.course import Move, led_by
from specs.lint.finding import Finding, Places, cm, point
from specs.tolerances import PENETRATION, TOUCH_BEFORE_NEXT, size_of

Via = dict[str, Any] | None  # as a task file writes it

EVERY = 2  # nodes of a way from one that is looked at to the next
ROOM, APART = 0.015, 6  # [m] left by a way round, and nodes at its ends where it need not be
STRAY = TOUCH_BEFORE_NEXT  # [m] from its goal, at the end of a way that is foreseen
PRESSED = 0.015  # [m] that a hand and what it touches may go into each other in the end
FARTHEST = (0.08, 0.16, 0.24, 0.32)  # [m] of a via point from the middle of the way
MOST_SEARCHES = 4  # for via points in one task: each may take a second
OUTWARDS = (  # forward, to the arm's own side, up
    *((1, 0, 0), (1, 1, 0), (0, 1, 0), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    *((1, 0, -1), (1, 1, -1), (0, 0, 1), (1, -1, 0)),
)
SWINGS = (25.0, 50.0, 75.0)  # [deg] of a via posture from the middle of the way


@dataclass(frozen=True)
class Clash:
    """Where a way goes wrong."""

    links: tuple[str, str]
    depth: float  # [m]
    at: float  # share of the way


def colliding_ways(task: BoundTask, places: Places, moves: Sequence[Move]) -> list[Finding]:
    """Ways that pass through something or get stuck, as far as they can be foreseen."""
    found = []
    known: dict[int, tuple[Clash, str, Via] | None] = {}
    searches = 0
    for move in moves:
        if move.short > STRAY * size_of(task.body):  # then how the arm goes on cannot be foreseen
            found.append(
                places.finding(
                    "note", "stuck", move.name,
                    f"its way may lead the arm to the ends of its joints, {cm(move.short)} short"
                    " of the goal",
                    "lead it round by via points, or by a direction of 'upper_arm'",
                    short=move.short,
                )
            )  # fmt: skip
            continue
        key = id(move.way)
        if key not in known:
            hit = clash(task.body, move, move.way)
            searches += hit is not None
            aided = searches <= MOST_SEARCHES
            known[key] = None if hit is None else (hit, *_round(task, move, hit, aided))
        told = known[key]
        if told is None:
            continue
        hit, advice, via = told
        one, other = (name.replace("_", " ") for name in hit.links)
        where = "in the end" if hit.at == 1.0 else f"at {100.0 * hit.at:.0f} % of its way"
        found.append(
            places.finding(
                "warning", "collision", move.name,
                f"{where} the {one} would be {cm(hit.depth)} inside the {other}", advice,
                links=list(hit.links), depth=hit.depth, at=hit.at, via=via,
            )
        )  # fmt: skip
    return found


def clash(body: Body, move: Move, way: FloatArray) -> Clash | None:
    """The deepest collision on a way (k, nq) that is deeper than where it begins and ends."""
    pairs = _pairs(body, move)
    if not pairs:
        return None
    looked = way[::EVERY]
    distances = clearances(body, looked, pairs)
    worst: Clash | None = None
    for pair, distance in zip(pairs, distances.T, strict=True):
        touches = _touches(body, move, pair)
        allowed = PRESSED if touches else PENETRATION
        begins = max(0.0, -float(distance[0])) if len(distance) > 1 else 0.0
        ends = max(0.0, -float(distance[-1])) if touches else 0.0
        k = int(np.argmin(distance))
        depth = -float(distance[k])
        if depth > max(begins, min(ends, PRESSED)) + allowed and (
            worst is None or depth > worst.depth
        ):
            worst = Clash(pair, depth, k / max(1, len(looked) - 1))
    return worst


def is_free(body: Body, move: Move, way: FloatArray) -> bool:
    """Whether nothing on a way (k, nq) is inside something else."""
    return clash(body, move, way) is None


def _is_roomy(body: Body, move: Move, way: FloatArray) -> bool:
    """Whether a way keeps its distance, but for where it begins and ends."""
    if not is_free(body, move, way):
        return False
    return bool(clearances(body, way[APART:-APART:EVERY], _pairs(body, move)).min() > ROOM)


def _pairs(body: Body, move: Move) -> list[tuple[str, str]]:
    """Links that must not touch and of which the movement moves one."""
    moved = set(move.dofs.tolist())
    return [
        pair
        for pair in body.map.keep_apart
        if _moved_by(body, pair[0], moved) != _moved_by(body, pair[1], moved)
    ]


def _moved_by(body: Body, link: str, dofs: set[int]) -> frozenset[int]:
    return frozenset(dofs & set(np.flatnonzero(body.ancestors[body.link(link)]).tolist()))


def _touches(body: Body, move: Move, pair: tuple[str, str]) -> bool:
    if move.limb is None or move.touched < 0:
        return False
    hand = body.map.limbs[move.limb].hand
    return set(pair) == {hand, body.model.body(move.touched).name}


def _round(task: BoundTask, move: Move, hit: Clash, search: bool) -> tuple[str, Via]:
    """What to do about a collision, and a via point that avoids it, if one is soon found."""
    if hit.at == 1.0:
        return "choose another goal, or turn the hand or the elbow another way", None
    does = task.graph.subtasks[move.name].does
    if not isinstance(does, GoToPoint | GetPosture) or does.via:
        return "move its via points away from there", None
    tries = (
        _via_places(task, move, does)
        if isinstance(does, GoToPoint)
        else _via_postures(task, move, does)
    )
    for said, changed in tries if search else ():
        way = led_by(task, changed, move)
        if way is not None and _is_roomy(task.body, move, way):
            via = changed.via[0].model_dump(exclude_defaults=True)
            return f"go round it: via: [{said}]", via
    return "go round it by way of via points; one alone was not found", None


def _via_places(task: BoundTask, move: Move, does: GoToPoint) -> Iterator[tuple[str, GoToPoint]]:
    body, arm = task.body, task.body.arm(does.limb)
    start, end = (places_of(body, move.way[k], [arm.palm])[0] for k in (0, -1))
    (trunk,) = places_of(body, move.way[0], [origin(arm.root)])
    middle = axes_of(body, move.way[0], arm.root).T @ (0.5 * (start + end) - trunk)
    side = 1.0 if arm.limb.side == "left" else -1.0
    for far in FARTHEST:
        for ahead, aside, up in OUTWARDS:
            way = np.array([ahead, aside * side, up], dtype=float)
            x, y, z = np.round(middle + far * way / np.linalg.norm(way), 2).tolist()
            via = ViaPlace(point=(x, y, z))
            yield point((x, y, z)), does.model_copy(update={"via": (via,)})


def _via_postures(
    task: BoundTask, move: Move, does: GetPosture
) -> Iterator[tuple[str, GetPosture]]:
    body = task.body
    if does.limb is None:
        return
    arm = body.arm(does.limb)
    columns = body.qpos_of_dof[arm.dofs]
    middle = np.rad2deg(0.5 * (move.way[0] + move.way[-1])[columns])
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

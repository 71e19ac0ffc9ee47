"""collision: movements on which links go into each other that must not touch; a way round."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from primitives import GetPosture, GoToPoint, ViaPlace, ViaPosture
from sim import Body, Foreseen, axes_of, clearances, origin, places_of
from specs.binding import BoundTask
from specs.lint.course import Move, led_by
from specs.lint.finding import Finding, Places, cm, point

Via = dict[str, Any] | None  # as a task file writes it

BRUSH = 0.002  # [m] of depth that is not told
LOOKS = 60  # postures of a movement that are looked at, at most
ROOM, APART = 0.015, 0.15  # [m] left by a way round, but for so much of its time at either end
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
    """Movements on which links go into each other, as far as they can be foreseen."""
    found = []
    known: dict[int, tuple[Clash, str, Via] | None] = {}
    searches = 0
    for move in moves:
        key = id(move.foresight)
        if key not in known:
            hit = clash(move)
            searches += hit is not None
            aided = searches <= MOST_SEARCHES
            known[key] = None if hit is None else (hit, *_round(task, move, hit, aided))
        told = known[key]
        if told is None:
            continue
        hit, advice, via = told
        one, other = (name.replace("_", " ") for name in hit.links)
        where = "in the end" if hit.at >= 1.0 else f"at {100.0 * hit.at:.0f} % of its way"
        found.append(
            places.finding(
                "warning", "collision", move.name,
                f"{where} the {one} would be {cm(hit.depth)} inside the {other}", advice,
                links=list(hit.links), depth=hit.depth, at=hit.at, via=via,
            )
        )  # fmt: skip
    return found


def clash(move: Move) -> Clash | None:
    """The deepest collision of a movement that is deeper than where it begins and ends."""
    if not touches(move, move.foreseen):
        return None
    pairs, through = _pairs(move), move.through()
    looked = _looked(through)
    worst: Clash | None = None
    for pair, distance in zip(
        pairs, clearances(move.body, through.qpos[looked], pairs).T, strict=True
    ):
        meant = set(pair) == move.touching
        allowed = PRESSED if meant else BRUSH
        begins = max(0.0, -float(distance[0]))
        ends = max(0.0, -float(distance[-1])) if meant else 0.0
        k = int(np.argmin(distance))
        depth = -float(distance[k])
        if depth > max(begins, min(ends, PRESSED)) + allowed and (
            worst is None or depth > worst.depth
        ):
            worst = Clash(pair, depth, float(through.time[looked[k]]) / through.travel)
    return worst


def touches(move: Move, foreseen: Foreseen) -> bool:
    """Whether links that must not touch do, but for those that it is to bring together."""
    pairs = [pair for pair in _pairs(move) if set(pair) != move.touching]
    if not pairs:
        return False
    return bool(clearances(move.body, foreseen.qpos[_looked(foreseen)], pairs).min() < 0.0)


def _leads_there(move: Move) -> bool:
    """Whether a movement comes to its goal with ease, and keeps its distance but near its ends."""
    if not move.works(move.foreseen, move.duration) or move.foreseen.torque.max() > 1.0:
        return False
    if touches(move, move.foreseen):
        return False
    share = move.foreseen.time / move.foreseen.travel
    inner = move.foreseen.qpos[(share > APART) & (share < 1.0 - APART)]
    return bool(clearances(move.body, inner[:: _step(len(inner))], _pairs(move)).min() > ROOM)


def _looked(foreseen: Foreseen) -> NDArray[np.int_]:
    """Rows of a movement that are looked at, the first and the last among them."""
    last = len(foreseen.time) - 1
    return np.append(np.arange(0, last, _step(last)), last)


def _step(rows: int) -> int:
    return -(-rows // LOOKS)


def _pairs(move: Move) -> list[tuple[str, str]]:
    """Links that must not touch and of which the movement moves one."""
    body, moved = move.body, set(move.dofs.tolist())
    return [
        pair
        for pair in body.map.keep_apart
        if _moved_by(body, pair[0], moved) != _moved_by(body, pair[1], moved)
    ]


def _moved_by(body: Body, link: str, dofs: set[int]) -> frozenset[int]:
    return frozenset(dofs & set(np.flatnonzero(body.ancestors[body.link(link)]).tolist()))


def _round(task: BoundTask, move: Move, hit: Clash, search: bool) -> tuple[str, Via]:
    """What to do about a collision, and a via point that avoids it, if one is soon found."""
    if hit.at >= 1.0:
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
        other = led_by(task, changed, move)
        if other is not None and _leads_there(other):
            via = changed.via[0].model_dump(exclude_defaults=True)
            return f"go round it: via: [{said}]", via
    return "go round it by way of via points; one alone was not found", None


def _via_places(task: BoundTask, move: Move, does: GoToPoint) -> Iterator[tuple[str, GoToPoint]]:
    body, arm = task.body, task.body.arm(does.limb)
    first, last = move.foreseen.qpos[[0, -1]]
    start, end = (places_of(body, q, [arm.palm])[0] for q in (first, last))
    (trunk,) = places_of(body, first, [origin(arm.root)])
    middle = axes_of(body, first, arm.root).T @ (0.5 * (start + end) - trunk)
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

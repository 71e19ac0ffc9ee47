"""Which links come into each other on a movement that must not touch, and how deep."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim import Body, Foreseen, clearances
from specs.lint.course import Move
from specs.lint.together import Together

BRUSH = 0.002  # [m] of depth that is not told
PRESSED = 0.015  # [m] that a hand and what it touches may go into each other in the end
LOOKS = 60  # postures of a movement that are looked at, at most


@dataclass(frozen=True)
class Clash:
    """Where a movement goes wrong."""

    links: tuple[str, str]
    depth: float  # [m]
    at: float  # share of the time in which its set point travels


def clash(move: Move, together: Together) -> Clash | None:
    """The deepest collision of a movement that is deeper than where it begins and ends."""
    if not touches(move, move.foreseen, together):
        return None
    pairs, through = pairs_of(move), move.through()
    rows = looked(len(through.time))
    postures = together.postures(move, through, rows)
    worst: Clash | None = None
    for pair, distance in zip(pairs, clearances(move.body, postures, pairs).T, strict=True):
        meant = set(pair) == move.touching
        allowed = PRESSED if meant else BRUSH
        begins = max(0.0, -float(distance[0]))
        ends = max(0.0, -float(distance[-1])) if meant else 0.0
        k = int(np.argmin(distance))
        depth = -float(distance[k])
        if depth > max(begins, min(ends, PRESSED)) + allowed and (
            worst is None or depth > worst.depth
        ):
            worst = Clash(pair, depth, float(through.time[rows[k]]) / through.travel)
    return worst


def touches(move: Move, foreseen: Foreseen, together: Together) -> bool:
    """Whether links that must not touch do, but for those that it is to bring together."""
    pairs = [pair for pair in pairs_of(move) if set(pair) != move.touching]
    if not pairs:
        return False
    postures = together.postures(move, foreseen, looked(len(foreseen.time)))
    return bool(clearances(move.body, postures, pairs).min() < 0.0)


def pairs_of(move: Move) -> list[tuple[str, str]]:
    """Links that must not touch and of which the movement moves one."""
    body, dofs = move.body, set(move.dofs.tolist())
    return [
        pair
        for pair in body.map.keep_apart
        if _moved_by(body, pair[0], dofs) != _moved_by(body, pair[1], dofs)
    ]


def looked(rows: int) -> NDArray[np.int_]:
    """Rows of a movement that are looked at, the first and the last among them."""
    return np.append(np.arange(0, rows - 1, -(-(rows - 1) // LOOKS)), rows - 1)


def _moved_by(body: Body, link: str, dofs: set[int]) -> frozenset[int]:
    return frozenset(dofs & set(np.flatnonzero(body.ancestors[body.link(link)]).tolist()))

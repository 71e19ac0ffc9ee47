"""Which links come into each other on a movement that must not touch, and how deep."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from primitives.primitive import FloatArray
from sim import Foreseen, clearances
from specs.lint.move import Move
from specs.lint.together import Together
from specs.tolerances import size_of

BRUSH = 0.002  # [m] of depth that is not told, on Adonis
LOOKS = 60  # postures of a movement that are looked at, at most


@dataclass(frozen=True)
class Clash:
    """Where a movement goes wrong."""

    links: tuple[str, str]
    depth: float  # [m] to which they would go into each other if they could
    at: float  # share of the time in which its set point travels, when they first touch


def clash(move: Move, together: Together) -> Clash | None:
    """The deepest collision of a movement that is deeper than where it begins."""
    near = distances(move, move.foreseen, together)
    if near.min(initial=0.0) >= 0.0:
        return None
    through = move.through()
    worst: Clash | None = None
    for pair, distance, free in zip(
        move.apart, near.T, distances(move, through, together).T, strict=True
    ):
        depth, begins = -float(free.min()), max(0.0, -float(free[0]))
        if (
            distance.min() < 0.0
            and depth > begins + BRUSH * size_of(move.body)
            and (worst is None or depth > worst.depth)
        ):
            rows = looked(len(move.foreseen.time))
            first = rows[int(np.argmax(distance < min(0.0, float(distance[0]))))]
            worst = Clash(pair, depth, float(move.foreseen.time[first]) / through.travel)
    return worst


def touches(move: Move, foreseen: Foreseen, together: Together) -> bool:
    """Whether links that must not touch do, but for those that it is to bring together."""
    return bool(distances(move, foreseen, together).min(initial=0.0) < 0.0)


def distances(move: Move, foreseen: Foreseen, together: Together) -> FloatArray:
    """Distances (k, pairs) [m] of links that it is to keep apart, if it goes so."""
    postures = together.postures(move, foreseen, looked(len(foreseen.time)))
    return clearances(move.body, postures, move.apart)


def looked(rows: int) -> NDArray[np.int_]:
    """Rows of a movement that are looked at, the first and the last among them."""
    return np.append(np.arange(0, rows - 1, -(-(rows - 1) // LOOKS)), rows - 1)

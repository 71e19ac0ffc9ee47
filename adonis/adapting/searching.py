"""A small search: CMA-ES (Hansen 2016, "The CMA evolution strategy: a tutorial") over a few knobs.

Everything that the search has come to follows from its seed and the costs of the candidates that
it has tried. So those costs are all that has to be kept: a search that was broken off asks for the
same candidates again, is told what they cost, and goes on as if nothing had happened.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from cmaes import CMA
from numpy.typing import NDArray

from adonis.adapting.knobs import KNOBS, Knob, bounds, factors_of
from adonis.adapting.trying import Mark

FloatArray = NDArray[np.float64]
Factors = dict[str, float]
Try = Callable[[Sequence[Factors]], list[Mark]]

FIRST = 0.25  # spread of the first candidates, in logarithms of the factors
STRAY = 0.5  # cost of a factor that is e times what the laws say
LATER = 20.0  # cost of taking twice the time


@dataclass(frozen=True)
class Found:
    """The best that a search has come to."""

    factors: Factors
    mark: Mark
    start: Mark  # with all factors 1
    tried: int  # candidates, the start among them


def search(
    tries: Try,
    budget: int,
    *,
    seed: int = 0,
    knobs: tuple[Knob, ...] = KNOBS,
    known: Sequence[Sequence[Mark]] = (),
    done: Callable[[Sequence[Mark], Found], None] | None = None,
) -> Found:
    """Look for factors that are better than none.

    Args:
        tries: marks of candidates, all of a generation at once.
        budget: how many candidates are tried, at most; the start is the first.
        seed: of what is drawn.
        knobs: what may be turned.
        known: marks of the first generations, from a search that was broken off.
        done: told the marks of each generation, and the best so far.

    Returns:
        The best; never worse than the start.
    """
    asked = CMA(np.zeros(len(knobs)), FIRST, bounds=bounds(knobs), seed=seed + 1)
    many = asked.population_size
    generations = list(known)
    found: Found | None = None
    for k in range(1 + max(0, budget - 1) // many):
        points = [np.zeros(len(knobs))] if k == 0 else [asked.ask() for _ in range(many)]
        factors = [factors_of(point, knobs) for point in points]
        kept = generations[k] if k < len(generations) else ()
        marks = list(kept) if len(kept) == len(points) else tries(factors)
        found = _best(found, factors, marks)
        if k:
            costs = [m.cost + _stray(f) for f, m in zip(factors, marks, strict=True)]
            asked.tell(list(zip(points, costs, strict=True)))
        if done is not None:
            done(marks, found)
    assert found is not None, "the start is always tried"
    return found


def _best(found: Found | None, factors: Sequence[Factors], marks: Sequence[Mark]) -> Found:
    """The best of what was found before and a generation."""
    if found is None:
        return Found(factors[0], marks[0], marks[0], 1)
    best, mark = found.factors, found.mark
    for one, its in zip(factors, marks, strict=True):
        if _key(one, its) < _key(best, mark):
            best, mark = one, its
    return Found(best, mark, found.start, found.tried + len(marks))


def _key(factors: Factors, mark: Mark) -> tuple[int, float]:
    return mark.failures, mark.cost + _stray(factors)


def _stray(factors: Factors) -> float:
    """A little for every factor that is turned, and more for time."""
    off = {name: abs(float(np.log(factor))) for name, factor in factors.items()}
    return STRAY * sum(off.values()) + LATER * max(0.0, factors.get("time", 1.0) - 1.0)

"""Adapt a task to another body: the laws of scaling, then a search for what they leave over.

After Hodgins & Pollard (1997), "Adapting simulated behaviors for new characters": lengths, times
and gains are scaled first (`specs.fitted`, `sim.scaled_gains`), then a few high-level parameters
are tuned in simulation.
"""

from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass

from adonis.adapting.knobs import KNOBS, TIME, turned
from adonis.adapting.searching import Factors, Found, search
from adonis.adapting.trying import Mark, marks
from adonis.keeping import keep, kept_file, read_kept
from sim import Body
from specs import TaskSpec, bind_task

Progress = Callable[[int, Found], None]


@dataclass(frozen=True)
class Adapted:
    """A task that suits another body."""

    spec: TaskSpec
    found: Found


def adapt(
    spec: TaskSpec,
    body: Body,
    *,
    budget: int,
    seed: int = 0,
    keep_tempo: bool = False,
    afresh: bool = False,
    progress: Progress | None = None,
) -> Adapted:
    """Search near a task that has been scaled to a body for one that succeeds with more to spare.

    The marks of all candidates are kept in the user's cache after each generation, so that a
    search that was broken off goes on from there.

    Args:
        spec: the task as the laws have it for that body: see `fitted`.
        body: the body.
        budget: how many candidates are danced, at most.
        seed: of what is drawn.
        keep_tempo: whether its times stay as they are.
        afresh: forget what was kept.
        progress: told how many candidates have been danced, and the best so far.

    Raises:
        SpecError: the task does not fit the body.
    """
    knobs = tuple(knob for knob in KNOBS if not (keep_tempo and knob.name == TIME))
    file = kept_file("adaptations", spec, body, seed, [knob.name for knob in knobs])
    known = [] if afresh else _marks_in(read_kept(file))
    every: list[list[Mark]] = []

    def tries(candidates: Sequence[Factors]) -> list[Mark]:
        return marks([bind_task(turned(spec, f), body) for f in candidates])

    def done(generation: Sequence[Mark], found: Found) -> None:
        every.append(list(generation))
        if len(every) > len(known):
            keep(file, [[astuple(mark) for mark in marks_] for marks_ in every])
        if progress is not None:
            progress(found.tried, found)

    found = search(tries, budget, seed=seed, knobs=knobs, known=known, done=done)
    return Adapted(turned(spec, found.factors), found)


def _marks_in(kept: object) -> list[list[Mark]]:
    """The marks in a file; none if it is damaged."""
    try:
        generations = [[Mark(*values) for values in marks_] for marks_ in kept]  # type: ignore[attr-defined]
        sound = all(
            isinstance(m.failures, int) and isinstance(m.cost, float)
            for generation in generations
            for m in generation
        )
    except TypeError:
        return []
    return generations if sound else []

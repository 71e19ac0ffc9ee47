"""Tempo: which beat it is when, in a task whose tempo changes.

tempo: 80
tempo_map:
  - {beat: 8, tempo: 120}          # from the ninth beat on
  - {subtask: finale, tempo: 60}   # from when it is planned to begin

A stretch of so many beats across a change takes the time that it takes at both tempos.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from specs.conditions import Name

Tempo = Annotated[float, Field(ge=1, le=1000)]  # beats per minute
MOST_STEPS = 100  # of a tempo map
ROUNDING = 1e-9  # what begins this much before a change begins at it [s, beats]


class TempoStep(BaseModel):
    """Another tempo, from a beat or a sub-task on."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    beat: Annotated[float | None, Field(ge=0, le=1e6)] = None  # so many have passed by then; or
    subtask: Name | None = None  # from when this one is planned to begin
    tempo: Tempo  # beats per minute

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.beat is None) == (self.subtask is None):
            raise ValueError("give either beat or subtask, from which on the tempo holds")
        return self


@dataclass(frozen=True)
class Clock:
    """Stretches of one tempo each: the beat at which it begins, and the tempo there."""

    beats: tuple[float, ...]  # rising, the first is 0
    tempos: tuple[float, ...]  # beats per minute

    @cached_property
    def seconds(self) -> tuple[float, ...]:
        """When each stretch begins [s]."""
        found = [0.0]
        for (one, then), tempo in zip(pairwise(self.beats), self.tempos, strict=False):
            found.append(found[-1] + (then - one) * 60.0 / tempo)
        return tuple(found)

    def beat(self, time: float) -> float:
        """How many beats have passed by a time [s]."""
        k = self._stretch(time)
        return self.beats[k] + (time - self.seconds[k]) * self.tempos[k] / 60.0

    def tempo(self, time: float) -> float:
        """The tempo at a time [s]."""
        return self.tempos[self._stretch(time)]

    def lasts(self, start: float, beats: float) -> float:
        """How long so many beats take that begin at a time [s]."""
        k, lasts = self._stretch(start), 0.0
        for j in range(k, len(self.tempos) - 1):
            before = (self.seconds[j + 1] - max(start, self.seconds[j])) * self.tempos[j] / 60.0
            if beats <= before + ROUNDING:
                return lasts + beats * 60.0 / self.tempos[j]
            beats -= before
            lasts += before * 60.0 / self.tempos[j]
        return lasts + beats * 60.0 / self.tempos[-1]

    def changes(self, start: float, end: float) -> tuple[tuple[float, float], ...]:
        """The tempos between two times [s]: so many beats later, so many beats per minute."""
        k, now = self._stretch(start) + 1, self.beat(start)
        n = sum(second < end - ROUNDING for second in self.seconds)
        return tuple((b - now, t) for b, t in zip(self.beats[k:n], self.tempos[k:n], strict=True))

    def _stretch(self, time: float) -> int:
        return bisect_right(self.seconds, time + ROUNDING) - 1


def clock_of(tempo: float, steps: Sequence[TempoStep], begins: Mapping[str, float]) -> Clock:
    """The clock of a task.

    Args:
        tempo: with which it begins.
        steps: its tempo map.
        begins: the beat at which a sub-task begins; steps at others are left out.
    """
    known = {0.0: tempo}
    for step in steps:  # of two at the same beat the one written last holds
        beat = begins.get(step.subtask or "") if step.beat is None else step.beat
        if beat is not None:
            known[beat] = step.tempo
    return Clock(tuple(sorted(known)), tuple(known[beat] for beat in sorted(known)))

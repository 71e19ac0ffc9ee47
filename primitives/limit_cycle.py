"""The limit cycle of Matsuoka's oscillator: what its formulas give only nearly, measured once."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from primitives.oscillator import STATES, States, matsuoka

FloatArray = NDArray[np.float64]

STEP = 0.02  # of the integration; times here are in units of t1, states in units of c
SETTLING = 200.0


@dataclass(frozen=True)
class LimitCycle:
    """One cycle, from where the first harmonic of its output rises through zero."""

    states: FloatArray  # (samples + 1, 4) at even times, the first again at the end
    pace: float  # f t1: the frequency times the time constant
    swing: float  # amplitude of the output, half of its range
    ahead: float  # amplitude of x1 - x2, by its first harmonic
    aside: float  # amplitude of v1 - v2
    turn: float  # by which v1 - v2 comes after x1 - x2 [rad]

    def at(self, phase: float) -> FloatArray:
        """The states (4,) at a phase [rad]; the output's first harmonic is sin(phase)."""
        share = (phase / (2.0 * np.pi)) % 1.0 * (len(self.states) - 1)
        rows = np.arange(len(self.states))
        return np.array([np.interp(share, rows, self.states[:, i]) for i in range(STATES)])


@lru_cache(maxsize=1)
def limit_cycle() -> LimitCycle:
    """Let the oscillator run by itself until it repeats itself, and measure a cycle."""
    s = np.array([0.3, 0.1, 0.0, 0.0])
    rows = []
    for _ in range(round(SETTLING / STEP)):
        rows.append(s)
        a = _rate(s)
        b = _rate(s + 0.5 * STEP * a)
        c = _rate(s + 0.5 * STEP * b)
        s = s + STEP / 6.0 * (a + 2.0 * b + 2.0 * c + _rate(s + STEP * c))
    way = np.array(rows)
    output = np.maximum(way[:, 0], 0.0) - np.maximum(way[:, 2], 0.0)
    rising = np.flatnonzero((output[:-1] < 0.0) & (output[1:] >= 0.0))[-2:]
    share = output[rising] / (output[rising] - output[rising + 1])
    begin, end = rising + share  # in steps
    samples = 256
    wave = np.exp(-2j * np.pi * np.arange(samples) / samples)

    def cycle_from(first: float) -> FloatArray:
        when = np.linspace(first, first + end - begin, samples + 1)
        steps = np.arange(len(way))
        return np.column_stack([np.interp(when, steps, way[:, i]) for i in range(STATES)])

    last = output[rising[0] : rising[1] + 1]
    share_of_last = np.linspace(begin, end, samples + 1)[:-1]
    first_harmonic = np.mean(np.interp(share_of_last, np.arange(len(way)), output) * wave)
    early = np.angle(1j * first_harmonic) / (2.0 * np.pi)  # its phase at the crossing, in cycles
    cycle = cycle_from(begin - early * (end - begin))
    ahead, aside = (2.0 * np.mean((cycle[:-1, i] - cycle[:-1, i + 2]) * wave) for i in (0, 1))
    return LimitCycle(
        states=cycle,
        pace=float(1.0 / ((end - begin) * STEP)),
        swing=float(0.5 * (last.max() - last.min())),
        ahead=float(abs(ahead)),
        aside=float(abs(aside)),
        turn=float(np.angle(ahead / aside)),
    )


def _rate(s: FloatArray) -> FloatArray:
    now: States = (float(s[0]), float(s[1]), float(s[2]), float(s[3]))
    return np.array(matsuoka(now, 1.0, 0.0, 1.0))

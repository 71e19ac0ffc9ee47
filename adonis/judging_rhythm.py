"""How fast, how far and how far behind a joint or a hand swings: by zero crossings and a sine.

Only angles, places and times go in, nothing of the oscillators that were to make them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from primitives import Oscillate

FloatArray = NDArray[np.float64]

FEWEST_CYCLES = 2.0  # below, nothing can be told
SETTLING = 0.5  # cycles after a change of tempo


@dataclass(frozen=True)
class Rhythm:
    """What was to be seen for some time."""

    start: float  # [s]
    end: float
    frequency: float  # [Hz]


@dataclass(frozen=True)
class Seen:
    """What was seen."""

    frequency: float  # [Hz]; 0 where nothing swings
    amplitudes: FloatArray  # of each cycle (cycles,), in the unit of what was given
    phase: float  # of its sine at time 0 [rad]


def asked_rhythms(does: Oscillate, start: float, end: float) -> Iterator[Rhythm]:
    """The stretches of one frequency, without the time in which the swing grows or dies away.

    Its frequencies are in Hz: see `Primitive.at_tempo`.

    Stretches too short to be measured are left out.
    """
    assert does.frequency is not None
    begins, cycle, frequency = start, 0.0, does.frequency
    stretches = [(begins, frequency)]
    for change in does.then:
        assert change.frequency is not None
        begins += (change.cycle - cycle) / frequency
        cycle, frequency = change.cycle, change.frequency
        stretches.append((begins, frequency))
    ends = [min(begins, end) for begins, _ in stretches[1:]] + [end]
    for k, ((begins, frequency), stops) in enumerate(zip(stretches, ends, strict=True)):
        first = begins + (SETTLING if k else does.ease) / frequency
        last = stops - (does.ease / frequency if stops == end else 0.0)
        if (last - first) * frequency >= FEWEST_CYCLES * (1.0 - 1e-9):
            yield Rhythm(first, last, frequency)


def seen(time: FloatArray, angle: FloatArray, frequency: float) -> Seen:
    """Measure a swing.

    Args:
        time: (k,) [s]
        angle: (k,) [rad], or in any other unit.
        frequency: of the sine that is fitted to it [Hz]; what it has is measured apart from that.
    """
    turn = 2.0 * np.pi * frequency * time
    # The trend and the sine are fitted at once: a line alone would take part of the sine away.
    columns = np.column_stack([np.ones_like(time), time, np.sin(turn), np.cos(turn)])
    fitted = np.linalg.lstsq(columns, angle, rcond=None)[0]
    swing = angle - columns[:, :2] @ fitted[:2]
    rises = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
    if len(rises) < 2:
        return Seen(0.0, np.zeros(1), np.nan)
    share = swing[rises] / (swing[rises] - swing[rises + 1])
    crossings = time[rises] + share * (time[rises + 1] - time[rises])
    cycles = [swing[a : b + 1] for a, b in pairwise(rises)]
    return Seen(
        frequency=float((len(crossings) - 1) / (crossings[-1] - crossings[0])),
        amplitudes=np.array([0.5 * (c.max() - c.min()) for c in cycles]),
        phase=float(np.arctan2(fitted[3], fitted[2])),
    )


def off_rhythm(
    does: Oscillate, rhythm: Rhythm, time: FloatArray, swung: Mapping[str, FloatArray]
) -> tuple[dict[str, float], dict[str, float], dict[str, float]]:
    """By how much joints, or a hand, miss frequency and amplitude [%], and lags [deg].

    Args:
        does: what was asked.
        rhythm: for how long, and how fast.
        time: (k,) [s]
        swung: where each joint [deg], or the hand along each direction [m], was (k,).

    Returns:
        By joint or direction; lags are behind the first.
    """
    frequencies, amplitudes, lags = {}, {}, {}
    rows = (time >= rhythm.start) & (time <= rhythm.end)
    first: tuple[float, float] | None = None
    for name, swing in does.swings.items():
        what = seen(time[rows], swung[name][rows], rhythm.frequency)
        frequencies[name] = 100.0 * abs(what.frequency / rhythm.frequency - 1.0)
        share = what.amplitudes / swing.amplitude
        amplitudes[name] = 100.0 * float(np.abs(share - 1.0).max())
        if first is None:
            first = what.phase, swing.lag
            continue
        behind = np.rad2deg(first[0] - what.phase) - (swing.lag - first[1])
        lags[name] = abs(float((behind + 180.0) % 360.0 - 180.0))
    return frequencies, amplitudes, lags


def off_swing(
    does: Oscillate, time: FloatArray, swung: Mapping[str, FloatArray], start: float, end: float
) -> dict[str, float]:
    """By how much the width of a swing is missed, in a rhythm too short for more [%]."""
    rows = (time >= start) & (time <= end)
    return {
        name: 100.0 * abs(0.5 * float(np.ptp(swung[name][rows])) / swing.amplitude - 1.0)
        for name, swing in does.swings.items()
    }


def off_centre(
    rhythm: Rhythm, time: FloatArray, swung: Mapping[str, FloatArray]
) -> dict[str, float]:
    """How far the middle of a hand's swing is from its centre, along each direction [m].

    It is the mean over whole cycles.
    """
    cycles = np.floor((rhythm.end - rhythm.start) * rhythm.frequency * (1.0 + 1e-9))
    end = rhythm.start + cycles / rhythm.frequency
    rows = (time >= rhythm.start) & (time < end)
    return {name: abs(float(np.mean(place[rows]))) for name, place in swung.items()}

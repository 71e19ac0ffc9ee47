"""Figures of a human doing the same task, to hold the controllers against."""

import csv
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from adonis.errors import InputError

FloatArray = NDArray[np.float64]

DATA = Path(str(files("adonis") / "data"))
NUMBERS = (
    *("duration", "path", "peak_speed", "peak_over_mean"),
    *("time_to_peak", "jerk", "peak_at_5hz"),
)


@dataclass(frozen=True)
class HumanMove:
    """One sub-task by a human; what was not measured is NaN."""

    duration: float  # [s]
    path: float  # [m]
    peak_speed: float  # of the hand [m/s]
    peak_over_mean: float
    time_to_peak: float  # share of the duration
    jerk: float  # eq 11 [m^2/s^5]
    peak_at_5hz: float  # what 5 samples/s would show of the peak [m/s]
    speed: FloatArray  # hand speed at evenly spread times (k,) [m/s]; may be empty


@dataclass(frozen=True)
class Human:
    """A human's sub-tasks by their number in the task, from 1."""

    moves: dict[int, HumanMove]
    about: str

    def column(self, name: str, count: int) -> FloatArray:
        """One figure of all sub-tasks (count,); NaN where there is none."""
        return np.array(
            [
                getattr(self.moves[k], name) if k in self.moves else np.nan
                for k in range(1, count + 1)
            ]
        )


def load_human(path: str | Path) -> Human:
    """Read a human's figures.

    Args:
        path: a CSV file with a column `subtask` (1, 2, ...) and any of `duration` [s], `path`
            [m], `peak_speed` [m/s], `peak_over_mean`, `time_to_peak` (share), `jerk`
            [m^2/s^5], `peak_at_5hz` [m/s], and of `s000` ... `s100`, the hand speed [m/s] at
            so many hundredths of the duration. Lines that begin with # say where it is from.

    Raises:
        InputError: there is no such file, or it is not like that; with file and line.
    """
    path = Path(path)
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as problem:
        said = getattr(problem, "strerror", None) or "is not text"
        raise InputError(f"{path}: {said}") from None
    about = " ".join(line.lstrip("# ").strip() for line in lines if line.startswith("#"))
    first = next((i for i, line in enumerate(lines) if not line.startswith("#")), len(lines))
    reader = csv.DictReader(lines[first:])
    columns = reader.fieldnames or []
    if "subtask" not in columns:
        raise InputError(f"{path}:{first + 1}: expected a column 'subtask', found {columns}")
    samples = sorted(c for c in columns if c[:1] == "s" and c[1:].isdigit())
    moves = {}
    for row in reader:
        where = f"{path}:{first + reader.line_num}"
        try:
            numbers = {name: float(row.get(name) or "nan") for name in NUMBERS}
            speed = np.array([float(row[c]) for c in samples])
            number = int(row["subtask"])
        except (TypeError, ValueError) as problem:
            raise InputError(f"{where}: {problem}") from None
        moves[number] = HumanMove(**numbers, speed=speed)
    if not moves:
        raise InputError(f"{path}: no sub-task is in it")
    return Human(moves, about)


def known_human(task: str) -> Human | None:
    """The human's figures that come with the package for a task, if there are any."""
    path = DATA / f"human_{task}.csv"
    return load_human(path) if path.exists() else None

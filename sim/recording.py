"""Recordings: what happened in one simulation, as named arrays with units.

While a simulation runs, its recorder appends to `recording.npz.part`, a plain sequence of
NumPy arrays; when it ends, that becomes `recording.npz`. A run that is killed leaves the
part, and `Recording.load` reads what is in it.
"""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO
from zipfile import BadZipFile

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body
from sim.errors import RecordingError
from sim.state import State

FloatArray = NDArray[np.float64]

UNITS = {
    "time": "s",
    "qpos": "m, rad",
    "qvel": "m/s, rad/s",
    "torque": "N m",
    "contribution": "N m",
    "objects": "m",
}
ARRAYS = 7  # of a chunk: those above, and which primitive each contribution is of
ROWS = 250  # of a chunk: what a killed run may lose


@dataclass(frozen=True)
class Span:
    """What became of one sub-task; times are NaN if it did not come to it."""

    name: str
    start: float  # [s] of its last round, if it is repeated
    end: float  # [s] when it was over; its goal may have been held long after
    outcome: str  # pending, running, done, timed out, ended, skipped
    began: float = np.nan  # [s] its first round; NaN if it has only one

    @property
    def first(self) -> float:
        """When it first began [s]."""
        return self.began if np.isfinite(self.began) else self.start


SPAN = tuple(part.name for part in fields(Span))


@dataclass(frozen=True)
class Recording:
    """One simulation: row k is the state at time[k] and the torque that was then applied."""

    time: FloatArray  # (T,) [s]
    qpos: FloatArray  # (T, nq)
    qvel: FloatArray  # (T, nv)
    torque: FloatArray  # (T, nv) applied by the motors [N m]
    contribution: NDArray[np.float32]  # (T, primitives, nv) what each primitive asked for [N m]
    names: tuple[str, ...]  # of the primitives
    spans: tuple[Span, ...]  # of the sub-tasks
    model_xml: str  # the model that was run
    about: Mapping[str, Any] = field(default_factory=dict)  # task, body map, versions, seed …
    rounds: tuple[Span, ...] = ()  # of sub-tasks that were done over, before the last of each
    later_models: tuple[tuple[float, str], ...] = ()  # that the body became, and from when [s]
    complete: bool = True  # False when it was read from the part that a killed run left
    # (T, objects, 3) where objects of the scene were [m]; see `Body.objects`
    objects: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 3)))

    @cached_property
    def model(self) -> mujoco.MjModel:
        """The model that was run, compiled anew; of several the first."""
        return mujoco.MjModel.from_xml_string(self.model_xml)

    @cached_property
    def models(self) -> tuple[tuple[int, str], ...]:
        """The models that were run, each with its first row."""
        rows = np.searchsorted(self.time, [time - 1e-9 for time, _ in self.later_models])
        later = ((int(row), xml) for row, (_, xml) in zip(rows, self.later_models, strict=True))
        return ((0, self.model_xml), *later)

    @property
    def timestep(self) -> float:
        """Seconds between rows."""
        return float(self.time[1] - self.time[0]) if len(self.time) > 1 else 0.0

    def until(self, time: float) -> "Recording":
        """The rows up to a time [s]."""
        rows = slice(self.row(time) + 1)
        return replace(self, **{name: getattr(self, name)[rows] for name in UNITS})

    def row(self, time: float) -> int:
        """The last row that is not after `time` [s]."""
        index = int(np.searchsorted(self.time, time + 1e-9, side="right")) - 1
        return min(max(index, 0), len(self.time) - 1)

    def save(self, path: str | Path) -> None:
        """Write the recording as one `.npz` file, whole or not at all.

        Raises:
            RecordingError: it cannot be written there.
        """
        path = Path(path)
        arrays = {key: getattr(self, key) for key in UNITS}
        arrays["names"] = np.array(self.names)
        for what, spans in (("span", self.spans), ("round", self.rounds)):
            for part in SPAN:
                kind = str if part in {"name", "outcome"} else float
                arrays[f"{what}_{part}"] = np.array([getattr(s, part) for s in spans], dtype=kind)
        arrays["model_xml"] = np.array(self.model_xml)
        arrays["later_time"] = np.array([time for time, _ in self.later_models], dtype=float)
        arrays["later_xml"] = np.array([xml for _, xml in self.later_models], dtype=str)
        about = {**self.about, "units": UNITS, "complete": self.complete}
        arrays["about"] = np.array(json.dumps(about, sort_keys=True))
        draft = path.with_name(path.name + ".tmp")
        try:
            with draft.open("wb") as file:
                np.savez_compressed(file, **arrays)
            os.replace(draft, path)
        except OSError as problem:
            draft.unlink(missing_ok=True)
            raise RecordingError(f"cannot write {path}: {problem.strerror}") from None

    @classmethod
    def load(cls, path: str | Path) -> "Recording":
        """Read a recording, or what a killed run left of one.

        Args:
            path: `recording.npz`, its `.part`, or the folder they are in.

        Raises:
            RecordingError: there is none, or it cannot be read.
        """
        path = Path(path)
        if path.is_dir():
            path /= "recording.npz"
        part = path if path.suffix == ".part" else path.with_name(path.name + ".part")
        try:
            if path.exists() and path != part:
                return cls._from_npz(path)
            if part.exists():
                return cls._from_part(part)
        except (OSError, ValueError, KeyError, EOFError, BadZipFile) as problem:
            raise RecordingError(f"cannot read {path}: {problem}") from None
        raise RecordingError(f"there is no recording at {path}")

    @classmethod
    def _from_npz(cls, path: Path) -> "Recording":
        with path.open("rb") as file, np.load(file, allow_pickle=False) as f:
            spans, rounds = (
                tuple(
                    Span(str(n), float(a), float(b), str(o), float(c))
                    for n, a, b, o, c in zip(*(f[f"{what}_{part}"] for part in SPAN), strict=True)
                )
                for what in ("span", "round")
            )
            about = json.loads(str(f["about"]))
            return cls(
                **{key: f[key] for key in UNITS if key in f},  # once there were no objects
                names=tuple(str(n) for n in f["names"]),
                spans=spans,
                rounds=rounds,
                model_xml=str(f["model_xml"]),
                later_models=tuple(
                    (float(time), str(xml))
                    for time, xml in zip(f["later_time"], f["later_xml"], strict=True)
                ),
                about=about,
                complete=bool(about.get("complete", True)),
            )

    @classmethod
    def _from_part(cls, part: Path) -> "Recording":
        with part.open("rb") as file:
            header = json.loads(str(np.load(file)))
            chunks = list(_chunks(file))
        if not chunks:
            raise ValueError("it ended before its first row")
        names = tuple(header["names"])
        rows = [np.concatenate(arrays) for arrays in zip(*chunks, strict=True)]
        found = _recording(rows, 0, names, (), header["model_xml"], header["about"], False)
        later = tuple((float(time), str(xml)) for time, xml in header["later_models"])
        return replace(found, later_models=later)


class Recorder:
    """Takes down the simulations of a world, row by row.

    Args:
        body: what is simulated.
        n: number of simulations.
        names: of all primitives; empty if contributions are not to be kept.
        channels: how many primitives can be on at once.
        about: task, body map, versions, seed.
        part: file to append to meanwhile; None keeps the recording in memory only.
        later_models: models that the body becomes, and from when [s].

    Raises:
        RecordingError: the part cannot be written.
    """

    def __init__(
        self,
        body: Body,
        n: int,
        *,
        names: tuple[str, ...] = (),
        channels: int = 0,
        about: Mapping[str, Any] | None = None,
        part: Path | None = None,
        later_models: tuple[tuple[float, str], ...] = (),
    ) -> None:
        nq, nv = body.model.nq, body.nv
        channels = channels if names else 0
        self._chunk: tuple[NDArray[Any], ...] = (
            np.zeros((ROWS, n)),
            np.zeros((ROWS, n, nq)),
            np.zeros((ROWS, n, nv)),
            np.zeros((ROWS, n, nv)),
            np.zeros((ROWS, n, channels, nv), dtype=np.float32),
            np.full((ROWS, n, channels), -1, dtype=np.int32),
            np.zeros((ROWS, n, len(body.objects), 3)),
        )
        self._objects = body.objects
        self._full: list[tuple[NDArray[Any], ...]] = []
        self._row = 0
        self._names, self._model_xml, self._about = names, body.xml, dict(about or {})
        self._part, self._later = part, later_models
        self._file: BinaryIO | None = None
        if part is not None:
            try:
                self._file = part.open("wb")
                header = {
                    "names": names,
                    "model_xml": body.xml,
                    "later_models": later_models,
                    "about": self._about,
                }
                np.save(self._file, np.array(json.dumps(header)))
                self._file.flush()
            except OSError as problem:
                raise RecordingError(f"cannot write {part}: {problem.strerror}") from None

    def take(
        self, state: State, contribution: FloatArray | None, channels: NDArray[np.int32]
    ) -> None:
        """Begin a row: the state, and which primitive asks for what.

        Args:
            state: of n simulations.
            contribution: (n, channels, nv) [N m]; None if they are not kept
            channels: (n, channels) which of `names` each is, -1 for nobody.
        """
        time, qpos, qvel, _, asked, who, objects = self._chunk
        k = self._row
        time[k], qpos[k], qvel[k] = state.time, state.qpos, state.qvel
        if len(self._objects):
            objects[k] = state.xpos[:, self._objects]
        if self._names:
            asked[k], who[k] = contribution, channels

    def applied(self, torque: FloatArray) -> None:
        """Complete the row with the torques (n, nv) [N m] that the motors applied to it."""
        self._chunk[3][self._row] = torque
        self._row += 1
        if self._row == ROWS:
            self._flush()

    def finish(
        self,
        spans: Sequence[tuple[Span, ...]],
        rounds: Sequence[tuple[Span, ...]] = (),
        *,
        complete: bool = True,
    ) -> tuple[Recording, ...]:
        """A recording of each simulation; the part is kept until `discard_part`."""
        self._flush()
        if self._file is not None:
            self._file.close()
        rows = [np.concatenate(arrays) for arrays in zip(*self._full, strict=True)]
        return tuple(
            replace(
                _recording(rows, i, self._names, spans[i], self._model_xml, self._about, complete),
                rounds=rounds[i] if rounds else (),
                later_models=self._later,
            )
            for i in range(rows[0].shape[1])
        )

    def discard_part(self) -> None:
        """Remove the part, once the recording has been saved."""
        if self._part is not None:
            self._part.unlink(missing_ok=True)

    def _flush(self) -> None:
        """Put the rows of the chunk away, and on disk if there is a part."""
        rows = tuple(array[: self._row].copy() for array in self._chunk)
        self._full.append(rows)
        self._row = 0
        if self._file is not None:
            for array in rows:
                np.save(self._file, array)
            self._file.flush()


def _recording(
    rows: Sequence[NDArray[Any]],
    simulation: int,
    names: tuple[str, ...],
    spans: tuple[Span, ...],
    model_xml: str,
    about: Mapping[str, Any],
    complete: bool,
) -> Recording:
    time, qpos, qvel, torque, asked, who, objects = (row[:, simulation].copy() for row in rows)
    return Recording(
        time=time,
        qpos=qpos,
        qvel=qvel,
        torque=torque,
        contribution=_spread(asked, who, len(names)),
        names=names,
        spans=spans,
        model_xml=model_xml,
        about=about,
        complete=complete,
        objects=objects,
    )


def _chunks(file: BinaryIO) -> Any:
    """The whole chunks of a part; the last may have been cut off."""
    while True:
        chunk = []
        for _ in range(ARRAYS):
            try:
                chunk.append(np.load(file))
            except (EOFError, ValueError, OSError):
                return
        yield chunk


def _spread(
    values: NDArray[np.float32], channels: NDArray[np.int32], count: int
) -> NDArray[np.float32]:
    """(T, channels, nv) with a number for each channel, as (T, count, nv)."""
    dense = np.zeros((values.shape[0], count, values.shape[2]), dtype=np.float32)
    rows, slots = np.nonzero(channels >= 0)
    dense[rows, channels[rows, slots]] = values[rows, slots]
    return dense

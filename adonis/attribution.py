"""Attribution: which primitive made which torque, and which two cancel each other's.

Everything is computed from the recording's `contribution` and model, nothing from the controllers.

* The **share** of a primitive on a joint is |c_i| / sum_k |c_k|, of what the primitives ask for.
* The **conflict** of two is the torque they cancel over the torque they produce,
  (|a| + |b| - |a + b|) / (|a| + |b|): 0 where they agree, 1 where they cancel entirely. Over
  joints and time both integrals are taken before the division, where both are on.
* **Weight.** What exactly carries the body's weight is set against the weight, not against the
  spring that lowers the arm: see `pulls`. It counts in the shares and not in conflicts.
* **Saturation.** Contributions are what was asked for, before the motors' limits. A motor that
  gives only part of their sum is taken to give that part of each; that changes no share and no
  conflict, but work is reckoned from it. `lost` says how much was asked for in vain. Where there
  is no motor nothing counts.

Any two cancel some torque during a hand-over, when both are on for a tenth of a second; only what
lasts is a fight.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adonis.measures import mechanical_work
from sim import Recording, Replay

FloatArray = NDArray[np.floating[Any]]  # contributions are in single precision
BoolArray = NDArray[np.bool_]

FIGHT = 0.5  # conflict on one joint from which two fight: the weaker has a third of the stronger
STRENGTH = 0.05  # and both pull with more than this share of the joint's limit
LASTING = 0.5  # a fight that is longer is worth a warning [s]
BREATH = 0.02  # a fight that pauses for no longer goes on [s]
VARIED = 0.1  # deviation of the weight, of its RMS, from which a multiple of it is no accident
CARRIES = 0.01  # residual up to which torques are a multiple of those that carry the weight


@dataclass(frozen=True)
class Fight:
    """Two primitives against each other on one joint."""

    joint: str
    start: float  # [s]
    end: float  # [s]
    conflict: float  # while it lasted

    @property
    def seconds(self) -> float:
        """How long it lasted [s]."""
        return self.end - self.start

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "joint": self.joint,
            "start": self.start,
            "end": self.end,
            "seconds": self.seconds,
            "conflict": self.conflict,
        }


@dataclass(frozen=True)
class Pull:
    """What one primitive did in a run."""

    name: str
    share: float  # of all torque that was asked for, joints and time together
    work: float  # [J] on the body: positive drives, negative brakes
    absolute_work: float  # [J] braking costs what driving costs
    peak: float  # largest torque asked for, as a share of the joint's limit
    peak_joint: str
    peak_time: float  # [s]
    carries_weight: bool  # its torque is that which holds the body up, or a part of it

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return dict(vars(self))


@dataclass(frozen=True)
class Pair:
    """What two primitives did to each other."""

    between: tuple[str, str]
    conflict: float  # 0 they agree … 1 they cancel entirely
    together: float  # time in which both are on, on the same joint [s]
    cancelled: float  # [N m s]
    longest_fight: Fight | None

    @property
    def warning(self) -> str | None:
        """What to tell the user, if they fight for long."""
        fight = self.longest_fight
        if fight is None or fight.seconds <= LASTING + 1e-9:
            return None
        one, other = self.between
        return (
            f"{one} and {other} fight over {fight.joint} from {fight.start:.2f} to"
            f" {fight.end:.2f} s: {100 * fight.conflict:.0f} % of their torque cancels"
        )

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        fight = self.longest_fight
        return {
            "between": list(self.between),
            "conflict": self.conflict,
            "together": self.together,
            "cancelled": self.cancelled,
            "longest_fight": fight.as_dict() if fight else None,
        }


@dataclass(frozen=True)
class Attribution:
    """Who pulled in a run, and who against whom; the pairs that cancel most come first."""

    primitives: tuple[Pull, ...]
    pairs: tuple[Pair, ...]
    lost: float  # share of the torque asked for that the motors could not give

    @property
    def warnings(self) -> tuple[str, ...]:
        """One for each two primitives that fight for long."""
        return tuple(said for pair in self.pairs if (said := pair.warning) is not None)

    def as_dict(self) -> dict[str, Any]:
        """For JSON, with the thresholds behind it."""
        return {
            "primitives": [p.as_dict() for p in self.primitives],
            "pairs": [p.as_dict() for p in self.pairs],
            "lost": self.lost,
            "a_fight_is": {"conflict": FIGHT, "share_of_limit": STRENGTH, "warned_after": LASTING},
        }


def attribute(recording: Recording, replay: Replay) -> Attribution:
    """Say of a recording which primitive made which torque, and which two fought."""
    limits = replay.torque_limits()
    asked = asked_torques(recording, limits)
    weight = replay.weight()
    pulled, carrying = pulls(asked, weight)
    given = given_shares(asked.sum(axis=1, dtype=float), recording.torque)
    total = float(np.abs(asked).sum(dtype=float))
    primitives = []
    for p, name in enumerate(recording.names):
        own = asked[:, p].astype(float)
        strength = np.nan_to_num(np.abs(own) / limits)
        row, dof = np.unravel_index(np.argmax(strength), strength.shape)
        power = own * given * recording.qvel
        primitives.append(
            Pull(
                name=name,
                share=float(np.abs(own).sum()) / total if total else 0.0,
                work=float(np.trapezoid(power.sum(axis=1), dx=recording.timestep)),
                absolute_work=mechanical_work(own * given, recording.qvel, recording.timestep),
                peak=float(strength[row, dof]),
                peak_joint=replay.joint_of_dof(int(dof)),
                peak_time=float(recording.time[row]),
                carries_weight=bool(carrying[p]),
            )
        )
    sums = np.abs(asked.sum(axis=1, dtype=float))
    lost = float((sums * (1.0 - given)).sum() / sums.sum()) if total and sums.any() else 0.0
    pairs = sorted(_pairs(recording, replay, pulled, limits), key=lambda p: -p.cancelled)
    return Attribution(tuple(primitives), tuple(pairs), lost)


# --- torques ---------------------------------------------------------------------------------


def asked_torques(recording: Recording, limits: FloatArray) -> FloatArray:
    """What each primitive asked of the motors (T, primitives, nv) [N m].

    Args:
        recording: what happened.
        limits: of the motors (nv,) [N m]; NaN where there is none, and nothing counts.
    """
    asked = np.nan_to_num(recording.contribution, nan=0.0, posinf=0.0, neginf=0.0)
    asked[:, :, np.isnan(limits)] = 0.0
    return asked


def shares(asked: FloatArray) -> FloatArray:
    """Each primitive's share of the absolute torque, |c_i| / sum_k |c_k|.

    Args:
        asked: (T, primitives, nv) [N m]

    Returns:
        The same shape; on a joint they sum to 1, or to 0 where nobody pulls.
    """
    size = np.abs(asked)
    return _ratio(size, size.sum(axis=1, keepdims=True))


def given_shares(asked: FloatArray, applied: FloatArray) -> FloatArray:
    """Share of the torque asked for that a motor gave: 1 unless it is at its limit.

    Args:
        asked: (T, nv) sum over the primitives [N m], in single precision.
        applied: (T, nv) [N m]
    """
    part = np.divide(applied, asked, out=np.ones_like(applied), where=asked != 0.0)
    rounding = np.abs(applied - asked) <= 1e-5 * np.maximum(np.abs(asked), 1.0)
    given: FloatArray = np.where(rounding, 1.0, np.clip(part, 0.0, 1.0))
    return given


def pulls(asked: FloatArray, weight: FloatArray) -> tuple[FloatArray, BoolArray]:
    """What is left to fight with, once the weight is carried.

    A primitive carries weight if over the whole run its torques are, within 1 %, one and the
    same positive multiple k of those that hold the body up, on the joints where it is on:
    compensate-gravity does, and so does whatever else feeds the weight forward. Where the weight
    is the same all the time, as on one joint at rest, a constant torque proves nothing and pulls.
    Such a torque answers the weight and no other primitive. If the carriers of a joint carry
    K > 1 times the weight between them, the part 1 - 1/K of each is one too many, and pulls.

    Args:
        asked: (T, primitives, nv) [N m]
        weight: (T, nv) torques that hold the body up at rest [N m]

    Returns:
        Torques (T, primitives, nv) that count in conflicts [N m]; and who carries weight
        (primitives,).
    """
    count = asked.shape[1]
    multiple = np.zeros(count)
    for p in range(count):
        own = asked[:, p].astype(float)
        own, there = own[own != 0.0], weight[own != 0.0]
        energy = float(there @ there)
        if energy == 0.0 or np.var(there) * len(there) <= VARIED**2 * energy:
            continue
        k = float(own @ there) / energy
        if k > 0.0 and np.linalg.norm(own - k * there) <= CARRIES * np.linalg.norm(own):
            multiple[p] = k
    carried = np.einsum("p,tpj->tj", multiple, asked != 0.0)
    excess = np.where(carried > 1.0 + CARRIES, 1.0 - 1.0 / np.maximum(carried, 1.0), 0.0)
    pulled = asked.copy()
    pulled[:, multiple > 0.0] *= excess[:, None]
    return pulled, multiple > 0.0


# --- two against each other ------------------------------------------------------------------


def cancelled(one: FloatArray, other: FloatArray) -> FloatArray:
    """Torque that two cancel, |a| + |b| - |a + b| [N m], of arrays of one shape."""
    gone: FloatArray = np.abs(one) + np.abs(other) - np.abs(one + other)
    return gone


def conflict(one: FloatArray, other: FloatArray) -> float:
    """Torque cancelled over torque produced by two primitives, where and while both are on.

    Args:
        one: (T, nv) [N m]
        other: (T, nv) [N m]

    Returns:
        0 … 1; 0 if they are never on together.
    """
    both = (one != 0.0) & (other != 0.0)
    produced = float((np.abs(one) + np.abs(other))[both].sum())
    return float(cancelled(one, other)[both].sum()) / produced if produced else 0.0


def fighting(one: FloatArray, other: FloatArray, limits: FloatArray) -> BoolArray:
    """Where and when two fight: conflict above `FIGHT`, both above `STRENGTH` of the limit.

    Args:
        one: (T, nv) [N m]
        other: (T, nv) [N m]
        limits: (nv,) [N m]; NaN where there is no motor.
    """
    weaker = np.minimum(np.abs(one), np.abs(other))
    fierce = cancelled(one, other) > FIGHT * (np.abs(one) + np.abs(other))
    both: BoolArray = np.logical_and(fierce, weaker > STRENGTH * limits)
    return both


def bouts(on: BoolArray, pause: int) -> list[tuple[int, int]]:
    """First row, and the row after the last, of each time in which `on` (T,) holds.

    Args:
        on: row by row.
        pause: so many rows of something else do not end it.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], on, [False]]).astype(np.int8)))
    merged: list[tuple[int, int]] = []
    for first, end in edges.reshape(-1, 2):
        if merged and first - merged[-1][1] <= pause:
            merged[-1] = merged[-1][0], int(end)
        else:
            merged.append((int(first), int(end)))
    return merged


def _pairs(
    recording: Recording, replay: Replay, pulled: FloatArray, limits: FloatArray
) -> Iterator[Pair]:
    """Every two primitives that are ever on together on a joint."""
    alive: BoolArray = np.any(pulled != 0.0, axis=2)
    meetings = alive.T.astype(np.float32) @ alive.astype(np.float32)
    for p, q in np.argwhere(np.triu(meetings, k=1) > 0.0):
        rows = np.flatnonzero(alive[:, p] & alive[:, q])
        span = slice(int(rows[0]), int(rows[-1]) + 1)
        one, other = pulled[span, p].astype(float), pulled[span, q].astype(float)
        both = (one != 0.0) & (other != 0.0)
        if both.any():
            yield Pair(
                between=(recording.names[p], recording.names[q]),
                conflict=conflict(one, other),
                together=float(both.any(axis=1).sum()) * recording.timestep,
                cancelled=float(cancelled(one, other)[both].sum()) * recording.timestep,
                longest_fight=_longest(recording, replay, one, other, limits, span.start),
            )


def _longest(
    recording: Recording,
    replay: Replay,
    one: FloatArray,
    other: FloatArray,
    limits: FloatArray,
    first: int,
) -> Fight | None:
    """The longest fight of two; row 0 of theirs is row `first` of the recording."""
    step = recording.timestep
    fights = fighting(one, other, limits)
    found = [
        (end - start, start, end, dof)
        for dof in np.flatnonzero(fights.any(axis=0))
        for start, end in bouts(fights[:, dof], round(BREATH / step))
    ]
    if not found:
        return None
    _, start, end, dof = max(found, key=lambda bout: bout[0])
    return Fight(
        joint=replay.joint_of_dof(int(dof)),
        start=float(recording.time[first + start]),
        end=float(recording.time[first + start]) + (end - start) * step,
        conflict=conflict(one[start:end, [dof]], other[start:end, [dof]]),
    )


def _ratio(part: FloatArray, whole: FloatArray) -> FloatArray:
    """Part over whole, 0 where there is nothing."""
    ratio: FloatArray = np.divide(part, whole, out=np.zeros_like(part), where=whole != 0.0)
    return ratio

"""The hand-over contract: at every switch a bounded torque step, and so a bounded jerk.

A torque may change by no more than `HAND_OVER_STEP` of its motor's limit in 2 ms; the judge holds
a run to that. Motors that keep it give the joints a jerk of at most

    |M(q)^-1| · HAND_OVER_STEP · limit / 2 ms    [rad/s^3], with the inertia at the switch.

The jerk that is reported is that of the recorded movement, whatever made it. Where it exceeds
what the motors can make, something was touched or let go. From the recording and the task alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adonis.judging import HAND_OVER_STEP, hand_over_rows, torque_steps
from adonis.verdicts import claimed
from sim import Recording, Replay, Span
from specs import TaskSpec, build_graph

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.intp]

CALM = 0.1  # torques are calm while they change by no more than this share of the bound
QUIET = 0.05  # and have settled when they stay calm for so long [s]


@dataclass(frozen=True)
class Transition:
    """One hand-over: who gave joints to whom, and how smoothly."""

    time: float  # [s]
    giving: tuple[str, ...]  # who pulled on the joints and no longer does; empty if nobody did
    taking: str
    joints: tuple[str, ...]
    torque_step: float  # largest in 2 ms, of the limit
    torque_step_joint: str
    jerk: float  # largest, as recorded [rad/s^3]
    jerk_joint: str
    jerk_bound: float  # of that joint, from motors that keep the bound on the step [rad/s^3]
    jerk_share: float  # largest jerk of any of the joints, of its own bound
    settling: float  # from the switch until the torques stay calm [s]; infinity if they never do

    @property
    def within(self) -> bool:
        """Whether the torque step keeps its bound."""
        return self.torque_step <= HAND_OVER_STEP

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "time": self.time,
            "from": list(self.giving),
            "to": self.taking,
            "joints": list(self.joints),
            "torque_step": self.torque_step,
            "torque_step_joint": self.torque_step_joint,
            "torque_step_bound": HAND_OVER_STEP,
            "within_bound": self.within,
            "jerk": self.jerk,
            "jerk_joint": self.jerk_joint,
            "jerk_bound": self.jerk_bound,
            "jerk_share": self.jerk_share,
            "settling": self.settling if np.isfinite(self.settling) else None,
        }


def transitions(recording: Recording, spec: TaskSpec, replay: Replay) -> tuple[Transition, ...]:
    """Every hand-over of a recording, in the order in which they began.

    Those at which the recording ends before the first torque step are left out, and so are all of
    a recording without contributions.
    """
    limits = replay.torque_limits()
    steps = torque_steps(recording, limits)
    jerk = np.abs(np.diff(recording.qvel, n=2, axis=0)) / recording.timestep**2
    giving = [b.name for b in spec.background if claimed(b)]  # what only adds gives nothing away
    giving += [s.name for s in spec.subtasks]
    graph = build_graph(spec)
    found = []
    for span in sorted(recording.spans, key=lambda s: s.start):
        if not np.isfinite(span.start) or span.name not in recording.names:
            continue
        rows = hand_over_rows(recording, span, graph.fade(span.name))
        own = recording.contribution[rows, recording.names.index(span.name)]
        dofs = np.flatnonzero(own.any(axis=0) & ~np.isnan(limits))
        window, jolts = steps[rows][:, dofs], jerk[rows][:, dofs]
        if not window.size or not jolts.size:
            continue
        largest, hardest = window.max(axis=0).argmax(), jolts.max(axis=0).argmax()
        mobility = np.abs(replay.mobility(recording.row(span.start)))
        bound = (mobility @ np.nan_to_num(HAND_OVER_STEP / 0.002 * limits))[dofs]
        found.append(
            Transition(
                time=span.start,
                giving=givers(recording, span.name, rows, dofs, giving),
                taking=span.name,
                joints=tuple(replay.joint_of_dof(int(dof)) for dof in dofs),
                torque_step=float(window[:, largest].max()),
                torque_step_joint=replay.joint_of_dof(int(dofs[largest])),
                jerk=float(jolts[:, hardest].max()),
                jerk_joint=replay.joint_of_dof(int(dofs[hardest])),
                jerk_bound=float(bound[hardest]),
                jerk_share=float((jolts / bound).max()),
                settling=_settling(steps[rows.start : _end(recording, span), dofs], recording),
            )
        )
    return tuple(found)


def givers(
    recording: Recording, taking: str, rows: slice, dofs: IntArray, candidates: Sequence[str]
) -> tuple[str, ...]:
    """Who pulled on the joints during the hand-over, and on none of them once it was over."""
    after = min(rows.stop, len(recording.time) - 1)
    found = []
    for name in candidates:
        if name != taking and name in recording.names:
            own = recording.contribution[:, recording.names.index(name)][:, dofs]
            if own[rows].any() and not own[after].any():
                found.append(name)
    return tuple(found)


def _end(recording: Recording, span: Span) -> int:
    """The row in which a sub-task was over, or the last."""
    return recording.row(span.end if np.isfinite(span.end) else float(recording.time[-1]))


def _settling(steps: FloatArray, recording: Recording) -> float:
    """From the switch until torques have begun to be calm for long enough [s].

    Args:
        steps: (k, joints) from the switch to the end of the sub-task.
        recording: of which they are.
    """
    calm = steps.max(axis=1) <= CALM * HAND_OVER_STEP
    long = max(round(QUIET / recording.timestep), 1)
    if len(calm) < long:
        return float("inf")
    quiet = np.flatnonzero(np.convolve(calm, np.ones(long), mode="valid") >= long - 0.5)
    return float(quiet[0]) * recording.timestep if len(quiet) else float("inf")

"""The judge: did the recorded movement do what the task says?

It sees the recording, the model and the words of the task, and measures with MuJoCo's own
kinematics (`sim.Replay`). It uses nothing of the controllers, so that it cannot share their
mistakes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from primitives import GetPosture, GoToPoint, Place
from sim import DIRECTIONS, BodyMap, Limb, Recording, Replay, Span
from specs import SubTask, TaskSpec, task_from_text

FloatArray = NDArray[np.float64]

TOUCH_AT_END = 0.03  # palm to landmark when the move's time is over [m]
TOUCH_BEFORE_NEXT = 0.015  # and just before the arm moves on [m]
ANGLE = 10.0  # arm, elbow and other joints of a posture [deg]
PALM_ANGLE = 15.0  # palm of a posture [deg]
PENETRATION = 0.005  # of any two geoms, at any step [m]
HAND_OVER_STEP = 0.10  # change of a joint's torque in 2 ms, as a share of its limit
UPRIGHT = 5.0  # joints that no sub-task moves [deg]


@dataclass(frozen=True)
class Measure:
    """One thing that was measured, against what is allowed."""

    what: str
    value: float
    limit: float
    unit: str
    where: str = ""

    @property
    def success(self) -> bool:
        """Whether the value is within its limit."""
        return bool(self.value <= self.limit)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "what": self.what,
            "value": _finite(self.value),
            "limit": self.limit,
            "unit": self.unit,
            "where": self.where,
            "success": self.success,
        }


@dataclass(frozen=True)
class Verdict:
    """What became of one sub-task."""

    subtask: SubTask
    span: Span
    measures: tuple[Measure, ...]

    @property
    def success(self) -> bool:
        """It ended as the task foresees, and everything measured is within its limit.

        A task may leave sub-tasks out, end them, and say what is to happen after a time-out.
        """
        gave_up = self.span.outcome == "timed out" and self.subtask.otherwise is not None
        foreseen = gave_up or self.span.outcome in ("done", "ended", "skipped")
        return foreseen and all(m.success for m in self.measures)

    @property
    def worst(self) -> Measure | None:
        """The measure that is nearest to its limit, or furthest beyond."""
        return max(self.measures, key=_ratio, default=None)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        does, worst = self.subtask.does, self.worst
        limb = ", ".join(_claimed(self.subtask))
        return {
            "name": self.subtask.name,
            "words": self.subtask.words,
            "primitive": does.kind,
            "controller": getattr(does, "controller", None),
            "limb": limb or None,
            "start": _finite(self.span.start),
            "end": _finite(self.span.end),
            "outcome": self.span.outcome,
            "error": _finite(worst.value) if worst else None,
            "tolerance": worst.limit if worst else None,
            "unit": worst.unit if worst else None,
            "success": self.success,
            "measures": [m.as_dict() for m in self.measures],
        }


@dataclass(frozen=True)
class Judgement:
    """A whole run: its sub-tasks, and what must hold all the time."""

    verdicts: tuple[Verdict, ...]
    checks: tuple[Measure, ...]
    complete: bool

    @property
    def success(self) -> bool:
        """Every sub-task succeeded, every check holds, and the run came to its end."""
        return (
            self.complete
            and all(v.success for v in self.verdicts)
            and all(c.success for c in self.checks)
        )

    @property
    def passed(self) -> int:
        """How many sub-tasks succeeded."""
        return sum(v.success for v in self.verdicts)


def judge(recording: Recording, spec: TaskSpec | None = None) -> Judgement:
    """Measure a recording against a task.

    Args:
        recording: what happened.
        spec: the task; default: the one that the recording says it is of, which may then use
            only primitives that are installed.
    """
    task = task_from_text(str(recording.about["task"]))[0] if spec is None else spec
    names = BodyMap.model_validate(recording.about["body_map"])
    measuring = _Measuring(recording, names)
    spans = {s.name: s for s in recording.spans}
    verdicts = []
    for subtask in task.subtasks:
        span = spans.get(subtask.name, Span(subtask.name, np.nan, np.nan, "pending"))
        measures: tuple[Measure, ...] = ()
        if _had_a_goal(subtask, span):
            measures = tuple(measuring.subtask(subtask, span, task, spans))
        verdicts.append(Verdict(subtask, span, measures))
    return Judgement(tuple(verdicts), tuple(measuring.checks(task, spans)), recording.complete)


class _Measuring:
    """Measures one recording."""

    def __init__(self, recording: Recording, names: BodyMap) -> None:
        self.recording, self.names = recording, names
        self.replay = Replay(recording)

    # --- sub-tasks -------------------------------------------------------------------------

    def subtask(
        self, subtask: SubTask, span: Span, task: TaskSpec, spans: dict[str, Span]
    ) -> list[Measure]:
        end = self.recording.row(span.end)
        held = max(self.recording.row(self._claimed_again(subtask, task, spans)), end)
        does = subtask.does
        if isinstance(does, GoToPoint):
            return self._reach(does, end, held)
        if isinstance(does, GetPosture):
            return self._posture(does, end, held)
        return []

    def _reach(self, does: GoToPoint, end: int, held: int) -> list[Measure]:
        palm = self.replay.site(self.names.limbs[does.limb].palm).position
        goal = self._goal(does)
        return [
            Measure(f"palm to goal {when}", float(np.linalg.norm(palm[k] - goal[k])), limit, "m")
            for when, k, limit in (
                ("at the end", end, TOUCH_AT_END),
                ("before the arm moves on", held, TOUCH_BEFORE_NEXT),
            )
        ]

    def _goal(self, does: GoToPoint) -> FloatArray:
        """Where the palm was to be, row by row (T, 3)."""
        if isinstance(does.to, str):
            return self.replay.site(does.to).position
        return self._place(does.to, self.names.limbs[does.limb])

    def _place(self, place: Place, limb: Limb) -> FloatArray:
        """A place that is not a landmark, seen from the link that carries it."""
        if place.near is not None:
            mark = self.replay.site(place.near)
            carrier = self.replay.link(self.replay.link_of_site(place.near))
            point = mark.position + place.away * mark.axes[:, :, 0]
        else:
            carrier = self.replay.link(self.replay.parent(limb.upper_arm))
            point = carrier.position + carrier.axes @ np.array(place.point)
        shifted: FloatArray = point + carrier.axes @ np.array(place.offset)
        return shifted

    def _posture(self, does: GetPosture, end: int, held: int) -> list[Measure]:
        window = slice(end, held + 1)
        if isinstance(does.posture, str):
            own = self._joints(does.limb or does.joints or ())
            asked = {j: a for j, a in self.names.postures[does.posture].items() if j in own}
            return [self._angles(asked, window)]
        said = dict(does.posture)
        measures: list[Measure] = []
        if does.limb is not None:
            limb = self.names.limbs[does.limb]
            readings: dict[str, tuple[Callable[[Limb], FloatArray], float]] = {
                "arm": (self._arm_direction, ANGLE),
                "palm": (self._palm_direction, PALM_ANGLE),
            }
            for part, (reading, limit) in readings.items():
                if part in said:
                    wanted = _direction(said.pop(part))
                    off = _angle_between(self._from_carrier(limb, reading(limb))[window], wanted)
                    measures.append(Measure(f"{part} direction", float(off.max()), limit, "deg"))
            if "elbow" in said:
                value = said.pop("elbow")
                said[limb.elbow] = 0.0 if value == "straight" else value
            said = {_own(limb, joint): value for joint, value in said.items()}
        asked = {
            joint: float(angle)
            for name, angle in said.items()
            if isinstance(angle, float | int)
            for joint in self._joints(name)
        }
        if asked:
            measures.append(self._angles(asked, window))
        return measures

    def _angles(self, asked: dict[str, float], window: slice) -> Measure:
        off = {
            joint: float(np.abs(np.rad2deg(self.replay.angle(joint)[window]) - angle).max())
            for joint, angle in asked.items()
        }
        worst = max(off, key=off.__getitem__)
        return Measure("joint angles", off[worst], ANGLE, "deg", worst)

    def _from_carrier(self, limb: Limb, directions: FloatArray) -> FloatArray:
        """Directions (T, 3) of the world, seen from the link that carries the limb."""
        carrier = self.replay.link(self.replay.parent(limb.upper_arm))
        seen: FloatArray = np.einsum("tij,ti->tj", carrier.axes, directions)
        return seen

    def _arm_direction(self, limb: Limb) -> FloatArray:
        along = self.replay.link(limb.hand).position - self.replay.link(limb.upper_arm).position
        unit: FloatArray = along / np.linalg.norm(along, axis=1, keepdims=True)
        return unit

    def _palm_direction(self, limb: Limb) -> FloatArray:
        return self.replay.site(limb.palm).axes[:, :, 0]

    # --- all the time ----------------------------------------------------------------------

    def checks(self, task: TaskSpec, spans: dict[str, Span]) -> list[Measure]:
        recording = self.recording
        deepest = self.replay.penetration
        limits = self.replay.torque_limits()
        share = np.abs(recording.torque) / limits
        row, dof = np.unravel_index(np.nanargmax(share), share.shape)
        checks = [
            Measure(
                "worst penetration",
                abs(deepest.distance),
                PENETRATION,
                "m",
                f"{deepest.geoms[0]} and {deepest.geoms[1]} at {deepest.time:.2f} s"
                if deepest.distance < 0
                else "",
            ),
            Measure(
                "peak torque",
                float(share[row, dof]),
                1.0 + 1e-9,
                "of the limit",
                f"{self.replay.joint_of_dof(int(dof))} at {recording.time[row]:.2f} s",
            ),
            self._hand_over(task, spans, limits),
        ]
        moved = {j for s in task.subtasks for j in self._joints(_claimed(s))}
        still = [j for group in self.names.upright for j in self.names.groups[group]]
        home = self.names.postures[self.names.home]
        off = {
            j: float(np.abs(np.rad2deg(self.replay.angle(j)) - home.get(j, 0.0)).max())
            for j in still
            if j not in moved
        }
        if off:
            worst = max(off, key=off.__getitem__)
            checks.append(Measure("upright", off[worst], UPRIGHT, "deg", worst))
        return checks

    def _hand_over(self, task: TaskSpec, spans: dict[str, Span], limits: FloatArray) -> Measure:
        """Largest torque step in 2 ms, of the joints that are being handed over."""
        recording = self.recording
        pace = 0.002 / recording.timestep
        steps = np.abs(np.diff(recording.torque, axis=0)) / limits * pace
        worst = Measure("hand-over torque step", 0.0, HAND_OVER_STEP, "of the limit in 2 ms")
        for subtask in task.subtasks:
            span = spans.get(subtask.name)
            if span is None or not np.isfinite(span.start):
                continue
            dofs = [self.replay.dof(j) for j in self._joints(_claimed(subtask))]
            first = max(recording.row(span.start) - 1, 0)
            last = recording.row(span.start + task.fade(subtask)) + 1
            if not dofs or last <= first:
                continue
            window = steps[first:last, dofs]
            row, column = np.unravel_index(np.argmax(window), window.shape)
            if window[row, column] > worst.value:
                where = f"{self.replay.joint_of_dof(dofs[column])}, to {subtask.name}"
                worst = Measure(
                    worst.what, float(window[row, column]), worst.limit, worst.unit, where
                )
        return worst

    # --- who claims what -------------------------------------------------------------------

    def _joints(self, names: str | Sequence[str]) -> set[str]:
        """Joints of limbs, groups or single joints."""
        found: set[str] = set()
        for name in [names] if isinstance(names, str) else names:
            if name in self.names.limbs:
                found |= set(self.names.limbs[name].joints)
            elif name in self.names.groups:
                found |= set(self.names.groups[name])
            elif name == "all":
                found |= set(self.names.servos)
            elif self._is_joint(name):
                found.add(name)
        return found

    def _is_joint(self, name: str) -> bool:
        try:
            self.replay.dof(name)
        except KeyError:
            return False
        return True

    def _claimed_again(self, subtask: SubTask, task: TaskSpec, spans: dict[str, Span]) -> float:
        """When the next sub-task that claims a joint of this one began, or infinity [s]."""
        own, start = self._joints(_claimed(subtask)), spans[subtask.name].start
        later = [
            spans[s.name].start
            for s in task.subtasks
            if s.name in spans and spans[s.name].start > start and own & self._joints(_claimed(s))
        ]
        return min(later, default=np.inf)


def _had_a_goal(subtask: SubTask, span: Span) -> bool:
    """Whether it should be at its goal: not if it ended for a reason of another kind."""
    if span.outcome == "timed out":
        return subtask.otherwise is None
    on_its_own = subtask.done in ("on-time", "reached") and subtask.while_ is None
    return span.outcome == "done" and on_its_own


def _claimed(subtask: SubTask) -> Sequence[str]:
    """The parts of the body that a sub-task moves, as its task file names them.

    A primitive of the user's own may mean something else by those parameters.
    """
    limb, joints = getattr(subtask.does, "limb", None), getattr(subtask.does, "joints", None)
    if isinstance(limb, str):
        return (limb,)
    listed = joints if isinstance(joints, list | tuple) else ()
    return tuple(name for name in listed if isinstance(name, str))


def _own(limb: Limb, joint: str) -> str:
    return f"{limb.side}_{joint}" if f"{limb.side}_{joint}" in limb.joints else joint


def _direction(said: object) -> FloatArray:
    vector = np.array(DIRECTIONS[said] if isinstance(said, str) else said, dtype=float)
    unit: FloatArray = vector / np.linalg.norm(vector)
    return unit


def _angle_between(rows: FloatArray, wanted: FloatArray) -> FloatArray:
    """Angles (T,) [deg] between unit vectors (T, 3) and one (3,)."""
    angles: FloatArray = np.rad2deg(np.arccos(np.clip(rows @ wanted, -1.0, 1.0)))
    return angles


def _ratio(measure: Measure) -> float:
    return measure.value / measure.limit if np.isfinite(measure.value) else np.inf


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None

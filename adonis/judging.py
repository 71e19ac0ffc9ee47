"""The judge: did the recorded movement do what the task says?

It sees the recording, the model and the words of the task, and measures with MuJoCo's own
kinematics (`sim.Replay`). It uses nothing of the controllers, so that it cannot share their
mistakes.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from adonis.aims import Aims
from adonis.claiming import Claims
from adonis.judging_rhythm import asked_rhythms, off_centre, off_rhythm, off_swing
from adonis.verdicts import Judgement, Measure, Verdict, claimed, moved_by, swinging
from primitives import (
    Follow,
    GetPosture,
    GoToPoint,
    Hold,
    LookAt,
    Oscillate,
    Place,
    PointAt,
    Primitive,
    Relax,
)
from primitives.parameters import settling
from sim import DIRECTIONS, BodyMap, Limb, Recording, Replay, Span
from specs import Fitness, SubTask, TaskGraph, TaskSpec, build_graph, task_from_text
from specs.tolerances import ANGLE, PALM_ANGLE, PENETRATION, TOUCH_AT_END, TOUCH_BEFORE_NEXT, size

FloatArray = NDArray[np.float64]

RHYTHM_FREQUENCY = 3.0  # of a joint that swings [% of what was asked]
RHYTHM_AMPLITUDE = 20.0  # in any cycle [% of what was asked]
RHYTHM_LAG = 20.0  # of a joint behind the first [deg]
RHYTHM_CENTRE = 0.03  # of a hand's swing, on average, from where it should be [m]
GAZE = 5.0  # between where the face points and the goal [deg]
POINTING = 5.0  # between the arm and the goal, seen from the shoulder [deg]
DRIFT = 5.0  # of any joint that is to stay where it was [deg]
TRACKING_RMS = 0.02  # palm to moving point, once it has caught up [m]
TRACKING_AT_END = 0.02  # and when the time is over [m]
RELAXED = 1.0  # speed of any joint of a relaxed limb, when its time is over [rad/s]
HAND_OVER_STEP = 0.10  # change of a joint's torque in 2 ms, as a share of its limit
UPRIGHT = 5.0  # joints that no sub-task moves [deg]


def judge(
    recording: Recording,
    spec: TaskSpec | None = None,
    replay: Replay | None = None,
    *,
    fitness: Sequence[Fitness] = (),
) -> Judgement:
    """Measure a recording against a task.

    Args:
        recording: what happened.
        spec: the task; default: the one that the recording says it is of, which may then use
            only primitives that are installed.
        replay: of the recording, if there is one already.
        fitness: what the body can do of the task, if it was done as far as that.
    """
    short = {each.subtask: each for each in fitness if each.verdict != "reachable"}
    task = task_from_text(str(recording.about["task"]))[0] if spec is None else spec
    names, graph = BodyMap.model_validate(recording.about["body_map"]), build_graph(task)
    measuring = _Measuring(recording, names, replay or Replay(recording))
    spans = {s.name: s for s in recording.spans}
    verdicts = []
    for subtask in task.subtasks:
        span = spans.get(subtask.name, Span(subtask.name, np.nan, np.nan, "pending"))
        rounds = [each for each in (*recording.rounds, span) if each.name == subtask.name]
        measured = [
            measuring.subtask(subtask, each, graph) for each in rounds if _had_a_goal(subtask, each)
        ]
        verdicts.append(Verdict(subtask, span, _worst_of(measured), short.get(subtask.name)))
    return Judgement(tuple(verdicts), tuple(measuring.checks(graph, spans)), recording.complete)


def torque_steps(recording: Recording, limits: FloatArray) -> FloatArray:
    """Change of each torque from row to row (T - 1, nv), as a share of its limit in 2 ms."""
    pace = 0.002 / recording.timestep
    steps: FloatArray = np.abs(np.diff(recording.torque, axis=0)) / limits * pace
    return steps


def hand_over_rows(recording: Recording, span: Span, fade: float) -> slice:
    """The torque steps that belong to the hand-over [s] to a sub-task that began."""
    return slice(max(recording.row(span.start) - 1, 0), recording.row(span.start + fade) + 1)


class _Measuring:
    """Measures one recording."""

    def __init__(self, recording: Recording, names: BodyMap, replay: Replay) -> None:
        self.recording, self.names, self.replay = recording, names, replay
        self.aims = Aims(self.replay, names)
        self.claims = Claims(recording, names, replay)
        self.size = size(self._arms())

    def _arms(self) -> list[float]:
        """From shoulder to palm of each arm held straight [m]: where they change, the shortest."""
        lengths = []
        for limb in self.names.limbs.values():
            links = (self.replay.link(n) for n in (limb.upper_arm, limb.forearm, limb.hand))
            places = [*(link.position for link in links), self.replay.site(limb.palm).position]
            parts = [np.linalg.norm(b - a, axis=1) for a, b in pairwise(places)]
            lengths.append(float(np.sum(parts, axis=0).min()))
        return lengths

    def _length(self, what: str, value: float, limit: float, where: str = "") -> Measure:
        """A measure of a length [m], its limit being that of Adonis."""
        return Measure(what, value, limit * self.size, "m", where)

    # --- sub-tasks -------------------------------------------------------------------------

    def subtask(self, subtask: SubTask, span: Span, graph: TaskGraph) -> list[Measure]:
        end = self.recording.row(span.end)
        held = max(self.recording.row(self.claims.let_go(subtask, span, graph.spec)), end)
        does = subtask.does
        if isinstance(does, GoToPoint):
            return self._reach(does, end, held)
        if isinstance(does, GetPosture):
            return self._posture(does, end, held)
        if isinstance(does, Oscillate):
            paced = graph.paced(does, graph.planned[subtask.name][0], graph.lasts(subtask.name))
            return self._rhythm(paced, span.start, span.end, does.swings)
        return self._aim(does, span, end, held, graph.lasts(subtask.name))

    def _aim(
        self, does: Primitive, span: Span, end: int, held: int, duration: float
    ) -> list[Measure]:
        """Of look-at, point-at, follow, hold and relax; nothing of a primitive of one's own."""
        after = slice(end, held + 1)
        match does:
            case LookAt():
                return [Measure("gaze", float(self.aims.gaze(does)[after].max()), GAZE, "deg")]
            case PointAt():
                straight = {self.names.limbs[does.limb].elbow: 0.0}
                off = float(self.aims.pointing(does)[after].max())
                return [
                    Measure("arm to goal", off, POINTING, "deg"),
                    self._angles(straight, after),
                ]
            case Follow():
                distance = self.aims.tracking(does, span.start)
                caught = self.recording.row(span.start + settling(does.settle, duration))
                rms = float(np.sqrt(np.mean(distance[min(caught, end) : end + 1] ** 2)))
                return [
                    self._length("palm to moving point, rms", rms, TRACKING_RMS),
                    self._length("at the end", float(distance[end]), TRACKING_AT_END),
                ]
            case Hold():
                began = self.recording.row(span.start)
                own = self.claims.joints(does.limb or does.joints or ())
                was = {j: float(np.rad2deg(self.replay.angle(j)[began])) for j in own}
                drift = self._angles(was, slice(began, held + 1))
                return [Measure("drift", drift.value, DRIFT, "deg", drift.where)]
            case Relax():
                own = self.claims.joints(does.limb or does.joints or ())
                speed = {
                    j: float(np.abs(self.recording.qvel[after, self.replay.dof(j)]).max())
                    for j in own
                }
                worst = max(speed, key=speed.__getitem__)
                return [Measure("joint speed", speed[worst], RELAXED, "rad/s", worst)]
        return []

    def _reach(self, does: GoToPoint, end: int, held: int) -> list[Measure]:
        palm = self.replay.site(self.names.limbs[does.limb].palm).position
        goal = self._goal(does)
        return [
            self._length(f"palm to goal {when}", float(np.linalg.norm(palm[k] - goal[k])), limit)
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
            carrier = self.aims.turned(self.replay.link_of_site(place.near))
            point = mark.position + place.away * mark.axes[:, :, 0]
        else:
            carrier = self.aims.turned(self.aims.carrier(limb.joints))
            point = carrier.position + carrier.axes @ np.array(place.point)
        shifted: FloatArray = point + carrier.axes @ np.array(place.offset)
        return shifted

    def _posture(self, does: GetPosture, end: int, held: int) -> list[Measure]:
        window = slice(end, held + 1)
        if isinstance(does.posture, str):
            own = self.claims.joints(does.limb or does.joints or ())
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
            for joint in self.claims.joints(name)
        }
        if asked:
            measures.append(self._angles(asked, window))
        return measures

    def _angles(self, asked: dict[str, float], window: slice) -> Measure:
        off = {
            joint: float(np.abs(np.rad2deg(self.replay.angle(joint)[window]) - angle).max())
            for joint, angle in asked.items()
        }
        worst = max(off, key=off.__getitem__, default="")
        return Measure("joint angles", off.get(worst, 0.0), ANGLE, "deg", worst)

    def _rhythm(
        self, does: Oscillate, start: float, end: float, names: Iterable[str]
    ) -> list[Measure]:
        """What swings of it. What listens to the limb swings as the limb would."""
        own = set(names)
        if does.feedback or not own:
            return []
        swung, time = self.aims.swung(does), self.recording.time
        measures: list[Measure] = []

        def worst(what: str, off: dict[str, float], limit: float, unit: str) -> None:
            found = {name: value for name, value in off.items() if name in own}
            if found:
                at = max(found, key=found.__getitem__)
                measures.append(Measure(what, found[at], limit, unit, at))

        for rhythm in asked_rhythms(does, start, end):
            frequencies, amplitudes, lags = off_rhythm(does, rhythm, time, swung)
            worst("frequency off", frequencies, RHYTHM_FREQUENCY, "%")
            worst("amplitude off", amplitudes, RHYTHM_AMPLITUDE, "%")
            worst("lag off", lags, RHYTHM_LAG, "deg")
            if does.at is not None:
                off = off_centre(rhythm, time, swung)
                worst("centre off", off, RHYTHM_CENTRE * self.size, "m")
        if not measures:
            off = off_swing(does, time, swung, start, end)
            worst("swing off", off, RHYTHM_AMPLITUDE, "%")
        return measures

    def _from_carrier(self, limb: Limb, directions: FloatArray) -> FloatArray:
        """Directions (T, 3) of the world, seen from the link that carries the limb."""
        carrier = self.aims.turned(self.aims.carrier(limb.joints))
        seen: FloatArray = np.einsum("tij,ti->tj", carrier.axes, directions)
        return seen

    def _arm_direction(self, limb: Limb) -> FloatArray:
        along = self.replay.link(limb.hand).position - self.replay.link(limb.upper_arm).position
        unit: FloatArray = along / np.linalg.norm(along, axis=1, keepdims=True)
        return unit

    def _palm_direction(self, limb: Limb) -> FloatArray:
        return self.replay.site(limb.palm).axes[:, :, 0]

    # --- all the time ----------------------------------------------------------------------

    def checks(self, graph: TaskGraph, spans: dict[str, Span]) -> list[Measure]:
        recording, task = self.recording, graph.spec
        deepest = self.replay.penetration
        limits = self.replay.torque_limits()
        share = np.abs(self.replay.torque_share())
        row, dof = np.unravel_index(np.nanargmax(share), share.shape)
        checks = [
            self._length(
                "worst penetration",
                abs(deepest.distance),
                PENETRATION,
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
            self._hand_over(graph, spans, limits),
        ]
        taken = {j for s in task.subtasks for j in self.claims.joints(claimed(s))}
        steps = (*task.background, *task.subtasks)
        moved = taken | {j for s in steps for j in self.claims.joints(swinging(s.does))}
        for beside in task.background:
            if isinstance(beside.does, LookAt | Relax):
                moved |= self.claims.joints(moved_by(beside.does))
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
        for beside in task.background:
            if isinstance(beside.does, Oscillate):
                swings = beside.does
                free = [
                    j for j in swings.swings if not self.claims.joints(swings.limb or j) & taken
                ]
                whole = float(recording.time[0]), float(recording.time[-1])
                seen = self._rhythm(graph.paced(swings), *whole, free)
                checks += [replace(m, what=f"{beside.name}: {m.what}") for m in seen]
        return checks

    def _hand_over(self, graph: TaskGraph, spans: dict[str, Span], limits: FloatArray) -> Measure:
        """Largest torque step in 2 ms, of the joints that are being handed over."""
        recording = self.recording
        steps = torque_steps(recording, limits)
        worst = Measure("hand-over torque step", 0.0, HAND_OVER_STEP, "of the limit in 2 ms")
        known = {subtask.name: subtask for subtask in graph.spec.subtasks}
        for span in (*recording.rounds, *spans.values()):
            subtask = known.get(span.name)
            if subtask is None or not np.isfinite(span.start):
                continue
            dofs = [self.replay.dof(j) for j in self.claims.joints(claimed(subtask))]
            window = steps[hand_over_rows(recording, span, graph.fade(subtask.name)), dofs]
            if window.size == 0:
                continue
            row, column = np.unravel_index(np.argmax(window), window.shape)
            if window[row, column] > worst.value:
                where = f"{self.replay.joint_of_dof(dofs[column])}, to {subtask.name}"
                worst = Measure(
                    worst.what, float(window[row, column]), worst.limit, worst.unit, where
                )
        return worst


def _worst_of(rounds: Sequence[Sequence[Measure]]) -> tuple[Measure, ...]:
    """Of each measure the worst round, which is then named beside where it was."""
    found: dict[str, Measure] = {}
    for number, measures in enumerate(rounds, start=1):
        for measure in measures:
            which = f"round {number}" if len(rounds) > 1 else ""
            where = ", ".join(part for part in (measure.where, which) if part)
            known = found.get(measure.what)
            if known is None or not measure.value <= known.value:
                found[measure.what] = replace(measure, where=where)
    return tuple(found.values())


def _had_a_goal(subtask: SubTask, span: Span) -> bool:
    """Whether it should be at its goal: not if it ended for a reason of another kind."""
    if span.outcome == "timed out":
        return subtask.otherwise is None
    on_its_own = subtask.done in ("on-time", "reached") and subtask.while_ is None
    return span.outcome == "done" and on_its_own


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

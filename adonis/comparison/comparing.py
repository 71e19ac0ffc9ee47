"""One task by several controllers: every movement measured in the same way."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from adonis import measures
from adonis.bench import against_physics
from adonis.comparison.human import Human
from adonis.dancing import run_task
from adonis.errors import InputError
from adonis.judging import judge
from adonis.reporting import clearance
from adonis.verdicts import Judgement
from primitives import Field, Primitive
from primitives.parameters import Controller
from primitives.posture_field import PostureField
from primitives.reach_field import ReachField
from primitives.set_point import Profile
from sim import Body, BodyMap, Limb, Recording, Replay, Span, unknown
from specs import BoundTask, SubTask, TaskSpec, bind_task, load_task, load_variant, with_parameter

FloatArray = NDArray[np.float64]

COMBINED = "combined"  # the task as it is written, each sub-task by the controller it names
DANCERS = ("pd-servo", "torque-field", "impedance", COMBINED)
SETTLED = 0.015  # distance from where the hand ends up that counts as there [m]
PAPER_RATE = 5.0  # samples/s of the paper's human data


@dataclass(frozen=True)
class Move:
    """One sub-task by one dancer, as the hand's wrist moved in the sub-task's time."""

    number: int
    name: str
    success: bool
    duration: float  # [s]
    peak_speed: float  # [m/s]
    mean_speed: float  # [m/s]
    peak_over_mean: float
    time_to_peak: float  # share of the duration
    symmetry: float  # 1 is the same forwards and backwards in time
    peak_at_5hz: float  # what the paper's 5 samples/s would show of the peak [m/s]
    jerk: float  # eq 11 [m^2/s^5]
    normalised_jerk: float
    spectral_arc_length: float
    path: float  # [m]
    line_deviation: float  # of the path from the straight line between its ends [m]
    curvature: float  # median over the path [1/m]
    settling: float  # from the sub-task's start until the hand is there to stay [s]
    joint_effort: float  # of the arm's torques [N^2 m^2 s]
    joint_work: float  # [J]
    hand_effort: float  # of the force on the hand that the torques amount to [N^2 s]
    hand_work: float  # [J]
    tracking: float  # rms distance of the arm's set point from the arm; NaN if it has none
    tracking_unit: str
    numbers: int  # that the task file gives for it


@dataclass(frozen=True)
class Dancer:
    """A task done in one way."""

    name: str
    spec: TaskSpec
    recording: Recording
    judgement: Judgement
    replay: Replay
    moves: tuple[Move, ...]
    cost: Mapping[str, float]  # physics_us, dance_us, ratio; bind_s

    @cached_property
    def spans(self) -> dict[str, Span]:
        """What became of the sub-tasks, by name."""
        return {s.name: s for s in self.recording.spans}

    def column(self, measure: str) -> FloatArray:
        """One measure of all sub-tasks, in their order."""
        return np.array([getattr(move, measure) for move in self.moves], dtype=float)

    def hand(self, number: int) -> tuple[FloatArray, FloatArray]:
        """Time (k,) [s] and place (k, 3) [m] of the moving wrist during a sub-task, filtered."""
        subtask = self.spec.subtasks[number - 1]
        rows = _rows(self.recording, self.spans[subtask.name])
        path = _wrist(self.replay, _limb(self.recording, subtask))
        return self.recording.time[rows] - self.recording.time[rows.start], path[rows]

    def speed(self, number: int, count: int = 101) -> FloatArray:
        """Speed of the moving wrist (count,) [m/s] at evenly spread times of a sub-task."""
        at, place = self.hand(number)
        speed = measures.speed(place, self.recording.timestep)
        return np.interp(np.linspace(0.0, at[-1], count), at, speed)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        checks = [c.as_dict() for c in self.judgement.checks]
        return {
            "dancer": self.name,
            "success": self.judgement.success,
            "passed": self.judgement.passed,
            "of": len(self.moves),
            "checks": checks,
            "clearance": self.clearance,
            "joint_effort": float(np.nansum(self.column("joint_effort"))),
            "joint_work": float(np.nansum(self.column("joint_work"))),
            "numbers": int(np.sum(self.column("numbers"))),
            "cost": dict(self.cost),
            "moves": [asdict(move) for move in self.moves],
        }

    @cached_property
    def clearance(self) -> float:
        """Smallest distance of links that must not touch and need not [m]."""
        return clearance(self.recording, self.spec).distance


@dataclass(frozen=True)
class Comparison:
    """The same task by several dancers, and by a human if there are figures of one."""

    task: str
    title: str
    body: Body
    dancers: tuple[Dancer, ...]
    human: Human | None

    def __getitem__(self, name: str) -> Dancer:
        return next(d for d in self.dancers if d.name == name)

    def __contains__(self, name: str) -> bool:
        return any(d.name == name for d in self.dancers)

    @property
    def subtasks(self) -> tuple[SubTask, ...]:
        """The sub-tasks, in the order in which they are numbered."""
        return self.dancers[0].spec.subtasks


def compare(
    task: str,
    body: Body,
    *,
    dancers: Sequence[str] = DANCERS,
    human: Human | None = None,
    seed: int = 0,
    costs: bool = True,
    primitives: Sequence[type[Primitive]] = (),
    progress: Callable[[str, float], None] | None = None,
) -> Comparison:
    """Let a task be done by one controller after another.

    Args:
        task: a name of the library, or a path.
        body: whose task it is.
        dancers: names of controllers; `combined` is the task as it is written.
        human: figures of a human.
        seed: written into the recordings.
        costs: whether to measure what each costs per step.
        primitives: classes of one's own that the task may use.
        progress: told what is being done, and the share that is done.

    Raises:
        SpecError: the task does not fit the body or a controller.
        Stopped: a run broke off.
    """
    found = []
    for k, name in enumerate(dancers):

        def tell(what: str, share: float, name: str = name, k: int = k) -> None:
            if progress is not None:
                progress(f"{name}: {what}", (k + share) / len(dancers))

        found.append(_dance(task, name, body, seed, costs, tell, primitives=primitives))
    spec, _ = load_task(task, primitives=primitives)
    return Comparison(task, spec.title or spec.task, body, tuple(found), human)


def dance(task: str, name: str, body: Body, *, profile: Profile | None = None) -> Dancer:
    """One controller's dance outside a comparison, its cost not measured.

    Args:
        task: a name of the library, or a path.
        name: of the controller.
        body: whose task it is.
        profile: of the set points, instead of the task's own.
    """
    return _dance(task, name, body, 0, False, _silent, profile)


def _silent(what: str, share: float) -> None:
    """Tell nobody."""


def _dance(
    task: str,
    name: str,
    body: Body,
    seed: int,
    costs: bool,
    tell: Callable[[str, float], None],
    profile: Profile | None = None,
    primitives: Sequence[type[Primitive]] = (),
) -> Dancer:
    tell("binding", 0.0)
    if name == COMBINED:
        spec, document = load_task(task, primitives=primitives)
    else:
        spec, document = load_variant(task, _controller(name), primitives=primitives)
    if profile is not None:
        spec = with_parameter(spec, "profile", profile)
    began = time.perf_counter()
    bound = bind_task(spec, body, document)
    cost = {"bind_s": time.perf_counter() - began}
    recording = run_task(
        bound, seed=seed, contributions=False, progress=lambda share, what: tell(what, 0.5 * share)
    )[0]
    tell("judging", 0.5)
    judgement = judge(recording, bound.spec)
    replay = Replay(recording)
    tell("measuring", 0.7)
    moves = tuple(_moves(bound, recording, judgement, replay))
    if costs:
        tell("timing", 0.8)
        cost |= against_physics(bound)
    return Dancer(name, bound.spec, recording, judgement, replay, moves, cost)


def _controller(name: str) -> str:
    known = get_args(Controller)
    if name not in known:
        raise InputError(unknown("controller", name, [*known, COMBINED]))
    return name


def _rows(recording: Recording, span: Span) -> slice:
    """The rows of a sub-task's time; all of them if it never ended."""
    end = span.end if np.isfinite(span.end) else recording.time[-1]
    start = span.start if np.isfinite(span.start) else 0.0
    return slice(recording.row(start), max(recording.row(float(end)), recording.row(start) + 8) + 1)


def _limb(recording: Recording, subtask: SubTask) -> Limb:
    """The arm that a sub-task moves; the first if it moves none."""
    limbs = BodyMap.model_validate(recording.about["body_map"]).limbs
    return limbs.get(getattr(subtask.does, "limb", None) or "", next(iter(limbs.values())))


def _wrist(replay: Replay, limb: Limb) -> FloatArray:
    """Place of the wrist (T, 3) [m], filtered as the human's is."""
    return measures.low_pass(replay.link(limb.hand).position, replay.recording.timestep)


def _moves(
    bound: BoundTask, recording: Recording, judgement: Judgement, replay: Replay
) -> Iterator[Move]:
    """Measure every sub-task."""
    dt = recording.timestep
    spans = {s.name: s for s in recording.spans}
    fields = dict(zip(bound.graph.order, bound.fields, strict=True))
    for number, verdict in enumerate(judgement.verdicts, start=1):
        subtask = verdict.subtask
        limb, rows = _limb(recording, subtask), _rows(recording, spans[subtask.name])
        whole = _wrist(replay, limb)
        place = whole[rows]
        profile = measures.speed_profile(place, dt)
        dofs = [replay.dof(joint) for joint in limb.joints]
        torque, velocity = recording.torque[rows][:, dofs], recording.qvel[rows][:, dofs]
        force = replay.hand_force(limb.palm, rows)
        speed_of_hand = np.gradient(replay.site(limb.palm).position, dt, axis=0)[rows]
        tracking, unit = _tracking(fields[subtask.name], recording, replay, rows, limb)
        held = whole[rows.start : _held(recording, subtask, judgement)]
        away = np.linalg.norm(held - held[-1], axis=1)
        yield Move(
            number=number,
            name=subtask.name,
            success=verdict.success,
            duration=float((rows.stop - 1 - rows.start) * dt),
            peak_speed=profile.peak,
            mean_speed=profile.mean,
            peak_over_mean=profile.peak_to_mean,
            time_to_peak=profile.time_to_peak,
            symmetry=profile.symmetry,
            peak_at_5hz=profile.peak * (1.0 - measures.peak_loss(place, dt, PAPER_RATE)),
            jerk=measures.jerk_index(place, dt),
            normalised_jerk=measures.normalised_jerk(place, dt),
            spectral_arc_length=measures.spectral_arc_length(measures.speed(place, dt), dt),
            path=measures.path_length(place),
            line_deviation=measures.line_deviation(place),
            curvature=_median(measures.curvature(place, dt)),
            settling=measures.settling_time(away, dt, SETTLED),
            joint_effort=measures.joint_effort(torque, dt),
            joint_work=measures.mechanical_work(torque, velocity, dt),
            hand_effort=measures.hand_effort(force, dt),
            hand_work=measures.hand_work(force, speed_of_hand, dt),
            tracking=tracking,
            tracking_unit=unit,
            numbers=count_numbers(subtask),
        )


def _median(values: FloatArray) -> float:
    """Of what is known; NaN if nothing is."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else np.nan


def _held(recording: Recording, subtask: SubTask, judgement: Judgement) -> int:
    """The row before the arm of a sub-task moves on, or the last."""
    spans = {v.subtask.name: v.span for v in judgement.verdicts}
    limb, start = getattr(subtask.does, "limb", None), spans[subtask.name].start
    later = [
        v.span.start
        for v in judgement.verdicts
        if getattr(v.subtask.does, "limb", None) == limb and v.span.start > start
    ]
    return recording.row(min(later)) if later else len(recording.time)


def _tracking(
    field: Field, recording: Recording, replay: Replay, rows: slice, limb: Limb
) -> tuple[float, str]:
    """Root mean square distance of an arm from its set point, if that moves at all."""
    t = recording.time[rows] - recording.time[rows.start]
    if isinstance(field, PostureField) and field.controller == "pd-servo":
        qpos = np.array([replay.angle(joint) for joint in limb.joints])[:, rows].T
        dofs = [replay.dof(joint) for joint in limb.joints]
        wanted = field.set_point(t, qpos[0], dofs)
        return measures.tracking_error(qpos, wanted)[0], "rad"
    if isinstance(field, ReachField):
        palm = replay.site(limb.palm).position[rows]
        weights = field.weights(t)
        wanted = weights[:, :1] * palm[0]
        for k, spot in enumerate(field.places, start=1):
            wanted = wanted + weights[:, k : k + 1] * replay.point(spot)[rows]
        return measures.tracking_error(palm, wanted)[0], "m"
    return np.nan, ""


def count_numbers(subtask: SubTask) -> int:
    """How many numbers a task file gives for a sub-task: in its goal, via points and gains."""

    def count(value: object) -> int:
        if isinstance(value, bool | str) or value is None:
            return 0
        if isinstance(value, dict):
            return sum(count(v) for v in value.values())
        if isinstance(value, list | tuple):
            return sum(count(v) for v in value)
        return 1

    return count(subtask.does.model_dump(exclude_unset=True))

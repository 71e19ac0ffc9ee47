"""oscillate: swing joints about a centre, for as long as it lasts.

For waving, nodding, bouncing, swaying: an oscillator moves the equilibrium of a joint spring
(Williamson 1998); see `oscillator`. By itself it holds its joints. With `claims: false` it only
moves the equilibrium of whatever else holds them, so that a rhythm can go on beside a movement.
"""

from collections.abc import Sequence
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator
from pydantic import Field as Parameter

from primitives.compiled_field import CompiledField
from primitives.errors import PrimitiveError
from primitives.limit_cycle import limit_cycle
from primitives.oscillator import HEAD, HOPF, JOINT, MATSUOKA, SINE, STATES, STRETCH
from primitives.parameters import NonNegative, Positive
from primitives.posture_field import JointGains, joint_gains
from primitives.primitive import NO_JOINTS, FloatArray, IntArray, Primitive
from primitives.table import RHYTHM, TableBuilder
from sim import Body

Oscillator = Literal["sine", "hopf", "matsuoka"]
KINDS: dict[Oscillator, int] = {"sine": SINE, "hopf": HOPF, "matsuoka": MATSUOKA}
FASTEST = 0.1  # cycles per time step of the physics
ROUNDING = 1e-9  # what changes this much later changes now [cycles, beats]
ITS_OWN = ("feedback", "coupling")  # what a sine does not have


class Swing(BaseModel):
    """How one joint swings."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    amplitude: Annotated[float, Parameter(gt=0, le=180)]  # to either side [deg]
    lag: Annotated[float, Parameter(ge=-360, le=360)] = 0.0  # behind the rhythm [deg]


class TempoChange(BaseModel):
    """Another frequency from some cycle on; the phase goes on where it is."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    cycle: Positive  # how many cycles have passed by then
    frequency: Positive | None = None  # [Hz]
    beats_per_cycle: Positive | None = None  # at the tempo of the task

    @model_validator(mode="after")
    def _one_pace(self) -> Self:
        _check_pace(self.frequency, self.beats_per_cycle)
        return self


class Oscillate(Primitive):
    """Swing joints about a centre, in a rhythm."""

    kind: Literal["oscillate"] = "oscillate"
    joints: Annotated[dict[str, Swing], Parameter(min_length=1)]  # each that swings
    frequency: Positive | None = None  # [Hz], or
    beats_per_cycle: Positive | None = None  # at the task's tempo
    then: tuple[TempoChange, ...] = ()  # other paces later
    phase: Annotated[float, Parameter(ge=-360, le=360)] = 0.0  # at the beginning [deg]
    centre: str | dict[str, float] | None = None  # posture, or degrees; default: where they are
    ease: NonNegative = 0.5  # cycles in which the swing grows, and dies away before the end
    claims: bool = True  # whether it holds its joints, or moves the equilibrium of what does
    oscillator: Oscillator = "sine"  # what keeps the rhythm
    feedback: NonNegative = 0.0  # of the joint to its oscillator; 0: it does not listen
    coupling: Annotated[float, Parameter(ge=0, lt=1)] = 0.5  # how firmly joints keep their lags
    stiffness: Positive | None = None  # of the joint springs [N m/rad]; default: the body's
    damping: NonNegative | None = None  # [N m s/rad]

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        _check_pace(self.frequency, self.beats_per_cycle)
        if any(b.cycle <= a.cycle for a, b in zip(self.then, self.then[1:], strict=False)):
            raise ValueError("the cycles of 'then' must rise")
        if self.oscillator == "sine":
            for name in ITS_OWN:
                if name in self.model_fields_set:
                    raise ValueError(f"{name} belongs to the oscillators hopf and matsuoka")
        if not self.claims and self.centre is not None:
            raise ValueError(
                "without claims the centre is that of whatever holds the joints: leave it out"
            )
        return self

    def at_tempo(self, tempo: float, changes: Sequence[tuple[float, float]] = ()) -> Self:
        """See `Primitive.at_tempo`."""
        (_, frequency), *later = _in_hertz(self, [(0.0, tempo), *changes])
        then = tuple(TempoChange(cycle=cycle, frequency=pace) for cycle, pace in later)
        own = {"frequency": frequency, "beats_per_cycle": None, "then": then}
        return self.model_copy(update=own)

    def bind(self, body: Body, duration: float) -> "RhythmField":
        """See `Primitive.bind`."""
        dofs = []
        for name in self.joints:
            found = body.joints(name)
            if len(found) != 1:
                raise PrimitiveError(f"{name!r} is {len(found)} joints; name each that swings")
            dofs.append(int(found[0]))
        stretches = self._stretches(body)
        ease = self.ease / stretches[[0, -1], 2]  # [s] at the beginning and before the end
        if np.isfinite(duration) and ease.sum() > duration * (1.0 + 1e-9):
            raise PrimitiveError(
                f"{duration:.3g} s are too short for a swing to grow and die away, which takes"
                f" {ease.sum():.3g} s: give it more time, or less 'ease'"
            )
        centre = self._centre(body)
        swings = [
            (float(dof), np.deg2rad(s.amplitude), np.deg2rad(s.lag - self.phase), centre[dof])
            for dof, s in zip(dofs, self.joints.values(), strict=True)
        ]
        return RhythmField(
            body,
            np.array(dofs, dtype=np.int32),
            self,
            stretches,
            ease,
            np.array(swings),
            joint_gains(
                body, np.array(dofs, dtype=np.int32),
                stiffness=self.stiffness, damping=self.damping,
            ),
            duration,
        )  # fmt: skip

    def _stretches(self, body: Body) -> FloatArray:
        """Stretches of one frequency: begins [s], cycles until then, frequency [Hz]."""
        rows = [(0.0, 0.0, self._known(self.frequency, body))]
        for change in self.then:
            begins, until, frequency = rows[-1]
            begins += (change.cycle - until) / frequency
            rows.append((begins, change.cycle, self._known(change.frequency, body)))
        return np.array(rows)

    def _known(self, frequency: float | None, body: Body) -> float:
        if frequency is None:
            raise PrimitiveError("beats_per_cycle needs a tempo: bind what at_tempo(…) returns")
        if frequency * body.timestep > FASTEST:
            raise PrimitiveError(
                f"{frequency:.4g} Hz is too fast for the time step of {body.timestep:g} s;"
                f" at most {FASTEST / body.timestep:.4g} Hz"
            )
        return frequency

    def _centre(self, body: Body) -> FloatArray:
        """The centre (nv,) [rad]; NaN where it is wherever a joint is."""
        match self.centre:
            case None:
                return np.full(body.nv, np.nan)
            case str() as name:
                angles = body.posture(name)
            case said:
                for name in said:
                    if name not in self.joints:
                        raise PrimitiveError(f"the centre has {name!r}, which does not swing")
                angles = body.angles(said)
        for name in self.joints:
            if np.isnan(angles[body.joints(name)]).any():
                raise PrimitiveError(f"the centre {self.centre!r} says nothing about {name!r}")
        return angles


class RhythmField(CompiledField):
    """Swings joints: see `oscillator`.

    Args:
        body: whose joints.
        dofs: which of them (k,).
        does: the primitive, of which kind, feedback, coupling and claims are taken.
        stretches: of one frequency (s, 3): begins [s], cycles until then, frequency [Hz].
        ease: time in which it grows, and in which it dies away (2,) [s].
        swings: per joint (k, 4): number, amplitude, lag, centre [rad].
        gains: of the joints.
        duration: when it is at rest again [s].
    """

    def __init__(
        self,
        body: Body,
        dofs: IntArray,
        does: Oscillate,
        stretches: FloatArray,
        ease: FloatArray,
        swings: FloatArray,
        gains: JointGains,
        duration: float,
    ) -> None:
        super().__init__(body, dofs if does.claims else NO_JOINTS, unit="")
        self._does, self._stretches, self._ease = does, stretches, ease
        self._swings, self._gains, self._duration = swings, gains, duration

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        does, shape = self._does, np.zeros(6)
        if does.oscillator == "matsuoka":
            c = limit_cycle()
            shape[:] = c.pace, c.swing, c.ahead, c.aside, np.cos(c.turn), np.sin(c.turn)
        head = np.array(
            [
                *(KINDS[does.oscillator], does.claims, does.feedback, does.coupling),
                *(len(self._swings), len(self._stretches), *self._ease, *shape),
            ]
        )
        joints = np.array([self._joint(swing) for swing in self._swings])
        assert head.shape == (HEAD,)
        assert self._stretches.shape[1] == STRETCH
        assert joints.shape[1] == JOINT
        row = table.numbers(head, self._stretches, joints)
        return table.field(RHYTHM, row, self.claims, duration=self._duration)

    def _joint(self, swing: FloatArray) -> list[float]:
        number, amplitude, lag, centre = swing.tolist()
        dof, begin = int(number), np.zeros(STATES)
        if self._does.oscillator == "hopf":
            begin[:2] = np.cos(-lag), np.sin(-lag)
        elif self._does.oscillator == "matsuoka":
            cycle = limit_cycle()
            begin = amplitude / cycle.swing * cycle.at(-lag)
        gains = float(self._gains.stiffness[dof]), float(self._gains.damping[dof])
        turned = float(np.cos(lag)), float(np.sin(lag))
        return [number, *gains, centre, amplitude, lag, *turned, *begin.tolist()]


def _check_pace(frequency: float | None, beats_per_cycle: float | None) -> None:
    if (frequency is None) == (beats_per_cycle is None):
        raise ValueError("give either frequency or beats_per_cycle")


def _in_hertz(does: Oscillate, tempos: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Its paces, and the cycle from which each holds, at tempos that hold from a beat on [Hz]."""
    paces: list[tuple[float, Oscillate | TempoChange]]
    paces = [(0.0, does), *((change.cycle, change) for change in does.then)]
    found: list[tuple[float, float]] = []
    beat = cycle = 0.0
    while True:
        tempo, pace = tempos[0][1], paces[0][1]
        frequency = _hertz(pace, tempo)
        if not found or frequency != found[-1][1]:
            found.append((cycle, frequency))
        per_beat = frequency * 60.0 / tempo  # cycles
        left = [(paces[1][0] - cycle) / per_beat] if paces[1:] else []
        left += [tempos[1][0] - beat] if tempos[1:] else []
        if not left:
            return found
        passed = min(left)
        beat, cycle = beat + passed, cycle + passed * per_beat
        if paces[1:] and paces[1][0] <= cycle + ROUNDING:
            paces, cycle = paces[1:], paces[1][0]
        if tempos[1:] and tempos[1][0] <= beat + ROUNDING:
            tempos, beat = tempos[1:], tempos[1][0]


def _hertz(pace: Oscillate | TempoChange, tempo: float) -> float:
    """Its frequency [Hz] at a tempo [beats/min]."""
    if pace.beats_per_cycle is not None:
        return tempo / (60.0 * pace.beats_per_cycle)
    assert pace.frequency is not None, "it has one or the other"
    return pace.frequency

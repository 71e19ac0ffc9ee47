"""oscillate: swing joints, or a hand, about a centre, for as long as it lasts.

For waving, nodding, bouncing, swaying, patting: an oscillator moves the equilibrium of a joint's
spring (Williamson 1998), or of the spring that holds a palm; see `oscillator` and `hand_rhythm`. By
itself it holds what swings. With `claims: false` it only moves the equilibrium of whatever else
holds it, so that a rhythm can go on beside a movement.
"""

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator
from pydantic import Field as Parameter

from primitives.errors import PrimitiveError
from primitives.parameters import (
    Damping,
    Direction,
    Frequency,
    Length,
    NonNegative,
    Positive,
    Stiffness,
)
from primitives.posture_field import joint_gains
from primitives.primitive import FloatArray, Primitive
from primitives.reach_field import HandGoal
from primitives.rhythm_field import HandRhythmField, Oscillators, RhythmField
from primitives.target import Target, locate, refuse_own
from sim import Body, Spot

Oscillator = Literal["sine", "hopf", "matsuoka"]
FASTEST = 0.1  # cycles per time step of the physics
ROUNDING = 1e-9  # what changes this much later changes now [cycles, beats]
ITS_OWN = ("feedback", "coupling")  # what a sine does not have
OF_A_HAND = ("along", "at", "palm", "turn_stiffness", "turn_damping", "shoulder_damping")
OPPOSITES = (("up", "down"), ("left", "right"), ("forward", "back"))


class Swing(BaseModel):
    """How one joint swings."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    amplitude: Annotated[float, Parameter(gt=0, le=180)]  # to either side [deg]
    lag: Annotated[float, Parameter(ge=-360, le=360)] = 0.0  # behind the rhythm [deg]


class HandSwing(BaseModel):
    """How a hand swings in one direction."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    amplitude: Annotated[Length, Parameter(gt=0, le=2)]  # to either side [m]
    lag: Annotated[float, Parameter(ge=-360, le=360)] = 0.0  # behind the rhythm [deg]


class TempoChange(BaseModel):
    """Another frequency from some cycle on; the phase goes on where it is."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    cycle: Positive  # how many cycles have passed by then
    frequency: Frequency | None = None  # [Hz]
    beats_per_cycle: Positive | None = None  # at the tempo of the task

    @model_validator(mode="after")
    def _one_pace(self) -> Self:
        _check_pace(self.frequency, self.beats_per_cycle)
        return self


class Oscillate(Primitive):
    """Swing joints, or a hand, about a centre, in a rhythm."""

    kind: Literal["oscillate"] = "oscillate"
    joints: Annotated[dict[str, Swing], Parameter(min_length=1)] | None = None  # that swing, or
    limb: str | None = None  # an arm, whose hand swings
    along: Annotated[dict[str, HandSwing], Parameter(min_length=1)] | None = None  # directions
    at: str | Target | None = None  # the centre of a hand's swing; default: where the palm is
    palm: Direction | None = None  # where it faces; default: free
    frequency: Frequency | None = None  # [Hz], or
    beats_per_cycle: Positive | None = None  # at the task's tempo
    then: tuple[TempoChange, ...] = ()  # other paces later
    phase: Annotated[float, Parameter(ge=-360, le=360)] = 0.0  # at the beginning [deg]
    centre: str | dict[str, float] | None = None  # posture, or degrees; default: where they are
    ease: NonNegative = 0.5  # cycles in which the swing grows, and dies away before the end
    claims: bool = True  # whether it holds its joints, or moves the equilibrium of what does
    oscillator: Oscillator = "sine"  # what keeps the rhythm
    feedback: NonNegative = 0.0  # of the joint to its oscillator; 0: it does not listen
    coupling: Annotated[float, Parameter(ge=0, lt=1)] = 0.5  # how firmly joints keep their lags
    # Gains of the joints' springs [N m/rad, N m s/rad], or of the hand's [N/m, N s/m]; default: the
    # body's. Then those that only a hand has.
    stiffness: Stiffness | None = None
    damping: Damping | None = None
    turn_stiffness: Stiffness | None = None  # [N m/rad]
    turn_damping: Damping | None = None  # [N m s/rad]
    shoulder_damping: Damping | None = None  # [N m s/rad]

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.joints is None) == (self.limb is None):
            raise ValueError("give either joints, or a limb and along")
        if self.limb is not None:
            self._check_hand()
        elif own := self.model_fields_set.intersection(OF_A_HAND):
            raise ValueError(f"{min(own)} goes with a limb, whose hand swings")
        _check_pace(self.frequency, self.beats_per_cycle)
        if any(b.cycle <= a.cycle for a, b in zip(self.then, self.then[1:], strict=False)):
            raise ValueError("the cycles of 'then' must rise")
        if self.oscillator == "sine":
            for name in ITS_OWN:
                if name in self.model_fields_set:
                    raise ValueError(f"{name} belongs to the oscillators hopf and matsuoka")
        for name in ("centre", "at"):
            if not self.claims and getattr(self, name) is not None:
                raise ValueError(
                    "without claims the centre is that of whatever holds what swings: leave"
                    f" {name!r} out"
                )
        return self

    def _check_hand(self) -> None:
        if self.along is None:
            raise ValueError("a limb swings along directions: along: {up: {amplitude: 0.05}}")
        if self.centre is not None:
            raise ValueError("centre is for joints; a hand swings about what 'at' says")
        for one, other in OPPOSITES:
            if one in self.along and other in self.along:
                raise ValueError(f"{one!r} and {other!r} are one line: leave one of them out")

    @property
    def swings(self) -> Mapping[str, Swing | HandSwing]:
        """What swings and how: joints [deg], or the directions of a hand [m]."""
        return self.joints or self.along or {}

    def at_tempo(self, tempo: float, changes: Sequence[tuple[float, float]] = ()) -> Self:
        """See `Primitive.at_tempo`."""
        (_, frequency), *later = _in_hertz(self, [(0.0, tempo), *changes])
        then = tuple(TempoChange(cycle=cycle, frequency=pace) for cycle, pace in later)
        own = {"frequency": frequency, "beats_per_cycle": None, "then": then}
        return self.model_copy(update=own)

    def bind(self, body: Body, duration: float) -> "RhythmField | HandRhythmField":
        """See `Primitive.bind`."""
        stretches = self._stretches(body)
        ease = self.ease / stretches[[0, -1], 2]  # [s] at the beginning and before the end
        if np.isfinite(duration) and ease.sum() > duration * (1.0 + 1e-9):
            raise PrimitiveError(
                f"{duration:.3g} s are too short for a swing to grow and die away, which takes"
                f" {ease.sum():.3g} s: give it more time, or less 'ease'"
            )
        scale = 1.0 if self.limb else np.deg2rad(1.0)
        swings = [
            (s.amplitude * scale, np.deg2rad(s.lag - self.phase)) for s in self.swings.values()
        ]
        how = Oscillators(
            self.oscillator, self.claims, self.feedback, self.coupling, stretches, ease,
            np.array(swings),
        )  # fmt: skip
        if self.limb is not None:
            return self._bind_hand(body, self.limb, how, duration)
        dofs = []
        for name in self.joints or ():
            found = body.joints(name)
            if len(found) != 1:
                raise PrimitiveError(f"{name!r} is {len(found)} joints; name each that swings")
            dofs.append(int(found[0]))
        own = np.array(dofs, dtype=np.int32)
        gains = joint_gains(body, own, stiffness=self.stiffness, damping=self.damping)
        return RhythmField(body, own, how, self._centre(body)[own], gains, duration)

    def _bind_hand(
        self, body: Body, limb: str, how: Oscillators, duration: float
    ) -> HandRhythmField:
        arm = body.arm(limb)
        directions = [body.to_link(arm.root, body.direction(word)) for word in self.swings]
        places: tuple[Spot, ...] = ()
        normal, touched = None, -1
        if self.at is not None:
            places = (locate(body, self.at, arm.root),)
            refuse_own(body, places[0], arm.dofs, "oscillate", self.at)
            if isinstance(self.at, str):
                touched, normal = places[0].link, (places[0].link, -places[0].normal)
        if self.palm is not None:
            normal = (arm.root, body.to_link(arm.root, body.direction(self.palm)))
        goal = HandGoal(places, normal=normal, touched=touched)
        gains = {name: getattr(self, name, None) for name in type(arm.limb.spring).model_fields}
        return HandRhythmField(body, arm, how, np.array(directions), goal, gains, duration)

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
                    if name not in self.swings:
                        raise PrimitiveError(f"the centre has {name!r}, which does not swing")
                angles = body.angles(said)
        for name in self.swings:
            if np.isnan(angles[body.joints(name)]).any():
                raise PrimitiveError(f"the centre {self.centre!r} says nothing about {name!r}")
        return angles


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

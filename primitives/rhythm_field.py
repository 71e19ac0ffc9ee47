"""The fields of a rhythm: joints, or a hand, whose equilibrium oscillators move."""

from dataclasses import dataclass

import numpy as np

from primitives.compiled_field import CompiledField
from primitives.impedance import POINT
from primitives.limit_cycle import limit_cycle
from primitives.oscillator import HEAD, HOPF, JOINT, MATSUOKA, SINE, STATES, STRETCH
from primitives.posture_field import JointGains
from primitives.primitive import NO_JOINTS, FloatArray, IntArray
from primitives.reach_field import HandGoal, hand_springs
from primitives.table import HAND_RHYTHM, RHYTHM, TableBuilder
from sim import Arm, Body

KINDS = {"sine": SINE, "hopf": HOPF, "matsuoka": MATSUOKA}


@dataclass(frozen=True)
class Oscillators:
    """What swings, and how; all that joints and hands have in common."""

    kind: str  # sine, hopf or matsuoka
    holds: bool  # whether it holds what swings, or only moves the equilibrium
    feedback: float
    coupling: float
    stretches: FloatArray  # of one frequency (s, 3): begins [s], cycles until then, frequency [Hz]
    ease: FloatArray  # time in which it grows, and in which it dies away (2,) [s]
    swings: FloatArray  # (k, 2): amplitude [rad or m], lag [rad]

    def numbers(self, rows: FloatArray) -> tuple[FloatArray, ...]:
        """As compiled code has them; rows (k, 4) say joint, stiffness, damping, centre of each."""
        shape = np.zeros(6)
        if self.kind == "matsuoka":
            c = limit_cycle()
            shape[:] = c.pace, c.swing, c.ahead, c.aside, np.cos(c.turn), np.sin(c.turn)
        head = np.array(
            [
                *(KINDS[self.kind], self.holds, self.feedback, self.coupling),
                *(len(self.swings), len(self.stretches), *self.ease, *shape),
            ]
        )
        joints = np.array(
            [
                [*row, *self._oscillator(*swing)]
                for row, swing in zip(rows, self.swings, strict=True)
            ]
        )
        assert head.shape == (HEAD,)
        assert self.stretches.shape[1] == STRETCH
        assert joints.shape[1] == JOINT
        return head, self.stretches, joints

    def _oscillator(self, amplitude: float, lag: float) -> list[float]:
        begin = np.zeros(STATES)
        if self.kind == "hopf":
            begin[:2] = np.cos(-lag), np.sin(-lag)
        elif self.kind == "matsuoka":
            cycle = limit_cycle()
            begin = amplitude / cycle.swing * cycle.at(-lag)
        return [amplitude, lag, float(np.cos(lag)), float(np.sin(lag)), *begin.tolist()]


class RhythmField(CompiledField):
    """Swings joints: see `oscillator`.

    Args:
        body: whose joints.
        dofs: which of them (k,).
        oscillators: of each.
        centres: about which they swing (k,) [rad]; NaN for where they are when it begins.
        gains: of the joints.
        duration: when it is at rest again [s].
    """

    def __init__(
        self,
        body: Body,
        dofs: IntArray,
        oscillators: Oscillators,
        centres: FloatArray,
        gains: JointGains,
        duration: float,
    ) -> None:
        super().__init__(body, dofs if oscillators.holds else NO_JOINTS, unit="")
        self._oscillators, self._duration = oscillators, duration
        self._rows = np.column_stack([dofs, gains.stiffness[dofs], gains.damping[dofs], centres])

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        row = table.numbers(*self._oscillators.numbers(self._rows))
        return table.field(RHYTHM, row, self.claims, duration=self._duration)


class HandRhythmField(CompiledField):
    """Swings a hand: see `hand_rhythm`.

    Args:
        body: whose arm.
        arm: the arm.
        oscillators: of each direction.
        directions: (k, 3) unit vectors in the frame of the link that carries the arm.
        goal: the centre, if it is not where the palm is when it begins; how the palm is turned.
        gains: by the names of `sim.Spring`; what is missing or None is the body's.
        duration: when it is at rest again [s].
    """

    def __init__(
        self,
        body: Body,
        arm: Arm,
        oscillators: Oscillators,
        directions: FloatArray,
        goal: HandGoal,
        gains: dict[str, float | None],
        duration: float,
    ) -> None:
        super().__init__(body, arm.dofs if oscillators.holds else NO_JOINTS, unit="")
        self._oscillators, self._directions = oscillators, directions
        self._hand, self._goal, self._duration = arm.hand, goal, duration
        self._reach = hand_springs(arm, body.palm_at_home(arm), goal, gains)

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        points, reach = np.zeros(len(self._goal.places), dtype=POINT), self._reach.copy()
        for row, place in zip(points, self._goal.places, strict=True):
            row["link"], row["point"] = place.link, place.point
        reach["points"] = table.records(points)
        rows = np.tile((-1.0, 0.0, 0.0, np.nan), (len(self._directions), 1))
        return table.field(
            HAND_RHYTHM,
            table.records(reach),
            self.claims,
            duration=self._duration,
            curve=table.numbers(*self._oscillators.numbers(rows), self._directions),
            knots=len(points),
            touch=(self._hand, self._goal.touched),
        )

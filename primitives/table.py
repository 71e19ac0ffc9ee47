"""The table of fields: every compiled field of a task as rows of a few arrays.

One compiled function can then work through the fields of a simulation without returning to
Python between them. `TableBuilder` collects the rows when a task is bound; `begin_field`,
`add_torque` and `field_error` are what the arbiter calls on them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Record, Records, compiled
from primitives.endpoint_force import endpoint_force
from primitives.gaze import begin_gaze, gaze, gaze_error, looking_at
from primitives.gravity import carry_weight, hang_loose
from primitives.hand_rhythm import begin_hand_rhythm, swing_hand
from primitives.impedance import (
    POINT,
    REACH,
    REMEMBERED,
    begin_reach,
    impedance,
    keep_goal,
    palm_position,
    pull_hand,
)
from primitives.mechanics import Row, dot, subtract, to_world, vector
from primitives.oscillator import JOINTS, REMEMBERS, begin_rhythm, rhythm
from primitives.pd_servo import pd_servo
from primitives.pointing import begin_pointing, point_arm, pointing_at, pointing_error
from primitives.profiles import minimum_jerk
from primitives.pursuit import SINCE, catch_up, moving_point, pull_to, pursuit_error
from primitives.repulsion import CAPSULE, GUARD, GUARDED, PAIR, TOUCH, repel
from primitives.set_point import (
    MOST_KNOTS,
    POWERS,
    Profile,
    knot_weights,
    weigh_knots,
)
from primitives.torque_field import torque_field, weigh_wells

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

PLAIN, PD_SERVO, TORQUE_FIELD, IMPEDANCE, ENDPOINT_FORCE, GUARDING, WEIGHT, RHYTHM = range(8)
GAZE, POINT_ARM, PURSUIT, LOOSE, HAND_RHYTHM = range(8, 13)

# `row` is where the field's own numbers begin: in `numbers` (PD_SERVO, TORQUE_FIELD, WEIGHT,
# RHYTHM, GAZE, POINT_ARM, LOOSE), `reaches` (IMPEDANCE, ENDPOINT_FORCE, PURSUIT, HAND_RHYTHM),
# `guards` (GUARDING), or its place among the plain fields (PLAIN). A PURSUIT keeps a trajectory of
# `knots` points in `numbers`, from `curve` on; a HAND_RHYTHM its oscillators there, and `knots` is
# 1 if it has a centre of its own.
FIELD = np.dtype(
    [
        *(("kind", np.int32), ("row", np.int32), ("curve", np.int32), ("knots", np.int32)),
        *(("hand", np.int32), ("touched", np.int32)),  # links that it brings together, or -1
        ("duration", np.float64),
    ],
    align=True,
)


class FieldTable(NamedTuple):
    """All fields of a task; see the dtypes for the columns."""

    fields: Records  # FIELD (f,)
    claims: NDArray[np.bool_]  # (f, nv)
    numbers: FloatArray  # set-point curves, gains and postures, end to end
    reaches: Records  # REACH
    points: Records  # POINT
    guards: Records  # GUARD
    guarded: Records  # GUARDED
    pairs: Records  # PAIR
    capsules: Records  # CAPSULE


class Scratch(NamedTuple):
    """Room for compiled code to work in, one for each thread."""

    weight: FloatArray  # (MOST_KNOTS,)
    rate: FloatArray  # (MOST_KNOTS,)
    angles: FloatArray  # (nv,)
    balls: FloatArray  # (guarded, 3)
    wrenches: FloatArray  # (guarded, 6)
    placed: FloatArray  # (capsules, 7)


def make_scratch(table: FieldTable, threads: int) -> tuple[FloatArray, ...]:
    """Room for each thread, in the order of `Scratch` with the threads in front."""
    guarded, capsules = len(table.guarded), len(table.capsules)
    nv = table.claims.shape[1]
    sizes = ((MOST_KNOTS,), (MOST_KNOTS,), (nv,), (guarded, 3), (guarded, 6), (capsules, 7))
    return tuple(np.zeros((threads, *size)) for size in sizes)


class TableBuilder:
    """Collects the rows of a `FieldTable`."""

    def __init__(self, nv: int) -> None:
        self.nv = nv
        self._fields: list[tuple[int, int, int, int, int, int, float]] = []
        self._claims: list[NDArray[np.bool_]] = []
        self._numbers: list[FloatArray] = []
        self._used = 0
        self._curves: dict[tuple[Profile, tuple[float, ...]], int] = {}
        self._records: dict[np.dtype[np.void], list[Records]] = {
            kind: [] for kind in (REACH, POINT, GUARD, GUARDED, PAIR, CAPSULE)
        }
        self._counts = dict.fromkeys(self._records, 0)

    def field(
        self,
        kind: int,
        row: int,
        claims: IntArray,
        *,
        duration: float = 0.0,
        curve: int = 0,
        knots: int = 0,
        touch: tuple[int, int] = (-1, -1),
    ) -> int:
        """Add a field; returns its number."""
        mask = np.zeros(self.nv, dtype=np.bool_)
        mask[claims] = True
        self._claims.append(mask)
        self._fields.append((kind, row, curve, knots, *touch, duration))
        return len(self._fields) - 1

    def numbers(self, *arrays: FloatArray) -> int:
        """Add numbers; returns where they begin."""
        at = self._used
        for array in arrays:
            flat = np.ravel(array).astype(np.float64)
            self._numbers.append(flat)
            self._used += flat.size
        return at

    def curve(self, profile: Profile, times: tuple[float, ...]) -> int:
        """Add the weights of a set point's knots, once; returns where they begin."""
        key = (profile, times)
        if key not in self._curves:
            self._curves[key] = self.numbers(np.array(times), knot_weights(profile, times))
        return self._curves[key]

    def records(self, rows: Records) -> int:
        """Add rows of one of the record types; returns the number of the first."""
        kept = self._records[rows.dtype]
        at = self._counts[rows.dtype]
        kept.append(rows)
        self._counts[rows.dtype] += len(rows)
        return at

    def build(self) -> FieldTable:
        """The table of everything that was added."""

        def joined(kind: np.dtype[np.void]) -> Records:
            # np.concatenate would promote the type anew for every row.
            rows, at = np.zeros(self._counts[kind], dtype=kind), 0
            for part in self._records[kind]:
                rows[at : at + len(part)] = part
                at += len(part)
            return rows

        claims = np.array(self._claims, dtype=np.bool_).reshape(-1, self.nv)
        return FieldTable(
            fields=np.array(self._fields, dtype=FIELD),
            claims=claims,
            numbers=np.concatenate([*self._numbers, np.zeros(0)]),
            reaches=joined(REACH),
            points=joined(POINT),
            guards=joined(GUARD),
            guarded=joined(GUARDED),
            pairs=joined(PAIR),
            capsules=joined(CAPSULE),
        )


def memory_size(table: FieldTable) -> int:
    """How many numbers a field may remember per simulation."""
    most: int = max(table.claims.shape[1], SINCE + 1, REMEMBERED)
    for field in table.fields:
        if field["kind"] == RHYTHM:
            joints = int(table.numbers[field["row"] + JOINTS])
            most = max(most, 1 + REMEMBERS * joints)
        if field["kind"] == HAND_RHYTHM:
            axes = int(table.numbers[field["curve"] + JOINTS])
            most = max(most, REMEMBERED + 1 + REMEMBERS * axes)
    return most


@compiled
def begin_field(table: FieldTable, f: int, x: Row, memory: FloatArray) -> None:
    """Let field f remember what it needs of the moment in which it is switched on."""
    field = table.fields[f]
    if field.kind in (PD_SERVO, TORQUE_FIELD):
        for j in range(x.qvel.shape[0]):
            at = x.dofs[j].qpos
            memory[j] = x.qpos[at] if at >= 0 else 0.0
    elif field.kind in (IMPEDANCE, ENDPOINT_FORCE):
        begin_reach(x, table.reaches[field.row], memory)
        keep_goal(x, table.reaches[field.row], table.points, field.knots, memory)
    elif field.kind == RHYTHM:
        begin_rhythm(x, table.numbers[field.row :], memory)
    elif field.kind == HAND_RHYTHM:
        begin_hand_rhythm(x, table.reaches[field.row], table.numbers[field.curve :], memory)
    elif field.kind == PURSUIT:
        begin_reach(x, table.reaches[field.row], memory)
        memory[SINCE] = 0.0
    elif field.kind == GAZE:
        begin_gaze(x, looking_at(table.numbers[field.row :]), memory)
    elif field.kind == POINT_ARM:
        begin_pointing(x, pointing_at(table.numbers[field.row :]), memory)


@compiled
def add_movement(
    table: FieldTable,
    f: int,
    x: Row,
    memory: FloatArray,
    share: float,
    pace: float,
    scratch: Scratch,
    out: FloatArray,
) -> None:
    """`add_torque` of a field that moves through knots, at a share of its time."""
    field = table.fields[f]
    nv, knots = out.shape[0], field.knots
    times = table.numbers[field.curve : field.curve + knots]
    at = field.curve + knots
    coefficients = table.numbers[at : at + (knots - 1) * POWERS * knots]
    weight, rate = scratch.weight[:knots], scratch.rate[:knots]
    if field.kind == TORQUE_FIELD:
        own = table.numbers[field.row : field.row + nv * (knots + 2) + knots - 1]
        goal, rest = nv * (knots + 1), nv * (knots + 2)
        weigh_wells(share, times, own[rest + 1 :], weight)
        torque_field(
            x, own[:nv], own[nv : 2 * nv], memory[:nv], own[2 * nv : goal], own[goal:rest],
            own[rest] != 0.0, weight, scratch.angles, out,
        )  # fmt: skip
        return
    weigh_knots(share, times, coefficients, weight, rate)
    for k in range(knots):
        rate[k] = rate[k] / field.duration * pace
    if field.kind == PD_SERVO:
        own = table.numbers[field.row : field.row + nv * (knots + 1)]
        pd_servo(x, own[:nv], own[nv : 2 * nv], memory[:nv], own[2 * nv :], weight, rate, out)
    elif field.kind == IMPEDANCE:
        reach = table.reaches[field.row]
        impedance(x, reach, table.points, memory, share, weight, rate, out)
    else:
        reach = table.reaches[field.row]
        endpoint_force(x, reach, table.points, memory, weight, rate, out)


@compiled
def add_torque(
    table: FieldTable,
    f: int,
    x: Row,
    memory: FloatArray,
    t: float,
    pace: float,
    touches: Records,
    scratch: Scratch,
    out: FloatArray,
) -> None:
    """out += the torques (nv,) [N m] of field f, t seconds after it was switched on.

    Args:
        table: the fields.
        f: which of them; plain fields add nothing here.
        x: the simulation.
        memory: what `begin_field` remembered.
        t: [s]
        pace: of that time: 1, or less when it is slowed down, and set points with it.
        touches: rows of TOUCH, for fields that keep links apart.
        scratch: to work in.
        out: (nv,) [N m]
    """
    field = table.fields[f]
    nv = out.shape[0]
    knots = field.knots
    if field.kind == GAZE:
        looking = looking_at(table.numbers[field.row :])
        gaze(x, looking, table.claims[f], memory, t / field.duration, out)
    elif field.kind == POINT_ARM:
        pointing = pointing_at(table.numbers[field.row :])
        point_arm(x, pointing, memory, t / field.duration, out)
    elif field.kind == PURSUIT:
        reach = table.reaches[field.row]
        memory[SINCE] = t
        place, velocity = moving_point(
            x, reach, table.points, table.numbers[field.curve :], knots, t
        )
        wanted, speed = catch_up(x, reach, place, velocity, memory, t, field.duration)
        force = pull_to(x, reach, wanted, speed)
        pull_hand(x, reach, memory, t / field.duration, force, out)
    elif field.kind == LOOSE:
        own = table.numbers[field.row : field.row + nv + 3]
        hang_loose(x, own[:nv], own[nv:], table.claims[f], scratch.angles, out)
    elif field.kind in (PD_SERVO, TORQUE_FIELD, IMPEDANCE, ENDPOINT_FORCE):
        add_movement(table, f, x, memory, t / field.duration, pace, scratch, out)
    elif field.kind == GUARDING:
        guard = table.guards[field.row]
        repel(
            x, guard, table.guarded, table.pairs, table.capsules, touches,
            scratch.balls, scratch.wrenches, scratch.placed, out,
        )  # fmt: skip
    elif field.kind == WEIGHT:
        carry_weight(x, table.numbers[field.row : field.row + 3], out)
    elif field.kind == RHYTHM:
        rhythm(x, table.numbers[field.row :], memory, t, field.duration, out)
    elif field.kind == HAND_RHYTHM:
        own = table.numbers[field.curve :]
        swing_hand(
            x, table.reaches[field.row], table.points, own, knots, memory, t, field.duration, out
        )


@compiled
def field_error(table: FieldTable, f: int, x: Row, memory: FloatArray) -> float:
    """Distance of field f from its goal: largest joint error or angle [rad], palm to goal [m].

    A servo whose movement never ends stays where it began. NaN if the field has no goal.
    """
    field = table.fields[f]
    nv = x.qvel.shape[0]
    if field.kind in (PD_SERVO, TORQUE_FIELD):
        goal = table.numbers[field.row + nv * field.knots : field.row + nv * (field.knots + 1)]
        worst = 0.0
        for j in range(nv):
            if table.claims[f, j]:
                wanted = memory[j] if np.isinf(field.duration) else goal[j]
                worst = max(worst, abs(x.qpos[x.dofs[j].qpos] - wanted))
        return worst
    if field.kind in (IMPEDANCE, ENDPOINT_FORCE):
        reach = table.reaches[field.row]
        p = table.points[reach.points + field.knots - 2]
        gap = subtract(to_world(x, p.link, vector(p.point)), palm_position(x, reach))
        return float(np.sqrt(dot(gap, gap)))
    if field.kind == PURSUIT:
        reach = table.reaches[field.row]
        knots = table.numbers[field.curve :]
        place, _ = moving_point(x, reach, table.points, knots, field.knots, memory[SINCE])
        return pursuit_error(x, reach, place)
    if field.kind == GAZE:
        return gaze_error(x, looking_at(table.numbers[field.row :]))
    if field.kind == POINT_ARM:
        return pointing_error(x, pointing_at(table.numbers[field.row :]))
    return np.nan


@compiled
def touch_of(table: FieldTable, f: int, t: float, touch: Record) -> bool:
    """Fill in `touch` if field f brings a hand to a link; its share grows with the set point."""
    field = table.fields[f]
    if field.touched < 0:
        return False
    touch.hand, touch.link = field.hand, field.touched
    touch.share = minimum_jerk(t / field.duration)
    return True


__all__ = [
    "FIELD",
    "PLAIN",
    "TOUCH",
    "FieldTable",
    "Scratch",
    "TableBuilder",
    "add_torque",
    "begin_field",
    "field_error",
    "make_scratch",
    "memory_size",
    "touch_of",
]

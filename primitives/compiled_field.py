"""A field whose torque is compiled code: rows of the table of fields.

The arbiter puts the rows of all its fields into one table. Used on its own, as here, such a
field is a table of one.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np

from primitives.compiled import Records, compiled, compiled_entry, fingerprint
from primitives.mechanics import Row, dof_table, link_table
from primitives.primitive import BoolArray, FloatArray, IntArray
from primitives.table import (
    TOUCH,
    FieldTable,
    Scratch,
    TableBuilder,
    add_torque,
    begin_field,
    field_error,
    make_scratch,
    memory_size,
)
from sim import Body, State


class CompiledField(ABC):
    """A bound primitive that is rows of a table; also usable by itself as a `Field`."""

    passive: bool = False  # see `Primitive.passive`

    def __init__(self, body: Body, claims: IntArray, unit: str) -> None:
        self.claims = claims
        self.unit = unit
        self._body = body
        self._alone: _Alone | None = None

    @abstractmethod
    def add_to(self, table: TableBuilder) -> int:
        """Add the rows of this field to a table; returns the field's number there."""

    def begin(self, state: State, who: BoolArray) -> None:
        """Remember what is needed of the simulations `who` (n,) in which it is switched on."""
        alone = self._table(state.n)
        _begin(*alone.seen(state), who, alone.memory)

    def torque(self, state: State, t: FloatArray) -> FloatArray:
        """Torques (n, nv) [N m], t (n,) [s] after being switched on."""
        alone, out = self._table(state.n), np.zeros((state.n, self._body.nv))
        _torque(*alone.seen(state), alone.memory, t, NO_TOUCH, alone.room, out)
        return out

    def error(self, state: State) -> FloatArray:
        """Distance (n,) from the goal, in `unit`."""
        alone, out = self._table(state.n), np.zeros(state.n)
        _error(*alone.seen(state), alone.memory, out)
        return out

    def _table(self, n: int) -> "_Alone":
        if self._alone is None:
            builder = TableBuilder(self._body.nv)
            self.add_to(builder)
            self._alone = _Alone(self._body, builder.build())
        self._alone.make_room(n)
        return self._alone


class _Alone:
    """The table, the body's tables and the memory of one field by itself."""

    def __init__(self, body: Body, table: FieldTable) -> None:
        self.table = table
        self.links, self.dofs = link_table(body), dof_table(body)
        self.memory = np.zeros((0, memory_size(table)))
        self.room = make_scratch(table, 1)

    def make_room(self, n: int) -> None:
        """Memory for n simulations; what was remembered of another number of them is forgotten."""
        if len(self.memory) != n:
            self.memory = np.zeros((n, self.memory.shape[1]))

    def seen(self, s: State) -> tuple[object, ...]:
        """The table, and the simulations as a compiled function wants them."""
        arrays = (s.qpos, s.qvel, s.xpos, s.xmat, s.cdof, s.cvel, s.subtree_com)
        return self.table, Row(*arrays, self.links, self.dofs)


NO_TOUCH: Records = np.zeros(0, dtype=TOUCH)


@compiled
def one_of(every: Row, i: int) -> Row:
    """The row of simulation i, from arrays that hold all of them."""
    return Row(
        every.qpos[i], every.qvel[i], every.xpos[i], every.xmat[i], every.cdof[i],
        every.cvel[i], every.com[i], every.links, every.dofs,
    )  # fmt: skip


@compiled
def begin_all(table: FieldTable, x: Row, who: BoolArray, memory: FloatArray) -> None:
    """`begin_field` in some simulations."""
    for i in range(len(x.qpos)):
        if who[i]:
            begin_field(table, 0, one_of(x, i), memory[i])


@compiled
def torque_all(
    table: FieldTable,
    x: Row,
    memory: FloatArray,
    t: FloatArray,
    touches: Records,
    room: tuple[FloatArray, ...],
    out: FloatArray,
) -> None:
    """`add_torque` in all simulations."""
    scratch = Scratch(room[0][0], room[1][0], room[2][0], room[3][0], room[4][0], room[5][0])
    for i in range(len(x.qpos)):
        add_torque(table, 0, one_of(x, i), memory[i], t[i], 1.0, touches, scratch, out[i])


@compiled
def error_all(table: FieldTable, x: Row, memory: FloatArray, out: FloatArray) -> None:
    """`field_error` in all simulations."""
    for i in range(len(x.qpos)):
        out[i] = field_error(table, 0, one_of(x, i), memory[i])


def _make(code: str) -> tuple[Callable[..., None], Callable[..., None], Callable[..., None]]:
    """Entry points of the three; `code` is the fingerprint that they capture."""

    @compiled_entry
    def begin(table, x, who, memory):  # type: ignore[no-untyped-def]
        len(code)
        begin_all(table, x, who, memory)

    @compiled_entry
    def torque(table, x, memory, t, touches, room, out):  # type: ignore[no-untyped-def]
        len(code)
        torque_all(table, x, memory, t, touches, room, out)

    @compiled_entry
    def error(table, x, memory, out):  # type: ignore[no-untyped-def]
        len(code)
        error_all(table, x, memory, out)

    return begin, torque, error


_begin, _torque, _error = _make(fingerprint())

"""A field whose torque is compiled code: rows of the table of fields.

The arbiter puts the rows of all its fields into one table. Used on its own, as here, such a
field is a table of one.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np

from primitives.compiled import Records, compiled_entry, fingerprint
from primitives.mechanics import Row, dof_table, link_table
from primitives.primitive import BoolArray, FloatArray, IntArray
from primitives.table import (
    MOST_KNOTS,
    TOUCH,
    FieldTable,
    TableBuilder,
    add_torque,
    begin_field,
    field_error,
    memory_size,
)
from sim import Body, State


class CompiledField(ABC):
    """A bound primitive that is rows of a table; also usable by itself as a `Field`."""

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
        alone = self._table()
        if alone.memory.shape[0] != state.n:
            alone.memory = np.zeros((state.n, memory_size(self._body.nv)))
        _begin(alone.table, *_arrays(state), alone.links, alone.dofs, who, alone.memory)

    def torque(self, state: State, t: FloatArray) -> FloatArray:
        """Torques (n, nv) [N m], t (n,) [s] after being switched on."""
        alone, out = self._table(), np.zeros((state.n, self._body.nv))
        _torque(
            alone.table, *_arrays(state), alone.links, alone.dofs, alone.memory, t, NO_TOUCH, out
        )
        return out

    def error(self, state: State) -> FloatArray:
        """Distance (n,) from the goal, in `unit`."""
        alone, out = self._table(), np.zeros(state.n)
        _error(alone.table, *_arrays(state), alone.links, alone.dofs, out)
        return out

    def _table(self) -> "_Alone":
        if self._alone is None:
            builder = TableBuilder(self._body.nv)
            self.add_to(builder)
            self._alone = _Alone(self._body, builder.build())
        return self._alone


class _Alone:
    """The table, the body's tables and the memory of one field by itself."""

    def __init__(self, body: Body, table: FieldTable) -> None:
        self.table = table
        self.links, self.dofs = link_table(body), dof_table(body)
        self.memory = np.zeros((0, memory_size(body.nv)))


def _arrays(s: State) -> tuple[FloatArray, ...]:
    return s.qpos, s.qvel, s.xpos, s.xmat, s.cdof, s.subtree_com


NO_TOUCH: Records = np.zeros(0, dtype=TOUCH)


def _make(code: str) -> tuple[Callable[..., None], Callable[..., None], Callable[..., None]]:
    """The three loops over simulations; `code` is the fingerprint that they capture."""

    @compiled_entry
    def begin(table, qpos, qvel, xpos, xmat, cdof, com, links, dofs, who, memory):  # type: ignore[no-untyped-def]
        len(code)
        for i in range(len(qpos)):
            if who[i]:
                x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], com[i], links, dofs)
                begin_field(table, 0, x, memory[i])

    @compiled_entry
    def torque(table, qpos, qvel, xpos, xmat, cdof, com, links, dofs, memory, t, none, out):  # type: ignore[no-untyped-def]
        len(code)
        scratch = np.zeros((2, MOST_KNOTS))
        for i in range(len(qpos)):
            x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], com[i], links, dofs)
            add_torque(table, 0, x, memory[i], t[i], none, scratch, out[i])

    @compiled_entry
    def error(table, qpos, qvel, xpos, xmat, cdof, com, links, dofs, out):  # type: ignore[no-untyped-def]
        len(code)
        for i in range(len(qpos)):
            x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], com[i], links, dofs)
            out[i] = field_error(table, 0, x)

    return begin, torque, error


_begin, _torque, _error = _make(fingerprint())

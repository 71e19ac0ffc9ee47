"""Fields with a goal that can be protected from others: how fast they move it, joint by joint.

The Jacobian of a servo is that of its joints; of a reach or a pursuit, that of the palm. Strict
priorities hold on to these rows.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records, compiled, compiled_entry, fingerprint
from primitives.compiled_field import CompiledField, one_of
from primitives.impedance import palm_position
from primitives.mechanics import Row, Vector, cross, push_link, subtract, tree_centre
from primitives.primitive import FloatArray
from primitives.table import ENDPOINT_FORCE, IMPEDANCE, PD_SERVO, PURSUIT, TORQUE_FIELD, FieldTable
from sim import State


def most_rows(nv: int) -> int:
    """How many rows the Jacobian of a field has at most."""
    return max(nv, 6)


class GoalField(CompiledField):
    """A compiled field that has a Jacobian."""

    def jacobian(self, state: State) -> FloatArray:
        """Of what it controls, (n, rows, nv): its joints; or the palm, its turn below its place.

        The turn is left out where the palm may turn as it likes.
        """
        alone = self._table(state.n)
        rows = np.zeros((state.n, most_rows(self._body.nv), self._body.nv))
        count = _jacobian(*alone.seen(state), rows)
        return rows[:, :count]


@compiled
def goal_rows(
    fields: Records, claims: NDArray[np.bool_], reaches: Records, f: int, x: Row, rows: FloatArray
) -> int:
    """Write the Jacobian of field f into the first of `rows`; returns how many, 0 without a goal.

    Args:
        fields: FIELD, of a table.
        claims: its own.
        reaches: its own.
        f: which field.
        x: the simulation.
        rows: (`most_rows`, nv) out.
    """
    kind, count = fields[f].kind, 0
    if kind in (PD_SERVO, TORQUE_FIELD):
        for j in range(rows.shape[1]):
            if claims[f, j]:
                clear(rows[count])
                rows[count, j] = 1.0
                count += 1
    elif kind in (IMPEDANCE, ENDPOINT_FORCE, PURSUIT):
        reach = reaches[fields[f].row]
        arm = subtract(palm_position(x, reach), tree_centre(x, reach.hand))
        for k in range(3):
            clear(rows[count])
            push_link(x, reach.hand, cross(arm, axis(k)), axis(k), rows[count])
            count += 1
        for k in range(3 if reach.turns_palm or reach.turns_fingers else 0):
            clear(rows[count])
            push_link(x, reach.hand, axis(k), (0.0, 0.0, 0.0), rows[count])
            count += 1
    return count


@compiled
def clear(row: FloatArray) -> None:
    """row = 0."""
    for j in range(row.shape[0]):
        row[j] = 0.0


@compiled
def axis(k: int) -> Vector:
    """The k-th axis of the world."""
    return 1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0


@compiled
def rows_of_all(table: FieldTable, x: Row, rows: FloatArray) -> int:
    """`goal_rows` of a field by itself in all simulations."""
    count = 0
    for i in range(len(x.qpos)):
        count = goal_rows(table.fields, table.claims, table.reaches, 0, one_of(x, i), rows[i])
    return count


def _make(code: str) -> Callable[..., int]:
    @compiled_entry
    def jacobian(table, x, rows):  # type: ignore[no-untyped-def]
        """See `rows_of_all`."""
        len(code)
        return rows_of_all(table, x, rows)

    return jacobian


_jacobian = _make(fingerprint())

__all__ = ["GoalField", "clear", "goal_rows", "most_rows"]

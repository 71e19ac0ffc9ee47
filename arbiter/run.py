"""A run: everything that the compiled step works on besides the state, as one argument.

Unpacking arguments is most of what a compiled call costs at n = 1, and an array costs as much
as this whole structure.
"""

from typing import Any, NamedTuple

from numba import types
from numba.experimental import structref

from primitives.compiled import Records


class Parts(NamedTuple):
    """The arrays of a run."""

    # The body, and the fields of the task: see `primitives.mechanics` and `primitives.table`.
    links: Records
    dofs: Records
    fields: Records
    claims: Records
    numbers: Records
    reaches: Records
    points: Records
    guards: Records
    guarded: Records
    pairs: Records
    capsules: Records
    # The graph: see `plan`.
    gives_way: Records  # (backgrounds,)
    nodes: Records
    others: Records
    roots: Records
    conditions: Records
    ease: Records  # (1,) in which a pause stops the task's time [s]
    # What changes, one row for each simulation.
    course: Records  # (n,) COURSE: the task's clock, and who waits to begin
    events: Records  # (n, events) when each was sent last; infinite: since the last step [s]
    live: Records  # (n,) how many sub-tasks are on; -1 before the first step
    slots: Records  # (n, slots) SLOT: which they are
    log: Records  # (n, sub-tasks) LOG: how far each has come
    rounds: Records  # (n, rounds) ROUND: what was done before it was done over
    memory: Records  # (n, fields on + 1, m) what fields remember; the last row is the arbiter's
    touches: Records  # (n, slots + 1) TOUCH: room to say which hands are to touch what
    plain: Records  # (n, plain fields, nv) torques of primitives in plain Python [N m]
    plain_error: Records  # (n, plain fields)
    contribution: Records  # (n, fields on, nv) if they are kept, else (0, 0, nv) [N m]
    activation: Records  # the same, what each is worth on each joint
    torque: Records  # (n, nv) [N m]
    # How the simulations are shared out over threads, and room for each share to work in.
    shares: Records  # (shares + 1,) where each begins
    weight: Records  # (shares, fields on + 1, nv)
    asked: Records  # (shares, fields on, nv) [N m]
    knot_weight: Records  # these six: see `make_scratch`
    knot_rate: Records
    angles: Records
    balls: Records
    wrenches: Records
    placed: Records


@structref.register
class RunType(types.StructRef):
    """The type of a run, for the compiler."""

    def preprocess_fields(self, fields: Any) -> Any:
        """Forget literal values: only the types of the arrays matter."""
        return tuple((name, types.unliteral(kind)) for name, kind in fields)


class Run(structref.StructRefProxy):
    """`Parts` as one argument."""

    def __new__(cls, parts: Parts) -> Any:
        """Gather the arrays."""
        return structref.StructRefProxy.__new__(cls, *parts)


structref.define_proxy(Run, RunType, Parts._fields)

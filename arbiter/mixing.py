"""What the groups of a task work on besides the state, as one argument: see `run`."""

from typing import Any, NamedTuple

from numba import types
from numba.experimental import structref

from primitives.compiled import Records


class Mixing(NamedTuple):
    """The arrays of a combination."""

    # The body: see `primitives.mechanics` and `dynamics`.
    links: Records
    dofs: Records
    lumps: Records
    joints: Records  # INERT
    # The fields: see `primitives.table`.
    fields: Records
    claims: Records
    reaches: Records
    # The groups, inner ones first.
    groups: Records  # GROUP
    gains: Records  # (members of all groups,)
    belongs: Records  # (groups, fields) which member of a group a field is part of, or -1
    counts: Records  # (fields, nv) where a field counts: where it claims, or everywhere
    fade: Records  # (1,) in which another becomes dominant [s]
    # The arbiter's own: see `run`.
    backgrounds: Records  # (1,) how many primitives are in the background
    slots: Records
    live: Records
    contribution: Records
    activation: Records
    torque: Records
    # What changes, one row for each simulation.
    dominance: Records  # (n, members of all groups)
    clock: Records  # (n,) time of the last step [s]
    # Jacobians of fields that are plain Python.
    given: Records  # (n, plain fields, rows, nv)
    given_rows: Records  # (plain fields,) how many of them there are
    # How the simulations are shared out over threads, and room for each share to work in.
    shares: Records  # (shares + 1,)
    mass: Records  # (shares, nv, nv)
    whole: Records  # (shares, nbody, 10)
    worth: Records  # (shares, members of a group, nv)
    rows: Records  # (shares, rows, nv)
    held: Records  # (shares, most, nv) these three: see `priorities`
    answers: Records  # (shares, most, nv)
    firmness: Records  # (shares, most)


@structref.register
class MixType(types.StructRef):
    """The type of a combination's arrays, for the compiler."""

    def preprocess_fields(self, fields: Any) -> Any:
        """Forget literal values: only the types of the arrays matter."""
        return tuple((name, types.unliteral(kind)) for name, kind in fields)


class Mix(structref.StructRefProxy):
    """`Mixing` as one argument."""

    def __new__(cls, parts: Mixing) -> Any:
        """Gather the arrays."""
        return structref.StructRefProxy.__new__(cls, *parts)


structref.define_proxy(Mix, MixType, Mixing._fields)

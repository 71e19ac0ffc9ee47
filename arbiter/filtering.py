"""What the safety filter works on besides the state, as one argument: see `run`."""

from typing import Any, NamedTuple

from numba import types
from numba.experimental import structref

from primitives.compiled import Records


class Filtering(NamedTuple):
    """The arrays of a safety filter."""

    # The body: see `primitives.mechanics`, `dynamics`, `barriers` and `primitives.repulsion`.
    links: Records
    dofs: Records
    lumps: Records
    joints: Records
    guarded: Records
    pairs: Records
    brushing: Records
    capsules: Records
    # The arbiter's own.
    touches: Records  # (n, slots + 1) TOUCH: which hands are to touch what
    live: Records  # (n,) how many sub-tasks are on
    backgrounds: Records  # (1,) how many primitives are in the background
    contribution: Records  # (n, channels + 1, nv), the last is the filter's; or (0, 0, nv) [N m]
    torque: Records  # (n, nv) [N m]
    # What it remembers, one row for each simulation.
    applied: Records  # (n, nv) torque of the last step [N m]
    passive: Records  # (n, nv) -bias - damping of the last step [N m]
    besides: Records  # (n, nv) what acted besides [N m]
    before: Records  # (n, nv) speeds at the last step [rad/s]
    clock: Records  # (n,) time of the last step [s]
    # The limits that are near, and what they ask of the torque: rows . u >= lower, u being the
    # change as a share of the torque limits. Only those that it runs into have a row.
    near: Records  # (n, most, NEAR)
    found: Records  # (n,) how many are near
    rows: Records  # (n, most, nv)
    upper: Records  # (n, nv + most) first of u itself
    lower: Records  # (n, nv + most)
    cost: Records  # (n, nv, nv) of u
    count: Records  # (n,) how many rows; 0 where the torque may stay as it is
    # How the simulations are shared out over threads, and room for each share to work in.
    shares: Records  # (shares + 1,)
    mass: Records  # (shares, nv, nv)
    whole: Records  # (shares, nbody, 10)
    moving: Records  # (shares, nv, 18)
    work: Records  # (shares, nv)
    help: Records  # (shares, nv)
    balls: Records  # (shares, guarded, 7)
    placed: Records  # (shares, capsules, 7)


@structref.register
class FilterType(types.StructRef):
    """The type of a filter's arrays, for the compiler."""

    def preprocess_fields(self, fields: Any) -> Any:
        """Forget literal values: only the types of the arrays matter."""
        return tuple((name, types.unliteral(kind)) for name, kind in fields)


class Filter(structref.StructRefProxy):
    """`Filtering` as one argument."""

    def __new__(cls, parts: Filtering) -> Any:
        """Gather the arrays."""
        return structref.StructRefProxy.__new__(cls, *parts)


structref.define_proxy(Filter, FilterType, Filtering._fields)

"""Primitive: the parameters of a behavior, exactly as a task file writes them.

A primitive becomes a torque field when it is bound to a body. To write one of your own,
give it parameters and a torque:

    class Damp(Primitive):
        '''Resist motion as if under water.'''
        kind: Literal["damp"] = "damp"
        viscosity: float = 2.0  # [N m s/rad]

        def torque(self, state, t):
            return -self.viscosity * state.qvel

One that needs names resolved or has to remember something overrides `bind` and returns a
`Field` of its own.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Protocol, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from primitives.errors import PrimitiveError
from sim import Body, State

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int32]

NO_JOINTS: IntArray = np.zeros(0, dtype=np.int32)


class Field(Protocol):
    """A bound primitive: which joint torques it would like, in n simulations at once."""

    claims: IntArray  # degrees of freedom that it wants for itself; none: it only adds
    unit: str  # of `error`; "" when it has no goal

    def begin(self, state: State, who: BoolArray) -> None:
        """Remember what is needed of the simulations `who` (n,) in which it is switched on."""

    def torque(self, state: State, t: FloatArray) -> FloatArray:
        """Torques (n, nv) [N m], t (n,) [s] after being switched on."""

    def error(self, state: State) -> FloatArray:
        """Distance (n,) from the goal, in `unit`; NaN when it has none."""


class Primitive(BaseModel):
    """A behavior with its parameters: frozen, validated, the same in YAML and in Python."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    kind: str

    # Parameters that name the part of the body which a report lists as the limb.
    limb_parameters: ClassVar[Sequence[str]] = ("limb", "joints")

    # Whether it only stores and dissipates energy once its set point has arrived: around a closed
    # path of its joints it does no work on the body. A field of one's own has it instead.
    passive: ClassVar[bool] = False

    def at_tempo(self, tempo: float, changes: Sequence[tuple[float, float]] = ()) -> Self:
        """The same with whatever it says in beats said in seconds.

        A task asks this before it binds. Most primitives say nothing in beats.

        Args:
            tempo: when it begins [beats/min].
            changes: later tempos: so many beats after it began, so many beats per minute. Given
                only by a task whose tempo changes.
        """
        return self

    def bind(self, body: Body, duration: float) -> Field:
        """The torque field of this primitive on a body.

        Args:
            body: where its names are looked up.
            duration: time that the sub-task is given [s]; infinite in the background.

        Raises:
            BodyError: a name that the body lacks.
            PrimitiveError: parameters that mean nothing on this body, or no torque.
        """
        if type(self).torque is Primitive.torque:
            raise PrimitiveError(
                f"{type(self).__name__} makes no torque: it needs a method torque(self, state, t),"
                " or a bind of its own"
            )
        return PlainField(self)

    def torque(self, state: State, t: FloatArray) -> FloatArray:
        """Torques (n, nv) [N m]; t (n,) is the time since the primitive was switched on [s]."""
        raise NotImplementedError(f"the torque of {type(self).__name__} is that of its field")


class PlainField:
    """The field of a primitive that is nothing but a torque: no claims, no memory, no goal."""

    claims = NO_JOINTS
    unit = ""

    def __init__(self, primitive: Primitive) -> None:
        self._primitive = primitive
        self.passive = primitive.passive

    def begin(self, state: State, who: BoolArray) -> None:
        """Nothing to remember."""

    def torque(self, state: State, t: FloatArray) -> FloatArray:
        """The torque of the primitive."""
        return self._primitive.torque(state, t)

    def error(self, state: State) -> FloatArray:
        """It has no goal."""
        return np.full(state.n, np.nan)


Parameters = dict[str, Any]

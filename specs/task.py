"""A task: sub-tasks in an order, the primitive that does each, and what runs beside them."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, SerializeAsAny, model_validator

from primitives import Primitive
from specs.errors import SpecError

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", max_length=100)]
Positive = Annotated[float, Field(gt=0, le=1e6)]
NonNegative = Annotated[float, Field(ge=0, le=1e6)]


class _Doing(BaseModel):
    """Something that a primitive does. In a file the primitive's parameters stand beside it.

        {name: wave, primitive: oscillate, limb: right_arm}

    is in Python `SubTask(name="wave", does=Oscillate(limb="right_arm"))`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: Name
    does: SerializeAsAny[Primitive]


class Background(_Doing):
    """A primitive that is on all the time; on the joints that a sub-task claims it gives way."""


class SubTask(_Doing):
    """One step of a task."""

    words: str = ""  # what one would say to a person
    beats: Positive | None = None  # how long it takes; one beat by default
    seconds: Positive | None = None  # the same in seconds
    after: tuple[Name, ...] | None = None  # what must be over before; default: the one above
    done: Literal["on-time", "reached"] = "on-time"  # when it is over
    tolerance: Positive | None = None  # what counts as reached, in the primitive's unit
    timeout: Positive | None = None  # [s] after which one that waits to be reached gives up
    hand_over: NonNegative | None = None  # [s] cross-fade from what moved its joints before

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.beats is not None and self.seconds is not None:
            raise ValueError("give beats or seconds, not both")
        if self.done == "reached" and (self.tolerance is None or self.timeout is None):
            raise ValueError("done: reached needs a tolerance and a timeout")
        if self.done == "on-time" and (self.tolerance is not None or self.timeout is not None):
            raise ValueError("tolerance and timeout go with done: reached")
        return self


class TaskSpec(BaseModel):
    """A whole task, as a task file writes it."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    task: Name
    title: str = ""
    source: str = ""  # where the words come from
    tempo: Annotated[float, Field(ge=1, le=1000)] = 60.0  # beats per minute
    start: str | None = None  # posture of the body to begin in; default: its home
    hand_over: NonNegative = 0.1  # [s] cross-fade between sub-tasks that claim the same joints
    coda: NonNegative = 1.0  # beats for which the last goals are held
    safety: Literal["none", "filter"] = "none"  # what comes after all torques are summed
    background: tuple[Background, ...] = ()
    subtasks: Annotated[tuple[SubTask, ...], Field(min_length=1)]

    def seconds(self, beats: float) -> float:
        """Duration of so many beats [s]."""
        return beats * 60.0 / self.tempo

    def duration(self, subtask: SubTask) -> float:
        """How long a sub-task takes [s]."""
        if subtask.seconds is not None:
            return subtask.seconds
        return self.seconds(1.0 if subtask.beats is None else subtask.beats)

    def fade(self, subtask: SubTask) -> float:
        """How long the hand-over to a sub-task takes [s]: never longer than the sub-task."""
        asked = self.hand_over if subtask.hand_over is None else subtask.hand_over
        return min(asked, self.duration(subtask))


def with_tempo(spec: TaskSpec, tempo: float) -> TaskSpec:
    """The same task at another tempo [beats/min].

    Raises:
        SpecError: no such tempo.
    """
    if not 1.0 <= tempo <= 1000.0:
        raise SpecError(f"a tempo is between 1 and 1000 beats per minute, not {tempo:g}")
    return spec.model_copy(update={"tempo": tempo})

"""A task: sub-tasks in an order, the primitive that does each, and what runs beside them."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, SerializeAsAny, model_validator

from primitives import GoToPoint, Primitive, Quantity
from specs.conditions import Condition, Join, Name, Positive, Repeat, Times
from specs.definitions import Landmark, NamedPosture
from specs.errors import SpecError
from specs.firmness import Firmness
from specs.groups import Group
from specs.scene import SceneObject
from specs.tempo import MOST_STEPS, Tempo, TempoStep

NonNegative = Annotated[float, Field(ge=0, le=1e6)]
Fade = Annotated[NonNegative, Quantity.TIME]
Time = Annotated[Positive, Quantity.TIME]


class _Doing(BaseModel):
    """Something that a primitive does. In a file the primitive's parameters stand beside it.

        {name: wave, primitive: oscillate, limb: right_arm}

    is in Python `SubTask(name="wave", does=Oscillate(limb="right_arm"))`.
    """

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True
    )

    name: Name  # what it is called
    does: SerializeAsAny[Primitive]


class Background(_Doing):
    """A primitive that is on all the time; on the joints that a sub-task claims it gives way."""


class SubTask(_Doing):
    """One step of a task."""

    words: str = ""  # what one would say to a person
    beats: Positive | None = None  # how long it takes; one beat by default
    seconds: Time | None = None  # the same in seconds
    after: tuple[Name, ...] | Join | None = None  # what must be over before; default: one above
    while_: Annotated[Name | None, Field(alias="while")] = None  # on as long as this one is on
    if_: Annotated[Condition | None, Field(alias="if")] = None  # else it is skipped
    done: Literal["on-time", "reached"] | Condition = "on-time"  # when it is over
    tolerance: Positive | None = None  # what counts as reached, in the primitive's unit
    timeout: Time | None = None  # [s] after which one that waits for something gives up
    otherwise: Name | None = None  # what begins instead when it gave up, or `if` did not hold
    repeat: Times | Repeat = 1  # how often it is done
    hand_over: Fade | None = None  # [s] cross-fade from what moved its joints before

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.beats is not None and self.seconds is not None:
            raise ValueError("give beats or seconds, not both")
        if self.done == "reached" and (self.tolerance is None or self.timeout is None):
            raise ValueError("done: reached needs a tolerance and a timeout")
        if self.done == "on-time" and (self.tolerance is not None or self.timeout is not None):
            raise ValueError("tolerance and timeout go with done: reached")
        if isinstance(self.done, Condition) and self.tolerance is not None:
            raise ValueError("tolerance goes with done: reached")
        if isinstance(self.done, Condition) and self.timeout is None:
            raise ValueError("done: a condition needs a timeout")
        reasons = (self.timeout, self.if_, self.until)
        if self.otherwise is not None and all(reason is None for reason in reasons):
            raise ValueError("otherwise goes with a timeout, with if, or with repeat: until")
        if self.if_ is not None and self.first is not None:
            raise ValueError(
                "what ends a repeated chain has no 'if': it would not know when to end"
            )
        if self.while_ is not None and not self._only_while:
            raise ValueError("while goes without after, if, done, otherwise and repeat")
        return self

    @property
    def _only_while(self) -> bool:
        others = (self.after, self.if_, self.otherwise)
        return others == (None, None, None) and self.done == "on-time" and self.repeat == 1

    @property
    def lacks_way(self) -> bool:
        """Whether it brings a hand to a place and says nothing of the way."""
        return isinstance(self.does, GoToPoint) and not self.does.via

    @property
    def until(self) -> Condition | None:
        """What it is repeated until."""
        return self.repeat.until if isinstance(self.repeat, Repeat) else None

    @property
    def first(self) -> str | None:
        """What it repeats everything from, if that is not itself."""
        return self.repeat.from_ if isinstance(self.repeat, Repeat) else None

    @property
    def times(self) -> int:
        """How often it is done, at most."""
        return self.repeat.times if isinstance(self.repeat, Repeat) else self.repeat

    @property
    def policy(self) -> str:
        """How many of those that it comes after must be over: `all`, `any` or `first`."""
        return self.after.policy if isinstance(self.after, Join) else "all"

    @property
    def conditions(self) -> dict[str, Condition]:
        """Its conditions, by the key that they stand under."""
        done = self.done if isinstance(self.done, Condition) else None
        given = {"if": self.if_, "done": done, "repeat": self.until}
        return {key: condition for key, condition in given.items() if condition is not None}

    @property
    def depends(self) -> bool:
        """Whether it is not known beforehand when it begins or ends."""
        waits = self.done != "on-time" or self.policy != "all" or self.otherwise is not None
        return waits or bool(self.conditions)

    @property
    def circumstances(self) -> str:
        """Its conditions in words; nothing for one that is simply done."""
        said = [f"if {self.if_}"] if self.if_ else []
        if self.while_:
            said.append(f"while {self.while_}")
        if self.done != "on-time":
            said.append(f"until {self.done}")
        whence = f" from {self.first}" if self.first else ""
        if self.until:
            said.append(f"repeated{whence} until {self.until}, at most {self.times} times")
        elif self.times > 1:
            said.append(
                f"repeated{whence}, {self.times} times" if whence else f"{self.times} times"
            )
        return ", ".join(said)


def keys_of(model: type[BaseModel]) -> dict[str, str]:
    """The names of a model's fields by the keys that a task file uses."""
    return {field.alias or name: name for name, field in model.model_fields.items()}


class TaskSpec(BaseModel):
    """A whole task, as a task file writes it."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    task: Name  # what it is called
    title: str = ""  # the same for people
    source: str = ""  # where the words come from
    # whose metres and seconds it is written in; on another body they are scaled; default: on any
    # body they are as they stand
    body: str | None = None
    tempo: Tempo = 60.0  # beats per minute
    tempo_map: Annotated[tuple[TempoStep, ...], Field(max_length=MOST_STEPS)] = ()  # later tempos
    start: str | None = None  # posture of the body to begin in; default: its home
    hand_over: Fade = 0.1  # [s] cross-fade between sub-tasks that claim the same joints
    coda: NonNegative = 1.0  # beats for which the last goals are held
    gains: Firmness | None = None  # how firmly the body holds itself: factors of its own gains
    safety: Literal["none", "filter"] = "none"  # what comes after all torques are summed
    # whether ways of hands that it says nothing of are to be found first
    rehearse: bool = False
    scene: dict[Name, SceneObject] = {}  # objects to touch and to follow
    landmarks: dict[Name, Landmark] = {}  # of this task, beside the body's
    postures: dict[Name, NamedPosture] = {}  # of this task, beside the body's
    background: tuple[Background, ...] = ()  # what is on all the time
    groups: tuple[Group, ...] = ()  # what is combined by another rule than the sum
    # what is done, one after the other unless `after` says otherwise
    subtasks: Annotated[tuple[SubTask, ...], Field(min_length=1)]


def with_tempo(spec: TaskSpec, tempo: float) -> TaskSpec:
    """The same task at another tempo [beats/min]; what its tempo map says changes in proportion.

    Raises:
        SpecError: no such tempo.
    """
    share = tempo / spec.tempo
    later = [step.tempo * share for step in spec.tempo_map]
    for asked in (tempo, *later):
        if not 1.0 <= asked <= 1000.0:
            raise SpecError(f"a tempo is between 1 and 1000 beats per minute, not {asked:g}")
    steps = tuple(
        step.model_copy(update={"tempo": changed})
        for step, changed in zip(spec.tempo_map, later, strict=True)
    )
    return spec.model_copy(update={"tempo": tempo, "tempo_map": steps})

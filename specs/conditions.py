"""Conditions: what a sub-task may wait for, depend on, or be repeated until.

{event: NAME}                                     somebody sent it: `arbiter.send(NAME)`
{near: LANDMARK, limb: ARM, distance: METRES}     the palm is that near to the landmark
"""

from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from primitives import Quantity
from sim import Body, Spot

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", max_length=100)]
Positive = Annotated[float, Field(gt=0, le=1e6)]
Times = Annotated[int, Field(ge=1, le=1_000_000, strict=True)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Condition(_Part):
    """An event from outside, or a hand near a landmark."""

    event: Name | None = None  # it has been sent from outside
    near: str | None = None  # a landmark
    limb: str | None = None  # the arm whose palm is to be near
    distance: Annotated[Positive, Quantity.LENGTH] | None = None  # [m]

    @model_validator(mode="after")
    def _one(self) -> Self:
        near = [self.near, self.limb, self.distance]
        if (self.event is None) == all(part is None for part in near):
            raise ValueError(
                "a condition is {event: NAME} or {near: LANDMARK, limb: ARM, distance: METRES}"
            )
        if self.event is None and None in near:
            raise ValueError("near needs a landmark, a limb and a distance")
        return self

    def __str__(self) -> str:
        if self.event is not None:
            return f"event {self.event}"
        return f"{self.limb} within {self.distance:g} m of {self.near}"


class Join(_Part):
    """What a sub-task comes after, and how many of them must be over."""

    all: tuple[Name, ...] | None = None  # all of them
    any: tuple[Name, ...] | None = None  # one; the others run on
    first: tuple[Name, ...] | None = None  # one; the others are ended

    @model_validator(mode="after")
    def _one(self) -> Self:
        given = [names for names in (self.all, self.any, self.first) if names is not None]
        if len(given) != 1 or not given[0]:
            raise ValueError("after takes one of all, any and first, with names of sub-tasks")
        return self

    @property
    def policy(self) -> str:
        """`all`, `any` or `first`."""
        return "all" if self.all else "any" if self.any else "first"

    @property
    def names(self) -> tuple[str, ...]:
        """What it comes after."""
        return self.all or self.any or self.first or ()


class Repeat(_Part):
    """What is done over, and how often: until a condition holds at the end of a round."""

    model_config = ConfigDict(populate_by_name=True)

    from_: Annotated[Name | None, Field(alias="from")] = None  # all from there on; default: itself
    until: Condition | None = None  # that holds at the end of a round
    times: Times  # at most, if it is until something

    @model_validator(mode="after")
    def _says_more(self) -> Self:
        if self.from_ is None and self.until is None:
            raise ValueError(f"write repeat: {self.times}, or say until when or from where")
        return self


@dataclass(frozen=True)
class BoundCondition:
    """A condition on a body, by index."""

    event: int = -1  # which of the task's events; -1 if it is of a hand that is near
    palm: Spot | None = None
    landmark: Spot | None = None
    distance: float = 0.0  # [m]


def bind_condition(condition: Condition, body: Body, events: list[str]) -> BoundCondition:
    """The condition by index; an event that is not yet in the list is added to it.

    Raises:
        BodyError: the body has no such limb or landmark.
    """
    if condition.event is not None:
        if condition.event not in events:
            events.append(condition.event)
        return BoundCondition(event=events.index(condition.event))
    palm = body.arm(condition.limb or "").palm
    landmark = body.landmark(condition.near or "")
    return BoundCondition(palm=palm, landmark=landmark, distance=condition.distance or 0.0)

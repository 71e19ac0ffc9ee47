"""The scene of a task: objects that the body touches, bumps into, or follows.

scene:
  table: {box: [0.4, 0.8, 0.03], at: [0.5, 0, 0.9]}
  ball: {sphere: 0.06, at: {near: table.top, away: 0.06}, moves: [{beat: 4, to: [0.4, 0.1, 1.3]}]}

Their landmarks (`table.edge`, `ball.front`) are used like those of the body. They are what they are
and where they are whatever the body, unless they are said to scale; a place may be said from a
landmark of an object that is written above, or of the body at home.
"""

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from primitives import Quantity
from sim import Body, BodyError, Carry, Thing, furnished, overlap
from sim.furnishing import Shape
from specs.conditions import Name, Positive
from specs.reading import Document, Path_
from specs.tempo import Clock

Length = Annotated[float, Field(gt=0, le=100), Quantity.LENGTH]
Coordinate = Annotated[float, Field(ge=-100, le=100), Quantity.LENGTH]
Place = tuple[Coordinate, Coordinate, Coordinate]
MOST_MOVES = 1000
TOUCHING = 1e-3  # [m] what an object may overlap the body in the beginning


class Beside(BaseModel):
    """A place near a landmark, where that is in the beginning."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    near: str  # a landmark of an object that is written above, or of the body at home
    away: Coordinate = 0.0  # this far out along its normal [m]
    offset: Place = (0.0, 0.0, 0.0)  # added: forward, left, up [m]


class Move(BaseModel):
    """A movement of an object: smooth, along a straight line from where it stands."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    beat: Annotated[float, Field(ge=0, le=1e6)]  # at which it begins
    beats: Positive = 1.0  # how long it takes
    to: Place | Beside  # where its middle then is: forward, left, up from the floor [m]


class SceneObject(BaseModel):
    """An object of the scene."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    box: tuple[Length, Length, Length] | None = None  # lengths in X, Y and Z [m]; or
    sphere: Length | None = None  # radius [m]; or
    cylinder: tuple[Length, Length] | None = None  # upright: radius and height [m]
    at: Place | Beside  # its middle: forward, left, up from the floor below the body [m]
    turn: Annotated[float, Field(ge=-360, le=360)] = 0.0  # about the vertical, to the left [deg]
    # how it is carried, one move after the other; it stands still between them
    moves: Annotated[tuple[Move, ...], Field(max_length=MOST_MOVES)] = ()
    # whether its lengths and places are made to fit another body, like those of the task
    scales: bool = False

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        shapes = {"box": self.box, "sphere": self.sphere, "cylinder": self.cylinder}
        given = [name for name, lengths in shapes.items() if lengths is not None]
        if len(given) != 1:
            said = " and ".join(given) or "none"
            raise ValueError(f"an object has one shape, box, sphere or cylinder, not {said}")
        for early, late in pairwise(self.moves):
            if late.beat < early.beat + early.beats:
                raise ValueError(
                    f"an object makes one move after the other: the one at beat {late.beat:g}"
                    f" begins before that at beat {early.beat:g} is over"
                )
        return self

    @property
    def shape(self) -> tuple[Shape, tuple[float, float, float]]:
        """Its shape, and its lengths along its own axes [m]."""
        if self.box is not None:
            return "box", self.box
        if self.sphere is not None:
            return "sphere", (2.0 * self.sphere,) * 3
        radius, height = self.cylinder or (0.0, 0.0)
        return "cylinder", (2.0 * radius, 2.0 * radius, height)


def furnish(
    scene: Mapping[Name, SceneObject], body: Body, clock: Clock, document: Document
) -> Body:
    """The body beside the objects of a scene.

    Args:
        scene: the objects by name.
        body: that is to meet them.
        clock: of the task, by which they move.
        document: what the task was read from, so that errors can say where.

    Raises:
        SpecError: an object is called like something of the body, or is near nothing that is there.
    """
    for name, given in scene.items():
        path: Path_ = ("scene", name)
        at = _place(given.at, body, document, (*path, "at"))
        carried = []
        for k, move in enumerate(given.moves):
            start = clock.lasts(0.0, move.beat)
            to = _place(move.to, body, document, (*path, "moves", k, "to"))
            carried.append(Carry(start=start, lasts=clock.lasts(start, move.beats), to=to))
        turn = float(np.deg2rad(given.turn))
        try:
            body = furnished(body, Thing(name, *given.shape, at, turn, tuple(carried)))
        except BodyError as problem:
            raise document.error(str(problem), path, key=True) from None
    return body


def _place(said: Place | Beside, body: Body, document: Document, path: Path_) -> Place:
    """A place in the world [m]."""
    if not isinstance(said, Beside):
        return said
    try:
        spot = body.landmark(said.near)
    except BodyError as problem:
        raise document.error(f"{path[1]}: {problem}", (*path, "near")) from None
    point = body.at_home(spot.link, spot.point + said.away * spot.normal) + said.offset
    x, y, z = (float(c) for c in point)
    return x, y, z


def check_room(body: Body, start: NDArray[np.float64], document: Document) -> None:
    """Objects stand beside the body in the beginning, not in it.

    Raises:
        SpecError: one of them overlaps a link in the posture (nq,) in which the task starts.
    """
    for name in body.map.objects:
        link, depth = overlap(body, name, start)
        if depth > TOUCHING:
            raise document.error(
                f"{name} overlaps the {link.replace('_', ' ')} of {body.map.name} by"
                f" {100.0 * depth:.1f} cm in the beginning: place it elsewhere, or make it smaller",
                ("scene", name, "at"),
            )

"""Landmarks and postures that a task defines for itself.

landmarks:
  nose: {near: head.front, away: 0.02, offset: [0, 0, -0.03]}   # beside one that there is
  heart: {between: [chest.front, left_ribs]}                    # halfway, on the surface
postures:
  ready: {from: rest, right_arm: {arm: forward, palm: up}, neck_y: 10}

They become names of the body that the task is bound to, so that primitives, conditions and the
judge need not know where a name comes from.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from primitives import PrimitiveError, Quantity
from primitives.get_posture import said_angles
from primitives.parameters import Direction, Offset
from primitives.primitive import FloatArray
from sim import Body, BodyError, Spot, extended, halfway, unknown
from specs.conditions import Name
from specs.reading import Document, Path_

Metres = Annotated[float, Field(ge=-100, le=100), Quantity.LENGTH]
Degrees = Annotated[float, Field(ge=-3600, le=3600)]


class Landmark(BaseModel):
    """A place on the body: beside a landmark that there is, or halfway between two."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    near: str | None = None  # a landmark of the body, or one that is written above; or
    between: tuple[str, str] | None = None  # two of them: halfway, out to the surface
    away: Metres = 0.0  # this far out along the normal [m]
    offset: Offset = (0.0, 0.0, 0.0)  # added: forward, left, up, as the link is at home [m]

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.near is None) == (self.between is None):
            raise ValueError("give either near (a landmark) or between (two of them)")
        return self

    @property
    def of(self) -> tuple[str, ...]:
        """The landmarks that it is defined by."""
        return self.between or (self.near or "",)


class NamedPosture(BaseModel):
    """Joint angles, of joints or part by part of an arm, on top of a posture that there is."""

    model_config = ConfigDict(
        frozen=True, extra="allow", allow_inf_nan=False, populate_by_name=True
    )
    __pydantic_extra__: dict[str, Degrees | dict[str, float | Direction]]

    from_: Annotated[str | None, Field(alias="from")] = None  # what is not said is as in this one

    @property
    def parts(self) -> dict[str, float | dict[str, float | Direction]]:
        """Degrees of each joint or group of joints, and what is said of each limb."""
        return self.__pydantic_extra__


def define(
    landmarks: Mapping[Name, Landmark],
    postures: Mapping[Name, NamedPosture],
    body: Body,
    document: Document,
) -> Body:
    """The body with what a task defines.

    Raises:
        SpecError: at the name or the value that makes no sense on this body.
    """
    if not landmarks and not postures:
        return body
    spots: dict[str, Spot] = {}
    for name, landmark in landmarks.items():
        path: Path_ = ("landmarks", name)
        _check_new(name, body.map.landmarks, "landmark", body, document, path)
        spots[name] = _spot(landmark, body, spots, document, path)
    angles: dict[str, FloatArray] = {}
    for name, posture in postures.items():
        path = ("postures", name)
        _check_new(name, body.map.postures, "posture", body, document, path)
        angles[name] = _angles(posture, body, angles, document, path)
    try:
        return extended(body, spots, angles)
    except BodyError as problem:
        raise document.error(str(problem), ("landmarks",)) from None


def _check_new(
    name: str, there: Any, what: str, body: Body, document: Document, path: Path_
) -> None:
    if name in there:
        said = f"{name!r} is a {what} of {body.map.name} already: take another name"
        raise document.error(said, path, key=True)


def _spot(
    landmark: Landmark, body: Body, above: Mapping[str, Spot], document: Document, path: Path_
) -> Spot:
    """Where a landmark is."""
    found = []
    for k, name in enumerate(landmark.of):
        if name not in above and name not in body.map.landmarks:
            place = (*path, "near") if landmark.near else (*path, "between", k)
            there = [*above, *body.map.landmarks]
            raise document.error(f"{path[-1]}: {unknown('landmark', name, there)}", place)
        found.append(above[name] if name in above else body.landmark(name))
    try:
        spot = found[0] if len(found) == 1 else halfway(body, *found)
    except BodyError as problem:
        raise document.error(f"{path[-1]}: {problem}", (*path, "between")) from None
    shift = body.to_link(spot.link, np.array(landmark.offset))
    return Spot(spot.link, spot.point + landmark.away * spot.normal + shift, spot.normal)


def _angles(
    posture: NamedPosture,
    body: Body,
    above: Mapping[str, FloatArray],
    document: Document,
    path: Path_,
) -> FloatArray:
    """A posture as joint angles (nv,) [rad]; NaN where it says nothing."""
    angles = np.full(body.nv, np.nan)
    given: dict[int, str] = {}
    if (base := posture.from_) is not None:
        if base not in above and base not in body.map.postures:
            message = unknown("posture", base, [*above, *body.map.postures])
            raise document.error(f"{path[-1]}: {message}", (*path, "from"))
        angles = (above[base] if base in above else body.posture(base)).copy()
    for part, said in posture.parts.items():
        try:
            added = _part(body, part, said)
        except (BodyError, PrimitiveError) as problem:
            at_key = "unknown" in str(problem) and not isinstance(said, dict)
            raise document.error(f"{path[-1]}: {problem}", (*path, part), key=at_key) from None
        for dof in np.flatnonzero(~np.isnan(added)).tolist():
            if dof in given:
                twice = f"{body.dof_name(dof)} is given twice: by {given[dof]!r} and by {part!r}"
                raise document.error(f"{path[-1]}: {twice}", (*path, part), key=True)
            given[dof] = part
        angles = np.where(np.isnan(added), angles, added)
    if np.isnan(angles).all():
        raise document.error(f"{path[-1]}: says nothing: give joints, limbs, or from", path)
    return angles


def _part(body: Body, part: str, said: float | dict[str, float | Direction]) -> FloatArray:
    """The angles (nv,) [rad] of a joint, a group of joints or a limb."""
    if isinstance(said, dict):
        return said_angles(body, body.arm(part).name, tuple(said.items()))
    return body.angles({part: said})


__all__ = ["Landmark", "NamedPosture", "define"]

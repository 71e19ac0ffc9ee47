"""More names for a body: landmarks and postures that a task defines for itself."""

import copy
from collections.abc import Mapping

import mujoco
import numpy as np

from sim.body import Body, FloatArray, Spot
from sim.body_map import BodyMap
from sim.errors import BodyError
from sim.landmarks import Ray, leave, x_along


def extended(body: Body, landmarks: Mapping[str, Spot], postures: Mapping[str, FloatArray]) -> Body:
    """The same body with more names; its physics is the same.

    Args:
        body: what the names are added to.
        landmarks: places and outward normals, by name.
        postures: joint angles (nv,) [rad], NaN where they say nothing, by name.

    Raises:
        BodyError: the model has something else of that name.
    """
    names, spec = body.map, body.spec.copy()
    for name, spot in landmarks.items():
        if name in names.landmarks:
            raise BodyError(f"{name!r} is a landmark of {names.name} already")
        if mujoco.mj_name2id(body.model, mujoco.mjtObj.mjOBJ_SITE, name) >= 0:
            raise BodyError(f"{name!r} is another part of {names.name}")
        spec.bodies[spot.link].add_site(
            name=name, pos=spot.point, quat=x_along(spot.normal), size=[0.006] * 3, group=4
        )
    angles = {name: _degrees(body, q) for name, q in postures.items()}
    for name in angles:
        if name in names.postures:
            raise BodyError(f"{name!r} is a posture of {names.name} already")
    more = {
        "landmarks": (*names.landmarks, *landmarks),
        "postures": {**names.postures, **angles},
    }
    return Body(spec, names.model_copy(update=more))


def renamed(body: Body, names: BodyMap) -> Body:
    """The same model with another body map, which names the same parts."""
    other = copy.copy(body)
    other.map = names
    for known in ("home", "speed_limit", "_at_home"):  # that follow from the map
        vars(other).pop(known, None)
    return other


def halfway(body: Body, one: Spot, other: Spot) -> Spot:
    """The place between two of one link: on its surface, out along their mean normal.

    Where the link has no surface that way, it is the midpoint itself.

    Raises:
        BodyError: they are on links that move apart, or face away from each other.
    """
    if one.link != other.link:
        links = " and ".join(repr(body.model.body(spot.link).name) for spot in (one, other))
        raise BodyError(f"nothing is fixed halfway: they are on two links, {links}")
    normal = one.normal + other.normal
    length = float(np.linalg.norm(normal))
    if length < 1e-3:
        raise BodyError("they face away from each other: no side is halfway")
    middle, normal = 0.5 * (one.point + other.point), normal / length
    found = leave(body.model, Ray("", body.model.body(one.link).name, middle, normal))
    point, normal = found if found is not None else (middle, normal)
    return Spot(one.link, point, normal)


def _degrees(body: Body, angles: FloatArray) -> dict[str, float]:
    """A posture by the names of the joints, as a body map has it [deg]."""
    given = np.flatnonzero(~np.isnan(angles))
    return {body.dof_name(int(dof)): float(np.rad2deg(angles[dof])) for dof in given}

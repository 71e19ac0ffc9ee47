"""Objects of the scene: tables, drums and balls that a body touches and bumps into.

An object is a link of the model that no joint moves: a mocap body. The body cannot push it, and it
may be carried along (see `carrying`). It collides with the body, not with other objects.

Its landmarks come from its shape, so that they follow its size and place. Sides are called as the
body calls them that looks forward: `front` is the near side of what stands before it.
"""

from dataclasses import dataclass, field
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body
from sim.body_map import Carry
from sim.errors import BodyError
from sim.landmarks import x_along

FloatArray = NDArray[np.float64]
Shape = Literal["box", "sphere", "cylinder"]

KINDS: dict[Shape, mujoco.mjtGeom] = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
}
ROUND = (mujoco.mjtGeom.mjGEOM_CAPSULE.value, mujoco.mjtGeom.mjGEOM_SPHERE.value)
FRICTION = 0.3  # of a hand on smooth wood
COLORS = (  # of one object after the other
    *((0.72, 0.56, 0.38, 1.0), (0.83, 0.30, 0.22, 1.0)),
    *((0.24, 0.52, 0.45, 1.0), (0.88, 0.68, 0.24, 1.0)),
)
# Where a landmark is, in halves of the object's lengths, and its outward normal.
SIDES: dict[str, tuple[tuple[float, float, float], tuple[float, float, float]]] = {
    "top": ((0, 0, 1), (0, 0, 1)),
    "bottom": ((0, 0, -1), (0, 0, -1)),
    "front": ((-1, 0, 0), (-1, 0, 0)),
    "back": ((1, 0, 0), (1, 0, 0)),
    "left": ((0, 1, 0), (0, 1, 0)),
    "right": ((0, -1, 0), (0, -1, 0)),
    "centre": ((0, 0, 0), (0, 0, 1)),
    "edge": ((-1, 0, 1), (0, 0, 1)),  # of the top, in front: a hand lies there palm down
}
REACHING = ("hand", "forearm")  # links of a limb that avoid objects


@dataclass(frozen=True)
class Thing:
    """An object of the scene."""

    name: str
    shape: Shape
    lengths: tuple[float, float, float]  # along its own X, Y and Z, of a ball thrice the same [m]
    place: tuple[float, float, float]  # of its middle, in the world [m]
    turn: float = 0.0  # about the vertical, to the left [rad]
    carried: tuple[Carry, ...] = field(default=())  # one after the other

    @property
    def landmarks(self) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Point and outward normal of each, in its own frame."""
        half = 0.5 * np.array(self.lengths)
        return {
            f"{self.name}.{side}": (half * np.array(where), np.array(normal, dtype=float))
            for side, (where, normal) in SIDES.items()
            if side != "edge" or self.shape != "sphere"
        }


def furnished(body: Body, thing: Thing) -> Body:
    """The body with an object beside it: a link, and landmarks of its map.

    Hands and forearms are kept apart from it like links that must not touch.

    Raises:
        BodyError: the body has something of that name.
    """
    names = body.map
    for name in (thing.name, *thing.landmarks):
        if (what := _known(body, name)) is not None:
            raise BodyError(f"{name!r} is a {what} of {names.name}: take another name")
    spec = body.spec.copy()
    _add(spec, thing, COLORS[len(names.objects) % len(COLORS)])
    links = [getattr(limb, part) for limb in names.limbs.values() for part in REACHING]
    more = {
        "landmarks": (*names.landmarks, *thing.landmarks),
        "keep_apart": (*names.keep_apart, *((link, thing.name) for link in dict.fromkeys(links))),
        "objects": {**names.objects, thing.name: thing.carried},
    }
    return Body(spec, names.model_copy(update=more))


def pushed_apart(body: Body) -> tuple[tuple[str, str], ...]:
    """Pairs of links that must not touch, but for objects that distances are not kept from.

    These are boxes and cylinders, which contacts alone keep out of the body.
    """
    edged = {
        name for name in body.map.objects
        if any(body.model.geom_type[g] not in ROUND for g in body.colliding(body.link(name)))
    }  # fmt: skip
    return tuple(pair for pair in body.map.keep_apart if edged.isdisjoint(pair))


def overlap(body: Body, name: str, qpos: FloatArray) -> tuple[str, float]:
    """The link that an object overlaps most in a posture (nq,), and how deep [m]; 0 for none."""
    model, data = body.model, mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(model, data)
    own = body.colliding(body.link(name))
    deepest, where = 0.0, ""
    for link in range(1, model.nbody):
        if model.body(link).name in body.map.objects:
            continue
        for one in own:
            for other in body.colliding(link):
                depth = -mujoco.mj_geomDistance(model, data, one, other, 1.0, None)
                if depth > deepest:
                    deepest, where = float(depth), str(model.body(link).name)
    return where, deepest


def _known(body: Body, name: str) -> str | None:
    """What a name means already."""
    if name in body.map.limbs:
        return "limb"
    if name in body.map.groups:
        return "joint group"
    for what, kind in (
        ("link", mujoco.mjtObj.mjOBJ_BODY),
        ("joint", mujoco.mjtObj.mjOBJ_JOINT),
        ("landmark", mujoco.mjtObj.mjOBJ_SITE),
        ("shape", mujoco.mjtObj.mjOBJ_GEOM),
    ):
        if mujoco.mj_name2id(body.model, kind, name) >= 0:
            return what
    return None


def _add(spec: mujoco.MjSpec, thing: Thing, color: tuple[float, ...]) -> None:
    """Put an object into a model."""
    half = [0.5 * length for length in thing.lengths]
    if thing.shape == "cylinder":
        half = [half[0], half[2], 0.0]
    turned = [float(np.cos(0.5 * thing.turn)), 0.0, 0.0, float(np.sin(0.5 * thing.turn))]
    link = spec.worldbody.add_body(name=thing.name, mocap=True, pos=thing.place, quat=turned)
    link.add_geom(
        name=thing.name,
        type=KINDS[thing.shape],
        size=half,
        rgba=color,
        density=0.0,
        friction=[FRICTION, 0.005, 0.0001],
        conaffinity=0,  # so that objects pass through each other
    )
    for name, (point, normal) in thing.landmarks.items():
        link.add_site(name=name, pos=point, quat=x_along(normal), size=[0.006] * 3, group=4)

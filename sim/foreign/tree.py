"""The moving links of a model as a tree, with everything that is welded to each."""

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.foreign.reading import LEAST_MASS, Source
from sim.foreign.surface import Shape, shapes_of, solid, spread

FloatArray = NDArray[np.float64]

BASE = 0  # the link that carries all others, and does not move
POINTS = 400  # of the surface of each MuJoCo body
MOVING = (mujoco.mjtJoint.mjJNT_HINGE.value, mujoco.mjtJoint.mjJNT_SLIDE.value)


class Tree:
    """Links of a model: a link is a MuJoCo body with joints, and the bodies welded to it.

    A link is called by the index of that body; what is welded to the world, or floats freely,
    is the base. Positions are in the axes of the model's own world [m].

    Args:
        source: the model.
        angles: of joints by name, in the model's own sense [rad or m]; the others as at home.
    """

    def __init__(self, source: Source, angles: Mapping[str, float] | None = None) -> None:
        self.source, self.model = source, source.model
        self.data = mujoco.MjData(self.model)
        self.pose(angles or {})

    def pose(self, angles: Mapping[str, float]) -> None:
        """Put joints at some angles, and all others where they are at home."""
        model = self.model
        self.data.qpos[:] = self.source.home
        for j in range(model.njnt):
            if model.jnt_type[j] not in MOVING:
                at = model.jnt_qposadr[j]
                wide = 7 if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_FREE.value else 4
                self.data.qpos[at : at + wide] = model.qpos0[at : at + wide]
        for name, angle in angles.items():
            self.data.qpos[model.jnt_qposadr[self.joint(name)]] = angle
        mujoco.mj_kinematics(model, self.data)

    # --- what there is -----------------------------------------------------------------------

    @cached_property
    def link_of(self) -> list[int]:
        """The link that each MuJoCo body is part of."""
        found: list[int] = []
        for body in range(self.model.nbody):
            own = body if self.joints_on(body) else None
            parent = int(self.model.body_parentid[body])
            found.append(own if own is not None else found[parent] if body else BASE)
        return found

    @cached_property
    def links(self) -> list[int]:
        """The links that move, each after the one that carries it."""
        return [body for body in range(1, self.model.nbody) if self.link_of[body] == body]

    @cached_property
    def children(self) -> dict[int, list[int]]:
        """The links that each link carries."""
        found: dict[int, list[int]] = {link: [] for link in (BASE, *self.links)}
        for link in self.links:
            found[self.parent(link)].append(link)
        return found

    def parent(self, link: int) -> int:
        """The link that carries a link."""
        return self.link_of[int(self.model.body_parentid[link])]

    def bodies(self, link: int) -> list[int]:
        """The MuJoCo bodies of a link."""
        return [body for body in range(self.model.nbody) if self.link_of[body] == link]

    def joints_on(self, body: int) -> list[int]:
        """The hinges and slides of a MuJoCo body, in their order."""
        first, count = self.model.body_jntadr[body], self.model.body_jntnum[body]
        return [j for j in range(first, first + count) if self.model.jnt_type[j] in MOVING]

    def joint(self, name: str) -> int:
        """Index of a joint, which must exist."""
        return int(self.model.joint(name).id)

    def joint_name(self, joint: int) -> str:
        """Name of a joint."""
        return str(self.model.joint(joint).name)

    def name(self, body: int) -> str:
        """Name of a MuJoCo body."""
        return str(self.model.body(body).name)

    def body(self, name: str) -> int:
        """Index of a MuJoCo body, which must exist."""
        return int(self.model.body(name).id)

    def path(self, link: int) -> list[int]:
        """The links from the base, which is left out, to a link."""
        found = []
        while link != BASE:
            found.append(link)
            link = self.parent(link)
        return found[::-1]

    def below(self, link: int) -> list[int]:
        """A link and all that it carries."""
        found = [link]
        for child in self.children[link]:
            found += self.below(child)
        return found

    def mass(self, link: int) -> float:
        """Mass of a link alone [kg]."""
        own = [self.model.body_mass[body] for body in self.bodies(link)]
        return float(sum(mass for mass in own if mass > 2.0 * LEAST_MASS))

    def mass_below(self, link: int) -> float:
        """Mass of a link and all that it carries [kg]."""
        return sum(self.mass(each) for each in self.below(link))

    # --- where it is -------------------------------------------------------------------------

    def anchor(self, joint: int) -> FloatArray:
        """A point (3,) on the axis of a joint."""
        return np.array(self.data.xanchor[joint])

    def axis(self, joint: int) -> FloatArray:
        """The direction (3,) of the axis of a joint."""
        return np.array(self.data.xaxis[joint])

    def where(self, body: int, point: FloatArray) -> FloatArray:
        """A point (3,) or points (k, 3) of a MuJoCo body, in the world."""
        axes = self.data.xmat[body].reshape(3, 3)
        placed: FloatArray = point @ axes.T + self.data.xpos[body]
        return placed

    def seen_from(self, body: int, point: FloatArray) -> FloatArray:
        """A point of the world in the frame of a MuJoCo body."""
        axes = self.data.xmat[body].reshape(3, 3)
        placed: FloatArray = (point - self.data.xpos[body]) @ axes
        return placed

    def start(self, link: int) -> FloatArray:
        """Where a link begins: a point (3,) on its first joint's axis; of the base its origin."""
        joints = self.joints_on(link)
        return self.anchor(joints[0]) if joints else np.array(self.data.xpos[link])

    def shapes(self, body: int) -> list[Shape]:
        """The geoms of a MuJoCo body."""
        if body not in self._shapes:
            self._shapes[body] = shapes_of(self.model, body)
        return self._shapes[body]

    def surface(self, body: int) -> FloatArray:
        """Points (k, 3) of the surface of a MuJoCo body, in its own frame; none if it has none."""
        if body not in self._surface:
            self._surface[body] = spread(solid(self.shapes(body)), POINTS)
        return self._surface[body]

    def points(self, *links: int) -> FloatArray:
        """Points (k, 3) of the surfaces of links, in the world."""
        bodies = [body for link in links for body in self.bodies(link)]
        parts = [self.where(body, self.surface(body)) for body in bodies]
        return np.concatenate([np.zeros((0, 3)), *parts])

    def length(self, link: int) -> float:
        """How far it is from where a link begins to its farthest end, joint by joint [m]."""
        start = self.start(link)
        points = self.points(link)
        own = np.linalg.norm(points - start, axis=1).max(initial=0.0)
        further = [
            np.linalg.norm(self.start(child) - start) + self.length(child)
            for child in self.children[link]
        ]
        return float(max([own, *further]))

    @cached_property
    def _shapes(self) -> dict[int, list[Shape]]:
        return {}

    @cached_property
    def _surface(self) -> dict[int, FloatArray]:
        return {}


def name_of_source(source: Source) -> str:
    """What a model's body is called: its file, without what comes after the dot."""
    return source.path.name.split(".")[0]


__all__ = ["BASE", "Any", "Tree", "name_of_source"]

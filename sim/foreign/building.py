"""From a body file to a body: a model made anew out of somebody's, with names in anatomy.

Only what the body needs is taken over: links with their masses, hinges with their limits, a torque
motor for each, capsules that collide, coarse meshes that are looked at. Everything else of the
model (free joints, its actuators, equalities, tendons, sensors) stays behind.
"""

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.adonis_character import FRICTION, SOFTNESS
from sim.body import Body
from sim.errors import BodyError
from sim.foreign.apart import excluded
from sim.foreign.body_file import BodyFile, ShapeOf
from sim.foreign.layout import Joint, Layout, Link, lay_out
from sim.foreign.looks import looks_of
from sim.foreign.mapping import body_map
from sim.foreign.motors import torque_limit
from sim.foreign.reading import LEAST_MASS, Source
from sim.foreign.surface import drawn
from sim.foreign.tree import Tree
from sim.landmarks import x_along
from sim.physics import set_physics
from sim.scenery import set_scene

FloatArray = NDArray[np.float64]

SHELL = (0.62, 0.66, 0.72, 1.0)  # of capsules where there are no meshes
OUT_OF_THE_WAY = 3  # group of geoms that are not drawn
ELBOW_HALF = 0.4  # of the upper arm, from the shoulder: what lies beyond may run into the trunk
LEAST_INERTIA = 1e-6  # [kg m^2]
ROUNDING = 1e-4  # relative, of moments written with six digits


def build_body(
    source: Source, file: BodyFile, *, limits: bool = True, contacts: bool = True
) -> Body:
    """The body that a file describes.

    Args:
        source: the model that it is about.
        file: what its parts are.
        limits: joint limits on.
        contacts: collisions of the body with itself on.

    Raises:
        BodyError: the file does not fit the model.
    """
    layout = lay_out(Tree(source), file)
    spec = build_spec(layout, file, limits=limits, contacts=contacts)
    return Body(spec, body_map(layout, file, spec, source.speeds))


def hanging_places(source: Source, file: BodyFile) -> dict[str, FloatArray]:
    """Where landmarks are (3,) while the arms hang: forward, left, up of the shoulders [m].

    Args:
        source: the model that the file is about.
        file: what its parts are.
    """
    layout = lay_out(Tree(source), file)
    middle = np.mean([layout.places(limb)[0] for limb in layout.arms], axis=0)
    return {
        name: np.array(mark.point) + layout.link(mark.link).origin - middle
        for name, mark in file.landmarks.items()
    }


def build_spec(
    layout: Layout,
    file: BodyFile,
    *,
    limits: bool = True,
    contacts: bool = True,
    looks: bool = True,
) -> Any:
    """The model, as an `mujoco.MjSpec`; without looks only what collides is drawn."""
    return _Builder(layout, file, limits, contacts, looks).build()


class _Builder:
    """Adds the links one by one."""

    def __init__(
        self, layout: Layout, file: BodyFile, limits: bool, contacts: bool, looks: bool
    ) -> None:
        self.layout, self.file, self.looks = layout, file, looks
        self.limits, self.contacts = limits, contacts
        self.model = layout.tree.model
        self.spec = mujoco.MjSpec()
        self.made: dict[str, Any] = {"": self.spec.worldbody}

    def build(self) -> Any:
        spec = self.spec
        spec.modelname = self.file.body
        spec.compiler.degree = False
        spec.memory = 4 << 20
        set_physics(spec, contacts=self.contacts)
        self._scene()
        for name in self.file.shapes:
            self.layout.link(name)
        for link in self.layout.links:
            self._link(link)
        self._sites()
        self._collisions()
        for link in self.layout.links:
            for joint in link.joints:
                self._motor(joint)
        return spec

    # --- the parts ---------------------------------------------------------------------------

    def _scene(self) -> None:
        """Look at the upper body, and see all of the arms."""
        layout = self.layout
        shoulders = [layout.places(limb)[0] for limb in layout.arms]
        arm = max(layout.length(limb) for limb in layout.arms)
        middle = np.mean(shoulders, axis=0)
        centre = float(middle[0]) + 0.1 * arm, float(middle[1]), float(middle[2]) - 0.25 * arm
        set_scene(self.spec, centre, 2.2 * arm)

    def _link(self, link: Link) -> None:
        origin = link.origin - (self.layout.link(link.parent).origin if link.parent else 0.0)
        body = self.made[link.parent].add_body(name=link.name, pos=list(origin))
        self.made[link.name] = body
        shapes = self.file.shapes.get(link.name, ())
        mass, centre, inertia = self._weight(link)
        given = self.file.masses.get(link.name)
        if given is None and link.joints and mass < 2.0 * LEAST_MASS:
            raise BodyError(
                f"the link {link.name!r} has no mass in the model: give it one in masses"
            )
        for joint in link.joints:
            self._joint(body, joint, link.origin)
        looks = looks_of(self._shapes_of(link)) if self.looks else []
        volumes = [volume(shape) for shape in shapes]
        for k, (shape, size) in enumerate(zip(shapes, volumes, strict=True)):
            self._capsule(
                body, f"{link.name}_{k + 1}", shape,
                mass=given * size / sum(volumes) if given is not None else 0.0,
                seen=not looks,
            )  # fmt: skip
        if given is None or not shapes:
            body.explicitinertial = True
            body.mass, body.ipos = given or mass, list(centre)
            body.inertia, body.iquat = _principal(inertia)
        for k, look in enumerate(looks):
            name = f"{link.name}_look_{k + 1}"
            mesh = self.spec.add_mesh(name=name)
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
            mesh.uservert, mesh.userface = look.points.ravel().tolist(), look.faces.ravel().tolist()
            body.add_geom(
                name=name,
                type=mujoco.mjtGeom.mjGEOM_MESH,
                meshname=name,
                rgba=list(look.rgba),
                contype=0,
                conaffinity=0,
                mass=0.0,
                group=1,
            )

    def _shapes_of(self, link: Link) -> list[Any]:
        """The geoms of a link; a hand cut off a forearm has none of its own to be seen."""
        return [] if link.beyond is not None else self.layout.shapes(link, drawn)

    def _weight(self, link: Link) -> tuple[float, FloatArray, FloatArray]:
        """Mass [kg], centre of mass (3,) [m] and inertia (3, 3) about it, in the link's frame."""
        tree, model = self.layout.tree, self.model
        bodies = [b for b in link.bodies if model.body_mass[b] > 2.0 * LEAST_MASS]
        if not bodies or link.beyond is not None:
            return 0.0, np.zeros(3), np.zeros((3, 3))
        masses = np.array([model.body_mass[b] for b in bodies])
        centres = np.array(
            [self.layout.placed(np.array(tree.data.xipos[b])) - link.origin for b in bodies]
        )
        centre = masses @ centres / masses.sum()
        total = np.zeros((3, 3))
        for body, mass, place in zip(bodies, masses, centres, strict=True):
            turn = self.layout.axes @ _ximat(tree, body)
            arm = place - centre
            total += turn @ np.diag(model.body_inertia[body]) @ turn.T
            total += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        return float(masses.sum()), centre, total

    def _joint(self, body: Any, joint: Joint, origin: FloatArray) -> None:
        model, dof = self.model, self.model.jnt_dofadr[joint.index]
        said = joint.said
        torque = said.torque or torque_limit(model, joint.index)
        if torque is None:
            raise BodyError(
                f"the model gives no torque limit for {said.joint!r}: give it a torque [N m]"
            )
        damping = model.dof_damping[dof] if said.damping is None else said.damping
        body.add_joint(
            name=joint.name,
            type=mujoco.mjtJoint.mjJNT_HINGE,
            pos=list(joint.anchor - origin),
            axis=list(joint.axis),
            limited=self.limits and anatomical_range(model, joint) is not None,
            range=list(anatomical_range(model, joint) or (0.0, 0.0)),
            actfrclimited=True,
            actfrcrange=[-torque, torque],
            armature=float(model.dof_armature[dof] if said.armature is None else said.armature),
            damping=[float(np.ravel(damping)[0]), 0.0, 0.0],
            frictionloss=float(model.dof_frictionloss[dof]),
            solref_limit=[0.02, 1.0],
        )

    def _motor(self, joint: Joint) -> None:
        of = self.spec.joint(joint.name)
        self.spec.add_actuator(
            name=joint.name,
            target=joint.name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            ctrllimited=True,
            ctrlrange=[-of.actfrcrange[1], of.actfrcrange[1]],
        )

    def _capsule(self, body: Any, name: str, shape: ShapeOf, *, mass: float, seen: bool) -> None:
        point = np.allclose(shape.start, shape.end, atol=1e-6)
        body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_SPHERE if point else mujoco.mjtGeom.mjGEOM_CAPSULE,
            **({"pos": list(shape.start)} if point else {"fromto": [*shape.start, *shape.end]}),
            size=[shape.radius, 0.0, 0.0],
            rgba=list(SHELL),
            condim=3,
            friction=[FRICTION, 0.005, 0.0001],
            solref=SOFTNESS,
            mass=mass,
            group=0 if seen else OUT_OF_THE_WAY,
        )

    def _sites(self) -> None:
        """The palms: +x out of the palm, +z to the fingertips; and landmarks: +x outward."""
        for limb in self.file.limbs.values():
            normal, fingers = (np.array(v) for v in (limb.palm.normal, limb.palm.fingers))
            normal = normal / np.linalg.norm(normal)
            fingers = fingers - normal * (normal @ fingers)
            length = float(np.linalg.norm(fingers))
            if length < 1e-6:
                raise BodyError(f"the palm of the {limb.side} hand faces where its fingers point")
            fingers = fingers / length
            quat = np.empty(4)
            axes = np.column_stack([normal, np.cross(fingers, normal), fingers])
            mujoco.mju_mat2Quat(quat, axes.ravel())
            self._site(f"{limb.side}_palm", f"{limb.side}_hand", limb.palm.point, quat)
        for name, mark in self.file.landmarks.items():
            normal = np.array(mark.normal) / max(float(np.linalg.norm(mark.normal)), 1e-9)
            self.layout.link(mark.link)
            self._site(name, mark.link, mark.point, x_along(normal))

    def _site(self, name: str, link: str, point: Any, quat: FloatArray) -> None:
        self.made[link].add_site(
            name=name, pos=list(point), quat=list(quat), size=[0.006] * 3, group=4
        )

    # --- collisions --------------------------------------------------------------------------

    def _collisions(self) -> None:
        """Neighbours overlap by design; elbow halves of upper arms may run into the trunk again."""
        apart = excluded(self.layout, self.file.may_overlap)
        for one, other in sorted(apart):
            self.spec.add_exclude(bodyname1=one, bodyname2=other)
        for limb, chain in self.layout.chains.items():
            side = self.file.limbs[limb].side
            arm = f"{side}_upper_arm"
            if ("trunk", arm) in ((a, b) for a, b in self.file.may_overlap) or arm not in chain:
                continue
            self._elbow_half_against_the_trunk(limb, arm)

    def _elbow_half_against_the_trunk(self, limb: str, arm: str) -> None:
        if not self.contacts:
            return
        shoulder, elbow, _ = self.layout.places(limb)
        far = ELBOW_HALF * float(np.linalg.norm(elbow - shoulder))
        origin = self.layout.link(arm).origin - shoulder
        for k, shape in enumerate(self.file.shapes.get(arm, ())):
            ends = [np.array(shape.start) + origin, np.array(shape.end) + origin]
            if min(float(np.linalg.norm(end)) for end in ends) < far:
                continue
            for n in range(len(self.file.shapes.get("trunk", ()))):
                self.spec.add_pair(
                    geomname1=f"{arm}_{k + 1}",
                    geomname2=f"trunk_{n + 1}",
                    condim=3,
                    solref=SOFTNESS,
                    friction=[FRICTION] * 2 + [0.005, 0.0001, 0.0001],
                )


def anatomical_range(model: Any, joint: Joint) -> tuple[float, float] | None:
    """The range of a joint in its new sense [rad]; None if it has none."""
    if joint.said.range is not None:
        low, high = np.deg2rad(joint.said.range)
    elif model.jnt_limited[joint.index]:
        low, high = sorted(joint.sense * (model.jnt_range[joint.index] - joint.zero))
    else:
        return None
    return float(low), float(high)


def _principal(inertia: FloatArray) -> tuple[list[float], list[float]]:
    """Principal moments [kg m^2] that a body can have, and the turn (wxyz) to their axes."""
    moments, axes = np.linalg.eigh(inertia)
    moments = np.maximum(moments, LEAST_INERTIA)
    lacking = (1.0 + ROUNDING) * moments[2] - moments[0] - moments[1]
    moments[:2] += max(0.5 * float(lacking), 0.0)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, axes.ravel())
    return moments.tolist(), quat.tolist()


def volume(shape: ShapeOf) -> float:
    """Volume of a capsule [m^3]."""
    length = float(np.linalg.norm(np.subtract(shape.end, shape.start)))
    return float(np.pi * shape.radius**2 * (length + 4.0 / 3.0 * shape.radius))


def _ximat(tree: Tree, body: int) -> FloatArray:
    """The axes (3, 3) of a body's principal moments, in the world."""
    own, turned = np.empty(9), np.empty(9)
    mujoco.mju_quat2Mat(own, tree.model.body_iquat[body])
    turned = tree.data.xmat[body].reshape(3, 3) @ own.reshape(3, 3)
    return np.array(turned)

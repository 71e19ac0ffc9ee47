"""Bodies of another size: every link longer, heavier and harder to turn by factors of its own.

Lengths, masses and moments of links are scaled as asked; all that acts on them follows by the
laws of Hodgins & Pollard (1997): of each joint armature, damping and the torque of its motor, by
the inertia that it moves, and times (of flesh in contact, of ends of joints, of the step of the
physics) by L^1/2. So a scale model does exactly the scaled movement in the scaled time. Its motors
are as strong as that takes, L^4; muscles of the same stress would grow by L^3 only.
"""

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from sim.body import Body
from sim.body_map import BodyMap
from sim.errors import BodyError, unknown
from sim.extending import renamed
from sim.gains import Gains, scaled_gains
from sim.laws import Law
from sim.likeness import moved_inertia

WIDTH = 2  # of the numbers of a contact's impedance, the one that is a length


def scaled(
    body: Body,
    size: float | Law,
    *,
    segments: Mapping[str, Law] | None = None,
    name: str | None = None,
) -> Body:
    """A body like another of another size, with gains that suit it.

    Args:
        body: the other; its joints are hinges.
        size: factors of lengths, masses and moments of inertia; a number is the length of a scale
            model.
        segments: factors of single links in place of those.
        name: what it is called; default: as the other.

    Raises:
        BodyError: there is no such link, or the model has parts that cannot be scaled.
    """
    whole = Law.geometric(size) if isinstance(size, float | int) else size
    spec = body.spec.copy()
    scale_model(spec, whole, segments or {})
    scale_motors(spec, body, whole)
    larger = Body(spec, _names(body, whole, name or body.map.name))
    gains, _ = scaled_gains(body, Gains.of(body.map), larger, length=whole.length)
    return renamed(larger, gains.on(larger.map))


def scale_model(spec: Any, whole: Law, segments: Mapping[str, Law] | None = None) -> None:
    """Scale the links of an `mujoco.MjSpec`, and its times; what moves them stays as it is."""
    _refuse_others(spec, segments or {})
    model = spec.compile()
    for link in spec.bodies:
        own = (segments or {}).get(link.name, whole)
        if link.parent is not None:
            around = (segments or {}).get(link.parent.name, whole)
            link.pos = link.pos * around.length
        if link.name != "world":
            _scale_inertia(link, model, own)
        for part in (*link.sites, *link.cameras, *link.lights, *link.joints):
            part.pos = part.pos * own.length
        for site in link.sites:
            site.size = site.size * own.length
        for geom in link.geoms:
            _scale_geom(geom, own, whole)
        for joint in link.joints:
            joint.solref_limit = _slower(joint.solref_limit, whole)
    for mesh in spec.meshes:
        mesh.scale = mesh.scale * whole.length
    for pair in spec.pairs:
        pair.margin, pair.gap = pair.margin * whole.length, pair.gap * whole.length
        pair.friction = pair.friction * np.array([1.0, 1.0, *[whole.length] * 3])
        pair.solref, pair.solimp = _slower(pair.solref, whole), _wider(pair.solimp, whole)
    spec.option.timestep *= whole.time
    spec.stat.center = spec.stat.center * whole.length
    spec.stat.extent *= whole.length


def scale_motors(spec: Any, body: Body, whole: Law) -> None:
    """Scale what acts on each hinge: its motor, armature, damping and springs.

    Args:
        spec: a model whose links are scaled, and whose motors are still those of `body`.
        body: the body that it is scaled from.
        whole: the law of its length and time; I is that of what each hinge moves.
    """
    moved, more = moved_inertia(body.model, rigid=True), moved_inertia(spec.compile(), rigid=True)
    joints = {name: Law(whole.length, whole.mass, more[name] / moved[name]) for name in moved}
    for joint in spec.joints:
        law = joints[joint.name]
        joint.armature *= law.inertia
        joint.damping = joint.damping * law.torsional_damping * law.time ** np.arange(3)
        joint.stiffness = joint.stiffness * law.torque
        joint.frictionloss *= law.torque
        joint.actfrcrange = joint.actfrcrange * law.torque
    for motor in spec.actuators:
        motor.ctrlrange = motor.ctrlrange * joints[motor.target].torque
        motor.forcerange = motor.forcerange * joints[motor.target].torque


def _scale_inertia(link: Any, model: Any, law: Law) -> None:
    """Mass, its centre and moments of a link, as they were compiled."""
    k = model.body(link.name).id
    link.explicitinertial = True
    link.mass = model.body_mass[k] * law.mass
    link.ipos, link.iquat = model.body_ipos[k] * law.length, model.body_iquat[k].copy()
    link.fullinertia = np.full(6, np.nan)
    link.inertia = model.body_inertia[k] * law.inertia


def _scale_geom(geom: Any, own: Law, whole: Law) -> None:
    geom.pos = geom.pos * own.length
    geom.size = geom.size * own.length
    if not np.isnan(geom.fromto[0]):
        geom.fromto = geom.fromto * own.length
    geom.margin, geom.gap = geom.margin * own.length, geom.gap * own.length
    geom.friction = geom.friction * np.array([1.0, own.length, own.length])
    geom.solref, geom.solimp = _slower(geom.solref, whole), _wider(geom.solimp, whole)


def _slower(solref: Any, law: Law) -> Any:
    """Time constant and damping ratio; where they are negative, stiffness and damping by mass."""
    first, second = solref
    if first > 0.0:
        return [first * law.time, second]
    return [first / law.length, second / law.time]


def _wider(solimp: Any, law: Law) -> Any:
    wider = np.array(solimp)
    wider[WIDTH] *= law.length
    return wider


def _names(body: Body, law: Law, name: str) -> BodyMap:
    """The body map with its lengths and times scaled; gains are scaled elsewhere."""
    names = body.map
    more: dict[str, Any] = {"name": name, "time_scale": names.time_scale * law.time}
    if names.head is not None:
        eyes = tuple(law.length * x for x in names.head.eyes)
        more["head"] = names.head.model_copy(update={"eyes": eyes})
    return names.model_copy(update=more)


def _refuse_others(spec: Any, segments: Mapping[str, Law]) -> None:
    """Refuse what has no place in these laws.

    Raises:
        BodyError: naming it.
    """
    links = [link.name for link in spec.bodies]
    for name in segments:
        if name not in links:
            raise BodyError(unknown("link", name, links))
    for what in ("tendons", "equalities", "flexes", "hfields", "skins"):
        if len(getattr(spec, what)):
            raise BodyError(f"a model with {what} cannot be scaled")
    if segments and len(spec.meshes):
        raise BodyError("a model with meshes can be scaled as a whole only, not link by link")
    for joint in spec.joints:
        if joint.type != mujoco.mjtJoint.mjJNT_HINGE:
            raise BodyError(f"only hinges can be scaled, and {joint.name!r} is none")

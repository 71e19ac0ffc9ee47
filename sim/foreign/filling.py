"""What a model leaves unsaid of its joints and links, filled in by rule.

torque      three times what holds up all that the joint carries, held out level; at least 1 N m
armature    4 % of the inertia that the joint moves and 0.004 kg m^2, which is Adonis' to within a
            third; without any, a chain of light links is not stable
damping     8 % of that of the joint's servo
range       half a turn either way of hanging straight
mass        of a link that has none: its capsules' volume at 1000 kg/m^3
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.briskness import DAMPING_RATIO, FREQUENCY
from sim.foreign.body_file import BodyFile, JointOf
from sim.foreign.building import anatomical_range, build_spec, volume
from sim.foreign.layout import Layout, joint_name
from sim.foreign.motors import torque_limit
from sim.foreign.reading import LEAST_MASS
from sim.foreign.tree import Tree
from sim.gain_rules import half_out, moved_inertia

FloatArray = NDArray[np.float64]

GRAVITY = 9.81  # [m/s^2]
STRONG, WEAKEST = 3.0, 1.0  # torque over what holds the load; and at least [N m]
MOVED, ROTOR = 0.04, 0.004  # armature: of the inertia moved, and [kg m^2]
DRAG = 0.08  # damping, of that of the servo
DENSITY = 1000.0  # [kg/m^3]
HALF_TURN = (-180.0, 180.0)  # [deg]


def fill_masses(layout: Layout, file: BodyFile) -> BodyFile:
    """Masses for links that the model gives none."""
    model = layout.tree.model
    masses = dict(file.masses)
    for link in layout.links:
        known = sum(float(model.body_mass[b]) for b in link.bodies)
        shapes = file.shapes.get(link.name, ())
        if link.joints and known < 2.0 * LEAST_MASS and shapes:
            masses[link.name] = round(DENSITY * sum(volume(s) for s in shapes), 3)
        elif link.joints and known < 2.0 * LEAST_MASS:
            masses[link.name] = 0.01  # of a link that only stands between two hinges
    return file.model_copy(update={"masses": masses})


def fill_joints(layout: Layout, file: BodyFile) -> tuple[BodyFile, dict[str, list[str]]]:
    """Torques, ranges, armature and damping of joints where the model has none.

    Returns:
        The file with them, and for each joint of the model what was filled in.
    """
    model = layout.tree.model
    parts = _parts(file)
    filled: dict[str, dict[str, Any]] = {}
    for link in layout.links:
        for joint in link.joints:
            given: dict[str, Any] = {}
            if torque_limit(model, joint.index) is None:
                given["torque"] = round(_lifting(layout.tree, joint.index), 1)
            if anatomical_range(model, joint) is None:
                given["range"] = HALF_TURN
            filled[joint.said.joint] = given
    file = _with(file, filled)
    bare = _with(file, {name: {**given, "armature": ROTOR} for name, given in filled.items()})
    compiled = build_spec(_again(layout, bare), bare, looks=False).compile()
    inertia = moved_inertia(compiled, half_out(compiled)) - ROTOR
    for link in layout.links:
        for joint in link.joints:
            dof = compiled.jnt_dofadr[compiled.joint(joint.name).id]
            moved, old = float(inertia[dof]), model.jnt_dofadr[joint.index]
            armature = float(model.dof_armature[old])
            if armature <= 0.0:
                armature = MOVED * moved + ROTOR
                filled[joint.said.joint]["armature"] = float(f"{armature:.2g}")
            if float(np.ravel(model.dof_damping[old])[0]) <= 0.0:
                rate = 2.0 * np.pi * FREQUENCY[parts[joint.name]]
                drag = DRAG * 2.0 * DAMPING_RATIO * rate * (moved + armature)
                filled[joint.said.joint]["damping"] = float(f"{drag:.2g}")
    return _with(file, filled), {name: list(given) for name, given in filled.items() if given}


def _parts(file: BodyFile) -> dict[str, str]:
    """The part that each joint is of, by its new name."""
    parts = dict.fromkeys(file.waist, "waist") | dict.fromkeys(file.neck, "neck")
    for limb in file.limbs.values():
        names = list(limb.joints)
        for k, name in enumerate(names):
            bend = names.index("elbow")
            part = "shoulder" if k < bend else "elbow" if k == bend else "wrist"
            parts[joint_name(limb.side, name)] = part
    return parts


def _with(file: BodyFile, filled: dict[str, dict[str, Any]]) -> BodyFile:
    """The file with more said of joints, by their names in the model."""

    def more(joints: dict[str, JointOf]) -> dict[str, JointOf]:
        return {name: of.model_copy(update=filled.get(of.joint, {})) for name, of in joints.items()}

    limbs = {
        name: limb.model_copy(update={"joints": more(limb.joints)})
        for name, limb in file.limbs.items()
    }
    update = {"waist": more(file.waist), "neck": more(file.neck), "limbs": limbs}
    return file.model_copy(update=update)


def _again(layout: Layout, file: BodyFile) -> Layout:
    """The same layout, with what the file says of its joints now."""
    said = {of.joint: of for of in (*file.waist.values(), *file.neck.values())}
    said |= {of.joint: of for limb in file.limbs.values() for of in limb.joints.values()}
    links = tuple(
        replace(
            link,
            joints=tuple(replace(j, said=said[j.said.joint]) for j in link.joints),
        )
        for link in layout.links
    )
    return replace(layout, links=links)


def _lifting(tree: Tree, joint: int) -> float:
    """Torque [N m] of a joint that is not told how strong it is."""
    model, data = tree.model, tree.data
    first = int(model.jnt_bodyid[joint])
    held = 0.0
    for body in range(first, model.nbody):
        above = body
        while above not in (first, 0):
            above = int(model.body_parentid[above])
        if above == first:
            far = np.linalg.norm(data.xipos[body] - data.xanchor[joint])
            held += float(model.body_mass[body] * GRAVITY * far)
    return max(STRONG * held, WEAKEST)

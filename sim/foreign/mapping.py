"""The body map of a body that was read: its names in anatomy, and its gains by rule."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from sim.body_map import BodyMap, Guard, Head, Limb
from sim.briskness import SPEED
from sim.foreign.apart import kept_apart
from sim.foreign.body_file import BodyFile, LimbOf
from sim.foreign.layout import Layout, joint_name
from sim.gain_rules import felt_inertia, guard, hand_spring, servos


def body_map(layout: Layout, file: BodyFile, spec: Any, known: Mapping[str, float]) -> BodyMap:
    """The names of a body, and its gains by rule.

    Args:
        layout: of its links.
        file: what it says.
        spec: its model.
        known: largest speeds of joints of the old model [rad/s].
    """
    model = spec.compile()
    limbs = {name: _limb(limb, model) for name, limb in file.limbs.items()}
    parts = dict.fromkeys(file.waist, "waist") | dict.fromkeys(file.neck, "neck")
    for limb in limbs.values():
        bend = len(limb.shoulder)
        parts |= dict.fromkeys(limb.shoulder, "shoulder") | {limb.elbow: "elbow"}
        parts |= dict.fromkeys(limb.joints[bend + 1 :], "wrist")
    missing = {f"{side}_arm": () for side in ("right", "left") if f"{side}_arm" not in limbs}
    return BodyMap(
        name=file.body,
        limbs=limbs,
        groups={"waist": tuple(file.waist), "neck": tuple(file.neck), **missing},
        head=_head(layout, file),
        landmarks=tuple(file.landmarks),
        postures=file.postures,
        home=file.home,
        servos=servos(model, parts, file.frequency, file.damping_ratio),
        speed_limits={
            joint.name: joint.said.speed
            or float(np.rad2deg(known.get(joint.said.joint, 0.0)))
            or SPEED[parts[joint.name]]
            for link in layout.links
            for joint in link.joints
        },
        keep_apart=file.keep_apart if file.keep_apart is not None else kept_apart(layout, file),
        guard=_guard(layout, limbs, model),
        upright=("waist", "neck"),
    )


def _limb(limb: LimbOf, model: Any) -> Limb:
    side = limb.side
    joints = tuple(joint_name(side, joint) for joint in limb.joints)
    bend = joints.index(f"{side}_elbow")
    return Limb(
        side=side,
        joints=joints,
        shoulder=joints[:bend],
        elbow=joints[bend],
        upper_arm=f"{side}_upper_arm",
        forearm=f"{side}_forearm",
        hand=f"{side}_hand",
        palm=f"{side}_palm",
        spring=limb.spring or hand_spring(model, joints, bend, f"{side}_palm"),
    )


def _head(layout: Layout, file: BodyFile) -> Head | None:
    """What looks is turned by the neck, or without one by the waist."""
    turning = ("neck",) if file.neck else ("waist",) if file.waist else ()
    if file.head is None or not turning:
        return None
    return Head(link=layout.head, forward=file.head.forward, eyes=file.head.eyes, joints=turning)


def _guard(layout: Layout, limbs: Mapping[str, Limb], model: Any) -> Guard:
    """What keeps links apart has to push a hand as heavy as those of this body."""
    felt = [
        felt_inertia(model, limb.joints, len(limb.shoulder), limb.palm)[0]
        for limb in limbs.values()
    ]
    return guard(float(np.mean(felt)), float(np.mean([layout.length(name) for name in limbs])))

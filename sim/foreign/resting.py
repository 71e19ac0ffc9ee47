"""The rest posture of a body: arms hang at ease, away from the trunk; and what touches anyhow."""

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.foreign.anatomy import Anatomy
from sim.foreign.body_file import BodyFile
from sim.foreign.building import build_spec
from sim.foreign.hanging import Hanging, hang
from sim.foreign.layout import Layout
from sim.foreign.tree import Tree

FloatArray = NDArray[np.float64]

OUTWARD = (9.0, 16.0, 24.0, 36.0, 50.0)  # from hanging straight down, tried in turn [deg]
BENT = 14.0  # the elbow [deg]
ROOM = 0.003  # left between links [m]
HOPELESS = np.deg2rad(50.0)  # an arm that is so far from hanging at best cannot hang
OFTEN = 0.5  # of random postures in which two links are in each other: they always are
DRAWN = 60
EDGE = 0.01  # kept from the ends of joints [deg]


def rest_posture(
    tree: Tree, anatomy: Anatomy, layout: Layout, file: BodyFile, hangs: bool
) -> tuple[dict[str, float], tuple[tuple[str, str], ...]]:
    """Find the rest posture; of arms that cannot hang, every joint in the middle of its range.

    Returns:
        Angles of all joints [deg], in the sense of the body, and pairs of links that are in each
        other then, or in most postures.
    """
    spec = build_spec(layout, file, looks=False)
    model = spec.compile()
    always = _often_together(model)
    best: tuple[float, dict[str, float], list[tuple[str, str]]] | None = None
    for outward in OUTWARD:
        angles = _angles(layout, _hung(tree, anatomy, outward)) if hangs else _middle(model)
        deep, pairs = _touching(model, angles, always)
        if best is None or deep < best[0]:
            best = deep, angles, pairs
        if deep == 0.0 or not hangs:
            break
    assert best is not None
    _, angles, pairs = best
    return angles, tuple(sorted({*pairs, *always}))


def _hung(tree: Tree, anatomy: Anatomy, outward: float) -> list[Hanging]:
    """All arms at ease, within their limits."""
    return [
        hang(
            tree, arm.anatomy, anatomy.facing.frame, arm.side, arm.fingers, arm.normal,
            outward=np.deg2rad(outward), bend=np.deg2rad(BENT), near=arm.hanging.angles,
        )
        for arm in anatomy.arms
    ]  # fmt: skip


def _angles(layout: Layout, hung: list[Hanging]) -> dict[str, float]:
    """Angles in the sense of the body [deg]; waist and neck at 0, or as near as they come."""
    old = {name: q for hanging in hung for name, q in hanging.angles.items()}
    found = {}
    for link in layout.links:
        for joint in link.joints:
            q = old.get(joint.said.joint)
            angle = 0.0 if q is None else float(np.rad2deg(joint.sense * (q - joint.zero)))
            found[joint.name] = angle
    return found


def _middle(model: Any) -> dict[str, float]:
    """Every joint in the middle of its range [deg]."""
    return {
        model.joint(j).name: float(np.rad2deg(np.mean(model.jnt_range[j])))
        for j in range(model.njnt)
    }


def clipped(model: Any, angles: dict[str, float]) -> dict[str, float]:
    """Angles [deg] within the ranges of the joints, as a person would write them."""
    found = {}
    for name, angle in angles.items():
        joint = model.joint(name).id
        low, high = (
            np.rad2deg(model.jnt_range[joint]) if model.jnt_limited[joint] else (-360.0, 360.0)
        )
        inside = float(np.clip(angle, low + EDGE, high - EDGE))
        neat = round(inside)
        found[name] = float(neat if low < neat < high else round(inside, 2)) + 0.0
    return found


def _touching(
    model: Any, angles: dict[str, float], always: set[tuple[str, str]]
) -> tuple[float, list[tuple[str, str]]]:
    """How deep links are in each other in a posture [m], and which."""
    data = mujoco.MjData(model)
    for name, angle in clipped(model, angles).items():
        data.qpos[model.jnt_qposadr[model.joint(name).id]] = np.deg2rad(angle)
    deep, pairs = 0.0, set()
    for names, distance in _contacts(model, data):
        if names not in always and distance < ROOM:
            pairs.add(names)
            deep += ROOM - distance
    return deep, sorted(pairs)


def _often_together(model: Any) -> set[tuple[str, str]]:
    """Links that are in each other in most postures, whatever the arms do."""
    rng, data = np.random.default_rng(0), mujoco.MjData(model)
    limited = model.jnt_limited[:, None] > 0
    low, high = np.where(limited, model.jnt_range, [-np.pi, np.pi]).T
    counts: dict[tuple[str, str], int] = {}
    for _ in range(DRAWN):
        data.qpos[model.jnt_qposadr] = rng.uniform(low, high)
        for pair in {names for names, distance in _contacts(model, data) if distance < 0.0}:
            counts[pair] = counts.get(pair, 0) + 1
    return {pair for pair, count in counts.items() if count > OFTEN * DRAWN}


def _contacts(model: Any, data: Any) -> list[tuple[tuple[str, str], float]]:
    """Pairs of links that touch in a posture, and their distances [m]."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_collision(model, data)
    found = []
    for k in range(data.ncon):
        one, other = (model.body(model.geom_bodyid[g]).name for g in data.contact.geom[k])
        found.append(((min(one, other), max(one, other)), float(data.contact.dist[k])))
    return found


__all__ = ["HOPELESS", "clipped", "rest_posture"]

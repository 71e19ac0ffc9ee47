"""Where the fingers of a hand point and which way its palm faces, from whatever there is to see.

Fingers that bend show it: they bend towards the palm. Two that close on each other leave the flat
sides between them. A hand without fingers is thinnest across its palm.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.foreign.arm import ALONG, ArmAnatomy, limits
from sim.foreign.geometry import angle_between, unit
from sim.foreign.tree import Tree

FloatArray = NDArray[np.float64]

CLEARLY = 0.5  # share of the fingers' movements that agree
FLAT = 1.25  # a hand is flat if it is so much thinner one way than the other
NEAT = 0.94  # cosine between what was found and an axis of the wrist that it may be
CLOSED = 0.5  # share of its range by which a finger is bent to see where it goes


@dataclass(frozen=True)
class PalmGuess:
    """Directions in the frame of the hand's MuJoCo body, and how they were found."""

    fingers: FloatArray  # (3,) unit
    normal: FloatArray  # (3,) unit, at right angles to the fingers
    signed: bool  # whether the palm is known from the back of the hand
    why: str


def guess_palm(tree: Tree, arm: ArmAnatomy) -> PalmGuess:
    """Guess the directions of a hand; the tree is posed anyhow."""
    axes = tree.data.xmat[arm.hand].reshape(3, 3)
    wrist = arm.places(tree)[2]
    points = _hand_points(tree, arm, wrist)
    fingers = _fingers(tree, arm, wrist, points)
    moved = _closing(tree, arm.hand)
    across = [v - fingers * (v @ fingers) for v in moved]
    total = np.sum(across, axis=0) if across else np.zeros(3)
    whole = sum(float(np.linalg.norm(v)) for v in across)
    if whole > 1e-4 and np.linalg.norm(total) > CLEARLY * whole:
        return PalmGuess(axes.T @ fingers, axes.T @ unit(total), True, "the way the fingers bend")
    if whole > 1e-4:
        _, _, main = np.linalg.svd(np.array(across))
        normal = unit(np.cross(fingers, main[0]))
        return PalmGuess(axes.T @ fingers, axes.T @ normal, False, "the flat side of a gripper")
    normal, why = _thinnest(tree, arm, fingers, points)
    return PalmGuess(axes.T @ fingers, axes.T @ normal, False, why)


def _hand_points(tree: Tree, arm: ArmAnatomy, wrist: FloatArray) -> FloatArray:
    """The surface of a hand; of a forearm without a wrist what is beyond it."""
    points = tree.points(*tree.below(arm.hand))
    if arm.hand == arm.forearm and len(points):
        along = unit(wrist - arm.places(tree)[1])
        points = points[(points - wrist) @ along > 0.0]
    return points


def _fingers(tree: Tree, arm: ArmAnatomy, wrist: FloatArray, points: FloatArray) -> FloatArray:
    """From the wrist to what is farthest out; in line with the forearm if nearly so at home.

    A thumb, or a gripper beside its flange, would turn it a little.
    """
    forearm = _along_forearm(tree, arm, wrist)
    if len(points):
        far = np.linalg.norm(points - wrist, axis=1)
        towards = unit(points[far >= np.quantile(far, 0.8)].mean(axis=0) - wrist)
    else:
        towards = forearm
    if not arm.wrist or angle_between(forearm, towards) < ALONG:
        return forearm
    axis = tree.axis(arm.joints[-1])
    axis = axis if axis @ towards >= 0.0 else -axis
    if angle_between(axis, towards) < ALONG:
        return axis
    if angle_between(axis, towards) > np.pi / 2.0 - ALONG:
        return unit(towards - axis * (axis @ towards))
    return towards


def _along_forearm(tree: Tree, arm: ArmAnatomy, wrist: FloatArray) -> FloatArray:
    """The direction of the forearm: the axis about which it rolls, if there is one."""
    along = unit(wrist - arm.places(tree)[1])
    for joint in arm.wrist[:1]:
        axis = tree.axis(joint)
        if angle_between_lines(axis, along) < ALONG:
            return axis if axis @ along > 0.0 else -axis
    return along


def _closing(tree: Tree, hand: int) -> list[FloatArray]:
    """How far the tip of each finger moves as it closes, (3,) each [m]."""
    model, data = tree.model, tree.data
    found = []
    before = data.qpos.copy()
    for finger in tree.children[hand]:
        links = tree.below(finger)
        ends = [link for link in links if not tree.children[link]]
        starts = _ends(tree, ends)
        for joint in (j for link in links for j in tree.joints_on(link)):
            low, high = limits(tree, joint)
            if not np.isfinite(low + high):
                continue
            at = model.jnt_qposadr[joint]
            further = high if high - before[at] >= before[at] - low else low
            data.qpos[at] += CLOSED * (further - before[at])
        mujoco.mj_kinematics(model, data)
        found.append(np.mean(_ends(tree, ends) - starts, axis=0))
        data.qpos[:] = before
        mujoco.mj_kinematics(model, data)
    return found


def _ends(tree: Tree, links: list[int]) -> FloatArray:
    """The middles of some links (k, 3)."""
    middles = []
    for link in links:
        points = tree.points(link)
        middles.append(points.mean(axis=0) if len(points) else tree.data.xipos[link])
    return np.array(middles)


def _thinnest(
    tree: Tree, arm: ArmAnatomy, fingers: FloatArray, points: FloatArray
) -> tuple[FloatArray, str]:
    """The direction across the fingers in which a hand is thinnest; else what the wrist tells."""
    if len(points):
        across = points - np.outer(points @ fingers, fingers)
        _, spread, main = np.linalg.svd(across - across.mean(axis=0), full_matrices=False)
        if spread[0] > FLAT * spread[1]:
            thin = unit(main[1] - fingers * (main[1] @ fingers))
            return _neat(tree, arm, fingers, thin), "the hand is thinnest there"
    bends = [j for j in arm.wrist if angle_between_lines(tree.axis(j), fingers) > ALONG]
    if bends:
        least = min(bends, key=lambda j: limits(tree, j)[1] - limits(tree, j)[0])
        axis = tree.axis(least)
        if len(bends) < 2:  # one that bends the wrist bends it towards the palm
            axis = np.cross(axis, fingers)
        return unit(axis - fingers * (axis @ fingers)), "the wrist bends so"
    elbow = tree.axis(arm.elbow)
    return unit(elbow - fingers * (elbow @ fingers)), "the axis of the elbow"


def _neat(tree: Tree, arm: ArmAnatomy, fingers: FloatArray, thin: FloatArray) -> FloatArray:
    """The axis of the wrist, or what is at right angles to it and the fingers, if nearly `thin`."""
    axes = [tree.axis(j) for j in arm.wrist]
    axes = [axis - fingers * (axis @ fingers) for axis in axes]
    axes = [unit(axis) for axis in axes if np.linalg.norm(axis) > 0.5]
    for axis in [*axes, *(np.cross(fingers, axis) for axis in axes)]:
        if abs(axis @ thin) > NEAT:
            return axis * np.sign(axis @ thin)
    return thin


def angle_between_lines(a: FloatArray, b: FloatArray) -> float:
    """Angle of two lines, at most a right one [rad]."""
    return min(angle_between(a, b), angle_between(-a, b))

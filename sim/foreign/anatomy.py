"""The anatomy of a model, all of it: parts, arms, palms, the way it faces, names of joints."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim.foreign.arm import ArmAnatomy, find_arm, hinges
from sim.foreign.facing import Facing, find_facing
from sim.foreign.hanging import Frame, Hanging, hang
from sim.foreign.naming import Named, name_joints
from sim.foreign.palm import PalmGuess, guess_palm
from sim.foreign.parts import Parts, find_parts
from sim.foreign.tree import Tree

FloatArray = NDArray[np.float64]

SIDES = {1.0: "left", -1.0: "right"}
FAR = np.deg2rad(10.0)  # off by more: the arm does not hang so
ALIKE = 0.99  # cosine between an axis and that of the other arm in a mirror


@dataclass(frozen=True)
class Arm:
    """One arm with its names."""

    side: float  # +1 left, -1 right
    anatomy: ArmAnatomy
    palm: PalmGuess
    hanging: Hanging
    joints: tuple[Named, ...]
    fingers: FloatArray  # (3,) in the frame of the hand's MuJoCo body; down when the arm hangs
    normal: FloatArray  # (3,) likewise; out of the palm, inward when the arm hangs


@dataclass(frozen=True)
class Anatomy:
    """What is what in a model."""

    parts: Parts
    facing: Facing
    arms: tuple[Arm, ...]
    waist: tuple[Named, ...]
    neck: tuple[Named, ...]

    @property
    def hanging(self) -> dict[str, float]:
        """Angles of the arms' joints, in the model's sense, when they hang straight."""
        return {name: q for arm in self.arms for name, q in arm.hanging.angles.items()}


def find_anatomy(tree: Tree) -> Anatomy:
    """The anatomy of a model; the tree is left with its arms hanging.

    Raises:
        BodyError: nothing in it looks like an arm.
    """
    parts = find_parts(tree)
    arms = tuple(find_arm(tree, hinges(tree, chain)) for chain in parts.arms)
    palms = tuple(guess_palm(tree, arm) for arm in arms)
    facing = find_facing(tree, parts, arms, palms)
    if len(arms) > 1:
        arms = _bending_alike(tree, arms, facing.frame)
    tree.pose({})
    hung = _hang_all(tree, arms, palms, facing)
    tree.pose({name: q for hanging in hung for name, q in hanging.angles.items()})
    named = []
    for arm, palm, hanging, side in zip(arms, palms, hung, facing.sides, strict=True):
        called = [
            *name_joints(tree, facing.frame, arm.shoulder, "shoulder", side),
            Named("elbow", arm.elbow, arm.flexion < 0.0, True),
            *name_joints(tree, facing.frame, arm.wrist, "wrist", side),
        ]
        hand, frame = tree.data.xmat[arm.hand].reshape(3, 3), facing.frame
        fingers, normal = hand.T @ -frame.up, hand.T @ (-side * frame.left)
        named.append(Arm(side, arm, palm, hanging, tuple(called), fingers, normal))
    named.sort(key=lambda arm: arm.side)  # the right one first
    waist, neck = (
        tuple(name_joints(tree, facing.frame, hinges(tree, links), part))
        for links, part in ((parts.waist, "waist"), (parts.neck, "neck"))
    )
    return Anatomy(parts, facing, tuple(named), waist, neck)


def _bending_alike(
    tree: Tree, arms: tuple[ArmAnatomy, ...], frame: Frame
) -> tuple[ArmAnatomy, ...]:
    """If one elbow's range does not tell how it bends, it does as the other in a mirror."""
    found = []
    for arm, other in zip(arms, arms[::-1], strict=True):
        if arm.either_way and not other.either_way:
            axis = other.flexion * tree.axis(other.elbow)
            wanted = _mirrored_turn(axis, frame)
            sense = 1.0 if tree.axis(arm.elbow) @ wanted >= 0.0 else -1.0
            found.append(replace(arm, flexion=sense))
        else:
            found.append(arm)
    return tuple(found)


def _hang_all(
    tree: Tree, arms: tuple[ArmAnatomy, ...], palms: tuple[PalmGuess, ...], facing: Facing
) -> list[Hanging]:
    """Let all arms hang; a palm that could be either side is the one that is turned in with ease.

    If the second arm is the first in a mirror, it hangs as in a mirror.
    """
    found: list[Hanging] = []
    for arm, palm, side in zip(arms, palms, facing.sides, strict=True):
        signs = _mirror(tree, arms[0], arm, facing.frame) if found else None
        if signs is not None:
            found.append(_reflected(tree, arms[0], arm, found[0], signs))
            continue
        best = _easiest(tree, arm, facing.frame, side, palm.fingers, palm.normal, palm.signed)
        if best.off > FAR and not palm.signed:  # what seemed the palm cannot be turned inward
            edge = np.cross(palm.fingers, palm.normal)
            other = _easiest(tree, arm, facing.frame, side, palm.fingers, edge, False)
            best = other if other.off < best.off - FAR else best
        found.append(best)
    return found


def _easiest(
    tree: Tree,
    arm: ArmAnatomy,
    frame: Frame,
    side: float,
    fingers: FloatArray,
    normal: FloatArray,
    signed: bool,
) -> Hanging:
    """How an arm hangs with its palm inward, or what may be its palm on either side."""
    options = [
        hang(tree, arm, frame, side, fingers, sign * normal)
        for sign in ((1.0,) if signed else (1.0, -1.0))
    ]
    return min(options, key=lambda hanging: hanging.strain)


def _mirror(tree: Tree, one: ArmAnatomy, other: ArmAnatomy, frame: Frame) -> list[float] | None:
    """For each joint of an arm whether it turns as that of the other in a mirror, or against it.

    Returns:
        None: they are not mirror images.
    """
    if len(one.joints) != len(other.joints):
        return None
    tree.pose({})
    signs = []
    for a, b in zip(one.joints, other.joints, strict=True):
        same = float(tree.axis(b) @ _mirrored_turn(tree.axis(a), frame))
        if abs(same) < ALIKE:
            return None
        signs.append(float(np.sign(same)))
    return signs


def _reflected(
    tree: Tree, one: ArmAnatomy, other: ArmAnatomy, hanging: Hanging, signs: list[float]
) -> Hanging:
    """How an arm hangs if the other hangs so."""
    angles = {}
    for a, b, sign in zip(one.joints, other.joints, signs, strict=True):
        home_a, home_b = (tree.source.home[tree.model.jnt_qposadr[j]] for j in (a, b))
        moved = hanging.angles[tree.joint_name(a)] - home_a
        angles[tree.joint_name(b)] = float(home_b + sign * moved)
    return Hanging(angles, hanging.strain, hanging.off)


def _mirrored_turn(turn: FloatArray, frame: Frame) -> FloatArray:
    """A rotation vector seen in the mirror between left and right."""
    mirrored: FloatArray = 2.0 * (turn @ frame.left) * frame.left - turn
    return mirrored


__all__ = ["SIDES", "Anatomy", "Arm", "find_anatomy"]

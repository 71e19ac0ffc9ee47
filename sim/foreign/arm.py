"""The anatomy of one arm: which of its hinges is the elbow, and where shoulder and wrist are.

The elbow is the hinge with the most on either side of it. The shoulder is where the two axes
before it meet, the wrist where the last two meet. All of it depends on axes alone, so that it is
the same in any posture.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.errors import BodyError
from sim.foreign.geometry import (
    PARALLEL,
    angle_between,
    distance_to_line,
    foot,
    nearest_on_line,
    nearest_turn,
    turn_about,
    unit,
)
from sim.foreign.tree import MOVING, Tree

FloatArray = NDArray[np.float64]

ALONG = np.deg2rad(35.0)  # between the axis of a joint that rolls a segment, and the segment
EVEN = 0.9  # ratio of the two parts of its range: an elbow bends either way
WRIST = 0.65  # of the way from elbow to fingertips, where a hand has no joints


@dataclass(frozen=True)
class ArmAnatomy:
    """An arm as joints of the model, and points that are fixed to its links."""

    links: tuple[int, ...]  # from the trunk outwards
    joints: tuple[int, ...]  # hinges, likewise
    elbow: int  # which of the joints
    straight: float  # angle of the elbow at which the arm is straight, in the model's sense [rad]
    flexion: float  # +1 if the elbow bends as its angle grows, -1 if the other way
    upper_arm: int  # link before the elbow
    forearm: int  # link after it
    hand: int  # the last link; the forearm itself if there is no wrist
    either_way: bool  # whether the elbow bends as far one way as the other
    shoulder_at: FloatArray  # (3,) in the frame of the upper arm's MuJoCo body
    elbow_at: FloatArray  # (3,) in that of the forearm's
    wrist_at: FloatArray  # (3,) in that of the hand's

    @property
    def shoulder(self) -> tuple[int, ...]:
        """The joints before the elbow."""
        return self.joints[: self.joints.index(self.elbow)]

    @property
    def wrist(self) -> tuple[int, ...]:
        """The joints after it."""
        return self.joints[self.joints.index(self.elbow) + 1 :]

    def places(self, tree: Tree) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Shoulder, elbow and wrist (3,) in the world, as the tree is posed now."""
        return (
            tree.where(self.upper_arm, self.shoulder_at),
            tree.where(self.forearm, self.elbow_at),
            tree.where(self.hand, self.wrist_at),
        )


def find_arm(tree: Tree, chain: Sequence[int], elbow: str | None = None) -> ArmAnatomy:
    """The anatomy of a chain of hinges.

    Args:
        tree: the model.
        chain: joints from the trunk outwards.
        elbow: name of the joint that is the elbow, if that is known.

    Raises:
        BodyError: there is no elbow.
    """
    joints = tuple(chain)
    bend = tree.joint(elbow) if elbow is not None else _elbow(tree, joints)
    before, after = joints[: joints.index(bend)], joints[joints.index(bend) + 1 :]
    if not before:
        said = f"{tree.joint_name(bend)!r} cannot be an elbow: no joint comes before it"
        raise BodyError(f"{tree.source.path}: {said}")
    body_of = tree.model.jnt_bodyid
    upper_arm, forearm = int(body_of[before[-1]]), int(body_of[bend])
    hand = int(body_of[joints[-1]])
    shoulder_at = _meeting(tree, before, tree.anchor(bend))
    elbow_at = foot(shoulder_at, tree.anchor(bend), tree.axis(bend))
    wrist_at = _wrist(tree, after, hand, elbow_at)
    straight, flexion = _straight(tree, before, bend, after, (shoulder_at, elbow_at, wrist_at))
    return ArmAnatomy(
        links=tuple(dict.fromkeys(int(body_of[j]) for j in joints)),
        joints=joints,
        elbow=bend,
        straight=straight,
        flexion=flexion,
        upper_arm=upper_arm,
        forearm=forearm,
        hand=hand,
        either_way=_either_way(tree, bend, straight),
        shoulder_at=tree.seen_from(upper_arm, shoulder_at),
        elbow_at=tree.seen_from(forearm, elbow_at),
        wrist_at=tree.seen_from(hand, wrist_at),
    )


def tip_of(tree: Tree, hand: int) -> FloatArray:
    """The middle (3,) of what is farthest out on a hand, fingers and all."""
    points = tree.points(*tree.below(hand))
    start = tree.anchor(tree.joints_on(hand)[-1])
    if not len(points):
        return start
    far = np.linalg.norm(points - start, axis=1)
    tip: FloatArray = points[far >= np.quantile(far, 0.9)].mean(axis=0)
    return tip


def limits(tree: Tree, joint: int) -> tuple[float, float]:
    """The range of a joint; infinite if it has none."""
    if not tree.model.jnt_limited[joint]:
        return -np.inf, np.inf
    low, high = tree.model.jnt_range[joint]
    return float(low), float(high)


def hinges(tree: Tree, links: Sequence[int]) -> list[int]:
    """The hinges of a chain of links: postures are angles, and slides stay where they are."""
    joints = [j for link in links for j in tree.joints_on(link)]
    return [j for j in joints if tree.model.jnt_type[j] == MOVING[0]]


def _elbow(tree: Tree, joints: tuple[int, ...]) -> int:
    """The hinge that has most on either side of it, between what would be shoulder and wrist."""
    if len(joints) < 2:
        raise BodyError(f"{tree.source.path}: an arm with {len(joints)} hinges has no elbow")

    hand = int(tree.model.jnt_bodyid[joints[-1]])

    def divides(k: int) -> float:
        line = tree.anchor(joints[k]), tree.axis(joints[k])
        shoulder = _meeting(tree, joints[:k], line[0])
        elbow = foot(shoulder, *line)
        wrist = _wrist(tree, joints[k + 1 :], hand, elbow)
        return min(distance_to_line(shoulder, *line), distance_to_line(wrist, *line))

    return joints[max(range(1, len(joints)), key=divides)]


def _meeting(tree: Tree, joints: tuple[int, ...], towards: FloatArray) -> FloatArray:
    """Where the last axis of some joints meets the one before it that is not parallel to it."""
    anchor, axis = tree.anchor(joints[-1]), tree.axis(joints[-1])
    for joint in joints[-2::-1]:
        other = tree.axis(joint)
        if abs(other @ axis) < PARALLEL:
            return nearest_on_line(anchor, axis, tree.anchor(joint), other)
    return foot(towards, anchor, axis)


def _wrist(tree: Tree, after: tuple[int, ...], hand: int, elbow: FloatArray) -> FloatArray:
    """Where the last two axes meet; without two, a share of the way to the fingertips."""
    tip = tip_of(tree, hand)
    if len(after) > 1:
        return _meeting(tree, after, tip)
    place: FloatArray = elbow + WRIST * (tip - elbow)
    return foot(place, tree.anchor(after[0]), tree.axis(after[0])) if after else place


def _straight(
    tree: Tree,
    before: tuple[int, ...],
    bend: int,
    after: tuple[int, ...],
    places: tuple[FloatArray, FloatArray, FloatArray],
) -> tuple[float, float]:
    """The angle of the elbow at which the arm is straight, and the sense in which it bends.

    Straight means that upper arm and forearm are parallel: the axes about which they roll where
    they have such, which an elbow beside them does not deceive.
    """
    shoulder, elbow, wrist = places
    axis = tree.axis(bend)
    upper = _roll(tree, before[-1], elbow - shoulder)
    lower = _roll(tree, after[0], wrist - elbow) if after else wrist - elbow
    now = float(tree.data.qpos[tree.model.jnt_qposadr[bend]])
    low, high = limits(tree, bend)
    straight = nearest_turn(now + turn_about(axis, lower, upper), low, high)
    return straight, 1.0 if high - straight >= straight - low else -1.0


def _either_way(tree: Tree, bend: int, straight: float) -> bool:
    """Whether the range of an elbow does not tell in which sense it bends."""
    low, high = limits(tree, bend)
    more, less = max(high - straight, straight - low), min(high - straight, straight - low)
    return bool(np.isinf(more) or less > EVEN * more)


def _roll(tree: Tree, joint: int, segment: FloatArray) -> FloatArray:
    """The direction of a segment: the axis of the joint that rolls it, if that is what it does."""
    axis, along = tree.axis(joint), unit(segment)
    axis = axis if axis @ along >= 0.0 else -axis
    return axis if angle_between(axis, along) < ALONG else along

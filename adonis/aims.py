"""What the judge measures of oscillate, look-at, point-at, follow, hold and relax, row by row.

Like `judging`, this sees the recording and the words of the task, and nothing of the controllers: a
trajectory is put together anew with SciPy's spline.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from primitives import Follow, LookAt, Oscillate, PointAt, Target, Trajectory
from sim import DIRECTIONS, BodyMap, Poses, Replay

FloatArray = NDArray[np.float64]


class Aims:
    """Angles and distances of what is aimed at something.

    Args:
        replay: of the recording.
        names: of the body.
    """

    def __init__(self, replay: Replay, names: BodyMap) -> None:
        self.replay, self.names = replay, names

    def gaze(self, does: LookAt) -> FloatArray:
        """Angle (T,) [deg] between where the face points and the goal, seen from the eyes."""
        head = self.names.head
        assert head is not None, "it was bound to a body with a head"
        link = self.replay.link(head.link)
        eyes = link.position + link.axes @ np.array(head.eyes)
        forward = link.axes @ np.array(head.forward)
        neck = self.carrier(head.joints)
        turns = self.carrier(does.joints) if does.joints else neck
        goal = self._goal(does.at, neck)
        point = does.at.point if isinstance(does.at, Target) else None
        if point is not None and turns != neck:  # it stays behind when the waist turns
            base = self.turned(turns)
            seen = base.axes[0].T @ (goal[0] - base.position[0])
            goal = base.position + base.axes @ seen
        return _degrees(forward, goal - eyes)

    def pointing(self, does: PointAt) -> FloatArray:
        """Angle (T,) [deg] between shoulder to wrist and shoulder to goal."""
        limb = self.names.limbs[does.limb]
        shoulder = self.replay.link(limb.upper_arm).position
        goal = self._goal(does.at, self.carrier(limb.joints))
        return _degrees(self.replay.link(limb.hand).position - shoulder, goal - shoulder)

    def tracking(self, does: Follow, start: float) -> FloatArray:
        """Distance (T,) [m] of the palm from the moving point; `start` [s] is when it began."""
        limb = self.names.limbs[does.limb]
        trunk = self.carrier(limb.joints)
        if does.trajectory is not None:
            goal = self._along(does.trajectory, trunk, start)
        else:
            assert does.to is not None, "it has one or the other"
            goal = self._goal(does.to, trunk)
        palm = self.replay.site(limb.palm).position
        distance: FloatArray = np.linalg.norm(palm - goal, axis=1)
        return distance

    def swung(self, does: Oscillate) -> dict[str, FloatArray]:
        """How far each joint [deg], or the palm along each direction [m], was from the centre.

        Joints, and a palm whose centre is not said, from somewhere.
        """
        if does.limb is None:
            return {joint: np.rad2deg(self.replay.angle(joint)) for joint in does.swings}
        limb = self.names.limbs[does.limb]
        trunk = self.carrier(limb.joints)
        carrier, palm = self.turned(trunk), self.replay.site(limb.palm).position
        centre = carrier.position if does.at is None else self._goal(does.at, trunk)
        return {
            word: np.einsum("ti,tij,j->t", palm - centre, carrier.axes, DIRECTIONS[word])
            for word in does.swings
        }

    def turned(self, link: str) -> Poses:
        """Poses of a link, its axes being forward, left and up in the home posture."""
        home = {
            joint: angle
            for name, angle in self.names.postures[self.names.home].items()
            for joint in self.names.groups.get(name, (name,))
        }
        return self.replay.turned(link, home)

    def _along(self, trajectory: Trajectory, trunk: str, start: float) -> FloatArray:
        spline = CubicSpline(trajectory.times, trajectory.points, bc_type="clamped")
        t = self.replay.recording.time - start
        carrier = self.turned(trunk)
        seen = spline(np.clip(t, trajectory.times[0], trajectory.times[-1]))
        where: FloatArray = carrier.position + np.einsum("tij,tj->ti", carrier.axes, seen)
        return where

    def _goal(self, said: str | Target, trunk: str) -> FloatArray:
        """Where a target was, row by row (T, 3)."""
        target = Target(near=said) if isinstance(said, str) else said
        if target.point is not None:
            carrier = self.turned(trunk)
            return carrier.position + carrier.axes @ np.add(target.point, target.offset)
        name = self.names.limbs[target.hand].palm if target.hand else target.near or ""
        mark, carrier = self.replay.site(name), self.turned(self.replay.link_of_site(name))
        out = mark.position + target.away * mark.axes[:, :, 0]
        shifted: FloatArray = out + carrier.axes @ np.array(target.offset)
        return shifted

    def carrier(self, names: tuple[str, ...]) -> str:
        """The link that carries a chain of joints."""
        joints = [j for name in names for j in self.names.groups.get(name, (name,))]
        model = self.replay.model
        first = model.dof_bodyid[min(self.replay.dof(joint) for joint in joints)]
        return str(model.body(model.body_parentid[first]).name)


def _degrees(a: FloatArray, b: FloatArray) -> FloatArray:
    """Angles (T,) [deg] between vectors (T, 3)."""
    across = np.linalg.norm(np.cross(a, b), axis=1)
    angles: FloatArray = np.rad2deg(np.arctan2(across, np.einsum("ti,ti->t", a, b)))
    return angles

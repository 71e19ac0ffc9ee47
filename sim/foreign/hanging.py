"""How an arm hangs straight down, palm to the thigh: the posture in which all its angles are zero.

Found by least squares over the joints of the arm: upper arm and fingers down, the elbow straight
and bending forward, the palm inward; what that leaves open stays near home, and turns shoulder
axes along or across the body.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import minimize
from numpy.typing import NDArray

from sim.foreign.arm import ArmAnatomy, limits
from sim.foreign.geometry import unit
from sim.foreign.tree import Tree

FloatArray = NDArray[np.float64]

NEAR_HOME = 0.04  # weight of staying near home [1/rad]
BEYOND = 0.3  # of being past a limit [1/rad]
STRAIGHT = 4.0  # of an elbow that is not straight [1/rad]
NEATLY = 0.25  # weight of axes of the shoulder lying along or across the body [1/rad]
STARTS = 8  # postures from which it is looked for
ROUND = np.deg2rad(2.0)  # zeros so near to a multiple of 15 degrees are that


@dataclass(frozen=True)
class Frame:
    """The directions of a body, in the axes of the model's own world."""

    forward: FloatArray  # (3,)
    left: FloatArray
    up: FloatArray

    @classmethod
    def of(cls, forward: FloatArray, up: FloatArray) -> "Frame":
        """The frame with an upward axis that faces forward."""
        forward = unit(forward - up * (forward @ up))
        return cls(forward, np.cross(up, forward), up)

    @property
    def axes(self) -> FloatArray:
        """(3, 3): takes a vector of the model's world to forward, left, up."""
        return np.array([self.forward, self.left, self.up])


@dataclass(frozen=True)
class Hanging:
    """Angles of an arm's joints when it hangs straight."""

    angles: dict[str, float]  # joint -> angle in the model's sense [rad]
    strain: float  # how far from home that is; small is comfortable
    off: float  # how far from hanging straight the limits keep it [rad]


def hang(
    tree: Tree,
    arm: ArmAnatomy,
    frame: Frame,
    side: float,
    fingers: FloatArray,
    normal: FloatArray | None,
    *,
    outward: float = 0.0,
    bend: float = 0.0,
    near: Mapping[str, float] | None = None,
) -> Hanging:
    """Let an arm hang, straight or at ease.

    Args:
        tree: the model; it is left posed like that.
        arm: the arm.
        frame: of the body.
        side: +1 left, -1 right.
        fingers: (3,) where they point, in the frame of the hand's MuJoCo body.
        normal: (3,) out of the palm, likewise; None leaves the palm open.
        outward: how far from hanging straight down it is held to its side [rad].
        bend: how far the elbow is bent [rad].
        near: angles to stay near to, within the limits of the joints; without them the arm stays
            near home, and ignores limits where they are in the way.
    """
    problem = _Problem(tree, arm, frame, side, fingers, normal, outward, bend)
    if near is not None:
        best = problem.solve(bounded=True, start=problem.stay_near(near))
        problem.set(best)
        return problem.told(best, problem.strain(best), problem.off(best))
    best = problem.solve()
    if arm.wrist[1:] and normal is not None:  # the last joint may roll as the forearm does
        kept = problem.solve(problem.with_the_last_at_home())
        if problem.off(kept) < problem.off(best) + ROUND:
            best = kept
    within = problem.solve(bounded=True, start=best)
    off, strain = problem.off(within), problem.strain(within)
    best = problem.rounded(best)
    problem.set(best)
    return problem.told(best, strain, off)


class _Problem:
    """What is to be made small, over the angles (j,) of an arm's joints."""

    def __init__(
        self,
        tree: Tree,
        arm: ArmAnatomy,
        frame: Frame,
        side: float,
        fingers: FloatArray,
        normal: FloatArray | None,
        outward: float,
        bend: float,
    ) -> None:
        self.tree, self.arm, self.frame = tree, arm, frame
        self._places = np.array([tree.model.jnt_qposadr[j] for j in arm.joints])
        self._home = tree.source.home[self._places].copy()
        self._range = np.array([limits(tree, j) for j in arm.joints]).T
        self._bend = arm.joints.index(arm.elbow)
        self._bent = arm.straight + arm.flexion * bend
        self._home[self._bend] = self._bent
        self._down = -np.cos(outward) * frame.up + side * np.sin(outward) * frame.left
        self._reach = np.cos(0.5 * bend), np.sin(0.5 * bend)  # down, and forward by the bent elbow
        self._fingers, self._normal = fingers, normal
        # What two joints could do as well is done by the one nearer to the trunk.
        self._weights = NEAR_HOME * np.linspace(1.0, 2.0, len(arm.joints))
        self._medial = -side * frame.left

    def stay_near(self, angles: Mapping[str, float]) -> FloatArray:
        """Take other angles for home; returns them (j,)."""
        home: FloatArray = np.array([angles[self.tree.joint_name(j)] for j in self.arm.joints])
        home[self._bend] = self._bent
        self._home = home
        return home

    def set(self, q: FloatArray) -> None:
        self.tree.data.qpos[self._places] = q
        mujoco.mj_kinematics(self.tree.model, self.tree.data)

    def misses(self) -> list[FloatArray]:
        """Differences of directions from those wanted, as the tree is posed now."""
        tree, arm, down = self.tree, self.arm, self._down
        shoulder, _, wrist = arm.places(tree)
        bends = arm.flexion * tree.axis(arm.elbow)
        hand = tree.data.xmat[arm.hand].reshape(3, 3)
        # Upper arm and forearm together, since an elbow may lie beside the line.
        to_wrist = self._reach[0] * down + self._reach[1] * self.frame.forward
        along = 2.0 * self._reach[0] * to_wrist - down  # of the forearm: turned twice as far
        found = [unit(wrist - shoulder) - to_wrist, bends + self.frame.left]
        found.append(hand @ self._fingers - along)
        if self._normal is not None:
            found.append(hand @ self._normal - self._medial)
        return found

    def with_the_last_at_home(self) -> FloatArray:
        """Weights of staying near home (j,) that all but hold the last joint there."""
        weights = self._weights.copy()
        weights[-1] = 10.0
        return weights

    def solve(
        self,
        weights: FloatArray | None = None,
        *,
        bounded: bool = False,
        start: FloatArray | None = None,
    ) -> FloatArray:
        """The best angles (j,): within the limits, or past them where nothing else hangs."""
        low, high = (np.clip(limit, -2.0 * np.pi, 2.0 * np.pi) for limit in self._range)
        far = np.full_like(low, 2.0 * np.pi)
        bounds = (low, high) if bounded else (-far, far)
        rng = np.random.default_rng(0)
        starts = [self._home] if start is None else [start]
        starts += [rng.uniform(low, high) for _ in range(STARTS if start is None else 0)]
        best, least = starts[0], np.inf
        near = self._weights if weights is None else weights

        def residual(columns: FloatArray) -> FloatArray:
            rows = []
            for q in columns.T:
                self.set(q)
                neat = [NEATLY * self._askew(j) for j in self.arm.shoulder]
                over = BEYOND * (np.maximum(q - high, 0.0) + np.maximum(low - q, 0.0))
                over[self._bend] = STRAIGHT * (q[self._bend] - self._bent)
                rows.append(np.concatenate([*self.misses(), neat, near * (q - self._home), over]))
            return np.array(rows).T

        for begin in starts:
            found, _ = minimize.least_squares(
                np.clip(begin, *bounds),
                residual,
                bounds=bounds,
                verbose=minimize.Verbosity.SILENT,
            )
            cost = float(np.sum(residual(found.reshape(-1, 1)) ** 2))
            if cost < least - 1e-6:
                best, least = found.ravel(), cost
        return best

    def _askew(self, joint: int) -> float:
        """Angle between the axis of a joint and the nearest direction of the body [rad]."""
        along = np.max(np.abs(self.frame.axes @ self.tree.axis(joint)))
        return float(np.arccos(min(along, 1.0)))

    def off(self, q: FloatArray) -> float:
        """The largest angle by which a direction is missed [rad]."""
        self.set(q)
        chords = [min(float(np.linalg.norm(miss)) / 2.0, 1.0) for miss in self.misses()]
        straight = abs(float(q[self._bend]) - self._bent)
        return max(2.0 * float(np.arcsin(max(chords))), straight)

    def strain(self, q: FloatArray) -> float:
        """How far a posture is from home, squared, and how much it lacks of hanging."""
        self.set(q)
        lacking = sum(float(miss @ miss) for miss in self.misses())
        return float(np.sum((q - self._home) ** 2)) + 10.0 * lacking

    def told(self, q: FloatArray, strain: float, off: float) -> Hanging:
        """Angles by the names of the joints."""
        names = [self.tree.joint_name(j) for j in self.arm.joints]
        return Hanging(dict(zip(names, q.tolist(), strict=True)), strain, off)

    def rounded(self, q: FloatArray) -> FloatArray:
        """The same with neat angles, where that changes nothing to speak of."""
        step = np.deg2rad(15.0)
        neat = np.round(q / step) * step
        close: FloatArray = np.where(np.abs(neat - q) < ROUND, neat, q)
        return close if self.off(close) < self.off(q) + ROUND else q

"""The way of a hand: what is between it and its goal, and how to go round?

Pure kinematics. The palm is led along a path, by inverse kinematics from posture to posture,
all other joints being as they are; the way's clearance is the smallest distance that links
which must not touch have on it. `find_way` looks for via points and a direction of the upper
arm whose way keeps a distance, by the cross-entropy method (Rubinstein 1999): draw some, keep
the best, draw again near those. Seeds are fixed, so that the same question gets the same answer.

Nothing here is proof for the physics: a hand lags behind its path, and springs give.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Arm, Body
from sim.reaching import DIRECTION, PLACE, PalmGoal

FloatArray = NDArray[np.float64]
Curve = Callable[[FloatArray], FloatArray]  # from start, via points and goal (p, 3) to (k, 3)

ROOM = 0.02  # between links that must not touch, on a way that is free [m]
CLOSE = 0.003  # the same where it begins and ends: whoever touches something is near the rest [m]
STRAY = 0.02  # of the palm from its path, on a way that the arm can go [m]
NEAR = 0.06  # from start and goal: there the hand may touch what it leaves, and what it is to [m]
SIGHT = 0.08  # distances beyond this are not measured [m]
POINTS = 20  # of a path that are looked at
STEPS = 8  # of inverse kinematics at most, from each to the next
STIFF = 0.1  # cost of leaving the posture before [1/rad]
ROUNDS, DRAWN, KEPT = 5, 24, 6  # of the search for via points
SPREAD = 0.12  # of the via points that are drawn first [m]
TURN = 0.5  # of the upper arm's direction, likewise [1]


@dataclass(frozen=True)
class Way:
    """How an arm goes along a path of its palm."""

    path: FloatArray  # (k, 3) of the palm, in the world [m]
    postures: FloatArray  # (k, nq)
    clearance: float  # distance of links that must not touch, where it is tightest [m]
    tight: float  # by how much more room is wanted there [m]; 0 if there is enough everywhere
    at: float  # where that is on the path, from 0 to 1
    links: tuple[str, str]  # between which links; empty names if all are far apart
    stray: float  # how far the palm is from its path at most [m]
    cost: float  # what a search makes small: crowding, straying, length, turning

    @property
    def free(self) -> bool:
        """Whether the arm can go it and keeps its distance."""
        return self.tight == 0.0 and self.stray <= STRAY


@dataclass(frozen=True)
class Detour:
    """Via points and a direction of the upper arm, and the way that they make."""

    via: tuple[FloatArray, ...]  # (3,) each, in the frame of the link that carries the arm [m]
    shares: tuple[float, ...]  # of the length from point to point, at which they are passed
    upper_arm: FloatArray | None  # (3,) unit, in the body's frame; None leaves it free
    way: Way


def straight(knots: FloatArray) -> FloatArray:
    """A path (POINTS, 3) straight from knot to knot (p, 3), at one speed."""
    along = _lengths(knots)
    asked = np.linspace(0.0, along[-1], POINTS)
    return np.stack([np.interp(asked, along, axis) for axis in knots.T], axis=1)


def straight_way(body: Body, start: FloatArray, arm: Arm, goal: PalmGoal) -> Way:
    """The way of the hand straight from where it is in posture `start` (nq,) to a goal."""
    return _Scene(body, start, arm, goal).way((), goal.upper_arm, straight)


def way_gone(body: Body, arm: Arm, goal: PalmGoal, path: FloatArray, postures: FloatArray) -> Way:
    """The way that a palm went (k, 3) in postures (k, nq) of the whole body."""
    return _Scene(body, postures[0], arm, goal).seen(path, postures)


def find_way(
    body: Body,
    start: FloatArray,
    arm: Arm,
    goal: PalmGoal,
    *,
    counts: Sequence[int] = (0, 1, 2),
    curve: Curve = straight,
    seed: int = 0,
) -> Detour:
    """The way with the fewest via points that is free, or the best that is found.

    Args:
        body: whose arm it is.
        start: posture (nq,) of the whole body in which the way begins.
        arm: the arm.
        goal: where the palm is to be; a direction of the upper arm that it gives is kept.
        counts: of via points that are tried, one after the other; 0 is the straight way.
        curve: the path through start, via points and goal.
        seed: of the search.

    Returns:
        The way; whether it is good enough is for `way.free` to say.
    """
    scene = _Scene(body, start, arm, goal)
    best: Detour | None = None
    for count in counts:
        if count == 0:
            found = scene.detour((), goal.upper_arm, curve)
        else:
            found = _search(scene, count, curve, np.random.default_rng([seed, count]))
        if best is None or found.way.free or found.way.cost < best.way.cost:
            best = found
        if found.way.free:
            break
    if best is None:
        raise ValueError("counts is empty: give at least one number of via points")
    carrier, axes = scene.frame(arm.root)
    return replace(best, via=tuple(axes.T @ (point - carrier) for point in best.via))


def _search(scene: "_Scene", count: int, curve: Curve, rng: np.random.Generator) -> Detour:
    """The best of `count` via points, in the world, by the cross-entropy method."""
    points, free = scene.first_guess(count), scene.goal.upper_arm is None
    mean = np.concatenate([points.ravel(), scene.upper_arm if free else ()])
    size = np.where(np.arange(len(mean)) < 3 * count, SPREAD, TURN)
    best: Detour | None = None
    for _ in range(ROUNDS):
        drawn = mean + size * rng.standard_normal((DRAWN, len(mean)))
        drawn[0] = mean
        tried = []
        for row in drawn:
            via = tuple(row[: 3 * count].reshape(count, 3))
            along = row[3 * count :]
            upper = along / np.linalg.norm(along) if free else scene.goal.upper_arm
            tried.append(scene.detour(via, upper, curve))
        order = np.argsort([t.way.cost for t in tried], kind="stable")
        if best is None or tried[order[0]].way.cost < best.way.cost:
            best = tried[order[0]]
        kept = drawn[order[:KEPT]]
        mean, size = kept.mean(axis=0), 0.5 * (size + kept.std(axis=0))
    assert best is not None
    return best


class _Scene:
    """One question: an arm, the posture in which it begins, and its goal."""

    def __init__(self, body: Body, start: FloatArray, arm: Arm, goal: PalmGoal) -> None:
        self.body, self.arm, self.goal, self.start = body, arm, goal, start
        self.data = mujoco.MjData(body.model)
        self._set(start)
        place, axes = self.frame(goal.place.link)
        self.target = place + axes @ goal.place.point
        self.palm = self._palm()
        hand = self.frame(arm.hand)[1]
        self.normal, self.outward = hand @ arm.palm.normal, np.zeros(3)
        if goal.normal is not None:
            self.outward = -goal.normal
        along = self.frame(arm.forearm)[0] - self.frame(arm.upper_arm)[0]
        self.upper_arm = along / np.linalg.norm(along)
        self._pairs = _pairs(body, arm, goal.touched)
        self._leaves = {
            key for key, group in self._pairs.items() if self._closest(group) < ROOM
        }  # what is close already as the way begins
        self._lead = _Lead(body, arm)

    def frame(self, link: int) -> tuple[FloatArray, FloatArray]:
        """Origin (3,) and axes (3, 3) of a link as the way begins."""
        return self.data.xpos[link].copy(), self.data.xmat[link].reshape(3, 3).copy()

    def first_guess(self, count: int) -> FloatArray:
        """Via points (count, 3) in the world: in front of the trunk, then before the goal."""
        _, axes = self.frame(self.arm.root)
        middle = 0.5 * (self.palm + self.target)
        before = self.target + 0.12 * self.outward + 0.04 * axes[:, 0]
        front = middle + 0.15 * axes[:, 0]
        return np.array([0.5 * (front + before)] if count == 1 else [front, before][:count])

    def way(self, via: tuple[FloatArray, ...], upper_arm: FloatArray | None, curve: Curve) -> Way:
        """The way through via points in the world."""
        path = curve(np.array([self.palm, *via, self.target]))
        return self.seen(path, self._lead(self.start, path, self, upper_arm))

    def detour(
        self, via: tuple[FloatArray, ...], upper_arm: FloatArray | None, curve: Curve
    ) -> Detour:
        """The way through via points, and the points themselves, still in the world."""
        along = _lengths(np.array([self.palm, *via, self.target]))
        shares = tuple(along[1:-1] / max(along[-1], 1e-9))
        return Detour(via, shares, upper_arm, self.way(via, upper_arm, curve))

    def seen(self, path: FloatArray, postures: FloatArray) -> Way:
        """What there is to say of postures (k, nq) whose palm was to be on a path (k, 3)."""
        shares = np.linspace(0.0, 1.0, len(path))
        least, asked, where, links = SIGHT, ROOM, 0.0, ("", "")
        crowding, stray = 0.0, 0.0
        for share, wanted, q in zip(shares, path, postures, strict=True):
            self._set(q)
            stray = max(stray, float(np.linalg.norm(self._palm() - wanted)))
            gone, left = (float(np.linalg.norm(wanted - end)) for end in (self.palm, self.target))
            room = min(ROOM, CLOSE + 0.3 * min(gone, left))
            for key, group in self._pairs.items():
                if (gone < NEAR and key in self._leaves) or (left < NEAR and group.touches):
                    continue
                distance = self._closest(group)
                crowding += max(0.0, 1.0 - distance / (1.5 * room)) ** 2 * POINTS / len(path)
                if distance - room < least - asked:
                    least, asked, where, links = distance, room, float(share), key
        self._set(self.start)
        length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
        turned = np.abs(np.diff(postures, axis=0)).sum()
        cost = crowding + 50.0 * max(0.0, stray - 0.5 * STRAY) + 0.3 * length + 0.05 * turned
        tight = max(0.0, asked - least)
        return Way(path, postures, least, tight, where, links, stray, float(cost))

    def _closest(self, group: "_Group") -> float:
        """Least distance of two links, as `data` has them [m]; SIGHT if it is more."""
        least, model = SIGHT, self.body.model
        for a, b in product(group.mine, group.theirs):
            least = min(least, mujoco.mj_geomDistance(model, self.data, a, b, least, None))
        return float(least)

    def _palm(self) -> FloatArray:
        place, axes = self.frame(self.arm.hand)
        palm: FloatArray = place + axes @ self.arm.palm.point
        return palm

    def _set(self, qpos: FloatArray) -> None:
        self.data.qpos[:] = qpos
        mujoco.mj_kinematics(self.body.model, self.data)


@dataclass(frozen=True)
class _Group:
    """The colliding geoms of two links that are to be kept apart."""

    mine: list[int]
    theirs: list[int]
    touches: bool  # the hand is to touch it in the end


def _pairs(body: Body, arm: Arm, touched: int) -> dict[tuple[str, str], _Group]:
    """What must not touch an arm, by the names of the links: the other arm too."""
    own = {arm.limb.upper_arm, arm.limb.forearm, arm.limb.hand}
    found = {}
    for names in body.map.keep_apart:
        one, other = sorted(names, key=lambda name: name not in own)
        if one not in own or other in own:
            continue
        touches = (body.link(one), body.link(other)) == (arm.hand, touched)
        mine, theirs = (body.colliding(body.link(name)) for name in (one, other))
        if mine and theirs:
            found[one, other] = _Group(mine, theirs, touches)
    return found


class _Lead:
    """Leads the palm along a path by inverse kinematics, as mink does it."""

    def __init__(self, body: Body, arm: Arm) -> None:
        import mink  # noqa: PLC0415  (half a second that most tasks never need)

        self._mink, self._arm = mink, arm
        self._configuration = mink.Configuration(body.model, body.home)
        others = [j for j in range(body.nv) if j not in set(arm.dofs)]
        self._frozen = [mink.DofFreezingTask(body.model, others)] if others else []
        self._limits = [mink.ConfigurationLimit(body.model)]
        self._place = mink.FrameTask(
            arm.limb.palm, "site", position_cost=PLACE, orientation_cost=0.0
        )
        self._stay = mink.PostureTask(body.model, cost=STIFF)
        along = body.to_link(arm.upper_arm, body.upper_arm_at_home(arm))
        self._palm = mink.AxisAlignTask(arm.limb.hand, "body", axis=arm.palm.normal, cost=DIRECTION)
        self._upper_arm = mink.AxisAlignTask(arm.limb.upper_arm, "body", axis=along, cost=DIRECTION)

    def __call__(
        self,
        start: FloatArray,
        path: FloatArray,
        scene: _Scene,
        upper_arm: FloatArray | None,
    ) -> FloatArray:
        """Postures (k, nq) whose palm is on the path (k, 3), from a start (nq,)."""
        configuration, normal = self._configuration, scene.goal.normal
        configuration.update(start)
        tasks = [self._place, self._stay]
        tasks += [self._palm] if normal is not None else []
        tasks += [self._upper_arm] if upper_arm is not None else []
        postures, shares = [start], np.linspace(0.0, 1.0, len(path))
        for share, wanted in zip(shares[1:], path[1:], strict=True):
            self._place.set_target(self._mink.SE3.from_translation(wanted))
            self._stay.set_target(configuration.q)
            if normal is not None:
                self._palm.set_target(_between(scene.normal, normal, share))
            if upper_arm is not None:
                self._upper_arm.set_target(_between(scene.upper_arm, upper_arm, share))
            for _ in range(STEPS):
                try:
                    velocity = self._mink.solve_ik(
                        configuration, tasks, 1.0, "daqp", 1e-2,
                        limits=self._limits, constraints=self._frozen,
                    )  # fmt: skip
                except self._mink.NoSolutionFound:
                    break
                largest = float(np.abs(velocity).max())
                configuration.integrate_inplace(velocity * min(1.0, 0.3 / (largest + 1e-9)), 1.0)
                if largest < 2e-2:
                    break
            postures.append(configuration.q.copy())
        return np.array(postures)


def _lengths(knots: FloatArray) -> FloatArray:
    """How far it is from the first of some points (p, 3) to each, along all of them (p,)."""
    steps = np.linalg.norm(np.diff(knots, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _between(one: FloatArray, other: FloatArray, share: float) -> FloatArray:
    """A direction (3,) between two, so far along."""
    mixed = (1.0 - share) * one + share * other
    length = float(np.linalg.norm(mixed))
    unit: FloatArray = mixed / length if length > 1e-6 else other
    return unit

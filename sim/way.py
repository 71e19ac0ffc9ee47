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
from sim.reaching import PalmGoal
from sim.state import State
from sim.world import World

FloatArray = NDArray[np.float64]
Curve = Callable[[FloatArray], FloatArray]  # from start, via points and goal (p, 3) to (k, 3)

ROOM = 0.02  # between links that must not touch, on a way that is free [m]
CLOSE = 0.003  # the same where it begins and ends: whoever touches something is near the rest [m]
STRAY = 0.02  # of the palm from its path, on a way that the arm can go [m]
NEAR = 0.06  # from start and goal: there the hand may touch what it leaves, and what it is to [m]
SIGHT = 0.08  # distances beyond this are not measured [m]
POINTS = 20  # of a path that are looked at
STEPS = 5  # of inverse kinematics, from each to the next
PLACE, DIRECTION, STIFF = 60.0, 0.3, 0.1  # costs of missing these, of moving [1/m, 1, 1/rad]
BEND = 0.1  # a joint at the end of its range begins so far from it: a straight arm is stuck [rad]
ROUNDS, DRAWN, KEPT = 6, 48, 6  # of the search for via points
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
    return _straight(_Scene(body, start, arm, goal), straight).way


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
            found = _straight(scene, curve)
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


def _straight(scene: "_Scene", curve: Curve) -> Detour:
    """No via points; the upper arm as the goal has it."""
    wish = scene.goal.upper_arm
    (only,) = scene.detours(np.zeros((1, 0, 3)), None if wish is None else wish[None], curve)
    return only


def _search(scene: "_Scene", count: int, curve: Curve, rng: np.random.Generator) -> Detour:
    """The best of `count` via points, in the world, by the cross-entropy method."""
    wish = scene.goal.upper_arm
    turn = scene.upper_arm if wish is None else wish
    mean = np.concatenate([scene.first_guess(count).ravel(), turn])
    size = np.where(np.arange(len(mean)) < 3 * count, SPREAD, TURN if wish is None else 0.0)
    best: Detour | None = None
    for _ in range(ROUNDS):
        drawn = mean + size * rng.standard_normal((DRAWN, len(mean)))
        drawn[0] = mean
        along = drawn[:, 3 * count :]
        along = along / np.linalg.norm(along, axis=1, keepdims=True)
        tried = scene.detours(drawn[:, : 3 * count].reshape(DRAWN, count, 3), along, curve)
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
        self.normal = hand @ arm.palm.normal
        self.facing: FloatArray | None = None
        if goal.normal is not None:  # it turns with what is touched, which may be the other arm
            carrier = goal.place.link if goal.touched >= 0 else arm.root
            self.facing = self.frame(carrier)[1] @ body.to_link(carrier, goal.normal)
        along = self.frame(arm.forearm)[0] - self.frame(arm.upper_arm)[0]
        self.upper_arm = along / np.linalg.norm(along)
        pairs = _pairs(body, arm)
        self._links = [links for _, _, links in pairs]
        one, other = (np.array([pair[k] for pair in pairs], dtype=int) for k in (0, 1))
        radius = body.model.geom_rbound
        self._geoms = one, other, (radius[one] + radius[other] + SIGHT) ** 2
        names = [body.model.body(link).name for link in (arm.hand, max(goal.touched, 0))]
        self._touch = (names[0], names[1])  # what the hand is to touch in the end
        self._leaves = {key for key, distance in self._near().items() if distance < ROOM}

    def frame(self, link: int) -> tuple[FloatArray, FloatArray]:
        """Origin (3,) and axes (3, 3) of a link as the way begins."""
        return self.data.xpos[link].copy(), self.data.xmat[link].reshape(3, 3).copy()

    def first_guess(self, count: int) -> FloatArray:
        """Via points (count, 3) in the world: from the start and over to the goal, in front."""
        forward = self.frame(self.arm.root)[1][:, 0]
        outward = np.zeros(3) if self.facing is None else -self.facing
        before = self.target + 0.12 * outward + 0.04 * forward
        shares = np.linspace(0.0, 1.0, count + 1)[:-1, None] + 0.5 / count
        front = (1.0 - shares) * self.palm + shares * before + 0.15 * forward
        return front if count == 1 else np.concatenate([front[:-1], [before]])

    def detours(
        self, points: FloatArray, upper_arms: FloatArray | None, curve: Curve
    ) -> list[Detour]:
        """The ways through via points (n, p, 3) that stay in the world; upper arms are (n, 3)."""
        n = len(points)
        first, last = (np.tile(end, (n, 1, 1)) for end in (self.palm, self.target))
        knots = np.concatenate([first, points, last], axis=1)
        paths = np.stack([curve(row) for row in knots])
        postures = _Lead(self, n)(paths, upper_arms)
        found = []
        for i in range(n):
            along = _lengths(knots[i])
            shares = tuple(along[1:-1] / max(along[-1], 1e-9))
            upper_arm = None if upper_arms is None else upper_arms[i]
            way = self.seen(paths[i], postures[i])
            found.append(Detour(tuple(points[i]), shares, upper_arm, way))
        return found

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
            for key, distance in self._near().items():
                if (gone < NEAR and key in self._leaves) or (left < NEAR and key == self._touch):
                    continue
                crowding += max(0.0, 1.0 - distance / (1.5 * room)) ** 2 * POINTS / len(path)
                if distance - room < least - asked:
                    least, asked, where, links = distance, room, float(share), key
        self._set(self.start)
        length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
        turned = np.abs(np.diff(postures, axis=0)).sum()
        cost = crowding + 50.0 * max(0.0, stray - 0.5 * STRAY) + 0.3 * length + 0.05 * turned
        tight = max(0.0, asked - least)
        return Way(path, postures, least, tight, where, links, stray, float(cost))

    def _near(self) -> dict[tuple[str, str], float]:
        """Least distances of the links that are within sight of each other, as `data` has them."""
        one, other, sight = self._geoms
        between = self.data.geom_xpos[one] - self.data.geom_xpos[other]
        found: dict[tuple[str, str], float] = {}
        for k in np.flatnonzero(np.einsum("ki,ki->k", between, between) < sight):
            key, model = self._links[k], self.body.model
            least = found.get(key, SIGHT)
            found[key] = min(
                least, mujoco.mj_geomDistance(model, self.data, one[k], other[k], least, None)
            )
        return found

    def _palm(self) -> FloatArray:
        place, axes = self.frame(self.arm.hand)
        palm: FloatArray = place + axes @ self.arm.palm.point
        return palm

    def _set(self, qpos: FloatArray) -> None:
        self.data.qpos[:] = qpos
        mujoco.mj_kinematics(self.body.model, self.data)


def _pairs(body: Body, arm: Arm) -> list[tuple[int, int, tuple[str, str]]]:
    """What must not touch an arm, the other arm too: geoms, and the links that they are of."""
    own = {body.model.body(link).name for link in arm.links}
    found = []
    for names in body.map.keep_apart:
        one, other = sorted(names, key=lambda name: name not in own)
        if one in own and other not in own:
            geoms = product(*(body.colliding(body.link(name)) for name in (one, other)))
            found += [(a, b, (one, other)) for a, b in geoms]
    return found


class _Lead:
    """Leads n palms along paths by damped least squares (Wampler 1986), all at once.

    `sim.reach` finds a posture with mink; here it is thousands of postures, each next to the one
    before, and what they run into is to be seen, not kept away.
    """

    def __init__(self, scene: _Scene, n: int) -> None:
        self._body, self._arm, self._scene = scene.body, scene.arm, scene
        self._world = World(scene.body, n)
        self._places = self._body.qpos_of_dof[self._arm.dofs]
        self._range = tuple(limit[self._arm.dofs] for limit in self._body.range)
        self._root = int(self._body.model.body_rootid[self._arm.hand])
        self._along = self._body.to_link(
            self._arm.upper_arm, self._body.upper_arm_at_home(self._arm)
        )

    def __call__(self, paths: FloatArray, upper_arms: FloatArray | None) -> FloatArray:
        """Postures (n, k, nq) whose palms are on paths (n, k, 3), the first being the start.

        Args:
            paths: of the palms, in the world.
            upper_arms: directions of the upper arms in the end (n, 3); None leaves them free.
        """
        scene, normal = self._scene, self._scene.facing
        n, points = paths.shape[:2]
        start = np.tile(scene.start, (n, 1))
        postures, q, (low, high) = [start], start.copy(), self._range
        q[:, self._places] = np.clip(start[:, self._places], low + BEND, high - BEND)
        for k in range(1, points):
            share, turns = k / (points - 1), []
            if normal is not None:
                towards = np.tile(_between(scene.normal, normal, share), (n, 1))
                turns.append((self._arm.hand, self._arm.palm.normal, towards))
            if upper_arms is not None:
                towards = _between(scene.upper_arm, upper_arms, share)
                turns.append((self._arm.upper_arm, self._along, towards))
            for _ in range(STEPS):
                q = self._step(q, paths[:, k], turns)
            postures.append(q)
        return np.stack(postures, axis=1)

    def _step(
        self,
        qpos: FloatArray,
        wanted: FloatArray,
        turns: Sequence[tuple[int, FloatArray, FloatArray]],
    ) -> FloatArray:
        """Bring palms nearer to places (n, 3), and axes of links to directions (n, 3)."""
        arm, dofs = self._arm, self._arm.dofs
        self._world.reset(qpos)
        state = self._world.state
        palm = state.xpos[:, arm.hand] + _axes(state, arm.hand) @ arm.palm.point
        spin, centre = state.cdof[:, dofs, :3], state.subtree_com[:, self._root]
        moves = state.cdof[:, dofs, 3:] + _cross(spin, (palm - centre)[:, None])
        rows, misses = [PLACE * moves], [PLACE * (wanted - palm)]
        for link, axis, direction in turns:
            now = _axes(state, link) @ axis
            turned = np.where(self._body.ancestors[link][dofs][:, None], spin, 0.0)
            along = np.einsum("nji,ni->nj", turned, now)  # spinning about the axis itself is free
            rows.append(DIRECTION * (turned - along[:, :, None] * now[:, None]))
            misses.append(DIRECTION * _cross(now, direction))
        J, e = np.concatenate(rows, axis=2).swapaxes(1, 2), np.concatenate(misses, axis=1)
        q = qpos[:, self._places]
        change = _solve(J, e)
        beyond = np.clip(q + change, *self._range) != q + change
        change = np.where(beyond, change, _solve(np.where(beyond[:, None], 0.0, J), e))
        change *= np.minimum(1.0, 0.3 / (np.abs(change).max(axis=1, keepdims=True) + 1e-9))
        new = qpos.copy()
        new[:, self._places] = np.clip(q + change, *self._range)
        return new


def _solve(J: FloatArray, e: FloatArray) -> FloatArray:
    """The x (n, j) that make |J x - e|^2 + STIFF^2 |x|^2 least, for J (n, m, j) and e (n, m)."""
    squared = J.swapaxes(1, 2) @ J + STIFF**2 * np.eye(J.shape[2])
    solved = np.linalg.solve(squared, J.swapaxes(1, 2) @ e[:, :, None])[:, :, 0]
    return np.asarray(solved, dtype=np.float64)


def _axes(state: State, link: int) -> FloatArray:
    """Axes (n, 3, 3) of a link."""
    axes: FloatArray = state.xmat[:, link].reshape(-1, 3, 3)
    return axes


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Vector products (..., 3); `np.cross` takes ten times as long for a few."""
    (ax, ay, az), (bx, by, bz) = np.moveaxis(a, -1, 0), np.moveaxis(b, -1, 0)
    product_: FloatArray = np.stack(
        [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1
    )
    return product_


def _lengths(knots: FloatArray) -> FloatArray:
    """How far it is from the first of some points (p, 3) to each, along all of them (p,)."""
    steps = np.linalg.norm(np.diff(knots, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _between(one: FloatArray, other: FloatArray, share: float) -> FloatArray:
    """Directions (..., 3) between two, so far along."""
    mixed = (1.0 - share) * one + share * other
    length = np.linalg.norm(mixed, axis=-1, keepdims=True)
    unit: FloatArray = np.where(length > 1e-6, mixed / np.maximum(length, 1e-6), other)
    return unit

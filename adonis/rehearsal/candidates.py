"""Ways that a rehearsal tries: drawn at random, first widely, then near the best.

A way is a few via points with their times, a direction of the upper arm, a tilt of the palm off
the surface that it touches, and the share of the time in which the hand travels. What the task
itself says is never changed. Numbers are rounded as they are drawn, so that what is written into a
file is what was tried.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from primitives import GoToPoint, ViaPlace
from sim import Body, Detour, axes_of, reach

FloatArray = NDArray[np.float64]

PLACE, TIME, TURN, TILT, TRAVEL = 0.12, 0.08, 0.60, 0.20, 0.06  # first spreads [m], then [1]
EARLIEST, LATEST, BETWEEN = 0.12, 0.92, 0.10  # times of via points, as shares
FEWEST, MOST = 0.65, 0.95  # of the travel
CLOSER = 0.35  # share of the first spread near a way that was found
SLOWLY = 0.3  # of the old spread is kept when it narrows
NARROWEST = 0.08  # of the first spread


@dataclass(frozen=True)
class Family:
    """Ways with the same number of via points: a normal distribution of their numbers.

    The numbers are the via points in the frame of the carrier (3 each), their times, the upper
    arm's direction (3), the tilt of the palm (3), and the travel.
    """

    count: int
    turns: bool  # whether the upper arm is given a direction
    facing: FloatArray | None  # (3,) onto what the palm touches, in the body's frame; None: as said
    mean: FloatArray
    spread: FloatArray

    def draw(self, rng: np.random.Generator, many: int) -> FloatArray:
        """Numbers (many, size) of ways; the first are the mean."""
        rows = self.mean + self.spread * rng.standard_normal((many, len(self.mean)))
        rows[0] = self.mean
        drawn: FloatArray = rows
        return drawn

    def near(self, kept: FloatArray) -> "Family":
        """The family narrowed to the best of its ways (k, size)."""
        least = NARROWEST * _spreads(self.count)
        spread = np.maximum(SLOWLY * self.spread + (1.0 - SLOWLY) * kept.std(axis=0), least)
        return Family(self.count, self.turns, self.facing, kept.mean(axis=0), spread)

    def way(self, numbers: FloatArray, does: GoToPoint, body: Body) -> GoToPoint:
        """A go-to-point that goes this way."""
        root, count = body.arm(does.limb).root, self.count
        points = numbers[: 3 * count].reshape(count, 3)
        turn, tilt = numbers[4 * count : 4 * count + 6].reshape(2, 3)
        more: dict[str, object] = {}
        if count:
            more["via"] = tuple(
                ViaPlace(point=_rounded(body.from_link(root, point), 3), at=at)
                for point, at in zip(points, _times(numbers[3 * count : 4 * count]), strict=True)
            )
        length = float(np.linalg.norm(turn))
        if self.turns and does.upper_arm is None and length > 1e-3:
            more["upper_arm"] = _rounded(turn / length, 2)
        if self.facing is not None:
            more["palm"] = _rounded(_unit(self.facing + tilt), 2)
        if "travel" not in does.model_fields_set:
            more["travel"] = round(float(np.clip(numbers[-1], FEWEST, MOST)), 2)
        return does.model_copy(update=more)


def family(detour: Detour, does: GoToPoint, body: Body, start: FloatArray) -> Family:
    """The ways near a detour that kinematics found for a go-to-point.

    Args:
        detour: that was found.
        does: the go-to-point.
        body: whose arm it is.
        start: posture (nq,) of the whole body in which the way begins.
    """
    times = _when(np.array(detour.shares))
    turn = np.zeros(3) if detour.upper_arm is None else detour.upper_arm
    mean = np.concatenate([np.ravel(detour.via), times, turn, np.zeros(3), [does.travel]])
    count = len(detour.via)
    return Family(
        count, detour.upper_arm is not None, _facing(does, body, start), mean, _spreads(count)
    )


def settled(one: Family, does: GoToPoint, body: Body, start: FloatArray) -> Family:
    """The same ways, but ending as inverse kinematics would have the arm beside the others.

    Args:
        one: ways near a detour.
        does: the go-to-point.
        body: whose arm it is.
        start: posture (nq,) of the whole body in which the way begins.
    """
    arm = body.arm(does.limb)
    (angles,), _ = reach(body, arm, [does.palm_goal(body)], posture=start)
    _, normal, _, upper_arm = body.palm_goal(arm, angles)
    mean = one.mean.copy()
    mean[4 * one.count : 4 * one.count + 3] = body.from_link(arm.root, upper_arm)
    if one.facing is not None:
        mean[4 * one.count + 3 : 4 * one.count + 6] = body.from_link(arm.root, normal) - one.facing
    return replace(one, mean=mean, turns=True)


def near_way(way: GoToPoint, said: GoToPoint, body: Body, start: FloatArray) -> Family:
    """The ways near one that was found.

    Args:
        way: that was found.
        said: what the task itself says of it.
        body: whose arm it is.
        start: posture (nq,) of the whole body in which the way begins.
    """
    root, count, facing = body.arm(way.limb).root, len(way.via), _facing(said, body, start)
    via = [body.to_link(root, np.array(via.point)) for via in way.via]
    times = [via.at for via in way.via]
    turn = np.zeros(3) if way.upper_arm is None else body.direction(way.upper_arm)
    tilt = np.zeros(3)
    if facing is not None and way.palm is not None:
        tilt = body.direction(way.palm) - facing
    mean = np.concatenate([np.ravel(via), times, turn, tilt, [way.travel]])
    return Family(count, way.upper_arm is not None, facing, mean, CLOSER * _spreads(count))


def _facing(does: GoToPoint, body: Body, start: FloatArray) -> FloatArray | None:
    """Which way a palm faces, if it may be tilted: not if the task says it."""
    goal, root = does.palm_goal(body), body.arm(does.limb).root
    if does.palm is not None or goal.normal is None:
        return None
    link = goal.place.link
    facing = axes_of(body, start, link) @ body.to_link(link, goal.normal)
    return body.from_link(root, axes_of(body, start, root).T @ facing)


def _unit(vector: FloatArray) -> FloatArray:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])


def _spreads(count: int) -> FloatArray:
    return np.repeat([PLACE, TIME, TURN, TILT, TRAVEL], [3 * count, count, 3, 3, 1])


def _when(shares: FloatArray) -> FloatArray:
    """When a minimum-jerk movement has gone so much of its way, as shares of its time."""
    s = np.linspace(0.0, 1.0, 201)
    return np.interp(shares, s**3 * (10.0 - 15.0 * s + 6.0 * s**2), s)


def _times(numbers: FloatArray) -> list[float]:
    """Times in order, with some time between them."""
    times: list[float] = []
    for k, number in enumerate(np.sort(numbers)):
        earliest = EARLIEST if k == 0 else times[-1] + BETWEEN
        latest = LATEST - BETWEEN * (len(numbers) - 1 - k)
        times.append(round(float(np.clip(number, earliest, latest)), 2))
    return times


def _rounded(vector: FloatArray, digits: int) -> tuple[float, float, float]:
    x, y, z = (round(float(v), digits) + 0.0 for v in vector)
    return x, y, z

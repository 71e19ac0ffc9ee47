"""Inverse kinematics: which joint angles put a palm somewhere?

Differential inverse kinematics by mink: the palm's place comes first, then the directions of
palm, fingers and upper arm, then staying near a posture; joint limits hold, and links that
must not touch stay apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Arm, Body, Spot

FloatArray = NDArray[np.float64]

PLACE, DIRECTION, POSTURE = 20.0, 1.0, 0.05  # costs: [1/m], [1], [1/rad]
NEAR = 5e-4  # close enough [m]
STEPS = 150  # at most, from each of the postures to start from
ROOM = 0.002  # left between links that must not touch [m]


@dataclass(frozen=True)
class PalmGoal:
    """Where a palm is to be; directions are unit vectors of the body's frame at home."""

    place: Spot  # `normal` is not used
    normal: FloatArray | None = None  # out of the palm
    fingers: FloatArray | None = None
    upper_arm: FloatArray | None = None
    touched: int = -1  # the link that the palm may touch


def reach(
    body: Body, arm: Arm, goals: Sequence[PalmGoal], *, posture: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Postures that take a palm through places to a goal, all other joints staying as they are.

    The last goal is solved first, since it says most; each place on the way is then reached
    in the posture that is nearest to the one after it.

    Args:
        body: whose arm it is.
        arm: the arm.
        goals: where the palm is to be, in their order.
        posture: of the whole body (nq,), whose other limbs are kept apart from, too; default:
            at home, other limbs being out of the way.

    Returns:
        Joint angles (goals, nv) [rad], NaN for all other joints, and by how much the palm
        misses each goal (goals,) [m]; how deep links are in each other that must not touch counts
        as well.
    """
    places = body.qpos_of_dof[arm.dofs]
    postures = np.full((len(goals), body.nv), np.nan)
    misses = np.zeros(len(goals))
    low, high = (np.clip(limit[arm.dofs], -np.pi, np.pi) for limit in body.range)
    still = body.home if posture is None else posture
    home = still[places]
    starts = [home, 0.5 * (low + high), 0.3 * low + 0.7 * high, 0.7 * low + 0.3 * high]
    for k in range(len(goals) - 1, -1, -1):
        solve, best, least = _Solver(body, arm, goals[k], still, posture is not None), home, np.inf
        for start in starts:
            angles, miss = solve(start)
            if miss < least - NEAR:
                best, least = angles, miss
            if least < NEAR:
                break
        postures[k, arm.dofs], misses[k] = best, least
        starts = [best, *starts]
    return postures, misses


class _Solver:
    """mink's tasks for one goal."""

    def __init__(
        self, body: Body, arm: Arm, goal: PalmGoal, posture: FloatArray, limbs: bool
    ) -> None:
        import mink  # noqa: PLC0415  (half a second that most tasks never need)

        self._mink, self._places = mink, body.qpos_of_dof[arm.dofs]
        self._configuration, self._posture = mink.Configuration(body.model, posture), posture
        others = [j for j in range(body.nv) if j not in set(arm.dofs)]
        self._frozen = [mink.DofFreezingTask(body.model, others)] if others else []
        data, spot = self._configuration.data, goal.place
        self._palm = arm.limb.palm
        self._place = data.xpos[spot.link] + data.xmat[spot.link].reshape(3, 3) @ spot.point
        place = mink.FrameTask(self._palm, "site", position_cost=PLACE, orientation_cost=0.0)
        place.set_target(mink.SE3.from_translation(self._place))
        self._near = mink.PostureTask(body.model, cost=POSTURE)
        self._tasks = [place, self._near]
        along = body.to_link(arm.upper_arm, body.upper_arm_at_home(arm))
        facing = spot.link if goal.touched >= 0 else arm.root  # turns with what is touched
        for link, axis, wanted, carrier in (
            (arm.limb.hand, arm.palm.normal, goal.normal, facing),
            (arm.limb.hand, arm.fingers, goal.fingers, arm.root),
            (arm.limb.upper_arm, along, goal.upper_arm, arm.root),
        ):
            if wanted is not None:
                turn = mink.AxisAlignTask(link, "body", axis=axis, cost=DIRECTION)
                axes = data.xmat[carrier].reshape(3, 3)
                turn.set_target(axes @ body.to_link(carrier, wanted))
                self._tasks.append(turn)
        self._pairs = pairs = body.geoms_to_keep_apart(arm, goal.touched, limbs=limbs)
        self._limits: list[mink.Limit] = [mink.ConfigurationLimit(body.model)]
        if pairs:
            self._limits.append(
                mink.CollisionAvoidanceLimit(
                    body.model,
                    pairs,
                    minimum_distance_from_collisions=ROOM,
                    collision_detection_distance=0.1,
                )
            )

    def __call__(self, start: FloatArray) -> tuple[FloatArray, float]:
        """Angles of the arm's joints found from a start, and the palm's miss [m], see `reach`."""
        q = self._posture.copy()
        q[self._places] = start
        self._configuration.update(q)
        self._near.set_target(q)
        for _ in range(STEPS):
            try:
                velocity = self._mink.solve_ik(
                    self._configuration, self._tasks, 1.0, "daqp", 1e-2,
                    limits=self._limits, constraints=self._frozen,
                )  # fmt: skip
            except self._mink.NoSolutionFound:
                break
            largest = float(np.abs(velocity).max())
            self._configuration.integrate_inplace(velocity * min(1.0, 0.3 / (largest + 1e-9)), 1.0)
            if largest < 1e-4:
                break
        palm = self._configuration.get_transform_frame_to_world(self._palm, "site").translation()
        miss = float(np.linalg.norm(palm - self._place))
        return self._configuration.q[self._places].copy(), miss + self._depth()

    def _depth(self) -> float:
        """How deep links are in each other; mink keeps them from going in, and leads none out."""
        model, data = self._configuration.model, self._configuration.data
        closest = [
            mujoco.mj_geomDistance(model, data, a, b, 0.0, None)
            for one, other in self._pairs
            for a in one
            for b in other
        ]
        return max(0.0, -min(closest, default=0.0))

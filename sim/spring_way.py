"""The way that springs on a hand take an arm, if they take it slowly: kinematics, no simulation.

At every place on the way the joints come to rest where the moments of the springs that pull the
hand, turn it, keep the fingers in line and point the upper arm are in balance,

    J_h^T [K (x_d - x), k_n n x n_d + k_f f x f_d] + J_e^T [0, k_e u x u_d] = 0,

found by Gauss-Newton steps within the joint limits (springs as in Mataric et al. 1999, eq 7 to 9).
What they leave open, the swivel of the elbow, goes the way of least inertia and damping, as that
of a limb does that is pulled by its hand (Khatib 1987).
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Arm, Body, Spot

FloatArray = NDArray[np.float64]

STEPS = 6  # Gauss-Newton steps at each place, at most
NEAR = 1e-3  # [rad] a step that changes less is the last
LEAP = 0.5  # [rad] the largest step
# Of a movement in the time T the largest acceleration and speed are 5.8 / T^2 and 1.9 / T of the
# way (minimum jerk), so damping counts this much of T beside inertia.
DRAGGING = 0.33
LOOSE = 0.8  # share of their firmness that fingers which are free lose


@dataclass(frozen=True)
class HandPath:
    """What springs want of a hand at k places; directions are unit vectors of the world."""

    place: FloatArray  # (k, 3) of the palm [m]
    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    # How far the hand has turned (k,), from 0, as it was on the forearm, to 1, as it is to be.
    late: FloatArray
    normal: FloatArray | None = None  # (3,) out of the palm in the end; None: as on the forearm
    fingers: FloatArray | None = None  # (3,) in the end; None: loosely in line with the forearm
    upper_arm: FloatArray | None = None  # (k, 3) from shoulder to elbow
    turn_stiffness: float = 0.0  # of normal and fingers [N m/rad]
    turn_damping: float = 0.0  # of the hand [N m s/rad]
    upper_arm_stiffness: float = 0.0  # [N m/rad]
    joint_damping: FloatArray | float = 0.0  # of each joint of the arm (j,) [N m s/rad]
    duration: float = 0.0  # of the movement, which says how much damping counts [s]


@dataclass(frozen=True)
class Springs:
    """What moves some joints along a way, at k places of it."""

    qpos: FloatArray  # (k, nq) where the springs would have the body [rad]
    stiffness: FloatArray  # (k, j, j) of the joints [N m/rad]
    damping: FloatArray  # (k, j, j) of the difference from the wanted velocity [N m s/rad]
    drag: FloatArray  # (k, j, j) of the velocity itself [N m s/rad]


def spring_way(body: Body, arm: Arm, start: FloatArray, path: HandPath) -> Springs:
    """How springs lead an arm along a path of its hand; all else stays as it starts.

    Args:
        body: whose arm it is.
        arm: the arm.
        start: posture (nq,) in which the way begins.
        path: of its hand.
    """
    pulled, columns = _Pulled(body, arm, start, path), body.qpos_of_dof[arm.dofs]
    low, high = (limit[arm.dofs] for limit in body.range)
    q, count, joints = start.copy(), len(path.place), len(arm.dofs)
    way = np.empty((count, len(start)))
    stiffness, damping, drag = np.zeros((3, count, joints, joints))
    for k in range(count):
        for _ in range(STEPS):
            pulled.move(q)
            stiffness[k], pull = pulled.springs(k)
            damping[k], drag[k], lazy = pulled.dampers()
            step = _within(lazy + stiffness[k], pull, low - q[columns], high - q[columns])
            q[columns] += step
            if np.abs(step).max() < NEAR:
                break
        way[k] = q
    return Springs(way, stiffness, damping, drag)


class _Pulled:
    """An arm that is pulled by its hand."""

    def __init__(self, body: Body, arm: Arm, start: FloatArray, path: HandPath) -> None:
        self._body, self._arm, self._path = body, arm, path
        self._data = mujoco.MjData(body.model)
        self._mass = np.zeros((body.nv, body.nv))
        self._passive = passive_damping(body, arm.dofs)
        self._own = np.eye(len(arm.dofs)) * path.joint_damping
        hand, forearm = axes_of(body, start, arm.hand), axes_of(body, start, arm.forearm)
        # The palm's normal and the fingers as they are on the forearm when it begins.
        self._kept = forearm.T @ hand @ arm.palm.normal, forearm.T @ hand @ arm.fingers

    def move(self, qpos: FloatArray) -> None:
        """Bring kinematics and Jacobians (3, j) to a posture (nq,)."""
        body, data, arm = self._body, self._data, self._arm
        data.qpos[:] = qpos
        mujoco.mj_kinematics(body.model, data)
        mujoco.mj_comPos(body.model, data)
        self._palm = place_of(data, arm.palm)
        self._linear, self._angular = self._jacobians(arm.hand)
        self._hand = data.xmat[arm.hand].reshape(3, 3)

    def springs(self, k: int) -> tuple[FloatArray, FloatArray]:
        """Stiffness (j, j) and torque (j,) of the springs at the k-th place."""
        path, arm, data = self._path, self._arm, self._data
        stiffness = path.stiffness * self._linear.T @ self._linear
        pull = path.stiffness * self._linear.T @ (path.place[k] - self._palm)
        _, carrying = self._jacobians(arm.forearm)
        for firmness, own, wanted, carried in self._turns(k):
            relative = self._angular - carried * carrying
            stiffness += firmness * self._angular.T @ relative
            pull += firmness * self._angular.T @ _turn(own, wanted)
        if path.upper_arm is not None:
            _, swing = self._jacobians(arm.upper_arm)
            along = _along(data, arm.upper_arm, arm.forearm)
            stiffness += path.upper_arm_stiffness * swing.T @ swing
            pull += path.upper_arm_stiffness * swing.T @ _turn(along, path.upper_arm[k])
        return stiffness, pull

    def dampers(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Damping and drag (j, j), and what makes the joints slow to move: see `DRAGGING`."""
        path, dofs = self._path, self._arm.dofs
        mujoco.mj_crb(self._body.model, self._data)
        mujoco.mj_fullM(self._body.model, self._data, self._mass)
        damping = path.damping * self._linear.T @ self._linear
        drag = self._own + path.turn_damping * self._angular.T @ self._angular
        lazy = self._mass[np.ix_(dofs, dofs)] + DRAGGING * path.duration * (self._passive + drag)
        return damping, drag, lazy

    def _turns(self, k: int) -> list[tuple[float, FloatArray, FloatArray, float]]:
        """Of palm and fingers: firmness, where they point, where to, and how far that turns with
        the forearm.
        """  # noqa: D205
        path, arm, data, late = self._path, self._arm, self._data, self._path.late[k]
        forearm = data.xmat[arm.forearm].reshape(3, 3)
        normal, ahead = (forearm @ kept for kept in self._kept)
        free = path.fingers is None
        goal = path.fingers if path.fingers is not None else _along(data, arm.forearm, arm.hand)
        if path.normal is not None:
            normal = turned(normal, path.normal, late)
        ahead = turned(ahead, goal, late)
        ahead = ahead - (ahead @ normal) * normal
        ahead /= max(float(np.linalg.norm(ahead)), 1e-9)
        firm = path.turn_stiffness * (1.0 - LOOSE * late if free else 1.0)
        return [
            (path.turn_stiffness, self._hand @ arm.palm.normal, normal,
             1.0 if path.normal is None else 1.0 - late),
            (firm, self._hand @ arm.fingers, ahead, 1.0 if free else 1.0 - late),
        ]  # fmt: skip

    def _jacobians(self, link: int) -> tuple[FloatArray, FloatArray]:
        """Of the palm, as if it were fixed to a link: linear and angular, (3, j) each."""
        both = np.zeros((2, 3, self._body.nv))
        mujoco.mj_jac(self._body.model, self._data, both[0], both[1], self._palm, link)
        return both[0][:, self._arm.dofs], both[1][:, self._arm.dofs]


def passive_damping(body: Body, dofs: NDArray[np.int32]) -> FloatArray:
    """Damping of some joints themselves (j, j) [N m s/rad]."""
    every = np.array(body.model.dof_damping, dtype=float).reshape(body.nv, -1)[:, 0]
    return np.diag(every[dofs])


def places_of(body: Body, qpos: FloatArray, spots: list[Spot]) -> FloatArray:
    """Where points that are fixed to links are [m] (spots, 3) in a posture (nq,)."""
    data = mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(body.model, data)
    return np.array([place_of(data, spot) for spot in spots])


def origin(link: int) -> Spot:
    """The origin of a link, as a point of it."""
    return Spot(link, np.zeros(3), np.zeros(3))


def axes_of(body: Body, qpos: FloatArray, link: int) -> FloatArray:
    """The axes of a link (3, 3), as columns, in a posture (nq,)."""
    data = mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(body.model, data)
    axes: FloatArray = data.xmat[link].reshape(3, 3).copy()
    return axes


def palm_jacobian(body: Body, arm: Arm, qpos: FloatArray) -> FloatArray:
    """Of the palm's place with respect to the arm's joints (3, j), in a posture (nq,)."""
    data, jacobian = mujoco.MjData(body.model), np.zeros((3, body.nv))
    data.qpos[:] = qpos
    mujoco.mj_kinematics(body.model, data)
    mujoco.mj_comPos(body.model, data)
    mujoco.mj_jac(body.model, data, jacobian, None, place_of(data, arm.palm), arm.hand)
    return jacobian[:, arm.dofs]


def place_of(data: mujoco.MjData, spot: Spot) -> FloatArray:
    """Where a point that is fixed to a link is, in the present kinematics."""
    place: FloatArray = data.xpos[spot.link] + data.xmat[spot.link].reshape(3, 3) @ spot.point
    return place


def turned(start: FloatArray, goal: FloatArray, share: float) -> FloatArray:
    """The unit vector so far on the great circle from one to another."""
    cosine = float(np.clip(start @ goal, -1.0, 1.0))
    angle = float(np.arccos(cosine))
    if angle < 1e-6:
        return goal
    aside = goal - cosine * start
    if np.pi - angle < 1e-3:  # any way round
        aside = np.cross(start, np.roll(start, 1) + np.array([0.0, 0.0, 1e-3]))
    unit: FloatArray = aside / np.linalg.norm(aside)
    between: FloatArray = np.cos(share * angle) * start + np.sin(share * angle) * unit
    return between


def _along(data: mujoco.MjData, one: int, other: int) -> FloatArray:
    """Unit vector from the origin of a link to that of another."""
    way = data.xpos[other] - data.xpos[one]
    unit: FloatArray = way / np.linalg.norm(way)
    return unit


def _turn(own: FloatArray, wanted: FloatArray) -> FloatArray:
    """Rotation vector that takes one unit vector to another, its length held to at most 1."""
    axis: FloatArray = np.cross(own, wanted)
    if own @ wanted < 0.0:
        axis /= max(float(np.linalg.norm(axis)), 1e-9)
    return axis


def _within(
    stiffness: FloatArray, pull: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """The step (j,) to the balance of the springs; joints that would pass a limit stop there."""
    step, free = np.zeros(len(pull)), np.ones(len(pull), dtype=bool)
    for _ in range(len(pull)):
        rest = pull[free] - stiffness[np.ix_(free, ~free)] @ step[~free]
        step[free] = np.linalg.solve(stiffness[np.ix_(free, free)], rest)
        past = free & ((step < low) | (step > high))
        if not past.any():
            break
        step[past] = np.clip(step, low, high)[past]
        free &= ~past
        if not free.any():
            break
    return np.clip(step, -LEAP, LEAP)

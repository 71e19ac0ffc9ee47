"""The way that springs on a hand take an arm, if they take it slowly: kinematics, no simulation.

At every place on the way the joints come to rest where the springs that pull the hand, turn it,
keep the fingers in line and point the upper arm hold least energy,

    min  K |x_d - x|^2 + k_n |n_d - n|^2 + k_f |f_d - f|^2 + k_e |u_d - u|^2,

found by Gauss-Newton steps within the joint limits. What the springs leave open, the swivel of
the elbow, goes the way of least inertia and damping, as a limb does that is pulled by its hand
(Khatib 1987).
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Arm, Body, Spot

FloatArray = NDArray[np.float64]

STEPS = 6  # Gauss-Newton steps at each place, at most
NEAR = 1e-3  # [rad] a step that changes less is the last
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
    duration: float = 0.0  # of the movement, which says how much damping counts [s]
    joint_damping: FloatArray | float = 0.0  # of each joint of the arm (j,) [N m s/rad]


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
    model, data = body.model, mujoco.MjData(body.model)
    columns = body.qpos_of_dof[arm.dofs]
    low, high = (limit[arm.dofs] for limit in body.range)
    q, way = start.copy(), np.empty((len(path.place), len(start)))
    linear, angular, mass = np.zeros((3, body.nv)), np.zeros((3, body.nv)), np.zeros((body.nv,) * 2)
    swing, joints = np.zeros((3, body.nv)), len(arm.dofs)
    stiff, damp, drag = np.zeros((3, len(way), joints, joints))
    kept = _on_forearm(body, arm, start)
    own_drag = np.eye(joints) * path.joint_damping
    passive = passive_damping(body, arm.dofs)
    for k in range(len(way)):
        for _ in range(STEPS):
            data.qpos[:] = q
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_crb(model, data)
            mujoco.mj_fullM(model, data, mass)
            palm = place_of(data, arm.palm)
            mujoco.mj_jac(model, data, linear, angular, palm, arm.hand)
            parts = [(path.stiffness, linear, path.place[k] - palm)]
            turns: list[tuple[float, FloatArray]] = []
            hand = data.xmat[arm.hand].reshape(3, 3)
            forearm, late = data.xmat[arm.forearm].reshape(3, 3), path.late[k]
            mujoco.mj_jac(model, data, None, swing, palm, arm.forearm)
            wanted = forearm @ kept[0]
            if path.normal is not None:
                wanted = turned(wanted, path.normal, late)
            firm = path.turn_stiffness * (1.0 if path.fingers is not None else 1.0 - LOOSE * late)
            goal = _along(data, arm.forearm, arm.hand) if path.fingers is None else path.fingers
            ahead = turned(forearm @ kept[1], goal, late)
            ahead = ahead - (ahead @ wanted) * wanted
            ahead = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
            follow_normal = 1.0 - late if path.normal is not None else 1.0
            follow_ahead = 1.0 - late if path.fingers is not None else 1.0
            for stiffness, own, to, carried in (
                (path.turn_stiffness, hand @ arm.palm.normal, wanted, follow_normal),
                (firm, hand @ arm.fingers, ahead, follow_ahead),
            ):
                parts.append((stiffness, angular, _turn(own, to)))
                turns.append((stiffness, carried * swing))
            if path.upper_arm is not None:
                mujoco.mj_jac(model, data, None, swing, palm, arm.upper_arm)
                off = _turn(_along(data, arm.upper_arm, arm.forearm), path.upper_arm[k])
                parts.append((path.upper_arm_stiffness, swing.copy(), off))
            of_palm, of_hand = linear[:, arm.dofs], angular[:, arm.dofs]
            drag[k] = own_drag + path.turn_damping * of_hand.T @ of_hand
            lazy = mass[np.ix_(arm.dofs, arm.dofs)] + DRAGGING * path.duration * (passive + drag[k])
            pull = np.zeros(joints)
            stiff[k] = 0.0
            for stiffness, jacobian, off in parts:
                own = jacobian[:, arm.dofs]
                stiff[k] += stiffness * own.T @ own
                pull += stiffness * own.T @ off
            for stiffness, jacobian in turns:  # the goals that turn with the forearm
                stiff[k] -= stiffness * of_hand.T @ jacobian[:, arm.dofs]
            step = _within(lazy + stiff[k], pull, low - q[columns], high - q[columns])
            q[columns] += step
            if np.abs(step).max() < NEAR:
                break
        way[k] = q
        damp[k] = path.damping * of_palm.T @ of_palm
    return Springs(way, stiff, damp, drag)


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


def _along(data: mujoco.MjData, one: int, other: int) -> FloatArray:
    """Unit vector from the origin of a link to that of another."""
    way = data.xpos[other] - data.xpos[one]
    unit: FloatArray = way / np.linalg.norm(way)
    return unit


def _on_forearm(body: Body, arm: Arm, qpos: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The palm's normal and the fingers in the frame of the forearm, in a posture."""
    hand, forearm = axes_of(body, qpos, arm.hand), axes_of(body, qpos, arm.forearm)
    return forearm.T @ hand @ arm.palm.normal, forearm.T @ hand @ arm.fingers


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


def _turn(own: FloatArray, wanted: FloatArray) -> FloatArray:
    """Rotation vector that takes one unit vector to another, its length held to at most 1."""
    axis = np.cross(own, wanted)
    if own @ wanted < 0.0:
        axis /= max(float(np.linalg.norm(axis)), 1e-9)
    turn: FloatArray = axis
    return turn


def _within(
    hessian: FloatArray, pull: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """The step (j,) that minimises the energy; joints that would pass a limit stop there."""
    step, free = np.zeros(len(pull)), np.ones(len(pull), dtype=bool)
    for _ in range(len(pull)):
        own = np.ix_(free, free)
        rest = pull[free] - hessian[np.ix_(free, ~free)] @ step[~free]
        step[free] = np.linalg.solve(hessian[own], rest)
        past = free & ((step < low) | (step > high))
        if not past.any():
            break
        step[past] = np.clip(step, low, high)[past]
        free &= ~past
        if not free.any():
            break
    return np.clip(step, -0.5, 0.5)

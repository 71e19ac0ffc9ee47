"""The law of point-at: springs stretch an arm and turn it towards a place.

    m   = K a x u + D (w_u - w_a)            a from shoulder to wrist, u from shoulder to goal
    F   = (m x a) / r                        at the wrist, r away from the shoulder
    tau = J_w^T F - b q'                     over the arm
        + k (0 - q) - k_d q'                 at the elbow (eq 1)
        + J_h^T (T fingers x forearm - B w)  at the wrist

F has the moment m about the shoulder. Written as a force at the wrist it also counts for the
elbow, which moves the wrist as well, so that the pull is the gradient of one energy,
K (1 - a . u). The springs are those of Mataric et al. (1999), eq 8 and 9; u and the elbow set in
along the minimum-jerk profile (Flash & Hogan 1985).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled
from primitives.gaze import NEAREST, angle_between, turning_of
from primitives.mechanics import (
    Row,
    Vector,
    add,
    cross,
    dot,
    joint_torque,
    origin,
    point_velocity,
    rotate,
    scale,
    spin,
    store,
    subtract,
    to_world,
    tree_centre,
    turn_between,
    turn_error,
    unit,
    unrotate,
    vector,
)
from primitives.profiles import minimum_jerk

FloatArray = NDArray[np.float64]


class Pointing(NamedTuple):
    """What is turned towards what: an arm, and the place at which it points."""

    upper_arm: int  # links
    forearm: int
    hand: int
    root: int
    elbow: int  # degree of freedom
    goal_link: int
    goal: Vector  # in the frame of goal_link [m]
    fingers: Vector  # in the frame of the hand
    stiffness: float  # K [N m/rad]
    damping: float  # D [N m s/rad]
    elbow_stiffness: float  # k [N m/rad]
    elbow_damping: float  # k_d [N m s/rad]
    turn_stiffness: float  # T [N m/rad]
    turn_damping: float  # B [N m s/rad]
    shoulder_damping: float  # b [N m s/rad]


@compiled
def pointing_at(own: FloatArray) -> Pointing:
    """A `Pointing` from its numbers, one after the other."""
    return Pointing(
        int(own[0]), int(own[1]), int(own[2]), int(own[3]), int(own[4]), int(own[5]),
        vector(own[6:]), vector(own[9:]),
        own[12], own[13], own[14], own[15], own[16], own[17], own[18],
    )  # fmt: skip


@compiled
def arm_line(x: Row, a: Pointing) -> tuple[Vector, float, Vector, float]:
    """Direction of the arm and its length, direction of the goal and how far it is [m]."""
    shoulder = origin(x, a.upper_arm)
    along = subtract(origin(x, a.hand), shoulder)
    away = subtract(to_world(x, a.goal_link, a.goal), shoulder)
    length, far = np.sqrt(dot(along, along)), np.sqrt(dot(away, away))
    return unit(along), max(length, NEAREST), unit(away), max(far, NEAREST)


@compiled
def begin_pointing(x: Row, a: Pointing, memory: FloatArray) -> None:
    """Remember the direction of the arm, seen from the trunk, and the angle of the elbow."""
    along, _, _, _ = arm_line(x, a)
    store(memory, 0, unrotate(x, a.root, along))
    memory[3] = x.qpos[x.dofs[a.elbow].qpos]


@compiled
def point_arm(x: Row, a: Pointing, memory: FloatArray, share: float, out: FloatArray) -> None:
    """out += the torques [N m] (nv,) that point an arm.

    Args:
        x: the simulation.
        a: the arm and its goal.
        memory: what `begin_pointing` remembered.
        share: how much of the time of setting in has passed.
        out: (nv,) [N m]
    """
    late = minimum_jerk(share)
    along, length, towards, far = arm_line(x, a)
    wrist = origin(x, a.hand)
    began = rotate(x, a.root, (memory[0], memory[1], memory[2]))
    wanted = turn_between(began, towards, late)
    passing = subtract(point_velocity(x, a.hand, wrist), point_velocity(x, a.root, wrist))
    own = scale(1.0 / length, cross(along, passing))
    turning = scale(late, turning_of(x, a.root, a.goal_link, a.goal, towards, far))
    turning = subtract(turning, scale(dot(turning, along), along))
    moment = scale(a.stiffness, turn_error(along, wanted))
    moment = add(moment, scale(a.damping, subtract(turning, own)))
    force = scale(1.0 / length, cross(moment, along))
    moment = cross(subtract(wrist, tree_centre(x, a.hand)), force)
    base = x.links[a.root].last_dof
    j = x.links[a.hand].last_dof
    while j != base:
        out[j] += joint_torque(x, j, moment, force)
        j = x.dofs[j].parent
    j = x.links[a.upper_arm].last_dof
    while j != base:
        out[j] -= a.shoulder_damping * x.qvel[j]
        j = x.dofs[j].parent
    angle = x.qpos[x.dofs[a.elbow].qpos]
    out[a.elbow] += a.elbow_stiffness * ((1.0 - late) * memory[3] - angle)
    out[a.elbow] -= a.elbow_damping * x.qvel[a.elbow]
    forearm = unit(subtract(wrist, origin(x, a.forearm)))
    moment = scale(late * a.turn_stiffness, turn_error(rotate(x, a.hand, a.fingers), forearm))
    own = subtract(spin(x, a.hand), spin(x, a.forearm))
    moment = subtract(moment, scale(a.turn_damping, own))
    base = x.links[a.forearm].last_dof
    j = x.links[a.hand].last_dof
    while j != base:
        out[j] += joint_torque(x, j, moment, (0.0, 0.0, 0.0))
        j = x.dofs[j].parent


@compiled
def pointing_error(x: Row, a: Pointing) -> float:
    """Angle between the arm and the direction of the goal [rad]."""
    along, _, towards, _ = arm_line(x, a)
    return angle_between(along, towards)

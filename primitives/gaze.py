"""The law of look-at: a rotational spring turns the head until it faces a place.

    U   = K (1 - f . u) + L (l . z)^2 / 2          (beyond 90 degrees the pull stays constant)
    m   = K f x u - L (l . z) (l x z) + D (w_u - w)
    F   = (m_K x u) / |g - e|
    tau = J^T (m, F)   over the joints that it may turn

f is where the face points, u the direction from the eyes e to the goal g, l the line from ear
to ear, z the upward axis of the link that carries the joints, w the head's angular velocity
against that link, and w_u that of u as the goal moves. F is there because the eyes are not on
the axes of the neck: m and F together are the gradient of U, so that the spring gives back no
more energy than it was given. The rotational springs are those of Mataric et al. (1999), eq 8,
for the upper arm; u sets in along the minimum-jerk profile (Flash & Hogan 1985).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled
from primitives.mechanics import (
    Row,
    Vector,
    add,
    cross,
    dot,
    joint_torque,
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
BoolArray = NDArray[np.bool_]

NEAREST = 0.05  # what is closer to the eyes or the shoulder counts as so far away [m]


class Looking(NamedTuple):
    """What is turned towards what: a head, and the place that it faces."""

    link: int  # the head
    root: int  # the link that carries the joints that turn it
    goal_link: int
    goal: Vector  # in the frame of goal_link [m]
    eyes: Vector  # in the frame of the head [m]
    forward: Vector  # in the frame of the head
    left: Vector  # in the frame of the head, from ear to ear
    up: Vector  # in the frame of the root
    stiffness: float  # K [N m/rad]
    damping: float  # D [N m s/rad]
    level: float  # L [N m/rad]


@compiled
def looking_at(own: FloatArray) -> Looking:
    """A `Looking` from its numbers."""
    return Looking(
        int(own[0]), int(own[1]), int(own[2]), vector(own[3:]), vector(own[6:]), vector(own[9:]),
        vector(own[12:]), vector(own[15:]), own[18], own[19], own[20],
    )  # fmt: skip


@compiled
def line_of_sight(x: Row, a: Looking) -> tuple[Vector, Vector, Vector, float]:
    """The eyes, where the face points, the direction of the goal, and how far it is [m]."""
    eyes = to_world(x, a.link, a.eyes)
    away = subtract(to_world(x, a.goal_link, a.goal), eyes)
    return eyes, rotate(x, a.link, a.forward), unit(away), max(np.sqrt(dot(away, away)), NEAREST)


@compiled
def begin_gaze(x: Row, a: Looking, memory: FloatArray) -> None:
    """Remember where the face points, seen from the link that carries the joints."""
    store(memory, 0, unrotate(x, a.root, rotate(x, a.link, a.forward)))


@compiled
def turning_of(x: Row, root: int, link: int, point: Vector, towards: Vector, far: float) -> Vector:
    """Angular velocity of the direction to a point of a link, seen from `root` [rad/s]."""
    place = to_world(x, link, point)
    passing = subtract(point_velocity(x, link, place), point_velocity(x, root, place))
    return scale(1.0 / far, cross(towards, passing))


@compiled
def gaze(
    x: Row, a: Looking, claims: BoolArray, memory: FloatArray, share: float, out: FloatArray
) -> None:
    """out += the torques [N m] (nv,) that turn the head.

    Args:
        x: the simulation.
        a: the head and its goal.
        claims: (nv,) the joints that may turn it.
        memory: what `begin_gaze` remembered.
        share: how much of the time of setting in has passed.
        out: (nv,) [N m]
    """
    late = minimum_jerk(share)
    eyes, forward, towards, far = line_of_sight(x, a)
    began = rotate(x, a.root, (memory[0], memory[1], memory[2]))
    wanted = turn_between(began, towards, late)
    moment = scale(a.stiffness, turn_error(forward, wanted))
    force = scale(1.0 / far, cross(moment, wanted))
    left, up = rotate(x, a.link, a.left), rotate(x, a.root, a.up)
    moment = subtract(moment, scale(late * a.level * dot(left, up), cross(left, up)))
    turning = scale(late, turning_of(x, a.root, a.goal_link, a.goal, towards, far))
    own = subtract(spin(x, a.link), spin(x, a.root))
    moment = add(moment, scale(a.damping, subtract(turning, own)))
    moment = add(moment, cross(subtract(eyes, tree_centre(x, a.link)), force))
    base = x.links[a.root].last_dof
    j = x.links[a.link].last_dof
    while j != base:
        if claims[j]:
            out[j] += joint_torque(x, j, moment, force)
        j = x.dofs[j].parent


@compiled
def angle_between(a: Vector, b: Vector) -> float:
    """Angle of two unit vectors [rad]."""
    across = cross(a, b)
    return float(np.arctan2(np.sqrt(dot(across, across)), dot(a, b)))


@compiled
def gaze_error(x: Row, a: Looking) -> float:
    """Angle between where the face points and the goal [rad]."""
    _, forward, towards, _ = line_of_sight(x, a)
    return angle_between(forward, towards)

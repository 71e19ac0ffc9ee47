"""Controller impedance: virtual springs and dampers pull the hand and turn the upper arm.

    F   = K (x_d - x) + B (x_d' - x')                          (Mataric et al. 1999, eq 7)
    tau = J_h^T F_h + J_e^T F_e + b_shoulder                                 (eq 8 and 9)

F_h has six components: three pull the centre of the palm, three turn the palm. F_e only
turns: it points the upper arm in a wanted direction. b_shoulder damps the shoulder. The
g(theta) of eq 9 is the primitive compensate-gravity, added once for the whole body.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Record, Records, compiled
from primitives.mechanics import (
    Row,
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
    to_link,
    to_world,
    tree_centre,
    turn_between,
    turn_by_way_of,
    turn_error,
    unit,
    unrotate,
    vector,
)
from primitives.profiles import minimum_jerk

FloatArray = NDArray[np.float64]

_VECTOR = (np.float64, (3,))
REACH = np.dtype(
    [
        # The arm: links, and the palm in the frame of the hand.
        ("hand", np.int32),
        ("upper_arm", np.int32),
        ("forearm", np.int32),
        ("root", np.int32),
        ("palm", *_VECTOR),
        ("palm_normal", *_VECTOR),
        ("palm_neutral", *_VECTOR),  # its normal at home, in the frame of the forearm
        ("fingers", *_VECTOR),
        # The goal: via points and goal are rows of POINT; directions are unit vectors.
        ("points", np.int32),  # first row
        ("stays", np.bool_),  # whether the goal is where it was as the movement began
        ("turns_palm", np.bool_),
        ("turns_fingers", np.bool_),
        ("turns_upper_arm", np.bool_),
        ("by_neutral", np.bool_),  # half a turn of the palm goes as the forearm can turn
        ("normal_link", np.int32),
        ("normal_goal", *_VECTOR),  # of the palm, in the frame of normal_link
        ("fingers_goal", *_VECTOR),  # in the frame of the root
        ("upper_arm_goal", *_VECTOR),  # in the frame of the root
        # Gains.
        ("stiffness", np.float64),  # [N/m]
        ("damping", np.float64),  # [N s/m]
        ("turn_stiffness", np.float64),  # [N m/rad]
        ("turn_damping", np.float64),  # [N m s/rad]
        ("upper_arm_stiffness", np.float64),
        ("upper_arm_damping", np.float64),
        ("shoulder_damping", np.float64),
        # Of the controller endpoint-force alone.
        ("approach", np.float64),  # c [N s/m^2]
        ("joint_damping", np.float64),  # b [N m s/rad]
    ],
    align=True,
)
POINT = np.dtype([("link", np.int32), ("point", *_VECTOR)], align=True)
PALM_WAITS = 0.3  # share of the movement for which the palm keeps its place on the forearm
LOOSELY = 0.2  # how firmly, in the end, fingers that are free keep in line with the forearm
NEARLY_OPPOSITE = -0.7  # cosine of an angle of 134 degrees
# Start of the palm and of the upper arm in the root's frame, of the palm's normal and of the
# fingers in the forearm's, whether the palm turns by way of its neutral direction; and of a goal
# that stays its place, and the normal of the palm there, in the root's frame.
REMEMBERED = 19
GOAL, FACING = 13, 16


@compiled
def upper_arm_direction(x: Row, r: Record) -> tuple[float, float, float]:
    """Unit vector from shoulder to elbow."""
    return unit(subtract(origin(x, r.forearm), origin(x, r.upper_arm)))


@compiled
def palm_position(x: Row, r: Record) -> tuple[float, float, float]:
    """Centre of the palm in the world."""
    return to_world(x, r.hand, vector(r.palm))


@compiled
def begin_reach(x: Row, r: Record, memory: FloatArray) -> None:
    """Remember where palm and upper arm are, and how the hand is turned on the forearm."""
    normal, fingers = rotate(x, r.hand, vector(r.palm_normal)), rotate(x, r.hand, vector(r.fingers))
    store(memory, 0, to_link(x, r.root, palm_position(x, r)))
    store(memory, 3, unrotate(x, r.forearm, normal))
    store(memory, 6, unrotate(x, r.forearm, fingers))
    store(memory, 9, unrotate(x, r.root, upper_arm_direction(x, r)))
    goal = rotate(x, r.normal_link, vector(r.normal_goal))
    opposite = r.by_neutral and dot(normal, goal) < NEARLY_OPPOSITE
    memory[12] = 1.0 if opposite else 0.0


@compiled
def keep_goal(x: Row, r: Record, points: Records, knots: int, memory: FloatArray) -> None:
    """Remember where the goal is, if it is to stay there.

    Args:
        x: the simulation.
        r: a row of REACH.
        points: rows of POINT.
        knots: how many there are: start, via points and goal.
        memory: of `begin_reach`.
    """
    if r.stays:
        goal = points[r.points + knots - 2]
        store(memory, GOAL, to_link(x, r.root, to_world(x, goal.link, vector(goal.point))))
        facing = rotate(x, r.normal_link, vector(r.normal_goal))
        store(memory, FACING, unrotate(x, r.root, facing))


@compiled
def goal_place(x: Row, r: Record, p: Record, memory: FloatArray) -> tuple[float, float, float]:
    """Where the goal p, a row of POINT, is in the world [m]."""
    if r.stays:
        return to_world(x, r.root, (memory[GOAL], memory[GOAL + 1], memory[GOAL + 2]))
    return to_world(x, p.link, vector(p.point))


@compiled
def goal_facing(x: Row, r: Record, memory: FloatArray) -> tuple[float, float, float]:
    """Which way the palm is to face in the end, in the world."""
    if r.stays:
        return rotate(x, r.root, (memory[FACING], memory[FACING + 1], memory[FACING + 2]))
    return rotate(x, r.normal_link, vector(r.normal_goal))


@compiled
def palm_force(
    x: Row,
    r: Record,
    points: Records,
    memory: FloatArray,
    weight: FloatArray,
    rate: FloatArray,
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Force that pulls the palm to its set point (eq 7) [N], and the set point's speed [m/s]."""
    start = to_world(x, r.root, (memory[0], memory[1], memory[2]))
    wanted, speed = scale(weight[0], start), scale(rate[0], start)
    for k in range(1, weight.shape[0]):
        p = points[r.points + k - 1]
        if k == weight.shape[0] - 1:
            place = goal_place(x, r, p, memory)
        else:
            place = to_world(x, p.link, vector(p.point))
        wanted = add(wanted, scale(weight[k], place))
        speed = add(speed, scale(rate[k], place))
    palm = palm_position(x, r)
    force = add(
        scale(r.stiffness, subtract(wanted, palm)),
        scale(r.damping, subtract(speed, point_velocity(x, r.hand, palm))),
    )
    return force, speed


@compiled
def push_palm(
    x: Row,
    r: Record,
    moment: tuple[float, float, float],
    force: tuple[float, float, float],
    out: FloatArray,
) -> None:
    """out += J_h^T F_h over the joints of the arm (eq 8); the force acts at the palm."""
    arm = subtract(palm_position(x, r), tree_centre(x, r.hand))
    moment = add(moment, cross(arm, force))
    base = x.links[r.root].last_dof
    j = x.links[r.hand].last_dof
    while j != base:
        out[j] += joint_torque(x, j, moment, force)
        j = x.dofs[j].parent


@compiled
def impedance(
    x: Row,
    r: Record,
    points: Records,
    memory: FloatArray,
    share: float,
    weight: FloatArray,
    rate: FloatArray,
    out: FloatArray,
) -> None:
    """out += the torques [N m] of the hand's and the upper arm's springs.

    Args:
        x: the simulation.
        r: a row of REACH.
        points: rows of POINT: this reach's via points and goal begin at r.points.
        memory: what `begin_reach` remembered (REMEMBERED,).
        share: how much of the movement's time has passed; orientations turn with the
            minimum-jerk profile of it.
        weight: of start, via points and goal (1 + points,).
        rate: derivative of the weights [1/s].
        out: (nv,) [N m]
    """
    force, _ = palm_force(x, r, points, memory, weight, rate)
    pull_hand(x, r, memory, share, force, out)


@compiled
def pull_hand(
    x: Row,
    r: Record,
    memory: FloatArray,
    share: float,
    force: tuple[float, float, float],
    out: FloatArray,
) -> None:
    """out += the torques [N m] of a force on the palm, and of what turns hand and upper arm.

    Args:
        x: the simulation.
        r: a row of REACH.
        memory: what `begin_reach` remembered (REMEMBERED,).
        share: how much of the movement's time has passed.
        force: on the palm, in the world [N].
        out: (nv,) [N m]
    """
    # The moment that turns the palm: at first as it was on the forearm, in the end as the
    # goal has it. The fingers stay in line with the forearm unless the goal says otherwise.
    late = minimum_jerk((share - PALM_WAITS) / (1.0 - PALM_WAITS))
    normal = rotate(x, r.forearm, (memory[3], memory[4], memory[5]))
    if r.turns_palm:
        goal = goal_facing(x, r, memory)
        if memory[12] != 0.0:
            neutral = rotate(x, r.forearm, vector(r.palm_neutral))
            normal = turn_by_way_of(normal, neutral, goal, late)
        else:
            normal = turn_between(normal, goal, late)
    if r.turns_fingers:
        goal = rotate(x, r.root, vector(r.fingers_goal))
    else:
        goal = unit(subtract(origin(x, r.hand), origin(x, r.forearm)))
    firmness = 1.0 if r.turns_fingers else 1.0 - (1.0 - LOOSELY) * late
    fingers = rotate(x, r.forearm, (memory[6], memory[7], memory[8]))
    fingers = turn_between(fingers, goal, late)
    fingers = unit(subtract(fingers, scale(dot(fingers, normal), normal)))
    moment = add(
        turn_error(rotate(x, r.hand, vector(r.palm_normal)), normal),
        scale(firmness, turn_error(rotate(x, r.hand, vector(r.fingers)), fingers)),
    )
    moment = subtract(scale(r.turn_stiffness, moment), scale(r.turn_damping, spin(x, r.hand)))

    push_palm(x, r, moment, force, out)

    # J_e^T F_e and b_shoulder over the joints of the shoulder (eq 9).
    moment = (0.0, 0.0, 0.0)
    if r.turns_upper_arm:
        goal = rotate(x, r.root, vector(r.upper_arm_goal))
        began = rotate(x, r.root, (memory[9], memory[10], memory[11]))
        wanted = turn_between(began, goal, minimum_jerk(share))
        along = upper_arm_direction(x, r)
        turning = spin(x, r.upper_arm)
        swing = subtract(turning, scale(dot(turning, along), along))
        moment = subtract(
            scale(r.upper_arm_stiffness, turn_error(along, wanted)),
            scale(r.upper_arm_damping, swing),
        )
    base = x.links[r.root].last_dof
    j = x.links[r.upper_arm].last_dof
    while j != base:
        out[j] += joint_torque(x, j, moment, (0.0, 0.0, 0.0))
        out[j] -= r.shoulder_damping * x.qvel[j]
        j = x.dofs[j].parent

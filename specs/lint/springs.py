"""The springs that a movement's field is, as they are foreseen."""

import numpy as np

from primitives import GetPosture, GoToPoint
from primitives.posture_field import PostureField, joint_gains
from primitives.primitive import FloatArray, IntArray
from primitives.reach_field import ReachField
from sim import (
    Body,
    HandPath,
    HandSprings,
    JointSprings,
    axes_of,
    minimum_jerk_profile,
    moved,
    origin,
    places_of,
    turned,
)

NODES = 81  # places of a set point
PALM_WAITS = 0.3  # share of a movement for which the palm keeps its place on the forearm


def servos(
    body: Body,
    dofs: IntArray,
    set_point: FloatArray,
    stiffness: float | None = None,
    damping: float | None = None,
) -> JointSprings:
    """Servos on some joints (j,) whose set point (NODES, j) [rad] travels."""
    gains = joint_gains(body, dofs, stiffness=stiffness, damping=damping)
    return JointSprings(body, dofs, set_point, gains.stiffness[dofs], gains.damping[dofs])


def joint_springs(
    body: Body,
    does: GetPosture | GoToPoint,
    field: PostureField,
    start: FloatArray,
    travel: float,
    beside: FloatArray,
) -> tuple[FloatArray, JointSprings]:
    """The set point of a servo (NODES, j) [rad], and its springs.

    Args:
        body: whose joints.
        does: whose gains it has.
        field: the servo.
        start: posture (nq,) in which the movement begins.
        travel: time in which the set point travels [s].
        beside: set points of all that moves (NODES, m), the servo's own joints first.
    """
    times, dofs = np.linspace(0.0, travel, NODES), field.claims
    curve = field.set_point(times, start[body.qpos_of_dof[dofs]], dofs.tolist())
    wanted = np.hstack([curve, beside[:, len(dofs) :]])
    return curve, servos(body, moved(body, dofs), wanted, does.stiffness, does.damping)


def hand_springs(body: Body, field: ReachField, start: FloatArray, travel: float) -> HandSprings:
    """The springs of a reach that begins in a posture (nq,) and travels for a time [s]."""
    arm, goal, gains = field.arm, field.hand_goal, field.springs[0]
    shares = np.linspace(0.0, 1.0, NODES)
    knots = places_of(body, start, [arm.palm, *field.places])
    rise, late = (minimum_jerk_profile(shares - wait, 1.0 - wait)[0] for wait in (0.0, PALM_WAITS))
    root, (carrier,) = axes_of(body, start, arm.root), places_of(body, start, [origin(arm.root)])
    normal = upper_arm = None
    if goal.normal is not None:
        link, wanted = goal.normal
        normal = root.T @ axes_of(body, start, link) @ wanted
    if goal.upper_arm is not None:
        shoulder, elbow = places_of(body, start, [origin(arm.upper_arm), origin(arm.forearm)])
        along = root.T @ (elbow - shoulder) / np.linalg.norm(elbow - shoulder)
        upper_arm = np.array([turned(along, goal.upper_arm, share) for share in rise])
    path = HandPath(
        place=field.weights(shares * travel) @ ((knots - carrier) @ root),
        stiffness=float(gains["stiffness"]),
        damping=float(gains["damping"]),
        late=late,
        normal=normal,
        neutral=body.palm_at_home(arm) if goal.by_neutral else None,
        fingers=goal.fingers,
        upper_arm=upper_arm,
        turn_stiffness=float(gains["turn_stiffness"]),
        turn_damping=float(gains["turn_damping"]),
        upper_arm_stiffness=float(gains["upper_arm_stiffness"]),
        upper_arm_damping=float(gains["upper_arm_damping"]),
        shoulder_damping=float(gains["shoulder_damping"]),
    )
    return HandSprings(body, arm, moved(body, arm.dofs), start, path)

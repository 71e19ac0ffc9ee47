"""Whether a movement that goes in some way counts as done, as the judge has it."""

import numpy as np

from primitives import GetPosture, GoToPoint
from primitives.primitive import FloatArray
from sim import Arm, Body, axes_of, origin, places_of
from specs.tolerances import ANGLE, PALM_ANGLE, TOUCH_AT_END, TOUCH_BEFORE_NEXT, size_of

LOOKS = 8  # times that the direction of an arm that is held is looked at


def missed(body: Body, does: GetPosture | GoToPoint, postures: FloatArray) -> float:
    """How far a movement is from success, 1 being what is allowed.

    Args:
        body: what moves.
        does: what is asked of it.
        postures: (h, nq) from the end of the sub-task to that of the holding.
    """
    if isinstance(does, GoToPoint):
        first, last = (short_of(body, does, q) / size_of(body) for q in (postures[0], postures[-1]))
        return max(first / TOUCH_AT_END, last / TOUCH_BEFORE_NEXT)
    worst = 0.0
    for dof, angle in asked_angles(body, does).items():
        off = np.rad2deg(np.abs(postures[:, body.qpos_of_dof[dof]] - angle))
        worst = max(worst, float(off.max()) / ANGLE)
    if does.limb is None or not isinstance(does.posture, dict):
        return worst
    arm = body.arm(does.limb)
    for part, allowed in (("arm", ANGLE), ("palm", PALM_ANGLE)):
        direction = does.posture.get(part)
        if isinstance(direction, str | tuple):
            looked = postures[:: max(1, len(postures) // LOOKS)]
            wanted = body.to_link(arm.root, body.direction(direction))
            turns = [_turn(wanted, _held(body, arm, q)[part]) for q in (*looked, postures[-1])]
            worst = max(worst, max(turns) / allowed)
    return worst


def short_of(body: Body, does: GoToPoint, qpos: FloatArray) -> float:
    """How far a palm is from its goal [m] in a posture (nq,)."""
    arm = body.arm(does.limb)
    palm, goal = places_of(body, qpos, [arm.palm, does.hand_goal(body, arm).places[-1]])
    return float(np.linalg.norm(palm - goal))


def asked_angles(body: Body, does: GetPosture) -> dict[int, float]:
    """The joints of a posture that are measured one by one, and their angles [rad]."""
    arm = body.arm(does.limb) if does.limb else None
    if isinstance(does.posture, str):
        claims = arm.dofs if arm is not None else body.joints(does.joints or ())
        angles = body.posture(does.posture)
        return {int(dof): float(angles[dof]) for dof in claims}
    asked: dict[int, float] = {}
    for key, value in does.posture.items():
        joint, angle = key, value
        if arm is not None and key == "elbow":
            joint, angle = arm.limb.elbow, (0.0 if value == "straight" else value)
        elif arm is not None and f"{arm.limb.side}_{key}" in arm.limb.joints:
            joint = f"{arm.limb.side}_{key}"
        if isinstance(angle, float | int):
            asked |= {int(dof): float(np.deg2rad(angle)) for dof in body.joints(joint)}
    return asked


def _held(body: Body, arm: Arm, q: FloatArray) -> dict[str, FloatArray]:
    """Directions (3,) of arm and palm in the frame of the link that carries the arm."""
    shoulder, wrist = places_of(body, q, [origin(arm.upper_arm), origin(arm.hand)])
    carrier = axes_of(body, q, arm.root)
    palm = axes_of(body, q, arm.hand) @ arm.palm.normal
    straight = (wrist - shoulder) / np.linalg.norm(wrist - shoulder)
    return {"arm": carrier.T @ straight, "palm": carrier.T @ palm}


def _turn(one: FloatArray, other: FloatArray) -> float:
    """Angle between two unit vectors [deg]."""
    return float(np.rad2deg(np.arccos(np.clip(one @ other, -1.0, 1.0))))

"""Whether a movement that ends in some posture counts as done, as the judge has it."""

from collections.abc import Callable

import numpy as np

from primitives import GetPosture, GoToPoint
from primitives.posture_field import PostureField
from primitives.primitive import FloatArray, IntArray
from primitives.reach_field import ReachField
from sim import Arm, Body, axes_of, origin, palm_jacobian, places_of
from specs.tolerances import ANGLE, PALM_ANGLE, TOUCH_AT_END, TOUCH_BEFORE_NEXT, size_of

LOOKS = 8  # times that a posture that is held is looked at
Miss = Callable[[FloatArray], float]


def missing(
    body: Body, does: GetPosture | GoToPoint, field: PostureField | ReachField, end: FloatArray
) -> Miss:
    """A function of lags (h, j) [rad]: how far they are from success, 1 being what is allowed.

    Args:
        body: what moves.
        does: what is asked of it.
        field: its field.
        end: posture (nq,) in which the way ends, all being well.
    """
    if isinstance(does, GoToPoint):
        return _off_place(palm_jacobian(body, body.arm(does.limb), end), size_of(body))
    return _off_posture(body, does, field.claims, end)


def _off_place(jacobian: FloatArray, size: float) -> Miss:
    def miss(off: FloatArray) -> float:
        first, last = (float(np.linalg.norm(jacobian @ lag)) / size for lag in (off[0], off[-1]))
        return max(first / TOUCH_AT_END, last / TOUCH_BEFORE_NEXT)

    return miss


def _off_posture(body: Body, does: GetPosture, claims: IntArray, end: FloatArray) -> Miss:
    arm = body.arm(does.limb) if does.limb else None
    said = does.posture if isinstance(does.posture, dict) else {}
    parts = [part for part in ("arm", "palm") if part in said]
    measured = np.ones(len(claims), dtype=bool)  # the joints that are measured one by one
    if parts:
        named = [d for key in said if key not in parts for d in _dofs(body, arm, key)]
        measured = np.isin(claims, named)
    columns = body.qpos_of_dof[claims]

    def miss(off: FloatArray) -> float:
        worst = float(np.rad2deg(np.abs(off[:, measured])).max(initial=0.0)) / ANGLE
        if arm is None or not parts:
            return worst
        wanted, q = _held(body, arm, end), end.copy()
        for lag in off[:: max(1, len(off) // LOOKS)]:
            q[columns] = end[columns] - lag
            held = _held(body, arm, q)
            for part in parts:
                turn = np.arccos(np.clip(held[part] @ wanted[part], -1.0, 1.0))
                allowed = ANGLE if part == "arm" else PALM_ANGLE
                worst = max(worst, float(np.rad2deg(turn)) / allowed)
        return worst

    return miss


def _held(body: Body, arm: Arm, q: FloatArray) -> dict[str, FloatArray]:
    """Directions of arm and palm."""
    shoulder, wrist = places_of(body, q, [origin(arm.upper_arm), origin(arm.hand)])
    palm = axes_of(body, q, arm.hand) @ arm.palm.normal
    return {"arm": (wrist - shoulder) / np.linalg.norm(wrist - shoulder), "palm": palm}


def _dofs(body: Body, arm: Arm | None, key: str) -> list[int]:
    """The joints that a word of a posture is about."""
    if arm is not None and key == "elbow":
        key = arm.limb.elbow
    own = f"{arm.limb.side}_{key}" if arm is not None else key
    known = arm is not None and own in arm.limb.joints
    return [int(d) for d in body.joints(own if known else key)]

"""joint-limit: swings and curves through via postures that pass the end of a joint's range.

A posture that does is refused when the task is bound.
"""

from collections.abc import Sequence

import numpy as np

from primitives import Oscillate
from primitives.primitive import FloatArray
from specs.binding import BoundTask
from specs.lint.finding import Finding, Places
from specs.lint.move import Move

MARGIN = 1.0  # [deg] of a range that may be passed


def beyond_limits(task: BoundTask, places: Places, moves: Sequence[Move]) -> list[Finding]:
    """Set points that leave the ranges of the joints."""
    body = task.body
    found = []
    for move in moves:
        if move.curve is None:
            continue
        low, high = (np.rad2deg(limit[move.dofs]) for limit in body.range)
        curve = np.rad2deg(move.curve)
        past = np.maximum(curve.max(axis=0) - high, low - curve.min(axis=0))
        worst = int(np.argmax(past))
        if past[worst] > MARGIN:
            joint = body.dof_name(int(move.dofs[worst]))
            found.append(
                places.finding(
                    "warning", "joint-limit", move.name,
                    f"the curve through its via postures takes {joint} {past[worst]:.0f} degrees"
                    f" past the end of its range, {low[worst]:.0f} to {high[worst]:.0f}",
                    "bring the via postures nearer to the way, spread their times, or take"
                    " 'profile: linear'",
                    joint=joint, past=float(past[worst]),
                )
            )  # fmt: skip
    starts = {b.name: b.does for b in task.spec.background}
    starts |= {name: task.graph.subtasks[name].does for name in task.graph.order}
    for name, does in starts.items():
        if isinstance(does, Oscillate):
            found += _swings(task, places, name, does)
    return found


def _swings(task: BoundTask, places: Places, name: str, does: Oscillate) -> list[Finding]:
    body, found = task.body, []
    centre = _centre(task, does)
    for joint, swing in (does.joints or {}).items():
        (dof,) = body.joints(joint)
        low, high = (float(np.rad2deg(limit[dof])) for limit in body.range)
        middle = float(np.rad2deg(centre[dof]))
        past = max(middle + swing.amplitude - high, low - middle + swing.amplitude)
        if past > MARGIN:
            room = max(0.0, min(high - middle, middle - low))
            found.append(
                places.finding(
                    "error", "joint-limit", name,
                    f"{joint} swings {past:.0f} degrees past the end of its range, {low:.0f} to"
                    f" {high:.0f}: {swing.amplitude:g} to either side of {middle:.0f}",
                    f"an amplitude of at most {room:.0f}, or a 'centre' farther from the end",
                    "joints", joint, "amplitude", joint=joint, past=past,
                )
            )  # fmt: skip
    return found


def _centre(task: BoundTask, does: Oscillate) -> FloatArray:
    """Where joints swing about (nv,) [rad]; NaN where that is known only as it begins."""
    body = task.body
    if isinstance(does.centre, str):
        return body.posture(does.centre)
    if does.centre is not None:
        return body.angles(does.centre)
    taken = {int(dof) for field in task.fields for dof in field.claims}
    own = [d for d in range(body.nv) if d not in taken or does.claims]
    centre = np.full(body.nv, np.nan)
    centre[own] = task.start[body.qpos_of_dof[own]]
    claimed = [int(d) for j in does.joints or () for d in body.joints(j)]
    for dof in claimed:
        if sum(dof in field.claims for field in task.fields) > int(does.claims):
            centre[dof] = np.nan
    return centre

"""The course of a task as it is planned: where each movement begins, and how it goes.

No step of a simulation is taken. Every sub-task is thought to begin at its planned time in the
posture that the ones before it leave; what cannot be foreseen (a hand that follows something, a
limb that hangs loose) is left out.
"""

from dataclasses import replace

import numpy as np

from primitives import CompensateGravity, GoToPoint, Hold, Oscillate
from primitives.parameters import background_settling
from primitives.posture_field import PostureField
from primitives.primitive import Field, FloatArray, IntArray
from sim import Body, moving_dofs
from specs.binding import BoundTask
from specs.lint.move import Move, Scene, move_of
from specs.lint.springs import NODES


def planned_moves(task: BoundTask) -> list[Move]:
    """The movements of a task whose way can be foreseen, as they begin."""
    body, graph = task.body, task.graph
    carried = any(isinstance(b.does, CompensateGravity) for b in task.spec.background)
    moves: list[Move] = []
    posture = task.start.copy()
    over: list[tuple[float, IntArray, FloatArray]] = [  # what is still to come true
        (background_settling(body), field.claims, field.goal[field.claims])
        for field in task.background
        if isinstance(field, PostureField)
    ]
    planned = sorted(range(len(graph.order)), key=lambda k: graph.planned[graph.order[k]][0])
    next_claim = _next_claims(task)
    settling = _settling(task)
    known: dict[object, Move | None] = {}
    for k in planned:
        name, field = graph.order[k], task.fields[k]
        start, end = graph.planned[name]
        for done in [o for o in over if o[0] <= start + 1e-9]:
            _, dofs, angles = done
            posture[body.qpos_of_dof[dofs]] = angles
            over.remove(done)
        hold = max(0.0, next_claim[k] - end)
        subtask = graph.subtasks[name]
        here = graph.lasts(name), graph.fade(name), round(hold, 6)
        beside = task.body_for(name)
        objects = beside.model.body_pos[beside.objects].tobytes()
        key = repr(subtask.does), *here, posture.round(6).tobytes(), start == 0.0, objects
        if key not in known:
            held = settling if start == 0.0 else np.full_like(settling, np.nan)
            scene = Scene(beside, posture.copy(), held, carried)
            known[key] = move_of(scene, name, subtask.does, field, *here)
        move = known[key]
        if move is not None:
            moves.append(replace(move, name=name, begins=start))
        left = _leaves(body, subtask.does, field, posture, move)
        if left is not None:
            over.append((end, field.claims, left))
    return moves


def _settling(task: BoundTask) -> FloatArray:
    """Where the background wants the joints as it settles (NODES, nv) [rad]; NaN where nowhere."""
    body, wanted = task.body, np.full((NODES, task.body.nv), np.nan)
    times = np.linspace(0.0, background_settling(body), NODES)
    for field in task.background:
        if isinstance(field, PostureField):
            dofs = field.claims
            here = task.start[body.qpos_of_dof[dofs]]
            wanted[:, dofs] = field.set_point(times, here, dofs.tolist())
    return wanted


def _next_claims(task: BoundTask) -> list[float]:
    """When each sub-task's goal is let go, or the task is over [s].

    That is when its joints are claimed again, or those of another limb that its goal is on.
    """
    body, graph = task.body, task.graph
    order = sorted(range(len(graph.order)), key=lambda k: -graph.planned[graph.order[k]][0])
    soonest, found = np.full(body.nv, graph.duration), [graph.duration] * len(graph.order)
    for k in order:
        claims = task.fields[k].claims
        if len(claims):
            below = _carrying(body, graph.subtasks[graph.order[k]].does)
            found[k] = float(soonest[[*claims, *below]].min())
            soonest[claims] = graph.planned[graph.order[k]][0]
    return found


def _carrying(body: Body, does: object) -> list[int]:
    """The joints of limbs that carry the landmark to which a hand goes."""
    if not isinstance(does, GoToPoint):
        return []
    mark = does.to if isinstance(does.to, str) else does.to.near
    if mark is None:
        return []
    limbs = {int(dof) for limb in body.map.limbs for dof in body.joints(limb)}
    return sorted(limbs & set(moving_dofs(body, body.landmark(mark).link)))


def _leaves(
    body: Body, does: object, field: Field, posture: FloatArray, move: Move | None
) -> FloatArray | None:
    """The angles of its joints that a sub-task leaves; NaN where nobody can tell."""
    columns = body.qpos_of_dof[field.claims]
    if move is not None:
        left: FloatArray = move.foreseen.qpos[-1][columns]
        return left
    if isinstance(field, PostureField):
        goal: FloatArray = field.goal[field.claims]
        return goal
    if isinstance(does, Hold):
        return posture[columns]
    if isinstance(does, Oscillate) or not len(field.claims):
        return None
    return np.full(len(columns), np.nan)

"""The course of a task as it is planned: where each movement begins, and the way it goes.

Nothing is simulated. Every sub-task is taken to begin at its planned time in the posture that the
ones before it leave; what cannot be foreseen (a hand that follows something, a limb that hangs
loose) is left out.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from primitives import CompensateGravity, GetPosture, GoToPoint, Hold, Oscillate
from primitives.parameters import BACKGROUND_SETTLING
from primitives.posture_field import PostureField, joint_gains
from primitives.primitive import Field, FloatArray, IntArray
from primitives.reach_field import ReachField
from sim import (
    Body,
    HandPath,
    Haste,
    Springs,
    axes_of,
    minimum_jerk_profile,
    origin,
    places_of,
    spring_way,
    turned,
)
from specs.binding import BoundTask
from specs.lint.success import missing

NODES = 41  # places of a way that are looked at
# A spring pulls a palm as if it were a mass of so many kilograms, and what it does not follow is
# as much quicker than that mass on that spring. Its joints, which catch up after the hand-over, are
# then so much faster than foreseen. Both were found on tasks drawn at random: without via points
# (speeds foreseen: 0.81 of the simulated, +-0.06), and with them.
STRAIGHT, ROUND = (1.0, 1.2), (2.0, 1.0)
PALM_WAITS = 0.3  # share of a movement for which the palm keeps its place on the forearm


@dataclass(frozen=True)
class Move:
    """A movement as it is planned."""

    name: str
    dofs: IntArray  # that it moves (j,)
    way: FloatArray  # (NODES, nq) at even shares of the time that its set point travels [rad]
    duration: float  # [s]
    travel: float  # share of the duration in which the set point travels
    hold: float  # time for which the goal is then held [s]
    hand_over: float  # [s]
    limb: str | None  # the arm that it moves
    touched: int  # the link that its hand is to touch; -1 for none
    short: float  # by how much the palm is short of a goal when the way ends [m]; 0 for a posture
    haste: Haste | None  # what it takes; None for a controller that follows no set point
    miss: Callable[[FloatArray], float]  # of lags (h, j) at its end, as a share of what is allowed


def planned_moves(task: BoundTask) -> list[Move]:
    """The movements of a task whose way can be foreseen, as they begin."""
    body, graph = task.body, task.graph
    carried = any(isinstance(b.does, CompensateGravity) for b in task.spec.background)
    moves: list[Move] = []
    posture = task.start.copy()
    over: list[tuple[float, IntArray, FloatArray]] = [  # what is still to come true
        (BACKGROUND_SETTLING, field.claims, field.goal[field.claims])
        for field in task.background
        if isinstance(field, PostureField)
    ]
    planned = sorted(range(len(graph.order)), key=lambda k: graph.planned[graph.order[k]][0])
    next_claim = _next_claims(task)
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
        key = repr(subtask.does), *here, posture.round(6).tobytes()
        if key not in known:
            known[key] = _move(body, name, subtask.does, field, posture, *here, carried)
        move = known[key]
        if move is not None:
            moves.append(Move(**{**vars(move), "name": name}))
        left = _leaves(body, subtask.does, field, posture, move)
        if left is not None:
            over.append((end, field.claims, left))
    return moves


def _next_claims(task: BoundTask) -> list[float]:
    """When each sub-task's joints are claimed again, or the task is over [s]."""
    graph = task.graph
    order = sorted(range(len(graph.order)), key=lambda k: -graph.planned[graph.order[k]][0])
    soonest, found = np.full(task.body.nv, graph.duration), [graph.duration] * len(graph.order)
    for k in order:
        claims = task.fields[k].claims
        if len(claims):
            found[k] = float(soonest[claims].min())
            soonest[claims] = graph.planned[graph.order[k]][0]
    return found


def _leaves(
    body: Body, does: object, field: Field, posture: FloatArray, move: Move | None
) -> FloatArray | None:
    """The angles of its joints that a sub-task leaves; NaN where nobody can tell."""
    columns = body.qpos_of_dof[field.claims]
    if isinstance(field, PostureField):
        goal: FloatArray = field.goal[field.claims]
        return goal
    if move is not None:
        left: FloatArray = move.way[-1][columns]
        return left
    if isinstance(does, Hold):
        return posture[columns]
    if isinstance(does, Oscillate) or not len(field.claims):
        return None
    return np.full(len(columns), np.nan)


def _move(
    body: Body,
    name: str,
    does: object,
    field: Field,
    posture: FloatArray,
    duration: float,
    hand_over: float,
    hold: float,
    carried: bool,
) -> Move | None:
    if not isinstance(does, GetPosture | GoToPoint):
        return None
    if np.isnan(posture[body.qpos_of_dof[field.claims]]).any():
        return None
    start = np.where(np.isnan(posture), body.home, posture)
    if does.controller == "torque-field" and does.via:
        return None  # it has pulses instead of a set point that runs through via postures
    travel, touched = does.travel, -1
    if isinstance(field, PostureField):
        springs = _joint_springs(body, does, field, start, travel * duration)
    elif isinstance(field, ReachField):
        if body.ancestors[field.places[-1].link, field.arm.dofs].any():
            return None  # a place on the arm itself
        springs = _hand_springs(body, field, start, travel * duration)
        touched = field.hand_goal.touched
    else:
        return None
    blur, rush = 0.0, 1.0
    if isinstance(field, ReachField):
        mass, rush = ROUND if does.via else STRAIGHT
        blur = float(np.sqrt(mass / float(field.springs[0]["stiffness"])))
    haste = None
    if does.controller in ("pd-servo", "impedance"):
        haste = Haste(body, field.claims, springs, carried=carried, blur=blur, rush=rush)
    return Move(
        name=name,
        dofs=field.claims,
        way=springs.qpos,
        duration=duration,
        travel=travel,
        hold=hold,
        hand_over=hand_over,
        limb=does.limb,
        touched=touched,
        short=_short(body, does, springs.qpos[-1]),
        haste=haste,
        miss=missing(body, does, field, springs.qpos[-1]),
    )


def _short(body: Body, does: GetPosture | GoToPoint, end: FloatArray) -> float:
    if isinstance(does, GetPosture):
        return 0.0
    arm = body.arm(does.limb)
    palm, goal = places_of(body, end, [arm.palm, does.hand_goal(body, arm).places[-1]])
    return float(np.linalg.norm(palm - goal))


def _joint_springs(
    body: Body, does: GetPosture | GoToPoint, field: PostureField, start: FloatArray, travel: float
) -> Springs:
    dofs, columns = field.claims, body.qpos_of_dof[field.claims]
    gains = joint_gains(body, dofs, stiffness=does.stiffness, damping=does.damping)
    way = np.tile(start, (NODES, 1))
    times = np.linspace(0.0, travel, NODES)
    way[:, columns] = field.set_point(times, start[columns], dofs.tolist())
    stiffness, damping = (np.diag(g[dofs]) for g in (gains.stiffness, gains.damping))
    alike = (NODES, 1, 1)
    return Springs(
        way, np.tile(stiffness, alike), np.tile(damping, alike), np.tile(0.0 * damping, alike)
    )


def _hand_springs(body: Body, field: ReachField, start: FloatArray, travel: float) -> Springs:
    arm, goal, gains = field.arm, field.hand_goal, field.springs[0]
    shares = np.linspace(0.0, 1.0, NODES)
    knots = places_of(body, start, [arm.palm, *field.places])
    rise, late = (minimum_jerk_profile(shares - wait, 1.0 - wait)[0] for wait in (0.0, PALM_WAITS))
    root = axes_of(body, start, arm.root)
    normal = upper_arm = None
    if goal.normal is not None:
        link, wanted = goal.normal
        normal = axes_of(body, start, link) @ wanted
    if goal.upper_arm is not None:
        shoulder_at, elbow = places_of(body, start, [origin(arm.upper_arm), origin(arm.forearm)])
        along = (elbow - shoulder_at) / np.linalg.norm(elbow - shoulder_at)
        upper_arm = np.array([turned(along, root @ goal.upper_arm, share) for share in rise])
    shoulder = np.isin(arm.dofs, arm.shoulder_dofs).astype(np.float64)
    path = HandPath(
        place=field.weights(shares * travel) @ knots,
        stiffness=float(gains["stiffness"]),
        damping=float(gains["damping"]),
        late=late,
        normal=normal,
        fingers=None if goal.fingers is None else root @ goal.fingers,
        upper_arm=upper_arm,
        turn_stiffness=float(gains["turn_stiffness"]),
        turn_damping=float(gains["turn_damping"]),
        upper_arm_stiffness=float(gains["upper_arm_stiffness"]),
        duration=travel,
        joint_damping=float(gains["shoulder_damping"]) * shoulder,
    )
    return spring_way(body, arm, start, path)


def led_by(task: BoundTask, does: GetPosture | GoToPoint, move: Move) -> FloatArray | None:
    """The way (k, nq) of a movement if another primitive did it."""
    field = does.bind(task.body, move.duration)
    made = _move(task.body, move.name, does, field, move.way[0], move.duration, 0.0, 0.0, True)
    return None if made is None else made.way

"""The course of a task as it is planned: where each movement begins, and how it goes.

No step of a simulation is taken. Every sub-task is thought to begin at its planned time in the
posture that the ones before it leave; what cannot be foreseen (a hand that follows something, a
limb that hangs loose) is left out.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from primitives import CompensateGravity, GetPosture, GoToPoint, Hold, Oscillate
from primitives.parameters import BACKGROUND_SETTLING
from primitives.posture_field import PostureField, joint_gains
from primitives.primitive import Field, FloatArray, IntArray
from primitives.reach_field import ReachField
from sim import (
    Body,
    Foreseen,
    Foresight,
    HandPath,
    HandSprings,
    JointSprings,
    Springs,
    axes_of,
    minimum_jerk_profile,
    moved,
    origin,
    places_of,
    turned,
)
from specs.binding import BoundTask
from specs.lint.success import missed, short_of

NODES = 81  # places of a set point
PALM_WAITS = 0.3  # share of a movement for which the palm keeps its place on the forearm


@dataclass(frozen=True)
class Scene:
    """What is there when a movement begins."""

    body: Body
    posture: FloatArray  # (nq,) [rad]; NaN where nobody can tell
    settling: FloatArray  # set points of what holds the joints (NODES, nv); NaN: where they are
    carried: bool  # whether something carries the weight


@dataclass(frozen=True)
class Move:
    """A movement as it is planned."""

    name: str
    does: GetPosture | GoToPoint
    dofs: IntArray  # that it moves (j,)
    begins: float  # by the plan [s]
    duration: float  # [s]
    hold: float  # time for which the goal is then held [s]
    hand_over: float  # [s]
    touched: int  # the link that its hand is to touch; -1 for none
    curve: FloatArray | None  # set point of its joints (NODES, j) [rad], if it has one
    scene: Scene  # in which it begins
    foresight: Foresight  # how it goes in any time
    foreseen: Foreseen  # how it goes in the time that it has
    timed: bool  # whether that is foreseen for its controller, or only which way it goes

    @property
    def body(self) -> Body:
        """What moves."""
        return self.foresight.body

    def short(self, foreseen: Foreseen) -> float:
        """How far the palm is from its goal [m] if it comes to rest so; 0 for a posture."""
        if isinstance(self.does, GetPosture):
            return 0.0
        return short_of(self.body, self.does, foreseen.qpos[-1])

    @property
    def touching(self) -> set[str]:
        """The links that it is to bring together, a hand and another."""
        if self.does.limb is None or self.touched < 0:
            return set()
        limb, model = self.body.map.limbs[self.does.limb], self.body.model
        return {limb.hand, model.body(self.touched).name}

    @cached_property
    def apart(self) -> list[tuple[str, str]]:
        """Pairs of links of which it moves one, and that must not touch on it."""
        body, dofs = self.body, set(self.dofs.tolist())
        moved_by = {
            link: dofs & set(np.flatnonzero(body.ancestors[body.link(link)]).tolist())
            for link in {link for pair in body.map.keep_apart for link in pair}
        }
        return [
            pair
            for pair in body.map.keep_apart
            if moved_by[pair[0]] != moved_by[pair[1]] and set(pair) != self.touching
        ]

    def in_time(self, duration: float) -> Foreseen:
        """How it goes in a time [s]."""
        return self._foreseen(self.foresight, duration)

    def through(self) -> Foreseen:
        """How it would go through whatever it must not touch, so that its depth can be told."""
        passed = self.foresight.passed | set(self.apart)
        return self._foreseen(replace(self.foresight, passed=passed), self.duration)

    def works(self, foreseen: Foreseen, duration: float) -> bool:
        """Whether it comes to its goal if it goes so in a time [s], no joint being too fast."""
        return self.missed(foreseen, duration) <= 1.0 and float(foreseen.speed.max()) <= 1.0

    def _foreseen(self, foresight: Foresight, duration: float) -> Foreseen:
        fade = min(self.hand_over, duration)
        return foresight.in_time(self.does.travel * duration, duration + self.hold, fade)

    def missed(self, foreseen: Foreseen, duration: float) -> float:
        """How far it is from success if it goes so in a time [s], 1 being what is allowed."""
        held = foreseen.between(duration, duration + self.hold)
        return missed(self.body, self.does, held)


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
        key = repr(subtask.does), *here, posture.round(6).tobytes(), start == 0.0
        if key not in known:
            held = settling if start == 0.0 else np.full_like(settling, np.nan)
            scene = Scene(body, posture.copy(), held, carried)
            known[key] = _move(scene, name, subtask.does, field, *here)
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
    times = np.linspace(0.0, BACKGROUND_SETTLING, NODES)
    for field in task.background:
        if isinstance(field, PostureField):
            dofs = field.claims
            here = task.start[body.qpos_of_dof[dofs]]
            wanted[:, dofs] = field.set_point(times, here, dofs.tolist())
    return wanted


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


def _move(
    scene: Scene,
    name: str,
    does: object,
    field: Field,
    duration: float,
    hand_over: float,
    hold: float,
    shy: frozenset[tuple[str, str]] = frozenset(),
) -> Move | None:
    body, posture = scene.body, scene.posture
    if not isinstance(does, GetPosture | GoToPoint):
        return None
    if np.isnan(posture[body.qpos_of_dof[field.claims]]).any():
        return None
    if does.controller == "torque-field" and does.via:
        return None  # it has pulses instead of a set point that runs through via postures
    start = np.where(np.isnan(posture), body.home, posture)
    every = moved(body, field.claims)
    wanted = np.where(
        np.isnan(scene.settling[:, every]), start[body.qpos_of_dof[every]], scene.settling[:, every]
    )
    travel, curve, touched = does.travel * duration, None, -1
    springs: Springs
    if isinstance(field, PostureField):
        times, dofs = np.linspace(0.0, travel, NODES), field.claims
        curve = field.set_point(times, start[body.qpos_of_dof[dofs]], dofs.tolist())
        beside = np.hstack([curve, wanted[:, len(dofs) :]])
        springs = _servos(body, every, beside, does.stiffness, does.damping)
    elif isinstance(field, ReachField):
        if body.ancestors[field.places[-1].link, field.arm.dofs].any():
            return None  # a place on the arm itself
        springs, touched = _hand_springs(body, field, start, travel), field.hand_goal.touched
    else:
        return None
    foresight = Foresight(
        body, field.claims, start, springs, _servos(body, every, wanted), BACKGROUND_SETTLING,
        scene.carried, _giving(body, field.claims),
    )  # fmt: skip
    fade = min(hand_over, duration)
    return Move(
        name=name,
        does=does,
        dofs=field.claims,
        begins=0.0,
        duration=duration,
        hold=hold,
        hand_over=hand_over,
        touched=touched,
        curve=curve,
        scene=scene,
        foresight=foresight,
        foreseen=foresight.in_time(travel, duration + hold, fade, shy),
        timed=does.controller in ("pd-servo", "impedance"),
    )


def _giving(body: Body, dofs: IntArray) -> frozenset[tuple[str, str]]:
    """Pairs of links that a movement does not lean on: other limbs, which give way."""
    limbs = [(limb.upper_arm, limb.forearm, limb.hand) for limb in body.map.limbs.values()]
    others = {
        link for links in limbs for link in links if not body.ancestors[body.link(link), dofs].any()
    }
    own = {body.model.body(link).name for link in range(1, body.model.nbody)} - others
    return frozenset((one, other) for one in own for other in others)


def _servos(
    body: Body,
    dofs: IntArray,
    set_point: FloatArray,
    stiffness: float | None = None,
    damping: float | None = None,
) -> JointSprings:
    gains = joint_gains(body, dofs, stiffness=stiffness, damping=damping)
    return JointSprings(body, dofs, set_point, gains.stiffness[dofs], gains.damping[dofs])


def _hand_springs(body: Body, field: ReachField, start: FloatArray, travel: float) -> HandSprings:
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


def from_posture(body: Body, does: GoToPoint, posture: FloatArray, duration: float) -> Move | None:
    """How a reach would go that begins in a posture (nq,), all else being held there."""
    still = np.full((NODES, body.nv), np.nan)
    field = does.bind(body, duration)
    return _move(Scene(body, posture, still, True), "", does, field, duration, 0.0, duration)


def led_by(does: GetPosture | GoToPoint, move: Move) -> Move | None:
    """The same movement if another primitive did it; it ends where it runs into something."""
    field = does.bind(move.body, move.duration)
    here = move.duration, move.hand_over, move.hold
    shy = {both for one, other in move.apart for both in ((one, other), (other, one))}
    made = _move(move.scene, move.name, does, field, *here, frozenset(shy))
    return None if made is None else replace(made, begins=move.begins)

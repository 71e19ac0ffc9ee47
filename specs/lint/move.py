"""One movement as it is foreseen: by which springs, and whether it comes to its goal."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from primitives import GetPosture, GoToPoint
from primitives.parameters import background_settling
from primitives.posture_field import PostureField
from primitives.primitive import Field, FloatArray, IntArray
from primitives.reach_field import ReachField
from sim import Body, Foreseen, Foresight, Springs, moved
from specs.lint.springs import NODES, hand_springs, joint_springs, servos
from specs.lint.success import missed, short_of


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
    def touching(self) -> list[set[str]]:
        """The pairs of links that it may bring together: a hand and what that is to touch.

        On an object of the scene the forearm may lie too.
        """
        if self.does.limb is None or self.touched < 0:
            return []
        limb, there = self.body.map.limbs[self.does.limb], self.body.model.body(self.touched).name
        pairs: list[set[str]] = [{limb.hand, there}]
        return [*pairs, {limb.forearm, there}] if there in self.body.map.objects else pairs

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
            if moved_by[pair[0]] != moved_by[pair[1]] and set(pair) not in self.touching
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
        if foreseen.lost or float(foreseen.speed.max()) > 1.0:
            return False
        return self.missed(foreseen, duration) <= 1.0

    def _foreseen(self, foresight: Foresight, duration: float) -> Foreseen:
        fade = min(self.hand_over, duration)
        return foresight.in_time(self.does.travel * duration, duration + self.hold, fade)

    def missed(self, foreseen: Foreseen, duration: float) -> float:
        """How far it is from success if it goes so in a time [s], 1 being what is allowed."""
        held = foreseen.between(duration, duration + self.hold)
        return missed(self.body, self.does, held)


def move_of(
    scene: Scene,
    name: str,
    does: object,
    field: Field,
    duration: float,
    hand_over: float,
    hold: float,
    shy: frozenset[tuple[str, str]] = frozenset(),
) -> Move | None:
    """How a sub-task goes that begins in a scene; None if that cannot be foreseen.

    Args:
        scene: where it begins.
        name: of the sub-task.
        does: its primitive.
        field: the primitive's field.
        duration: of the sub-task [s].
        hand_over: cross-fade from what held the joints before [s].
        hold: how long the goal is then held [s].
        shy: pairs of links that end it if they touch.
    """
    body, posture = scene.body, scene.posture
    if not isinstance(does, GetPosture | GoToPoint):
        return None
    pulsed = does.controller == "torque-field" and does.via  # instead of a set point that travels
    if pulsed or np.isnan(posture[body.qpos_of_dof[field.claims]]).any():
        return None
    start = np.where(np.isnan(posture), body.home, posture)
    every = moved(body, field.claims)
    wanted = np.where(
        np.isnan(scene.settling[:, every]), start[body.qpos_of_dof[every]], scene.settling[:, every]
    )
    travel, curve, touched = does.travel * duration, None, -1
    springs: Springs
    if isinstance(field, PostureField):
        curve, springs = joint_springs(body, does, field, start, travel, wanted)
    elif isinstance(field, ReachField):
        if body.ancestors[field.places[-1].link, field.arm.dofs].any():
            return None  # a place on the arm itself
        springs, touched = hand_springs(body, field, start, travel), field.hand_goal.touched
    else:
        return None
    foresight = Foresight(
        body, field.claims, start, springs, servos(body, every, wanted),
        background_settling(body),
        scene.carried, _giving(body, field.claims),
    )  # fmt: skip
    foreseen = foresight.in_time(travel, duration + hold, min(hand_over, duration), shy)
    if foreseen.lost:
        return None
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
        foreseen=foreseen,
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


def from_posture(body: Body, does: GoToPoint, posture: FloatArray, duration: float) -> Move | None:
    """How a reach would go that begins in a posture (nq,), all else being held there."""
    still = np.full((NODES, body.nv), np.nan)
    field = does.bind(body, duration)
    return move_of(Scene(body, posture, still, True), "", does, field, duration, 0.0, duration)


def led_by(does: GetPosture | GoToPoint, move: Move) -> Move | None:
    """The same movement if another primitive did it; it ends where it runs into something."""
    field = does.bind(move.body, move.duration)
    here = move.duration, move.hand_over, move.hold
    shy = {both for one, other in move.apart for both in ((one, other), (other, one))}
    made = move_of(move.scene, move.name, does, field, *here, frozenset(shy))
    return None if made is None else replace(made, begins=move.begins)

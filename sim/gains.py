"""Gains of one body made into gains of another: Hodgins & Pollard (1997), mass scaling.

A servo's gains follow the inertia that its joint moves, a hand's springs the mass and the inertia
that are felt at its palm; all by one common length and time (`sim.laws`).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np

from sim.body import Body
from sim.body_map import BodyMap, Guard, Limb, Servo, Spring
from sim.laws import Law
from sim.likeness import Likeness, likeness

Rule = Literal["mass", "geometric"]


@dataclass(frozen=True)
class Gains:
    """What a body map says of how firmly a body moves when a task does not say otherwise."""

    servos: Mapping[str, Servo]  # by joint
    springs: Mapping[str, Spring]  # by limb
    guard: Guard
    speed_limits: Mapping[str, float]  # by joint [deg/s]

    @classmethod
    def of(cls, names: BodyMap) -> Self:
        """The gains of a body map."""
        springs = {name: limb.spring for name, limb in names.limbs.items()}
        return cls(names.servos, springs, names.guard, names.speed_limits)

    def on(self, names: BodyMap) -> BodyMap:
        """A body map with these gains."""
        limbs = {
            name: limb.model_copy(update={"spring": self.springs[name]})
            for name, limb in names.limbs.items()
        }
        more = {"servos": self.servos, "guard": self.guard, "speed_limits": self.speed_limits}
        return names.model_copy(update={"limbs": limbs, **more})


def scaled_gains(
    one: Body, gains: Gains, other: Body, *, rule: Rule = "mass", length: float | None = None
) -> tuple[Gains, Likeness]:
    """Gains with which another body moves like one that these gains suit.

    Args:
        one: the body that they suit.
        gains: of it.
        other: the body that is to move like it; it has the same limbs and joints.
        rule: by the masses and inertias that are moved; or as if it were a scale model.
        length: how much longer it is; default: its arms.

    Returns:
        The gains, and the factors that they were made by.
    """
    like = likeness(one, other, length)
    if rule == "geometric":
        like = like.geometric
    servos = {name: scaled_servo(servo, like.joint(name)) for name, servo in gains.servos.items()}
    springs = {
        name: _spring(spring, one.map.limbs[name], name, like)
        for name, spring in gains.springs.items()
    }
    speeds = {
        name: speed * like.joint(name).angular_velocity
        for name, speed in gains.speed_limits.items()
    }
    return Gains(servos, springs, scaled_guard(gains.guard, mean_hand(like)), speeds), like


def firmer(
    gains: Gains,
    *,
    joints: float = 1.0,
    hands: float = 1.0,
    damping: float = 1.0,
    guard: float = 1.0,
) -> Gains:
    """Gains of the same body that hold it more firmly, or less.

    Args:
        gains: its own.
        joints: factor of the stiffness of joints; their damping ratio stays as it is.
        hands: factor of the stiffness of hands' springs; the same.
        damping: factor of the damping ratio of joints and hands.
        guard: factor of the force that keeps links apart.
    """
    servos = {
        name: servo.model_copy(
            update={
                "stiffness": servo.stiffness * joints,
                "damping": servo.damping * damping * joints**0.5,
            }
        )
        for name, servo in gains.servos.items()
    }
    springs = {
        name: Spring(
            **{
                gain: value * (hands if "stiffness" in gain else damping * hands**0.5)
                for gain, value in spring
            }
        )
        for name, spring in gains.springs.items()
    }
    kept = Guard(
        range=gains.guard.range,
        stiffness=gains.guard.stiffness * guard,
        damping=gains.guard.damping * guard**0.5,
    )
    return Gains(servos, springs, kept, gains.speed_limits)


def scaled_servo(servo: Servo, law: Law) -> Servo:
    """The gains of a joint by its law; an angle is the same on both."""
    return Servo(
        stiffness=servo.stiffness * law.torsional_stiffness,
        damping=servo.damping * law.torsional_damping,
        width=servo.width,
    )


def scaled_guard(guard: Guard, law: Law) -> Guard:
    """What keeps links apart by the law of what it pushes."""
    return Guard(
        range=guard.range * law.length,
        stiffness=guard.stiffness * law.stiffness,
        damping=guard.damping * law.damping,
    )


def mean_hand(like: Likeness) -> Law:
    """The hands of a body taken together."""
    laws = list(like.hands.values())
    if not laws:
        return like.whole
    return Law(like.length, _mean(law.mass for law in laws), _mean(law.inertia for law in laws))


def mean_joint(like: Likeness, joints: Iterable[str]) -> Law:
    """Several joints taken together."""
    laws = [like.joint(name) for name in joints]
    if not laws:
        return like.whole
    return Law(like.length, _mean(law.mass for law in laws), _mean(law.inertia for law in laws))


def spring_laws(limb: Limb, name: str, like: Likeness) -> dict[str, float]:
    """The factor of each gain of a hand's springs."""
    hand = like.hand(name)
    shoulder, arm = mean_joint(like, limb.shoulder), mean_joint(like, limb.joints)
    return {
        "stiffness": hand.stiffness,
        "damping": hand.damping,
        "turn_stiffness": hand.torsional_stiffness,
        "turn_damping": hand.torsional_damping,
        "upper_arm_stiffness": shoulder.torsional_stiffness,
        "upper_arm_damping": shoulder.torsional_damping,
        "shoulder_damping": shoulder.torsional_damping,
        "approach": hand.approach,
        "joint_damping": arm.torsional_damping,
    }


def _spring(spring: Spring, limb: Limb, name: str, like: Likeness) -> Spring:
    factors = spring_laws(limb, name, like)
    return Spring(**{gain: getattr(spring, gain) * factor for gain, factor in factors.items()})


def _mean(factors: Iterable[float]) -> float:
    """The geometric mean, as of ratios."""
    return float(np.exp(np.mean(np.log(list(factors)))))

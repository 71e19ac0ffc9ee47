"""A weight strapped to the back of a hand: a bar of lead along the fingers' bones."""

from math import pi
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.errors import BodyError

FloatArray = NDArray[np.float64]

LEAD = 11340.0  # [kg/m^3]
LENGTH = 0.09  # of the bar, without its round ends [m]
GREY = (0.35, 0.36, 0.38, 1.0)


def add_weight(spec: Any, side: str, mass: float) -> None:
    """Make a bar of lead a part of the hand of that side of an Adonis.

    Args:
        spec: `mujoco.MjSpec` of the body.
        side: `left` or `right`.
        mass: [kg]

    Raises:
        BodyError: the mass is not positive.
    """
    if not mass > 0.0:
        raise BodyError(f"a weight has a mass, not {mass:g} kg")
    hand, palm, finger = (
        spec.body(f"{side}_hand"),
        spec.site(f"{side}_palm"),
        spec.geom(f"{side}_middle"),
    )
    radius = _radius(mass)
    out, thickness = np.empty(3), 2.0 * finger.size[0]
    mujoco.mju_rotVecQuat(out, np.array([1.0, 0.0, 0.0]), palm.quat)
    centre, half = palm.pos - out * (thickness + radius), 0.5 * LENGTH
    hand.add_geom(
        name=f"{side}_weight",
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        pos=centre,
        size=[radius, half, 0.0],
        rgba=list(GREY),
        mass=0.0,  # it is in the inertia of the hand
        condim=finger.condim,
        friction=finger.friction,
        solref=finger.solref,
    )
    # As a cylinder of its mass, length and radius, along z.
    across = mass * (radius**2 / 4.0 + (LENGTH + radius) ** 2 / 12.0)
    bar = np.diag([across, across, mass * radius**2 / 2.0])
    own = np.diag(hand.inertia)
    whole = hand.mass + mass
    middle = (hand.mass * hand.ipos + mass * centre) / whole
    turned = own + _moved(hand.mass, hand.ipos - middle) + bar + _moved(mass, centre - middle)
    hand.mass, hand.ipos, hand.inertia = whole, middle, np.zeros(3)
    hand.fullinertia = [turned[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def _moved(mass: float, by: FloatArray) -> FloatArray:
    """What a mass adds to the moments of inertia (3, 3) when it is moved [kg m^2] (Steiner)."""
    moments: FloatArray = mass * (by @ by * np.eye(3) - np.outer(by, by))
    return moments


def _radius(mass: float) -> float:
    """Radius of a capsule of lead of that mass and `LENGTH` [m]: by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):
        r = 0.5 * (low + high)
        heavy = LEAD * pi * r**2 * (LENGTH + 4.0 / 3.0 * r) > mass
        low, high = (low, r) if heavy else (r, high)
    return 0.5 * (low + high)

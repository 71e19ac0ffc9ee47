"""A weight strapped to the back of a hand: a bar of lead along the fingers' bones."""

from math import pi
from typing import Any

import mujoco
import numpy as np

from sim.errors import BodyError

LEAD = 11340.0  # [kg/m^3]
LENGTH = 0.09  # of the bar, without its round ends [m]
GREY = (0.35, 0.36, 0.38, 1.0)


def add_weight(spec: Any, side: str, mass: float) -> None:
    """Add the link `{side}_weight` to the hand of that side of an Adonis.

    Args:
        spec: `mujoco.MjSpec` of the body.
        side: `left` or `right`.
        mass: [kg]

    Raises:
        BodyError: the mass is not positive.
    """
    if not mass > 0.0:
        raise BodyError(f"a weight has a mass, not {mass:g} kg")
    hand = spec.body(f"{side}_hand")
    palm = spec.site(f"{side}_palm")
    radius = _radius(mass)
    out = np.empty(3)
    mujoco.mju_rotVecQuat(out, np.array([1.0, 0.0, 0.0]), palm.quat)
    thickness = 2.0 * spec.geom(f"{side}_middle").size[0]
    centre = palm.pos - out * (thickness + radius)
    weight = hand.add_body(name=f"{side}_weight", pos=centre)
    half = 0.5 * LENGTH
    weight.add_geom(
        name=f"{side}_weight",
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        fromto=[0.0, 0.0, -half, 0.0, 0.0, half],
        size=[radius, 0.0, 0.0],
        rgba=list(GREY),
        mass=mass,
        friction=spec.geom(f"{side}_middle").friction,
        solref=spec.geom(f"{side}_middle").solref,
    )
    for part in ("upper_arm",):
        spec.add_exclude(bodyname1=f"{side}_{part}", bodyname2=f"{side}_weight")


def _radius(mass: float) -> float:
    """Radius of a capsule of lead of that mass and `LENGTH` [m]: by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):
        r = 0.5 * (low + high)
        heavy = LEAD * pi * r**2 * (LENGTH + 4.0 / 3.0 * r) > mass
        low, high = (low, r) if heavy else (r, high)
    return 0.5 * (low + high)

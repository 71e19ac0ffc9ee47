"""The torques that carry the body's own weight, or let go of it.

    g_j = - s_j . (m_j g at c_j)

for joint j with motion axis s_j, m_j being the mass of all that it carries and c_j its
centre of mass: the g(theta) of Mataric et al. 1999, eq 9, for every joint of the body.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled
from primitives.mechanics import (
    Row,
    cross,
    joint_torque,
    scale,
    subtract,
    tree_centre,
    vector,
)

FloatArray = NDArray[np.float64]


@compiled
def carry_weight(x: Row, gravity: FloatArray, out: FloatArray) -> None:
    """out += the torques [N m] (nv,) that hold the body up against gravity (3,) [m/s^2]."""
    carried = -1
    force = moment = (0.0, 0.0, 0.0)
    for j in range(out.shape[0]):
        link = x.dofs[j].link
        if link != carried:  # joints of the same link carry the same
            carried = link
            force = scale(-x.links[link].mass, vector(gravity))
            centre = x.com[link, 0], x.com[link, 1], x.com[link, 2]
            moment = cross(subtract(centre, tree_centre(x, link)), force)
        out[j] += joint_torque(x, j, moment, force)


@compiled
def hang_loose(
    x: Row,
    damping: FloatArray,
    gravity: FloatArray,
    claims: NDArray[np.bool_],
    weight: FloatArray,
    out: FloatArray,
) -> None:
    """out += -b q' less the torques that carry the weight, on the claimed joints [N m].

    Args:
        x: the simulation.
        damping: b (nv,) [N m s/rad]
        gravity: (3,) [m/s^2]; zero leaves the weight to who carries it.
        claims: (nv,) the joints that hang loose.
        weight: (nv,) to work in.
        out: (nv,) [N m]
    """
    for j in range(out.shape[0]):
        weight[j] = 0.0
    carry_weight(x, gravity, weight)
    for j in range(out.shape[0]):
        if claims[j]:
            out[j] -= damping[j] * x.qvel[j] + weight[j]

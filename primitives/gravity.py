"""The torques that carry the body's own weight.

    g_j = - s_j . (m_j g at c_j)

for joint j with motion axis s_j, m_j being the mass of all that it carries and c_j its
centre of mass: the g(theta) of Mataric et al. 1999, eq 9, for every joint of the body.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled
from primitives.mechanics import Row, axis_torque, cross, scale, subtract, vector

FloatArray = NDArray[np.float64]


@compiled
def carry_weight(x: Row, gravity: FloatArray, out: FloatArray) -> None:
    """out += the torques [N m] (nv,) that hold the body up against gravity (3,) [m/s^2]."""
    for j in range(out.shape[0]):
        link = x.dofs[j].link
        force = scale(-x.links[link].mass, vector(gravity))
        arm = subtract(vector(x.com[link]), vector(x.com[x.links[link].root]))
        out[j] += axis_torque(x.cdof[j], cross(arm, force), force)

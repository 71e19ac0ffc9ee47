"""Controller pd-servo: every joint follows its desired angle.

tau = k (theta_d - theta) + k_d (theta_d' - theta')        (Mataric et al. 1999, eq 1)
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled
from primitives.mechanics import Row

FloatArray = NDArray[np.float64]


@compiled
def pd_servo(
    x: Row,
    stiffness: FloatArray,
    damping: FloatArray,
    start: FloatArray,
    knots: FloatArray,
    weight: FloatArray,
    rate: FloatArray,
    out: FloatArray,
) -> None:
    """out += the servo torques [N m] towards a set point that is a weighted sum of postures.

    Args:
        x: the simulation.
        stiffness: k (nv,) [N m/rad]; 0 for joints that are not servoed.
        damping: k_d (nv,) [N m s/rad]
        start: posture (nv,) [rad] in which the movement began.
        knots: via postures and goal (nv per posture, flat) [rad].
        weight: of start, via postures and goal (1 + postures,)
        rate: derivative of the weights [1/s]
        out: (nv,) [N m]
    """
    nv, postures = stiffness.shape[0], weight.shape[0] - 1
    settled = weight[postures] == 1.0 and rate[postures] == 0.0
    for j in range(nv):
        if stiffness[j] == 0.0 and damping[j] == 0.0:
            continue
        wanted, speed = knots[(postures - 1) * nv + j], 0.0
        if not settled:
            wanted, speed = weight[0] * start[j], rate[0] * start[j]
            for k in range(postures):
                angle = knots[k * nv + j]
                wanted += weight[k + 1] * angle
                speed += rate[k + 1] * angle
        angle = x.qpos[x.dofs[j].qpos]
        out[j] += stiffness[j] * (wanted - angle) + damping[j] * (speed - x.qvel[j])

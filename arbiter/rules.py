"""The last of every rule: the torques of many fields become one per joint, within its limit."""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records, compiled

FloatArray = NDArray[np.float64]


@compiled
def sum_torques(contribution: FloatArray, count: int, out: FloatArray) -> None:
    """Rule `sum`: tau = sum_i a_i phi_i, fields add as vectors (Mussa-Ivaldi et al. 1994).

    Args:
        contribution: (fields, nv) torques, already scaled by their activations [N m].
        count: how many of the fields are on.
        out: (nv,) [N m]
    """
    for j in range(out.shape[0]):
        total = 0.0
        for k in range(count):
            total += contribution[k, j]
        out[j] = total


@compiled
def limit_torques(dofs: Records, torque: FloatArray) -> bool:
    """Hold torques within the motors' limits; returns whether all of them are finite."""
    finite = True
    for j in range(torque.shape[0]):
        finite = finite and np.isfinite(torque[j])
        torque[j] = min(max(torque[j], -dofs[j].limit), dofs[j].limit)
    return finite

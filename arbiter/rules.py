"""Combination rules: from the torques of many fields to one torque per joint."""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled

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

"""Which joint is to blame when something is out of reach: the one whose end stands in the way."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sim.body import Body

FloatArray = NDArray[np.float64]

AT_END = 0.02  # [rad] from the end of its range: a joint that rests there
STEP = 0.05  # [rad] by which it is turned further


def joint_to_blame(
    body: Body,
    dofs: NDArray[np.int32],
    angles: FloatArray,
    miss: Callable[[FloatArray], float],
    *,
    least: float,
) -> str | None:
    """The joint at the end of its range that would help most if it went further.

    Args:
        body: whose joints they are.
        dofs: the joints that may be to blame.
        angles: of the nearest posture (nv,) [rad].
        miss: how far a posture (nv,) is from what was wanted.
        least: what a radian has to save to count, in the unit of `miss`.

    Returns:
        Its name; None if no end of a range is in the way: then the limb is too short.
    """
    low, high = body.range
    now, best, name = miss(angles), least * STEP, None
    for dof in dofs.tolist():
        for end, further in ((low[dof], -STEP), (high[dof], STEP)):
            if abs(angles[dof] - end) > AT_END:
                continue
            turned = angles.copy()
            turned[dof] += further
            saved = now - miss(turned)
            if saved > best:
                best, name = saved, body.dof_name(dof)
    return name

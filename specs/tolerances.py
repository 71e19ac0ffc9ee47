"""What counts as done: how near a goal the judge wants a movement to end.

Lengths are those of Adonis; on another body they are longer or shorter as its arms are.
"""

from collections.abc import Sequence

import numpy as np

from sim import Body

TOUCH_AT_END = 0.03  # palm to landmark when the move's time is over [m]
TOUCH_BEFORE_NEXT = 0.015  # and just before the arm moves on [m]
ANGLE = 10.0  # arm, elbow and other joints of a posture [deg]
PALM_ANGLE = 15.0  # palm of a posture [deg]
PENETRATION = 0.005  # of any two geoms, at any step [m]

ARM = 0.6362  # from shoulder to palm of Adonis [m]


def size(arms: Sequence[float]) -> float:
    """How much longer arms [m] are than those of Adonis; 1 for a body without any."""
    return round(float(np.mean(arms)) / ARM, 3) if len(arms) else 1.0


def size_of(body: Body) -> float:
    """How much longer the arms of a body are than those of Adonis."""
    return size([body.reach(body.arm(limb)) for limb in body.map.limbs])

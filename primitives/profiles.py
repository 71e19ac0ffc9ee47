"""Profiles over the share s of a movement's time: functions from [0, 1]."""

import numpy as np

from primitives.compiled import compiled


@compiled
def minimum_jerk(s: float) -> float:
    """10 s^3 - 15 s^4 + 6 s^5 on [0, 1] (Flash & Hogan 1985)."""
    s = min(max(s, 0.0), 1.0)
    return s * s * s * (10.0 + s * (6.0 * s - 15.0))


@compiled
def minimum_jerk_rate(s: float) -> float:
    """The derivative of `minimum_jerk`: 30 s^2 (1 - s)^2 on [0, 1], 0 outside."""
    if s <= 0.0 or s >= 1.0:
        return 0.0
    return 30.0 * s * s * (1.0 - s) * (1.0 - s)


@compiled
def step(s: float) -> float:
    """s - sin(2 pi s) / (2 pi) on [0, 1], 0 before, 1 after (Mataric et al. 1999, eq 5)."""
    if s <= 0.0:
        return 0.0
    if s >= 1.0:
        return 1.0
    return float(s - np.sin(2.0 * np.pi * s) / (2.0 * np.pi))


@compiled
def pulse(s: float) -> float:
    """1 - cos(2 pi s) on [0, 1], 0 outside (eq 6): the derivative of `step`."""
    if s <= 0.0 or s >= 1.0:
        return 0.0
    return float(1.0 - np.cos(2.0 * np.pi * s))

"""Set points: smooth curves from where a movement starts, through via points, to its goal.

A curve of order m is the one that passes its knots at the given times with the smallest
integral of its squared m-th derivative, starting and ending at rest:

    m = 1  linear         constant speed between knots (Mataric et al. 1999, section 7)
    m = 2  spline         the clamped cubic spline (section 5)
    m = 3  minimum-jerk   Flash & Hogan (1985); without via points x = D(10s^3 - 15s^4 + 6s^5)

Each is linear in its knots, x(s) = sum_k w_k(s) x_k, so the weights w_k are worked out once
when a movement is bound and serve every simulation, wherever it starts and however its
knots move meanwhile.
"""

from functools import lru_cache
from math import factorial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled

FloatArray = NDArray[np.float64]
Profile = Literal["linear", "spline", "minimum-jerk"]

ORDER: dict[Profile, int] = {"linear": 1, "spline": 2, "minimum-jerk": 3}
POWERS = 6  # coefficients per segment: enough for the quintics of order 3
MOST_KNOTS = 16


@lru_cache(maxsize=1024)
def knot_weights(profile: Profile, times: tuple[float, ...]) -> FloatArray:
    """Coefficients of the weights w_k(s) of a curve.

    Args:
        profile: which curve.
        times: when it passes its knots, as shares of its duration, from 0 to 1.

    Returns:
        (segments, POWERS, knots): on segment g, w_k(s) = sum_p c[g, p, k] (s - times[g])^p.
    """
    order, knots = ORDER[profile], len(times)
    segments, powers = knots - 1, 2 * order
    lengths = np.diff(times)
    unknowns = segments * powers
    a = np.zeros((unknowns, unknowns))
    b = np.zeros((unknowns, knots))
    row = 0

    def derivative(segment: int, d: int, s: float) -> FloatArray:
        """Row that evaluates the d-th derivative of a segment at its local time s."""
        line = np.zeros(unknowns)
        for p in range(d, powers):
            line[segment * powers + p] = factorial(p) / factorial(p - d) * s ** (p - d)
        return line

    for g in range(segments):  # both ends of a segment lie on its knots
        for knot, s in ((g, 0.0), (g + 1, lengths[g])):
            a[row], b[row, knot] = derivative(g, 0, s), 1.0
            row += 1
    for d in range(1, order):  # at rest at both ends
        a[row], a[row + 1] = derivative(0, d, 0.0), derivative(segments - 1, d, lengths[-1])
        row += 2
    for g in range(segments - 1):  # as smooth as can be at the inner knots
        for d in range(1, powers - 1):
            a[row] = derivative(g, d, lengths[g]) - derivative(g + 1, d, 0.0)
            row += 1
    solution = np.linalg.solve(a, b).reshape(segments, powers, knots)
    weights = np.zeros((segments, POWERS, knots))
    weights[:, :powers] = solution
    weights.setflags(write=False)
    return weights


@compiled
def weigh_knots(
    s: float, times: FloatArray, coefficients: FloatArray, weight: FloatArray, rate: FloatArray
) -> None:
    """Weights of the knots at share s of the duration, and their derivatives by s, in place.

    Args:
        s: how much of the movement's time has passed, held within [0, 1].
        times: (knots,)
        coefficients: (segments * POWERS * knots,) of `knot_weights`, flat.
        weight: (knots,) out
        rate: (knots,) out, [1/duration]
    """
    knots = times.shape[0]
    if s >= 1.0:
        for k in range(knots):
            weight[k] = 0.0
            rate[k] = 0.0
        weight[knots - 1] = 1.0
        return
    g = 0
    while g < knots - 2 and s >= times[g + 1]:
        g += 1
    u = max(s, 0.0) - times[g]
    at = g * POWERS * knots
    for k in range(knots):
        x, dx = 0.0, 0.0
        for p in range(POWERS - 1, -1, -1):
            dx = dx * u + x
            x = x * u + coefficients[at + p * knots + k]
        weight[k] = x
        rate[k] = dx


def weights_at(profile: Profile, times: tuple[float, ...], shares: FloatArray) -> FloatArray:
    """Weights (k, knots) of a curve at shares (k,) of its duration: for looking at, not control."""
    coefficients = knot_weights(profile, times)
    s = np.clip(shares, 0.0, 1.0)
    segment = np.clip(np.searchsorted(times, s, side="right") - 1, 0, len(times) - 2)
    powers = (s - np.array(times)[segment])[:, None] ** np.arange(POWERS)
    weights: FloatArray = np.einsum("sp,spk->sk", powers, coefficients[segment])
    return weights

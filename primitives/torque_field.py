"""Controller torque-field: every joint lies in potential wells that are switched, not moved.

    phi = -A e exp(-e^2 / 2 s^2) - k_d theta',      e = theta - theta_d
    tau = (1 - w) phi_start + w phi_goal + sum_i v_i psi_i          (Mataric et al. 1999, eq 4)
    w(s) = s - sin(2 pi s) / 2 pi,   v(s) = 1 - cos(2 pi s)                      (eq 5 and 6)

A well of amplitude A and width s pulls hardest, with 0.607 A s, at e = s, and lets go beyond.
Eq 3 of the paper is the pair A = k, s^2 = 1/k. In Mussa-Ivaldi's coupled form (1997; footnote
1 of the paper) the exponent sums over all joints of the field: -sum e^2 / 2 s^2. The set
point of a well never moves: during the movement the step w takes the goal's well in and the
start's out, and a pulse v takes the well of a via posture in and out again. What the paper
leaves unsaid, what becomes of the field before, is answered by 1 - w.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled
from primitives.mechanics import Row
from primitives.profiles import pulse, step

FloatArray = NDArray[np.float64]
FAR = 36.0  # exponents beyond this count as this: exp(-36) is 2e-16


@compiled
def weigh_wells(s: float, times: FloatArray, size: FloatArray, weight: FloatArray) -> None:
    """Weights of the wells at share s of the movement, in place.

    Args:
        s: how much of the movement's time has passed.
        times: of start, via postures and goal (knots,); a pulse lasts from the knot before
            to the knot after its own.
        size: of the pulses (knots - 2,); at 0.5 the peak weighs as much as a step.
        weight: (knots,) out
    """
    last = times.shape[0] - 1
    weight[last] = step(s)
    weight[0] = 1.0 - weight[last]
    for k in range(1, last):
        lasts = times[k + 1] - times[k - 1]
        weight[k] = size[k - 1] * pulse((s - times[k - 1]) / lasts)


@compiled
def bell(x: float) -> float:
    """exp(-x) for x >= 0, to 2e-9 of its value up to FAR, and about exp(-FAR) beyond.

    exp(-x) = exp(-x/64)^64, the inner one by its series. Without a call or a branch the loops
    over joints become vector instructions, which makes a torque field several times cheaper.
    """
    u = min(x, FAR) * (1.0 / 64.0)
    y = 1.0 / 40320.0
    y = y * u - 1.0 / 5040.0
    y = y * u + 1.0 / 720.0
    y = y * u - 1.0 / 120.0
    y = y * u + 1.0 / 24.0
    y = y * u - 1.0 / 6.0
    y = y * u + 0.5
    y = y * u - 1.0
    y = y * u + 1.0
    y *= y
    y *= y
    y *= y
    y *= y
    y *= y
    return y * y


@compiled
def torque_field(
    x: Row,
    amplitude: FloatArray,
    damping: FloatArray,
    start: FloatArray,
    knots: FloatArray,
    sharpness: FloatArray,
    coupled: bool,
    weight: FloatArray,
    angle: FloatArray,
    out: FloatArray,
) -> None:
    """out += the torques [N m] of weighted wells.

    Args:
        x: the simulation.
        amplitude: A (nv,) [N m/rad]; 0 for joints that are in no well.
        damping: k_d (nv,) [N m s/rad]
        start: posture (nv,) [rad] in which the movement began.
        knots: via postures and goal (nv per posture, flat) [rad].
        sharpness: 1 / 2 s^2 (nv,) [1/rad^2]
        coupled: whether the exponent sums over the joints.
        weight: of start, via postures and goal (1 + postures,).
        angle: (nv,) to work in.
        out: (nv,) [N m]
    """
    nv = amplitude.shape[0]
    nv = amplitude.shape[0]
    for j in range(nv):
        at = x.dofs[j].qpos
        angle[j] = x.qpos[at] if at >= 0 else 0.0
        out[j] -= damping[j] * x.qvel[j]
    for k in range(weight.shape[0]):
        if weight[k] == 0.0:
            continue
        centre = start if k == 0 else knots[(k - 1) * nv : k * nv]
        if coupled:
            exponent = 0.0
            for j in range(nv):
                if amplitude[j] != 0.0:
                    e = angle[j] - centre[j]
                    exponent += sharpness[j] * e * e
            pull = weight[k] * bell(exponent)
            for j in range(nv):
                out[j] -= pull * amplitude[j] * (angle[j] - centre[j])
        else:
            for j in range(nv):
                e = angle[j] - centre[j]
                out[j] -= weight[k] * amplitude[j] * e * bell(sharpness[j] * e * e)

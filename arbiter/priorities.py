"""Strict priorities of one simulation, inside compiled code.

    tau = sum_i N_i^T c_i,   N_1 = 1,   N_{i+1} = N_i (1 - s_i Jbar_i J_i N_i)

c_i is what member i asks for, N_i the dynamically consistent null space of everything above it
(Khatib 1987; Sentis & Khatib 2005), Jbar = M^-1 J'^T (J' M^-1 J'^T)^+ with J' = J N, and s_i the
largest activation of the member, so that a lower one comes in smoothly while a higher one is
handed over.

No matrix of these is ever made. The rows of J' are made orthonormal in the metric M^-1 as they
come (Gram and Schmidt): q_k . M^-1 q_l = 1 if k = l, else 0. Then J'^T (J' M^-1 J'^T)^+ J' M^-1 is
sum_k q_k (M^-1 q_k)^T, and a torque is projected by taking away, one q_k after the other, as much
of it as would move what is held.
"""

import numpy as np
from numpy.typing import NDArray

from arbiter.dynamics import solve
from primitives.compiled import Records, compiled

FloatArray = NDArray[np.float64]
SINGULAR = 1e-6  # a row of which less than this share of its square is left is not held


@compiled
def product(a: FloatArray, b: FloatArray) -> float:
    """a . b."""
    total = 0.0
    for j in range(a.shape[0]):
        total += a[j] * b[j]
    return total


@compiled
def project(
    torque: FloatArray, held: FloatArray, answers: FloatArray, firmness: FloatArray, count: int
) -> None:
    """Take away from torques (nv,) what would move that which is held.

    Args:
        torque: [N m]
        held: (most, nv) the rows q.
        answers: (most, nv) M^-1 q.
        firmness: (most,) s of each.
        count: how many there are.
    """
    for k in range(count):
        share = firmness[k] * product(answers[k], torque)
        for j in range(torque.shape[0]):
            torque[j] -= share * held[k, j]


@compiled
def hold_rows(
    dofs: Records,
    factored: FloatArray,
    rows: FloatArray,
    firm: float,
    held: FloatArray,
    answers: FloatArray,
    firmness: FloatArray,
    count: int,
) -> int:
    """Hold the rows (m, nv) of a Jacobian as firmly as s; returns how many are held now.

    Args:
        dofs: of the body.
        factored: M, see `dynamics.factor`.
        rows: J.
        firm: s.
        held: see `project`, likewise the two that follow.
        answers: M^-1 q.
        firmness: of those that are held.
        count: how many were held before.
    """
    first = count
    for r in range(rows.shape[0]):
        if count == held.shape[0]:
            return count
        q, answer = held[count], answers[count]
        for j in range(q.shape[0]):
            q[j] = answer[j] = rows[r, j]
        solve(dofs, factored, answer)
        whole = product(q, answer)
        for k in range(count):
            share = product(answers[k], q) * (1.0 if k >= first else firmness[k])
            for j in range(q.shape[0]):
                q[j] -= share * held[k, j]
                answer[j] -= share * answers[k, j]
        left = product(q, answer)
        if left <= SINGULAR * whole:
            continue
        length = np.sqrt(left)
        for j in range(q.shape[0]):
            q[j] /= length
            answer[j] /= length
        firmness[count] = firm
        count += 1
    return count


__all__ = ["hold_rows", "project"]

"""The compiled part of groups: one rule after another, in one simulation after another."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from arbiter.dynamics import factor, mass_matrix
from arbiter.mixing import Mixing
from arbiter.priorities import hold_rows, project
from arbiter.rules import limit_torques, sum_torques
from primitives.compiled import compiled, compiled_entry, fingerprint
from primitives.goal_field import clear, goal_rows
from primitives.mechanics import Row
from primitives.profiles import step
from primitives.table import PLAIN

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

RULES = ("sum", "weighted", "dominant", "null-space")
WEIGHTED, DOMINANT, NULL_SPACE = range(1, 4)
# `first` of the `members` is where its gains begin.
GROUP = np.dtype([("rule", np.int32), ("first", np.int32), ("members", np.int32)], align=True)
INERT = np.dtype([("armature", np.float64), ("damping", np.float64)], align=True)


@compiled
def field_of(p: Mixing, i: int, m: int) -> int:
    """Which field makes the m-th contribution in simulation i."""
    b = p.backgrounds[0]
    field: int = m if m < b else b + p.slots[i, m - b].node
    return field


@compiled
def find_worth(p: Mixing, i: int, g: int, on: int, worth: FloatArray) -> None:
    """worth[k] (nv,) = the largest activation of what is on in the k-th member of group g."""
    nv = worth.shape[1]
    for k in range(p.groups[g].members):
        clear(worth[k])
    for m in range(on):
        f = field_of(p, i, m)
        k = p.belongs[g, f]
        if k < 0:
            continue
        for j in range(nv):
            if p.counts[f, j]:
                worth[k, j] = max(worth[k, j], p.activation[i, m, j])


@compiled
def weigh(p: Mixing, i: int, g: int, on: int, worth: FloatArray) -> None:
    """Rule `weighted`."""
    gains = p.gains[p.groups[g].first :]
    for j in range(worth.shape[1]):
        total = 0.0
        for k in range(p.groups[g].members):
            total += gains[k] * worth[k, j]
        for m in range(on):
            k = p.belongs[g, field_of(p, i, m)]
            if k >= 0:
                p.contribution[i, m, j] *= gains[k] / max(total, 1.0)


@compiled
def dominate(p: Mixing, i: int, g: int, on: int, worth: FloatArray, pace: float) -> None:
    """Rule `dominant`: of equals the one that is named first.

    `pace` is by how much a share of the joints may change now.
    """
    first, members = p.groups[g].first, p.groups[g].members
    best, most = -1, 0.0
    for k in range(members):
        for j in range(worth.shape[1]):
            if worth[k, j] * p.gains[first + k] > most:
                best, most = k, worth[k, j] * p.gains[first + k]
    kept, total = p.dominance[i, first : first + members], 0.0
    for k in range(members):
        kept[k] += min(max((1.0 if k == best else 0.0) - kept[k], -pace), pace)
        total += step(kept[k])
    for m in range(on):
        k = p.belongs[g, field_of(p, i, m)]
        if k >= 0:
            for j in range(worth.shape[1]):
                p.contribution[i, m, j] *= step(kept[k]) / max(total, 1.0)


@compiled
def prioritise(p: Mixing, share: int, i: int, g: int, on: int, x: Row, worth: FloatArray) -> None:
    """Rule `null-space`; p.mass holds the factored inertia."""
    held, answers, firmness = p.held[share], p.answers[share], p.firmness[share]
    rows, count, last = p.rows[share], 0, p.groups[g].members - 1
    for k in range(last + 1):
        if count:
            for m in range(on):
                if p.belongs[g, field_of(p, i, m)] == k:
                    project(p.contribution[i, m], held, answers, firmness, count)
        for m in range(on if k < last else 0):
            f = field_of(p, i, m)
            if p.belongs[g, f] != k:
                continue
            firm = 0.0
            for j in range(worth.shape[1]):
                if p.counts[f, j]:
                    firm = max(firm, p.activation[i, m, j])
            if firm == 0.0:
                continue
            if p.fields[f].kind == PLAIN:
                own = p.given[i, p.fields[f].row]
                made = p.given_rows[p.fields[f].row]
            else:
                own, made = rows, goal_rows(p.fields, p.claims, p.reaches, f, x, rows)
            count = hold_rows(
                x.dofs, p.mass[share], own[:made], firm, held, answers, firmness, count
            )


@compiled
def combine_one(share: int, i: int, time: float, x: Row, p: Mixing) -> None:
    """Combine what is asked for in simulation i."""
    on = p.backgrounds[0] + p.live[i]
    worth, factored = p.worth[share], False
    pace = min((time - p.clock[i]) / p.fade[0], 1.0)
    p.clock[i] = time
    for g in range(p.groups.shape[0]):
        rule = p.groups[g].rule
        if rule == NULL_SPACE:
            if not factored:
                mass_matrix(x, p.lumps, p.joints, 0.0, p.whole[share], p.mass[share])
                factor(x.dofs, p.mass[share])
                factored = True
            prioritise(p, share, i, g, on, x, worth)
        elif rule != 0:
            find_worth(p, i, g, on, worth)
            if rule == WEIGHTED:
                weigh(p, i, g, on, worth)
            else:
                dominate(p, i, g, on, worth, pace)
    sum_torques(p.contribution[i], on, p.torque[i])
    limit_torques(x.dofs, p.torque[i])


@compiled
def combine_share(
    share: int,
    time: FloatArray,
    qpos: FloatArray,
    qvel: FloatArray,
    xpos: FloatArray,
    xmat: FloatArray,
    cdof: FloatArray,
    cvel: FloatArray,
    com: FloatArray,
    p: Mixing,
) -> None:
    """Combine in a share of the simulations."""
    for i in range(p.shares[share], p.shares[share + 1]):
        x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], cvel[i], com[i], p.links, p.dofs)
        combine_one(share, i, time[i], x, p)


def _make(code: str) -> Callable[..., None]:
    @compiled_entry
    def combine(share, time, qpos, qvel, xpos, xmat, cdof, cvel, com, r):  # type: ignore[no-untyped-def]
        """See `combine_share`."""
        len(code)
        parts = Mixing(
            r.links, r.dofs, r.lumps, r.joints, r.fields, r.claims, r.reaches, r.groups, r.gains,
            r.belongs, r.counts, r.fade, r.backgrounds, r.slots, r.live, r.contribution,
            r.activation, r.torque, r.dominance, r.clock, r.given, r.given_rows, r.shares,
            r.mass, r.whole, r.worth, r.rows, r.held, r.answers, r.firmness,
        )  # fmt: skip
        combine_share(share, time, qpos, qvel, xpos, xmat, cdof, cvel, com, parts)

    return combine


combine: Callable[..., None] = _make(fingerprint())

__all__ = ["GROUP", "INERT", "RULES", "combine"]

"""The compiled part of the safety filter: predict, look at every limit, write the programme.

See `barriers` and `keeping_apart` for what is asked of each limit, `safety` for what becomes of it.
"""

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from arbiter.barriers import SMOOTHING, look_at_joints
from arbiter.dynamics import factor, help_at, mass_matrix, move, push_on, solve, times_mass
from arbiter.filtering import Filtering
from arbiter.keeping_apart import look_at_pairs
from primitives.compiled import Records, compiled, compiled_entry, fingerprint
from primitives.mechanics import Row, Vector, cross, dot, scale, subtract, tree_centre

FloatArray = NDArray[np.float64]

_inlined: Any = numba.njit(inline="always")
TINY = 1e-9  # what may be missing of a limit before the torque is changed
SOON = 5.0  # a limit with less left has a row from the start [m/s^2, rad/s^2]
LEAST = 1e-3  # torque limit that a joint without motor is counted with [N m]


@compiled
def add_pull(x: Row, link: int, point: Vector, direction: Vector, out: FloatArray) -> None:
    """out += the row n . J of a point of a link."""
    moment = cross(subtract(point, tree_centre(x, link)), direction)
    s = x.cdof
    j = x.links[link].last_dof
    while j >= 0:
        out[j] += (
            s[j, 0] * moment[0] + s[j, 1] * moment[1] + s[j, 2] * moment[2]
            + s[j, 3] * direction[0] + s[j, 4] * direction[1] + s[j, 5] * direction[2]
        )  # fmt: skip
        j = x.dofs[j].parent


@compiled
def gain(x: Row, near: FloatArray, moving: FloatArray, further: FloatArray) -> float:
    """By how much a change of the joints' acceleration, which `moving` tells too, opens a limit."""
    if near[1] >= 0.0:
        return float(near[2] * further[int(near[1])])
    on_a, on_b = (near[4], near[5], near[6]), (near[7], near[8], near[9])
    apart = subtract(help_at(x, moving, int(near[2]), on_a), help_at(x, moving, int(near[3]), on_b))
    return float(dot((near[10], near[11], near[12]), apart))


@compiled
def add_row(x: Row, i: int, k: int, count: int, p: Filtering, pull: FloatArray) -> int:
    """Ask of the change that limit k be kept; returns how many rows there are then.

    The row is J M^-1, times the torque limits. It is scaled by the root of J M^-1 J^T, so that
    what is missing of it is measured like the change. No more is asked for than all motors
    together could do, so that what no motor can help does not outweigh the rest.

    Args:
        x: the simulation.
        i: which it is.
        k: the limit.
        count: how many rows there are.
        p: the filter.
        pull: (nv,) to work in: J.
    """
    nv, near, row, cost = pull.shape[0], p.near[i, k], p.rows[i, count], p.cost[i]
    near[14] = 1.0
    for j in range(nv):
        pull[j] = row[j] = 0.0
    if near[1] >= 0.0:
        pull[int(near[1])] = near[2]
    else:
        n = near[10], near[11], near[12]
        add_pull(x, int(near[2]), (near[4], near[5], near[6]), n, pull)
        add_pull(x, int(near[3]), (near[7], near[8], near[9]), scale(-1.0, n), pull)
    square = 0.0
    for j in range(nv):
        pull[j] /= max(p.joints[j].limit, LEAST)
        if pull[j] != 0.0:
            for m in range(nv):
                row[m] += cost[j, m] * pull[j]
    for j in range(nv):
        square += row[j] * pull[j]
    if square < 1e-9:
        return count
    length, most = np.sqrt(square), 0.0
    for j in range(nv):
        row[j] = row[j] / length if p.joints[j].limit > 0.0 else 0.0
        most += max(row[j] * p.lower[i, j], row[j] * p.upper[i, j])
    p.lower[i, nv + count] = min(-near[0] / length, most)
    return count + 1


@compiled
def write_cost(dofs: Records, joints: Records, factored: FloatArray, cost: FloatArray) -> None:
    """cost = M^-1, times the torque limits on both sides."""
    nv = cost.shape[0]
    for j in range(nv):
        for i in range(nv):
            cost[j, i] = 0.0
        cost[j, j] = 1.0
        solve(dofs, factored, cost[j])
        for i in range(nv):
            cost[j, i] *= max(joints[j].limit, LEAST) * max(joints[i].limit, LEAST)


@compiled
def observe(
    fresh: bool, step: float, x: Row, p: Filtering, i: int, mass: FloatArray, force: FloatArray
) -> None:
    """Bring p.besides[i], the torques that act besides, up to date; `force` is to work in."""
    nv = force.shape[0]
    if fresh:
        for j in range(nv):
            p.besides[i, j] = 0.0
        return
    for j in range(nv):
        p.before[i, j] = (x.qvel[j] - p.before[i, j]) / step
    times_mass(x.dofs, mass, p.before[i], force)
    for j in range(nv):
        unexplained = force[j] - p.applied[i, j] - p.passive[i, j]
        p.besides[i, j] += SMOOTHING * (unexplained - p.besides[i, j])


@compiled
def screen_one(
    share: int, i: int, now: float, step: float, x: Row, bias: FloatArray, p: Filtering
) -> int:
    """Write the rows of the limits that are near if the torque runs into one; returns how many."""
    nv = bias.shape[0]
    mass, force, moving, near = p.mass[share], p.work[share], p.moving[share], p.near[i]
    torque = p.torque[i]
    mass_matrix(x, p.lumps, p.joints, step, p.whole[share], mass)
    observe(abs(now - p.clock[i] - step) > 0.5 * step, step, x, p, i, mass, force)
    p.clock[i] = now
    help_ = p.help[share]
    for j in range(nv):
        help_[j] = p.besides[i, j]
        p.before[i, j] = x.qvel[j]
        p.passive[i, j] = -bias[j] - p.joints[j].damping * x.qvel[j]
        p.applied[i, j] = torque[j]
        force[j] = torque[j] + p.passive[i, j] + p.besides[i, j]
    factor(x.dofs, mass)
    solve(x.dofs, mass, force)
    solve(x.dofs, mass, help_)
    move(x, force, help_, moving)
    count = look_at_joints(x, p.joints, force, help_, near)
    count = look_at_pairs(
        x, p.guarded, p.pairs, p.brushing, p.capsules, p.touches[i], moving,
        p.balls[share], p.placed[share], count, near,
    )  # fmt: skip
    for k in range(p.touches.shape[1]):
        p.touches[i, k].share = 0.0  # so that an old one is not read again
    p.found[i] = count
    runs_into = False
    for k in range(count):
        near[k, 14] = 0.0
        runs_into = runs_into or near[k, 0] < -TINY
    if not runs_into:
        return 0
    write_cost(x.dofs, p.joints, mass, p.cost[i])
    for j in range(nv):
        part = torque[j] / max(p.joints[j].limit, LEAST)
        p.upper[i, j], p.lower[i, j] = 1.0 - part, -1.0 - part
    rows = 0
    for k in range(count):
        if near[k, 0] < SOON:
            rows = add_row(x, i, k, rows, p, force)
    return rows


@compiled
def settle_one(x: Row, i: int, change: FloatArray, more: bool, p: Filtering) -> int:
    """Take a change of the torque, or add rows for the limits that it would run into.

    Args:
        x: the simulation.
        i: which it is.
        change: (nv,) of the torques, as shares of their limits.
        more: whether rows may be added.
        p: the filter.

    Returns:
        How many rows there are now; 0 if the change was taken.
    """
    nv, moving, further = change.shape[0], p.moving[0], p.help[0]
    for j in range(nv):
        total = 0.0
        for k in range(nv):
            total += p.cost[i, j, k] * change[k]
        further[j] = total / max(p.joints[j].limit, LEAST)
    push_on(x, further, moving)
    rows = p.count[i]
    for k in range(p.found[i] if more else 0):
        near = p.near[i, k]
        if near[14] == 0.0 and near[0] + gain(x, near, moving, further) < -TINY:
            rows = add_row(x, i, k, rows, p, p.work[0])
    if rows > p.count[i]:
        p.count[i] = rows
        return int(rows)
    for j in range(nv):
        take(i, j, p.torque[i, j] + change[j] * p.joints[j].limit, p)
    return 0


@compiled
def take(i: int, j: int, torque: float, p: Filtering) -> None:
    """Let a torque replace the one that was asked for."""
    limit = p.joints[j].limit
    safe = min(max(torque, -limit), limit)
    if p.contribution.shape[0]:
        p.contribution[i, p.contribution.shape[1] - 1, j] += safe - p.torque[i, j]
    p.torque[i, j] = p.applied[i, j] = safe


@compiled
def screen_share(
    share: int,
    step: float,
    time: FloatArray,
    qpos: FloatArray,
    qvel: FloatArray,
    xpos: FloatArray,
    xmat: FloatArray,
    cdof: FloatArray,
    cvel: FloatArray,
    com: FloatArray,
    bias: FloatArray,
    p: Filtering,
) -> int:
    """Look at a share of the simulations; returns how many run into something."""
    found = 0
    for i in range(p.shares[share], p.shares[share + 1]):
        x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], cvel[i], com[i], p.links, p.dofs)
        p.count[i] = screen_one(share, i, time[i], step, x, bias[i], p)
        found += p.count[i] > 0
        for j in range(p.contribution.shape[2] if p.contribution.shape[0] else 0):
            total = 0.0
            for m in range(p.backgrounds[0] + p.live[i]):
                total += p.contribution[i, m, j]
            p.contribution[i, p.contribution.shape[1] - 1, j] = p.torque[i, j] - total
    return found


@_inlined  # type: ignore[untyped-decorator]
def unpack(r: Any) -> Filtering:
    """The arrays of a `Filter`."""
    return Filtering(
        r.links, r.dofs, r.lumps, r.joints, r.guarded, r.pairs, r.brushing, r.capsules, r.touches,
        r.live, r.backgrounds, r.contribution, r.torque, r.applied, r.passive, r.besides,
        r.before, r.clock, r.near, r.found, r.rows, r.upper, r.lower, r.cost, r.count, r.shares,
        r.mass, r.whole, r.moving, r.work, r.help, r.balls, r.placed,
    )  # fmt: skip


def _make(code: str) -> Any:
    @compiled_entry
    def screen(share, step, time, qpos, qvel, xpos, xmat, cdof, cvel, com, bias, r):  # type: ignore[no-untyped-def]
        """See `screen_share`."""
        len(code)
        p = unpack(r)
        return screen_share(share, step, time, qpos, qvel, xpos, xmat, cdof, cvel, com, bias, p)

    @compiled_entry
    def settle(i, change, more, qpos, qvel, xpos, xmat, cdof, cvel, com, r):  # type: ignore[no-untyped-def]
        """See `settle_one`."""
        len(code)
        p = unpack(r)
        x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], cvel[i], com[i], p.links, p.dofs)
        return settle_one(x, i, change, more, p)

    return screen, settle


screen, settle = _make(fingerprint())

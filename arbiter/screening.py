"""The compiled part of the safety filter: predict, look at every limit, write the programme.

See `barriers` for what is asked of each limit, and `safety` for what becomes of it.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from arbiter.barriers import SMOOTHING, look_at_joints, look_at_pairs
from arbiter.dynamics import factor, mass_matrix, move, solve, times_mass
from arbiter.filtering import Filtering
from primitives.compiled import Records, compiled, compiled_entry, fingerprint
from primitives.mechanics import Row, Vector, cross, scale, subtract, tree_centre

FloatArray = NDArray[np.float64]


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
def write_row(
    x: Row,
    joints: Records,
    factored: FloatArray,
    near: FloatArray,
    k: int,
    pull: FloatArray,
    row: FloatArray,
) -> float:
    """row . u >= what is returned, u being the change of torque as a share of its limit.

    It is scaled by the root of J M^-1 J^T, so that what is missing of it is measured like u.

    Args:
        x: the simulation.
        joints: JOINT.
        factored: M.
        near: the limits.
        k: which of them.
        pull: (nv,) to work in: J.
        row: (nv,) what is filled in: J M^-1, times the torque limits.
    """
    nv = row.shape[0]
    for j in range(nv):
        pull[j] = 0.0
    if near[k, 1] >= 0.0:
        pull[int(near[k, 1])] = near[k, 2]
    else:
        n = near[k, 10], near[k, 11], near[k, 12]
        add_pull(x, int(near[k, 2]), (near[k, 4], near[k, 5], near[k, 6]), n, pull)
        opposite = scale(-1.0, n)
        add_pull(x, int(near[k, 3]), (near[k, 7], near[k, 8], near[k, 9]), opposite, pull)
    for j in range(nv):
        row[j] = pull[j]
    solve(x.dofs, factored, row)
    square = 0.0
    for j in range(nv):
        square += row[j] * pull[j]
    if square < 1e-9:
        return -np.inf
    length = np.sqrt(square)
    for j in range(nv):
        row[j] *= joints[j].limit / length
    return float(-near[k, 0] / length)


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
            cost[j, i] *= max(joints[j].limit, 1e-3) * max(joints[i].limit, 1e-3)


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
    mass, force, moving, near = p.mass[share], p.work[share], p.moving[share], p.near[share]
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
        x, p.guarded, p.pairs, p.capsules, p.touches[i], moving,
        p.balls[share], p.placed[share], count, near,
    )  # fmt: skip
    for k in range(p.touches.shape[1]):
        p.touches[i, k].share = 0.0  # so that an old one is not read again
    runs_into = False
    for k in range(count):
        runs_into = runs_into or near[k, 0] < -1e-9
    if not runs_into:
        return 0
    for k in range(count):
        p.needs[i, k] = write_row(x, p.joints, mass, near, k, force, p.rows[i, k])
    write_cost(x.dofs, p.joints, mass, p.cost[i])
    return count


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


def _make(code: str) -> Any:
    @compiled_entry
    def screen(share, step, time, qpos, qvel, xpos, xmat, cdof, cvel, com, bias, r):  # type: ignore[no-untyped-def]
        """See `screen_share`."""
        len(code)
        parts = Filtering(
            r.links, r.dofs, r.lumps, r.joints, r.guarded, r.pairs, r.capsules, r.touches,
            r.live, r.backgrounds, r.contribution, r.torque, r.applied, r.passive, r.besides,
            r.before, r.clock, r.rows, r.needs, r.cost, r.count, r.shares, r.mass, r.whole, r.moving,  # noqa: E501
            r.work, r.help, r.balls, r.placed, r.near,
        )  # fmt: skip
        return screen_share(share, step, time, qpos, qvel, xpos, xmat, cdof, cvel, com, bias, parts)

    return screen


screen: Any = _make(fingerprint())

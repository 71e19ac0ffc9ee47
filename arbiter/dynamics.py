"""The equations of motion of one simulation, compiled: M q'' = tau - bias - D q'.

M is made from composite bodies and factored as L^T D L along the branches of the tree, where
it has no zeros (Featherstone 2008, Rigid Body Dynamics Algorithms, 6.2 and 6.5). Like MuJoCo's
implicit integrator, M holds the damping of one time step. All is taken in world axes about
the centre of mass c of the tree, as MuJoCo's `cdof` is; the test is MuJoCo's own M.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records, compiled
from primitives.mechanics import (
    Row,
    Vector,
    add,
    cross,
    dot,
    scale,
    subtract,
    to_world,
    tree_centre,
    vector,
)
from sim import Body, inertias

FloatArray = NDArray[np.float64]

LUMP = np.dtype(
    [
        *(("parent", np.int32), ("moves", np.bool_), ("mass", np.float64)),
        *(("centre", np.float64, (3,)), ("inertia", np.float64, (9,))),
    ],
    align=True,
)


def lump_table(body: Body) -> Records:
    """Per link: what it weighs, and the link that carries it."""
    found = inertias(body)
    table = np.zeros(len(found.mass), dtype=LUMP)
    table["parent"], table["mass"], table["centre"] = found.parent, found.mass, found.centre
    table["inertia"] = found.inertia.reshape(-1, 9)
    for link, parent in enumerate(found.parent):
        table["moves"][link] = link and (body.model.body_dofnum[link] or table["moves"][parent])
    return table


@compiled
def gather(x: Row, lumps: Records, whole: FloatArray) -> None:
    """whole[b] = inertia of link b and all it carries, about c: mass, mass times centre, tensor.

    The tensor's six numbers are xx, yy, zz, xy, xz, yz.
    """
    m = x.xmat
    for b in range(lumps.shape[0]):
        for k in range(10):
            whole[b, k] = 0.0
        if not lumps[b].moves:
            continue
        mass, tensor = lumps[b].mass, lumps[b].inertia
        at = subtract(to_world(x, b, vector(lumps[b].centre)), tree_centre(x, b))
        whole[b, 0] = mass
        whole[b, 1], whole[b, 2], whole[b, 3] = scale(mass, at)
        square = mass * dot(at, at)
        for n in range(6):
            i = n if n < 3 else (0 if n < 5 else 1)
            j = n if n < 3 else (n - 2 if n < 5 else 2)
            total = 0.0
            for k in range(3):
                inner = (
                    tensor[3 * k] * m[b, 3 * j]
                    + tensor[3 * k + 1] * m[b, 3 * j + 1]
                    + tensor[3 * k + 2] * m[b, 3 * j + 2]
                )
                total += m[b, 3 * i + k] * inner
            whole[b, 4 + n] = total - mass * at[i] * at[j] + (square if n < 3 else 0.0)
    for b in range(lumps.shape[0] - 1, 0, -1):
        parent = lumps[b].parent
        if lumps[b].moves and lumps[parent].moves:
            for k in range(10):
                whole[parent, k] += whole[b, k]


@compiled
def mass_matrix(
    x: Row, lumps: Records, joints: Records, step: float, whole: FloatArray, mass: FloatArray
) -> None:
    """mass[j, i] [kg m^2] for every joint j and each i that carries it; the rest is left alone."""
    gather(x, lumps, whole)
    for j in range(joints.shape[0]):
        b, s = x.dofs[j].link, x.cdof
        w, v = (s[j, 0], s[j, 1], s[j, 2]), (s[j, 3], s[j, 4], s[j, 5])
        c = whole[b]
        h = c[1], c[2], c[3]
        moment = add(
            cross(h, v),
            (
                c[4] * w[0] + c[7] * w[1] + c[8] * w[2],
                c[7] * w[0] + c[5] * w[1] + c[9] * w[2],
                c[8] * w[0] + c[9] * w[1] + c[6] * w[2],
            ),
        )
        force = subtract(scale(c[0], v), cross(h, w))
        i = j
        while i >= 0:
            mass[j, i] = (
                s[i, 0] * moment[0] + s[i, 1] * moment[1] + s[i, 2] * moment[2]
                + s[i, 3] * force[0] + s[i, 4] * force[1] + s[i, 5] * force[2]
            )  # fmt: skip
            i = x.dofs[i].parent
        mass[j, j] += joints[j].armature + step * joints[j].damping


@compiled
def times_mass(dofs: Records, mass: FloatArray, a: FloatArray, out: FloatArray) -> None:
    """out = M a."""
    for j in range(dofs.shape[0]):
        out[j] = 0.0
    for j in range(dofs.shape[0]):
        out[j] += mass[j, j] * a[j]
        i = dofs[j].parent
        while i >= 0:
            out[j] += mass[j, i] * a[i]
            out[i] += mass[j, i] * a[j]
            i = dofs[i].parent


@compiled
def factor(dofs: Records, mass: FloatArray) -> None:
    """M = L^T D L, in place: D on the diagonal, L below it."""
    for k in range(dofs.shape[0] - 1, -1, -1):
        i = dofs[k].parent
        while i >= 0:
            share = mass[k, i] / mass[k, k]
            j = i
            while j >= 0:
                mass[i, j] -= share * mass[k, j]
                j = dofs[j].parent
            mass[k, i] = share
            i = dofs[i].parent


@compiled
def solve(dofs: Records, factored: FloatArray, b: FloatArray) -> None:
    """b becomes M^-1 b."""
    for k in range(dofs.shape[0] - 1, -1, -1):
        i = dofs[k].parent
        while i >= 0:
            b[i] -= factored[k, i] * b[k]
            i = dofs[i].parent
    for k in range(dofs.shape[0]):
        b[k] /= factored[k, k]
        i = dofs[k].parent
        while i >= 0:
            b[k] -= factored[k, i] * b[i]
            i = dofs[i].parent


@compiled
def move(x: Row, acceleration: FloatArray, part: FloatArray, moving: FloatArray) -> None:
    """Velocity (columns 0 to 5) and acceleration (6 to 11) of each joint's far side, about c.

    Columns 12 to 17 are the acceleration that a part (nv,) of that of the joints makes.
    Angular, then linear; spatial accelerations, as of a body-fixed point that passes c.
    """
    s = x.cdof
    for j in range(x.qvel.shape[0]):
        i, rate = x.dofs[j].parent, x.qvel[j]
        for k in range(18):
            moving[j, k] = moving[i, k] if i >= 0 else 0.0
        before = moving[j]
        w, v = (before[0], before[1], before[2]), (before[3], before[4], before[5])
        angular, linear = (s[j, 0], s[j, 1], s[j, 2]), (s[j, 3], s[j, 4], s[j, 5])
        turn = cross(w, angular)
        shift = add(cross(w, linear), cross(v, angular))
        for k in range(3):
            moving[j, 6 + k] += s[j, k] * acceleration[j] + turn[k] * rate
            moving[j, 9 + k] += s[j, 3 + k] * acceleration[j] + shift[k] * rate
        for k in range(6):
            moving[j, k] += s[j, k] * rate
            moving[j, 12 + k] += s[j, k] * part[j]


@compiled
def push_on(x: Row, part: FloatArray, moving: FloatArray) -> None:
    """Columns 12 to 17 for another part (nv,) of the joints' acceleration."""
    for j in range(x.qvel.shape[0]):
        i = x.dofs[j].parent
        for k in range(6):
            carried = moving[i, 12 + k] if i >= 0 else 0.0
            moving[j, 12 + k] = carried + x.cdof[j, k] * part[j]


@compiled
def velocity_at(x: Row, moving: FloatArray, link: int, point: Vector) -> Vector:
    """Velocity of the point of a link that is at `point` in the world [m/s]."""
    j = x.links[link].last_dof
    if j < 0:
        return 0.0, 0.0, 0.0
    m, arm = moving[j], subtract(point, tree_centre(x, link))
    return add((m[3], m[4], m[5]), cross((m[0], m[1], m[2]), arm))


@compiled
def acceleration_at(x: Row, moving: FloatArray, link: int, point: Vector) -> Vector:
    """Acceleration of the same point [m/s^2]."""
    j = x.links[link].last_dof
    if j < 0:
        return 0.0, 0.0, 0.0
    m, arm = moving[j], subtract(point, tree_centre(x, link))
    spin = m[0], m[1], m[2]
    velocity = add((m[3], m[4], m[5]), cross(spin, arm))
    spatial = add((m[9], m[10], m[11]), cross((m[6], m[7], m[8]), arm))
    return add(spatial, cross(spin, velocity))


@compiled
def help_at(x: Row, moving: FloatArray, link: int, point: Vector) -> Vector:
    """The part of it that columns 12 to 17 tell of [m/s^2]."""
    j = x.links[link].last_dof
    if j < 0:
        return 0.0, 0.0, 0.0
    m, arm = moving[j], subtract(point, tree_centre(x, link))
    return add((m[15], m[16], m[17]), cross((m[12], m[13], m[14]), arm))


__all__ = [
    "LUMP",
    "acceleration_at",
    "factor",
    "help_at",
    "lump_table",
    "mass_matrix",
    "move",
    "push_on",
    "solve",
    "times_mass",
    "velocity_at",
]

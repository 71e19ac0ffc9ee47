"""Forces and velocities of points on links, inside compiled code.

MuJoCo's `cdof` holds one motion axis per degree of freedom, (angular w, linear v), taken
about the centre of mass c of the kinematic tree. A point p of a link that the axis moves
has the velocity v + w x (p - c), so J^T F = w . ((p - c) x F) + v . F: no Jacobian is stored.
`cvel` holds the velocities of the links in the same form.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records, compiled
from sim import Body

FloatArray = NDArray[np.float64]

LINK = np.dtype([("last_dof", np.int32), ("root", np.int32), ("mass", np.float64)], align=True)
DOF = np.dtype(
    [("parent", np.int32), ("link", np.int32), ("qpos", np.int32), ("limit", np.float64)],
    align=True,
)


def link_table(body: Body) -> Records:
    """Per link: the degree of freedom nearest to it, its tree's root, the mass it carries."""
    model = body.model
    table = np.zeros(model.nbody, dtype=LINK)
    for link in range(model.nbody):
        parent = model.body_parentid[link]
        own = model.body_dofadr[link] + model.body_dofnum[link] - 1
        inherited = table["last_dof"][parent] if link else -1
        table["last_dof"][link] = own if model.body_dofnum[link] else inherited
    table["root"] = model.body_rootid
    table["mass"] = model.body_subtreemass
    return table


def dof_table(body: Body) -> Records:
    """Per degree of freedom: the next one towards the root, its link, and its motor's limit."""
    model = body.model
    table = np.zeros(model.nv, dtype=DOF)
    table["parent"] = model.dof_parentid
    table["link"] = model.dof_bodyid
    table["qpos"] = body.qpos_of_dof
    table["limit"] = body.torque_limit
    return table


class Row(NamedTuple):
    """One simulation's state, with the tables of its body."""

    qpos: FloatArray  # (nq,)
    qvel: FloatArray  # (nv,)
    xpos: FloatArray  # (nbody, 3)
    xmat: FloatArray  # (nbody, 9)
    cdof: FloatArray  # (nv, 6)
    cvel: FloatArray  # (nbody, 6)
    com: FloatArray  # (nbody, 3)
    links: Records
    dofs: Records


Vector = tuple[float, float, float]


@compiled
def add(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@compiled
def subtract(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@compiled
def scale(k: float, a: Vector) -> Vector:
    """k a."""
    return k * a[0], k * a[1], k * a[2]


@compiled
def dot(a: Vector, b: Vector) -> float:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def unit(a: Vector) -> Vector:
    """a / |a|, or a itself when it has no length."""
    length = np.sqrt(dot(a, a))
    return scale(1.0 / length, a) if length > 1e-9 else a


@compiled
def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@compiled
def vector(a: FloatArray) -> Vector:
    """The first three elements of an array."""
    return a[0], a[1], a[2]


@compiled
def store(array: FloatArray, at: int, a: Vector) -> None:
    """Write a vector into an array."""
    array[at], array[at + 1], array[at + 2] = a


@compiled
def rotate(x: Row, link: int, a: Vector) -> Vector:
    """Rotate out of a link's frame."""
    m = x.xmat
    return (
        m[link, 0] * a[0] + m[link, 1] * a[1] + m[link, 2] * a[2],
        m[link, 3] * a[0] + m[link, 4] * a[1] + m[link, 5] * a[2],
        m[link, 6] * a[0] + m[link, 7] * a[1] + m[link, 8] * a[2],
    )


@compiled
def unrotate(x: Row, link: int, a: Vector) -> Vector:
    """Rotate into a link's frame."""
    m = x.xmat
    return (
        m[link, 0] * a[0] + m[link, 3] * a[1] + m[link, 6] * a[2],
        m[link, 1] * a[0] + m[link, 4] * a[1] + m[link, 7] * a[2],
        m[link, 2] * a[0] + m[link, 5] * a[1] + m[link, 8] * a[2],
    )


@compiled
def origin(x: Row, link: int) -> Vector:
    """Origin of a link in the world."""
    return x.xpos[link, 0], x.xpos[link, 1], x.xpos[link, 2]


@compiled
def tree_centre(x: Row, link: int) -> Vector:
    """The c of a link: centre of mass of its kinematic tree."""
    root = x.links[link].root
    return x.com[root, 0], x.com[root, 1], x.com[root, 2]


@compiled
def to_world(x: Row, link: int, point: Vector) -> Vector:
    """World position of a point fixed to a link."""
    return add(origin(x, link), rotate(x, link, point))


@compiled
def to_link(x: Row, link: int, point: Vector) -> Vector:
    """Position in a link's frame of a point of the world."""
    return unrotate(x, link, subtract(point, origin(x, link)))


@compiled
def spin(x: Row, link: int) -> Vector:
    """Angular velocity of a link [rad/s]."""
    return x.cvel[link, 0], x.cvel[link, 1], x.cvel[link, 2]


@compiled
def point_velocity(x: Row, link: int, point: Vector) -> Vector:
    """Velocity of the point of a link that is at `point` in the world [m/s]."""
    linear = x.cvel[link, 3], x.cvel[link, 4], x.cvel[link, 5]
    return add(linear, cross(spin(x, link), subtract(point, tree_centre(x, link))))


@compiled
def joint_torque(x: Row, j: int, moment: Vector, force: Vector) -> float:
    """Torque about joint j of a wrench that is taken about c."""
    s = x.cdof
    angular = s[j, 0], s[j, 1], s[j, 2]
    linear = s[j, 3], s[j, 4], s[j, 5]
    return dot(angular, moment) + dot(linear, force)


@compiled
def push_link(x: Row, link: int, moment: Vector, force: Vector, out: FloatArray) -> None:
    """out += J^T of a wrench on a link, taken about c, over every joint that carries it."""
    j = x.links[link].last_dof
    while j >= 0:
        out[j] += joint_torque(x, j, moment, force)
        j = x.dofs[j].parent


@compiled
def turn_between(start: Vector, goal: Vector, share: float) -> Vector:
    """Unit vector at a share of the shortest turn from one unit vector to another."""
    cosine = min(max(dot(start, goal), -1.0), 1.0)
    if share >= 1.0 or cosine > 0.999999:
        return goal
    aside = subtract(goal, scale(cosine, start))  # the part of goal across start
    length = np.sqrt(dot(aside, aside))
    if length < 1e-6:  # opposite: any way round is as short; take the one nearest to up
        aside = subtract((0.0, 0.0, 1.0), scale(start[2], start))
        length = np.sqrt(dot(aside, aside))
        if length < 1e-6:
            aside, length = (1.0, 0.0, 0.0), 1.0
    angle: float = share * np.arccos(cosine)
    return add(scale(np.cos(angle), start), scale(np.sin(angle) / length, aside))


@compiled
def turn_by_way_of(start: Vector, way: Vector, goal: Vector, share: float) -> Vector:
    """Like `turn_between`, but by way of a third unit vector, a quarter of a turn from `start`."""
    aside = subtract(way, scale(dot(way, start), start))
    length = np.sqrt(dot(aside, aside))
    if length < 0.1:
        return turn_between(start, goal, share)
    middle = scale(1.0 / length, aside)
    quarter, rest = 0.5 * np.pi, np.arccos(min(max(dot(middle, goal), -1.0), 1.0))
    done = share * (quarter + rest)
    if done < quarter:
        return turn_between(start, middle, done / quarter)
    return turn_between(middle, goal, min((done - quarter) / max(rest, 1e-6), 1.0))


@compiled
def turn_error(current: Vector, wanted: Vector) -> Vector:
    """Rotation vector that takes one unit vector to another, its length held to at most 1."""
    axis = cross(current, wanted)
    if dot(current, wanted) >= 0.0:
        return axis
    length = np.sqrt(dot(axis, axis))
    return scale(1.0 / length, axis) if length > 1e-9 else axis

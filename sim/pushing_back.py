"""What pushes back: the ends of joints, and what is leant on, as softly as in MuJoCo's model.

The forces f >= 0 along rows J of the joints' velocities are those with which

    u' + R f = k d r - b u,    u = J v,    b = 2 / (d_max T),    k = 1 / (d_max T z)^2,

for a depth r that is left at the speed u: MuJoCo's soft constraints (Todorov 2014), T and z being
the time constant and damping ratio that the model gives, d its impedance at this depth, and
R = (1 - d) / d by the inertia that MuJoCo takes for the links. A contact that rubs has four rows,
the edges of its pyramid.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

AT_ONCE, ONE_BY_ONE = 6, 60  # rounds in which rows that push the wrong way change sides
SAME = 1e-9  # [m/rad] links that move alike


@dataclass(frozen=True)
class Stop:
    """One row of what pushes back."""

    links: tuple[str, str] | None  # that lean on each other; None for the end of a joint
    depth: float  # r [m or rad]
    away: FloatArray  # J (j,): how fast the joints lead out of it
    stiffness: float  # k d [1/s^2]
    damping: float  # b [1/s]
    give: float  # R [1/kg or 1/(kg m^2)]


class Stops:
    """Finds what pushes back on some joints.

    Args:
        body: whose joints.
        dofs: which of them (j,).
        passed: pairs of links that go through each other.
    """

    def __init__(self, body: Body, dofs: IntArray, passed: frozenset[tuple[str, str]]) -> None:
        self._body, self._dofs = body, dofs
        self._range = tuple(limit[dofs] for limit in body.range)
        self._columns = body.qpos_of_dof[dofs]
        pairs = [(body.link(one), body.link(other)) for one, other in passed]
        self._passed = {*pairs, *((other, one) for one, other in pairs)}
        self._jacobians = np.zeros((2, 3, body.nv))

    def found(self, data: mujoco.MjData) -> list[Stop]:
        """All of them in the present kinematics."""
        return [*self._ends(data), *self._contacts(data)]

    def _ends(self, data: mujoco.MjData) -> Iterator[Stop]:
        model, (low, high) = self._body.model, self._range
        angles = data.qpos[self._columns]
        for side, past in ((1.0, low - angles), (-1.0, angles - high)):
            for j in np.flatnonzero(past > 0.0):
                dof = self._dofs[j]
                joint, away = model.dof_jntid[dof], np.zeros(len(angles))
                away[j] = side
                softness = model.jnt_solref[joint], model.jnt_solimp[joint]
                inverse = float(model.dof_invweight0[dof])
                yield _stop(None, float(past[j]), away, inverse, *softness)

    def _contacts(self, data: mujoco.MjData) -> Iterator[Stop]:
        model = self._body.model
        mujoco.mj_collision(model, data)
        for k in range(data.ncon):
            contact = data.contact[k]
            one, other = (int(model.geom_bodyid[g]) for g in contact.geom)
            if contact.dist >= 0.0 or (one, other) in self._passed:
                continue
            for jacobian, link in zip(self._jacobians, (one, other), strict=True):
                mujoco.mj_jac(model, data, jacobian, None, contact.pos, link)
            lead = (self._jacobians[1] - self._jacobians[0])[:, self._dofs]
            away, *aside = contact.frame.reshape(3, 3) @ lead
            if np.abs(away).max() < SAME:  # neither moves, or both alike
                continue
            links = model.body(one).name, model.body(other).name
            softness = contact.solref, contact.solimp
            inverse = float(model.body_invweight0[[one, other], 0].sum())
            if contact.dim == 1:
                yield _stop(links, -contact.dist, away, inverse, *softness)
                continue
            rub = float(contact.friction[0])
            inverse *= 2.0 * rub**2 * (1.0 + rub**2)
            for across in aside:
                for edge in (away + rub * across, away - rub * across):
                    yield _stop(links, -contact.dist, edge, inverse, *softness)


def _stop(
    links: tuple[str, str] | None,
    depth: float,
    away: FloatArray,
    inverse: float,
    solref: FloatArray,
    solimp: FloatArray,
) -> Stop:
    """A row; `inverse` is the inverse of the inertia that MuJoCo takes for it."""
    (time, ratio), (least, most, width, middle, power) = solref.tolist(), solimp.tolist()
    share = min(depth / width, 1.0)
    if share <= middle:
        rise = share**power / middle ** (power - 1.0)
    else:
        rise = 1.0 - (1.0 - share) ** power / (1.0 - middle) ** (power - 1.0)
    impedance = least + rise * (most - least)
    return Stop(
        links, float(depth), away, impedance / (most * time * ratio) ** 2, 2.0 / (most * time),
        (1.0 - impedance) / impedance * inverse,
    )  # fmt: skip


def pushed_back(
    stops: Sequence[Stop], square: FloatArray, free: FloatArray, old: FloatArray, half: float
) -> FloatArray:
    """The velocity (j,) in the middle of a step with what pushes back.

    Args:
        stops: what does.
        square: what a force is divided by to get a velocity (j, j).
        free: the velocity without what pushes back (j,).
        old: velocity where the step begins (j,), with which depths were foreseen in its middle.
        half: of the step [s].
    """
    if not stops:
        return free
    rows = np.array([stop.away for stop in stops])
    depth, stiffness, damping, give = np.array(
        [(stop.depth, stop.stiffness, stop.damping, stop.give) for stop in stops]
    ).T
    response = np.linalg.solve(square, rows.T)
    # u' = (u - u_old) / half, and the depth is left by half (u - u_old).
    firm = 1.0 / half + damping + stiffness * half
    gain = firm[:, None] * (rows @ response) + np.diag(give)
    before = rows @ old
    wanted = stiffness * (depth + half * before) + before / half - firm * (rows @ free)
    return free + response @ complementary(gain, wanted)


def complementary(square: FloatArray, wanted: FloatArray) -> FloatArray:
    """The f >= 0 (r,) with A f >= b, and f = 0 where it is more: by principal pivoting.

    All rows on the wrong side change sides at once; if that goes round in circles, the first of
    them alone, which comes to an end (Murty 1974).
    """
    pushes, force = np.ones(len(wanted), dtype=bool), np.zeros(len(wanted))
    for turn in range(AT_ONCE + ONE_BY_ONE):
        force = np.zeros(len(wanted))
        own = np.flatnonzero(pushes)
        if len(own):
            force[own] = np.linalg.solve(square[np.ix_(own, own)], wanted[own])
        left = square @ force - wanted
        wrong = np.flatnonzero(np.where(pushes, force < 0.0, left < -SAME))
        if not len(wrong):
            break
        changed = wrong if turn < AT_ONCE else wrong[:1]
        pushes[changed] = ~pushes[changed]
    return np.maximum(force, 0.0)

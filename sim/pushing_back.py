"""What pushes back: the ends of joints, and what is leant on, as softly as in MuJoCo's model.

A limit or contact of depth r that gives way at the speed u makes a force f >= 0 with which

    u' = (1 - d) u'_0 + d (k r - b u),    b = 2 / (d T),    k = 1 / (d T)^2 / z^2,

u'_0 being the acceleration without it, and T, z, d the time constant, damping ratio and impedance
that the model gives (MuJoCo, "Solver parameters"). A contact rubs with at most its friction.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

SWEEPS = 4  # over what pushes back, each time with what the others make
SAME = 1e-9  # [m/rad] links that move alike


@dataclass(frozen=True)
class Stop:
    """One thing that pushes back, at one place."""

    links: tuple[str, str] | None  # that lean on each other; None for the end of a joint
    depth: float  # [m or rad]
    away: FloatArray  # (j,) how fast the joints lead out of it
    aside: FloatArray  # (a, j) how fast they lead along it
    friction: float
    time: float  # constant T [s]
    ratio: float  # of damping, z
    impedance: float  # d


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

    def _ends(self, data: mujoco.MjData) -> list[Stop]:
        model, found = self._body.model, []
        low, high = self._range
        angles = data.qpos[self._columns]
        for side, past in ((1.0, low - angles), (-1.0, angles - high)):
            for j in np.flatnonzero(past > 0.0):
                joint = model.dof_jntid[self._dofs[j]]
                away = np.zeros(len(angles))
                away[j] = side
                softness = model.jnt_solref[joint], model.jnt_solimp[joint]
                found.append(_stop(None, float(past[j]), away, away[:0], 0.0, *softness))
        return found

    def _contacts(self, data: mujoco.MjData) -> list[Stop]:
        model, found = self._body.model, []
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
            if np.abs(away).max() > SAME:
                links = model.body(one).name, model.body(other).name
                softness = contact.solref, contact.solimp
                found.append(
                    _stop(links, -float(contact.dist), away, np.array(aside),
                          float(contact.friction[0]), *softness)
                )  # fmt: skip
        return found


def _stop(
    links: tuple[str, str] | None,
    depth: float,
    away: FloatArray,
    aside: FloatArray,
    friction: float,
    solref: FloatArray,
    solimp: FloatArray,
) -> Stop:
    time, ratio = (float(v) for v in solref)
    return Stop(links, depth, away, aside.reshape(-1, len(away)), friction, time, ratio,
                float(solimp[1]))  # fmt: skip


def pushed_back(
    stops: Sequence[Stop], square: FloatArray, free: FloatArray, old: FloatArray, half: float
) -> FloatArray:
    """The velocity (j,) in the middle of a step with what pushes back.

    Args:
        stops: what does.
        square: S of the step without it, S v = ... (j, j).
        free: that velocity without it (j,).
        old: velocity where the step begins (j,), for which depths were foreseen in its middle.
        half: of the step [s].
    """
    if not stops:
        return free
    rows = np.vstack([np.vstack([stop.away, stop.aside]) for stop in stops])
    response = np.linalg.solve(square, rows.T)
    gain = rows @ response  # (r, r) velocity by force
    force, speed, before = np.zeros(len(rows)), rows @ free, rows @ old
    for _ in range(SWEEPS):
        i = 0
        for stop in stops:
            damping = 2.0 / (stop.impedance * stop.time)
            stiffness = 1.0 / (stop.impedance * stop.time * stop.ratio) ** 2
            least, most, spring = 0.0, np.inf, stiffness
            for row in range(i, i + 1 + len(stop.aside)):
                without = speed[row] + gain[row] @ force - gain[row, row] * force[row]
                gone = without - before[row]
                wanted = spring * (stop.depth - half * gone) - damping * without - gone / half
                firm = 1.0 / (stop.impedance * half) + damping + spring * half
                force[row] = min(max(wanted / (firm * gain[row, row]), least), most)
                if row == i:
                    most = stop.friction * force[i]
                    least, spring = -most, 0.0
            i += 1 + len(stop.aside)
    return free + response @ force

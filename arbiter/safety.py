"""The safety filter: the torque nearest to the one asked for that runs into no limit.

    min d . M^-1 d / 2 + |s|^2 / (2 rho)    so that    A d + s >= b,  |tau + d| <= limit,

d being the change of the torque, one row of A for each limit that is near (see `barriers`). That
norm makes d what a contact force would be. Only the limits that tau runs into are in the first
programme; those that its answer would run into are added, until there are none. Torque limits
hold always. Where the rest cannot all hold at once, what is missing, s, is spread so that the sum
of its squares is smallest; should the solver fail, all joints brake.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import daqp
import numpy as np
from numpy.typing import NDArray

from arbiter.barriers import JOINT, MOST_ROWS, NEAR, PACE
from arbiter.dynamics import lump_table
from arbiter.filtering import Filter, Filtering
from arbiter.screening import screen, settle
from primitives import AvoidCollisions
from primitives.compiled import Records
from primitives.mechanics import dof_table, link_table
from primitives.repulsion import PAIR
from primitives.table import FieldTable, TableBuilder
from sim import Body, State, inertias, pushed_apart

FloatArray = NDArray[np.float64]
SOFTNESS = 1e-6  # rho: what is missing costs so much more than torque that is changed
RESERVE = 0.5  # share of a motor's torque that braking is planned with
NO_LIMIT = 1000.0  # [N m] against which the torque of a motor without limit is measured
SOLVED = (1, 2)  # DAQP: optimal; optimal, with something missing


class SafetyFilter:
    """Changes torques in place so that no limit is passed.

    Args:
        body: whose joints have limits, and whose links must not touch.
        torque: the arbiter's torques (n, nv) [N m].
        touches: its rows of TOUCH (n, k).
        live: how many of its sub-tasks are on (n,).
        contribution: what made the torques (n, channels, nv), the last channel being for the
            change that the filter makes; or of length 0.
        backgrounds: how many channels are always on.
        shares: of simulations, one for each thread of the crew.
        crew: the threads, if there are several.
    """

    def __init__(
        self,
        body: Body,
        torque: FloatArray,
        touches: Records,
        live: NDArray[np.int32],
        contribution: FloatArray,
        backgrounds: int,
        shares: int = 1,
        crew: ThreadPoolExecutor | None = None,
    ) -> None:
        n, nv = torque.shape
        most = MOST_ROWS + 2 * nv
        self._torque, self._contribution, self._crew = torque, contribution, crew
        self._step, self._shares = body.timestep, shares
        joints, table = joint_table(body), guarded_links(body)
        self._count = np.zeros(n, dtype=np.int32)
        self._rows, self._cost = np.zeros((n, most, nv)), np.zeros((n, nv, nv))
        self._upper, self._lower = np.full((2, n, nv + most), 1e30)
        self._passive, self._before = np.zeros((2, n, nv))
        self._limit = np.where(joints["limit"] > 0.0, joints["limit"], 1.0)
        self._braking, self._linear = PACE * inertias(body).reflected, np.zeros(nv)
        self._sense = np.zeros(nv + most, dtype=np.int32)
        self._sense[nv:] = 8  # soft
        links, capsules = len(table.guarded), len(table.capsules)
        parts = Filtering(
            *(link_table(body), dof_table(body), lump_table(body), joints),
            *(table.guarded, table.pairs, brushing(body), table.capsules, touches, live),
            *(np.array([backgrounds]), contribution, torque),
            *(np.zeros((n, nv)), self._passive, np.zeros((n, nv)), self._before),
            *(np.full(n, -np.inf), np.zeros((n, most, NEAR)), np.zeros(n, dtype=np.int32)),
            *(self._rows, self._upper, self._lower, self._cost, self._count),
            np.linspace(0, n, shares + 1).astype(np.int64),
            np.zeros((shares, nv, nv)),
            np.zeros((shares, body.model.nbody, 10)),
            np.zeros((shares, nv, 18)),
            np.zeros((shares, nv)),
            np.zeros((shares, nv)),
            np.zeros((shares, links, 7)),
            np.zeros((shares, capsules, 7)),
        )
        self._filter = Filter(parts)
        self._bound: tuple[State, tuple[object, ...], tuple[object, ...]] | None = None
        self.changed = 0  # how many torques were changed so far

    def apply(self, state: State) -> None:
        """Change the torques that would run into something now."""
        if self._bound is None or self._bound[0] is not state:
            seen = (state.qpos, state.qvel, state.xpos, state.xmat, state.cdof, state.cvel)
            last = (state.subtree_com, state.qfrc_bias, self._filter)
            self._bound = (
                state,
                (self._step, state.time, *seen, *last),
                (*seen, state.subtree_com, self._filter),
            )
        _, arrays, also = self._bound
        found = screen(0, *arrays) if self._crew is None else self._screen(self._crew, arrays)
        if found:
            for i in np.flatnonzero(self._count):
                self._change(int(i), also)
            self.changed += found

    def _screen(self, crew: ThreadPoolExecutor, arrays: tuple[object, ...]) -> int:
        look: Callable[..., int] = screen
        jobs = [crew.submit(look, k, *arrays) for k in range(1, self._shares)]
        return look(0, *arrays) + sum(job.result() for job in jobs)

    def _change(self, i: int, arrays: tuple[object, ...]) -> None:
        """The small quadratic programme of one simulation; rows are added as they are needed."""
        count, nv = int(self._count[i]), len(self._linear)
        while count:
            whole = nv + count
            change, _, flag, _ = daqp.solve(
                self._cost[i], self._linear, self._rows[i, :count], self._upper[i, :whole],
                self._lower[i, :whole], self._sense[:whole], rho_soft=SOFTNESS,
            )  # fmt: skip
            solved = flag in SOLVED
            if not solved:
                brake = -self._passive[i] - self._braking * self._before[i]
                change = (brake - self._torque[i]) / self._limit
            count = settle(i, change, solved, *arrays)


def joint_table(body: Body) -> Records:
    """Per degree of freedom: its limits, and what its motor can brake with."""
    found, joints = inertias(body), np.zeros(body.nv, dtype=JOINT)
    joints["armature"], joints["damping"] = found.armature, found.damping
    joints["low"], joints["high"] = body.range
    joints["speed"] = body.speed_limit
    joints["limit"] = np.where(np.isfinite(body.torque_limit), body.torque_limit, NO_LIMIT)
    joints["braking"] = RESERVE * joints["limit"] / found.reflected
    return joints


def guarded_links(body: Body) -> FieldTable:
    """The links that must not touch: a table that holds avoid-collisions and nothing else.

    Raises:
        BodyError: one of them is drawn with something else than spheres and capsules.
        PrimitiveError: one of them has no geom that collides.
    """
    builder: Any = TableBuilder(body.nv)
    if pushed_apart(body):
        AvoidCollisions().bind(body, np.inf).add_to(builder)
    return builder.build()  # type: ignore[no-any-return]


def brushing(body: Body) -> Records:
    """Capsules of the links that must not touch something, which may touch each other.

    They are those that the model names in a pair of its own: an arm may lie on the ribs. The
    impact of two such capsules could throw a joint past its end before any torque could help.

    Returns:
        Rows of PAIR, by their place in the table of capsules.
    """
    names = dict.fromkeys(name for pair in pushed_apart(body) for name in pair)
    geoms = [int(g) for g in body.capsules(names).geom]
    apart = {frozenset(body.link(name) for name in pair) for pair in pushed_apart(body)}
    model, found = body.model, []
    for pair in zip(model.pair_geom1, model.pair_geom2, strict=True):
        links = frozenset(int(model.geom_bodyid[g]) for g in pair)
        if links not in apart and all(g in geoms for g in pair):
            found.append(tuple(geoms.index(int(g)) for g in pair))
    return np.array(sorted(found, key=lambda pair: pair[1]), dtype=PAIR)

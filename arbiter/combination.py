"""Groups: from the torques of members to one torque, by the rule of each group.

    sum         tau_j = sum_i c_ij
    weighted    tau_j = sum_i g_i c_ij / max(1, sum_i g_i a_ij)
    dominant    tau_j = sum_i d_i c_ij,  d_i goes to 1 for the largest g_i a_i, to 0 for others
    null-space  tau   = sum_i N_i^T c_i, see `priorities`

c_i = a_i phi_i is what member i asks for, a_i its activation, g_i its weight. Every rule is
linear in its members, so what each of them contributes in the end is known, and adds up to the
torque.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arbiter.combining import GROUP, INERT, RULES, combine
from arbiter.dynamics import lump_table
from arbiter.errors import ArbiterError
from arbiter.mixing import Mix, Mixing
from arbiter.run import Parts
from primitives import Field
from primitives.compiled import Records
from primitives.compiled_field import CompiledField
from primitives.goal_field import most_rows
from sim import State, inertias
from specs import BoundTask
from specs.blame import told
from specs.groups import leaves

FloatArray = NDArray[np.float64]


class Combination:
    """The groups of a task in n simulations.

    Args:
        task: a bound task with groups.
        names: of the background and the sub-tasks, in the arbiter's order.
        run: what the arbiter works on; contribution and torque are combined in place.
        crew: threads, one for each of the run's shares, if there are several.
    """

    def __init__(
        self, task: BoundTask, names: Sequence[str], run: Parts, crew: ThreadPoolExecutor | None
    ) -> None:
        body, spec = task.body, task.spec
        n, shares = len(run.live), len(run.shares) - 1
        number = {name: f for f, name in enumerate(names)}
        groups = np.zeros(len(spec.groups), dtype=GROUP)
        belongs = np.full((len(groups), len(run.fields)), -1, dtype=np.int32)
        gains: list[float] = []
        ranked: set[str] = set()  # whose Jacobians are needed
        for g, group in enumerate(spec.groups):
            groups[g] = RULES.index(group.rule), len(gains), len(group.members)
            for k, member in enumerate(group.members):
                gains.append(group.weights.get(member, 1.0))
                own = leaves(member, spec.groups)
                belongs[g, [number[leaf] for leaf in own]] = k
                if group.rule == "null-space" and k < len(group.members) - 1:
                    ranked.update(own)
        fields = (*task.background, *task.fields)
        self._names, self._crew, self._shares = names, crew, shares
        self._plain: list[tuple[int, int, Field]] = [
            (number[name], int(run.fields[number[name]]["row"]), fields[number[name]])
            for name in sorted(ranked, key=number.__getitem__)
            if not isinstance(fields[number[name]], CompiledField)
        ]
        joints, found = np.zeros(body.nv, dtype=INERT), inertias(body)
        joints["armature"], joints["damping"] = found.armature, found.damping
        most = run.contribution.shape[1] * body.nv if ranked else 0
        plain = run.plain.shape[1] if self._plain else 0
        self._mixing = Mixing(
            *(run.links, run.dofs, lump_table(body), joints, run.fields, run.claims, run.reaches),
            *(groups, np.array(gains), belongs),
            run.claims | ~run.claims.any(axis=1, keepdims=True),
            np.array([max(spec.hand_over, body.timestep)]),
            np.array([len(run.gives_way)]),
            *(run.slots, run.live, run.contribution, run.activation, run.torque),
            *(np.zeros((n, len(gains))), np.full(n, -np.inf)),
            np.zeros((n, plain, most_rows(body.nv), body.nv)),
            np.zeros(plain, dtype=np.int32),
            run.shares,
            np.zeros((shares, body.nv, body.nv)),
            np.zeros((shares, body.model.nbody, 10)),
            np.zeros((shares, int(groups["members"].max()), body.nv)),
            np.zeros((shares, most_rows(body.nv), body.nv)),
            *(np.zeros((shares, most, body.nv)), np.zeros((shares, most, body.nv))),
            np.zeros((shares, most)),
        )
        self._mix = Mix(self._mixing)
        self._bound: tuple[State, tuple[object, ...]] | None = None

    def reset(self, rows: slice | list[int]) -> None:
        """Forget who was dominant, in some simulations."""
        self._mixing.dominance[rows] = 0.0
        self._mixing.clock[rows] = -np.inf

    def apply(self, state: State) -> None:
        """Combine what was asked for, in place; the torque is kept within the motors' limits.

        Raises:
            ArbiterError: a field in plain Python fails to say its Jacobian.
        """
        for number, row, field in self._plain:
            self._ask(state, number, row, field)
        if self._bound is None or self._bound[0] is not state:
            seen = (state.time, state.qpos, state.qvel, state.xpos, state.xmat)
            also = (state.cdof, state.cvel, state.subtree_com, self._mix)
            self._bound = state, (*seen, *also)
        run: Callable[..., None] = combine
        arrays, crew = self._bound[1], self._crew
        jobs = [crew.submit(run, k, *arrays) for k in range(1, self._shares)] if crew else []
        run(0, *arrays)
        for job in jobs:
            job.result()

    def _ask(self, state: State, number: int, row: int, field: Any) -> None:
        """The Jacobian of a field in plain Python."""
        given: Records = self._mixing.given
        n, _, most, nv = given.shape
        try:
            made = np.asarray(field.jacobian(state), dtype=np.float64)
        except (Exception, SystemExit) as problem:  # whatever the user's own code raises
            who = self._names[number]
            raise ArbiterError(f"the jacobian of {who!r} raised {told(problem)}") from problem
        if made.ndim != 3 or made.shape[::2] != (n, nv) or not made.shape[1] <= most:
            raise ArbiterError(
                f"the jacobian of {self._names[number]!r} is of shape {made.shape}; expected"
                f" ({n}, rows, {nv}), at most {most} rows"
            )
        self._mixing.given_rows[row] = made.shape[1]
        given[:, row, : made.shape[1]] = made


__all__ = ["Combination"]

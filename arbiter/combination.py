"""Groups: from the torques of members to one torque, by the rule of each group.

    sum         tau_j = sum_i c_ij
    weighted    tau_j = sum_i g_i c_ij / max(1, sum_i g_i a_ij)
    dominant    tau_j = sum_i d_i c_ij,  d_i goes to 1 for the largest g_i a_i, to 0 for others
    null-space  tau   = sum_i N_i^T c_i

c_i = a_i phi_i is what member i asks for, a_i its activation, g_i its weight. N_i is the
dynamically consistent null space of everything above i (Khatib 1987; Sentis & Khatib 2005),

    N_1 = 1,   N_{i+1} = N_i (1 - s_i Jbar_i J_i N_i),   Jbar_i = M^-1 J'^T (J' M^-1 J'^T)^+,

with J' = J_i N_i and s_i = max_j a_ij, so that a lower member comes in smoothly while a higher
one is handed over. Every rule is linear in its members, so what each of them contributes in
the end is known, and adds up to the torque.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arbiter.errors import ArbiterError
from primitives import Field
from primitives.profiles import step
from sim import Body, State, joint_inertia
from specs import BoundTask, Group

FloatArray = NDArray[np.float64]
SINGULAR = 1e-6  # directions in which a task moves less than this share are not held


@dataclass
class _Member:
    """What a member asks for at this moment."""

    parts: dict[int, FloatArray]  # number of a name -> torques (n, nv) [N m]
    activation: FloatArray  # (n, nv)
    fields: list[tuple[Field, FloatArray]]  # with goals, and their activations (n,)

    def scaled(self, factor: FloatArray) -> "_Member":
        """The same with torques multiplied, joint by joint (n, nv)."""
        return _Member({k: factor * c for k, c in self.parts.items()}, self.activation, self.fields)

    def projected(self, matrix: FloatArray) -> "_Member":
        """The same with torques multiplied by a matrix (n, nv, nv)."""
        parts = {k: np.einsum("nij,nj->ni", matrix, c) for k, c in self.parts.items()}
        return _Member(parts, self.activation, self.fields)


class Combination:
    """The groups of a task in n simulations.

    Args:
        task: a bound task with groups.
        names: of the background and the sub-tasks, in the arbiter's order.
        n: number of simulations.
    """

    def __init__(self, task: BoundTask, names: Sequence[str], n: int) -> None:
        self._body: Body = task.body
        self._groups: tuple[Group, ...] = task.spec.groups
        self._number = {name: k for k, name in enumerate(names)}
        self._fields = (*task.background, *task.fields)
        self._fade = max(task.spec.hand_over, task.body.timestep)
        self._dominance = {g.name: np.zeros((n, len(g.members))) for g in self._groups}
        self._time = np.full(n, -np.inf)
        self.needs_inertia = any(g.rule == "null-space" for g in self._groups)

    def reset(self, rows: slice | list[int]) -> None:
        """Forget who was dominant, in some simulations."""
        for kept in self._dominance.values():
            kept[rows] = 0.0
        self._time[rows] = -np.inf

    def apply(
        self,
        state: State,
        contribution: FloatArray,
        activation: FloatArray,
        channels: NDArray[np.int32],
        torque: FloatArray,
    ) -> None:
        """Combine, in place.

        Args:
            state: of n simulations.
            contribution: (n, channels, nv) asked for [N m]; what each contributes comes back.
            activation: (n, channels, nv)
            channels: (n, channels) number of the name that each is, -1 for nobody.
            torque: (n, nv) [N m] the combined torque comes back.

        Raises:
            ArbiterError: strict priorities need `state.M`, and this state has none.
        """
        inertia = None
        if self.needs_inertia:
            if state.M is None:
                raise ArbiterError("strict priorities need the inertia: World(…, inertia=True)")
            inertia = np.asarray(
                np.linalg.inv(joint_inertia(self._body, state.M)), dtype=np.float64
            )
        passed = np.where(np.isfinite(self._time), state.time - self._time, np.inf)
        self._time[:] = state.time
        known: dict[str, _Member] = {}
        for group in self._groups:
            members = [
                known.get(m) or self._leaf(m, contribution, activation, channels)
                for m in group.members
            ]
            known[group.name] = self._combined(group, members, state, inertia, passed)
        for member in known.values():
            for number, part in member.parts.items():
                rows, slots = np.nonzero(channels == number)
                contribution[rows, slots] = part[rows]
        np.sum(np.where(channels[..., None] >= 0, contribution, 0.0), axis=1, out=torque)

    def _leaf(
        self,
        name: str,
        contribution: FloatArray,
        activation: FloatArray,
        channels: NDArray[np.int32],
    ) -> _Member:
        number = self._number[name]
        parts, worth = np.zeros(contribution[:, 0].shape), np.zeros(contribution[:, 0].shape)
        rows, slots = np.nonzero(channels == number)
        parts[rows], worth[rows] = contribution[rows, slots], activation[rows, slots]
        field = self._fields[number]
        if len(field.claims):  # elsewhere it asks for nothing, and must not count
            mine = np.zeros(self._body.nv)
            mine[field.claims] = 1.0
            worth = worth * mine
        fields = [(field, worth.max(axis=1))] if hasattr(field, "jacobian") else []
        return _Member({number: parts}, worth, fields)

    def _combined(
        self,
        group: Group,
        members: list[_Member],
        state: State,
        inertia: FloatArray | None,
        passed: FloatArray,
    ) -> _Member:
        gains = np.array([group.weights.get(m, 1.0) for m in group.members])
        if group.rule == "weighted":
            total = sum(g * m.activation for g, m in zip(gains, members, strict=True))
            share = 1.0 / np.maximum(total, 1.0)
            members = [m.scaled(g * share) for g, m in zip(gains, members, strict=True)]
        elif group.rule == "dominant":
            strength = np.stack([m.activation.max(axis=1) for m in members], axis=1) * gains
            shares = self._dominate(self._dominance[group.name], strength, passed)
            members = [m.scaled(shares[:, k : k + 1]) for k, m in enumerate(members)]
        elif group.rule == "null-space":
            assert inertia is not None
            members = _prioritised(members, state, inertia)
        whole = {k: c for m in members for k, c in m.parts.items()}
        strongest = np.max([m.activation for m in members], axis=0)
        return _Member(whole, strongest, [f for m in members for f in m.fields])

    def _dominate(self, kept: FloatArray, strength: FloatArray, passed: FloatArray) -> FloatArray:
        """Let the strongest take over within the time of a hand-over; shares (n, members)."""
        n = np.arange(len(kept))
        best = strength.argmax(axis=1)  # of equals the one that is named first
        wanted = np.zeros(kept.shape)
        wanted[n, best] = strength[n, best] > 0.0
        pace = np.minimum(passed / self._fade, 1.0)[:, None]
        kept += np.clip(wanted - kept, -pace, pace)
        shares = np.vectorize(step, otypes=[float])(kept)
        total = shares.sum(axis=1, keepdims=True)
        scaled: FloatArray = shares / np.maximum(total, 1.0)
        return scaled


def _prioritised(members: list[_Member], state: State, inertia: FloatArray) -> list[_Member]:
    """Project each member into what those before it leave; `inertia` is M^-1 (n, nv, nv)."""
    n, nv = inertia.shape[:2]
    left = np.broadcast_to(np.eye(nv), (n, nv, nv)).copy()
    found = []
    for member in members:
        found.append(member.projected(left.transpose(0, 2, 1)))
        for field, worth in member.fields:
            jacobian = np.asarray(field.jacobian(state)) @ left  # type: ignore[attr-defined]
            moved = jacobian @ inertia @ jacobian.transpose(0, 2, 1)
            back = inertia @ jacobian.transpose(0, 2, 1) @ _pseudo_inverse(moved)
            left = left - worth[:, None, None] * (left @ back @ jacobian)
    return found


def _pseudo_inverse(matrices: FloatArray) -> FloatArray:
    """Of symmetric matrices (n, m, m); directions that hardly move are left out."""
    values, vectors = np.linalg.eigh(matrices)
    least = SINGULAR * np.maximum(values[:, -1:], 1e-12)
    inverse = np.where(values > least, 1.0 / np.where(values > least, values, 1.0), 0.0)
    whole: FloatArray = (vectors * inverse[:, None]) @ vectors.transpose(0, 2, 1)
    return whole


__all__ = ["Combination"]

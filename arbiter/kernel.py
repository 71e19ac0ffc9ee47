"""One control step of many simulations, compiled: walk, fields, hand-over, combination."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from arbiter.hand_over import hand_over, share_left
from arbiter.rules import sum_torques
from arbiter.walk import begin_subtask, walk
from primitives.compiled import Records, compiled, compiled_entry, fingerprint
from primitives.mechanics import Row
from primitives.table import MOST_KNOTS, PLAIN, FieldTable, add_torque, begin_field, touch_of

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

WALK, ACT = 1, 2  # what a call is to do; both at once unless a field is plain Python


@compiled
def begin_task(
    now: float,
    x: Row,
    table: FieldTable,
    roots: IntArray,
    backgrounds: int,
    slots: Records,
    log: Records,
    memory: FloatArray,
) -> int:
    """The first step of a simulation: background and first sub-tasks begin; returns live slots.

    The last row of the memory is the arbiter's own: it keeps the time of this moment.
    """
    memory[-1, 0] = now
    for b in range(backgrounds):
        begin_field(table, b, x, memory[b])
    live = 0
    for r in range(roots.shape[0]):
        log[roots[r]].start = now
        live = begin_subtask(roots[r], x, table, backgrounds, slots, live, log, memory)
    return live


@compiled
def ask_fields(
    now: float,
    x: Row,
    table: FieldTable,
    nodes: Records,
    backgrounds: int,
    slots: Records,
    live: int,
    log: Records,
    memory: FloatArray,
    touches: Records,
    plain: FloatArray,
    scratch: FloatArray,
    out: FloatArray,
) -> None:
    """Torques of all fields that are on, unscaled, into the rows of `out`.

    Sub-tasks come first: a hand that is to touch a link tells the background, which then
    lets that pair be.
    """
    touching = 0
    for m in range(backgrounds + live - 1, -1, -1):
        out[m, :] = 0.0
        if m < backgrounds:
            f, since = m, now - memory[-1, 0]
        else:
            s = m - backgrounds
            f, since = backgrounds + slots[s].node, now - log[slots[s].node].start
            if touch_of(table, f, since, touches[touching]):
                touches[touching].share *= share_left(
                    s, now, nodes, table.claims, backgrounds, slots, live, log
                )
                touching += 1
        if table.fields[f].kind == PLAIN:
            out[m, :] = plain[table.fields[f].row]
        else:
            add_torque(table, f, x, memory[m], since, touches[:touching], scratch, out[m])


@compiled
def limit_torques(dofs: Records, torque: FloatArray) -> bool:
    """Hold torques within the motors' limits; returns whether all of them are finite."""
    finite = True
    for j in range(torque.shape[0]):
        finite = finite and np.isfinite(torque[j])
        torque[j] = min(max(torque[j], -dofs[j].limit), dofs[j].limit)
    return finite


def _make(code: str) -> Callable[..., int]:
    @compiled_entry
    def control(  # type: ignore[no-untyped-def]
        what, low, high,
        time, qpos, qvel, xpos, xmat, cdof, com,
        links, dofs,
        fields, claims, numbers, reaches, points, guards, pairs, capsules,
        gives_way, nodes, successors, roots,
        live, slots, log, memory, touches, plain, plain_error, contribution, torque,
    ):  # fmt: skip
        """Control simulations low to high; returns one whose torque is not finite, or -1.

        It takes arrays one by one because that is what costs least to call.
        """
        len(code)
        table = FieldTable(fields, claims, numbers, reaches, points, guards, pairs, capsules)
        backgrounds = gives_way.shape[0]
        scratch = np.empty((2, MOST_KNOTS))
        weight = np.empty(slots.shape[1])
        bad = -1
        for i in range(low, high):
            x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], com[i], links, dofs)
            if what & WALK:
                if live[i] < 0:
                    live[i] = begin_task(
                        time[i], x, table, roots, backgrounds, slots[i], log[i], memory[i]
                    )
                live[i] = walk(
                    time[i], x, table, nodes, successors, backgrounds,
                    slots[i], live[i], log[i], memory[i], plain_error[i],
                )  # fmt: skip
            if what & ACT:
                ask_fields(
                    time[i], x, table, nodes, backgrounds, slots[i], live[i], log[i], memory[i],
                    touches[i], plain[i], scratch, contribution[i],
                )  # fmt: skip
                hand_over(
                    time[i], nodes, claims, gives_way, slots[i], live[i], log[i],
                    contribution[i], weight,
                )  # fmt: skip
                sum_torques(contribution[i], backgrounds + live[i], torque[i])
                if not limit_torques(dofs, torque[i]):
                    bad = i
        return bad

    return control


control: Callable[..., int] = _make(fingerprint())

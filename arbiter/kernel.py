"""One control step of many simulations, compiled: walk, fields, hand-over, combination."""

# The compiled entry point takes arrays one by one, because that is what costs least to call.

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numpy as np

from arbiter.hand_over import hand_over, share_left
from arbiter.rules import sum_torques
from arbiter.walk import begin_subtask, walk
from primitives.mechanics import Row
from primitives.table import (
    MOST_KNOTS,
    PLAIN,
    FieldTable,
    add_torque,
    begin_field,
    touch_of,
)

WALK, ACT = 1, 2  # what a call is to do; both at once unless a field is plain Python


def _sources() -> str:
    """A fingerprint of all compiled code.

    Numba's cache on disk looks only at the file of the function that it caches. Captured by
    that function, this makes the cache notice a change of any other.
    """
    digest = hashlib.sha256()
    for folder in ("arbiter", "primitives"):
        for path in sorted((Path(__file__).parents[1] / folder).glob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _make(fingerprint: str) -> Callable[..., int]:
    @numba.njit(error_model="numpy", nogil=True, cache=True)
    def control(  # type: ignore[no-untyped-def]
        what, low, high,
        time, qpos, qvel, xpos, xmat, cdof, com,
        links, dofs,
        fields, claims, numbers, reaches, points, guards, pairs, capsules,
        gives_way, nodes, successors, roots,
        live, slots, log, memory, touches,
        plain, plain_error, contribution, torque,
    ):  # fmt: skip
        len(fingerprint)
        table = FieldTable(fields, claims, numbers, reaches, points, guards, pairs, capsules)
        backgrounds = gives_way.shape[0]
        scratch = np.empty((2, MOST_KNOTS))
        weight = np.empty(slots.shape[1])
        nv = torque.shape[1]
        bad = -1
        for i in range(low, high):
            x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], com[i], links, dofs)
            now = time[i]
            if what & WALK:
                if live[i] < 0:  # the first step of this simulation
                    live[i] = 0
                    for b in range(backgrounds):
                        begin_field(table, b, x, memory[i, b])
                    for r in range(roots.shape[0]):
                        log[i, roots[r]].start = now
                        live[i] = begin_subtask(
                            roots[r], x, table, backgrounds, slots[i], live[i], log[i], memory[i]
                        )
                    memory[i, -1, 0] = now
                live[i] = walk(
                    now, x, table, nodes, successors, backgrounds,
                    slots[i], live[i], log[i], memory[i], plain_error[i],
                )  # fmt: skip
            if not what & ACT:
                continue
            on = backgrounds + live[i]
            touching = 0
            # Sub-tasks first: those that touch tell the background which pairs to let be.
            for m in range(on - 1, -1, -1):
                out = contribution[i, m]
                out[:] = 0.0
                if m < backgrounds:
                    f, since = m, now - memory[i, -1, 0]
                else:
                    k = slots[i, m - backgrounds].node
                    f, since = backgrounds + k, now - log[i, k].start
                    if touch_of(table, f, since, touches[i, touching]):
                        touches[i, touching].share *= share_left(
                            m - backgrounds, now, nodes, claims, backgrounds,
                            slots[i], live[i], log[i],
                        )  # fmt: skip
                        touching += 1
                if fields[f].kind == PLAIN:
                    out[:] = plain[i, fields[f].row]
                else:
                    add_torque(
                        table, f, x, memory[i, m], since, touches[i, :touching], scratch, out
                    )
            hand_over(
                now, nodes, claims, gives_way, slots[i], live[i], log[i], contribution[i], weight
            )
            sum_torques(contribution[i], on, torque[i])
            for j in range(nv):
                limit = dofs[j].limit
                if not np.isfinite(torque[i, j]):
                    bad = i
                torque[i, j] = min(max(torque[i, j], -limit), limit)
        return bad

    made: Callable[..., int] = control
    return made


control: Callable[..., Any] = _make(_sources())

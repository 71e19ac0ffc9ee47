"""Hand-over: what each field on a joint is worth, while one sub-task takes over from another.

A sub-task that claims a joint lies over those that claimed it before, and those over the
background, as one sheet over another: the newest gets its weight w, the one below gets the
share w' of what is left, 1 - w, and so on down; the background gets what remains. w rises
from 0 to 1 along the step of Mataric et al. (1999), eq 5, and the weights on a joint always
add up to one, whatever interrupts what.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records, compiled

FloatArray = NDArray[np.float64]


@compiled
def step(s: float) -> float:
    """s - sin(2 pi s) / (2 pi) on [0, 1], 0 before, 1 after (Mataric et al. 1999, eq 5)."""
    if s <= 0.0:
        return 0.0
    if s >= 1.0:
        return 1.0
    return float(s - np.sin(2.0 * np.pi * s) / (2.0 * np.pi))


@compiled
def fade_in(elapsed: float, duration: float) -> float:
    """Weight after so much of a hand-over [s]; one that takes no time is over at once."""
    return step(elapsed / duration) if duration > 0.0 else 1.0


@compiled
def share_left(
    s: int,
    time: float,
    nodes: Records,
    claims: NDArray[np.bool_],
    backgrounds: int,
    slots: Records,
    live: int,
    log: Records,
) -> float:
    """What newer sub-tasks leave to slot s, on the first joint that it claims."""
    mine = claims[backgrounds + slots[s].node]
    joint = 0
    while joint < mine.shape[0] - 1 and not mine[joint]:
        joint += 1
    left = 1.0
    for newer in range(s + 1, live):
        k = slots[newer].node
        if claims[backgrounds + k, joint]:
            left *= 1.0 - fade_in(time - log[k].start, nodes[k].fade)
    return left


@compiled
def hand_over(
    time: float,
    nodes: Records,
    claims: NDArray[np.bool_],
    gives_way: NDArray[np.bool_],
    slots: Records,
    live: int,
    log: Records,
    contribution: FloatArray,
    weight: FloatArray,
) -> None:
    """Scale every field's torques by its weight on each joint, in place.

    Args:
        time: [s]
        nodes: rows of NODE.
        claims: (fields, nv): those of the background first.
        gives_way: (backgrounds,) whether it claims joints, which sub-tasks may take over.
        slots: rows of SLOT, the oldest first; `covered` is set where nothing is left.
        live: how many of them are in use.
        log: rows of LOG.
        contribution: (backgrounds + slots, nv) [N m]
        weight: (slots,) to work in.
    """
    backgrounds = gives_way.shape[0]
    nv = contribution.shape[1]
    for s in range(live):
        k = slots[s].node
        weight[s] = fade_in(time - log[k].start, nodes[k].fade)
        slots[s].covered = True
        if not nodes[k].claims:  # it only adds: on while it runs, then it fades away
            if slots[s].over:
                weight[s] *= 1.0 - fade_in(time - log[k].end, nodes[k].fade)
            slots[s].covered = weight[s] == 0.0 and slots[s].over
            for j in range(nv):
                contribution[backgrounds + s, j] *= weight[s]
    for j in range(nv):
        left = 1.0
        for s in range(live - 1, -1, -1):
            k = slots[s].node
            if not nodes[k].claims:
                continue
            if claims[backgrounds + k, j]:
                contribution[backgrounds + s, j] *= left * weight[s]
                if left > 0.0:
                    slots[s].covered = False
                left *= 1.0 - weight[s]
            else:
                contribution[backgrounds + s, j] = 0.0
        for b in range(backgrounds):
            if gives_way[b]:
                contribution[b, j] *= left if claims[b, j] else 0.0

"""Hand-over: what each field on a joint is worth, while one sub-task takes over from another.

A sub-task that claims a joint lies over those that claimed it before, and those over the
background, as one sheet over another: the newest gets its weight w, the one below gets the
share w' of what is left, 1 - w, and so on down; the background gets what remains. w rises
from 0 to 1 along the step of Mataric et al. (1999), eq 5, and the weights on a joint always
add up to one, whatever interrupts what. One that is cut short is released: its w falls to 0
along the same step, and what lies below comes out again.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Records, compiled
from primitives.profiles import step

FloatArray = NDArray[np.float64]


@compiled
def fade_in(elapsed: float, duration: float) -> float:
    """Weight after so much of a hand-over [s]; one that takes no time is over at once."""
    return step(elapsed / duration) if duration > 0.0 else 1.0


@compiled
def weigh_fields(
    time: float,
    nodes: Records,
    claims: NDArray[np.bool_],
    gives_way: NDArray[np.bool_],
    slots: Records,
    live: int,
    weight: FloatArray,
) -> None:
    """What the fields that are on are worth on each joint.

    Args:
        time: [s]
        nodes: rows of NODE.
        claims: (fields, nv): those of the background first.
        gives_way: (backgrounds,) whether it claims joints, which sub-tasks may take over.
        slots: rows of SLOT, the oldest first; `covered` is set where nothing is left.
        live: how many of them are in use.
        weight: (backgrounds + slots, nv) out: of the background, then of the slots.
    """
    backgrounds = gives_way.shape[0]
    nv = weight.shape[1]
    left = weight[-1]  # a row of room: what is left of each joint
    for j in range(nv):
        left[j] = 1.0
    for s in range(live - 1, -1, -1):
        k, row = slots[s].node, weight[backgrounds + s]
        share = fade_in(time - slots[s].start, nodes[k].fade)
        if nodes[k].claims:
            gone = False
            if slots[s].released:  # what lies below comes out again
                share *= 1.0 - fade_in(time - slots[s].end, nodes[k].fade)
                gone = share == 0.0
            slots[s].covered = not lay_over(share, claims[backgrounds + k], left, row) or gone
            continue
        if slots[s].over:  # it only adds: on while it runs, then it fades away
            share *= 1.0 - fade_in(time - slots[s].end, nodes[k].fade)
        slots[s].covered = share == 0.0
        for j in range(nv):
            row[j] = share
    for b in range(backgrounds):
        for j in range(nv):
            claimed = 1.0 if claims[b, j] else 0.0
            weight[b, j] = left[j] * claimed if gives_way[b] else 1.0


@compiled
def lay_over(share: float, claims: NDArray[np.bool_], left: FloatArray, weight: FloatArray) -> bool:
    """Give a sub-task its share of what is left of the joints (nv,) that it claims.

    Returns whether anything was left for it on any of them.
    """
    found = False
    for j in range(weight.shape[0]):
        weight[j] = 0.0
        if claims[j]:
            weight[j] = share * left[j]
            found = found or left[j] > 0.0
            left[j] *= 1.0 - share
    return found

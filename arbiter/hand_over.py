"""Hand-over: what each field on a joint is worth, while one sub-task takes over from another.

A sub-task that claims a joint lies over those that claimed it before, and those over the
background, as one sheet over another: the newest gets its weight w, the one below gets the
share w' of what is left, 1 - w, and so on down; the background gets what remains. w rises
from 0 to 1 along the step of Mataric et al. (1999), eq 5, and the weights on a joint always
add up to one, whatever interrupts what. One that is cut short is released: its w falls to 0
along the same step, and what lies below comes out again. Those that a group puts side by side do
not cover each other: each gets its weight of what all others above it leave.
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
    others: NDArray[np.int32],
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
        others: what their numbers stand for.
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
        slots[s].share = 0.0
        if nodes[k].claims:
            gone = False
            if slots[s].released:  # what lies below comes out again
                share *= 1.0 - fade_in(time - slots[s].end, nodes[k].fade)
                gone = share == 0.0
            slots[s].share = share
            room = left
            if nodes[k].mates:
                beside(nodes, others, slots, s, live, claims[backgrounds:], row)
                room = row
            slots[s].covered = not lay_over(share, claims[backgrounds + k], room, left, row) or gone
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
def lay_over(
    share: float,
    claims: NDArray[np.bool_],
    room: FloatArray,
    left: FloatArray,
    weight: FloatArray,
) -> bool:
    """Give a sub-task its share of the room on the joints (nv,) that it claims.

    What is left of them for those below becomes less. Returns whether there was any room.
    """
    found = False
    for j in range(weight.shape[0]):
        if claims[j]:
            found = found or room[j] > 0.0
            weight[j] = share * room[j]
            left[j] *= 1.0 - share
        else:
            weight[j] = 0.0
    return found


@compiled
def beside(
    nodes: Records,
    others: NDArray[np.int32],
    slots: Records,
    s: int,
    live: int,
    claims: NDArray[np.bool_],
    room: FloatArray,
) -> None:
    """room (nv,) = what those above slot s leave of each joint, but for those in its group."""
    node = nodes[slots[s].node]
    for j in range(room.shape[0]):
        room[j] = 1.0
    for above in range(s + 1, live):
        mate = False
        for m in range(node.mate, node.mate + node.mates):
            mate = mate or others[m] == slots[above].node
        for j in range(0 if mate else room.shape[0]):
            if claims[slots[above].node, j]:
                room[j] *= 1.0 - slots[above].share

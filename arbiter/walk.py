"""Walking the task graph: which sub-tasks are on, in one simulation, inside compiled code."""

import numpy as np
from numpy.typing import NDArray

from arbiter.plan import DONE, PENDING, RUNNING, TIMED_OUT
from primitives.compiled import Records, compiled
from primitives.mechanics import Row
from primitives.table import PLAIN, FieldTable, begin_field, field_error

FloatArray = NDArray[np.float64]

EARLY = 1e-9  # [s] rounding of sums of time steps


@compiled
def begin_subtask(
    k: int,
    x: Row,
    table: FieldTable,
    backgrounds: int,
    slots: Records,
    live: int,
    log: Records,
    memory: FloatArray,
) -> int:
    """Switch sub-task k on, in the next free slot; returns the new number of live slots."""
    slots[live].node = k
    slots[live].over = False
    slots[live].covered = False
    log[k].outcome = RUNNING
    log[k].on = True
    begin_field(table, backgrounds + k, x, memory[backgrounds + live])
    return live + 1


@compiled
def drop_covered(
    slots: Records,
    live: int,
    log: Records,
    memory: FloatArray,
    backgrounds: int,
) -> int:
    """Free the slots whose every joint another sub-task has taken over; the rest keep order."""
    kept = 0
    for s in range(live):
        if slots[s].covered and slots[s].over:
            log[slots[s].node].on = False
            continue
        if kept != s:
            slots[kept].node = slots[s].node
            slots[kept].over = slots[s].over
            slots[kept].covered = slots[s].covered
            for n in range(memory.shape[1]):
                memory[backgrounds + kept, n] = memory[backgrounds + s, n]
        kept += 1
    return kept


@compiled
def walk(
    time: float,
    x: Row,
    table: FieldTable,
    nodes: Records,
    successors: NDArray[np.int32],
    backgrounds: int,
    slots: Records,
    live: int,
    log: Records,
    memory: FloatArray,
    plain_error: FloatArray,
) -> int:
    """Finish what is over, begin what waited for it; returns the number of live slots.

    A sub-task that ends on time hands its exact end on as the start of the next, so that the
    beat does not drift with the time step.
    """
    live = drop_covered(slots, live, log, memory, backgrounds)
    s = 0
    while s < live:
        k = slots[s].node
        if not slots[s].over:
            node = nodes[k]
            end = log[k].start + node.duration
            outcome = PENDING
            if time >= end - EARLY:
                if node.tolerance == 0.0:
                    outcome = DONE
                else:
                    field = table.fields[backgrounds + k]
                    if field.kind == PLAIN:
                        error = plain_error[field.row]
                    else:
                        error = field_error(table, backgrounds + k, x, memory[backgrounds + s])
                    end = time
                    if error <= node.tolerance:
                        outcome = DONE
                    elif time >= log[k].start + node.timeout - EARLY:
                        outcome = TIMED_OUT
            if outcome != PENDING:
                slots[s].over = True
                log[k].outcome = outcome
                log[k].end = end
                for m in range(node.successors, node.successors + node.count):
                    after = successors[m]
                    log[after].start = max(log[after].start, end)
                    log[after].waits -= 1
                    if log[after].waits == 0:
                        live = begin_subtask(after, x, table, backgrounds, slots, live, log, memory)
        s += 1
    return live

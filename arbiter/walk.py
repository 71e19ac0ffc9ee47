"""Walking the task graph: which sub-tasks are on, in one simulation, inside compiled code.

Those that are to begin, and those that are over, stand in a queue: the second kind calls its
successors. One that cannot be (its branch was not taken, or it was ended) passes that on, so
that whatever comes after several branches knows which of them to wait for.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arbiter.plan import (
    ALL,
    DONE,
    ENDED,
    FIRST,
    GO_ON,
    NO_WAY,
    OTHER_WAY,
    PENDING,
    RUNNING,
    SKIPPED,
    TIMED_OUT,
)
from primitives.compiled import Record, Records, compiled
from primitives.mechanics import Row, dot, subtract, to_world, vector
from primitives.table import PLAIN, FieldTable, begin_field, field_error

FloatArray = NDArray[np.float64]

EARLY = 1e-9  # [s] rounding of sums of time steps


class Course(NamedTuple):
    """What a walk works on: the graph, and how far one simulation has come in it."""

    nodes: Records  # NODE
    others: NDArray[np.int32]
    conditions: Records  # CONDITION
    backgrounds: int
    slots: Records  # SLOT
    log: Records  # LOG
    memory: FloatArray
    plain_error: FloatArray
    events: FloatArray  # when each was sent last [s]
    course: Record  # COURSE
    rounds: Records  # ROUND


@compiled
def holds(c: Course, condition: int, since: float, x: Row) -> bool:
    """Whether a condition holds now; an event must have been sent after a time."""
    wanted = c.conditions[condition]
    if wanted.event >= 0:
        return bool(c.events[wanted.event] > since)
    palm = to_world(x, wanted.hand, vector(wanted.palm))
    gap = subtract(palm, to_world(x, wanted.link, vector(wanted.landmark)))
    return bool(dot(gap, gap) <= wanted.distance * wanted.distance)


@compiled
def queue_up(c: Course, k: int) -> None:
    """Put sub-task k at the end of the queue, unless it stands there."""
    if c.log[k].queued:
        return
    c.log[k].queued = True
    c.log[k].next = -1
    if c.course.head < 0:
        c.course.head = k
    else:
        c.log[c.course.tail].next = k
    c.course.tail = k


@compiled
def settle(c: Course, k: int, outcome: int, way: int, end: float) -> None:
    """Sub-task k is over, or will not be."""
    c.log[k].outcome = outcome
    c.log[k].way = way
    c.log[k].end = end
    c.log[k].end_lag = c.course.lag
    queue_up(c, k)


@compiled
def release(c: Course, s: int, end: float) -> None:
    """Let what is in slot s fade away, unless it does already."""
    slot = c.slots[s]
    if not slot.released and (not slot.over or c.nodes[slot.node].claims):
        slot.over = True
        slot.released = True
        slot.end = end


@compiled
def cut_short(c: Course, k: int, outcome: int, way: int, end: float, live: int) -> None:
    """End sub-task k, if it is on, and let its joints go; if it has not begun, it never will."""
    if c.log[k].outcome > RUNNING:
        return
    for s in range(live):
        if c.slots[s].node == k:
            release(c, s, end)
    began = c.log[k].outcome == RUNNING or c.log[k].rounds > 0
    settle(c, k, outcome if began else SKIPPED, way, end)


@compiled
def call(c: Course, k: int, leads: bool, end: float) -> None:
    """A predecessor of sub-task k is over; `leads` says whether the way from it leads here."""
    row = c.log[k]
    if row.outcome != PENDING or row.waits <= 0:
        return
    row.waits -= 1
    row.start = max(row.start, end)
    row.called = row.called or leads
    if leads and c.nodes[k].join != ALL:
        row.waits = 0
    if row.waits == 0:
        if row.called:
            queue_up(c, k)
        else:
            settle(c, k, SKIPPED, NO_WAY, row.start)


@compiled
def begin_subtask(c: Course, k: int, x: Row, table: FieldTable, live: int) -> int:
    """Switch sub-task k on, in the next free slot; returns the new number of live slots."""
    slot = c.slots[live]
    slot.node = k
    slot.start = c.log[k].start
    slot.over = False
    slot.covered = False
    slot.released = False
    c.log[k].outcome = RUNNING
    c.log[k].start_lag = c.course.lag
    if c.log[k].rounds == 0:
        c.log[k].began = c.log[k].start + c.course.lag
    c.log[k].on += 1
    c.log[k].fresh = True
    begin_field(table, c.backgrounds + k, x, c.memory[c.backgrounds + live])
    return live + 1


@compiled
def drop_covered(c: Course, live: int) -> int:
    """Free the slots whose every joint another sub-task has taken over; the rest keep order."""
    kept = 0
    slots, memory = c.slots, c.memory
    for s in range(live):
        if slots[s].covered and slots[s].over:
            c.log[slots[s].node].on -= 1
            continue
        if kept != s:
            slots[kept].node = slots[s].node
            slots[kept].start = slots[s].start
            slots[kept].end = slots[s].end
            slots[kept].over = slots[s].over
            slots[kept].covered = slots[s].covered
            slots[kept].released = slots[s].released
            for n in range(memory.shape[1]):
                memory[c.backgrounds + kept, n] = memory[c.backgrounds + s, n]
        kept += 1
    return kept


@compiled
def skips(time: float, x: Row, c: Course, k: int, live: int) -> bool:
    """Whether sub-task k, whose turn it is, is left out; `first` ends the others in any case."""
    node, row = c.nodes[k], c.log[k]
    if row.rounds > 0 and node.links == 0:
        return False
    if node.join == FIRST:
        for m in range(node.ended, node.ended + node.ends):
            cut_short(c, c.others[m], ENDED, NO_WAY, time, live)
    if node.given < 0 or holds(c, node.given, -np.inf, x):
        return False
    row.outcome = SKIPPED
    row.end = row.start
    row.way = OTHER_WAY if node.otherwise >= 0 else GO_ON
    return True


@compiled
def pass_on(c: Course, k: int, live: int) -> None:
    """Tell those around sub-task k that it runs now, or that it is settled."""
    node, row = c.nodes[k], c.log[k]
    outcome, way = (ENDED, NO_WAY) if row.way == NO_WAY else (DONE, GO_ON)
    for m in range(node.company, node.company + node.companions):
        other = c.others[m]
        if row.outcome != RUNNING:
            cut_short(c, other, outcome, way, row.end, live)
        elif c.log[other].outcome == PENDING:
            c.log[other].start = row.start
            queue_up(c, other)
    if row.outcome == RUNNING:
        return
    for m in range(node.successors, node.successors + node.count):
        call(c, c.others[m], row.way == GO_ON, row.end)
    if node.otherwise >= 0:
        call(c, node.otherwise, row.way == OTHER_WAY, row.end)


@compiled
def serve(time: float, x: Row, table: FieldTable, c: Course, live: int) -> int:
    """Empty the queue; returns the new number of live slots.

    Who finds no room stays at the head until there is some.
    """
    while c.course.head >= 0:
        k = c.course.head
        if c.log[k].outcome == PENDING and not skips(time, x, c, k, live):
            if live == c.slots.shape[0]:
                return live
            live = begin_subtask(c, k, x, table, live)
        c.course.head = c.log[k].next
        c.log[k].queued = False
        pass_on(c, k, live)
    return live


@compiled
def came_of(time: float, x: Row, table: FieldTable, c: Course, s: int, start: float) -> int:
    """What has become of the sub-task in slot s, begun at `start`; PENDING if it goes on."""
    k = c.slots[s].node
    node = c.nodes[k]
    if node.done >= 0:  # not before its hand-over is through
        if time < start + node.fade - EARLY:
            return PENDING
        good = holds(c, node.done, start, x)
    else:
        if time < start + node.duration - EARLY:
            return PENDING
        if node.tolerance == 0.0:
            return DONE
        field = table.fields[c.backgrounds + k]
        if field.kind == PLAIN:
            error = c.plain_error[field.row]
        else:
            error = field_error(table, c.backgrounds + k, x, c.memory[c.backgrounds + s])
        good = error <= node.tolerance
    if good:
        return DONE
    return TIMED_OUT if time >= start + node.timeout - EARLY else PENDING


@compiled
def keep_round(c: Course, k: int) -> None:
    """Take down what sub-task k did, before it is done over."""
    row, room = c.log[k], c.rounds.shape[0]
    if not room or row.outcome in (PENDING, SKIPPED):
        return
    kept = c.rounds[c.course.rounds % room]
    kept.node, kept.outcome = k, row.outcome
    kept.start, kept.end = row.start + row.start_lag, row.end + row.end_lag
    c.course.rounds += 1


@compiled
def do_over(c: Course, k: int, end: float, live: int) -> bool:
    """Let a new round of sub-task k begin, with all that is repeated with it; end what still runs.

    Returns whether it could: not while one of them still stands in the queue.
    """
    node, log = c.nodes[k], c.log
    chained = c.others[node.chain : node.chain + node.links]
    for m in chained:
        if log[m].queued:
            return False
    log[k].outcome, log[k].end, log[k].end_lag = DONE, end, c.course.lag
    log[k].rounds += 1
    if not node.links:
        keep_round(c, k)
    for m in chained:
        if m != k and log[m].outcome == RUNNING:  # beside others, or not waited for
            for s in range(live):
                if c.slots[s].node == m and not c.slots[s].over:
                    release(c, s, end)
            log[m].outcome, log[m].end = DONE if c.nodes[m].beside else ENDED, end
            log[m].end_lag = c.course.lag
        keep_round(c, m)
        log[m].outcome, log[m].way, log[m].called = PENDING, GO_ON, False
        log[m].waits, log[m].start = c.nodes[m].waits, end
        if m != k:
            log[m].rounds = 0
    log[k].outcome, log[k].start = PENDING, end
    queue_up(c, node.again)
    return True


@compiled
def check(time: float, x: Row, table: FieldTable, c: Course, s: int, live: int) -> None:
    """See whether the sub-task in slot s is over.

    One that ends on time hands its exact end on as the start of the next, so that the beat
    does not drift with the time step.
    """
    k = c.slots[s].node
    node = c.nodes[k]
    if node.beside:  # it is over when another is
        return
    start = c.slots[s].start
    outcome = came_of(time, x, table, c, s, start)
    if outcome == PENDING:
        return
    on_time = node.done < 0 and node.tolerance == 0.0
    end = start + node.duration if on_time else time
    if outcome == DONE and (node.until < 0 or not holds(c, node.until, c.log[node.again].start, x)):
        if c.log[k].rounds + 1 < node.times:
            if do_over(c, k, end, live):
                c.slots[s].over = True
                c.slots[s].end = end
            return
        if node.until >= 0:
            outcome = TIMED_OUT
    c.slots[s].over = True
    c.slots[s].end = end
    gave_up = outcome == TIMED_OUT and node.otherwise >= 0
    settle(c, k, outcome, OTHER_WAY if gave_up else GO_ON, end)


@compiled
def let_go(time: float, c: Course, live: int) -> None:
    """End whatever runs, skip whatever has not begun, and release what is held."""
    for s in range(live):
        release(c, s, time)
    for k in range(c.log.shape[0]):
        row = c.log[k]
        row.queued = False
        if row.outcome < DONE:
            row.outcome = ENDED if row.outcome == RUNNING or row.rounds > 0 else SKIPPED
            row.end = time
            row.end_lag = c.course.lag
    c.course.head = -1


@compiled
def walk(time: float, x: Row, table: FieldTable, c: Course, live: int) -> int:
    """Finish what is over, begin what waited for it; returns the number of live slots."""
    for e in range(c.events.shape[0]):
        if c.events[e] == np.inf:  # sent since the last step
            c.events[e] = time
    live = drop_covered(c, live)
    if c.course.stop:
        c.course.stop = False
        let_go(time, c, live)
    s = 0
    while True:
        live = serve(time, x, table, c, live)
        while s < live and c.slots[s].over:
            s += 1
        if s == live:
            return live
        check(time, x, table, c, s, live)
        s += 1

"""One control step of many simulations, compiled: walk, fields, hand-over, combination."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from arbiter.hand_over import weigh_fields
from arbiter.rules import limit_torques, sum_torques
from arbiter.run import Parts
from arbiter.walk import Course, queue_up, walk
from primitives.compiled import Record, Records, compiled, compiled_entry, fingerprint
from primitives.mechanics import Row
from primitives.table import (
    PLAIN,
    FieldTable,
    Scratch,
    add_torque,
    begin_field,
    touch_of,
)

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

WALK, ACT = 1, 2  # what a call is to do; both at once unless a field is plain Python


@compiled
def begin_task(now: float, x: Row, table: FieldTable, roots: IntArray, c: Course) -> None:
    """The first step of a simulation: the background begins, the first sub-tasks may.

    The last row of the memory is the arbiter's own: it keeps the time of this moment.
    """
    c.memory[-1, 0] = now
    for b in range(c.backgrounds):
        begin_field(table, b, x, c.memory[b])
    for r in range(roots.shape[0]):
        c.log[roots[r]].start = now
        queue_up(c, roots[r])


@compiled
def keep_time(time: float, ease: float, course: Record) -> None:
    """Move the task's clock on: in a pause it comes to rest softly, then it lags behind."""
    if course.pace != 1.0 or course.wanted != 1.0:
        passed = time - course.last
        change = passed / ease if ease > 0.0 else 1.0
        course.pace += min(max(course.wanted - course.pace, -change), change)
        course.lag += (1.0 - course.pace) * passed
    course.last = time


@compiled
def ask_fields(
    now: float,
    x: Row,
    table: FieldTable,
    backgrounds: int,
    slots: Records,
    live: int,
    pace: float,
    memory: FloatArray,
    weight: FloatArray,
    touches: Records,
    plain: FloatArray,
    scratch: Scratch,
    out: FloatArray,
) -> None:
    """Torques of the fields that are on, scaled by their weights, into the rows of `out`.

    Sub-tasks come first: a hand that is to touch a link tells the background, which then
    lets that pair be. Fields that are worth nothing are not asked.
    """
    touching = 0
    nv = out.shape[1]
    for m in range(backgrounds + live - 1, -1, -1):
        worth = 0.0
        for j in range(nv):
            worth = max(worth, weight[m, j])
            out[m, j] = 0.0
        if worth == 0.0:
            continue
        if m < backgrounds:
            f, since = m, now - memory[-1, 0]
        else:
            k = slots[m - backgrounds].node
            f, since = backgrounds + k, now - slots[m - backgrounds].start
            if touch_of(table, f, since, touches[touching]):
                touches[touching].share *= worth
                touching += 1
        if table.fields[f].kind == PLAIN:
            for j in range(nv):
                out[m, j] = plain[table.fields[f].row, j]
        else:
            add_torque(table, f, x, memory[m], since, pace, touches[:touching], scratch, out[m])
        for j in range(nv):
            out[m, j] *= weight[m, j]


@compiled
def keep(asked: FloatArray, on: int, contribution: FloatArray) -> None:
    """Copy the rows of the fields that are on."""
    for m in range(on):
        for j in range(asked.shape[1]):
            contribution[m, j] = asked[m, j]


@compiled
def control_one(what: int, share: int, i: int, time: float, x: Row, p: Parts) -> bool:
    """Control simulation i; returns whether its torque is finite."""
    table = FieldTable(
        p.fields, p.claims, p.numbers, p.reaches, p.points,
        p.guards, p.guarded, p.pairs, p.capsules,
    )  # fmt: skip
    backgrounds = p.gives_way.shape[0]
    slots, log, memory, live = p.slots[i], p.log[i], p.memory[i], p.live[i]
    course = p.course[i]
    if what & WALK:
        c = Course(
            p.nodes, p.others, p.conditions, backgrounds, slots, log, memory,
            p.plain_error[i], p.events[i], course, p.rounds[i],
        )  # fmt: skip
        keep_time(time, p.ease[0], course)
        if live < 0:
            begin_task(time - course.lag, x, table, p.roots, c)
            live = 0
        if course.wanted == 1.0:
            live = walk(time - course.lag, x, table, c, live)
        p.live[i] = live
    now = time - course.lag
    if not what & ACT:
        return True
    weight, asked, torque = p.weight[share], p.asked[share], p.torque[i]
    scratch = Scratch(
        p.knot_weight[share],
        p.knot_rate[share],
        p.angles[share],
        p.balls[share],
        p.wrenches[share],
        p.placed[share],
    )
    weigh_fields(now, p.nodes, p.others, p.claims, p.gives_way, slots, live, weight)
    ask_fields(
        now, x, table, backgrounds, slots, live, course.pace, memory, weight,
        p.touches[i], p.plain[i], scratch, asked,
    )  # fmt: skip
    sum_torques(asked, backgrounds + live, torque)
    if p.contribution.shape[0] > 0:
        keep(asked, backgrounds + live, p.contribution[i])
    if p.activation.shape[0] > 0:
        keep(weight, backgrounds + live, p.activation[i])
    return limit_torques(p.dofs, torque)


@compiled
def control_share(
    what: int,
    share: int,
    time: FloatArray,
    qpos: FloatArray,
    qvel: FloatArray,
    xpos: FloatArray,
    xmat: FloatArray,
    cdof: FloatArray,
    cvel: FloatArray,
    com: FloatArray,
    p: Parts,
) -> int:
    """Control a share of the simulations; returns one whose torque is not finite, or -1."""
    bad = -1
    for i in range(p.shares[share], p.shares[share + 1]):
        x = Row(qpos[i], qvel[i], xpos[i], xmat[i], cdof[i], cvel[i], com[i], p.links, p.dofs)
        if not control_one(what, share, i, time[i], x, p):
            bad = i
    return bad


def _make(code: str) -> Callable[..., int]:
    @compiled_entry
    def control(what, share, time, qpos, qvel, xpos, xmat, cdof, cvel, com, r):  # type: ignore[no-untyped-def]
        """See `control_share`."""
        len(code)
        parts = Parts(
            r.links, r.dofs, r.fields, r.claims, r.numbers, r.reaches, r.points, r.guards,
            r.guarded, r.pairs, r.capsules, r.gives_way, r.nodes, r.others, r.roots,
            r.conditions, r.ease, r.course, r.events, r.live, r.slots, r.log, r.rounds, r.memory,
            r.touches, r.plain, r.plain_error, r.contribution, r.activation, r.torque, r.shares,
            r.weight, r.asked, r.knot_weight, r.knot_rate, r.angles, r.balls,
            r.wrenches, r.placed,
        )  # fmt: skip
        return control_share(what, share, time, qpos, qvel, xpos, xmat, cdof, cvel, com, parts)

    return control


control: Callable[..., int] = _make(fingerprint())

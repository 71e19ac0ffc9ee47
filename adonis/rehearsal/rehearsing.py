"""Rehearsal: find a way for every hand that is only told where to go, by trying.

The sub-tasks are taken in the order in which they begin. For each that is to bring a hand to a
place, and says nothing of the way, ways that kinematics proposes (`sim.find_way`) and ways near
them are tried in simulation, all from the moment in which the sub-tasks before it, rehearsed
already, have left the body. The best is kept and the task goes on with it. Then the task is gone
through again: now that the ways of what comes later are known, each way is seen together with
those, and mended where it does not pass with room to spare; once more if one still fails. Seeds are
fixed: the same task on the same body gets the same ways.
"""

from collections.abc import Callable, Mapping

import numpy as np

from adonis.rehearsal.searching import Rehearsed, Search, with_ways
from adonis.rehearsal.stage import Walk
from primitives import GoToPoint
from sim import Body
from specs import TaskSpec, bind_task

TURNS = 4  # through the task, at most

Progress = Callable[[float, str], None]
Found = Callable[[str, Rehearsed], None]


def rehearse(
    spec: TaskSpec,
    body: Body,
    *,
    seed: int = 0,
    turns: int = TURNS,
    known: Mapping[str, Rehearsed] | None = None,
    progress: Progress | None = None,
    found: Found | None = None,
) -> dict[str, Rehearsed]:
    """Ways for the sub-tasks of a task that need one.

    Args:
        spec: the task.
        body: that is to do it.
        seed: of what is drawn.
        turns: how often the task is gone through at most.
        known: ways from a rehearsal of the same task that broke off.
        progress: told the share that is done and the sub-task that is on.
        found: told each way as soon as it is found, or mended.

    Returns:
        A way for each sub-task that needs one and has its turn; in the order of their turns.

    Raises:
        SpecError: the task does not fit the body.
    """
    said = {s.name: s.does for s in spec.subtasks if s.lacks_way}
    ways = dict(known or {})
    for turn in range(turns):
        walk = Walk(bind_task(_with(spec, ways), body))
        done = {name for name, way in ways.items() if way.turns > turn}
        while scene := walk.next(set(said) - done):
            name, way = scene.subtask, said[scene.subtask]
            assert isinstance(way, GoToPoint)
            if progress is not None:
                progress((turn + len(done) / len(said)) / turns, name)
            rng = np.random.default_rng([seed, list(said).index(name), turn])
            search = Search(_with(spec, ways), body, scene, alone=turn == 0, rng=rng)
            ways[name] = search.further(way, ways[name]) if turn else search.afresh()
            done.add(name)
            walk.go_on(bind_task(_with(spec, ways), body), scene)
            if found is not None:
                found(name, ways[name])
        begun = any(way.turns > turn + 1 for way in ways.values())  # of one that broke off
        if turn and not begun and all(way.grade.passes for way in ways.values()):
            break
    return ways


def _with(spec: TaskSpec, ways: Mapping[str, Rehearsed]) -> TaskSpec:
    return with_ways(spec, {name: way.does for name, way in ways.items()})

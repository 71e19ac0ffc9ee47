"""Rehearsal: find a way for every hand that is only told where to go, by trying.

The sub-tasks are taken in the order in which they begin. For each that is to bring a hand to a
place, and says nothing of the way, ways that kinematics proposes (`sim.find_way`) and ways near
them are tried in simulation, all from the moment in which the sub-tasks before it, rehearsed
already, have left the body. The best is kept and the task goes on with it. Seeds are fixed: the
same task on the same body gets the same ways.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from adonis.rehearsal.candidates import Family, FloatArray, family
from adonis.rehearsal.grading import FAILED, Grade, carries, grade
from adonis.rehearsal.stage import EARLY, Scene, Walk, play
from primitives import GoToPoint
from sim import Body, find_way
from specs import BoundTask, SubTask, TaskSpec, bind_task

VIAS = (1, 2, 3)  # via points of the ways that are tried
FIRST, AGAIN, KEPT = 36, 60, 10  # ways drawn of each family at first, later; the best of them
ROUNDS, FEWEST = 9, 1  # of drawing from a family again, at most and at least
LITTLE, PATIENCE = 0.1, 3  # once it passes: share of the cost that so many rounds should save
AFTERWARDS = 0.25  # [s] for which a goal is watched when its time is over, at most

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Rehearsed:
    """The way that was found for a sub-task."""

    does: GoToPoint
    grade: Grade
    tried: int  # how many ways


def rehearse(
    spec: TaskSpec,
    body: Body,
    *,
    seed: int = 0,
    threads: int = 1,
    known: Mapping[str, Rehearsed] | None = None,
    progress: Progress | None = None,
    found: Callable[[str, Rehearsed], None] | None = None,
) -> dict[str, Rehearsed]:
    """Ways for the sub-tasks of a task that need one.

    Args:
        spec: the task.
        body: that is to do it.
        seed: of what is drawn.
        threads: of the physics; the result does not depend on it.
        known: ways of the first sub-tasks, from a rehearsal of the same task that broke off.
        progress: told the share that is done and the sub-task that is on.
        found: told each way as soon as it is found.

    Returns:
        A way for each sub-task that needs one and has its turn; in the order of their turns.

    Raises:
        SpecError: the task does not fit the body.
    """
    ways = dict(known or {})
    wanted = [s.name for s in spec.subtasks if s.lacks_way]
    spec = with_ways(spec, {name: way.does for name, way in ways.items()})
    walk = Walk(bind_task(spec, body))
    while scene := walk.next(set(wanted) - set(ways)):
        name = scene.subtask
        if progress is not None:
            progress(len(ways) / len(wanted), name)
        rng = np.random.default_rng([seed, wanted.index(name)])
        ways[name] = _Rehearsal(spec, body, scene, rng, threads).run()
        spec = with_ways(spec, {name: ways[name].does})
        walk.go_on(bind_task(spec, body), scene)
        if found is not None:
            found(name, ways[name])
    return ways


def with_ways(spec: TaskSpec, ways: Mapping[str, GoToPoint]) -> TaskSpec:
    """The task with ways filled in."""
    subtasks = tuple(
        s.model_copy(update={"does": ways[s.name]}) if s.name in ways else s for s in spec.subtasks
    )
    return spec.model_copy(update={"subtasks": subtasks})


class _Rehearsal:
    """Of one sub-task.

    Args:
        spec: the task, its earlier sub-tasks rehearsed.
        body: that does it.
        scene: the moment before the sub-task.
        rng: of the ways that are drawn.
        threads: of the physics.
    """

    def __init__(
        self, spec: TaskSpec, body: Body, scene: Scene, rng: np.random.Generator, threads: int
    ) -> None:
        self._spec, self._body, self._scene = spec, body, scene
        self._rng, self._threads = rng, threads
        subtask = next(s for s in spec.subtasks if s.name == scene.subtask)
        assert isinstance(subtask.does, GoToPoint)
        self._does = subtask.does
        task = bind_task(spec, body)
        own = task.graph.lasts(subtask.name) * subtask.times
        self._seconds = max(own, subtask.timeout or 0.0) + _rest(task, subtask)
        self._best, self._grade, self._tried = self._does, FAILED, 0

    def run(self) -> Rehearsed:
        """The straight way if it is comfortable, else the best that is found."""
        self._try([self._does])
        if not self._grade.comfortable:
            self._search()
        return Rehearsed(self._best, self._grade, self._tried)

    def _search(self) -> None:
        """Try ways near the detours that kinematics proposes; go on with the most promising."""
        body, arm = self._body, self._body.arm(self._does.limb)
        goal, start = self._does.palm_goal(body), self._scene.qpos
        detours = [find_way(body, start, arm, goal, counts=(count,)) for count in VIAS]
        tried = [self._round(family(detour, self._does), FIRST) for detour in detours]
        for one, rows, costs in sorted(tried, key=lambda t: float(t[2].min())):
            self._narrow(one, rows, costs)
            if self._grade.passes:
                break

    def _narrow(self, one: Family, rows: FloatArray, costs: FloatArray) -> None:
        """Draw near the best of a family, again and again: the cross-entropy method."""
        history = [np.inf] * PATIENCE
        for _ in range(ROUNDS):
            history.append(self._grade.cost)
            settled = self._grade.passes and history[-1] > (1.0 - LITTLE) * history[-1 - PATIENCE]
            if settled or (self._grade.comfortable and len(history) > FEWEST + PATIENCE):
                break
            best = np.argsort(costs, kind="stable")[:KEPT]
            one, fresh, more = self._round(one.near(rows[best]), AGAIN)
            rows, costs = np.concatenate([rows[best], fresh]), np.concatenate([costs[best], more])

    def _round(self, one: Family, many: int) -> tuple[Family, FloatArray, FloatArray]:
        """Draw from a family: the numbers (many, size) of the ways, and their costs (many,)."""
        rows = one.draw(self._rng, many)
        return one, rows, self._try([one.way(row, self._does, self._body) for row in rows])

    def _try(self, ways: Sequence[GoToPoint]) -> FloatArray:
        """Costs (k,) of ways, from a simulation of each; the best of all is kept."""
        name = self._scene.subtask
        tasks = [bind_task(with_ways(self._spec, {name: way}), self._body) for way in ways]
        recordings = play(tasks, self._scene, self._seconds, threads=self._threads)
        costs = []
        for way, task, recording in zip(ways, tasks, recordings, strict=True):
            mark = grade(recording, task, name)
            costs.append(mark.cost)
            self._tried += 1
            if self._tried == 1 or mark.cost < self._grade.cost:
                self._best, self._grade = way, mark
        return np.array(costs)


def _rest(task: BoundTask, subtask: SubTask) -> float:
    """How long a goal is held, as it is planned, before hand or goal move on; or is watched [s]."""
    claims = dict(zip(task.graph.order, (set(f.claims.tolist()) for f in task.fields), strict=True))
    _, end = task.graph.planned[subtask.name]
    starts = [
        start - end
        for name, (start, _) in task.graph.planned.items()
        if name != subtask.name
        and start >= end - EARLY
        and (claims[name] & claims[subtask.name] or carries(task, claims[name], subtask.name))
    ]
    return float(np.clip(min(starts, default=AFTERWARDS), task.body.timestep, AFTERWARDS))

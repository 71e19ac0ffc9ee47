"""The search for one way: try some in simulation, keep the best, and try others near those."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from adonis.rehearsal.candidates import Family, FloatArray, family, near_way, settled
from adonis.rehearsal.grading import FAILED, HOPELESS, Grade, grade, hindered
from adonis.rehearsal.outlook import outlook
from adonis.rehearsal.stage import Scene, play
from primitives import GoToPoint
from sim import Body, find_way
from specs import TaskSpec, bind_task

VIAS = (1, 2, 3)  # via points of the ways that are tried
FIRST, AGAIN, KEPT = 36, 60, 10  # ways drawn of each family at first, later; the best of them
MOST = 3  # families that are drawn from again where nothing comes near to passing
ROUNDS, FEWEST = 9, 1  # of drawing from a family again, at most and at least
LITTLE, PATIENCE = 0.1, 3  # share of the cost that so many rounds should save


@dataclass(frozen=True)
class Rehearsed:
    """The way that was found for a sub-task."""

    does: GoToPoint
    grade: Grade
    tried: int  # how many ways
    turns: int = 1  # how often the task was gone through; after the first, later ways are known


def with_ways(spec: TaskSpec, ways: Mapping[str, GoToPoint]) -> TaskSpec:
    """The task with ways filled in."""
    subtasks = tuple(
        s.model_copy(update={"does": ways[s.name]}) if s.name in ways else s for s in spec.subtasks
    )
    return spec.model_copy(update={"subtasks": subtasks})


def without_ways(spec: TaskSpec) -> TaskSpec:
    """The task with the ways of its touches forgotten, to be rehearsed.

    A hand that goes to a place in the air is left its way, which may be what it is to draw.
    """
    subtasks = tuple(
        s.model_copy(update={"does": _told_where(s.does)})
        if isinstance(s.does, GoToPoint) and isinstance(s.does.to, str)
        else s
        for s in spec.subtasks
    )
    return spec.model_copy(update={"subtasks": subtasks, "rehearse": True})


def _told_where(does: GoToPoint) -> GoToPoint:
    kept = does.model_dump(exclude_unset=True, exclude={"via", "upper_arm", "travel"})
    return GoToPoint.model_validate(kept)


class Search:
    """For the way of one sub-task.

    Args:
        spec: the task, its earlier sub-tasks rehearsed.
        body: that does it.
        scene: the moment before the sub-task.
        alone: whether what comes later is held back, nobody knowing its ways yet.
        rng: of the ways that are drawn.
    """

    def __init__(
        self,
        spec: TaskSpec,
        body: Body,
        scene: Scene,
        *,
        alone: bool,
        rng: np.random.Generator,
    ) -> None:
        self._spec, self._body, self._scene = spec, body, scene
        self._rng = rng
        subtask = next(s for s in spec.subtasks if s.name == scene.subtask)
        assert isinstance(subtask.does, GoToPoint)
        self._does = subtask.does
        bound = bind_task(spec, body)
        self._beside = bound.body_for(subtask.name)  # what the task says of it, and objects
        self._outlook = outlook(bound, subtask, alone=alone)
        self._best, self._grade, self._tried = self._does, FAILED, 0

    def afresh(self) -> Rehearsed:
        """The straight way if it is comfortable, else the best that is found."""
        self._try([self._does])
        if not self._grade.comfortable:
            self._search()
        return Rehearsed(self._best, self._grade, self._tried)

    def further(self, said: GoToPoint, known: Rehearsed) -> Rehearsed:
        """A way that was found, or a better one.

        Args:
            said: what the task itself says of the way.
            known: the way that was found.
        """
        self._try([known.does])
        again, self._does = self._tried, said
        if known.does.via and not self._grade.comfortable:
            near = near_way(known.does, said, self._beside, self._scene.qpos)
            self._narrow(*self._round(near, FIRST))
        elif not self._grade.passes:
            self._search()
        tried = known.tried + self._tried - again
        return Rehearsed(self._best, self._grade, tried, known.turns + 1)

    def _search(self) -> None:
        """Try ways near the detours that kinematics proposes; go on with the most promising."""
        body, arm = self._beside, self._beside.arm(self._does.limb)
        goal, start = self._does.palm_goal(body), self._scene.qpos
        detours = [find_way(body, start, arm, goal, counts=(count,)) for count in VIAS]
        families = [family(detour, self._does, body, start) for detour in detours]
        families += [settled(one, self._does, body, start) for one in families]
        tried = [self._round(one, FIRST) for one in families]
        ranked = sorted(tried, key=lambda t: float(t[2].min()))
        for k, (one, rows, costs) in enumerate(ranked):
            if self._grade.passes or (k >= MOST and self._grade.cost > HOPELESS):
                break
            self._narrow(one, rows, costs)

    def _narrow(self, one: Family, rows: FloatArray, costs: FloatArray) -> None:
        """Draw near the best of a family, again and again: the cross-entropy method."""
        history = [np.inf] * PATIENCE
        for _ in range(ROUNDS):
            history.append(float(costs.min()))
            stalls = history[-1] > (1.0 - LITTLE) * history[-1 - PATIENCE]
            if stalls and (self._grade.passes or history[-1] > HOPELESS):
                break
            if self._grade.comfortable and len(history) > FEWEST + PATIENCE:
                break
            best = np.argsort(costs, kind="stable")[:KEPT]
            one, fresh, more = self._round(one.near(rows[best]), AGAIN)
            rows, costs = np.concatenate([rows[best], fresh]), np.concatenate([costs[best], more])

    def _round(self, one: Family, many: int) -> tuple[Family, FloatArray, FloatArray]:
        """Draw from a family: the numbers (many, size) of the ways, and their costs (many,)."""
        rows = one.draw(self._rng, many)
        return one, rows, self._try([one.way(row, self._does, self._beside) for row in rows])

    def _try(self, ways: Sequence[GoToPoint]) -> FloatArray:
        """Costs (k,) of ways, from a simulation of each; the best of all is kept."""
        name, ahead = self._scene.subtask, self._outlook
        tasks = [bind_task(with_ways(self._spec, {name: way}), self._body) for way in ways]
        recordings = play(tasks, self._scene, ahead.seconds, alone=ahead.alone)
        marks = [
            grade(recording, task, name, freed=ahead.freed)
            for task, recording in zip(tasks, recordings, strict=True)
        ]
        if ahead.next_hand is not None:
            ranked = np.argsort([mark.cost for mark in marks], kind="stable")
            for rank, k in enumerate(k for k in ranked if marks[k].passes):
                seen = recordings[k] if rank < KEPT else None
                marks[k] = hindered(marks[k], seen, tasks[k], name, ahead.next_hand)
        for way, mark in zip(ways, marks, strict=True):
            self._tried += 1
            if self._tried == 1 or mark.cost < self._grade.cost:
                self._best, self._grade = way, mark
        return np.array([mark.cost for mark in marks])

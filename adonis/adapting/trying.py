"""What becomes of variants of a task, each danced from beginning to end, all in one batch."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from adonis.judging import judge
from adonis.rehearsal.stage import opening, play
from adonis.verdicts import Judgement, Measure
from sim import Recording, Replay
from specs import BoundTask

AMPLE = 0.75  # share of what is allowed that may be used up without a cost
FAILURE = 50.0  # cost of each sub-task and each check that fails
NEAR, BEYOND = 4.0, 4.0  # costs of a measure that is near its limit, and beyond it
BROKE = 1e4  # cost of a run that breaks off


@dataclass(frozen=True)
class Mark:
    """How well a task was danced: fewer failures are better, then less cost."""

    failures: int  # sub-tasks and checks
    passed: int  # sub-tasks
    cost: float

    @property
    def key(self) -> tuple[int, float]:
        """By which marks are compared."""
        return self.failures, self.cost


BROKEN = Mark(10**6, 0, BROKE)


def marks(tasks: Sequence[BoundTask]) -> list[Mark]:
    """Dance variants of a task on bodies with the same model, and mark each."""
    seconds = [_seconds(task) for task in tasks]
    recordings = play(tasks, opening(tasks[0]), max(seconds))
    return [
        BROKEN if recording is None else mark(judged(recording, task, until))
        for recording, task, until in zip(recordings, tasks, seconds, strict=True)
    ]


def judged(recording: Recording, task: BoundTask, until: float) -> Judgement:
    """The judgement of the first seconds of a recording."""
    whole = recording.until(until)
    return judge(whole, task.spec, Replay(whole))


def mark(judgement: Judgement) -> Mark:
    """What a judgement comes to."""
    measures = [*judgement.checks, *(m for v in judgement.verdicts for m in v.measures)]
    failures = sum(not v.success for v in judgement.verdicts)
    failures += sum(not check.success for check in judgement.checks)
    cost = FAILURE * failures + sum(_cost(measure) for measure in measures)
    return Mark(failures, judgement.passed, float(cost))


def _cost(measure: Measure) -> float:
    """Nothing up to an ample share of what is allowed, then more and more."""
    share = measure.value / measure.limit
    if not np.isfinite(share):
        share = 100.0
    near = NEAR * max(0.0, min(share, 1.0) - AMPLE)
    return near + (BEYOND * (1.0 + float(np.log(share))) if share > 1.0 else 0.0)


def _seconds(task: BoundTask) -> float:
    """How long a run of it takes, at most [s]."""
    waits = sum(s.timeout or 0.0 for s in task.spec.subtasks) if task.may_wait else 0.0
    return task.graph.duration + waits

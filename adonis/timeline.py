"""A timeline: when each sub-task was planned, when it ran, and what it did with its joints.

What ran comes from the recording: spans say when a sub-task began and was over, its torques until
when it pulled (its goal is held) and from whom it took joints.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from adonis.judging import hand_over_rows
from adonis.transitions import givers
from adonis.verdicts import moved_by, swinging
from sim import Recording, Span
from specs import SubTask, TaskGraph

NEVER = float("nan")


@dataclass(frozen=True)
class Row:
    """One sub-task; times in seconds, NaN where there is none."""

    subtask: SubTask
    moves: tuple[str, ...]  # parts of the body
    planned: tuple[float, float]
    hand_over: float  # how long its cross-fade takes
    outcome: str = ""  # done, ended, skipped, timed out …; nothing if it has not run
    began: float = NEVER
    ended: float = NEVER  # when it was over
    let_go: float = NEVER  # until when it pulled, its goal held or fading
    took_from: tuple[str, ...] = ()  # sub-tasks that pulled on its joints until then

    @property
    def ran(self) -> bool:
        """Whether it began."""
        return bool(np.isfinite(self.began))

    @property
    def became(self) -> str:
        """What became of it, in a word or two."""
        return {"skipped": "not taken", "pending": "not begun"}.get(self.outcome, self.outcome)

    @property
    def rounds(self) -> tuple[float, ...]:
        """When each planned round but the first begins [s]."""
        start, end = self.planned
        times = self.subtask.times
        return tuple(start + (end - start) * k / times for k in range(1, times))


@dataclass(frozen=True)
class Timeline:
    """A task in time; rows in the order of the graph."""

    title: str
    rows: tuple[Row, ...]
    end: float  # of what was planned and of what ran [s]
    beat: float  # [s]
    recorded: bool


def timeline(task: TaskGraph, recording: Recording | None = None) -> Timeline:
    """The plan of a task and, with a recording of it, what became of that."""
    rows = [
        Row(
            task.subtasks[name],
            moves=tuple(moved_by(task.subtasks[name].does) or swinging(task.subtasks[name].does)),
            planned=task.planned[name],
            hand_over=task.fade(name),
        )
        for name in task.order
    ]
    end = task.duration
    if recording is not None:
        spans = {span.name: span for span in recording.spans}
        rows = [_as_it_ran(row, spans, recording) for row in rows]
        end = max(end, float(recording.time[-1]))
    return Timeline(
        title=task.spec.title or task.spec.task,
        rows=tuple(rows),
        end=end,
        beat=60.0 / task.spec.tempo,
        recorded=recording is not None,
    )


def _as_it_ran(row: Row, spans: Mapping[str, Span], recording: Recording) -> Row:
    name = row.subtask.name
    if name not in spans:  # a killed run leaves none
        return replace(row, outcome="unknown")
    span = spans[name]
    if not np.isfinite(span.start):
        return replace(row, outcome=span.outcome)
    let_go = span.end
    if not np.isfinite(let_go):
        let_go = float(recording.time[-1])
    took_from: tuple[str, ...] = ()
    if name in recording.names:
        pull = recording.contribution[:, recording.names.index(name)]
        pulls = recording.time[pull.any(axis=1)]
        if len(pulls):
            let_go = max(let_go, float(pulls[-1]))
        rows = hand_over_rows(recording, replace(span, start=span.first), row.hand_over)
        dofs = np.flatnonzero(pull[rows].any(axis=0))
        took_from = givers(recording, name, rows, dofs, tuple(spans))
    return replace(
        row,
        outcome=span.outcome,
        began=span.first,
        ended=span.end,
        let_go=let_go,
        took_from=took_from,
    )

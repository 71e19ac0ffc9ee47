"""What a judge says: measures of sub-tasks and of whole runs, against what is allowed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from primitives import LookAt, Oscillate, Primitive
from sim import Span
from specs import Background, Fitness, SubTask

HEAD = "head"  # the joints that turn it, in a list of what a sub-task moves


@dataclass(frozen=True)
class Measure:
    """One thing that was measured, against what is allowed."""

    what: str
    value: float
    limit: float
    unit: str
    where: str = ""

    @property
    def success(self) -> bool:
        """Whether the value is within its limit."""
        return bool(self.value <= self.limit)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "what": self.what,
            "value": _finite(self.value),
            "limit": self.limit,
            "unit": self.unit,
            "where": self.where,
            "success": self.success,
        }


@dataclass(frozen=True)
class Verdict:
    """What became of one sub-task."""

    subtask: SubTask
    span: Span
    measures: tuple[Measure, ...]
    fitness: Fitness | None = None  # of a task that is done as far as the body can

    @property
    def success(self) -> bool:
        """It ended as the task foresees, and everything measured is within its limit.

        A task may leave sub-tasks out, end them, and say what is to happen after a time-out.
        """
        gave_up = self.span.outcome == "timed out" and self.subtask.otherwise is not None
        foreseen = gave_up or self.span.outcome in ("done", "ended", "skipped")
        done = self.fitness is None or self.fitness.verdict != "impossible"
        return done and foreseen and all(m.success for m in self.measures)

    @property
    def worst(self) -> Measure | None:
        """The measure that is nearest to its limit, or furthest beyond."""
        return max(self.measures, key=_ratio, default=None)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        does, worst = self.subtask.does, self.worst
        limb = ", ".join(claimed(self.subtask) or swinging(self.subtask.does))
        return {
            "name": self.subtask.name,
            "words": self.subtask.words,
            "primitive": does.kind,
            "controller": getattr(does, "controller", None),
            "limb": limb or None,
            "start": _finite(self.span.start),
            "end": _finite(self.span.end),
            "outcome": self.span.outcome,
            "error": _finite(worst.value) if worst else None,
            "tolerance": worst.limit if worst else None,
            "unit": worst.unit if worst else None,
            "success": self.success,
            "measures": [m.as_dict() for m in self.measures],
            "best_effort": None if self.fitness is None else self.fitness.as_dict(),
        }


@dataclass(frozen=True)
class Judgement:
    """A whole run: its sub-tasks, and what must hold all the time."""

    verdicts: tuple[Verdict, ...]
    checks: tuple[Measure, ...]
    complete: bool

    @property
    def success(self) -> bool:
        """Every sub-task succeeded, every check holds, and the run came to its end."""
        return (
            self.complete
            and all(v.success for v in self.verdicts)
            and all(c.success for c in self.checks)
        )

    @property
    def passed(self) -> int:
        """How many sub-tasks succeeded."""
        return sum(v.success for v in self.verdicts)


def claimed(subtask: Background | SubTask) -> Sequence[str]:
    """The parts of the body that an entry of a task moves, as its task file names them.

    A primitive of the user's own may mean something else by those parameters.
    """
    return moved_by(subtask.does)


def moved_by(does: Primitive) -> Sequence[str]:
    """The same of a primitive."""
    if isinstance(does, Oscillate):
        return swinging(does) if does.claims else ()
    limb, joints = getattr(does, "limb", None), getattr(does, "joints", None)
    if isinstance(does, LookAt) and does.joints is None:
        return (HEAD,)
    if isinstance(limb, str):
        return (limb,)
    listed = joints if isinstance(joints, list | tuple) else ()
    return tuple(name for name in listed if isinstance(name, str))


def swinging(does: Primitive) -> Sequence[str]:
    """Joints, or the limb, that swing in a rhythm."""
    if not isinstance(does, Oscillate):
        return ()
    return tuple(does.joints or ()) if does.limb is None else (does.limb,)


def _ratio(measure: Measure) -> float:
    return measure.value / measure.limit if np.isfinite(measure.value) else np.inf


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None

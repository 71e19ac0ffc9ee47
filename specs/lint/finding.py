"""Findings: what is wrong or doubtful in a task, where, and what to do about it."""

from dataclasses import dataclass
from typing import Any, Literal

from specs.errors import SpecError
from specs.reading import Document, Path_
from specs.task import TaskSpec

Severity = Literal["error", "warning", "note"]
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")

# What each kind of finding is about; `adonis check --json` names them by these codes.
KINDS: dict[str, str] = {
    "refused": "the task makes no sense: a name, an order, a number",
    "claims": "two sub-tasks claim the same joint at the same time",
    "joint-limit": "a posture, a swing or a curve through via postures passes the end of a joint",
    "out-of-reach": "no posture of the body brings the palm to the goal",
    "inside-body": "the goal lies inside the body",
    "too-fast": "the time is too short for the body's torques, speeds or springs",
    "collision": "on the way, or at its end, links go into each other that must not touch",
    "stuck": "the way may end at the ends of joints before it comes to the goal",
    "never": "a condition that can never hold, or always does, so that something never begins",
    "event": "something waits for an event that only a program of one's own can send",
    "fight": "two primitives pull the same joints to different places at once",
}


# What to do about it in a lesson, which has no words for ways and numbers of joints.
SAYABLE = {
    "collision": "name another place, move the other arm away before, or give it more time",
    "stuck": "name another place, or bring the arm somewhere else before",
    "out-of-reach": "name another place",
    "inside-body": "name another place",
    "joint-limit": "say less of it",
}


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong or doubtful."""

    severity: Severity
    code: str  # one of KINDS
    subtask: str | None  # or entry of the background
    what: str
    advice: str
    file: str | None = None
    line: int | None = None
    column: int | None = None
    numbers: tuple[tuple[str, Any], ...] = ()  # what the words say in numbers, for tools

    @property
    def place(self) -> str:
        """FILE:LINE:COLUMN, as far as it is known."""
        parts = (self.file, self.line, self.column)
        return ":".join(str(part) for part in parts if part not in (None, ""))

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "severity": self.severity,
            "code": self.code,
            "subtask": self.subtask,
            "what": self.what,
            "advice": self.advice,
            "file": self.file,
            "line": self.line,
            "column": self.column,
            "numbers": dict(self.numbers),
        }


class Places:
    """Where the entries of a task stand in its file."""

    def __init__(self, spec: TaskSpec, document: Document) -> None:
        self._document = document
        self._paths: dict[str, Path_] = {
            **{b.name: ("background", i) for i, b in enumerate(spec.background)},
            **{s.name: ("subtasks", i) for i, s in enumerate(spec.subtasks)},
        }

    def finding(
        self,
        severity: Severity,
        code: str,
        subtask: str,
        what: str,
        advice: str,
        *below: str | int,
        **numbers: Any,
    ) -> Finding:
        """A finding about an entry, or about what stands below it in the file."""
        position = self._document.where((*self._paths[subtask], *below))
        file = (position.file if position else "") or self._document.file
        if self._document.is_lesson:
            advice = SAYABLE.get(code, advice)
        return Finding(
            severity, code, subtask, what, advice, file or None,
            position.line if position else None, position.column if position else None,
            tuple(numbers.items()),
        )  # fmt: skip


def refusal(problem: SpecError) -> Finding:
    """What was refused when the task was read or bound, as a finding."""
    advice = "correct it: nothing else can be looked at before"
    return Finding(
        "error", problem.code, None, problem.message, advice,
        problem.file, problem.line, problem.column,
    )  # fmt: skip


def cm(distance: float) -> str:
    """A distance [m] in centimetres."""
    return f"{100.0 * distance:.1f} cm"


def point(place: Any) -> str:
    """A place as a task file writes it."""
    return "{point: [" + ", ".join(f"{float(x) + 0.0:.2f}" for x in place) + "]}"

"""Lint: what is wrong or doubtful in a task, found before a single step is simulated."""

from dataclasses import replace

from specs.binding import BoundTask
from specs.lint.beginnings import never_begins
from specs.lint.collisions import colliding_ways
from specs.lint.course import planned_moves
from specs.lint.fights import fighting_primitives
from specs.lint.finding import KINDS, SEVERITIES, Finding, Places, refusal
from specs.lint.haste import too_fast
from specs.lint.joint_limits import beyond_limits
from specs.lint.reachable import out_of_reach
from specs.lint.together import Together
from specs.reading import Document

OF_THE_WAY = ("collision", "stuck", "too-fast")  # kinds that another way may mend

__all__ = ["KINDS", "SEVERITIES", "Finding", "lint_task", "refusal"]


def lint_task(task: BoundTask, document: Document | None = None) -> list[Finding]:
    """All findings about a task that could be bound, the gravest first.

    Args:
        task: the task, on a body.
        document: what it was read from, so that findings can say where.
    """
    places = Places(task.spec, document or Document(None, ""))
    moves = planned_moves(task)
    found = out_of_reach(task, places, moves)
    missed = {finding.subtask for finding in found}
    within = [move for move in moves if move.name not in missed]
    found += beyond_limits(task, places, moves)
    together = Together(moves)
    found += too_fast(task, places, within, together)
    found += colliding_ways(task, places, within, together)
    found += never_begins(task, places)
    found += fighting_primitives(task, places)
    if task.spec.rehearse:
        found = [_left_to_rehearsal(finding, task) for finding in found]
    rank = {name: k for k, name in enumerate(b.name for b in task.spec.background)}
    rank |= {name: len(rank) + k for k, name in enumerate(task.graph.order)}
    return sorted(found, key=lambda f: (SEVERITIES.index(f.severity), rank[f.subtask or ""]))


def _left_to_rehearsal(finding: Finding, task: BoundTask) -> Finding:
    """A finding about a straight way is a note where a rehearsal is to look for another."""
    subtask = task.graph.subtasks.get(finding.subtask or "")
    sought = subtask is not None and subtask.lacks_way
    if finding.code not in OF_THE_WAY or not sought:
        return finding
    return replace(
        finding,
        severity="note",
        what=f"on the straight way, {finding.what}",
        advice=f"the rehearsal before a run looks for another way; else {finding.advice}",
    )

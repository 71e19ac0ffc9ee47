"""Trials: the same task under other conditions, side by side in batches."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from adonis.dancing import Stopped, random_start, run_task
from adonis.judging import judge
from adonis.reporting import prepare_folder, write_text
from adonis.verdicts import Judgement
from sim import Body, Push, Recording, load_body
from specs import BoundTask, Document, TaskSpec, bind_task, fitted, with_tempo

OTHERS = {"adonis": "adonis-female"}  # bodies that are tried on another as well
TEMPOS = (80.0, 120.0)  # beats per minute, beside the task's own
PUSH = 40.0  # [N]
PUSH_DURATION = 0.1  # [s]


@dataclass(frozen=True)
class Trial:
    """One condition, and what became of the task in it."""

    condition: str
    body: str
    judgement: Judgement | None  # None if the run broke off

    @property
    def success(self) -> bool:
        """Whether everything succeeded."""
        return self.judgement is not None and self.judgement.success

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        j = self.judgement
        return {
            "condition": self.condition,
            "body": self.body,
            "success": self.success,
            "passed": j.passed if j else 0,
            "of": len(j.verdicts) if j else 0,
            "failed": [v.subtask.name for v in j.verdicts if not v.success] if j else [],
            "checks": [c.as_dict() for c in j.checks] if j else [],
        }


def run_trials(
    spec: TaskSpec,
    document: Document,
    *,
    body: Body | None = None,
    starts: int = 20,
    seed: int = 0,
    threads: int = 2,
    progress: Callable[[str], None] | None = None,
) -> list[Trial]:
    """Do a task as it stands, faster and slower, on another body, from anywhere, and pushed.

    Args:
        spec: the task.
        document: what it was read from.
        body: that does it; default: Adonis.
        starts: how many random start postures of the arms.
        seed: of those.
        threads: of the physics.
        progress: told which condition is on.

    Raises:
        SpecError: the task does not fit one of the bodies.
    """
    rows: list[Trial] = []
    body = load_body("adonis") if body is None else body
    spec = fitted(spec, body, document)

    def run(task: BoundTask, conditions: Sequence[str], **options: Any) -> None:
        if progress is not None:
            more = f" and {len(conditions) - 1} more" if conditions[1:] else ""
            progress(conditions[0] + more)
        recordings: Sequence[Recording | None]
        try:
            recordings = run_task(
                task, n=len(conditions), threads=threads, contributions=False, **options
            )
        except Stopped:
            recordings = [None] * len(conditions)
        for condition, recording in zip(conditions, recordings, strict=True):
            judgement = None if recording is None else judge(recording, task.spec)
            rows.append(Trial(condition, task.body.map.name, judgement))

    task = bind_task(spec, body, document)
    run(task, [f"as it stands, {spec.tempo:g} bpm"])
    for tempo in TEMPOS:
        run(bind_task(with_tempo(spec, tempo), body, document), [f"{tempo:g} bpm"])
    if body.map.name in OTHERS:
        other = load_body(OTHERS[body.map.name])
        danced = fitted(spec, other, document, tempo=spec.tempo)
        run(bind_task(danced, other, document), [f"female, {spec.tempo:g} bpm"])
    pushes = _pushes(task)
    run(task, [said for said, _ in pushes], pushes=[p for _, p in pushes])
    if starts:
        begin = random_start(body, task.start, starts, seed)
        names = [f"random start {k + 1}" for k in range(starts)]
        run(task, names, start=begin, seed=seed)
    return rows


def _pushes(task: BoundTask) -> list[tuple[str, Push]]:
    """A push on each hand, back and to the side, in the middle of the task."""
    middle = 0.5 * sum(task.graph.planned[task.graph.order[len(task.graph.order) // 2]])
    found: list[tuple[str, Push]] = []
    for name, limb in task.body.map.limbs.items():
        for way, force in (("back", (-PUSH, 0.0, 0.0)), ("left", (0.0, PUSH, 0.0))):
            said = f"{PUSH:g} N {way} for {PUSH_DURATION:g} s on the {limb.side} hand"
            push = Push(limb.hand, force, middle, PUSH_DURATION, (len(found),))
            found.append((f"{said} at {middle:.2f} s", push))
        del name
    return found


def write_trials(rows: Sequence[Trial], folder: Path) -> None:
    """Write the trials as JSON and as a Markdown table.

    Raises:
        OutputError: it cannot be written.
    """
    prepare_folder(folder)
    write_text(folder / "trials.json", json.dumps([r.as_dict() for r in rows], indent=2) + "\n")
    lines = ["| condition | body | sub-tasks | failed | checks failed |", "|---|---|---|---|---|"]
    for row in rows:
        said = row.as_dict()
        failed = ", ".join(said["failed"]) or "-"
        checks = ", ".join(c["what"] for c in said["checks"] if not c["success"]) or "-"
        cells = (row.condition, row.body, f"{said['passed']} of {said['of']}", failed, checks)
        lines.append(f"| {' | '.join(cells)} |")
    write_text(folder / "trials.md", "\n".join(lines) + "\n")


def print_trials(console: Console, rows: Sequence[Trial]) -> None:
    """The trials as a table in the terminal."""
    table = Table("condition", "body", "sub-tasks", "failed", title="Trials", title_justify="left")
    for row in rows:
        said = row.as_dict()
        checks = [
            f"{c['what']} {c['value']:.3g} {c['unit']}" for c in said["checks"] if not c["success"]
        ]
        color = "green" if row.success else "red"
        table.add_row(
            row.condition,
            row.body,
            f"[{color}]{said['passed']} of {said['of']}[/{color}]",
            ", ".join([*said["failed"], *checks]),
        )
    console.print(table)

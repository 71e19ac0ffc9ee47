"""What becomes of a dance on other people's robots: `python -m adonis.robots_study BODY...`.

Each body does the task as far as it can: by the ways of the task's hands, made for another body,
and by ways that a rehearsal finds round its own. What was foreseen of each sub-task, before
anything moved, stands beside what happened.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from adonis.dancing import run_task
from adonis.judging import judge
from adonis.rehearsal.keeping import rehearsed
from adonis.rehearsal.rehearsing import TURNS
from adonis.rehearsal.searching import without_ways
from adonis.reporting import write_results
from adonis.verdicts import Judgement, Verdict
from sim import Body
from specs import BestEffort, Fitness, TaskSpec, bind_task, find_body, fitted, load_task


@dataclass(frozen=True)
class Danced:
    """What was foreseen of a task on a body, and what happened."""

    body: str
    fitness: tuple[Fitness, ...]
    by_its_ways: Judgement
    by_own_ways: Judgement

    @property
    def agree(self) -> int:
        """Of how many sub-tasks the forecast came true, by the body's own ways."""
        happened = {v.subtask.name: v.success for v in self.by_own_ways.verdicts}
        return sum((fit.verdict == "reachable") == happened[fit.subtask] for fit in self.fitness)


def dance(
    spec: TaskSpec, body: Body, *, turns: int = TURNS, seed: int = 0, folder: Path | None = None
) -> Danced:
    """Let a body do a task as far as it can, twice.

    Args:
        spec: the task, for the body that it was written for.
        body: that does it.
        turns: how often the rehearsal goes through the task at most.
        seed: of the rehearsal.
        folder: where recordings and pictures go, in folders of their own.
    """
    judged = []
    for forgotten in (False, True):
        fits = fitted(spec, body)
        effort = BestEffort.of(without_ways(fits) if forgotten else fits, body)
        tried = (
            rehearsed(effort.tried, body, seed=seed, turns=turns)[0] if forgotten else effort.tried
        )
        (recording,) = run_task(bind_task(tried, body))
        asked = effort.to_judge(tried)
        if folder is not None:
            out = folder / f"{body.map.name}-{'own' if forgotten else 'given'}-ways"
            out.mkdir(parents=True, exist_ok=True)
            write_results(recording, asked, out, fitness=effort.fitness)
        judged.append(judge(recording, asked, fitness=effort.fitness))
    return Danced(body.map.name, effort.fitness, *judged)


def table(danced: Danced) -> str:
    """What was foreseen and what happened, sub-task by sub-task, as Markdown."""
    lines = ["| sub-task | foreseen | by the task's ways | by its own ways |", "|---|---|---|---|"]
    pairs = zip(danced.by_its_ways.verdicts, danced.by_own_ways.verdicts, strict=True)
    known = {fit.subtask: fit for fit in danced.fitness}
    for its, own in pairs:
        said = _foreseen(known[its.subtask.name])
        lines.append(f"| {its.subtask.name} | {said} | {_became(its)} | {_became(own)} |")
    return "\n".join(lines)


def _foreseen(fit: Fitness) -> str:
    if fit.short is None:
        return fit.verdict if fit.verdict == "reachable" else f"{fit.verdict}: {fit.why}"
    scale, unit = (1000.0, "mm") if fit.unit == "m" else (1.0, "°")
    return f"{fit.verdict}, {scale * fit.short:.0f} {unit} short: {fit.why}"


def _became(verdict: Verdict) -> str:
    worst = verdict.worst
    said = "ok" if verdict.success else "missed"
    if worst is None:
        return f"{said} ({verdict.span.outcome})"
    scale, unit = (1000.0, "mm") if worst.unit == "m" else (1.0, worst.unit)
    off = f"{scale * worst.value:.0f} of {scale * worst.limit:.0f} {unit}"
    return f"{said}, {worst.what} {off}"


def main(
    bodies: Annotated[list[str], typer.Argument(help="Body files, or names.")],
    task: Annotated[str, typer.Option("--task", help="What they do.")] = "macarena",
    tempo: Annotated[float | None, typer.Option("--tempo", help="Beats per minute.")] = None,
    turns: Annotated[
        int, typer.Option("--turns", min=1, help="How often rehearsal goes through it at most.")
    ] = TURNS,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for recordings.")] = None,
) -> None:
    """Let bodies do a task as far as they can, and print what was foreseen and what happened."""
    spec, _ = load_task(task)
    if tempo is not None:
        spec = spec.model_copy(update={"tempo": tempo})
    for name in bodies:
        danced = dance(spec, find_body(name), turns=turns, folder=out)
        its, own = danced.by_its_ways, danced.by_own_ways
        print(f"## {danced.body}\n\n{table(danced)}\n")
        print(
            f"{its.passed} of {len(its.verdicts)} by the task's ways, {own.passed} by its own;"
            f" the forecast came true of {danced.agree}. Checks that fail, by its own ways: "
            + ("; ".join(f"{c.what} {c.value:.3g} of {c.limit:.3g}{c.unit and ' ' + c.unit}"
                         for c in own.checks if not c.success) or "none")
            + "\n", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    typer.run(main)

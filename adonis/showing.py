"""Judgements and comparisons in the terminal."""

from collections.abc import Mapping
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from adonis.comparison.comparing import Comparison
from adonis.comparison.report import Written, failures, summary
from adonis.rehearsal.searching import Rehearsed
from adonis.tables import headed
from adonis.verdicts import Judgement, Verdict


def print_results(console: Console, judgement: Judgement, title: str) -> None:
    """What became of each sub-task, of what must hold all the time, and of the whole."""
    table = headed(
        title,
        ("", "right"),
        ("sub-task", "left"),
        ("primitive", "left"),
        ("from", "right"),
        ("to", "right"),
        ("error", "right"),
        ("allowed", "right"),
        ("", "left"),
    )
    for number, verdict in enumerate(judgement.verdicts, start=1):
        row, worst = verdict.as_dict(), verdict.worst
        error = allowed = ""
        if worst is not None:
            scale, unit = (1000.0, "mm") if worst.unit == "m" else (1.0, worst.unit)
            error, allowed = (
                f"{scale * worst.value:.1f} {unit}",
                f"{scale * worst.limit:.0f} {unit}",
            )
        table.add_row(
            str(number),
            escape(row["words"] or row["name"]),
            row["primitive"],
            "" if row["start"] is None else f"{row['start']:.2f}",
            "" if row["end"] is None else f"{row['end']:.2f}",
            error,
            allowed,
            _became(verdict),
        )
    console.print(table)
    for measure in judgement.checks:
        scale, unit = (1000.0, "mm") if measure.unit == "m" else (1.0, measure.unit)
        said = "[green]ok[/green]" if measure.success else "[red]failed[/red]"
        where = f"  [dim]({measure.where})[/dim]" if measure.where else ""
        console.print(
            f"  {measure.what}: {scale * measure.value:.2f} {unit},"
            f" allowed {scale * measure.limit:.2f}  {said}{where}",
            soft_wrap=True,
        )
    total = len(judgement.verdicts)
    console.print(
        f"{judgement.passed} of {total} sub-tasks succeeded{_verdict(judgement)}", soft_wrap=True
    )


def _verdict(judgement: Judgement) -> str:
    """How the last line goes on: what else went wrong, where it was not the sub-tasks."""
    if judgement.success:
        return ": [green]success[/green]"
    if judgement.passed < len(judgement.verdicts):
        return ": [red]failed[/red]"
    wrong = [c.what for c in judgement.checks if not c.success]
    if not judgement.complete:
        wrong.insert(0, "the whole run")
    return f", but not: [red]{', '.join(wrong)}[/red]"


def _became(verdict: Verdict) -> str:
    """What became of a sub-task, in a word."""
    outcome = verdict.span.outcome
    if verdict.success:
        return "[green]ok[/green]" if outcome == "done" else f"[dim]{outcome}[/dim]"
    return f"[red]{'failed' if outcome == 'done' else outcome}[/red]"


def print_comparison(console: Console, comparison: Comparison, written: Written) -> None:
    """Who succeeded and at what cost, what became of the paper's claims, and where it all is."""
    heads, rows = summary(comparison)
    table = Table("", *(name for name, _ in rows), title=escape(comparison.title))
    for k, head in enumerate(heads):
        table.add_row(escape(head), *(row[k] for _, row in rows))
    console.print(table)
    for said in failures(comparison):
        console.print(f"[yellow]{escape(said)}[/yellow]", soft_wrap=True)
    if written.claims:
        verdicts = [claim.verdict for claim in written.claims]
        counted = ", ".join(f"{verdicts.count(v)} {v}" for v in dict.fromkeys(verdicts))
        console.print(f"The paper's claims: {counted}.", soft_wrap=True)
    for notice in written.notices:
        console.print(f"[yellow]{escape(notice)}[/yellow]", soft_wrap=True)
    report = written.folder / "report.html"
    console.print(f"The report is [bold]{escape(str(report))}[/bold].", soft_wrap=True)


def print_rehearsal(console: Console, found: Mapping[str, Rehearsed], file: Path) -> None:
    """The ways that a rehearsal found, and where they are written."""
    for name, way in found.items():
        points, passes = len(way.does.via), way.grade.passes
        how = f"by way of {points} point{'s' * (points > 1)}" if points else "straight"
        said = "[green]ok[/green]" if passes else "[red]no way was found that passes[/red]"
        tries = f"{way.tried} way{'s' * (way.tried > 1)} tried"
        console.print(f"  {escape(name)}: {how}, {tries}  {said}", soft_wrap=True)
    console.print(
        f"{len(found)} ways are in [bold]{escape(str(file))}[/bold]"
        if found
        else f"No hand lacks a way; the task is in [bold]{escape(str(file))}[/bold]",
        soft_wrap=True,
    )

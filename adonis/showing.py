"""A judgement in the terminal."""

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from adonis.judging import Judgement


def print_results(console: Console, judgement: Judgement, title: str) -> None:
    """What became of each sub-task, of what must hold all the time, and of the whole."""
    table = Table(title=escape(title), title_justify="left")
    for heading, justify in (("", "right"), ("sub-task", "left"), ("primitive", "left"),
                             ("from", "right"), ("to", "right"), ("error", "right"),
                             ("allowed", "right"), ("", "left")):  # fmt: skip
        table.add_column(heading, justify=justify)  # type: ignore[arg-type]
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
            "[green]ok[/green]" if verdict.success else f"[red]{_why(verdict.span.outcome)}[/red]",
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


def _why(outcome: str) -> str:
    return "failed" if outcome == "done" else outcome

"""What a body can do of a task, on the terminal."""

from collections.abc import Sequence

from rich.console import Console
from rich.markup import escape

from adonis.tables import headed
from specs import Fitness, TaskSpec

COLORS = {"reachable": "green", "partly": "yellow", "impossible": "red"}


def print_fitness(console: Console, spec: TaskSpec, body: str, fitness: Sequence[Fitness]) -> None:
    """Each sub-task: whether the body can do it, how far short it stays, and what is to blame."""
    table = headed(
        f"What {body} can do of {spec.task}",
        ("", "right"),
        ("sub-task", "left"),
        ("", "left"),
        ("short of it", "right"),
        ("why", "left"),
    )
    for number, fit in enumerate(fitness, start=1):
        said = f"[{COLORS[fit.verdict]}]{fit.verdict}[/]"
        table.add_row(str(number), escape(fit.subtask), said, short(fit), escape(fit.why))
    console.print(table)
    counts = [(sum(fit.verdict == verdict for fit in fitness), verdict) for verdict in COLORS]
    console.print(", ".join(f"{count} {verdict}" for count, verdict in counts if count) + ".")


def notes(fitness: Sequence[Fitness]) -> list[str]:
    """What was tried instead, a line for each sub-task that the body cannot do as it is asked."""
    found = []
    for fit in fitness:
        if fit.verdict == "impossible":
            found.append(f"{fit.subtask}: impossible, it was waited for ({fit.why})")
        elif fit.instead is not None:
            found.append(
                f"{fit.subtask}: the nearest that the body reaches was tried, {short(fit)} short of"
                f" the goal ({fit.why})"
            )
        elif fit.verdict == "partly":
            found.append(f"{fit.subtask}: {fit.why}")
    return found


def short(fit: Fitness) -> str:
    """How far short a body stays, with its unit; nothing if it is not known."""
    if fit.short is None:
        return ""
    scale, unit = (100.0, "cm") if fit.unit == "m" else (1.0, fit.unit)
    return f"{scale * fit.short:.1f} {unit}"

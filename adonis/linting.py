"""What `adonis check` says: the plan of a task, what a body can do of it, and the findings."""

import json
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.markup import escape

from adonis.arguments import BAD_INPUT, FAILED, fit, refuse, whose
from adonis.fitness import print_fitness
from adonis.tables import headed
from primitives import GoToPoint, Primitive
from sim import BodyError
from specs import (
    BestEffort,
    BoundTask,
    Finding,
    Fitness,
    SpecError,
    bind_task,
    find_body,
    lint_task,
    load_task,
    refusal,
)

REACH = ("out-of-reach", "inside-body", "stuck")  # findings that a table of fitness tells better
COLORS = {"error": "red", "warning": "yellow", "note": "cyan"}


def check_task(
    task: str,
    body: str | None,
    tempo: float | None,
    kinds: Sequence[type[Primitive]],
    changes: Sequence[str] = (),
    *,
    as_json: bool,
    explained: bool = False,
) -> int:
    """Look at a task and say what would go wrong; a task that makes no sense ends the program.

    Args:
        task: of the library, or a file.
        body: that is to do it; default: the task's own.
        tempo: instead of the task's own [beats/min].
        kinds: primitives of the user's own.
        changes: values in the place of those of the file, `PATH=VALUE` each.
        as_json: print the findings for tools.
        explained: whether it was said already how a lesson was understood.

    Returns:
        The exit code: 1 if there is an error, or something that the body cannot do; else 0.
    """
    try:
        spec, document = load_task(task, primitives=kinds, changes=changes)
        on = find_body(whose(spec, body))
        another = on.map.name != whose(spec, None)
        fit_spec = fit(spec, on, document, tempo)
        effort = BestEffort.of(fit_spec, on, document) if another else None
        bound = (
            bind_task(effort.tried, on, document) if effort else bind_task(fit_spec, on, document)
        )
    except (BodyError, SpecError) as problem:
        if as_json and isinstance(problem, SpecError):
            print(findings_json([refusal(problem)]))
            return BAD_INPUT
        refuse(problem)
    fitness = effort.fitness if effort else ()
    told = {each.subtask for each in fitness if each.verdict != "reachable"}
    found = [f for f in lint_task(bound, document) if f.subtask not in told or f.code not in REACH]
    if as_json:
        print(findings_json(found, spec.task, on.map.name, fitness))
    else:
        console = Console()
        print_plan(console, bound)
        if document.is_lesson and not explained:
            console.print("How it was understood, and what was assumed: add --explain.")
        if fitness:
            print_fitness(console, spec, on.map.name, fitness)
        print_findings(console, found)
        if fitness and any(isinstance(s.does, GoToPoint) and s.does.via for s in spec.subtasks):
            console.print(
                f"The ways of its hands were made for {whose(spec, None)}; with --forget-ways `run`"
                f" and `rehearse` look for ways round {escape(on.map.name)}.",
                soft_wrap=True,
            )
    able = all(fit.verdict == "reachable" for fit in fitness)
    return 0 if able and all(f.severity != "error" for f in found) else FAILED


def print_plan(console: Console, bound: BoundTask) -> None:
    """When each sub-task is planned, and what is beside them."""
    spec, graph = bound.spec, bound.graph
    table = headed(
        spec.title or spec.task,
        ("", "right"),
        ("sub-task", "left"),
        ("primitive", "left"),
        ("moves", "left"),
        ("from", "right"),
        ("to", "right"),
    )
    depends = any(s.circumstances for s in spec.subtasks)
    if depends:
        table.add_column("if, while, until")
    for number, name in enumerate(graph.order, start=1):
        does, (start, end) = graph.subtasks[name].does, graph.planned[name]
        moves = getattr(does, "limb", None) or ", ".join(getattr(does, "joints", None) or ())
        more = (escape(graph.subtasks[name].circumstances),) if depends else ()
        times = f"{start:.2f}", f"{end:.2f} s"
        table.add_row(str(number), name, does.kind, moves.replace("_", " "), *times, *more)
    console.print(table)
    beside = ", ".join(f"{b.name} ({b.does.kind})" for b in spec.background) or "nothing"
    console.print(f"Beside them: {beside}.", soft_wrap=True)
    console.print(
        f"{len(graph.order)} sub-tasks, {graph.duration:.2f} s at {spec.tempo:g} beats per"
        f" minute on {bound.body.map.name}.",
        soft_wrap=True,
    )


def print_findings(console: Console, findings: Sequence[Finding]) -> None:
    """Two lines for each finding: what is wrong and where, and what to do.

    What is wrong again with another sub-task of the same sentence, or the next round, is counted.
    """
    alike: dict[tuple[str, str, object], list[Finding]] = {}
    for finding in findings:
        where = finding.place or finding.subtask
        alike.setdefault((finding.severity, finding.code, where), []).append(finding)
    for finding, *more in alike.values():
        color = COLORS[finding.severity]
        console.print(
            f"[bold {color}]{finding.severity}[/] [dim]{finding.code}[/]"
            f" [bold]{escape(finding.subtask or '')}[/]: {escape(finding.what)}",
            soft_wrap=True,
        )
        place = f" [dim]({escape(finding.place)})[/]" if finding.place else ""
        console.print(f"    {escape(finding.advice)}{place}", soft_wrap=True)
        if more:
            names = ", ".join(dict.fromkeys(other.subtask or "" for other in more))
            console.print(f"    [dim]the same {len(more)} times more: {escape(names)}[/]",
                          soft_wrap=True)  # fmt: skip
    if not findings:
        console.print("Nothing wrong was found.")
        return
    counts = [(sum(f.severity == severity for f in findings), severity) for severity in COLORS]
    said = [f"{count} {what}{'s' if count > 1 else ''}" for count, what in counts if count]
    console.print(f"{', '.join(said)}.")


def findings_json(
    findings: Sequence[Finding],
    task: str | None = None,
    body: str | None = None,
    fitness: Sequence[Fitness] = (),
) -> str:
    """The findings for tools."""
    whole: dict[str, Any] = {"task": task, "body": body}
    whole["findings"] = [finding.as_dict() for finding in findings]
    if fitness:
        whole["fitness"] = [fit.as_dict() for fit in fitness]
    return json.dumps(whole, indent=2, ensure_ascii=False)

"""From what stands on the command line to tasks, paths and classes; mistakes end the program."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import typer

if TYPE_CHECKING:
    from sim import Body
    from specs import BestEffort, BoundTask, Document, TaskSpec

FAILED, BAD_INPUT = 1, 2
AS_FAR = (
    "`adonis check {task} --body {body}` says what this body can do of it;"
    " `adonis run` with --best-effort does as much"
)


def load(
    task: str, primitives: list[str] | None, changes: Sequence[str] = ()
) -> "tuple[TaskSpec, Document]":
    """Read a task, with values set on the command line; every mistake ends here, with code 2."""
    from specs import SpecError, load_task

    try:
        return load_task(task, primitives=classes(primitives), changes=changes)
    except SpecError as problem:
        refuse(problem)


def whose(spec: "TaskSpec", body: str | None) -> str:
    """The name of the body that does a task: what is asked for, else the task's own."""
    return body or spec.body or "adonis"


def fit(
    spec: "TaskSpec", body: "Body", document: "Document", tempo: float | None = None
) -> "TaskSpec":
    """The task as it fits a body, at a tempo given on the command line; what changes is told.

    Raises:
        SpecError: see `fitted`.
    """
    from specs import fit_of, fitted

    made = fitted(spec, body, document, tempo=tempo)
    scaled = fit_of(spec, body, document)
    if scaled is not None:
        typer.echo(
            f"{spec.task} is written for {spec.body}; for {body.map.name} lengths are multiplied by"
            f" {scaled.like.length:.3g} and times by {scaled.time:.3g}"
            f" ({made.tempo:.4g} beats/min{'' if tempo is None else ', as you ask'})",
            err=True,
        )
    return made


def bind(
    task: str,
    body: str | None,
    tempo: float | None,
    primitives: list[str] | None,
    *,
    forget_ways: bool = False,
) -> "BoundTask":
    """Read a task and bind it to a body; every mistake in either ends here, with code 2."""
    return bind_as_far(task, body, tempo, primitives, forget_ways=forget_ways)[0]


def bind_as_far(
    task: str,
    body: str | None,
    tempo: float | None,
    primitives: list[str] | None,
    *,
    limits: bool = True,
    contacts: bool = True,
    controller: str | None = None,
    best_effort: bool = False,
    forget_ways: bool = False,
    changes: Sequence[str] = (),
) -> "tuple[BoundTask, BestEffort | None]":
    """`bind`; and what was asked for, if the body may do only as much of it as it can."""
    from sim import BodyError
    from specs import BestEffort, SpecError, bind_task, find_body, with_controller

    (spec, document), advice = load(task, primitives, changes), ""
    try:
        if controller is not None:
            spec = with_controller(spec, controller)
        on = find_body(whose(spec, body), limits=limits, contacts=contacts)
        if whose(spec, body) != whose(spec, None):
            advice = AS_FAR.format(task=task, body=body)
        spec = fit(spec, on, document, tempo)
        if forget_ways:
            from adonis.rehearsal.searching import without_ways

            spec = without_ways(spec)
        if not best_effort:
            return bind_task(spec, on, document), None
        effort = BestEffort.of(spec, on, document)
        return bind_task(effort.tried, on, document), effort
    except (BodyError, SpecError) as problem:
        refuse(problem, advice)


def classes(files: list[str] | None) -> "list[type]":
    """The primitives of some files or modules; every mistake ends here, with code 2."""
    from specs import SpecError, primitives_in

    found: list[type] = []
    for name in files or ():
        is_module = all(part.isidentifier() for part in name.split("."))
        is_data = Path(name).is_file() or Path(name).suffix in (".yaml", ".yml")
        if Path(name).suffix != ".py" and (is_data or not is_module):
            refuse(f"--primitives: expected a .py file or a module, not {name!r}")
        try:
            found += primitives_in(name)
        except SpecError as problem:
            refuse(problem)
        except SystemExit as problem:
            refuse(f"{name}: cannot be imported: it ends the program (code {problem.code})")
    return found


def given_path(option: str, given: str | None) -> Path | None:
    """The path that an option names; an empty one is a mistake, not the present folder."""
    if given is not None and not given.strip():
        refuse(f"{option}: expected a path, not {given!r}")
    return None if given is None else Path(given)


def refuse(problem: Exception | str, advice: str = "") -> NoReturn:
    """One clear message, exit code 2; below it the line that it is about, and advice."""
    typer.echo(f"adonis: {problem}", err=True)
    if excerpt := getattr(problem, "excerpt", ""):
        typer.echo(excerpt, err=True)
    if advice:
        typer.echo(advice, err=True)
    sys.exit(BAD_INPUT)

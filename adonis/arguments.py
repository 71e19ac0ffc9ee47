"""From what stands on the command line to tasks, paths and classes; mistakes end the program."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import typer

if TYPE_CHECKING:
    from specs import BoundTask, Document, TaskSpec

FAILED, BAD_INPUT = 1, 2


def load(
    task: str, tempo: float | None, primitives: list[str] | None
) -> "tuple[TaskSpec, Document]":
    """`read`; every mistake ends here, with code 2."""
    from specs import SpecError

    try:
        return read(task, tempo, classes(primitives))
    except SpecError as problem:
        refuse(problem)


def read(task: str, tempo: float | None, kinds: "list[type]") -> "tuple[TaskSpec, Document]":
    """Read a task; a tempo given on the command line replaces its own."""
    from specs import load_task, with_tempo

    spec, document = load_task(task, primitives=kinds)
    return (spec if tempo is None else with_tempo(spec, tempo)), document


def bind(
    task: str,
    body: str,
    tempo: float | None,
    primitives: list[str] | None,
    *,
    limits: bool = True,
    contacts: bool = True,
    controller: str | None = None,
) -> "BoundTask":
    """Read a task and bind it to a body; every mistake in either ends here, with code 2."""
    from sim import BodyError
    from specs import SpecError, bind_task, find_body, with_controller

    spec, document = load(task, tempo, primitives)
    try:
        if controller is not None:
            spec = with_controller(spec, controller)
        on = find_body(body, limits=limits, contacts=contacts)
        return bind_task(spec, on, document)
    except (BodyError, SpecError) as problem:
        refuse(problem)


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


def refuse(problem: Exception | str) -> NoReturn:
    """One clear message, exit code 2; the line of the file that it is about stands below it."""
    typer.echo(f"adonis: {problem}", err=True)
    if excerpt := getattr(problem, "excerpt", ""):
        typer.echo(excerpt, err=True)
    sys.exit(BAD_INPUT)

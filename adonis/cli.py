"""The command line: `adonis run`, `check`, `graph`, `list`, `compare`, `trials`, `bench`."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from adonis.options import (
    INTERRUPTED,
    AfreshOption,
    BodyOption,
    Commands,
    Format,
    PrimitivesOption,
    Start,
    TaskArgument,
    TempoOption,
    WaysOption,
)
from adonis.teaching import ExplainOption, print_explanation, translate, words

if TYPE_CHECKING:
    from specs import BoundTask, Document, TaskSpec

FAILED, BAD_INPUT = 1, 2


app = typer.Typer(
    cls=Commands,
    help="Compose motor primitives on articulated bodies: describe a movement, watch it done.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.command()
def run(
    task: TaskArgument,
    body: BodyOption = "adonis",
    out: Annotated[
        str | None,
        typer.Option(
            "--out", metavar="DIR", help="Folder for the results.", show_default="runs/TASK"
        ),
    ] = None,
    video: Annotated[bool, typer.Option("--video", help="Render an MP4 as well.")] = False,
    tempo: TempoOption = None,
    start: Annotated[
        Start, typer.Option("--start", help="Begin at home or in a random posture of the arms.")
    ] = Start.home,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of all that is random.")] = 0,
    primitives: PrimitivesOption = None,
    limits: Annotated[
        bool, typer.Option("--limits/--no-limits", help="Joint limits; the 1998 paper had none.")
    ] = True,
    contacts: Annotated[
        bool, typer.Option("--contacts/--no-contacts", help="Self-collision; the paper had none.")
    ] = True,
    controller: Annotated[
        str | None,
        typer.Option(
            "--controller", metavar="NAME", help="Let this controller move every sub-task."
        ),
    ] = None,
    send: Annotated[
        list[str] | None,
        typer.Option("--send", metavar="EVENT@SECONDS", help="Send an event; may be repeated."),
    ] = None,
    afresh: AfreshOption = False,
) -> None:
    """Do a task, and say how well it went.

    Writes into DIR: recording.npz, model.xml, task.yaml, report.json, filmstrip.png and plots.
    Ends with 0 if every sub-task succeeded, 1 if not, 2 if the input makes no sense.

    [dim]adonis run macarena --video[/dim]
    """
    from rich.console import Console
    from rich.markup import escape

    console = Console()
    wished = _path("--out", out)
    bound = _bind(
        task, body, tempo, primitives, limits=limits, contacts=contacts, controller=controller
    )
    from adonis.dancing import Stopped, random_start
    from adonis.errors import InputError, OutputError
    from adonis.performing import events_of, perform, perform_rehearsal
    from adonis.showing import print_results
    from sim import SimError

    if bound.spec.rehearse:
        bound, _ = perform_rehearsal(console, bound, seed=seed, afresh=afresh)
    spec = bound.spec
    folder = wished or Path("runs") / spec.task
    begin = random_start(bound.body, bound.start, 1, seed) if start is Start.random else None
    try:
        events = events_of(send or (), bound.events)
        results, stopped = perform(
            console, bound, folder, start=begin, seed=seed, video=video, events=events
        )
    except (InputError, OutputError, SimError, Stopped) as problem:
        if isinstance(problem, Stopped) and problem.interrupted:
            raise KeyboardInterrupt from None
        _refuse(problem)
    print_results(console, results.judgement, spec.title or spec.task)
    for notice in results.notices:
        console.print(f"[yellow]{escape(notice)}[/yellow]", soft_wrap=True)
    written = ", ".join(path.name for path in results.files.values())
    console.print(f"Results are in [bold]{escape(str(folder))}[/bold]: {written}", soft_wrap=True)
    if stopped is not None:
        console.print(f"[red]stopped:[/red] {escape(str(stopped))}", soft_wrap=True)
        raise typer.Exit(INTERRUPTED if stopped.interrupted else FAILED)
    raise typer.Exit(0 if results.judgement.success else FAILED)


@app.command()
def rehearse(
    task: TaskArgument,
    out: WaysOption = None,
    body: BodyOption = "adonis",
    tempo: TempoOption = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the ways tried.")] = 0,
    primitives: PrimitivesOption = None,
    afresh: AfreshOption = False,
) -> None:
    """Find ways round the body for hands that are only told where to go, and write them down.

    Ends with 0 if every way that was needed passes, 1 if not, 2 if the input makes no sense.
    """
    from rich.console import Console

    from adonis.errors import OutputError
    from adonis.performing import perform_rehearsal
    from adonis.rehearsal.keeping import task_text
    from adonis.reporting import prepare_file, write_text
    from adonis.showing import print_rehearsal
    from specs import find_task

    console, wished = Console(), _path("--out", out)
    bound = _bind(task, body, tempo, primitives)
    file = wished or Path(f"{bound.spec.task}-rehearsed.yaml")
    try:
        prepare_file(file)
        bound, found = perform_rehearsal(console, bound, seed=seed, afresh=afresh)
        write_text(file, task_text(bound.spec, found, find_task(task).read_text()))
    except OutputError as problem:
        _refuse(problem)
    print_rehearsal(console, found, file)
    raise typer.Exit(0 if all(way.grade.passes for way in found.values()) else FAILED)


@app.command()
def check(
    task: TaskArgument,
    body: BodyOption = "adonis",
    tempo: TempoOption = None,
    primitives: PrimitivesOption = None,
    explain: ExplainOption = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the findings for tools.")] = False,
) -> None:
    """Find what is wrong or doubtful in a task, without simulating a single step.

    Reads it, binds every name to the body, prints when each sub-task is planned, and what would
    go wrong: goals out of reach, too little time, collisions on the way, and more.
    Ends with 2 if the task makes no sense, 1 if there is an error, 0 if at most warnings.
    """
    from adonis.linting import findings_json, print_findings, print_plan
    from sim import BodyError, load_body
    from specs import SpecError, bind_task, lint_task, refusal

    if explain and not as_json:
        print_explanation(task)
    classes = _classes(primitives)
    try:
        spec, document = _read(task, tempo, classes)
        bound = bind_task(spec, load_body(body), document)
    except (BodyError, SpecError) as problem:
        if as_json and isinstance(problem, SpecError):
            typer.echo(findings_json([refusal(problem)]))
            sys.exit(BAD_INPUT)
        _refuse(problem)
    found = lint_task(bound, document)
    if as_json:
        typer.echo(findings_json(found, spec.task, body))
    else:
        from rich.console import Console

        console = Console()
        print_plan(console, bound)
        print_findings(console, found)
    raise typer.Exit(FAILED if any(f.severity == "error" for f in found) else 0)


@app.command()
def graph(
    task: TaskArgument,
    style: Annotated[Format, typer.Option("--format", help="How to print it.")] = Format.mermaid,
    body: BodyOption = "adonis",
    tempo: TempoOption = None,
    primitives: PrimitivesOption = None,
) -> None:
    """Print the task graph, or a timeline of it; TASK may be the folder of a run.

    JSON carries the whole task: `adonis run` takes it like a task file.
    """
    from adonis.graphing import print_graph
    from sim import SimError
    from specs import SpecError

    try:
        print_graph(task, style.value, body, tempo, _classes(primitives))
    except (SimError, SpecError) as problem:
        _refuse(problem)


@app.command("list")
def list_all(primitives: PrimitivesOption = None) -> None:
    """List the tasks of the library, the bodies and the primitives."""
    from rich.console import Console

    from adonis.catalogue import print_catalogue
    from specs import SpecError, available_primitives

    try:
        kinds = available_primitives(_classes(primitives))
    except SpecError as problem:
        _refuse(problem)
    print_catalogue(Console(), kinds)


@app.command()
def trials(
    task: TaskArgument,
    out: Annotated[
        str | None,
        typer.Option(
            "--out", metavar="DIR", help="Folder for the table.", show_default="runs/TASK-trials"
        ),
    ] = None,
    starts: Annotated[int, typer.Option(min=0, help="How many random start postures.")] = 20,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the start postures.")] = 0,
    threads: Annotated[int, typer.Option(min=1, help="Threads of the physics.")] = 2,
    primitives: PrimitivesOption = None,
) -> None:
    """Do a task under other conditions: tempo, body, start posture, a push.

    Prints how many of its sub-tasks succeed in each, and ends with 0 only if all do.
    """
    from rich.console import Console

    from adonis.errors import OutputError
    from adonis.trials import print_trials, run_trials, write_trials
    from sim import SimError
    from specs import SpecError

    console = Console()
    wished = _path("--out", out)
    spec, document = _load(task, None, primitives)
    folder = wished or Path("runs") / f"{spec.task}-trials"
    try:
        with console.status("starting") as status:
            rows = run_trials(
                spec, document, starts=starts, seed=seed, threads=threads, progress=status.update
            )
        write_trials(rows, folder)
    except (OutputError, SimError, SpecError) as problem:
        _refuse(problem)
    print_trials(console, rows)
    console.print(f"Results are in [bold]{folder}[/bold]: trials.json, trials.md", soft_wrap=True)
    raise typer.Exit(0 if all(r.success for r in rows) else FAILED)


@app.command()
def compare(
    task: TaskArgument,
    controllers: Annotated[
        str | None,
        typer.Option(
            "--controllers",
            metavar="NAMES",
            help="Who dances, separated by commas; `combined` is the task as it is written.",
            show_default="pd-servo,torque-field,impedance,combined",
        ),
    ] = None,
    body: BodyOption = "adonis",
    human: Annotated[
        str | None,
        typer.Option(
            "--human", metavar="CSV", help="Figures of a human doing it (see docs/results.md)."
        ),
    ] = None,
    out: Annotated[
        str | None,
        typer.Option(
            "--out", metavar="DIR", help="Folder for the report.", show_default="runs/TASK-compared"
        ),
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Leave out timings, the paper's claims, least squares.")
    ] = False,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Written into recordings.")] = 0,
    primitives: PrimitivesOption = None,
) -> None:
    """Let one controller after another do a task, and measure them all.

    Writes into DIR: report.html, which needs nothing beside it, its figures as SVG and PNG,
    measures.csv, comparison.json and the recordings. Of the Macarena it also says which of the
    1998 paper's claims are reproduced. A file TASK-CONTROLLER.yaml beside the task is taken for
    that controller; else every sub-task is given to it as it stands.

    [dim]adonis compare macarena[/dim]
    """
    from adonis.comparison.comparing import DANCERS
    from adonis.comparison.human import known_human, load_human
    from adonis.dancing import Stopped
    from adonis.errors import InputError, OutputError
    from adonis.performing import perform_comparison
    from sim import SimError, load_body
    from specs import SpecError

    spec, _ = _load(task, None, primitives)
    names = DANCERS if controllers is None else tuple(n.strip() for n in controllers.split(","))
    wished = _path("--out", out)
    try:
        perform_comparison(
            task,
            load_body(body),
            wished or Path("runs") / f"{spec.task}-compared",
            dancers=names,
            human=known_human(spec.task) if human is None else load_human(human),
            quick=quick,
            seed=seed,
            primitives=_classes(primitives),
        )
    except Stopped as problem:
        if problem.interrupted:
            raise KeyboardInterrupt from None
        _refuse(problem)
    except (InputError, OutputError, SimError, SpecError) as problem:
        _refuse(problem)


@app.command()
def bench(
    out: Annotated[
        str | None, typer.Option("--out", metavar="FILE", help="Write the JSON here as well.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer repetitions.")] = False,
) -> None:
    """Measure what control costs on top of bare physics; prints JSON."""
    import json

    from adonis.bench import measure
    from adonis.errors import OutputError
    from adonis.reporting import prepare_file, write_text

    file = _path("--out", out)
    try:
        if file is not None:
            prepare_file(file)
        figures = json.dumps(
            measure(quick=quick, tell=lambda said: typer.echo(said, err=True)), indent=2
        )
        typer.echo(figures)
        if file is not None:
            write_text(file, figures + "\n")
    except OutputError as problem:
        _refuse(problem)


for command in (translate, words):
    app.command()(command)


def main() -> None:
    """Entry point: rendering has a process of its own, this one needs no OpenGL."""
    wished = os.environ.get("MUJOCO_GL")
    if wished and wished != "disable":
        os.environ["ADONIS_GL"] = wished
    os.environ["MUJOCO_GL"] = "disable"
    app()


def _load(
    task: str, tempo: float | None, primitives: list[str] | None
) -> "tuple[TaskSpec, Document]":
    """`_read`; every mistake ends here, with code 2."""
    from specs import SpecError

    try:
        return _read(task, tempo, _classes(primitives))
    except SpecError as problem:
        _refuse(problem)


def _read(task: str, tempo: float | None, classes: "list[type]") -> "tuple[TaskSpec, Document]":
    """Read a task; a tempo given on the command line replaces its own."""
    from specs import load_task, with_tempo

    spec, document = load_task(task, primitives=classes)
    return (spec if tempo is None else with_tempo(spec, tempo)), document


def _bind(
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
    from sim import BodyError, load_body
    from specs import SpecError, bind_task, with_controller

    spec, document = _load(task, tempo, primitives)
    try:
        if controller is not None:
            spec = with_controller(spec, controller)
        on = load_body(body, limits=limits, contacts=contacts)
        return bind_task(spec, on, document)
    except (BodyError, SpecError) as problem:
        _refuse(problem)


def _classes(files: list[str] | None) -> "list[type]":
    from specs import SpecError, primitives_in

    found: list[type] = []
    for name in files or ():
        is_module = all(part.isidentifier() for part in name.split("."))
        is_data = Path(name).is_file() or Path(name).suffix in (".yaml", ".yml")
        if Path(name).suffix != ".py" and (is_data or not is_module):
            _refuse(f"--primitives: expected a .py file or a module, not {name!r}")
        try:
            found += primitives_in(name)
        except SpecError as problem:
            _refuse(problem)
        except SystemExit as problem:
            _refuse(f"{name}: cannot be imported: it ends the program (code {problem.code})")
    return found


def _path(option: str, given: str | None) -> Path | None:
    """The path that an option names; an empty one is a mistake, not the present folder."""
    if given is not None and not given.strip():
        _refuse(f"{option}: expected a path, not {given!r}")
    return None if given is None else Path(given)


def _refuse(problem: Exception | str) -> NoReturn:
    """One clear message, exit code 2."""
    typer.echo(f"adonis: {problem}", err=True)
    sys.exit(BAD_INPUT)

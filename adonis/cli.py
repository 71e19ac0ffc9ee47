"""The command line: one function for each command of `adonis`."""

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from adonis.commands import BAD_INPUT, FAILED, INTERRUPTED, Commands, Format, Start, Written

if TYPE_CHECKING:
    from specs import BoundTask, Document, TaskSpec

app = typer.Typer(
    cls=Commands,
    help="Compose motor primitives on articulated bodies: describe a movement, watch it done.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

TaskArgument = Annotated[
    str, typer.Argument(metavar="TASK", help="A task of the library (see `adonis list`) or a file.")
]
BodyOption = Annotated[str, typer.Option("--body", metavar="NAME", help="Body that does it.")]
TempoOption = Annotated[
    float | None,
    typer.Option("--tempo", metavar="BPM", help="Beats per minute instead of the task's own."),
]
PrimitivesOption = Annotated[
    list[str] | None,
    typer.Option(
        "--primitives",
        metavar="FILE",
        help="Python file (or module) whose primitives the task may use; may be repeated.",
    ),
]


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
    from adonis.errors import OutputError
    from adonis.performing import perform
    from adonis.showing import print_results
    from sim import SimError

    spec = bound.spec
    folder = wished or Path("runs") / spec.task
    begin = random_start(bound.body, bound.start, 1, seed) if start is Start.random else None
    try:
        results, stopped = perform(console, bound, folder, start=begin, seed=seed, video=video)
    except (OutputError, SimError, Stopped) as problem:
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
def check(
    task: TaskArgument,
    body: BodyOption = "adonis",
    tempo: TempoOption = None,
    primitives: PrimitivesOption = None,
) -> None:
    """Find what is wrong with a task, without simulating it.

    Reads it, binds every name to the body, orders it, and prints when each sub-task is planned.
    Ends with 0 if nothing is wrong, 1 if a goal cannot be reached, 2 if the task makes no sense.
    """
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from specs import doubts

    bound = _bind(task, body, tempo, primitives)
    spec, graph = bound.spec, bound.graph
    table = Table(title=escape(spec.title or spec.task), title_justify="left")
    for heading, justify in (("", "right"), ("sub-task", "left"), ("primitive", "left"),
                             ("moves", "left"), ("from", "right"), ("to", "right")):  # fmt: skip
        table.add_column(heading, justify=justify)  # type: ignore[arg-type]
    depends = any(s.circumstances for s in spec.subtasks)
    if depends:
        table.add_column("if, while, until")
    for number, name in enumerate(graph.order, start=1):
        does, (start, end) = graph.subtasks[name].does, graph.planned[name]
        moves = getattr(does, "limb", None) or ", ".join(getattr(does, "joints", None) or ())
        more = (escape(graph.subtasks[name].circumstances),) if depends else ()
        times = f"{start:.2f}", f"{end:.2f} s"
        table.add_row(str(number), name, does.kind, moves.replace("_", " "), *times, *more)
    console = Console()
    console.print(table)
    beside = ", ".join(f"{b.name} ({b.does.kind})" for b in spec.background) or "nothing"
    console.print(f"Beside them: {beside}.", soft_wrap=True)
    console.print(
        f"{len(graph.order)} sub-tasks, {graph.duration:.2f} s at {spec.tempo:g} beats per"
        f" minute on {bound.body.map.name}.",
        soft_wrap=True,
    )
    found = doubts(bound)
    for doubt in found:
        console.print(f"[yellow]{escape(doubt)}[/yellow]", soft_wrap=True)
    if found:
        raise typer.Exit(FAILED)
    console.print("Nothing wrong was found.")


@app.command()
def graph(
    task: TaskArgument,
    style: Annotated[Format, typer.Option("--format", help="How to print it.")] = Format.mermaid,
    tempo: TempoOption = None,
    primitives: PrimitivesOption = None,
) -> None:
    """Print the task graph."""
    from specs import SpecError, build_graph, to_dot, to_json, to_mermaid

    spec, document = _load(task, tempo, primitives)
    try:
        made = build_graph(spec, document)
    except SpecError as problem:
        _refuse(problem)
    printers = {Format.mermaid: to_mermaid, Format.dot: to_dot, Format.json: to_json}
    typer.echo(printers[style](made), nl=False)


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
def schema(
    style: Annotated[Written, typer.Option("--format", help="How to print it.")] = Written.json,
    primitives: PrimitivesOption = None,
) -> None:
    """Print the JSON Schema of task files, with which an editor completes and checks them.

    The comment [bold]# yaml-language-server: $schema=FILE[/bold] at the top of a task tells it to.
    """
    from specs import SHIPPED_SCHEMA, SpecError, reference, task_schema

    try:
        made = task_schema(_classes(primitives))
    except SpecError as problem:
        _refuse(problem)
    if style is Written.markdown:
        typer.echo(reference(made), nl=False)
        return
    typer.echo(json.dumps(made, indent=1, ensure_ascii=False))
    file = "task.schema.json" if primitives else SHIPPED_SCHEMA
    typer.echo(f"In a task: # yaml-language-server: $schema={file}", err=True)


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
    """Read a task; a tempo given on the command line replaces its own."""
    from specs import SpecError, load_task, with_tempo

    try:
        spec, document = load_task(task, primitives=_classes(primitives))
        return (spec if tempo is None else with_tempo(spec, tempo)), document
    except SpecError as problem:
        _refuse(problem)


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
    """One clear message, exit code 2; the line of the file that it is about stands below it."""
    typer.echo(f"adonis: {problem}", err=True)
    if excerpt := getattr(problem, "excerpt", ""):
        typer.echo(excerpt, err=True)
    sys.exit(BAD_INPUT)

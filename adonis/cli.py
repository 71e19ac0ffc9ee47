"""The command line: one function for each command of `adonis`."""

import json
import os
from pathlib import Path
from typing import Annotated

import typer

from adonis.arguments import (
    FAILED,
    bind,
    bind_as_far,
    classes,
    given_path,
    load,
    refuse,
)
from adonis.body_commands import body_app
from adonis.characters import adapt
from adonis.options import (
    INTERRUPTED,
    AfreshOption,
    BestEffortOption,
    BodyOption,
    Commands,
    ForgetOption,
    Format,
    MorphOption,
    PrimitivesOption,
    SetOption,
    Start,
    TaskArgument,
    TempoOption,
    WaysOption,
    Written,
)
from adonis.studies import bench, compare, trials
from adonis.teaching import ExplainOption, print_explanation, translate, words

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
    body: BodyOption = None,
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
    morph: MorphOption = None,
    best_effort: BestEffortOption = False,
    forget_ways: ForgetOption = False,
    changes: SetOption = None,
) -> None:
    """Do a task, and say how well it went.

    Writes into DIR: recording.npz, model.xml, task.yaml, report.json, filmstrip.png and plots.
    Ends with 0 if every sub-task succeeded, 1 if not, 2 if the input makes no sense.

    [dim]adonis run macarena --video[/dim]
    """
    from rich.console import Console
    from rich.markup import escape

    console = Console()
    wished = given_path("--out", out)
    bound, effort = bind_as_far(
        task, body, tempo, primitives, limits=limits, contacts=contacts, controller=controller,
        best_effort=best_effort, forget_ways=forget_ways, changes=changes or (),
    )  # fmt: skip
    from adonis.dancing import Stopped, random_start
    from adonis.errors import InputError, OutputError
    from adonis.performing import events_of, perform, perform_morph, perform_rehearsal
    from adonis.showing import print_results
    from sim import SimError
    from specs import SpecError

    if bound.spec.rehearse:
        bound, _ = perform_rehearsal(console, bound, seed=seed, afresh=afresh)
    spec = bound.spec
    folder = wished or Path("runs") / spec.task
    begin = random_start(bound.body, bound.start, 1, seed) if start is Start.random else None
    try:
        events = events_of(send or (), bound.events)
        becoming = (
            perform_morph(console, bound, morph, limits=limits, contacts=contacts) if morph else ()
        )
        results, stopped = perform(
            console, bound, folder, start=begin, seed=seed, video=video, events=events,
            becoming=becoming, effort=effort,
        )  # fmt: skip
    except (InputError, OutputError, SimError, SpecError, Stopped) as problem:
        if isinstance(problem, Stopped) and problem.interrupted:
            raise KeyboardInterrupt from None
        refuse(problem)
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
    body: BodyOption = None,
    tempo: TempoOption = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the ways tried.")] = 0,
    primitives: PrimitivesOption = None,
    afresh: AfreshOption = False,
    forget_ways: ForgetOption = False,
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
    from specs import find_task, fit_of

    console, wished = Console(), given_path("--out", out)
    bound = bind(task, body, tempo, primitives, forget_ways=forget_ways)
    scaled = fit_of(load(task, primitives)[0], bound.body)
    file = wished or Path(f"{bound.spec.task}-rehearsed.yaml")
    try:
        prepare_file(file)
        bound, found = perform_rehearsal(console, bound, seed=seed, afresh=afresh)
        size = 1.0 if scaled is None else scaled.like.length
        write_text(file, task_text(bound.spec, found, find_task(task).read_text(), size))
    except OutputError as problem:
        refuse(problem)
    print_rehearsal(console, found, file)
    raise typer.Exit(0 if all(way.grade.passes for way in found.values()) else FAILED)


@app.command()
def check(
    task: TaskArgument,
    body: BodyOption = None,
    tempo: TempoOption = None,
    primitives: PrimitivesOption = None,
    explain: ExplainOption = False,
    changes: SetOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the findings for tools.")] = False,
) -> None:
    """Find what is wrong or doubtful in a task, without simulating a single step.

    Reads it, binds every name to the body, prints when each sub-task is planned, and what would
    go wrong: goals out of reach, too little time, collisions on the way, and more. For another
    body than the task's own it says of each sub-task whether that body can do it.
    Ends with 2 if the task makes no sense, 1 if there is an error, 0 if at most warnings.
    """
    from adonis.linting import check_task

    if explain and not as_json:
        print_explanation(task)
    raise typer.Exit(
        check_task(
            task,
            body,
            tempo,
            classes(primitives),
            changes or (),
            as_json=as_json,
            explained=explain,
        )
    )


@app.command()
def graph(
    task: TaskArgument,
    style: Annotated[Format, typer.Option("--format", help="How to print it.")] = Format.mermaid,
    body: BodyOption = None,
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
        print_graph(task, style.value, body, tempo, classes(primitives))
    except (SimError, SpecError) as problem:
        refuse(problem)


@app.command("list")
def list_all(primitives: PrimitivesOption = None) -> None:
    """List the tasks of the library, the bodies and the primitives."""
    from rich.console import Console

    from adonis.catalogue import print_catalogue
    from specs import SpecError, available_primitives

    try:
        kinds = available_primitives(classes(primitives))
    except SpecError as problem:
        refuse(problem)
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
        made = task_schema(classes(primitives))
    except SpecError as problem:
        refuse(problem)
    if style is Written.markdown:
        typer.echo(reference(made), nl=False)
        return
    typer.echo(json.dumps(made, indent=1, ensure_ascii=False))
    file = "task.schema.json" if primitives else SHIPPED_SCHEMA
    typer.echo(f"In a task: # yaml-language-server: $schema={file}", err=True)


for command in (translate, words, adapt, trials, compare, bench):
    app.command()(command)
app.add_typer(body_app, name="body")


def main() -> None:
    """Entry point: rendering has a process of its own, this one needs no OpenGL."""
    wished = os.environ.get("MUJOCO_GL")
    if wished and wished != "disable":
        os.environ["ADONIS_GL"] = wished
    os.environ["MUJOCO_GL"] = "disable"
    app()

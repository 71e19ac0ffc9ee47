"""The commands that measure: `adonis trials`, `compare`, `bench`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from adonis.arguments import FAILED, classes, given_path, load, refuse, whose
from adonis.options import BodyOption, PrimitivesOption, TaskArgument


def trials(
    task: TaskArgument,
    body: BodyOption = None,
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
    from specs import SpecError, find_body

    console = Console()
    wished = given_path("--out", out)
    spec, document = load(task, primitives)
    folder = wished or Path("runs") / f"{spec.task}-trials"
    try:
        with console.status("starting") as status:
            rows = run_trials(
                spec,
                document,
                body=find_body(whose(spec, body)),
                starts=starts,
                seed=seed,
                threads=threads,
                progress=status.update,
            )
        write_trials(rows, folder)
    except (OutputError, SimError, SpecError) as problem:
        refuse(problem)
    print_trials(console, rows)
    console.print(f"Results are in [bold]{folder}[/bold]: trials.json, trials.md", soft_wrap=True)
    raise typer.Exit(0 if all(r.success for r in rows) else FAILED)


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
    body: BodyOption = None,
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
    from sim import SimError
    from specs import SpecError, find_body

    spec, _ = load(task, primitives)
    names = DANCERS if controllers is None else tuple(n.strip() for n in controllers.split(","))
    wished = given_path("--out", out)
    try:
        perform_comparison(
            task,
            find_body(whose(spec, body)),
            wished or Path("runs") / f"{spec.task}-compared",
            dancers=names,
            human=known_human(spec.task) if human is None else load_human(human),
            quick=quick,
            seed=seed,
            primitives=classes(primitives),
        )
    except Stopped as problem:
        if problem.interrupted:
            raise KeyboardInterrupt from None
        refuse(problem)
    except (InputError, OutputError, SimError, SpecError) as problem:
        refuse(problem)


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

    file = given_path("--out", out)
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
        refuse(problem)

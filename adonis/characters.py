"""The commands about other characters: `adonis adapt`."""

from pathlib import Path
from typing import Annotated

import typer

from adonis.arguments import FAILED, given_path, load, refuse
from adonis.options import PrimitivesOption, TaskArgument, TempoOption

BUDGET = 120


def adapt(
    task: TaskArgument,
    to: Annotated[str, typer.Option("--to", metavar="NAME", help="Body that is to do it.")],
    source: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="NAME",
            help="Body that it was made for.",
            show_default="the task's own, else adonis",
        ),
    ] = None,
    out: Annotated[
        str | None,
        typer.Option("--out", metavar="FILE", help="The task.", show_default="TASK-NAME.yaml"),
    ] = None,
    tempo: TempoOption = None,
    budget: Annotated[
        int, typer.Option("--budget", min=1, help="How many candidates are danced, at most.")
    ] = BUDGET,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the candidates.")] = 0,
    primitives: PrimitivesOption = None,
    afresh: Annotated[
        bool, typer.Option("--afresh", help="Search again, even if it was begun before.")
    ] = False,
) -> None:
    """Make a task suit another body: by the laws of scaling, then by a small search.

    Prints the factors, what was tuned and what changed, and writes the task; comments stay.
    A search that is interrupted goes on where it was. With --tempo, time is not searched for.
    Ends with 0 if everything succeeds in the end, 1 if not, 2 if the input makes no sense.

    [dim]adonis adapt macarena --to adonis-giant --tempo 103[/dim]
    """
    from rich.console import Console

    from adonis.adapting.performing import perform_adaptation
    from adonis.adapting.showing import print_difference, print_found, print_laws
    from adonis.adapting.writing import adapted_text, difference
    from adonis.errors import OutputError
    from adonis.reporting import prepare_file, write_text
    from sim import BodyError, likeness, load_body
    from specs import SpecError, find_task, fitted

    console, wished = Console(), given_path("--out", out)
    spec, document = load(task, primitives)
    if None not in (source, spec.body) and source != spec.body:
        refuse(f"--from {source}: {spec.task} is written for {spec.body}")
    written = spec.model_copy(update={"body": source or spec.body or "adonis"})
    file = wished or Path(f"{spec.task}-{to.replace(':', '-')}.yaml")
    try:
        one, other = load_body(written.body or ""), load_body(to)
        begun = fitted(written, other, document, tempo=tempo)
        prepare_file(file)
        print_laws(console, likeness(one, other), one, other)
        made = perform_adaptation(
            console, begun, other, budget=budget, seed=seed, keep_tempo=tempo is not None,
            afresh=afresh,
        )  # fmt: skip
        text = find_task(task).read_text()
        after = adapted_text(spec, made.spec, text)
        write_text(file, after)
    except (BodyError, OutputError, SpecError) as problem:
        refuse(problem)
    print_difference(console, difference(text, after, task, str(file)))
    print_found(console, made.found)
    console.print(f"The task is in [bold]{file}[/bold]", soft_wrap=True)
    raise typer.Exit(0 if made.found.mark.failures == 0 else FAILED)

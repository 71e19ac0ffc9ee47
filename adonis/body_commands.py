"""The commands `adonis body new` and `adonis body check`."""

from pathlib import Path
from typing import Annotated

import typer

from adonis.arguments import FAILED, given_path, refuse
from adonis.options import Commands

body_app = typer.Typer(
    cls=Commands,
    help="Bring a model of your own: a body file says what its parts are called in anatomy.",
    no_args_is_help=True,
)


@body_app.command()
def new(
    model: Annotated[str, typer.Argument(metavar="MODEL", help="A model in URDF or MJCF.")],
    out: Annotated[
        str | None,
        typer.Option(
            "--out", metavar="FILE", help="The body file.", show_default="NAME.body.yaml here"
        ),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option("--name", help="What the body is called.", show_default="after MODEL"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Write over a file that exists.")] = False,
) -> None:
    """Propose a body file for somebody's model, and draw it.

    Finds trunk, arms, head and hands, names the joints, places landmarks, and writes NAME.body.yaml
    with everything that is guessed marked, and NAME.body.png with the landmarks drawn. The model is
    not changed. Look at the picture, mend the file, then `adonis body check`.
    """
    from rich.console import Console

    from adonis.bodies import propose_and_write
    from adonis.errors import OutputError
    from sim import BodyError
    from specs import SpecError

    try:
        propose_and_write(Console(), Path(model), given_path("--out", out), name=name, force=force)
    except (BodyError, OutputError, SpecError) as problem:
        refuse(problem)


@body_app.command()
def check(
    body: Annotated[
        str, typer.Argument(metavar="BODY", help="A body file, or a body of the package.")
    ],
    picture: Annotated[
        str | None, typer.Option("--picture", metavar="PNG", help="Draw it, with its landmarks.")
    ] = None,
) -> None:
    """Say what a body is made of, what it lacks for tasks, and what that costs.

    Ends with 0 if it lacks nothing, 1 if something, 2 if the file makes no sense.
    """
    from rich.console import Console

    from adonis.bodies import check_body
    from adonis.errors import OutputError
    from specs import SpecError

    try:
        whole = check_body(Console(), body, given_path("--picture", picture))
    except (OutputError, SpecError) as problem:
        refuse(problem)
    raise typer.Exit(0 if whole else FAILED)

"""What the commands of the command line share: what they ask for, and how Ctrl-C ends them."""

import sys
from enum import StrEnum
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

INTERRUPTED = 130  # the exit code that shells use

TaskArgument = Annotated[
    str, typer.Argument(metavar="TASK", help="A task of the library (see `adonis list`) or a file.")
]
BodyOption = Annotated[
    str | None,
    typer.Option(
        "--body",
        metavar="BODY",
        help="Body that does it: a name of `adonis list` or a body file.",
        show_default="the task's own, else adonis",
    ),
]
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
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Another value in the task, such as tempo=90 or scene.table.at='[0.5, 0, 1]';"
        " may be repeated.",
    ),
]
WaysOption = Annotated[
    str | None,
    typer.Option(
        "--out", metavar="FILE", help="The task with its ways.", show_default="TASK-rehearsed.yaml"
    ),
]
MorphOption = Annotated[
    str | None,
    typer.Option(
        "--morph", metavar="NAME", help="Become this person meanwhile, who is there in the end."
    ),
]
BestEffortOption = Annotated[
    bool,
    typer.Option(
        "--best-effort", help="Where the body cannot do as it is told, do the nearest it can."
    ),
]
ForgetOption = Annotated[
    bool,
    typer.Option(
        "--forget-ways",
        help="Rehearse every touch, as if the task said nothing of ways: for another body.",
    ),
]
AfreshOption = Annotated[
    bool, typer.Option("--afresh", help="Look for ways again, even if they are known from before.")
]


class Start(StrEnum):
    """Where a run begins."""

    home = "home"
    random = "random"


class Format(StrEnum):
    """How a graph is printed."""

    mermaid = "mermaid"
    dot = "dot"
    graphml = "graphml"
    json = "json"
    timeline = "timeline"


class Commands(TyperGroup):
    """The commands; Ctrl-C ends any of them with one word and the code that shells use."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was asked for."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            typer.echo("adonis: interrupted", err=True)
            sys.exit(INTERRUPTED)


class Written(StrEnum):
    """How a schema is printed."""

    json = "json"
    markdown = "markdown"

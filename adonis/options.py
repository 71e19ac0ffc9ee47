"""What several commands of the command line ask for."""

from enum import StrEnum
from typing import Annotated

import typer

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
    json = "json"

"""What the commands of the command line are made of: how they end, and what options can be."""

import sys
from enum import StrEnum
from typing import Any

import typer
from typer.core import TyperGroup

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130


class Commands(TyperGroup):
    """The commands; Ctrl-C ends any of them with one word and the code that shells use."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was asked for."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            typer.echo("adonis: interrupted", err=True)
            sys.exit(INTERRUPTED)


class Start(StrEnum):
    """Where a run begins."""

    home = "home"
    random = "random"


class Format(StrEnum):
    """How a graph is printed."""

    mermaid = "mermaid"
    dot = "dot"
    json = "json"


class Written(StrEnum):
    """How a schema is printed."""

    json = "json"
    markdown = "markdown"

"""What can go wrong on this floor.

SpecError   a task that cannot be read, makes no sense, or does not fit a body
"""

from dataclasses import dataclass

WIDEST = 100  # characters of a line that an excerpt shows


@dataclass(frozen=True, slots=True)
class Position:
    """A place in a file, counted from 1."""

    line: int
    column: int
    file: str = ""  # "": the file of the task itself


class SpecError(Exception):
    """One message that says what was given, what was expected, and where it stands.

    Args:
        message: what is wrong.
        file: the file it stands in, if it came from one.
        position: line and column there.
        code: of the kind of finding that it is (`specs.lint.KINDS`).
        excerpt: that line of the file with a mark under the column, see `excerpt_of`.
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        position: Position | None = None,
        code: str = "refused",
        excerpt: str = "",
    ) -> None:
        self.message, self.code = message, code
        self.file = file
        self.line = position.line if position else None
        self.column = position.column if position else None
        self.excerpt = excerpt
        where = file or ""
        if position:
            where += f":{position.line}:{position.column}"
        super().__init__(f"{where}: {message}" if where else message)


def excerpt_of(lines: list[str], position: Position | None) -> str:
    """The line of a file with a mark under the column; of a long line what is around it."""
    if position is None or not 0 < position.line <= len(lines):
        return ""
    text = "".join(c if c.isprintable() else " " for c in lines[position.line - 1])
    first = max(0, min(position.column - WIDEST // 2, len(text) - WIDEST))
    number = f"{position.line:>5}"
    shown = text[first : first + WIDEST].rstrip()
    return f"{number} | {shown}\n      | {' ' * (position.column - 1 - first)}^"

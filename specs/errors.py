"""What can go wrong on this floor.

SpecError   a task that cannot be read, makes no sense, or does not fit a body
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Position:
    """A place in a file, counted from 1."""

    line: int
    column: int


class SpecError(Exception):
    """One message that says what was given, what was expected, and where it stands.

    Args:
        message: what is wrong.
        file: the file it stands in, if it came from one.
        position: line and column there.
        code: of the kind of finding that it is (`specs.lint.KINDS`).
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        position: Position | None = None,
        code: str = "refused",
    ) -> None:
        self.message, self.code = message, code
        self.file = file
        self.line = position.line if position else None
        self.column = position.column if position else None
        where = file or ""
        if position:
            where += f":{position.line}:{position.column}"
        super().__init__(f"{where}: {message}" if where else message)

"""A document put together from parts of others, each of which still knows where it stood."""

from collections.abc import Iterable
from typing import Any

from specs.errors import Position
from specs.reading import DEEPEST, Document, Path_

MOST_PUT_IN = 50_000  # values that fragments and includes may add to what is written


class Assembly:
    """Values by path, with their places.

    Args:
        task: the document of the task itself, which names the file.
    """

    def __init__(self, task: Document) -> None:
        self.task = task
        self.data: dict[str, Any] = {}
        self.positions: dict[Path_, Position] = {}
        self.keys: dict[Path_, Position] = {}
        self.lines = dict(task.lines)
        self._left = len(task.positions) + MOST_PUT_IN

    def document(self) -> Document:
        """The whole."""
        task = self.task
        return Document(self.data, task.file, self.positions, self.keys, self.lines, task.folder)

    def mark(self, source: Document, old: Path_, new: Path_) -> None:
        """What is at the path `new` stood at `old`.

        Raises:
            SpecError: that are too many values.
        """
        self._left -= 1
        if self._left < 0:
            said = f"more than {MOST_PUT_IN} values come from fragments and includes"
            raise source.error(said, old)
        for known, found in ((source.positions, self.positions), (source.keys, self.keys)):
            if old in known:
                found[new] = known[old]

    def mark_all(self, source: Document, old: Path_, new: Path_, value: Any) -> None:
        """The same of a value and everything in it."""
        if len(new) > DEEPEST:
            raise source.error(f"nested deeper than {DEEPEST} levels", old)
        self.mark(source, old, new)
        for key, part in parts(value):
            self.mark_all(source, (*old, key), (*new, key), part)


def parts(value: Any) -> Iterable[tuple[str | int, Any]]:
    """What is in a mapping or a list, by key or index."""
    if isinstance(value, dict):
        return value.items()
    return enumerate(value) if isinstance(value, list) else ()

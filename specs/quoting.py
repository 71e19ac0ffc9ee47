"""Where in a file the word stands that a message is about: the first that it quotes."""

import re
from collections.abc import Collection, Iterable
from typing import Any

from specs.reading import Document, Path_

QUOTED = re.compile("'([^']*)'")


def quoted_place(
    document: Document, path: Path_, message: str, *, apart_from: Collection[str] = ()
) -> tuple[Path_, bool]:
    """Where the first word in quotes of a message stands below a path, and whether as a key.

    Args:
        document: what was read.
        path: below which it is looked for; the answer if it is not there.
        message: that quotes the word.
        apart_from: keys directly below the path under which it is not looked for.
    """
    quoted = QUOTED.search(message)
    inside: Any = document.data
    try:
        for step in path:
            inside = inside[step]
    except (KeyError, IndexError, TypeError):  # what was read is not quite what is meant
        return path, False
    if quoted is None or not isinstance(inside, dict):
        return path, False
    parameters = {key: value for key, value in inside.items() if key not in apart_from}
    return _search(parameters, quoted[1], path) or (path, False)


def _search(inside: object, word: str, path: Path_) -> tuple[Path_, bool] | None:
    """Depth first, in the order of the file."""
    if inside == word:
        return path, False
    items: Iterable[tuple[str | int, object]] = ()
    if isinstance(inside, dict):
        items = inside.items()
    elif isinstance(inside, list):
        items = enumerate(inside)
    for key, value in items:
        if key == word:
            return (*path, key), True
        found = _search(value, word, (*path, key))
        if found:
            return found
    return None

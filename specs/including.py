"""Includes: definitions that several tasks share, from files beside them.

include: [moves.yaml, parts/places.yaml]

An included file has landmarks, postures, fragments and background entries, and may include
others. It lies in the task's own folder or below: a path that leads anywhere else is refused.
"""

from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from sim import unknown
from specs.assembling import Assembly, parts
from specs.errors import SpecError
from specs.reading import MOST_BYTES, Document, Path_, read_text, text_of

NAMED = ("landmarks", "postures", "fragments")  # each of them names to definitions
LISTED = ("background",)
KEYS = ("include", *NAMED, *LISTED)  # of an included file
MOST_FILES = 100


def include(document: Document) -> Document:
    """A document with everything that it includes, which comes before what it has itself.

    Raises:
        SpecError: a file that is not below the task's folder, is not there, includes itself,
            or defines what is defined already.
    """
    if not isinstance(document.data, dict) or "include" not in document.data:
        return document
    whole = _Including(document)
    whole.gather(document, (whole.own,))
    for key, value in document.data.items():
        if key not in KEYS:
            whole.made.data[key] = value
            whole.made.mark_all(document, (key,), (key,), value)
    return whole.made.document()


class _Including:
    """Gathers what a task and its includes define."""

    def __init__(self, task: Document) -> None:
        self.made = Assembly(task)
        self.top = task.folder
        self.own = (task.folder or Path()) / Path(task.file).name
        self.known: set[Path] = set()
        self.bytes = 0

    def gather(self, document: Document, around: tuple[Path, ...]) -> None:
        """Take the definitions of a document, after those that it includes."""
        self.made.lines.update(document.lines)
        asked = document.data.get("include", [])
        if not isinstance(asked, list):
            raise document.error(
                "include: expected a list of files, each with - in front", ("include",)
            )
        for i, name in enumerate(asked):
            self._include(document, ("include", i), name, around)
        for key in KEYS[1:]:
            if key in document.data:
                self._take(document, key, document.data[key])

    def _include(
        self, document: Document, place: Path_, name: Any, around: tuple[Path, ...]
    ) -> None:
        path = self._path(document, place, name)
        if path in around:
            shown = " -> ".join(p.name for p in (*around[around.index(path) :], path))
            raise document.error(f"these files include each other: {shown}", place)
        if path in self.known:
            return
        self.known.add(path)
        if len(self.known) > MOST_FILES:
            raise document.error(f"more than {MOST_FILES} files are included", place)
        try:
            text = text_of(path)
        except SpecError as problem:
            raise document.error(f"{name!r} {problem.message}", place) from None
        self.bytes += len(text)
        if self.bytes > MOST_BYTES:
            said = f"what is included has more than {MOST_BYTES / 1e6:.0f} MB"
            raise document.error(said, place)
        inner = read_text(text, str(path), path.parent)
        if not isinstance(inner.data, dict):
            raise inner.error(f"expected keys and values: {', '.join(KEYS)}")
        for key in inner.data:
            if key not in KEYS:
                raise inner.error(unknown("key of an included file", key, KEYS), (key,), key=True)
        self.gather(inner, (*around, path))

    def _path(self, document: Document, place: Path_, name: Any) -> Path:
        """The path of an included file.

        Raises:
            SpecError: it may lead out of the task's folder.
        """
        if self.top is None or document.folder is None:
            said = "only a task in a file can include others: this text is in no folder"
            raise document.error(said, place)
        if not isinstance(name, str) or not name.strip() or "\0" in name:
            said = f"include: expected the name of a file, not {str(name)[:60]!r}"
            raise document.error(said, place)
        given, elsewhere = PurePosixPath(name), PureWindowsPath(name)
        if elsewhere.drive or elsewhere.root or "\\" in name or ".." in given.parts:
            raise document.error(
                f"{name!r} may lead out of the task's folder: name a file in it or below, such as"
                " parts/moves.yaml",
                place,
            )
        path = document.folder
        for part in given.parts:
            path = path / part
            if _is_link(path):
                said = f"{name!r} goes through a symbolic link, which is not followed"
                raise document.error(said, place)
        return path

    def _take(self, document: Document, key: str, own: Any) -> None:
        """Add what a document has under one of the keys."""
        if key in LISTED and not isinstance(own, list):
            raise document.error(f"{key}: expected a list, each item with - in front", (key,))
        if key in NAMED and not isinstance(own, dict):
            raise document.error(f"{key}: expected names, each with what it is", (key,))
        self.made.mark(document, (key,), (key,))
        kept: Any = self.made.data.setdefault(key, type(own)())
        for old, value in parts(own):
            new = len(kept) if isinstance(kept, list) else old
            if isinstance(kept, list):
                kept.append(value)
            elif old in kept:
                first = self.made.positions.get((key, old))
                where = f" ({first.file}:{first.line})" if first else ""
                said = f"{old!r} is defined twice{where}"
                raise document.error(said, (key, old), key=True)
            else:
                kept[old] = value
            self.made.mark_all(document, (key, old), (key, new), value)


def _is_link(path: Path) -> bool:
    """Whether it is a symbolic link; what cannot even be looked at is refused when it is read."""
    try:
        return path.is_symlink()
    except OSError:
        return False

"""YAML with positions: plain data, and where in which file each part of it stands."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from specs.errors import Position, SpecError, excerpt_of

MOST_BYTES = 8_000_000
MOST_ALIASED = 50_000  # values that come from aliases: a bomb of them expands no further
DEEPEST = 40
BREAK = re.compile("\r\n|[\r\n\x85\u2028\u2029]")

Path_ = tuple[str | int, ...]


ENGLISH = (".txt", ".md")  # files of these kinds are lessons in English, others YAML


@dataclass(frozen=True)
class Document:
    """Plain data read from a file, and from those that it includes.

    A path is a tuple of keys and indices; `positions` knows the values, `keys` the keys.
    """

    data: Any
    file: str
    positions: dict[Path_, Position] = field(default_factory=dict)
    keys: dict[Path_, Position] = field(default_factory=dict)
    lines: dict[str, list[str]] = field(default_factory=dict)  # of each file, for excerpts
    folder: Path | None = None  # that the file is in; None for text that is in no file

    @property
    def is_lesson(self) -> bool:
        """Whether it is in English."""
        return Path(self.file).suffix in ENGLISH

    def where(self, path: Path_) -> Position | None:
        """Position of the value at `path`, or of the nearest thing around it."""
        for end in range(len(path), -1, -1):
            found = self.positions.get(path[:end])
            if found:
                return found
        return None

    def error(
        self, message: str, path: Path_ = (), *, key: bool = False, code: str = "refused"
    ) -> SpecError:
        """A `SpecError` that points at a value, or at its key."""
        place = self.keys.get(path) if key else None
        return self.error_at(message, place or self.where(path), code=code)

    def error_at(self, message: str, place: Position | None, *, code: str = "refused") -> SpecError:
        """A `SpecError` that points at a place."""
        file = (place.file if place else "") or self.file
        excerpt = excerpt_of(self.lines.get(file, []), place)
        return SpecError(message, file=file, position=place, code=code, excerpt=excerpt)


def read_file(path: Path) -> Document:
    """Read one YAML file.

    Raises:
        SpecError: it is missing, too large, not text, or not YAML.
    """
    return read_text(text_of(path), str(path), path.parent)


def text_of(path: Path) -> str:
    """The text of a file.

    Raises:
        SpecError: it is missing, too large, or not text.
    """
    shown = str(path)
    try:
        size = path.stat().st_size
        if not path.is_file():
            raise SpecError("is not a file", file=shown)
        if size > MOST_BYTES:
            raise SpecError(
                f"has {size / 1e6:.0f} MB; a task file has at most {MOST_BYTES / 1e6:.0f} MB",
                file=shown,
            )
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise SpecError(f"is not UTF-8 text (byte {problem.start})", file=shown) from None
    except (OSError, ValueError) as problem:
        reason = problem.strerror if isinstance(problem, OSError) else str(problem)
        raise SpecError(f"cannot be read: {reason}", file=shown) from None


def read_text(text: str, file: str, folder: Path | None = None) -> Document:
    """Read YAML from a string; `file` is what errors call it, `folder` where it may include from.

    Raises:
        SpecError: it is not YAML, or uses more of YAML than plain data needs.
    """
    yaml = YAML(typ="safe", pure=True)
    yaml.composer.warn_double_anchors = False  # an anchor may be given again, as YAML says
    document = Document(None, file, lines={file: _lines(text)}, folder=folder)
    try:
        node = yaml.compose(text)
        if node is None:
            raise SpecError("is empty; expected a task", file=file)
        data = _Builder(yaml, document).build(node, (), 0)
    except MarkedYAMLError as problem:
        mark = problem.problem_mark or problem.context_mark
        at = Position(mark.line + 1, mark.column + 1, file) if mark else None
        said = " ".join(str(problem.problem or problem.context or "it cannot be read").split())
        raise document.error_at(f"not YAML: {said}", at) from None
    except YAMLError as problem:
        raise SpecError(f"not YAML: {' '.join(str(problem).split())}", file=file) from None
    except RecursionError:
        raise SpecError(f"nested deeper than {DEEPEST} levels", file=file) from None
    return Document(data, file, document.positions, document.keys, document.lines, folder)


class _Builder:
    """Turns YAML nodes into plain data, noting where each part stands."""

    def __init__(self, yaml: YAML, document: Document) -> None:
        self._yaml, self._document = yaml, document
        self._seen: set[int] = set()  # nodes
        self._aliased = 0

    def build(self, node: Node, path: Path_, depth: int) -> Any:
        document = self._document
        document.positions[path] = self._position(node)
        if id(node) in self._seen:
            self._aliased += 1
            if self._aliased > MOST_ALIASED:
                raise document.error(f"more than {MOST_ALIASED} values come from aliases", path)
        self._seen.add(id(node))
        if depth > DEEPEST:
            raise document.error(f"nested deeper than {DEEPEST} levels", path)
        if isinstance(node, MappingNode):
            return self._mapping(node, path, depth)
        if isinstance(node, SequenceNode):
            return [self.build(n, (*path, i), depth + 1) for i, n in enumerate(node.value)]
        return self._scalar(node, path)

    def _mapping(self, node: MappingNode, path: Path_, depth: int) -> dict[str, Any]:
        result: dict[str, Any] = {}
        for key_node, value_node in node.value:
            key, place = key_node.value, self._position(key_node)
            if not isinstance(key_node, ScalarNode) or not isinstance(key, str):
                raise self._document.error_at("a key must be a word", place)
            own = (*path, key)
            if key in result:
                raise self._document.error_at(f"the key {key!r} is given twice", place)
            self._document.keys[own] = place
            result[key] = self.build(value_node, own, depth + 1)
        return result

    def _scalar(self, node: Node, path: Path_) -> Any:
        kind = str(node.tag).rpartition(":")[2]
        constructor = self._yaml.constructor
        try:
            match kind:
                case "null":
                    return None
                case "bool":
                    return constructor.construct_yaml_bool(node)
                case "int":
                    return constructor.construct_yaml_int(node)
                case "float":
                    return constructor.construct_yaml_float(node)
                case "str" | "timestamp":
                    return str(node.value)
        except (ValueError, OverflowError, IndexError):
            raise self._document.error(f"{_short(node.value)!r} is not a number", path) from None
        raise self._document.error(
            f"the tag {str(node.tag)!r} means nothing here; expected plain text, numbers or lists",
            path,
        )

    def _position(self, node: Node) -> Position:
        mark = node.start_mark
        return Position(mark.line + 1, mark.column + 1, self._document.file)


def _lines(text: str) -> list[str]:
    """The lines as YAML counts them."""
    return BREAK.split(text)


def _short(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."

"""YAML with positions: plain data, and where in the file each part of it stands."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from specs.errors import Position, SpecError

MOST_BYTES = 8_000_000
MOST_VALUES = 500_000  # after aliases are followed: a bomb of them expands no further
DEEPEST = 40

Path_ = tuple[str | int, ...]


@dataclass(frozen=True)
class Document:
    """Plain data read from a file.

    A path is a tuple of keys and indices; `positions` knows the values, `keys` the keys.
    """

    data: Any
    file: str
    positions: dict[Path_, Position] = field(default_factory=dict)
    keys: dict[Path_, Position] = field(default_factory=dict)

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
        return SpecError(message, file=self.file, position=place or self.where(path), code=code)


def read_file(path: Path) -> Document:
    """Read one YAML file.

    Raises:
        SpecError: it is missing, too large, not text, or not YAML.
    """
    return read_text(read_source(path), str(path))


def read_source(path: Path) -> str:
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


def read_text(text: str, file: str) -> Document:
    """Read YAML from a string; `file` is what errors call it.

    Raises:
        SpecError: it is not YAML, or uses more of YAML than plain data needs.
    """
    yaml = YAML(typ="safe", pure=True)
    try:
        node = yaml.compose(text)
        if node is None:
            raise SpecError("is empty; expected a task", file=file)
        document = Document(data=None, file=file)
        data = _Builder(yaml, document).build(node, (), 0)
    except MarkedYAMLError as problem:
        mark = problem.problem_mark or problem.context_mark
        at = Position(mark.line + 1, mark.column + 1) if mark else None
        said = " ".join(str(problem.problem or problem.context or "it cannot be read").split())
        raise SpecError(f"not YAML: {said}", file=file, position=at) from None
    except YAMLError as problem:
        raise SpecError(f"not YAML: {' '.join(str(problem).split())}", file=file) from None
    except RecursionError:
        raise SpecError(f"nested deeper than {DEEPEST} levels", file=file) from None
    return Document(data, file, document.positions, document.keys)


class _Builder:
    """Turns YAML nodes into plain data, noting where each part stands."""

    def __init__(self, yaml: YAML, document: Document) -> None:
        self._yaml, self._document = yaml, document
        self._count = 0

    def build(self, node: Node, path: Path_, depth: int) -> Any:
        document = self._document
        document.positions[path] = _position(node)
        self._count += 1
        if self._count > MOST_VALUES:
            raise document.error(f"more than {MOST_VALUES} values once its aliases are followed")
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
            key = key_node.value
            if not isinstance(key_node, ScalarNode) or not isinstance(key, str):
                raise SpecError(
                    "a key must be a word", file=self._document.file, position=_position(key_node)
                )
            own = (*path, key)
            if key in result:
                raise SpecError(
                    f"the key {key!r} is given twice",
                    file=self._document.file,
                    position=_position(key_node),
                )
            self._document.keys[own] = _position(key_node)
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


def _short(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."


def _position(node: Node) -> Position:
    return Position(node.start_mark.line + 1, node.start_mark.column + 1)

"""Tools write values back into a task file, and all else in it stays as it is.

Only the characters of a value are replaced, or a key is added; comments, order, and layout are
those of the author. What was written is read again and compared before the file is changed.
"""

import copy
import os
from collections.abc import Mapping
from io import StringIO
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from specs.errors import SpecError
from specs.reading import Document, Path_, read_text, text_of

Splice = tuple[int, int, str]  # first and last character that go, and what comes instead


def write_back(file: Path, values: Mapping[Path_, Any]) -> None:
    """Set values in a task file.

    Args:
        file: the task.
        values: by path in the file as it is written, such as ("subtasks", 2, "beats"): numbers,
            texts, lists and mappings. The last step may be a new key.

    Raises:
        SpecError: the file cannot be read or written, or has no such place.
    """
    changed = set_values(text_of(file), values, str(file))
    part = file.with_name(file.name + ".part")
    try:
        part.write_bytes(changed.encode("utf-8"))
        os.replace(part, file)
    except OSError as problem:
        part.unlink(missing_ok=True)
        raise SpecError(f"cannot be written: {problem.strerror}", file=str(file)) from None


def set_values(text: str, values: Mapping[Path_, Any], file: str = "task") -> str:
    """The same in a text; `file` is what errors call it.

    Raises:
        SpecError: the text is not YAML, or has no such place.
    """
    document = read_text(text, file)
    yaml = YAML(typ="safe", pure=True)
    yaml.composer.warn_double_anchors = False
    root = yaml.compose(text)
    splices = [_splice(document, root, text, path, value) for path, value in values.items()]
    changed = text
    for start, end, new in sorted(splices, reverse=True):
        changed = changed[:start] + new + changed[end:]
    wanted = copy.deepcopy(document.data)
    for path, value in values.items():
        around = wanted
        for step in path[:-1]:
            around = around[step]
        around[path[-1]] = value
    try:
        same = read_text(changed, file).data == wanted
    except SpecError:  # something else is an alias of what was replaced
        same = False
    if not same:
        said = "this cannot be changed without changing more than it"
        raise document.error(said, next(iter(values)))
    return changed


def _splice(document: Document, root: Node, text: str, path: Path_, value: Any) -> Splice:
    """What to replace in a text to set one value."""
    around: Node = root
    node: Node | None = root
    for depth, step in enumerate(path):
        around, node = node or root, _below(node, step)
        if node is None and (depth < len(path) - 1 or not isinstance(around, MappingNode)):
            shown = ".".join(str(s) for s in path)
            raise document.error(f"there is no {shown}", path[:depth])
    if node is None:
        assert isinstance(around, MappingNode)
        return _added(around, text, str(path[-1]), value)
    if isinstance(node, MappingNode | SequenceNode) and not node.flow_style:
        raise document.error("a value over several lines is not replaced: name one in it", path)
    return node.start_mark.index, node.end_mark.index, _written(value)


def _below(node: Node | None, step: str | int) -> Node | None:
    if isinstance(node, MappingNode):
        return next((value for key, value in node.value if key.value == step), None)
    if isinstance(node, SequenceNode) and isinstance(step, int) and 0 <= step < len(node.value):
        inner: Node = node.value[step]
        return inner
    return None


def _added(around: MappingNode, text: str, key: str, value: Any) -> Splice:
    """A new key: after the others of a flow mapping, else below one that takes one line."""
    pair = f"{_written(key)}: {_written(value)}"
    if around.flow_style:
        if not around.value:
            at = around.end_mark.index - 1
            return at, at, pair
        at = around.value[-1][1].end_mark.index
        return at, at, f", {pair}"
    for name, inner in around.value:
        if isinstance(inner, ScalarNode) and inner.style is None:
            ends = text.find("\n", inner.end_mark.index)
            at = len(text) if ends < 0 else ends
            if name.start_mark.line == inner.end_mark.line:
                return at, at, "\n" + " " * name.start_mark.column + pair
    first = around.value[0][0].start_mark
    return first.index, first.index, f"{pair}\n{' ' * first.column}"


def _written(value: Any) -> str:
    """A value on one line, so that it can stand anywhere."""
    yaml: Any = YAML(typ="safe", pure=True)
    yaml.default_flow_style = True
    yaml.sort_base_mapping_type_on_output = False
    yaml.width = 10**9
    stream = StringIO()
    yaml.dump({"x": value}, stream)
    return stream.getvalue().strip().removeprefix("{x: ").removesuffix("}")

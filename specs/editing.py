"""Tools write values back into a task file, and all else in it stays as it is.

Only the characters of a value are replaced, or a key is added or taken out; comments, order, and
layout are those of the author. What was written is read again and compared before the file is
changed.
"""

import copy
import os
from collections.abc import Mapping, Sequence
from enum import Enum
from io import StringIO
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from specs.errors import SpecError
from specs.reading import Document, Path_, read_text, text_of

Splice = tuple[int, int, str]  # first and last character that go, and what comes instead


class Gone(Enum):
    """In the place of a value: its key is taken out."""

    GONE = "gone"


GONE = Gone.GONE


def write_back(file: Path, values: Mapping[Path_, Any]) -> None:
    """Set values in a task file.

    Args:
        file: the task.
        values: by path in the file as it is written, such as ("subtasks", 2, "beats"): numbers,
            texts, lists and mappings, or `GONE`. The last step may be a new key.

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
    # From the end on; of keys that are added at one place the last first.
    for _, (start, end, new) in sorted(
        enumerate(splices), key=lambda s: (s[1][:2], s[0]), reverse=True
    ):
        changed = changed[:start] + new + changed[end:]
    try:
        same = read_text(changed, file).data == _wanted(document.data, values)
    except SpecError:  # something else is an alias of what was replaced
        same = False
    if not same:
        said = "this cannot be changed without changing more than it"
        raise document.error(said, next(iter(values)))
    return changed


def places_of_steps(text: str, file: str = "task") -> dict[str, Path_]:
    """Where each sub-task and background entry that is written in a text stands, by its name.

    What stands for others (a `use`) is none.

    Raises:
        SpecError: the text is not YAML.
    """
    data = read_text(text, file).data
    found: dict[str, Path_] = {}
    for key in ("background", "subtasks"):
        steps = data.get(key, ()) if isinstance(data, dict) else ()
        for k, step in enumerate(steps if isinstance(steps, list) else ()):
            if isinstance(step, dict) and "primitive" in step and "name" in step:
                found[str(step["name"])] = (key, k)
    return found


def _wanted(data: Any, values: Mapping[Path_, Any]) -> Any:
    """What the changed text should say."""
    wanted = copy.deepcopy(data)
    for path, value in values.items():
        around = wanted
        for step in path[:-1]:
            around = around[step]
        if value is GONE:
            around.pop(path[-1], None)
        else:
            around[path[-1]] = value
    return wanted


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
        return (0, 0, "") if value is GONE else _added(around, text, str(path[-1]), value)
    if value is GONE:
        return _removed(document, around, text, path)
    if isinstance(node, MappingNode | SequenceNode) and not node.flow_style:
        raise document.error("a value over several lines is not replaced: name one in it", path)
    return node.start_mark.index, node.end_mark.index, on_one_line(value)


def _below(node: Node | None, step: str | int) -> Node | None:
    if isinstance(node, MappingNode):
        return next((value for key, value in node.value if key.value == step), None)
    if isinstance(node, SequenceNode) and isinstance(step, int) and 0 <= step < len(node.value):
        inner: Node = node.value[step]
        return inner
    return None


def _added(around: MappingNode, text: str, key: str, value: Any) -> Splice:
    """A new key: after the others of a flow mapping, else below the last that takes one line."""
    pair = f"{on_one_line(key)}: {on_one_line(value)}"
    if around.flow_style:
        if not around.value:
            at = around.end_mark.index - 1
            return at, at, pair
        at = around.value[-1][1].end_mark.index
        return at, at, f", {pair}"
    for name, inner in reversed(around.value):
        plain = isinstance(inner, ScalarNode) and inner.style not in ("|", ">")
        flow = isinstance(inner, MappingNode | SequenceNode) and inner.flow_style
        if (plain or flow) and name.start_mark.line == inner.end_mark.line:
            at = _end_of_line(text, inner.end_mark.index)
            margin = " " * name.start_mark.column
            return at, at, f"\n{margin}{_block(key, value, margin) or pair}"
    first = around.value[0][0].start_mark
    return first.index, first.index, f"{pair}\n{' ' * first.column}"


def _removed(document: Document, around: Node, text: str, path: Path_) -> Splice:
    """A key and its value taken out: with its line, or with one comma of a flow mapping."""
    assert isinstance(around, MappingNode)  # items of lists are not taken out
    pairs: list[tuple[Node, Node]] = around.value
    k = next(k for k, (name, _) in enumerate(pairs) if name.value == path[-1])
    start, end = pairs[k][0].start_mark, pairs[k][1].end_mark.index
    if around.flow_style:
        if k:
            return pairs[k - 1][1].end_mark.index, end, ""
        after = pairs[1][0].start_mark.index if len(pairs) > 1 else around.end_mark.index - 1
        return start.index, after, ""
    before = text[start.index - start.column : start.index]
    if before.strip() or len(pairs) == 1:
        raise document.error("the first key of a list's item is not taken out", path, key=True)
    return start.index - start.column, _end_of_line(text, _last(pairs[k][1])) + 1, ""


def _last(node: Node) -> int:
    """The last character of a value; YAML counts the comments that follow one of several lines."""
    if isinstance(node, ScalarNode):
        return int(node.end_mark.index) - (node.style in ("|", ">"))
    if not isinstance(node, MappingNode | SequenceNode) or node.flow_style or not node.value:
        return int(node.end_mark.index)
    last = node.value[-1]
    return _last(last[1] if isinstance(node, MappingNode) else last)


def _block(key: str, value: Any, margin: str) -> str:
    """A list of mappings, one on each line, as the library has it; nothing for other values."""
    if not isinstance(value, Sequence) or not value:
        return ""
    if not all(isinstance(item, Mapping) for item in value):
        return ""
    return "\n".join(
        [f"{on_one_line(key)}:", *(f"{margin}  - {on_one_line(item)}" for item in value)]
    )


def _end_of_line(text: str, at: int) -> int:
    ends = text.find("\n", at)
    return len(text) if ends < 0 else ends


def on_one_line(value: Any) -> str:
    """A value on one line, so that it can stand anywhere."""
    yaml: Any = YAML(typ="safe", pure=True)
    yaml.default_flow_style = True
    yaml.sort_base_mapping_type_on_output = False
    yaml.width = 10**9
    stream = StringIO()
    yaml.dump({"x": value}, stream)
    return stream.getvalue().strip().removeprefix("{x: ").removesuffix("}")

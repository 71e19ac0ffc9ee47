"""Values written back into a task file; its comments, order and style stay."""

from collections.abc import Mapping
from io import StringIO
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import YAMLError

from specs.errors import SpecError

WIDTH = 100  # of a line


def amended(text: str, changes: Mapping[str, Mapping[str, Any]]) -> str:
    """The text of a task file with other values.

    Args:
        text: of a file that could be read as a task.
        changes: values by key, by the name of the sub-task; those of the task itself by "".
            What is None is taken out.

    Raises:
        SpecError: the text has no such sub-task: what it says is written somewhere else.
    """
    yaml: Any = YAML()
    yaml.width, yaml.preserve_quotes = WIDTH, True
    yaml.indent(mapping=2, sequence=4, offset=2)
    try:
        whole = yaml.load(text)
        entries = {step["name"]: step for step in whole["subtasks"]}
    except (YAMLError, LookupError, TypeError):
        raise SpecError("there is no list of sub-tasks to write into") from None
    for name, values in changes.items():
        if name and name not in entries:
            raise SpecError(f"{name!r} is not written in this file")
        entry = entries[name] if name else whole
        for key, value in values.items():
            if value is None:
                entry.pop(key, None)
            elif key in entry:
                entry[key] = _written(value)
            else:  # before the last, which carries the blank line that follows
                entry.insert(len(entry) - 1, key, _written(value))
    stream = StringIO()
    yaml.dump(whole, stream)
    return stream.getvalue()


def _written(value: Any) -> Any:
    """A value in the style of the library: lists of mappings line by line, the rest in one."""
    if isinstance(value, Mapping):
        mapping = CommentedMap({key: _written(v) for key, v in value.items()})
        mapping.fa.set_flow_style()
        return mapping
    if isinstance(value, list | tuple):
        sequence = CommentedSeq([_written(v) for v in value])
        if not any(isinstance(v, Mapping) for v in value):
            sequence.fa.set_flow_style()
        return sequence
    return value

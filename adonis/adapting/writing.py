"""An adapted task as a file: the file of the task it was made from, with other values in it."""

import difflib
from collections.abc import Iterator
from typing import Any

from specs import GONE, SpecError, TaskSpec, places_of_steps, set_values, task_to_data, task_to_yaml

Path_ = tuple[str | int, ...]
STEPS = ("background", "subtasks")


def adapted_text(before: TaskSpec, after: TaskSpec, text: str) -> str:
    """A task file with the values that changed.

    Args:
        before: the task as the file has it.
        after: the adapted one: of the same steps.
        text: of the file; its comments stay. Where the task is not written there, step by step,
            it is written anew.
    """
    try:
        places = places_of_steps(text)
        changes = dict(_changes(task_to_data(before), task_to_data(after), places))
        changed = set_values(text, changes)
    except (SpecError, KeyError):  # what it says is written somewhere else
        return task_to_yaml(after)
    return changed


def difference(before: str, after: str, name: str, other: str) -> list[str]:
    """What changed from one text to another, line by line, as `diff -u` has it."""
    one, two = before.splitlines(), after.splitlines()
    return list(difflib.unified_diff(one, two, name, other, lineterm="", n=0))


def _changes(
    before: dict[str, Any], after: dict[str, Any], places: dict[str, Path_]
) -> Iterator[tuple[Path_, Any]]:
    """Paths in the file and their new values."""
    for key in {**before, **after}:
        if key in STEPS:
            for one, other in zip(before[key], after[key], strict=True):
                if one != other:
                    yield from _inside(one, other, places[one["name"]])
        elif before.get(key) != after.get(key):
            yield from _inside({key: before.get(key)}, {key: after.get(key)}, ())


def _inside(before: Any, after: Any, path: Path_) -> Iterator[tuple[Path_, Any]]:
    """The smallest parts of a value that changed."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in {**before, **after}:
            if before.get(key) == after.get(key):
                continue
            if before.get(key) is None or after.get(key) is None:
                gone = after.get(key) is None
                yield (*path, key), GONE if gone else after[key]
            else:
                yield from _inside(before[key], after[key], (*path, key))
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        if any(isinstance(part, dict | list) for part in before):
            for k, (one, other) in enumerate(zip(before, after, strict=True)):
                if one != other:
                    yield from _inside(one, other, (*path, k))
        else:
            yield path, after
    else:
        yield path, after

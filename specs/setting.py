"""Values set from outside the file of a task: `scene.table.turn=20`, `subtasks.left.beats=4`.

A path goes by keys, and in lists by the names of what is in them. Its last step may be a new key.
"""

import copy
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from sim import unknown
from specs.errors import Position, SpecError
from specs.reading import Document, Path_, read_text

SOURCE = "--set"  # what errors call where a value comes from


def with_set(document: Document, asked: Iterable[str]) -> Document:
    """A document with other values.

    Args:
        document: in which includes and fragments are put in already.
        asked: `PATH=VALUE` each, the value as YAML.

    Raises:
        SpecError: there is no such place, or a value is not YAML.
    """
    for said in asked:
        document = _with_one(document, said)
    return document


def _with_one(document: Document, said: str) -> Document:
    path, equals, text = said.partition("=")
    if not equals or not path.strip() or not text.strip():
        raise SpecError(f"expected PATH=VALUE, such as tempo=90, not {said!r}", file=SOURCE)
    if not isinstance(document.data, dict):
        return document  # reading on will say what it should be
    value = read_text(text, SOURCE).data
    data = copy.deepcopy(document.data)
    place = _put(data, path.strip(), value)
    at = Position(1, len(path) + 2, SOURCE)
    below = len(place)
    positions = {p: q for p, q in document.positions.items() if p[:below] != place}
    lines = {**document.lines, SOURCE: [said]}
    return replace(document, data=data, positions={**positions, place: at}, lines=lines)


def _put(data: Any, path: str, value: Any) -> Path_:
    """Put a value into data; returns where."""
    place: Path_ = ()
    left, around = path, data
    while True:
        known = _known(around)
        # Names may have dots: of those that fit the longest is meant.
        fits = [name for name in known if left == name or left.startswith(f"{name}.")]
        name = max(fits, key=len, default=None)
        if name is None:
            if isinstance(around, dict) and "." not in left:
                around[left] = value
                return (*place, left)
            step, *_ = left.split(".")
            raise SpecError(f"{path}: {unknown('key or name', step, known)}", file=SOURCE)
        key, left = known[name], left[len(name) + 1 :]
        place = (*place, key)
        if not left:
            around[key] = value
            return place
        around = around[key]


def _known(around: Any) -> dict[str, Any]:
    """What a step of a path may be called here, and what it then is."""
    if isinstance(around, dict):
        return {str(key): key for key in around}
    if isinstance(around, list):
        named = {
            str(item["name"]): k
            for k, item in enumerate(around)
            if isinstance(item, dict) and "name" in item
        }
        return named or {str(k): k for k in range(len(around))}
    return {}

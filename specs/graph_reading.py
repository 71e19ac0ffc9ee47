"""A graph in JSON, as `graph_writing.to_json` writes it, is a task file again.

Its nodes become sub-tasks, and its edges their `after`, `otherwise` and `while`. Everything keeps
its position, so that whatever is wrong with it is found where it stands.
"""

from collections.abc import Iterator
from typing import Any

from sim import unknown
from specs.graph import AFTER, OTHERWISE, WHILE
from specs.graph_writing import ORDER
from specs.reading import Document, Path_

KINDS = (AFTER, "any", "first", OTHERWISE, WHILE)


def task_of_graph(document: Document) -> Document:
    """The document as a task file; one that is no graph is returned as it is.

    Raises:
        SpecError: it has nodes, but is not a graph.
    """
    data = document.data
    if not isinstance(data, dict) or "nodes" not in data:
        return document
    if "subtasks" in data:
        said = "a graph has nodes and edges, a task has subtasks: give one of the two"
        raise document.error(said, ("subtasks",), key=True)
    if "edges" not in data:
        raise document.error("'edges' is missing: what comes after what; [] if all begin at once")
    subtasks = [dict(node) for node in _mappings(document, "nodes")]
    made = Document(
        {key: value for key, value in data.items() if key not in ("nodes", "edges", "planned")},
        document.file,
        {_moved(path): at for path, at in document.positions.items()},
        {_moved(path): at for path, at in document.keys.items()},
    )
    made.data["subtasks"] = subtasks
    for i, subtask in enumerate(subtasks):
        for key in ORDER:
            if key in subtask:
                said = f"in a graph the edges say {key!r}"
                raise document.error(said, ("nodes", i, key), key=True)
    _connect(document, made, subtasks)
    return made


def _connect(document: Document, made: Document, subtasks: list[dict[str, Any]]) -> None:
    """Write edges into the sub-tasks that they lead to, or from."""
    places = {str(subtask.get("name")): i for i, subtask in enumerate(subtasks)}
    joins: dict[int, str] = {}  # for all, any or the first of those that it comes after
    for k, edge in enumerate(_mappings(document, "edges")):
        one, then, kind = _ends(document, places, k, edge)
        i = places[one if kind == OTHERWISE else then]
        path: Path_ = ("subtasks", i, kind)
        if kind in (OTHERWISE, WHILE):
            if kind in subtasks[i]:
                way = "leaves" if kind == OTHERWISE else "leads to"
                said = f"an edge of kind {kind} {way} {subtasks[i]['name']!r} already"
                raise document.error(said, ("edges", k))
            subtasks[i][kind] = then if kind == OTHERWISE else one
        else:
            if joins.setdefault(i, kind) != kind:
                mixed = f"{then!r} comes after others by edges of kind {joins[i]} and {kind}"
                raise document.error(mixed, ("edges", k))
            after = subtasks[i].setdefault("after", [] if kind == AFTER else {kind: []})
            names = after if kind == AFTER else after[kind]
            within = ("after",) if kind == AFTER else ("after", kind)
            path = ("subtasks", i, *within, len(names))
            names.append(one)
            _place(made, ("subtasks", i, "after"), document, ("edges", k))
        _place(made, path, document, ("edges", k, "to" if kind == OTHERWISE else "from"))
    spared = {subtask.get(OTHERWISE) for subtask in subtasks}
    for subtask in subtasks:
        if WHILE not in subtask and str(subtask.get("name")) not in spared:
            subtask.setdefault("after", [])


def _ends(
    document: Document, places: dict[str, int], k: int, edge: dict[str, Any]
) -> tuple[str, str, str]:
    """From, to and kind of an edge."""
    for key in edge:
        if key not in ("from", "to", "kind"):
            message = unknown("key of an edge", key, ("from", "to", "kind"))
            raise document.error(message, ("edges", k, key), key=True)
    for key in ("from", "to"):
        if key not in edge:
            raise document.error(f"{key!r} is missing", ("edges", k))
        if not isinstance(edge[key], str) or edge[key] not in places:
            raise document.error(unknown("node", edge[key], places), ("edges", k, key))
    kind = edge.get("kind", AFTER)
    if kind not in KINDS:
        raise document.error(unknown("kind of edge", kind, KINDS), ("edges", k, "kind"))
    return edge["from"], edge["to"], kind


def _mappings(document: Document, key: str) -> Iterator[dict[str, Any]]:
    """The items of a list of keys and values."""
    items = document.data[key]
    if not isinstance(items, list):
        raise document.error(f"{key}: expected a list", (key,))
    for i, item in enumerate(items):
        if not isinstance(item, dict):
            raise document.error(f"{key}, item {i + 1}, expected keys and values", (key, i))
        yield item


def _moved(path: Path_) -> Path_:
    return ("subtasks", *path[1:]) if path[:1] == ("nodes",) else path


def _place(made: Document, path: Path_, document: Document, origin: Path_) -> None:
    """Say where something stands that was made of an edge."""
    at = document.where(origin)
    if at is not None:
        made.positions.setdefault(path, at)

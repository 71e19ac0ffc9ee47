"""From a file, or the name of a task of the library, to a `TaskSpec`."""

from collections.abc import Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from primitives import Primitive
from sim import unknown
from specs.available import available_primitives
from specs.english.lesson import read_lesson
from specs.errors import SpecError
from specs.fragments import put_in_fragments
from specs.graph_reading import task_of_graph
from specs.including import include
from specs.reading import ENGLISH, Document, Path_, read_file, read_text, text_of
from specs.setting import with_set
from specs.task import Background, SubTask, TaskSpec, keys_of
from specs.validating import validate

Model = TypeVar("Model", bound=BaseModel)
LIBRARY = Path(str(files("specs") / "library"))


def library() -> dict[str, Path]:
    """The tasks that come with the package, by name."""
    found = (path for path in LIBRARY.iterdir() if path.suffix in (".yaml", ".txt"))
    return {path.stem: path for path in sorted(found)}


def find_task(name: str) -> Path:
    """The file of a task: of the library when it is one of its names, else a path.

    Raises:
        SpecError: there is neither.
    """
    if not name.strip():
        raise SpecError(f"expected a task: a file, or one of {', '.join(library())}")
    if name in library():
        return library()[name]
    path = Path(name)
    try:
        missing = not path.exists()
    except OSError:  # a name that no file can have
        missing = True
    if missing and path.suffix not in (".yaml", ".yml", ".json", *ENGLISH):
        raise SpecError(f"no such file, and {unknown('task of the library', name, library())}")
    return path


def load_task(
    task: str | Path,
    *,
    primitives: Iterable[type[Primitive]] = (),
    changes: Iterable[str] = (),
) -> tuple[TaskSpec, Document]:
    """Read a task.

    Args:
        task: a name of the library, or a path.
        primitives: classes of one's own that the file may use.
        changes: values in the place of those of the file, `PATH=VALUE` each: see `setting`.

    Returns:
        The task, and the document it was read from, which knows where everything stands.

    Raises:
        SpecError: with file, line and column.
    """
    path = find_task(str(task))
    if path.suffix in ENGLISH:
        document = read_lesson(text_of(path), str(path)).document
    else:
        document = put_in_fragments(include(task_of_graph(read_file(path))))
    document = with_set(document, changes)
    return parse_task(document, primitives=primitives), document


def task_from_text(
    text: str, file: str = "task", *, primitives: Iterable[type[Primitive]] = ()
) -> tuple[TaskSpec, Document]:
    """Read a task from a string; `file` is what errors call it, and says whether it is English."""
    if Path(file).suffix in ENGLISH:
        document = read_lesson(text, file).document
    else:
        document = put_in_fragments(include(task_of_graph(read_text(text, file))))
    return parse_task(document, primitives=primitives), document


def parse_task(document: Document, *, primitives: Iterable[type[Primitive]] = ()) -> TaskSpec:
    """The task that a document describes, in which includes and fragments are put in already.

    Raises:
        SpecError: it does not describe one.
    """
    data = document.data
    if not isinstance(data, dict):
        raise document.error("expected keys and values: task, tempo, subtasks …")
    kinds = available_primitives(primitives)
    whole = dict(data)
    for key, model in (("background", Background), ("subtasks", SubTask)):
        if key in whole:
            whole[key] = _steps(document, (key,), whole[key], model, kinds)
    spec = validate(document, (), whole, TaskSpec)
    _check_names(document, spec)
    return spec


def _steps(
    document: Document,
    path: Path_,
    items: Any,
    model: type[Model],
    kinds: Mapping[str, type[Primitive]],
) -> tuple[Model, ...]:
    if not isinstance(items, list):
        raise document.error(f"{path[-1]}: expected a list, each item with - in front", path)
    return tuple(_step(document, (*path, i), item, model, kinds) for i, item in enumerate(items))


def _step(
    document: Document,
    path: Path_,
    item: Any,
    model: type[Model],
    kinds: Mapping[str, type[Primitive]],
) -> Model:
    """One sub-task or background entry: its own keys, and beside them its primitive's."""
    if not isinstance(item, dict):
        raise document.error("expected keys and values: name, primitive …", path)
    kind = item.get("primitive")
    if kind is None:
        known = ", ".join(sorted(kinds))
        raise document.error(f"'primitive' is missing (there are: {known})", path)
    if not isinstance(kind, str) or kind not in kinds:
        raise document.error(unknown("primitive", kind, kinds), (*path, "primitive"))
    ours = keys_of(model).keys() - {"does"}
    theirs = kinds[kind].model_fields.keys() - {"kind"}
    for key in item:
        if key not in ours | theirs | {"primitive"}:
            message = unknown(f"key of a {kind}", key, {*ours, *theirs, "primitive"})
            raise document.error(message, (*path, key), key=True)
    parameters = {k: v for k, v in item.items() if k in theirs}
    own = {k: v for k, v in item.items() if k in ours}
    own["does"] = validate(document, path, parameters, kinds[kind])
    return validate(document, path, own, model)


def _check_names(document: Document, spec: TaskSpec) -> None:
    seen: dict[str, Path_] = {}
    steps = [(("background", i), b.name) for i, b in enumerate(spec.background)]
    steps += [(("subtasks", i), s.name) for i, s in enumerate(spec.subtasks)]
    for path, name in steps:
        if name in seen:
            first = document.where(seen[name])
            line = f" (line {first.line})" if first else ""
            raise document.error(f"the name {name!r} is used twice{line}", (*path, "name"))
        seen[name] = path


__all__ = ["SpecError", "find_task", "library", "load_task", "parse_task", "task_from_text"]

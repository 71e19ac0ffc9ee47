"""From a file, or the name of a task of the library, to a `TaskSpec`."""

from collections.abc import Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from primitives import Primitive
from sim import unknown
from specs.available import available_primitives
from specs.blame import told
from specs.conditions import Condition, Join, Repeat
from specs.english.lesson import read_lesson
from specs.errors import SpecError
from specs.graph_reading import task_of_graph
from specs.reading import Document, Path_, read_file, read_source, read_text
from specs.task import Background, SubTask, TaskSpec, keys_of

Model = TypeVar("Model", bound=BaseModel)
PARTS: dict[str | int, type[BaseModel]] = {  # what stands below a key of a sub-task
    "after": Join,
    "if": Condition,
    "done": Condition,
    "repeat": Repeat,
    "until": Condition,
}
ENGLISH = (".txt", ".md")  # files of these kinds are lessons in English, others YAML
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
    if not path.exists() and path.suffix not in (".yaml", ".yml", ".json", *ENGLISH):
        raise SpecError(f"no such file, and {unknown('task of the library', name, library())}")
    return path


def load_task(
    task: str | Path, *, primitives: Iterable[type[Primitive]] = ()
) -> tuple[TaskSpec, Document]:
    """Read a task.

    Args:
        task: a name of the library, or a path.
        primitives: classes of one's own that the file may use.

    Returns:
        The task, and the document it was read from, which knows where everything stands.

    Raises:
        SpecError: with file, line and column.
    """
    path = find_task(str(task))
    if path.suffix in ENGLISH:
        return task_from_text(read_source(path), str(path), primitives=primitives)
    document = task_of_graph(read_file(path))
    return parse_task(document, primitives=primitives), document


def task_from_text(
    text: str, file: str = "task", *, primitives: Iterable[type[Primitive]] = ()
) -> tuple[TaskSpec, Document]:
    """Read a task from a string; `file` is what errors call it, and says whether it is English."""
    if Path(file).suffix in ENGLISH:
        document = read_lesson(text, file).document
    else:
        document = task_of_graph(read_text(text, file))
    return parse_task(document, primitives=primitives), document


def parse_task(document: Document, *, primitives: Iterable[type[Primitive]] = ()) -> TaskSpec:
    """The task that a document describes.

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
    spec = _validate(document, (), whole, TaskSpec)
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
    own["does"] = _validate(document, path, parameters, kinds[kind])
    return _validate(document, path, own, model)


def _validate(document: Document, path: Path_, data: Any, model: type[Model]) -> Model:
    """Validate against a model; the first problem becomes a `SpecError` at its place."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        problems = error.errors(include_url=False)
        problem = min(problems, key=_rank)
        place = (*path, *_inside(data, problem["loc"]))
        message = _said_of_length(dict(problem), place, problems)
        message = message or _said(dict(problem), place, model)
        raise document.error(message, place, key=problem["type"] == "extra_forbidden") from None
    except (Exception, SystemExit) as problem:  # whatever a validator of the user's own raises
        raise document.error(f"{model.__name__} raised {told(problem)}", path) from problem


def _rank(problem: Any) -> int:
    """The most telling problem first; of alternatives, the one that was meant."""
    other_kind = problem["type"] == "string_type" and isinstance(problem["input"], dict | list)
    ranks = {"extra_forbidden": 0, "missing": 1, "value_error": 2}
    return 4 if other_kind else ranks.get(problem["type"], 3)


def _inside(data: Any, loc: tuple[str | int, ...]) -> Path_:
    """The part of a location that exists in the data: pydantic adds names of union members."""
    path: list[str | int] = []
    for step in loc:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            continue
        path.append(step)
    return tuple(path)


def _said_of_length(problem: dict[str, Any], place: Path_, problems: Iterable[Any]) -> str:
    """One sentence for a list that is too short or too long; nothing for other errors."""
    kind, (*around, last) = problem["type"], problem["loc"] or ("",)
    if kind == "missing" and isinstance(last, int):
        lacking = [p["loc"] for p in problems if p["type"] == "missing"]
        expected = 1 + max(loc[-1] for loc in lacking if loc[:-1] == (*around,))
        return f"{_name(place)}: expected {expected} values, not {_short(problem['input'])}"
    if kind in ("too_short", "too_long"):
        bound, length = ("least", "min") if kind == "too_short" else ("most", "max")
        context = problem["ctx"]
        return (
            f"{_name(place)}: expected at {bound} {context[f'{length}_length']},"
            f" not {context['actual_length']}"
        )
    return ""


def _said(problem: dict[str, Any], place: Path_, model: type[BaseModel]) -> str:
    """One sentence for one error of pydantic."""
    kind, given, loc = problem["type"], problem.get("input"), problem["loc"]
    name = _name(place)
    if kind == "extra_forbidden":
        inner = [PARTS[step] for step in loc[:-1] if step in PARTS]
        around = model if len(loc) == 1 else inner[-1] if inner else None
        return unknown("key", loc[-1], keys_of(around) if around else ())
    if kind == "missing":
        return f"{loc[-1]!r} is missing"
    if kind in ("value_error", "assertion_error"):
        return str(problem["ctx"]["error"])
    if kind.startswith("model_") or kind in ("dict_type", "mapping_type"):
        return f"{name}: expected keys and values, not {_short(given)}"
    if kind == "string_pattern_mismatch":
        return f"{name} is made of letters, digits, '-', '_' and '.', not {_short(given)}"
    said = str(problem["msg"])
    said = said.removeprefix("Input ").removeprefix("Value ")
    return f"{name} {said}, not {_short(given)}"


def _name(place: Path_) -> str:
    """What a place is called: its key, and which item of a list it is."""
    if not place:
        return "the task"
    *around, last = place
    if isinstance(last, int) and around and isinstance(around[-1], str):
        return f"{around[-1]}, item {last + 1},"
    return str(last)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


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

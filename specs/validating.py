"""From plain data to a model; what pydantic finds wrong is said in one line, with its place."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from sim import unknown
from specs.blame import told
from specs.conditions import Condition, Join, Repeat
from specs.reading import Document, Path_, read_file
from specs.task import keys_of

Model = TypeVar("Model", bound=BaseModel)
PARTS: dict[str | int, type[BaseModel]] = {  # what stands below a key of a sub-task
    "after": Join,
    "if": Condition,
    "done": Condition,
    "repeat": Repeat,
    "until": Condition,
}


def read_checked(path: Path, model: type[Model]) -> Model:
    """What a YAML file says, as a model.

    Raises:
        SpecError: with file, line and column.
    """
    document = read_file(path)
    return validate(document, (), document.data, model)


def validate(document: Document, path: Path_, data: Any, model: type[Model]) -> Model:
    """Validate against a model.

    Raises:
        SpecError: the most telling problem, at its place.
    """
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
        around = inner[-1] if inner and len(loc) > 1 else _model_at(model, loc[:-1])
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


def _model_at(model: type[BaseModel], loc: Iterable[str | int]) -> type[BaseModel] | None:
    """The model of what stands at a place below one; None if it may be one of several."""
    here = [model]
    for step in loc:
        own = [field for each in here for key, field in each.model_fields.items()
               if step in (key, field.alias)]  # fmt: skip
        here = [each for field in own for each in _models_in(field.annotation)] or here
    return here[0] if len(here) == 1 else None


def _models_in(annotation: object) -> list[type[BaseModel]]:
    """The models in a type: in its lists, mappings and alternatives."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [each for part in get_args(annotation) for each in _models_in(part)]


def _name(place: Path_) -> str:
    """What a place is called: its key, and which item of a list it is."""
    if not place:
        return "the file"
    *around, last = place
    if isinstance(last, int) and around and isinstance(around[-1], str):
        return f"{around[-1]}, item {last + 1},"
    return str(last)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."

"""The JSON Schema of task files, made from the models: what an editor completes and checks.

A task file writes a primitive's parameters beside the keys of its sub-task, so there is one
definition for each primitive; inside a fragment any value may be a `$parameter`.
"""

import json
from collections.abc import Iterable, Mapping
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel
from pydantic.errors import PydanticInvalidForJsonSchema
from pydantic.json_schema import models_json_schema

from primitives import Primitive
from sim import BODIES, load_body
from specs.available import BUILT_IN, available_primitives
from specs.describing import descriptions, summary
from specs.errors import SpecError
from specs.fragments import Fragment, Use
from specs.including import KEYS
from specs.task import Background, SubTask, TaskSpec, keys_of

SHIPPED_SCHEMA = Path(str(files("specs") / "task.schema.json"))
PARAMETER = {"type": "string", "pattern": r"^\$(\{[a-z_][a-z0-9_]*\}|[a-z_][a-z0-9_]*)$"}
Schema = dict[str, Any]


def task_schema(primitives: Iterable[type[Primitive]] | None = None) -> Schema:
    """The JSON Schema (draft 7) of task files, and of files that they include.

    Args:
        primitives: classes of one's own, beside those that are installed; None for those of the
            package alone.

    Raises:
        SpecError: two primitives share a name, or one has parameters that JSON has no word for.
    """
    own = {cls.model_fields["kind"].default: cls for cls in BUILT_IN}
    kinds = own if primitives is None else available_primitives(primitives)
    definitions = _definitions(kinds)
    _steps(definitions, "Background", Background, kinds)
    _steps(definitions, "SubTask", SubTask, kinds, others=["Use"])
    for name in ("Primitive", *(cls.__name__ for cls in kinds.values())):
        definitions.pop(name, None)
    definitions |= _within_fragments(definitions)
    task = definitions.pop("TaskSpec")
    properties = dict(task["properties"])
    properties["include"] = {
        "type": "array",
        "items": {"type": "string"},
        "description": "files of definitions, in the task's folder or below:"
        f" {', '.join(KEYS[1:])}, and further includes",
    }
    properties["fragments"] = {
        "type": "object",
        "additionalProperties": {"$ref": "#/$defs/Fragment"},
        "description": "lists of sub-tasks with parameters, to be used many times",
    }
    whole = {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Adonis task",
        "description": "What a body does, in which order, and what runs beside it.",
        "type": "object",
        "properties": properties,
        "dependencies": {"task": ["subtasks"], "subtasks": ["task"]},
        "additionalProperties": False,
        "$defs": dict(sorted(definitions.items())),
    }
    drafted: Schema = _plain(whole)
    return drafted


def schema_text(primitives: Iterable[type[Primitive]] | None = None) -> str:
    """The schema as it is shipped."""
    return json.dumps(task_schema(primitives), indent=1, ensure_ascii=False) + "\n"


def _definitions(kinds: Mapping[str, type[Primitive]]) -> dict[str, Schema]:
    """The schema of every model, each field with its description."""
    models: list[type[BaseModel]] = [TaskSpec, Fragment, Use, *kinds.values()]
    asked: list[tuple[type[BaseModel], Literal["validation"]]] = [(m, "validation") for m in models]
    try:
        _, made = models_json_schema(asked, by_alias=True)
    except PydanticInvalidForJsonSchema as problem:
        raise SpecError(f"a primitive's parameters have no JSON Schema: {problem}") from None
    definitions: dict[str, Schema] = made["$defs"]
    for model in _all_models(models):
        schema = definitions.get(model.__name__)
        if schema is None:
            continue
        said = descriptions(model)
        schema["description"] = summary(model)
        for key, name in keys_of(model).items():
            if key in schema.get("properties", {}):
                _improve(schema["properties"][key], name, said.get(name, ""))
    return definitions


def _all_models(models: Iterable[type[BaseModel]]) -> list[type[BaseModel]]:
    """Models, and those that are in their fields."""
    found: dict[type[BaseModel], None] = {}
    left = list(models)
    while left:
        model = left.pop()
        if model not in found:
            found[model] = None
            annotations = [field.annotation for field in model.model_fields.values()]
            left += [inner for a in annotations for inner in _models_in(a)]
    return list(found)


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [m for inner in getattr(annotation, "__args__", ()) for m in _models_in(inner)]


def _improve(schema: Schema, name: str, said: str) -> None:
    """Say what a field means, and which names the bodies of the package have for it."""
    schema.pop("title", None)
    if said:
        schema["description"] = said
    if name in known_names():
        schema["examples"] = known_names()[name]


@lru_cache(maxsize=1)
def known_names() -> dict[str, list[str]]:
    """Names of the package's bodies that fields can have, by the field."""
    maps = [load_body(name).map for name in BODIES]
    limbs = list(dict.fromkeys(limb for m in maps for limb in m.limbs))
    landmarks = sorted({landmark for m in maps for landmark in m.landmarks})
    postures = sorted({posture for m in maps for posture in m.postures})
    return {
        "body": list(BODIES),
        "limb": limbs, "hand": limbs, "near": landmarks, "to": landmarks, "at": landmarks,
        "posture": postures, "start": postures, "from_": postures,
    }  # fmt: skip


def _steps(
    definitions: dict[str, Schema],
    name: str,
    model: type[BaseModel],
    kinds: Mapping[str, type[Primitive]],
    others: Iterable[str] = (),
) -> None:
    """One definition for each primitive, its parameters beside the keys of the step."""
    step = definitions[name]
    own = {key: value for key, value in step["properties"].items() if key != "does"}
    branches = []
    for kind, cls in sorted(kinds.items()):
        primitive = definitions[cls.__name__]
        theirs = {k: v for k, v in primitive["properties"].items() if k != "kind"}
        about = {"const": kind, "description": summary(cls)}
        required = [k for k in primitive.get("required", ()) if k != "kind"]
        definitions[f"{name}:{kind}"] = {
            "title": kind,
            "description": summary(cls),
            "type": "object",
            "properties": {"name": own["name"], "primitive": about, **theirs, **own},
            "required": ["name", "primitive", *required],
            "additionalProperties": False,
        }
        branches.append({"$ref": f"#/$defs/{name}:{kind}"})
    branches += [{"$ref": f"#/$defs/{other}"} for other in others]
    listed = sorted(kinds)  # once more in one place, for editors that offer the first branch only
    told = [summary(kinds[kind]) for kind in listed]
    definitions[name] = {
        "description": summary(model),
        "type": "object",
        "properties": {"primitive": {"enum": listed, "enumDescriptions": told}},
        "anyOf": branches,
    }


def _within_fragments(definitions: dict[str, Schema]) -> dict[str, Schema]:
    """Definitions of sub-tasks in which any value may be a parameter of the fragment."""
    found: dict[str, Schema] = {}

    def opened(schema: Any) -> Any:
        """A schema of something inside a value."""
        if isinstance(schema, list):
            return [opened(inner) for inner in schema]
        if not isinstance(schema, dict):
            return schema
        if "$ref" in schema:
            name = schema["$ref"].rpartition("/")[2]
            if f"in-fragment:{name}" not in found:
                found[f"in-fragment:{name}"] = {}
                found[f"in-fragment:{name}"] = opened(definitions[name])
            return schema | {"$ref": f"#/$defs/in-fragment:{name}"}
        changed = {k: opened(v) for k, v in schema.items() if k not in ("properties", "items")}
        if "items" in schema:
            changed["items"] = either(schema["items"])
        if "properties" in schema:
            changed["properties"] = {
                key: value if key in ("name", "primitive") else either(value)
                for key, value in schema["properties"].items()
            }
        return changed

    def either(schema: Schema) -> Schema:
        kept = {k: v for k, v in schema.items() if k in ("description", "default", "examples")}
        rest = {k: v for k, v in schema.items() if k not in kept}
        return {**kept, "anyOf": [opened(rest), PARAMETER]}

    inner = opened({"$ref": "#/$defs/SubTask"})
    fragment = definitions["Fragment"]
    fragment["properties"]["subtasks"] |= {"items": inner}
    return found


def _plain(schema: Any) -> Any:
    """The same in draft 7, without what says nothing."""
    if isinstance(schema, list):
        return [_plain(inner) for inner in schema]
    if not isinstance(schema, dict):
        return schema
    made = {k: _plain(v) for k, v in schema.items() if not (k == "default" and v in (None, []))}
    if isinstance(made.get("title"), str) and "properties" not in made:
        del made["title"]
    if "prefixItems" in made:
        first, *rest = made.pop("prefixItems")
        made["items"] = first if all(r == first for r in rest) else [first, *rest]
    return made

"""From a `TaskSpec` back to a task file that means the same."""

from io import StringIO
from typing import Any

from pydantic import BaseModel
from ruamel.yaml import YAML

from specs.task import Background, SubTask, TaskSpec, keys_of


def task_to_data(spec: TaskSpec) -> dict[str, Any]:
    """The task as plain data; what is left to its default is not written.

    Fragments and includes are in it as what they stand for.
    """
    whole: dict[str, Any] = {
        key: _plain(getattr(spec, key))
        for key, field in TaskSpec.model_fields.items()
        if key not in ("background", "subtasks") and getattr(spec, key) != field.default
    }
    if spec.background:
        whole["background"] = [_step(b) for b in spec.background]
    whole["subtasks"] = [_step(s) for s in spec.subtasks]
    return whole


def task_to_yaml(spec: TaskSpec) -> str:
    """The task as YAML; what is left to its default is not written."""
    yaml: Any = YAML(typ="safe", pure=True)
    yaml.default_flow_style = None
    yaml.sort_base_mapping_type_on_output = False
    yaml.representer.ignore_aliases = lambda _: True
    yaml.width = 100
    stream = StringIO()
    yaml.dump(task_to_data(spec), stream)
    return stream.getvalue()


def _step(step: Background | SubTask) -> dict[str, Any]:
    """Our own keys, and beside them the primitive's: as a task file writes them."""
    written: dict[str, Any] = {"name": step.name}
    for key, name in keys_of(type(step)).items():
        value = getattr(step, name)
        if key not in ("name", "does") and value != type(step).model_fields[name].default:
            written[key] = _plain(value)
    parameters = step.does.model_dump(mode="json", exclude_defaults=True)
    parameters.pop("kind", None)
    return written | {"primitive": step.does.kind} | parameters


def _plain(value: Any) -> Any:
    """A value as YAML writes it."""
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    return [_plain(inner) for inner in value] if isinstance(value, tuple) else value

"""The reference of task files as Markdown: every key, made from the same schema as editors use."""

from typing import Any

from specs.schema import Schema, task_schema

HEAD = """\
# Every key of a task file

Made by `adonis schema --format markdown` from the models; what the keys are for is told in
[tasks.md](tasks.md). A key in **bold** must be given.
"""
UNBOUNDED = 1e6  # limits from here on only refuse nonsense, and are not worth saying


def reference(schema: Schema | None = None) -> str:
    """The whole reference.

    Args:
        schema: see `task_schema`; by default that of the package.
    """
    schema = schema or task_schema()
    definitions = schema["$defs"]
    kinds = [name for name in definitions if name.startswith("SubTask:")]
    common = set.intersection(*(set(definitions[kind]["properties"]) for kind in kinds))
    step = definitions[kinds[0]]
    own = {k: v for k, v in step["properties"].items() if k in common and k != "primitive"}
    beside = definitions[kinds[0].replace("SubTask", "Background")]["properties"]
    parts = [HEAD]
    parts.append(_section("The task", schema, "", required=("task", "subtasks")))
    parts.append(
        _section("Sub-task", {"properties": own}, _said(definitions["SubTask"]), ("name",))
    )
    also = f"{_said(definitions['Background'])} It has `name` and its primitive's parameters"
    keys = [key for key in own if key in beside and key != "name"]
    parts.append(f"## Background entry\n\n{also}{''.join(f', `{key}`' for key in keys)}.\n")
    parts += ["## Primitives\n\nTheir parameters stand beside the keys of the sub-task.\n"]
    for kind in kinds:
        found = definitions[kind]
        theirs = {k: v for k, v in found["properties"].items() if k not in common}
        required = tuple(found["required"])
        parts.append(
            _section(found["title"], {"properties": theirs}, _said(found), required, "###")
        )
    parts += ["## Parts\n\nWhat stands below the keys above.\n"]
    for name, found in definitions.items():
        if ":" not in name and "properties" in found and "anyOf" not in found:
            parts.append(
                _section(name, found, _said(found), tuple(found.get("required", ())), "###")
            )
    return "\n".join(parts)


def _section(
    title: str, schema: Schema, said: str, required: tuple[str, ...] = (), level: str = "##"
) -> str:
    """A heading, a sentence and a table of keys."""
    lines = [f"{level} {title}", ""] + ([said, ""] if said else [])
    rows = [
        f"| {f'**`{key}`**' if key in required else f'`{key}`'} | {_cell(_kind(value))} |"
        f" {_default(value)} | {_cell(_said(value))} |"
        for key, value in schema.get("properties", {}).items()
    ]
    if "additionalProperties" in schema and schema["additionalProperties"] is not False:
        rows.append(f"| any other name | {_cell(_kind(schema['additionalProperties']))} | | |")
    if rows:
        lines += ["| key | value | default | meaning |", "|---|---|---|---|", *rows, ""]
    return "\n".join(lines)


def _said(schema: Schema) -> str:
    said = str(schema.get("description", ""))
    return said[:1].upper() + said[1:] if said else ""


def _default(schema: Schema) -> str:
    given = schema.get("default")
    shown = {True: "yes", False: "no"}.get(given, given) if isinstance(given, bool) else given
    return "" if given in (None, "", {}) else f"`{shown}`"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _kind(schema: Any) -> str:
    """What a value can be, in words."""
    match schema:
        case {"$ref": str() as ref}:
            name = ref.rpartition("/")[2]
            places = {"SubTask": "sub-task", "Background": "background-entry"}
            said = f"[{name}](#{places.get(name, name.lower())})"
        case {"anyOf": choices}:
            found = [_kind(inner) for inner in choices if inner.get("type") != "null"]
            said = " or ".join(dict.fromkeys(found))
        case {"enum": values}:
            said = ", ".join(f"`{value}`" for value in values)
        case {"type": "array"}:
            said = _list(schema)
        case {"additionalProperties": dict()} | {"patternProperties": _}:
            said = f"names, each with {_kind(_each(schema))}"
        case {"type": "number" | "integer" as kind}:
            said = ("whole " if kind == "integer" else "") + "number" + _limits(schema)
        case {"type": "boolean"}:
            said = "`true`, `false`"
        case {"type": "string"}:
            said = "name" if "pattern" in schema else "text"
        case _:
            said = "anything"
    return said


def _each(schema: Schema) -> Any:
    """What is below each name of a mapping."""
    (inner,) = schema.get("patternProperties", {"": schema.get("additionalProperties")}).values()
    return inner


def _list(schema: Schema) -> str:
    least, most = schema.get("minItems"), schema.get("maxItems")
    inner = _kind(schema.get("items", {}))
    if least is not None and least == most:
        return f"list of {least}: {inner}"
    return f"list of {inner}"


def _limits(schema: Schema) -> str:
    """The limits of a number that are worth saying."""
    words = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    said = [
        f"{sign} {schema[k]:g}" for k, sign in words.items() if abs(schema.get(k, 1e9)) < UNBOUNDED
    ]
    return f" {', '.join(said)}" if said else ""

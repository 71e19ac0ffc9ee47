"""The schema and the reference that are shipped are those of the models, and say enough."""

import json
from pathlib import Path
from typing import Literal

import pytest
from jsonschema import Draft7Validator
from pydantic import BaseModel

from primitives import Primitive
from specs import SHIPPED_SCHEMA, available_primitives, library, reference, task_schema
from specs.describing import descriptions
from specs.reading import read_file, read_text
from specs.schema import schema_text

ROOT = Path(__file__).parents[2]
TASKS = [
    *(p for p in library().values() if p.suffix == ".yaml"),
    *sorted((ROOT / "examples").glob("*.yaml")),
]
GOOD = "task: x\nsubtasks:\n  - {name: a, primitive: go-to-point, limb: right_arm, to: head.top}\n"
FRAGMENT = "task: x\nfragments: {f: {parameters: {a: }, subtasks: [{name: s, primitive: hold, "


def test_what_is_shipped_is_current() -> None:
    """Else: adonis schema > specs/task.schema.json; and --format markdown > docs/reference.md."""
    assert SHIPPED_SCHEMA.read_text(encoding="utf-8") == schema_text()
    assert (ROOT / "docs" / "reference.md").read_text(encoding="utf-8") == reference()


def test_every_key_is_described() -> None:
    schema = task_schema()
    Draft7Validator.check_schema(schema)
    places = {"": schema, **schema["$defs"]}
    silent = [
        f"{name}.{key}"
        for name, found in places.items()
        for key, value in found.get("properties", {}).items()
        if not value.get("description") and set(value) != {"enum", "enumDescriptions"}
    ]
    assert not silent
    steps = {name.partition(":")[2] for name in schema["$defs"] if name.startswith("SubTask:")}
    assert steps == set(available_primitives())
    for kind in steps:
        found = schema["$defs"][f"SubTask:{kind}"]
        parameters = available_primitives()[kind].model_fields.keys() - {"kind"}
        assert parameters <= found["properties"].keys()
        assert f"### {kind}\n" in reference()


@pytest.mark.parametrize("path", TASKS, ids=lambda p: p.stem)
def test_every_task_that_there_is_fits(path: Path) -> None:
    found = Draft7Validator(task_schema()).iter_errors(read_file(path).data)
    assert [e.message for e in found] == []


@pytest.mark.parametrize(
    ("text", "fits"),
    [
        (GOOD, True),
        (GOOD.replace("limb", "limbs"), False),
        (GOOD.replace("to: head.top", "beats: 2"), False),
        (GOOD.replace("to: head.top", "to: head.top, beats: -2"), False),
        (GOOD.replace("to: head.top", "to: head.top, posture: rest"), False),
        (GOOD.replace("go-to-point", "go-to-pont"), False),
        (GOOD + "tempo: 0\n", False),
        (GOOD + "tempo_map: [{subtask: a, tempo: 90}]\n", True),
        (GOOD + "landmarks: {nose: {near: head.front, away: 0.1}, m: {between: [a, b]}}\n", True),
        (GOOD + "landmarks: {nose: {near: head.front, over: 0.1}}\n", False),
        (GOOD + "postures: {p: {from: rest, neck_y: 3, right_arm: {arm: up}}}\n", True),
        (GOOD + "postures: {p: {from: rest, neck_y: up}}\n", False),
        (GOOD + "include: [a.yaml]\n", True),
        ("landmarks: {nose: {near: head.front}}\n", True),
        ("task: x\n", False),
        (FRAGMENT + "limb: $a, beats: $a}]}}\nsubtasks: [{name: u, fragment: f}]\n", True),
        (FRAGMENT + "limb: $a, beats: many}]}}\nsubtasks: [{name: u, fragment: f}]\n", False),
        (FRAGMENT + "}]}}\nsubtasks: [{name: u, fragment: f, with: {a: [1]}, after: []}]\n", True),
        (FRAGMENT + "}]}}\nsubtasks: [{name: u, fragment: f, beats: 2}]\n", False),
        (GOOD.replace("head.top", "{near: $a}"), True),
        (GOOD.replace("to: head.top", "to: head.top, beats: $a"), False),
    ],
)
def test_it_allows_what_makes_sense(text: str, fits: bool) -> None:
    assert Draft7Validator(task_schema()).is_valid(read_text(text, "x").data) is fits


def test_comments_beside_fields_describe_them() -> None:
    class Own(BaseModel):
        """Something."""

        plain: int
        beside: int = 1  # [m] how far
        # below a line
        above: int = 2
        # In common, of both.
        one: int = 3  # the first
        other: int = 4

        far: int = 5

    class Heir(Own):
        plain: int = 0  # now it has one

    assert descriptions(Heir) == {
        "plain": "now it has one",
        "beside": "[m] how far",
        "above": "below a line",
        "one": "In common, of both: the first",
        "other": "In common, of both.",
    }


def test_a_primitive_of_ones_own_is_in_it() -> None:
    class Damp(Primitive):
        """Resist motion as if under water."""

        kind: Literal["damp"] = "damp"
        viscosity: float = 2.0  # [N m s/rad]

    schema = task_schema([Damp])
    own = schema["$defs"]["SubTask:damp"]
    assert own["description"] == "Resist motion as if under water."
    assert own["properties"]["viscosity"]["description"] == "[N m s/rad]"
    assert "| `viscosity` | number | `2.0` | [N m s/rad] |" in reference(schema)
    json.dumps(schema)

"""Reading task files: what is wrong is said once, with its place; never a traceback."""

import random
import textwrap
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import model_validator

from primitives import GoToPoint, Primitive
from sim import Body
from specs import (
    SpecError,
    bind_task,
    build_graph,
    library,
    load_task,
    task_from_text,
    task_to_yaml,
)

GOOD = textwrap.dedent("""\
    task: hello
    tempo: 60
    subtasks:
      - name: up
        primitive: go-to-point
        limb: right_arm
        to: head.top
        beats: 2
      - name: out
        primitive: get-posture
        limb: left_arm
        posture: {arm: forward, elbow: straight, palm: up}
    """)


def refused(text: str) -> SpecError:
    with pytest.raises(SpecError) as caught:
        task_from_text(text, "hello.yaml")
    return caught.value


def test_a_task_is_read_as_it_is_written() -> None:
    spec, _ = task_from_text(GOOD)
    assert [s.name for s in spec.subtasks] == ["up", "out"]
    assert isinstance(spec.subtasks[0].does, GoToPoint)
    graph = build_graph(spec)
    assert graph.lasts("up") == 2.0
    assert graph.lasts("out") == 1.0, "one beat unless told"


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("limb: right_arm", "limbs: right_arm", 6, "unknown key of a go-to-point 'limbs'"),
        ("limb: right_arm", "limbs: right_arm", 6, "did you mean 'limb'"),
        ("go-to-point", "go-to-pont", 5, "did you mean 'go-to-point'"),
        ("beats: 2", "beats: -2", 8, "greater than 0"),
        ("beats: 2", "beats: .nan", 8, "finite"),
        ("beats: 2", "beats: .inf", 8, "beats"),
        ("beats: 2", "beats: 2\n    seconds: 1", 4, "beats or seconds"),
        ("beats: 2", "stiffness: .nan", 8, "stiffness"),
        ("beats: 2", "stiffness: many", 8, "stiffness should be a valid number"),
        ("tempo: 60", "tempo: 0", 2, "tempo should be greater than or equal to 1"),
        ("tempo: 60", "tmpo: 60", 2, "unknown key 'tmpo'; did you mean 'tempo'"),
        ("tempo: 60", "tempo: 60\ntempo: 61", 3, "the key 'tempo' is given twice"),
        ("name: out", "name: up", 9, "the name 'up' is used twice (line 4)"),
        ("name: out", "name: a b", 9, "name is made of letters"),
        ("    to: head.top\n", "", 4, "'to' is missing"),
        ("primitive: go-to-point", "does: nothing", 4, "'primitive' is missing"),
        ("task: hello", "task: [hello]", 1, "task should be a valid string"),
        ("beats: 2", "done: reached", 4, "needs a tolerance and a timeout"),
        ("beats: 2", "timeout: 3", 4, "go with done: reached"),
        ("to: head.top", "to: {near: head.top, at: 3}", 7, "unknown key 'at'"),
        ("to: head.top", "to: {away: 3}", 7, "either near (a landmark) or point"),
        ("to: head.top", "to: head.top\n    via: [{near: head.left, at: 1.5}]", 8, "less than 1"),
        ("to: head.top", "to: {point: [1, 0]}", 7, "point: expected 3 values, not [1, 0]"),
        ("to: head.top", "to: {point: [1]}", 7, "point: expected 3 values, not [1]"),
        ("to: head.top", "to: {point: [1, 2, 3, 4]}", 7, "point: expected at most 3, not 4"),
        ("to: head.top", "to: {point: [0, .nan, 0]}", 7, "point, item 2, should be a finite"),
        ("beats: 2", "stiffness: 1.0e+300", 8, "less than or equal to 1000000000"),
        ("beats: 2", "damping: 1.0e+300", 8, "less than or equal to 1000000000"),
        ("head.top", "!!python/object:os.system x", 7, "the tag"),
        ("head.top", "[", 9, "not YAML"),
        ("head.top", "*nowhere", 7, "not YAML"),
    ],
)  # fmt: skip
def test_a_mistake_is_refused_at_its_place(old: str, new: str, line: int, said: str) -> None:
    assert old in GOOD
    error = refused(GOOD.replace(old, new, 1))
    assert said in error.message
    assert error.line == line
    assert str(error).startswith(f"hello.yaml:{line}:")
    assert "\n" not in error.message


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("- a\n- b\n", "expected keys and values"),
        ("task: x\nsubtasks: []\n", "subtasks: expected at least 1, not 0"),
        ("task: x\nsubtasks: 3\n", "expected a list"),
        ("task: x\n", "'subtasks' is missing"),
        ("subtasks: [3]\ntask: x\n", "expected keys and values"),
        ("? [a]\n: b\n", "a key must be a word"),
        ("a: " + "[" * 200 + "]" * 200, "nested deeper"),
        ("a: " + "[" * 20000, "nested deeper"),
        ("a: 1" + "0" * 6000, "is not a number"),
        ("a: \x00", "not YAML"),
    ],
)
def test_what_is_no_task_is_refused(text: str, said: str) -> None:
    assert said in refused(text).message


def test_a_bomb_of_aliases_does_not_go_off() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 10)]
    assert "aliases" in refused("\n".join(lines)).message


def test_files_are_refused_before_they_are_read(tmp_path: Path) -> None:
    huge = tmp_path / "huge.yaml"
    with huge.open("wb") as file:
        file.truncate(100_000_000)
    binary = tmp_path / "binary.yaml"
    binary.write_bytes(b"task: \xff\xfe")
    for path, said in (
        (huge, "100 MB"),
        (binary, "not UTF-8"),
        (tmp_path, "file"),
        (tmp_path / "missing.yaml", "No such file"),
    ):
        with pytest.raises(SpecError, match=said):
            load_task(path)
    with pytest.raises(SpecError, match="did you mean 'macarena'"):
        load_task("macarenna")


@pytest.mark.parametrize("name", sorted(library()))
def test_the_library_is_sound_and_survives_a_round_trip(name: str, body: Body) -> None:
    spec, document = load_task(name)
    bind_task(spec, body, document)
    again, _ = task_from_text(task_to_yaml(spec))
    assert again == spec


def test_the_macarena_is_the_paper_s_table_1_assigned_as_its_section_9_says() -> None:
    spec, _ = load_task("macarena")
    assert spec.tempo == 103
    assert [s.words for s in spec.subtasks] == [
        "Extend right arm straight out, palm down",
        "Extend left arm straight out, palm down",
        "Rotate right hand (palm up)",
        "Rotate left hand (palm up)",
        "Touch right hand to top of your left shoulder",
        "Touch left hand to top of your right shoulder",
        "Touch right hand to the back of your head",
        "Touch left hand to the back of your head",
        "Touch right hand to the left side of your ribs",
        "Touch left hand to the right side of your ribs",
        "Move right hand to your right hip",
        "Move left hand to your left hip",
    ]
    assert [s.does.kind for s in spec.subtasks] == ["get-posture"] * 4 + ["go-to-point"] * 8
    assert "avoid-collisions" in [b.does.kind for b in spec.background]


def test_a_primitive_of_one_s_own_is_an_argument() -> None:
    class Wobble(Primitive):
        """Shake a little."""

        kind: str = "wobble"
        strength: float = 1.0

    text = "task: x\nsubtasks: [{name: a, primitive: wobble, strength: 2}]"
    spec, _ = task_from_text(text, primitives=[Wobble])
    assert spec.subtasks[0].does == Wobble(strength=2)
    with pytest.raises(SpecError, match="unknown primitive 'wobble'"):
        task_from_text(text)


def test_a_validator_of_one_s_own_may_raise_anything() -> None:
    class Fragile(Primitive):
        """Breaks when it is read."""

        kind: str = "fragile"

        @model_validator(mode="after")
        def _check(self):
            return {}["missing"]

    text = "task: x\nsubtasks: [{name: a, primitive: fragile}]"
    with pytest.raises(
        SpecError, match=r"task:2:12: Fragile raised KeyError: 'missing' \(.*:\d+\)"
    ):
        task_from_text(text, primitives=[Fragile])


def test_a_task_needs_a_name() -> None:
    for name in ("", "  "):
        with pytest.raises(SpecError, match=r"expected a task: a file, or one of .*macarena"):
            load_task(name)
    with pytest.raises(SpecError, match="no such file, and unknown task of the library"):
        load_task("a" * 500)


TOKENS = [
    "{", "}", "[", "]", ":", "-", "&a", "*a", "!!int", "null", ".nan", "-1", "1e999", "''", "|",
    "\t", "\n", "  ", "#", "%", "@", "right_arm", "to", "via", "after", "primitive", "0x10", "\x07",
    "- name: x\n", "~", "2026-11-22", "yes", "<<", "?", ">", "é", "💃",
]  # fmt: skip


@settings(max_examples=300)
@given(st.integers(0, 10**9))
def test_a_damaged_task_file_is_read_or_refused(body: Body, seed: int) -> None:
    """Cut, doubled, spliced and peppered with what YAML finds interesting."""
    rng = random.Random(seed)
    text = library()["macarena"].read_text()
    for _ in range(rng.randint(1, 6)):
        i, j = sorted(rng.randrange(len(text) + 1) for _ in range(2))
        j = min(j, i + 200)
        match rng.randrange(4):
            case 0:
                text = text[:i] + text[j:]
            case 1:
                text = text[:j] + text[i:j] + text[j:]
            case 2:
                text = text[:i] + rng.choice(TOKENS) + text[i:]
            case 3:
                text = text[:i] + rng.choice(TOKENS) + text[j:]
    said = "mutant.yaml: sound"
    try:
        spec, document = task_from_text(text, "mutant.yaml")
        bind_task(spec, body, document)
    except SpecError as error:
        said = str(error)
    assert said.startswith("mutant.yaml")
    assert "\n" not in said

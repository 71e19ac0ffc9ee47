"""Values written back into a file: all else stays as it is, to the letter."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from specs import GONE, SpecError, places_of_steps, set_values, task_from_text, write_back
from specs.reading import read_text

TEXT = """\
# A dance.
task: hello   # its name
subtasks:
  - name: up        # comes first
    primitive: go-to-point
    limb: right_arm
    to: head.top    # touch it

    via: [{near: head.left, away: 0.1}]  # round the ear
  # and then
  - {name: down, primitive: get-posture, limb: right_arm, posture: rest}   # back
"""


def test_a_value_changes_and_its_comments_stay(tmp_path: Path) -> None:
    file = tmp_path / "hello.yaml"
    file.write_text(TEXT)
    write_back(
        file,
        {
            ("subtasks", 0, "to"): {"near": "head.top", "away": 0.05},
            ("subtasks", 0, "via", 0, "away"): 0.2,
            ("subtasks", 0, "beats"): 1.5,
            ("subtasks", 1, "stiffness"): 120.0,
            ("title",): "Hello: \"you\", # and all",
        },
    )  # fmt: skip
    assert file.read_text() == TEXT.replace(
        "to: head.top ", "to: {near: head.top, away: 0.05} "
    ).replace("away: 0.1}", "away: 0.2}").replace(
        "# round the ear\n", "# round the ear\n    beats: 1.5\n"
    ).replace("posture: rest}", "posture: rest, stiffness: 120.0}").replace(
        "# its name\n", "# its name\ntitle: 'Hello: \"you\", # and all'\n"
    )
    assert sorted(tmp_path.iterdir()) == [file]
    spec, _ = task_from_text(file.read_text())
    assert spec.subtasks[0].beats == 1.5


def test_keys_are_taken_out_with_their_lines_and_added_in_order() -> None:
    changed = set_values(
        TEXT,
        {
            ("subtasks", 0, "limb"): GONE,
            ("subtasks", 1, "limb"): GONE,
            ("subtasks", 0, "none"): GONE,
            ("subtasks", 0, "beats"): 2,
            ("subtasks", 0, "hand_over"): 0.2,
        },
    )
    assert changed == TEXT.replace("    limb: right_arm\n", "").replace(
        ", limb: right_arm, posture", ", posture"
    ).replace("# round the ear\n", "# round the ear\n    beats: 2\n    hand_over: 0.2\n")


def test_a_list_of_mappings_is_added_line_by_line() -> None:
    via = [{"near": "head.top", "at": 0.3}, {"near": "head.back", "away": 0.1}]
    text = TEXT.replace("    via: [{near: head.left, away: 0.1}]  # round the ear\n", "")
    changed = set_values(text, {("subtasks", 0, "via"): via})
    added = "    via:\n      - {near: head.top, at: 0.3}\n      - {near: head.back, away: 0.1}\n"
    assert changed == text.replace("# touch it\n", f"# touch it\n{added}")


def test_several_lines_are_taken_out_whole() -> None:
    text = TEXT.replace(
        "    via: [{near: head.left, away: 0.1}]  # round the ear\n",
        "    via:\n      - {near: head.left}   # one\n      - {near: head.back}   # two\n",
    )
    changed = set_values(text, {("subtasks", 0, "via"): GONE})
    assert changed == text[: text.index("    via:")] + text[text.index("  # and then") :]


def test_steps_are_found_by_their_names() -> None:
    assert places_of_steps(TEXT) == {"up": ("subtasks", 0), "down": ("subtasks", 1)}
    assert places_of_steps("task: none") == {}


@pytest.mark.parametrize(
    ("path", "text", "said"),
    [
        (("subtasks", 7, "beats"), TEXT, "hello.yaml:4:3: there is no subtasks.7.beats"),
        (("subtasks", 0, "to", "near"), TEXT, "hello.yaml:7:9: there is no subtasks.0.to.near"),
        (("subtasks", 0), TEXT, "4:5: a value over several lines is not replaced"),
        (("a",), "a: &x 1\nb: *x\n", "changed without changing more"),
        (("b", "c"), "a: &x {c: 1}\nb: *x\n", "changed without changing more"),
    ],
)
def test_what_cannot_be_set_is_refused(path: tuple[str | int, ...], text: str, said: str) -> None:
    with pytest.raises(SpecError) as caught:
        set_values(text, {path: 2}, "hello.yaml")
    assert said in str(caught.value)


def test_a_file_that_cannot_be_written_is_left_alone(tmp_path: Path) -> None:
    with pytest.raises(SpecError, match="No such file"):
        write_back(tmp_path / "none.yaml", {("task",): "x"})


VALUES = st.one_of(
    st.integers(-(10**9), 10**9),
    st.floats(allow_nan=False, allow_infinity=False),
    st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cs")), max_size=30),
    st.lists(st.floats(-5, 5), max_size=4),
    st.dictionaries(st.sampled_from("abc"), st.booleans(), max_size=3),
)


PLACES = [p for p in read_text(TEXT, "hello.yaml").positions if p not in ((), ("subtasks",))]


@given(st.sampled_from([p for p in PLACES if p != ("subtasks", 0)]), VALUES)
def test_any_value_can_be_set(path: tuple[str | int, ...], value: object) -> None:
    """What is read afterwards is that value, and the comments are all there."""
    changed = set_values(TEXT, {path: value})
    found = read_text(changed, "hello.yaml").data
    for step in path:
        found = found[step]
    assert found == value
    for comment in ("# A dance.", "# its name", "# comes first", "# touch it", "# and then"):
        assert comment in changed

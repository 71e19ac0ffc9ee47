"""Fragments and includes: what they become, and where their mistakes are said to be."""

import os
from pathlib import Path

import pytest

from sim import Body
from specs import SpecError, bind_task, build_graph, load_task, task_from_text, task_to_yaml

TASK = """\
task: x
fragments:
  tap:
    parameters: {limb: , place: , pause: 1}
    subtasks:
      - {name: go, primitive: go-to-point, limb: $limb, to: $place}
      - {name: back, primitive: get-posture, limb: $limb, posture: rest, beats: $pause}
  both:
    parameters: {place: head.top}
    subtasks:
      - {name: l, fragment: tap, with: {limb: left_arm, place: $place, pause: 2}}
      - {name: r, fragment: tap, with: {limb: right_arm, place: {near: $place, away: 0.1}},
         after: []}
subtasks:
  - {name: zero, primitive: get-posture, joints: [neck], posture: upright, words: costs $5}
  - {name: one, fragment: tap, with: {limb: right_arm, place: chest.front}}
  - {name: two, fragment: both}
  - {name: nod, primitive: get-posture, joints: [neck_y], posture: {neck_y: 10}}
  - {name: end, primitive: hold, joints: [waist], after: {any: [one, two.l.go]}}
"""
BY_HAND = """\
task: x
subtasks:
  - {name: zero, primitive: get-posture, joints: [neck], posture: upright, words: costs $5}
  - {name: one.go, primitive: go-to-point, limb: right_arm,
     to: chest.front, after: [zero]}
  - {name: one.back, primitive: get-posture, limb: right_arm, posture: rest, beats: 1}
  - {name: two.l.go, primitive: go-to-point, limb: left_arm,
     to: head.top, after: [one.back]}
  - {name: two.l.back, primitive: get-posture, limb: left_arm, posture: rest, beats: 2}
  - {name: two.r.go, primitive: go-to-point, limb: right_arm,
     to: {near: head.top, away: 0.1}, after: [one.back]}
  - {name: two.r.back, primitive: get-posture, limb: right_arm, posture: rest, beats: 1}
  - {name: nod, primitive: get-posture, joints: [neck_y], posture: {neck_y: 10},
     after: [two.l.back, two.r.back]}
  - {name: end, primitive: hold, joints: [waist], after: {any: [one.back, two.l.go]}}
"""


def test_fragments_become_the_subtasks_that_one_would_write_by_hand(body: Body) -> None:
    spec, document = task_from_text(TASK, "x")
    by_hand, _ = task_from_text(BY_HAND)
    assert spec == by_hand
    assert task_from_text(task_to_yaml(spec))[0] == spec
    bind_task(spec, body, document)


def test_only_texts_and_numbers_are_put_into_a_text() -> None:
    text = TASK.replace("name: go,", 'name: go, words: "Tap $place",')
    with pytest.raises(SpecError, match=r"x:12:65: 'place' is put into a text: expected a text"):
        task_from_text(text, "x")


def fragment(subtasks: str, use: str, more: str = "") -> str:
    return (
        f"task: x\nfragments:\n  f:\n    parameters: {{a: , b: 1}}\n    subtasks:\n{subtasks}\n"
        f"subtasks:\n  - {{name: first, primitive: hold, limb: left_arm}}\n{use}\n{more}"
    )


HOLD = "primitive: hold, joints: [waist]"


@pytest.mark.parametrize(
    ("value", "became"),
    [("3", "3"), ("'3'", "3"), ("true", "true"), ("1.5", "1.5"), ("'$b'", "$b"),
     ("'{{b}}'", "{{b}}"),
     ("__import__('os')", "__import__('os')")],
)  # fmt: skip
def test_an_argument_is_put_in_and_nothing_is_computed(value: str, became: str) -> None:
    text = fragment(
        f"      - {{name: s, {HOLD}, words: 'a ${{a}}b $a'}}",
        f"  - {{name: u, fragment: f, with: {{a: {value}}}}}",
    )
    spec, _ = task_from_text(text)
    assert spec.subtasks[1].words == f"a {became}b {became}"


def test_names_are_looked_up_from_the_inside_out() -> None:
    text = fragment(
        f"      - {{name: first, {HOLD}, done: {{event: e}}, timeout: 1, otherwise: out}}\n"
        f"      - {{name: in, {HOLD}, after: [first]}}\n"
        f"      - {{name: beside, {HOLD}, while: first}}",
        "  - {name: u, fragment: f, with: {a: 1}, after: [first]}\n"
        f"  - {{name: out, {HOLD}}}\n"
        "  - {name: v, fragment: f, with: {a: 1}, after: [u, out]}",
        "groups: [{name: g, members: [u, v.in]}]\ntempo_map: [{subtask: v, tempo: 90}]",
    )
    spec, _ = task_from_text(text)
    by_name = {s.name: s for s in spec.subtasks}
    assert by_name["u.first"].after == ("first",), "the one outside, though one inside is called so"
    assert by_name["u.in"].after == ("u.first",)
    assert by_name["u.beside"].while_ == "u.first"
    assert by_name["u.first"].otherwise == "out"
    assert by_name["v.first"].after == ("u.in", "out"), "what runs beside does not end it"
    assert spec.groups[0].members == ("u.first", "u.in", "u.beside", "v.in")
    assert spec.tempo_map[0].subtask == "v.first"


def test_a_fragment_can_begin_instead_of_something() -> None:
    text = fragment(
        f"      - {{name: s, {HOLD}}}\n      - {{name: t, {HOLD}}}",
        f"  - {{name: ask, {HOLD}, done: {{event: e}}, timeout: 1, otherwise: u}}\n"
        f"  - {{name: yes, {HOLD}}}\n"
        "  - {name: u, fragment: f, with: {a: 1}}\n"
        f"  - {{name: home, {HOLD}, after: [yes, u]}}",
    )
    spec, document = task_from_text(text)
    graph = build_graph(spec, document)
    assert graph.graph.edges["ask", "u.s"]["kind"] == "otherwise"
    assert spec.subtasks[-1].after == ("yes", "u.t")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("place: chest.front", "place: chest.font", "16:63: one.go: unknown landmark 'chest.font'"),
        ("posture: rest", "posture: rust", "7:68: one.back: unknown posture 'rust'"),
        ("pause: 2", "pause: -2", "11:79: beats should be greater than 0, not -2"),
        ("pause: 1", "pause: x", "4:42: beats should be a valid number"),
        ("beats: $pause", "beats: $pose", "7:81: unknown parameter of 'tap' 'pose'"),
        ("beats: $pause", "beets: $pause", "7:74: unknown key of a get-posture 'beets'"),
        ("tap, with: {limb: r", "tup, with: {limb: r", "12:29: unknown fragment 'tup'"),
        ("limb: right_arm, place: chest.front", "limb: right_arm", "16:5: one: 'place' of the"),
        ("place: chest.front", "plaice: head.top", "16:56: unknown parameter of 'tap' 'plaice'"),
        ("fragment: both", "fragment: both, beats: 2", "17:33: unknown key 'beats'"),
        ("fragment: both", "fragment: both, after: [nine]", "17:41: unknown sub-task 'nine'"),
        ("[one, two.l.go]", "[one, two]", "19:70: 'two' ends with several sub-tasks"),
        ("fragment: tap, with: {limb: left_arm, place: $place, pause: 2}", "fragment: both",
         "11:29: a fragment uses itself: both -> both"),
        ("parameters: {place: head.top}", "parameters: {Place: head.top}", "9:25: Place is made"),
        ("parameters: {place: head.top}", "params: {place: head.top}", "9:5: unknown key 'params'"),
        ("  - {name: nod", "  - - {name: nod", "expected keys and values: name, primitive"),
        ("name: end", "name: one.go", "19:12: the name 'one.go' is used twice (line 6)"),
        ("words: costs $5", "words: costs $5, after: [nine]", "unknown sub-task 'nine'"),
    ],
)  # fmt: skip
def test_a_mistake_is_said_where_it_was_written(body: Body, old: str, new: str, said: str) -> None:
    assert old in TASK
    with pytest.raises(SpecError) as caught:
        bind(TASK.replace(old, new, 1), body)
    assert said in str(caught.value)
    assert caught.value.excerpt


def bind(text: str, body: Body) -> None:
    spec, document = task_from_text(text, "x")
    bind_task(spec, body, document)


def test_what_grows_without_end_is_refused() -> None:
    lines = ["task: x", "subtasks: [{name: u, fragment: f40, with: {a: x}}]", "fragments:"]
    lines += ["  f0: {parameters: {a: 1}, subtasks: [{name: s, primitive: hold, joints: [$a]}]}"]
    for k in range(1, 41):
        uses = ", ".join(
            f"{{name: u{j}, fragment: f{k - 1}, with: {{a: [$a, $a]}}}}" for j in range(3)
        )
        lines.append(f"  f{k}: {{parameters: {{a: 1}}, subtasks: [{uses}]}}")
    with pytest.raises(SpecError, match=r"more than|deeper than"):
        task_from_text("\n".join(lines))


# --- includes -----------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    top = tmp_path / "dances"
    (top / "parts").mkdir(parents=True)
    (tmp_path / "secret.yaml").write_text("postures: {secret: {from: rest}}\n")
    (top / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    (top / "out").symlink_to(tmp_path)
    (top / "parts" / "all.yaml").write_text(
        "include: [places.yaml, moves.yaml]\nbackground:\n"
        "  - {name: weight, primitive: compensate-gravity}\n"
    )
    (top / "parts" / "moves.yaml").write_text(
        "include: [places.yaml]\nfragments:\n  tap:\n    parameters: {limb: right_arm}\n"
        "    subtasks:\n      - {name: go, primitive: go-to-point, limb: $limb, to: heart}\n"
    )
    (top / "parts" / "places.yaml").write_text(
        "landmarks:\n  heart: {near: chest.front, offset: [0, 0.05, 0]}\n"
    )
    (top / "parts" / "loop.yaml").write_text("include: [back.yaml]\n")
    (top / "parts" / "back.yaml").write_text("include: [loop.yaml]\n")
    (top / "parts" / "task.yaml").write_text("task: y\n")
    return top


def dance(folder: Path, include: str, more: str = "") -> Path:
    file = folder / "dance.yaml"
    file.write_text(
        f"task: x\ninclude: {include}\nsubtasks:\n  - {{name: u, fragment: tap}}\n{more}"
    )
    return file


def test_definitions_come_from_files_below(folder: Path, body: Body) -> None:
    own = "background:\n  - {name: still, primitive: get-posture, joints: [waist], posture: rest}\n"
    spec, document = load_task(dance(folder, "[parts/all.yaml]", own))
    assert [b.name for b in spec.background] == ["weight", "still"]
    assert list(spec.landmarks) == ["heart"], "included twice, there once"
    bind_task(spec, body, document)
    moves = folder / "parts" / "moves.yaml"
    moves.write_text(moves.read_text().replace("to: heart", "to: hart"))
    spec, document = load_task(dance(folder, "[parts/all.yaml]"))
    with pytest.raises(SpecError) as caught:
        bind_task(spec, body, document)
    assert str(caught.value).startswith(
        f"{moves}:6:61: u.go: unknown landmark 'hart'; did you mean"
    )
    assert "to: hart}" in caught.value.excerpt


@pytest.mark.parametrize(
    ("include", "said"),
    [
        ("[../secret.yaml]", "'../secret.yaml' may lead out of the task's folder"),
        ("[parts/../../secret.yaml]", "may lead out of the task's folder"),
        ("[/etc/passwd]", "may lead out of the task's folder"),
        ("['C:\\secret.yaml']", "may lead out of the task's folder"),
        ("[link.yaml]", "'link.yaml' goes through a symbolic link"),
        ("[out/secret.yaml]", "'out/secret.yaml' goes through a symbolic link"),
        ("[parts/none.yaml]", "'parts/none.yaml' cannot be read: No such file"),
        ("[parts]", "'parts' is not a file"),
        (f"[parts/{'9' * 400}.yaml]", "cannot be read: File name too long"),
        ("[parts/pipe]", "'parts/pipe' is not a file"),
        (
            "[parts/loop.yaml]",
            "include each other: loop.yaml -> back.yaml -> loop.yaml",
        ),
        ("[dance.yaml]", "these files include each other: dance.yaml -> dance.yaml"),
        ("[parts/task.yaml]", "task.yaml:1:1: unknown key of an included file 'task'"),
        ("parts/all.yaml", "dance.yaml:2:10: include: expected a list of files"),
        ("[3]", "dance.yaml:2:11: include: expected the name of a file"),
        ('["a\\0b"]', "dance.yaml:2:11: include: expected the name of a file"),
    ],
)
def test_includes_stay_in_the_folder(folder: Path, include: str, said: str) -> None:
    os.mkfifo(folder / "parts" / "pipe")
    with pytest.raises(SpecError) as caught:
        load_task(dance(folder, include))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
    assert caught.value.excerpt


def test_what_is_defined_twice_is_refused(folder: Path) -> None:
    file = dance(folder, "[parts/all.yaml]", "landmarks: {heart: {near: head.top}}\n")
    places = folder / "parts" / "places.yaml"
    with pytest.raises(SpecError) as caught:
        load_task(file)
    assert str(caught.value) == f"{file}:5:13: 'heart' is defined twice ({places}:2)"


def test_a_text_includes_nothing() -> None:
    with pytest.raises(SpecError, match="only a task in a file can include others"):
        task_from_text("task: x\ninclude: [a.yaml]\nsubtasks: []\n")

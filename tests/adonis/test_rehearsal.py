"""Rehearsal: ways are found, they pass the judge, and the same ones are found again."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner

from adonis.cli import app
from adonis.dancing import run_task
from adonis.judging import judge
from adonis.keeping import read_kept
from adonis.performing import perform_rehearsal
from adonis.rehearsal import keeping, searching
from adonis.rehearsal.keeping import rehearsed, task_text
from adonis.rehearsal.rehearsing import rehearse
from adonis.rehearsal.searching import Rehearsed, with_ways, without_ways
from adonis.rehearsal.stage import Walk, play
from primitives import GoToPoint
from sim import Body
from specs import bind_task, find_task, load_task, task_from_text

TEXT = """\
# A hand that would go through the head.
task: brow
rehearse: true   # English tasks do
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: arms, primitive: get-posture, joints: [right_arm, left_arm], posture: rest}
  - {name: guard, primitive: avoid-collisions}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - name: nape     # barred by the face
    primitive: go-to-point
    limb: right_arm
    to: head.back_right
  - name: out      # nothing is in the way
    primitive: go-to-point
    limb: left_arm
    to: {point: [0.35, 0.25, 0.1]}
"""


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A cache of our own; and fewer ways than usual, which are enough for an easy task."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("platformdirs.user_cache_path", lambda name: folder / name)
        patch.setattr(searching, "FIRST", 16)
        patch.setattr(searching, "AGAIN", 16)
        patch.setattr(searching, "KEPT", 5)
        yield folder


@pytest.fixture(scope="module")
def found(body: Body) -> dict[str, Rehearsed]:
    _, ways = rehearsed(task_from_text(TEXT)[0], body)
    return ways


def test_the_ways_found_pass_where_the_straight_way_does_not(
    body: Body, found: dict[str, Rehearsed]
) -> None:
    spec, _ = task_from_text(TEXT)
    (straight,) = run_task(bind_task(spec, body))
    assert not judge(straight, spec).verdicts[0].success
    ways = with_ways(spec, {name: way.does for name, way in found.items()})
    (recording,) = run_task(bind_task(ways, body))
    assert judge(recording, ways).success
    assert found["nape"].grade.passes
    assert found["nape"].does.via


def test_a_straight_way_that_passes_is_kept(found: dict[str, Rehearsed]) -> None:
    assert found["out"].does.via == ()
    assert found["out"].does.upper_arm is None
    assert found["out"].tried == 1


def test_the_same_task_gets_the_same_ways_and_goes_on_from_those_known(
    body: Body, found: dict[str, Rehearsed]
) -> None:
    spec, _ = task_from_text(TEXT)
    again = rehearse(spec, body, known={"nape": found["nape"]})
    assert again == found


def test_what_follows_a_scene_is_what_would_have_followed(body: Body) -> None:
    """Bit by bit: the body, the arbiter and the solver of the contacts go on as they were."""
    spec, _ = task_from_text(TEXT)
    task = bind_task(spec, body)
    (whole,) = run_task(task)
    scene = Walk(task).next({"out"})
    assert scene is not None
    parts = play([task, task], scene, 0.5)
    for part in parts:
        assert part is not None
        first = whole.row(float(part.time[0]))
        rows = slice(first, first + len(part.time))
        np.testing.assert_array_equal(part.qpos, whole.qpos[rows])
        np.testing.assert_array_equal(part.torque, whole.torque[rows])


def test_what_comes_later_is_held_back(body: Body) -> None:
    task = bind_task(task_from_text(TEXT)[0], body)
    scene = Walk(task).next({"nape"})
    assert scene is not None
    (part,) = play([task], scene, 1.2, alone=True)
    assert part is not None
    assert [s.outcome for s in part.spans] == ["done", "pending"]


@pytest.mark.parametrize(
    "more", ["safety: filter\n", "groups: [{name: g, rule: sum, members: [nape]}]\n"]
)
def test_a_task_that_cannot_be_entered_midway_is_played_from_its_beginning(
    body: Body, more: str
) -> None:
    task = bind_task(task_from_text(TEXT + more)[0], body)
    scene = Walk(task).next({"out"})
    assert scene is not None
    assert scene.place is None
    assert scene.time > 0.9
    (part,) = play([task], scene, 0.1)
    assert part is not None
    assert part.time[0] == 0.0
    assert part.time[-1] > scene.time


def test_only_hands_without_a_way_are_rehearsed() -> None:
    spec, _ = task_from_text(
        TEXT.replace("to: head.back_right", "to: head.back_right\n    via: [{near: head.top}]")
    )
    assert [s.lacks_way for s in spec.subtasks] == [False, True]


def test_ways_of_touches_can_be_forgotten_and_no_others() -> None:
    spec, _ = load_task("macarena")
    forgotten = without_ways(spec)
    assert forgotten.rehearse
    for before, after in zip(spec.subtasks, forgotten.subtasks, strict=True):
        if isinstance(before.does, GoToPoint):
            assert after.lacks_way
            assert (after.does.to, after.does.upper_arm) == (before.does.to, None)
    conductor, _ = load_task("conductor")  # whose hands draw what they beat
    assert without_ways(conductor).subtasks == conductor.subtasks


def test_what_is_known_is_not_looked_for_again(
    body: Body, monkeypatch: pytest.MonkeyPatch, found: dict[str, Rehearsed]
) -> None:
    spec, _ = task_from_text(TEXT)
    done, ways = rehearsed(spec, body)
    assert ways == found
    assert not done.rehearse

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("it looked again")

    monkeypatch.setattr(searching.Search, "_try", refuse)
    assert rehearsed(spec, body) == (done, ways)
    with pytest.raises(AssertionError, match="looked again"):
        rehearsed(spec, body, afresh=True)
    with pytest.raises(AssertionError, match="looked again"):
        rehearsed(spec, body, seed=1)


def test_a_damaged_cache_is_none(cache: Path) -> None:
    spec, _ = task_from_text(TEXT)
    file = cache / "bad.json"
    assert read_kept(file) is None
    for text in ("", "[]", "{}", '{"nape": 3}', '{"nape": {"does": {}, "grade": {}, "tried": 1}}'):
        file.write_text(text)
        assert keeping._ways_in(read_kept(file), spec) == {}


def test_ways_are_written_beside_the_comments(found: dict[str, Rehearsed]) -> None:
    spec, _ = task_from_text(TEXT)
    ways = with_ways(spec, {name: way.does for name, way in found.items()})
    text = task_text(ways, found, TEXT)
    assert "# A hand that would go through the head." in text
    assert "# barred by the face" in text
    assert "\n\n" not in text
    back, _ = task_from_text(text)
    assert back == ways.model_copy(update={"rehearse": False})
    assert isinstance(back.subtasks[0].does, GoToPoint)
    anew, _ = task_from_text(task_text(ways, found, "task: elsewhere"))
    assert anew.subtasks == ways.subtasks


def test_the_command_writes_the_task(tmp_path: Path, found: dict[str, Rehearsed]) -> None:
    file, out = tmp_path / "brow.yaml", tmp_path / "done.yaml"
    file.write_text(TEXT)
    ended = CliRunner().invoke(app, ["rehearse", str(file), "--out", str(out)])
    assert ended.exit_code == 0, ended.output
    assert "nape: by way of" in ended.output
    assert task_from_text(out.read_text())[0].subtasks[0].does == found["nape"].does


def test_a_lesson_is_rehearsed_before_it_is_danced(body: Body, tmp_path: Path) -> None:
    """Two sentences of the Macarena in words; by the straight way the hand meets the head."""
    lines = find_task("macarena-words").read_text().splitlines()
    head = [line for line in lines if not line[:1].isdigit()]
    file, out = tmp_path / "nape.txt", tmp_path / "nape"
    file.write_text("\n".join([*head, lines[len(head)], lines[len(head) + 6]]))
    spec, document = load_task(file)
    assert [s.words for s in spec.subtasks] == [
        "Extend right arm straight out, palm down",
        "Touch right hand to the back of your head",
    ]
    (straight,) = run_task(bind_task(spec, body, document))
    assert not judge(straight, spec).success
    ended = CliRunner().invoke(app, ["run", str(file), "--out", str(out)])
    assert ended.exit_code == 0, ended.output


def test_what_a_task_defines_is_there_in_its_rehearsal(body: Body) -> None:
    """Names, gains and objects of the task's own are put in once, and seen by the search."""
    text = TEXT.replace("to: head.back_right", "to: nape-left").replace(
        "background:",
        "landmarks: {nape-left: {near: head.back_left}}\ngains: {hands: 1.2}\n"
        "scene: {pole: {cylinder: [0.05, 1.0], at: [0.35, 0.5, 1.2]}}\nbackground:",
    )
    bound = bind_task(task_from_text(text)[0], body)
    made, ways = perform_rehearsal(Console(quiet=True), bound, seed=0, afresh=True)
    assert set(ways) == {"nape", "out"}
    assert made.body.map == bound.body.map, "neither gains nor objects twice"
    spring = body.map.limbs["left_arm"].spring
    assert made.body.map.limbs["left_arm"].spring.stiffness == pytest.approx(1.2 * spring.stiffness)
    assert ways["nape"].grade.passes

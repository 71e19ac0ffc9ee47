"""The scene of a task: what is read, what is refused, and what follows from it for the body."""

import numpy as np
import pytest

from adonis.dancing import run_task
from adonis.judging import judge
from sim import Body, Replay, load_body, places_of
from specs import (
    BoundTask,
    SpecError,
    bind_task,
    fitness_of,
    fitted,
    lint_task,
    load_task,
    task_from_text,
    task_to_yaml,
)

SCENE = """\
task: own
tempo: 120
tempo_map: [{beat: 2, tempo: 60}]
scene:
  table: {box: [0.4, 0.8, 0.04], at: [0.5, 0, 0.9]}
  ball:
    sphere: 0.05
    at: {near: table.top, away: 0.25, offset: [-0.1, -0.3, 0]}
    moves:
      - {beat: 1, beats: 2, to: [0.45, -0.1, 1.3]}
      - {beat: 4, to: {near: chest.front, away: 0.3}}
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: guard, primitive: avoid-collisions}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - name: touch
    primitive: go-to-point
    limb: right_arm
    to: ball.front
    upper_arm: [0.1, -0.6, -1]
    beats: 4
    done: {near: ball.front, limb: right_arm, distance: 0.03}
    timeout: 4
  - {name: hold-on, primitive: follow, limb: right_arm, to: ball.front, beats: 2}
"""


def bind(text: str, body: Body) -> BoundTask:
    spec, document = task_from_text(text, "own.yaml")
    return bind_task(spec, body, document)


def where(body: Body, name: str) -> np.ndarray:
    place: np.ndarray = places_of(body, body.home, [body.landmark(name)])[0]
    return place


def test_places_are_of_the_world_or_near_a_landmark(body: Body) -> None:
    bound = bind(SCENE, body)
    assert where(bound.body, "ball.centre") == pytest.approx([0.4, -0.3, 1.17])
    chest = body.landmark("chest.front")
    out = body.from_link(chest.link, chest.normal)
    first, then = bound.body.map.objects["ball"]
    assert then.to == pytest.approx(where(body, "chest.front") + 0.3 * out)
    assert "ball" not in body.map.objects, "the body itself stays as it is"
    assert (first.start, first.lasts) == pytest.approx((0.5, 1.5)), "across a change of tempo"
    assert (then.start, then.lasts) == pytest.approx((3.0, 1.0))


def test_what_is_touched_is_where_it_is_carried_to(body: Body) -> None:
    """The goal of each sub-task is where the ball is planned to be then."""
    bound = bind(SCENE, body)
    for name in bound.graph.order:
        later = bound.body_for(name)
        assert not np.allclose(where(later, "ball.front"), where(bound.body, "ball.front"))
    servo = bind(SCENE.replace("upper_arm: [0.1, -0.6, -1]", "controller: pd-servo"), body)
    field, posture = servo.fields[0], body.home.copy()
    dofs = field.claims
    posture[body.qpos_of_dof[dofs]] = field.goal[dofs]  # type: ignore[attr-defined]
    (palm,) = places_of(body, posture, [body.arm("right_arm").palm])
    assert palm == pytest.approx(where(servo.body_for("touch"), "ball.front"), abs=0.005)


def test_it_is_danced_judged_and_foreseen(body: Body) -> None:
    spec, document = task_from_text(SCENE, "own.yaml")
    bound = bind_task(spec, body, document)
    assert [f.code for f in lint_task(bound, document) if f.severity == "error"] == []
    alone, (one, two) = run_task(bound)[0], run_task(bound, n=2)
    for recording in (one, two):
        np.testing.assert_array_equal(recording.qpos, alone.qpos)
        np.testing.assert_array_equal(recording.objects, alone.objects)
    for verdicts in (judge(alone, spec), judge(alone)):
        assert [v.success for v in verdicts.verdicts] == [True] * 2
    ball = Replay(alone).site("ball.centre").position
    assert ball[0] == pytest.approx(where(bound.body, "ball.centre"))
    assert ball[-1] == pytest.approx(bound.body.map.objects["ball"][1].to)


def test_a_ball_carried_elsewhere_than_the_hand_is_a_miss(body: Body) -> None:
    """The judge goes by the recorded places, not by the task."""
    spec, document = task_from_text(SCENE, "own.yaml")
    (recording,) = run_task(bind_task(spec, body, document))
    recording.objects[:, 1] += [0.0, 0.1, 0.0]
    assert not judge(recording, spec).verdicts[1].success


def test_it_stays_itself_on_another_body_unless_it_scales(body: Body) -> None:
    child, text = load_body("adonis-child"), SCENE.replace("tempo: 120", "tempo: 120\nbody: adonis")
    spec, _ = task_from_text(text.replace("at: [0.5, 0, 0.9]", "at: [0.5, 0, 0.9], scales: true"))
    made = fitted(spec, child)
    ratio = child.reach(child.arm("right_arm")) / body.reach(body.arm("right_arm"))
    table, ball = made.scene["table"], made.scene["ball"]
    assert table.box == pytest.approx(np.multiply(spec.scene["table"].box, ratio), rel=1e-3)
    assert table.at == pytest.approx((0.5 * ratio, 0.0, 0.9 * ratio), rel=1e-3)
    assert ball == spec.scene["ball"]
    whole, _ = task_from_text(
        text.replace("sphere: 0.05", "sphere: 0.05\n    scales: true"),
    )
    near = fitted(whole, child).scene["ball"].at
    assert near.away == pytest.approx(0.25 * ratio, rel=1e-3)  # type: ignore[union-attr]


def test_what_is_out_of_reach_for_a_body_is_said(body: Body) -> None:
    far = SCENE.replace("[0.45, -0.1, 1.3]", "[1.2, -0.1, 1.3]")
    bound = bind(far, body)
    found = {f.code: f for f in lint_task(bound) if f.severity == "error"}
    assert found["out-of-reach"].subtask == "touch"
    touch, _ = fitness_of(bound.spec, body)
    assert (touch.verdict, touch.unit) == ("partly", "m")
    assert touch.short == pytest.approx(dict(found["out-of-reach"].numbers)["short"], abs=0.01)


def test_a_way_into_the_table_is_foreseen(body: Body) -> None:
    below = SCENE.replace("at: [0.5, 0, 0.9]", "at: [0.45, 0, 1.0]").replace(
        "to: ball.front\n    upper_arm: [0.1, -0.6, -1]", "to: table.edge"
    )
    below = below.replace("tempo: 120", "rehearse: true")  # a way round is not looked for
    found = [f for f in lint_task(bind(below, body)) if f.subtask == "touch"]
    assert any(f.code in ("stuck", "collision") and "table" in f.what for f in found)


def test_a_scene_is_written_and_read_again() -> None:
    spec, _ = task_from_text(SCENE)
    again, _ = task_from_text(task_to_yaml(spec))
    assert again == spec


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("box:", "bax:", "5:11: unknown key 'bax'; did you mean 'box'?"),
        ("sphere: 0.05", "sphere: 0.05\n    box: [1, 1, 1]", "one shape, box, sphere or cylinder"),
        ("sphere: 0.05\n    ", "", "one shape, box, sphere or cylinder, not none"),
        ("sphere: 0.05", "sphere: -1", "7:13: sphere should be greater than 0, not -1"),
        ("[0.4, 0.8, 0.04]", "[0.4, 0.8]", "5:16: box: expected 3 values, not [0.4, 0.8]"),
        (", at: [0.5, 0, 0.9]", "", "5:10: 'at' is missing"),
        ("table:", "head:", "5:3: 'head' is a link of adonis: take another name"),
        ("ball:\n", "right_arm:\n", "6:3: 'right_arm' is a limb of adonis"),
        ("near: table.top", "near: tabel.top", "8:16: ball: unknown landmark 'tabel.top'"),
        ("near: table.top", "near: ball.top", "8:16: ball: unknown landmark 'ball.top'"),
        ("beat: 4, to", "beat: 2, to", "the one at beat 2 begins before that at beat 1 is over"),
        ("at: [0.5, 0, 0.9]", "at: [0.1, 0, 0.9]", "5:38: table overlaps the pelvis of adonis by"),
        ("to: ball.front", "to: ball.edge", "20:9: touch: unknown landmark 'ball.edge'"),
    ],
)
def test_what_makes_no_sense_is_refused_at_its_place(
    body: Body, old: str, new: str, said: str
) -> None:
    assert old in SCENE
    with pytest.raises(SpecError) as caught:
        bind(SCENE.replace(old, new, 1), body)
    assert said in str(caught.value)
    assert caught.value.excerpt


def test_values_are_set_from_outside() -> None:
    spec, _ = load_task("drumming")
    changes = [
        "scene.table.at=[0.4, 0, 1]", "scene.table.turn=10", "subtasks.r1.down.beats=2", "tempo=90"
    ]  # fmt: skip
    made, _ = load_task("drumming", changes=changes)
    assert made.scene["table"].at == (0.4, 0.0, 1.0)
    assert made.scene["table"].turn == 10
    assert made.scene["ball"] == spec.scene["ball"]
    assert [s.beats for s in made.subtasks] == [2, *(s.beats for s in spec.subtasks[1:])]
    assert made.tempo == 90
    assert load_task("macarena-words", changes=["tempo=77"])[0].tempo == 77, "a lesson too"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("tempo", "--set: expected PATH=VALUE, such as tempo=90, not 'tempo'"),
        ("tempo=", "--set: expected PATH=VALUE"),
        ("tempo=fast", "--set:1:7: tempo should be a valid number"),
        ("tempi=90", "--set:1:7: unknown key 'tempi'; did you mean 'tempo'"),
        ("scene.tabel.at=[0, 0, 0]", "scene.tabel.at: unknown key or name 'tabel'; did you mean"),
        ("subtasks.r3.down.beats=1", "unknown key or name 'r3'"),
        ("subtasks.r1.down.beats.x=1", "unknown key or name 'beats'"),
        ("scene.table.at=[0, 0", "--set:1:"),
    ],
)
def test_what_cannot_be_set_is_refused(change: str, said: str) -> None:
    with pytest.raises(SpecError) as caught:
        load_task("drumming", changes=[change])
    assert said in str(caught.value)


def test_findings_about_what_is_set_stand_there(body: Body) -> None:
    spec, document = load_task("drumming", changes=["subtasks.r1.down.to=ball.centre"])
    first = spec.model_copy(update={"subtasks": spec.subtasks[:1]})
    (finding,) = (
        f for f in lint_task(bind_task(first, body, document), document) if f.severity == "error"
    )
    assert (finding.code, finding.place) == ("inside-body", "--set:1:21")
    assert finding.what == "the goal is 9.0 cm inside the ball"

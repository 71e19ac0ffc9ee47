"""Landmarks and postures that a task defines: they work wherever the body's own do."""

import mujoco
import numpy as np
import pytest

from adonis.dancing import run_task
from adonis.judging import judge
from sim import Body, load_body
from specs import BoundTask, SpecError, bind_task, task_from_text

OWN = """\
task: own
landmarks:
  nose: {near: head.front, away: 0.02, offset: [0, 0, -0.03]}
  tip: {near: nose, away: 0.05}
  heart: {between: [chest.front, left_ribs]}
postures:
  ready: {from: rest, right_arm: {arm: forward, palm: up}, neck_y: 10}
  tired: {from: ready, neck_y: 30, waist: 0}
start: ready
background:
  - {name: weight, primitive: compensate-gravity}
  - {name: still, primitive: get-posture, joints: [all], posture: rest}
subtasks:
  - {name: look, primitive: point-at, limb: left_arm, at: tip, beats: 2}
  - name: touch
    primitive: go-to-point
    limb: right_arm
    to: {near: heart, away: 0.03}
    via: [{near: tip, away: 0.1}]
    done: {near: heart, limb: right_arm, distance: 0.05}
    timeout: 4
    beats: 2
    after: []
  - {name: down, primitive: get-posture, joints: [right_arm, neck, waist], posture: tired, beats: 2,
     after: [look, touch]}
"""


def where(body: Body, name: str, q: np.ndarray) -> np.ndarray:
    data = mujoco.MjData(body.model)
    data.qpos[:] = q
    mujoco.mj_kinematics(body.model, data)
    spot = body.landmark(name)
    return data.xpos[spot.link] + data.xmat[spot.link].reshape(3, 3) @ spot.point


@pytest.mark.parametrize("name", ["adonis", "adonis-female"])
def test_they_are_danced_and_judged(name: str) -> None:
    body = load_body(name)
    spec, document = task_from_text(OWN, "own.yaml")
    bound = bind_task(spec, body, document)
    assert "nose" not in body.map.landmarks, "the body itself stays as it is"
    (recording,) = run_task(bound)
    assert np.rad2deg(recording.qpos[0][body.qpos_of_dof[body.joints("neck_y")]]) == [10]
    for verdicts in (judge(recording, spec), judge(recording)):
        assert [v.success for v in verdicts.verdicts] == [True] * 3
    (touch,) = (s for s in recording.spans if s.name == "touch")
    assert touch.end < 4.0, "the condition held"
    q = recording.qpos[recording.row(touch.end)]
    palm = bound.body.arm("right_arm").palm
    data = mujoco.MjData(bound.body.model)
    data.qpos[:] = q
    mujoco.mj_kinematics(bound.body.model, data)
    reached = data.xpos[palm.link] + data.xmat[palm.link].reshape(3, 3) @ palm.point
    assert np.linalg.norm(reached - where(bound.body, "heart", q)) <= 0.05


def test_a_landmark_is_where_its_definition_says(body: Body) -> None:
    made = bind(OWN, body).body
    turned = body.home.copy()
    turned[body.qpos_of_dof[body.joints("neck_z")]] = np.pi / 3
    for q, turn in ((body.home, 0.0), (turned, np.pi / 3)):
        c, s = np.cos(turn), np.sin(turn)
        head = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        front, nose, tip = (where(made, n, q) for n in ("head.front", "nose", "tip"))
        normal = head @ body.landmark("head.front").normal
        assert nose == pytest.approx(front + 0.02 * normal + [0, 0, -0.03], abs=1e-6)
        assert tip == pytest.approx(nose + 0.05 * normal, abs=1e-6)
    one, other, heart = (where(made, n, body.home) for n in ("chest.front", "left_ribs", "heart"))
    out = made.landmark("heart").normal
    middle = 0.5 * (one + other)
    assert np.linalg.norm(heart - middle) < 0.1
    assert (heart - middle) @ body.landmark("chest.front").normal > 0, "on the surface, not within"
    assert np.linalg.norm(out) == pytest.approx(1)


def test_the_physics_is_the_same(body: Body) -> None:
    made = bind(OWN, body).body
    rng = np.random.default_rng(0)
    one, other = mujoco.MjData(body.model), mujoco.MjData(made.model)
    for data in (one, other):
        data.qpos[:] = body.home + 0.1 * np.sin(np.arange(body.model.nq))
    for _ in range(50):
        torque = rng.normal(size=body.nv)
        for model, data in ((body.model, one), (made.model, other)):
            data.qfrc_applied[:] = torque
            mujoco.mj_step(model, data)
    np.testing.assert_array_equal(one.qpos, other.qpos)


def bind(text: str, body: Body) -> BoundTask:
    spec, document = task_from_text(text, "own.yaml")
    return bind_task(spec, body, document)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("near: head.front", "near: head.frunt", "3:16: nose: unknown landmark 'head.frunt'"),
        ("near: nose", "near: heart", "4:15: tip: unknown landmark 'heart'"),
        ("near: nose", "between: [nose, heart]", "4:25: tip: unknown landmark 'heart'"),
        ("[chest.front, left_ribs]", "[head.top, left_ribs]", "5:20: heart: nothing is fixed half"),
        ("[chest.front, left_ribs]", "[head.left, head.right]", "5:20: heart: they face away"),
        ("{near: nose, away: 0.05}", "{away: 0.05}", "4:8: give either near"),
        ("nose:", "head.top:", "3:3: 'head.top' is a landmark of adonis already"),
        ("tip:", "right_palm:", "'right_palm' is another part of adonis"),
        ("nose:", "'a b':", "3:10: a b is made of letters"),
        ("ready:", "rest:", "7:3: 'rest' is a posture of adonis already"),
        ("neck_y: 10", "nick_y: 10", "7:60: ready: unknown joint or joint group 'nick_y'"),
        ("neck_y: 10", "neck_y: 100", "7:68: ready: neck_y cannot be 100 degrees"),
        ("neck_y: 10", "neck: 0, neck_y: 10", "7:69: ready: neck_y is given twice: by 'neck'"),
        ("arm: forward", "arm: forwards", "7:34: ready: unknown direction 'forwards'"),
        ("from: rest", "from: tired", "7:17: ready: unknown posture 'tired'"),
        ("from: rest", "from: 3", "7:17: from should be a valid string"),
        ("{from: ready, neck_y: 30, waist: 0}", "{}", "8:10: tired: says nothing"),
        ("{from: ready, neck_y: 30, waist: 0}", "{neck_y: up}", "8:19: neck_y"),
        ("posture: tired", "posture: tirred", "24:85: down: unknown posture 'tirred'"),
        ("start: ready", "start: raedy", "9:8: unknown posture 'raedy'; did you mean 'ready'"),
    ],
)
def test_what_makes_no_sense_is_refused_at_its_place(
    body: Body, old: str, new: str, said: str
) -> None:
    assert old in OWN
    with pytest.raises(SpecError) as caught:
        bind(OWN.replace(old, new, 1), body)
    assert said in str(caught.value)
    assert caught.value.excerpt

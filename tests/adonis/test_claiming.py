"""A goal on another limb is held until that limb moves on."""

import numpy as np
import pytest

from adonis.claiming import Claims
from adonis.dancing import run_task
from adonis.judging import judge
from sim import Body, BodyMap, Recording, Replay, reach
from specs import TaskSpec, bind_task, task_from_text

TEXT = """
task: elbow
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: arms, primitive: get-posture, joints: [right_arm, left_arm], posture: rest}
  - {name: guard, primitive: avoid-collisions}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - {name: hold-out, primitive: get-posture, limb: left_arm,
     posture: {arm: forward, elbow: straight, palm: up}}
  - {name: touch, primitive: go-to-point, limb: right_arm, to: left_elbow.inside, seconds: 1.5,
     via: [{point: [0.35, -0.1, 0.45], at: 0.5}]}
  - {name: away, after: [touch], primitive: get-posture, limb: left_arm,
     posture: {arm: left, elbow: straight, palm: up}, seconds: 0.6}
  - {name: nod, after: [touch], primitive: get-posture, joints: [neck_y], posture: {neck_y: 20}}
  - {name: home, after: [away, nod], primitive: get-posture, limb: right_arm, posture: rest}
"""


@pytest.fixture(scope="module")
def spec() -> TaskSpec:
    return task_from_text(TEXT)[0]


@pytest.fixture(scope="module")
def recording(spec: TaskSpec, body: Body) -> Recording:
    (recording,) = run_task(bind_task(spec, body), contributions=False)
    return recording


def let_go(recording: Recording, spec: TaskSpec, name: str) -> float:
    names = BodyMap.model_validate(recording.about["body_map"])
    subtask = next(s for s in spec.subtasks if s.name == name)
    span = next(s for s in recording.spans if s.name == name)
    return Claims(recording, names, Replay(recording)).let_go(subtask, span, spec)


def test_a_hand_is_not_to_follow_a_limb_that_moves_on(recording: Recording, spec: TaskSpec) -> None:
    starts = {s.name: s.start for s in recording.spans}
    assert let_go(recording, spec, "touch") == starts["away"] < starts["home"]
    verdict = next(v for v in judge(recording, spec).verdicts if v.subtask.name == "touch")
    assert verdict.success
    replay, row = Replay(recording), recording.row(starts["home"])
    palm, goal = (replay.site(name).position[row] for name in ("right_palm", "left_elbow.inside"))
    assert np.linalg.norm(palm - goal) > 0.05, "by then it is far off"


def test_it_has_to_be_there_when_the_limb_moves_on(recording: Recording, spec: TaskSpec) -> None:
    """The same movement against a goal elsewhere on that arm."""
    subtasks = tuple(
        s.model_copy(update={"does": s.does.model_copy(update={"to": "left_palm"})})
        if s.name == "touch"
        else s
        for s in spec.subtasks
    )
    judgement = judge(recording, spec.model_copy(update={"subtasks": subtasks}))
    assert not judgement.verdicts[1].success


def test_a_goal_that_no_limb_carries_is_held_until_the_arm_moves_on(dance) -> None:
    """Also where neck or waist carry it: a hand can follow them."""
    starts = {s.name: s.start for s in dance.recording.spans}
    spec = dance.task.spec
    assert let_go(dance.recording, spec, "right-to-head") == starts["right-to-ribs"]
    assert let_go(dance.recording, spec, "left-to-hip") == np.inf


def test_a_hand_finds_its_way_beside_the_other_arm(body: Body) -> None:
    """Inverse kinematics keeps the arm out of one that lies across the body, or says it cannot."""
    across = body.home.copy()
    angles = np.deg2rad([21.0, 3.0, 100.0, 57.0, -9.0, 7.0, 20.0])
    across[body.qpos_of_dof[body.joints("right_arm")]] = angles
    spec, _ = task_from_text(
        "task: t\nsubtasks:"
        " [{name: a, primitive: go-to-point, limb: left_arm, to: right_hip.front}]"
    )
    arm, goal = body.arm("left_arm"), spec.subtasks[0].does.palm_goal(body)
    _, (free,) = reach(body, arm, [goal])
    _, (beside,) = reach(body, arm, [goal], posture=across)
    assert free < 0.002 < beside

"""The judge sees a good dance as good, and every way of spoiling it."""

from dataclasses import replace

import numpy as np
import pytest

from adonis.dancing import random_start, run_task
from adonis.judging import judge
from adonis.reporting import saturation
from adonis.verdicts import Judgement
from primitives import GoToPoint, Place
from sim import Body, BodyMap, Push, World, adonis
from sim.anthropometry import FEMALE
from specs import SubTask, TaskSpec, bind_task, load_task, task_from_text, with_tempo

SPEC, DOCUMENT = load_task("macarena")


def failed(judgement: Judgement) -> set[str]:
    names = {v.subtask.name for v in judgement.verdicts if not v.success}
    return names | {c.what for c in judgement.checks if not c.success}


def with_does(spec: TaskSpec, name: str, **changes: object) -> TaskSpec:
    """The task with other parameters for one sub-task."""

    def changed(s: SubTask) -> SubTask:
        return s.model_copy(update={"does": s.does.model_copy(update=changes)})

    steps = tuple(changed(s) if s.name == name else s for s in spec.subtasks)
    return spec.model_copy(update={"subtasks": steps})


def danced(spec: TaskSpec, body: Body, against: TaskSpec = SPEC, **options) -> Judgement:
    (recording,) = run_task(bind_task(spec, body), contributions=False, **options)
    return judge(recording, against)


# --- the dance as it should be --------------------------------------------------------------


def test_the_combined_macarena_succeeds(dance) -> None:
    """All twelve, with contacts, gravity, joint limits and torque limits on, at 103 bpm."""
    assert failed(dance.judgement) == set()
    assert dance.judgement.passed == 12
    model = dance.recording.model
    assert model.opt.gravity[2] == -9.81
    assert model.jnt_limited.all()
    assert model.opt.disableflags & 16 == 0, "contacts are on"


def test_every_touch_is_judged_when_its_time_is_over_and_before_the_arm_moves_on(dance) -> None:
    for verdict in dance.judgement.verdicts[4:]:
        end, held = verdict.measures
        assert end.limit == 0.03
        assert held.limit == 0.015
    for verdict in dance.judgement.verdicts[:4]:
        assert {m.what: m.limit for m in verdict.measures} == {
            "arm direction": 10.0, "palm direction": 15.0, "joint angles": 10.0
        }  # fmt: skip


def test_sub_tasks_begin_on_the_beat(dance) -> None:
    beat = 60.0 / 103.0
    for k, verdict in enumerate(dance.judgement.verdicts):
        assert verdict.span.start == pytest.approx(k * beat, abs=1e-6)
        assert verdict.span.end == pytest.approx((k + 1) * beat, abs=1e-6)


@pytest.mark.parametrize("tempo", [80.0, 120.0])
def test_it_also_dances_slower_and_faster(body: Body, tempo: float) -> None:
    spec = with_tempo(SPEC, tempo)
    assert danced(spec, body, spec).passed == 12


def test_the_woman_dances_it_too() -> None:
    assert danced(SPEC, adonis(FEMALE)).passed == 12


def test_it_begins_from_anywhere(body: Body) -> None:
    task = bind_task(SPEC, body, DOCUMENT)
    start = random_start(body, task.start, 4, seed=0)
    for recording in run_task(task, n=4, start=start, contributions=False):
        assert judge(recording, SPEC).passed == 12


def test_a_push_is_recovered_from_within_two_beats(body: Body) -> None:
    beat = 60.0 / 103.0
    push = Push("left_hand", (0.0, 40.0, 0.0), 6.5 * beat, 0.1)
    judgement = danced(SPEC, body, pushes=[push])
    late = [v for v in judgement.verdicts if v.span.start >= 8.0 * beat - 1e-6]
    assert len(late) == 4
    assert all(v.success for v in late)


# --- the dance spoiled on purpose ------------------------------------------------------------


def test_the_wrong_landmark_is_seen(body: Body) -> None:
    spoiled = with_does(SPEC, "right-to-hip", to="left_hip", via=())
    assert "right-to-hip" in failed(danced(spoiled, body))


def test_halved_stiffness_is_seen(body: Body) -> None:
    names = body.map.model_dump()
    for limb in names["limbs"].values():
        for gain in limb["spring"]:
            if gain.endswith("stiffness"):
                limb["spring"][gain] *= 0.5
    for servo in names["servos"].values():
        servo["stiffness"] *= 0.5
    weak = Body(body.spec, BodyMap.model_validate(names))
    assert failed(danced(SPEC, weak))


def test_a_hand_through_the_head_is_seen_even_with_contacts_off() -> None:
    """Straight from the shoulder to the back of the head, with nothing to keep it out."""
    spoiled = with_does(SPEC, "right-to-head", via=())
    spoiled = with_does(spoiled, "left-to-head", via=())
    quiet = tuple(b for b in spoiled.background if b.name != "guard")
    spoiled = spoiled.model_copy(update={"background": quiet})
    judgement = danced(spoiled, adonis(contacts=False))
    assert "worst penetration" in failed(judgement)
    (penetration,) = (c for c in judgement.checks if c.what == "worst penetration")
    assert penetration.value > 0.02


def test_an_arm_that_does_not_move_is_seen(dance) -> None:
    frozen = np.tile(dance.recording.qpos[0], (len(dance.recording.time), 1))
    assert judge(replace(dance.recording, qpos=frozen), SPEC).passed == 0


def test_a_torque_beyond_the_limit_is_seen(dance) -> None:
    torque = dance.recording.torque.copy()
    torque[1000, 6] *= 50
    assert "peak torque" in failed(judge(replace(dance.recording, torque=torque), SPEC))


def test_a_jump_of_the_torque_at_a_hand_over_is_seen(dance) -> None:
    torque = dance.recording.torque.copy()
    row = dance.recording.row(dance.judgement.verdicts[4].span.start) + 10
    torque[row, 6] += 20.0
    judged = judge(replace(dance.recording, torque=torque), SPEC)
    assert "hand-over torque step" in failed(judged)


def test_a_tilted_trunk_is_seen(dance) -> None:
    qpos = dance.recording.qpos.copy()
    qpos[500:, 1] += np.deg2rad(7)
    assert "upright" in failed(judge(replace(dance.recording, qpos=qpos), SPEC))


def test_a_run_that_broke_off_is_no_success(dance) -> None:
    assert not judge(replace(dance.recording, complete=False), SPEC).success


def test_a_sub_task_that_it_did_not_come_to_is_no_success(dance) -> None:
    cut = replace(dance.recording, spans=dance.recording.spans[:-1])
    assert "left-to-hip" in failed(judge(cut, SPEC))


TURNED = """
task: turned
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - {name: turn, primitive: get-posture, joints: [waist],
     posture: {waist_x: 0, waist_y: 0, waist_z: 30}}
  - {name: out, primitive: get-posture, limb: right_arm,
     posture: {arm: forward, elbow: straight, palm: down}}
  - {name: back, primitive: get-posture, joints: [waist], posture: {waist: 0}}
"""


def test_a_posture_is_seen_from_the_trunk_that_carries_the_arm(body: Body) -> None:
    """Forward is where the trunk faces: before, while and after the waist turns."""
    spec, document = task_from_text(TURNED)
    (recording,) = run_task(bind_task(spec, body, document), contributions=False)
    waist = np.rad2deg(recording.qpos[recording.row(2.0), body.joints("waist_z")[0]])
    assert waist == pytest.approx(30.0, abs=2.0)
    assert failed(judge(recording, spec)) == set()
    other = with_does(spec, "out", posture={"arm": (0.87, 0.5, 0.0), "palm": "down"})
    assert failed(judge(recording, other)) == {"out"}


def test_saturation_is_the_share_of_steps_at_a_limit(dance) -> None:
    torque, limit = dance.recording.torque.copy(), dance.task.body.torque_limit
    assert saturation(dance.recording) == 0.0
    torque[:25, 6] = -limit[6]
    torque[20:30, 7] = limit[7]
    assert saturation(replace(dance.recording, torque=torque)) == 30 / len(torque)


def test_nothing_that_touches_is_no_penetration_below_zero(dance) -> None:
    still = np.tile(dance.recording.qpos[0], (len(dance.recording.time), 1))
    judged = judge(replace(dance.recording, qpos=still), SPEC)
    (penetration,) = (c for c in judged.checks if c.what == "worst penetration")
    assert f"{penetration.value:.2f}" == "0.00"


def test_a_place_that_is_no_landmark_is_judged_too(body: Body) -> None:
    reach = GoToPoint(limb="right_arm", to={"near": "chest.front", "away": 0.25})
    spec = TaskSpec(
        task="t", subtasks=(SubTask(name="a", does=reach, seconds=1.0),), background=SPEC.background
    )
    good = danced(spec, body, spec)
    assert good.success
    other = with_does(spec, "a", to=Place(near="chest.front", away=0.35))
    assert "a" in failed(danced(spec, body, other))


def test_a_goal_is_judged_until_the_first_round_of_what_takes_its_arm(body: Body) -> None:
    """Later rounds begin elsewhere; the hand-over to the first is judged as well."""
    text = """task: t
tempo: 60
background:
  - {name: still, primitive: get-posture, joints: [all], posture: rest}
  - {name: guard, primitive: avoid-collisions}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - {name: reach, primitive: go-to-point, limb: right_arm, to: {point: [0.42, -0.1, 0.3]}}
  - {name: again, primitive: go-to-point, limb: right_arm, to: {point: [0.4, -0.2, 0.1]},
     repeat: 2}
"""
    spec, document = task_from_text(text)
    (recording,) = run_task(bind_task(spec, body, document))
    reach, again = recording.spans
    assert (again.began, again.start) == pytest.approx((1.0, 2.0))
    assert reach.first == reach.start
    judgement = judge(recording, spec)
    assert judgement.success, [v.as_dict() for v in judgement.verdicts]
    torque = recording.torque.copy()
    torque[recording.row(1.05), 6] += 20.0
    jumped = judge(replace(recording, torque=torque), spec)
    assert "hand-over torque step" in failed(jumped)


# --- in which frame -------------------------------------------------------------------------


@pytest.mark.parametrize("primitive", ["go-to-point", "follow"])
def test_an_offset_is_that_of_the_home_posture_and_turns_with_the_arm(
    body: Body, primitive: str
) -> None:
    """The forearm is turned by about 90 degrees from how it hangs; where the palm has to be is
    put together here from MuJoCo's own poses."""
    text = f"""
task: offset
background: [{{name: weight, primitive: compensate-gravity}},
  {{name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}}]
subtasks:
  - {{name: out, primitive: get-posture, limb: right_arm, posture: {{arm: forward, palm: left}}}}
  - {{name: beside, primitive: {primitive}, limb: left_arm, beats: 2,
     to: {{near: right_elbow.inside, away: 0.02, offset: [0.05, 0.1, 0.08]}}}}
"""
    spec, document = task_from_text(text)
    (recording,) = run_task(bind_task(spec, body, document))
    judgement = judge(recording, spec)
    assert judgement.verdicts[1].success, judgement.verdicts[1].measures
    world = World(body, 2)
    world.reset(np.array([body.home, recording.qpos[-1]]))
    mark, palm = body.landmark("right_elbow.inside"), body.arm("left_arm").palm
    home, now = world.state.xmat[:, mark.link].reshape(2, 3, 3)
    out = now @ (mark.point + 0.02 * mark.normal) + now @ home.T @ (0.05, 0.1, 0.08)
    goal = world.state.xpos[1, mark.link] + out
    hand = world.state.xmat[1, palm.link].reshape(3, 3) @ palm.point
    off = np.linalg.norm(world.state.xpos[1, palm.link] + hand - goal)
    assert off < 0.015
    assert np.linalg.norm(now @ home.T - np.eye(3)) > 1.0
    at_the_end = judgement.verdicts[1].measures[-1].value
    assert at_the_end == pytest.approx(off, abs=0.005)

"""Chains of sub-tasks that are repeated: how often, until when, judged in every round."""

import re
from pathlib import Path

import numpy as np
import pytest

from adonis.dancing import run_task
from adonis.judging import judge
from arbiter import Arbiter
from sim import Body, Recording, World
from specs import SpecError, bind_task, build_graph, task_from_text, task_to_yaml

TASK = """
task: clap
tempo: 120
background:
  - {{name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}}
  - {{name: weight, primitive: compensate-gravity}}
subtasks:
  - {{name: open, primitive: get-posture, joints: [right_elbow], posture: {{right_elbow: 30}}}}
  - {{name: look, while: open, primitive: get-posture, joints: [neck_z], posture: {{neck_z: 10}}}}
  - {{name: twice, primitive: get-posture, joints: [right_wrist_z], posture: {{right_wrist_z: 5}},
     after: [open], repeat: 2}}
  - {{name: close, primitive: get-posture, joints: [right_elbow], posture: {{right_elbow: 50}},
     after: [twice], repeat: {repeat}}}
  - {{name: end, primitive: get-posture, joints: [right_elbow], posture: {{right_elbow: 20}}}}
"""
BEAT = 0.5


def bound(body: Body, repeat: str):
    spec, document = task_from_text(TASK.format(repeat=repeat))
    return bind_task(spec, body, document)


def times(recording: Recording, name: str) -> list[float]:
    every = (*recording.rounds, *recording.spans)
    return [round(s.start, 6) for s in every if s.name == name]


def test_a_chain_is_done_so_many_times(body: Body, tmp_path: Path) -> None:
    task = bound(body, "{from: open, times: 3}")
    (recording,) = run_task(task)
    assert times(recording, "open") == [0.0, 2.0, 4.0]
    assert times(recording, "twice") == [0.5, 1.0, 2.5, 3.0, 4.5, 5.0]
    assert times(recording, "close") == [1.5, 3.5, 5.5]
    assert times(recording, "end") == [6.0]
    assert times(recording, "look") == [0.0, 2.0, 4.0]
    looked = [s.end for s in (*recording.rounds, *recording.spans) if s.name == "look"]
    np.testing.assert_allclose(looked, [0.5, 2.5, 4.5], atol=0.003)
    assert task.graph.planned["end"] == (6.0, 6.5)
    assert {s.outcome for s in recording.rounds} == {"done"}
    assert judge(recording, task.spec).success
    recording.save(tmp_path / "recording.npz")
    assert Recording.load(tmp_path).rounds == recording.rounds


def test_until_an_event_that_was_sent_in_the_round(body: Body) -> None:
    task = bound(body, "{from: open, until: {event: enough}, times: 5}")
    world, arbiter = World(body, 3), Arbiter(task, 3)
    world.reset(task.start)
    for step in range(int(11.5 / body.timestep)):
        if step == int(2.1 / body.timestep):  # early in the second round
            arbiter.send("enough", [1])
        if step == int(1.9 / body.timestep):  # late in the first
            arbiter.send("enough", [2])
        world.step(arbiter.torque(world.state))
    found = [
        (sum(s.name == "close" for s in arbiter.rounds(i)) + 1, arbiter.spans(i)[3].outcome)
        for i in range(3)
    ]
    assert found == [(5, "timed out"), (2, "done"), (1, "done")]
    assert arbiter.over.all()


def test_events_can_be_sent_by_time(body: Body) -> None:
    task = bound(body, "{from: open, until: {event: enough}, times: 9}")
    (recording,) = run_task(task, events=[(2.6, "enough")])
    assert times(recording, "close") == [1.5, 3.5]


def test_a_batch_does_what_each_would_do_alone(body: Body) -> None:
    near = "{from: open, until: {near: head.top, limb: right_arm, distance: 0.6}, times: 4}"
    task = bound(body, near)
    rng = np.random.default_rng(3)
    starts = task.start + np.abs(rng.normal(0, 0.4, (4, body.nv)))
    together = run_task(task, n=4, start=starts, contributions=False)
    for recording, start in zip(together, starts, strict=True):
        (alone,) = run_task(task, start=start, contributions=False)
        np.testing.assert_array_equal(alone.qpos, recording.qpos[: len(alone.qpos)])
        assert alone.rounds == recording.rounds


def test_every_round_is_judged(body: Body) -> None:
    """A push in the first round, and everything as it should be after it."""
    task = bound(body, "{from: open, times: 3}")
    (recording,) = run_task(task)
    joint = body.joints("right_elbow")[0]
    rows = (recording.time > 1.95) & (recording.time < 2.05)  # as the first `close` ends
    recording.qpos[rows, body.qpos_of_dof[joint]] += np.deg2rad(15.0)
    close = judge(recording, task.spec).verdicts[3]
    assert not close.success
    assert close.worst is not None
    assert close.worst.where == "right_elbow, round 1"


def test_a_chain_within_a_chain(body: Body) -> None:
    text = TASK.format(repeat="{from: twice, times: 2}").replace(
        "{name: end,", "{name: end, repeat: {from: open, times: 2},"
    )
    spec, document = task_from_text(text)
    (recording,) = run_task(bind_task(spec, body, document))
    assert times(recording, "open") == [0.0, 4.0]
    assert times(recording, "close") == [1.5, 3.0, 5.5, 7.0]
    assert times(recording, "end") == [3.5, 7.5]
    assert task_from_text(task_to_yaml(spec))[0] == spec


def test_what_still_runs_is_ended_for_the_next_round(body: Body) -> None:
    text = """
task: race
background: [{name: weight, primitive: compensate-gravity}]
subtasks:
  - {name: a, primitive: hold, joints: [neck_x]}
  - {name: short, primitive: hold, joints: [waist], after: [a], seconds: 0.5}
  - {name: long, primitive: hold, limb: left_arm, after: [a], seconds: 3}
  - {name: z, primitive: hold, limb: right_arm, after: {any: [short, long]}, seconds: 0.5,
     repeat: {from: a, times: 2}}
"""
    spec, document = task_from_text(text)
    (recording,) = run_task(bind_task(spec, body, document))
    assert [s.outcome for s in recording.rounds if s.name == "long"] == ["ended"]
    assert times(recording, "long") == [1.0, 3.0]
    assert recording.spans[-1].outcome == "done"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("from: open", "from: opne"), "13:37: unknown sub-task 'opne'; did you mean 'open'?"),
        (("from: open", "from: close"), "13:37: 'close' repeats itself: write repeat: 3"),
        (("from: open", "from: end"), "13:37: 'close' does not come after 'end'"),
        (("times: 3", "times: 3, form: open"), "unknown key 'form'"),
        (("{from: open, times: 3}", "{times: 3}"), "write repeat: 3, or say until when"),
        (
            ("{{name: end,", "{{name: end, after: [twice],"),
            "'end' comes after 'twice', which is not over before 'close' was repeated",
        ),
        (
            ("after: [twice],", "after: [twice, x],"),
            "'close' would be repeated with 'open', but it comes after 'x', which would not",
        ),
        (("{{name: end,", "{{name: end, repeat: {{from: twice, times: 2}},"), "overlap"),
        (("after: [twice],", "after: [twice], if: {{event: go}},"), "has no 'if'"),
    ],
)
def test_chains_that_mean_nothing_are_refused(change: tuple[str, str], said: str) -> None:
    text = TASK.replace("{repeat}", "{{from: open, times: 3}}").replace(*change).format()
    if change[0] not in TASK:
        text = TASK.format(repeat="{from: open, times: 3}").replace(*change)
    if "[twice, x]" in text:
        text += "  - {name: x, primitive: hold, joints: [waist], after: []}\n"
    with pytest.raises(SpecError, match=re.escape(said)):
        build_graph(*task_from_text(text))


def test_any_does_not_take_joints_that_are_still_used(body: Body) -> None:
    text = """
task: any
subtasks:
  - {name: a, primitive: hold, limb: right_arm}
  - {name: b, primitive: hold, limb: left_arm, after: []}
  - {name: c, primitive: hold, limb: right_arm, after: {any: [a, b]}}
"""
    spec, document = task_from_text(text)
    said = "6:56: 'c' begins when any of those before it is over, and 'a' may still run then"
    with pytest.raises(SpecError, match=said):
        bind_task(spec, body, document)

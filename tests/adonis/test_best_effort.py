"""What a body can do of a task is told beforehand, and is what happens when it tries."""

import numpy as np
import pytest

from adonis.dancing import run_task
from adonis.fitness import notes
from adonis.judging import judge
from adonis.verdicts import Judgement
from sim import BeyondRange, Body, Recording, Replay, Unposable, adonis, arm7
from specs import BestEffort, SpecError, TaskSpec, bind_task, fitness_of, load_task, task_from_text

TASK = """
task: t
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - {name: out, primitive: get-posture, limb: right_arm, posture: {arm: forward, elbow: straight}, seconds: 1}
  - {name: nearly, primitive: get-posture, limb: left_arm, posture: {arm: forward, elbow: straight}, seconds: 1}
  - {name: bend, primitive: get-posture, joints: [right_elbow], posture: {right_elbow: 140}, seconds: 1}
  - {name: shoulder, primitive: go-to-point, limb: right_arm, to: chest.front, seconds: 1.5}
  - {name: hip, primitive: go-to-point, limb: left_arm, to: left_hip, seconds: 1.5}
  - {name: nod, primitive: get-posture, joints: [neck_y], posture: {neck_y: 17}, seconds: 0.5}
"""  # noqa: E501
RANGES = {"right_elbow": (20, 100), "left_elbow": (6, 150), "neck_y": (-50, 10)}


def stiff() -> Body:
    """A man whose elbows and neck do not go all the way."""
    man = adonis()
    spec = man.spec.copy()
    for joint, ends in RANGES.items():
        spec.joint(joint).range = np.deg2rad(ends)
    rest = man.map.postures["rest"] | {"right_elbow": 20.0}
    return Body(spec, man.map.model_copy(update={"postures": man.map.postures | {"rest": rest}}))


def weak(share: float) -> Body:
    """A man whose right shoulder has little strength."""
    man = adonis()
    spec = man.spec.copy()
    for joint in ("right_shoulder_y", "right_shoulder_x", "right_shoulder_z"):
        motor = next(a for a in spec.actuators if a.target == joint)
        motor.ctrlrange = share * motor.ctrlrange
        spec.joint(joint).actfrcrange = share * spec.joint(joint).actfrcrange
    return Body(spec, man.map)


@pytest.fixture(scope="module")
def spec() -> TaskSpec:
    return task_from_text(TASK)[0]


@pytest.fixture(scope="module")
def effort(spec: TaskSpec) -> BestEffort:
    return BestEffort.of(spec, stiff())


@pytest.fixture(scope="module")
def recording(effort: BestEffort) -> Recording:
    (recording,) = run_task(bind_task(effort.tried, stiff()))
    return recording


@pytest.fixture(scope="module")
def judged(effort: BestEffort, recording: Recording) -> Judgement:
    return judge(recording, effort.to_judge(effort.tried), fitness=effort.fitness)


def test_who_lacks_nothing_can_do_the_macarena(body: Body) -> None:
    assert {fit.verdict for fit in fitness_of(load_task("macarena")[0], body)} == {"reachable"}


def test_each_sub_task_is_told_with_the_joint_to_blame(effort: BestEffort) -> None:
    told = {fit.subtask: (fit.verdict, fit.joint) for fit in effort.fitness}
    assert told == {
        "out": ("partly", "right_elbow"),
        "nearly": ("reachable", "left_elbow"),
        "bend": ("partly", "right_elbow"),
        "shoulder": ("partly", "right_elbow"),
        "hip": ("reachable", None),
        "nod": ("reachable", "neck_y"),
    }


def test_how_far_short_it_is_comes_true(effort: BestEffort, judged: Judgement) -> None:
    """The judge, who knows nothing of it, measures what was foreseen."""
    for fit, verdict in zip(effort.fitness, judged.verdicts, strict=True):
        assert verdict.success == (fit.verdict == "reachable"), (fit, verdict.measures)
        if fit.short is not None and verdict.worst is not None:
            near = 0.01 if fit.unit == "m" else 2.0
            assert verdict.worst.value == pytest.approx(fit.short, abs=near), fit.subtask


def test_the_nearest_place_is_reached(effort: BestEffort, recording: Recording) -> None:
    (fit,) = (fit for fit in effort.fitness if fit.subtask == "shoulder")
    place = np.array(fit.instead.to.point)  # type: ignore[union-attr]
    (span,) = (span for span in recording.spans if span.name == "shoulder")
    replay, row = Replay(recording), recording.row(span.end) - 1
    trunk = replay.link("trunk")
    palm = replay.site("right_palm").position[row]
    axes = trunk.axes[row]
    assert np.linalg.norm(axes.T @ (palm - trunk.position[row]) - place) < 0.015


def test_without_it_the_task_is_refused(spec: TaskSpec) -> None:
    with pytest.raises(SpecError, match="right_arm cannot be held so: 20 degrees off"):
        bind_task(spec, stiff())


def test_what_a_body_lacks_is_impossible_and_waited_for() -> None:
    spec, _ = task_from_text(
        "task: t\nsubtasks:\n"
        "  - {name: left, primitive: get-posture, limb: left_arm, posture: rest, seconds: 0.2}\n"
        "  - {name: look, primitive: look-at, at: {point: [1, 0, 0]}, seconds: 0.2}\n"
        "  - {name: bend, primitive: get-posture, joints: [right_elbow],"
        " posture: {right_elbow: 40}, seconds: 1}\n"
    )
    arm = arm7()
    effort = BestEffort.of(spec, arm)
    assert [fit.verdict for fit in effort.fitness] == ["impossible", "impossible", "reachable"]
    (recording,) = run_task(bind_task(effort.tried, arm))
    judged = judge(recording, effort.to_judge(effort.tried), fitness=effort.fitness)
    assert [verdict.success for verdict in judged.verdicts] == [False, False, True]
    assert [span.start for span in recording.spans] == pytest.approx([0.0, 0.2, 0.4], abs=1e-6)
    assert "left: impossible, it was waited for" in notes(effort.fitness)[0]


def test_what_no_body_can_do_is_a_mistake_and_no_lack() -> None:
    spec, document = task_from_text(
        "task: t\nsubtasks:\n  - {name: a, primitive: go-to-point, limb: right_arm, to: head.bak}\n"
    )
    with pytest.raises(SpecError, match=r"head\.bak.*did you mean 'head\.back'"):
        fitness_of(spec, arm7(), document)


def test_an_arm_that_is_too_weak_sinks() -> None:
    spec, _ = task_from_text(
        "task: t\nbackground: [{name: weight, primitive: compensate-gravity}]\nsubtasks:"
        " [{name: out, primitive: get-posture, limb: right_arm, posture: {arm: right}, seconds: 2}]"
    )
    for share, verdict in ((0.5, "reachable"), (0.1, "partly")):
        (fit,) = fitness_of(spec, weak(share))
        assert fit.verdict == verdict
        (recording,) = run_task(bind_task(spec, weak(share)))
        assert judge(recording, spec).success == (verdict == "reachable")
    assert fit.why.endswith("it will sink")


def test_the_errors_carry_the_nearest(spec: TaskSpec) -> None:
    body = stiff()
    with pytest.raises(Unposable) as caught:
        spec.subtasks[0].does.bind(body, 1.0)
    assert caught.value.off == pytest.approx(np.deg2rad(20.0), abs=0.02)
    with pytest.raises(BeyondRange):
        spec.subtasks[2].does.bind(body, 1.0)

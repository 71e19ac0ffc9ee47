"""A dancer becomes somebody else, and the recording knows who it was when."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from adonis.cli import app
from adonis.dancing import run_task
from adonis.judging import judge
from adonis.morphing import morph
from sim import Body, BodyError, Recording, Replay, load_body
from specs import BoundTask, SpecError, bind_task, load_task

INTERVAL = 0.5  # fewer bodies than usual, which are enough here


@pytest.fixture(scope="module")
def task(body: Body) -> BoundTask:
    spec, document = load_task("macarena")
    return bind_task(spec, body, document)


@pytest.fixture(scope="module")
def danced(task: BoundTask, tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """Through a file, as all recordings go."""
    becoming = morph(task, "adonis-female", interval=INTERVAL)
    (recording,) = run_task(task, becoming=becoming)
    file = tmp_path_factory.mktemp("morph") / "recording.npz"
    recording.save(file)
    return Recording.load(file)


def test_the_dance_succeeds_while_the_man_becomes_a_woman(
    task: BoundTask, danced: Recording
) -> None:
    judgement = judge(danced, task.spec)
    assert judgement.passed == 12
    assert judgement.success, [check for check in judgement.checks if not check.success]
    assert danced.about["becomes"] == "adonis-female"


def test_every_row_is_replayed_with_the_body_of_that_moment(danced: Recording) -> None:
    replay = Replay(danced)
    upper, elbow = (replay.link(f"right_{part}").position for part in ("upper_arm", "forearm"))
    length = np.linalg.norm(elbow - upper, axis=1)
    man, woman = 0.2817, 0.2751
    assert length[0] == pytest.approx(man, abs=1e-4)
    assert length[-1] == pytest.approx(woman, abs=1e-4)
    assert (np.diff(length) <= 1e-9).all(), "it only becomes shorter"
    assert len(np.unique(length.round(6))) == len(danced.models)
    last = Replay(danced.until(0.3))
    assert len(last.changes(["right_palm"])[0]) == 0, "no change was in those rows"


def test_energy_hardly_changes_when_the_body_does(danced: Recording) -> None:
    kinetic, moved = Replay(danced).changes(["right_palm", "left_palm"])
    assert len(kinetic) == len(danced.models) - 1
    assert np.abs(kinetic).max() < 0.2  # [J]; of some 10 J in mid-dance
    assert moved.max() < 0.003


def test_limits_are_those_of_the_moment(task: BoundTask, danced: Recording) -> None:
    replay = Replay(danced)
    woman = load_body("adonis-female")
    elbow = replay.dof("right_elbow")
    share, torque = replay.torque_share()[:, elbow], danced.torque[:, elbow]
    assert torque[5] / share[5] == pytest.approx(task.body.torque_limit[elbow])
    assert torque[-5] / share[-5] == pytest.approx(woman.torque_limit[elbow], rel=1e-3)
    assert replay.torque_limits()[elbow] == pytest.approx(woman.torque_limit[elbow], rel=1e-3)


def test_nothing_jumps_when_the_body_changes(danced: Recording) -> None:
    """Angles and velocities go on: no row is further from the last than in any other dance."""
    steps = np.abs(np.diff(danced.qvel, axis=0)).max(axis=1)
    rows = np.array([row for row, _ in danced.models[1:]])
    assert steps[rows - 1].max() < steps.max()


def test_who_cannot_be_become_is_told(task: BoundTask, body: Body) -> None:
    with pytest.raises(BodyError, match="unknown person to become or to begin with 'atlas'"):
        morph(task, "atlas")
    spec, _ = load_task("macarena")
    guarded = bind_task(spec.model_copy(update={"safety": "filter"}), body)
    with pytest.raises(SpecError, match="without safety: filter"):
        morph(guarded, "adonis-female")


def test_the_command_says_what_became_of_whom(tmp_path: Path) -> None:
    file, out = tmp_path / "up.yaml", tmp_path / "run"
    file.write_text(
        "task: up\nsubtasks: [{name: up, primitive: get-posture, limb: left_arm, posture: rest,"
        " seconds: 0.2}]\ncoda: 0.1\n"
    )
    ended = CliRunner().invoke(
        app, ["run", str(file), "--morph", "adonis-child", "--out", str(out)]
    )
    assert "it became adonis-child in 7 bodies" in " ".join(ended.output.split()), ended.output
    report = json.loads((out / "report.json").read_text())
    assert report["morph"]["to"] == "adonis-child"
    refused = CliRunner().invoke(app, ["run", "wave", "--morph", "adonis-weight"])
    assert refused.exit_code == 2
    assert "unknown person" in refused.output

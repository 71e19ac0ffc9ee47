"""`adonis body new` and `adonis body check`, and a dance on what they write."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest

from adonis.body_study import model_of, truths
from adonis.lacking import lacks_of
from sim import Body, BodyFile, arm7, load_body
from specs import read_body_file

TASK = """task: look
tempo: 60
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: guard, primitive: avoid-collisions}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - {name: up, primitive: get-posture, limb: right_arm, posture: {arm: forward, palm: down}}
  - {name: belly, primitive: go-to-point, limb: right_arm, to: belly.front, beats: 2}
"""


def adonis(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "adonis", *arguments],
        cwd=cwd,
        env={**os.environ, "COLUMNS": "160"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[subprocess.CompletedProcess[str], Path]:
    """What `body new` does with the human of example-robot-data."""
    where = tmp_path_factory.mktemp("new")
    truth = next(t for t in truths() if t.robot == "human")
    model = model_of(truth, tuple(Path(folder) for folder in sys.path if folder))
    assert model is not None, f"{truth.package} is in the extra `dev`; install that"
    return adonis("body", "new", str(model), cwd=where), where


def test_new_writes_a_file_and_says_what_it_guessed(made) -> None:
    ended, where = made
    assert ended.returncode == 0, ended.stderr
    assert (where / "human.body.yaml").is_file()
    assert "It faces +x of the model" in ended.stdout
    assert "things were guessed and are marked" in ended.stdout
    assert "12 joints are locked where they are at home" in ended.stdout
    if "no pictures" not in ended.stdout:
        assert (where / "human.body.png").stat().st_size > 20_000


def test_new_does_not_write_over_a_file(made) -> None:
    _, where = made
    file = where / "human.body.yaml"
    before = file.read_text()
    model = before.split("model: ", 1)[1].split("\n", 1)[0]
    ended = adonis("body", "new", model, cwd=where)
    assert ended.returncode == 2
    assert "human.body.yaml is there already: give --force" in ended.stderr
    assert file.read_text() == before


def test_check_shows_the_joints_and_what_is_lacking(made) -> None:
    _, where = made
    ended = adonis("body", "check", "human.body.yaml", cwd=where)
    assert ended.returncode == 0, ended.stdout
    assert "right_elbow_Z" in ended.stdout
    assert "things in human.body.yaml are marked as guessed" in ended.stdout
    assert "lacks nothing" in ended.stdout


def test_check_ends_with_1_if_something_is_lacking(tmp_path: Path) -> None:
    ended = adonis("body", "check", "arm7", cwd=tmp_path)
    assert ended.returncode == 1
    assert "no left arm: sub-tasks of the left arm are refused" in ended.stdout


def test_check_ends_with_2_if_the_file_makes_no_sense(made) -> None:
    _, where = made
    bad = where / "bad.body.yaml"
    bad.write_text((where / "human.body.yaml").read_text().replace("right_elbow_Z", "right_knee"))
    ended = adonis("body", "check", "bad.body.yaml", cwd=where)
    assert ended.returncode == 2
    assert "bad.body.yaml:" in ended.stderr
    assert "unknown joint of the model 'right_knee'" in ended.stderr
    assert "^" in ended.stderr


def test_new_of_something_else_ends_with_2(tmp_path: Path) -> None:
    (tmp_path / "notes.urdf").write_text("no model")
    for model, said in (("notes.urdf", "not well-formed XML"), ("none.urdf", "there is no model")):
        ended = adonis("body", "new", model, cwd=tmp_path)
        assert ended.returncode == 2
        assert said in ended.stderr
    assert list(tmp_path.glob("*.yaml")) == []


def test_a_task_runs_on_it(made) -> None:
    _, where = made
    (where / "look.yaml").write_text(TASK)
    ended = adonis("run", "look.yaml", "--body", "human.body.yaml", "--out", "run", cwd=where)
    assert "2 of 2 sub-tasks succeeded" in ended.stdout, ended.stdout + ended.stderr
    assert ended.stderr == ""
    checked = adonis("check", "look.yaml", "--body", "human.body.yaml", cwd=where)
    assert "on human" in checked.stdout


def test_adonis_lacks_nothing() -> None:
    assert lacks_of(load_body("adonis")) == []


def test_what_an_arm_lacks_is_said_with_its_cost() -> None:
    said = {lack.what: lack.cost for lack in lacks_of(arm7())}
    assert said["no left arm"] == "sub-tasks of the left arm are refused"
    assert said["no waist"] == "bows and sways are refused"
    assert said["nothing that turns the head"] == "look-at is impossible"


def test_motors_that_damping_holds_back_are_said() -> None:
    """Many models have a damping that nobody measured."""
    man = load_body("adonis")
    spec = man.spec.copy()
    spec.joint("right_wrist_z").damping[0] = 20.0
    (lack,) = lacks_of(Body(spec, man.map))
    assert lack.what.startswith("right_arm: motors too weak for their joints' own damping")
    assert "right_wrist_z" in lack.what


def test_a_sub_task_of_joints_that_a_body_lacks_is_refused(tmp_path: Path) -> None:
    (tmp_path / "nod.yaml").write_text(
        "task: nod\nsubtasks:\n"
        "  - {name: nod, primitive: get-posture, joints: [neck], posture: upright}\n"
    )
    ended = adonis("run", "nod.yaml", "--body", "arm7", cwd=tmp_path)
    assert ended.returncode == 2
    assert "nod.yaml:3:" in ended.stderr
    assert "nod: there is nothing to move: arm7 has no neck" in ended.stderr
    assert "`adonis check nod.yaml --body arm7` says what this body can do" in ended.stderr
    checked = adonis("check", "nod.yaml", "--body", "arm7", "--json", cwd=tmp_path)
    assert checked.returncode == 1
    (fit,) = json.loads(checked.stdout)["fitness"]
    assert fit["verdict"] == "impossible"
    assert fit["why"] == "there is nothing to move: arm7 has no neck"


def test_as_much_as_a_body_can_do_is_done_if_one_asks(tmp_path: Path) -> None:
    """The judge still wants what the task says; what was tried instead is told."""
    (tmp_path / "both.yaml").write_text(
        "task: both\nbackground: [{name: weight, primitive: compensate-gravity}]\nsubtasks:\n"
        "  - {name: left, primitive: get-posture, limb: left_arm, posture: rest, seconds: 0.2}\n"
        "  - {name: out, primitive: go-to-point, limb: right_arm, to: {point: [0.9, -0.2, 0.3]},"
        " seconds: 1.5}\n"
        "  - {name: up, primitive: get-posture, limb: right_arm, posture: {arm: forward},"
        " seconds: 1}\n"
    )
    asked = ("run", "both.yaml", "--body", "arm7", "--out", "run", "--best-effort")
    ended = adonis(*asked, cwd=tmp_path)
    assert ended.returncode == 1
    assert "1 of 3 sub-tasks succeeded" in ended.stdout
    said = re.sub(r"\s+", " ", ended.stdout)
    assert "left: impossible, it was waited for (unknown limb 'left_arm'" in said
    assert re.search(r"out: the nearest that the body reaches was tried, [0-9.]+ cm short", said)


def test_the_body_file_in_the_documentation_is_one(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "bodies.md").read_text(encoding="utf-8")
    (tmp_path / "shown.yaml").write_text(
        dedent(page.split("<!-- a body file -->\n")[1].split("<!-- end -->")[0])
    )
    file, _ = read_body_file(tmp_path / "shown.yaml")
    keys = set(re.findall(r"`(\w+)`", page.split("### The body file")[1].split("**Frames.**")[0]))
    assert set(BodyFile.model_fields) - {"body", "model", "limbs"} <= keys
    assert set(file.limbs["right_arm"].joints) > {"shoulder_x", "elbow"}

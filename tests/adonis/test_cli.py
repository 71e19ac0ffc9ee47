"""The command line, as a shell sees it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

from sim import Recording
from specs import task_from_text

GOOD = """task: wave
tempo: 120
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - {name: up, words: Raise your hand, primitive: go-to-point, limb: right_arm,
     to: {point: [0.4, -0.2, 0.35]}, beats: 2}
"""


def adonis(*arguments: str, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "adonis", *arguments],
        cwd=cwd,
        env={**os.environ, "COLUMNS": "120", **environment},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> tuple[subprocess.CompletedProcess[str], Path]:
    """One run of the library's Macarena, with everything it writes."""
    where = tmp_path_factory.mktemp("run")
    return adonis("run", "macarena", "--out", "dance", cwd=where), where / "dance"


def test_run_succeeds_and_says_so(finished) -> None:
    ended, _ = finished
    assert ended.returncode == 0, ended.stderr
    assert "12 of 12 sub-tasks succeeded" in ended.stdout
    assert "Touch right hand to the back of your head" in ended.stdout
    assert ended.stderr == ""


def test_run_writes_what_it_promises(finished) -> None:
    _, folder = finished
    recording = Recording.load(folder)
    model = mujoco.MjModel.from_xml_path(str(folder / "model.xml"))
    assert model.nv == recording.qvel.shape[1] == 20
    report = json.loads((folder / "report.json").read_text())
    assert report["success"] is True
    assert len(report["subtasks"]) == 12
    keys = {"name", "words", "primitive", "controller", "limb", "start", "end", "error"}
    keys |= {"tolerance", "unit", "success"}
    for row in report["subtasks"]:
        assert keys <= row.keys()
        assert row["error"] <= row["tolerance"]
        assert 0 <= row["start"] < row["end"] <= report["duration"]
    for key in (
        "worst_penetration", "smallest_clearance", "largest_hand_over_torque_step",
        "peak_torque_share",
    ):  # fmt: skip
        assert np.isfinite(report[key])
    spec, _ = task_from_text((folder / "task.yaml").read_text())
    assert spec.tempo == 103
    for name in ("hand_speed.png", "torque.png"):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")
    assert not list(folder.glob("*.part"))
    assert not list(folder.glob("*.tmp"))


def test_the_filmstrip_is_made_where_the_machine_can_render(finished) -> None:
    ended, folder = finished
    if "no pictures" in ended.stdout:
        assert not (folder / "filmstrip.png").exists()
    else:
        assert (folder / "filmstrip.png").read_bytes().startswith(b"\x89PNG")


def test_without_opengl_a_run_loses_its_pictures_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "wave.yaml").write_text(GOOD)
    ended = adonis("run", "wave.yaml", "--video", cwd=tmp_path, MUJOCO_GL="bogus")
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.count("no pictures: this machine cannot render") == 1
    assert "Traceback" not in ended.stdout + ended.stderr
    made = {p.name for p in (tmp_path / "runs" / "wave").iterdir()}
    assert made == {
        "recording.npz", "model.xml", "task.yaml", "report.json", "hand_speed.png", "torque.png"
    }  # fmt: skip


def test_a_dance_that_fails_ends_with_1(tmp_path: Path) -> None:
    text = GOOD.replace("point: [0.4", "point: [2.0")  # out of reach
    (tmp_path / "far.yaml").write_text(text)
    ended = adonis("run", "far.yaml", cwd=tmp_path, MUJOCO_GL="bogus")
    assert ended.returncode == 1
    assert "0 of 1 sub-tasks succeeded: failed" in ended.stdout
    report = json.loads((tmp_path / "runs" / "wave" / "report.json").read_text())
    assert report["success"] is False


def test_tempo_and_seed_reach_the_recording(tmp_path: Path) -> None:
    (tmp_path / "wave.yaml").write_text(GOOD)
    options = ("--tempo", "90", "--start", "random", "--seed", "4", "--out", "w")
    ended = adonis("run", "wave.yaml", *options, cwd=tmp_path, MUJOCO_GL="bogus")
    assert ended.returncode in (0, 1)
    report = json.loads((tmp_path / "w" / "report.json").read_text())
    assert report["tempo"] == 90
    assert report["seed"] == 4
    recording = Recording.load(tmp_path / "w")
    assert np.abs(recording.qpos[0, 6:]).max() > 0.5, "not at home"


BAD = {
    "missing file": (None, "no such file", ()),
    "broken YAML": ("task: [", "not YAML", ()),
    "unknown key": (GOOD.replace("beats", "beets"), "did you mean 'beats'", ()),
    "unknown primitive": (GOOD.replace("go-to-point", "teleport"), "go-to-point", ()),
    "unknown landmark": (
        GOOD.replace("{point: [0.4, -0.2, 0.35]}", "navel"),
        "belly.front",
        (),
    ),
    "unknown joint": (GOOD.replace("[waist, neck]", "[waist, tail]"), "right_elbow", ()),
    "negative duration": (GOOD.replace("beats: 2", "beats: -2"), "greater than 0", ()),
    "NaN gain": (GOOD.replace("beats: 2", "stiffness: .nan"), "finite", ()),
    "circular order": (GOOD.replace("beats: 2", "after: [up]"), "wait for each other", ()),
    "one arm twice at once": (
        GOOD + "  - {name: b, primitive: go-to-point, limb: right_arm, to: head.top, after: []}\n",
        "both claim right_shoulder_y",
        (),
    ),
    "unknown body": (GOOD, "adonis-female", ("--body", "hercules")),
    "impossible tempo": (GOOD, "between 1 and 1000", ("--tempo", "0")),
    "primitives that are not there": (GOOD, "no such file", ("--primitives", "mine.py")),
}


@pytest.mark.parametrize("kind", BAD)
def test_bad_input_gets_one_message_and_code_2_and_nothing_is_written(tmp_path, kind) -> None:
    text, said, options = BAD[kind]
    if text is not None:
        (tmp_path / "task.yaml").write_text(text)
    before = sorted(tmp_path.iterdir())
    name = "task.yaml" if text is not None else "missing.yml"
    if kind == "missing file":
        said = "No such file"
    ended = adonis("run", name, "--out", "out", *options, cwd=tmp_path)
    assert ended.returncode == 2
    assert said in ended.stderr
    assert ended.stderr.count("\n") == 1
    assert ended.stdout == ""
    assert sorted(tmp_path.iterdir()) == before


def test_a_folder_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    (tmp_path / "wave.yaml").write_text(GOOD)
    (tmp_path / "taken").write_text("a file, not a folder")
    for out in ("taken", "taken/below", "/proc/adonis"):
        ended = adonis("run", "wave.yaml", "--out", out, cwd=tmp_path)
        assert ended.returncode == 2
        assert ended.stderr.startswith("adonis: cannot ")
        assert ended.stderr.count("\n") == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["taken", "wave.yaml"]


def test_check_shows_the_plan(tmp_path: Path) -> None:
    ended = adonis("check", "macarena", cwd=tmp_path)
    assert ended.returncode == 0
    assert "right-to-head" in ended.stdout
    assert "Nothing wrong was found" in ended.stdout


def test_check_doubts_a_goal_that_is_out_of_reach(tmp_path: Path) -> None:
    (tmp_path / "far.yaml").write_text(GOOD.replace("point: [0.4", "point: [2.0"))
    ended = adonis("check", "far.yaml", cwd=tmp_path)
    assert ended.returncode == 1
    assert "up: the goal is" in ended.stdout
    assert "farther from the shoulder" in ended.stdout


@pytest.mark.parametrize(
    ("style", "said"), [("mermaid", "flowchart TD"), ("dot", "digraph"), ("json", '"edges"')]
)
def test_graph_prints_in_three_formats(tmp_path: Path, style: str, said: str) -> None:
    ended = adonis("graph", "macarena", "--format", style, cwd=tmp_path)
    assert ended.returncode == 0
    assert said in ended.stdout


def test_list_shows_tasks_bodies_and_primitives(tmp_path: Path) -> None:
    ended = adonis("list", cwd=tmp_path)
    assert ended.returncode == 0
    for word in ("macarena", "adonis-female", "avoid-collisions", "head.back"):
        assert word in ended.stdout


def test_help_teaches(tmp_path: Path) -> None:
    ended = adonis("--help", cwd=tmp_path)
    assert ended.returncode == 0
    for command in ("run", "check", "graph", "list", "trials", "bench"):
        assert command in ended.stdout
    ended = adonis("run", "--help", cwd=tmp_path)
    assert "macarena" in ended.stdout

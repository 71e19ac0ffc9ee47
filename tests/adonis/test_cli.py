"""The command line, as a shell sees it."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

from adonis.errors import OutputError
from adonis.reporting import write_text
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
    assert report["torque_saturation"] == 0.0
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
        "recording.npz", "model.xml", "task.yaml", "report.json", "hand_speed.png", "torque.png",
        "timeline.png", "attribution.png",
    }  # fmt: skip


def test_a_dance_that_fails_ends_with_1(tmp_path: Path) -> None:
    text = GOOD.replace("point: [0.4", "point: [2.0")  # out of reach
    (tmp_path / "far.yaml").write_text(text)
    ended = adonis("run", "far.yaml", cwd=tmp_path, MUJOCO_GL="bogus")
    assert ended.returncode == 1
    assert "0 of 1 sub-tasks succeeded: failed" in ended.stdout
    assert "-0.00" not in ended.stdout
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
    "primitives that are a task": (
        GOOD,
        "expected a .py file or a module, not 'task.yaml'",
        ("--primitives", "task.yaml"),
    ),
    "primitives that are a folder": (
        GOOD,
        "expected a .py file or a module, not '.'",
        ("--primitives", "."),
    ),
    "a folder without a name": (GOOD, "--out: expected a path, not ''", ("--out", "")),
    "a gain beyond all measure": (
        GOOD.replace("beats: 2", "stiffness: 1.0e+300"),
        "less than or equal to 1000000000",
        (),
    ),
}


def messages(stderr: str) -> int:
    """How many lines of errors there are, without the excerpts of files below them."""
    return sum(1 for line in stderr.splitlines() if not re.match(r" +\d* \| ", line))


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
    assert messages(ended.stderr) == 1
    assert ended.stdout == ""
    assert sorted(tmp_path.iterdir()) == before


def test_a_folder_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    (tmp_path / "wave.yaml").write_text(GOOD)
    (tmp_path / "taken").write_text("a file, not a folder")
    for out in ("taken", "taken/below", "/proc/adonis"):
        ended = adonis("run", "wave.yaml", "--out", out, cwd=tmp_path)
        assert ended.returncode == 2
        assert ended.stderr.startswith("adonis: cannot ")
        assert messages(ended.stderr) == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["taken", "wave.yaml"]


def test_check_shows_the_plan(tmp_path: Path) -> None:
    ended = adonis("check", "macarena", cwd=tmp_path)
    assert ended.returncode == 0
    assert "right-to-head" in ended.stdout
    assert re.search("warning collision left-to-shoulder: .* the right forearm", ended.stdout)
    assert "error" not in ended.stdout
    assert "Nothing wrong was found" in adonis("check", "sway", cwd=tmp_path).stdout


def test_check_ends_with_1_for_an_error_and_says_what_to_do(tmp_path: Path) -> None:
    (tmp_path / "far.yaml").write_text(GOOD.replace("point: [0.4", "point: [2.0"))
    ended = adonis("check", "far.yaml", cwd=tmp_path)
    assert ended.returncode == 1
    assert "error out-of-reach up: at best the palm of adonis stays" in ended.stdout
    assert "the nearest place that it reaches is {point: [" in ended.stdout
    assert "(far.yaml:8:" in ended.stdout


def test_check_gives_tools_its_findings_as_json_and_what_it_refuses_too(tmp_path: Path) -> None:
    (tmp_path / "far.yaml").write_text(GOOD.replace("point: [0.4", "point: [2.0"))
    ended = adonis("check", "far.yaml", "--json", cwd=tmp_path)
    assert ended.returncode == 1
    (finding,) = json.loads(ended.stdout)["findings"]
    assert (finding["code"], finding["file"], finding["line"]) == ("out-of-reach", "far.yaml", 8)
    assert finding["numbers"]["short"] > 1.0
    (tmp_path / "bad.yaml").write_text(GOOD.replace("limb: right_arm", "limb: tail"))
    ended = adonis("check", "bad.yaml", "--json", cwd=tmp_path)
    assert ended.returncode == 2
    (finding,) = json.loads(ended.stdout)["findings"]
    assert (finding["code"], finding["severity"], finding["line"]) == ("refused", "error", 7)
    assert "there are: left_arm, right_arm" in finding["what"]


def test_a_task_without_a_name_is_refused(tmp_path: Path) -> None:
    for command in ("run", "check", "graph"):
        ended = adonis(command, "", cwd=tmp_path)
        assert ended.returncode == 2
        assert ended.stderr.startswith("adonis: expected a task: a file, or one of ")
        assert messages(ended.stderr) == 1


# --- primitives of one's own, with mistakes in them ------------------------------------------

MINE = """
import os
import signal
from typing import Literal

import numpy as np

from primitives import Primitive


class Silent(Primitive):
    kind: Literal["silent"] = "silent"


class Unbound(Primitive):
    kind: Literal["unbound"] = "unbound"

    def bind(self, body, duration):
        return body.joints(None + 1)  # line 19


class Damp(Primitive):
    kind: Literal["damp"] = "damp"
    wrong: str = ""
    at: float = 0.0

    def bind(self, body, duration):
        if self.wrong == "interrupted-bind":
            os.kill(os.getpid(), signal.SIGINT)
        return super().bind(body, duration)

    def torque(self, state, t):
        if t[0] >= self.at:
            match self.wrong:
                case "raises":
                    raise RuntimeError("out of water")  # line 36
                case "exits":
                    raise SystemExit(0)
                case "nan":
                    return np.nan * state.qvel
                case "interrupted":
                    os.kill(os.getpid(), signal.SIGINT)
        return -state.qvel
"""


def with_mine(where: Path, parameters: str) -> tuple[str, ...]:
    (where / "mine.py").write_text(MINE)
    (where / "task.yaml").write_text(
        "task: own\nsubtasks:\n  - {name: up, primitive: get-posture, joints: [neck],"
        " posture: upright, seconds: 0.4}\n"
        f"background:\n  - {{name: water, primitive: {parameters}}}\n"
    )
    return "task.yaml", "--primitives", "mine.py"


def left(where: Path) -> set[str]:
    return {p.name for p in where.iterdir()} - {"mine.py", "task.yaml", "__pycache__"}


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ("silent", "task.yaml:5:5: water: Silent makes no torque: it needs a method torque"),
        ("unbound", "task.yaml:5:5: water: bind of Unbound raised TypeError: unsupported"),
    ],
)
def test_a_mistake_in_bind_is_found_before_anything_moves(tmp_path, command, parameters, said):
    ended = adonis(command, *with_mine(tmp_path, parameters), cwd=tmp_path)
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"adonis: {said}")
    assert ("mine.py:19)" in ended.stderr) == (parameters == "unbound")
    assert messages(ended.stderr) == 1
    assert left(tmp_path) == set()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("raises", "the torque of 'water' raised RuntimeError: out of water ("),
        ("exits", "the torque of 'water' raised SystemExit: 0 ("),
        ("nan", "'water' asks for a torque that is not finite"),
    ],
)
def test_a_mistake_at_the_first_step_leaves_nothing_behind(tmp_path, wrong, said) -> None:
    task = with_mine(tmp_path, f"damp, wrong: {wrong}")
    ended = adonis("run", *task, "--out", "a/b", cwd=tmp_path)
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"adonis: {said}")
    assert messages(ended.stderr) == 1
    assert ended.stdout.strip() == ""
    assert left(tmp_path) == set()


def test_a_folder_that_was_there_stays_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "mine.txt").write_text("mine")
    task = with_mine(tmp_path, "damp, wrong: raises")
    assert adonis("run", *task, "--out", "a", cwd=tmp_path).returncode == 2
    assert [p.name for p in (tmp_path / "a").iterdir()] == ["mine.txt"]


def test_a_mistake_in_mid_run_keeps_what_was_recorded(tmp_path: Path) -> None:
    task = with_mine(tmp_path, "damp, wrong: raises, at: 0.1")
    ended = adonis("run", *task, cwd=tmp_path, MUJOCO_GL="bogus")
    assert ended.returncode == 1
    assert "stopped: the torque of 'water' raised RuntimeError: out of water (" in ended.stdout
    assert "mine.py:36), during up" in ended.stdout
    assert "Traceback" not in ended.stdout + ended.stderr
    recording = Recording.load(tmp_path / "runs" / "own")
    assert recording.time[-1] == pytest.approx(0.1, abs=0.005)
    assert not list((tmp_path / "runs" / "own").glob("*.part"))


@pytest.mark.parametrize(
    "parameters", ["damp, wrong: interrupted-bind", "damp, wrong: interrupted", "late"]
)
def test_ctrl_c_ends_with_130_and_says_so(tmp_path: Path, parameters: str) -> None:
    late = parameters == "late"
    task = with_mine(tmp_path, "damp, wrong: interrupted, at: 0.1" if late else parameters)
    ended = adonis("run", *task, cwd=tmp_path, MUJOCO_GL="bogus")
    assert ended.returncode == 128 + signal.SIGINT
    assert "interrupted" in (ended.stdout if late else ended.stderr)
    assert "Traceback" not in ended.stdout + ended.stderr
    assert left(tmp_path) == ({"runs"} if late else set())


def test_the_last_line_names_the_check_that_failed(tmp_path: Path) -> None:
    """The hand arrives, but the trunk turned away, which no sub-task asks for."""
    turned = "posture: {waist_x: 0, waist_y: 0, waist_z: 20, neck: 0}"
    (tmp_path / "turned.yaml").write_text(GOOD.replace("posture: upright", turned))
    ended = adonis("run", "turned.yaml", cwd=tmp_path, MUJOCO_GL="bogus")
    assert ended.returncode == 1
    assert "1 of 1 sub-tasks succeeded, but not: upright" in ended.stdout
    assert "-0.00" not in ended.stdout


# --- files ---------------------------------------------------------------------------------


def test_bench_finds_out_that_it_cannot_write_before_it_measures(tmp_path: Path) -> None:
    (tmp_path / "afile").write_text("a file, not a folder")
    for out in ("afile/x.json", ".", "/proc/x.json"):
        ended = adonis("bench", "--quick", "--out", out, cwd=tmp_path)
        assert ended.returncode == 2
        assert ended.stderr.startswith("adonis: cannot ")
        assert messages(ended.stderr) == 1, "nothing was measured"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["afile"]


def test_a_text_that_cannot_be_written_is_one_error(tmp_path: Path) -> None:
    (tmp_path / "afile").write_text("a file, not a folder")
    with pytest.raises(OutputError, match=r"cannot write .*afile/x\.json"):
        write_text(tmp_path / "afile" / "x.json", "text")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OutputError, match="cannot write"):
        write_text(tmp_path / "folder", "text")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["afile", "folder"]


SHORT = """task: short
subtasks:
  - {name: out, primitive: get-posture, limb: right_arm, posture: {arm: forward, palm: down}}
"""


def test_compare_writes_a_report(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    ended = adonis(
        "compare", "short.yaml", "--controllers", "pd-servo,torque-field", "--quick", "--out", "c",
        cwd=tmp_path, MUJOCO_GL="nothing",
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    assert "report.html" in ended.stdout
    assert "no pictures" in ended.stdout
    names = {path.name for path in (tmp_path / "c").iterdir()}
    assert {"report.html", "measures.csv", "comparison.json", "recording_pd-servo.npz"} <= names


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--controllers", "pd-servo,magic"), "unknown controller 'magic'"),
        (("--human", "none.csv"), "none.csv: No such file"),
        (("--body", "nobody"), "unknown body"),
    ],
)
def test_a_comparison_that_makes_no_sense_leaves_nothing(tmp_path, options, said) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    ended = adonis("compare", "short.yaml", "--quick", "--out", "c", *options, cwd=tmp_path)
    assert ended.returncode == 2
    assert said in ended.stderr
    assert len(ended.stderr.splitlines()) == 1
    assert not (tmp_path / "c").exists()


def test_run_takes_another_controller(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    ended = adonis("run", "short.yaml", "--controller", "torque-field", "--out", "r", cwd=tmp_path)
    assert ended.returncode in (0, 1), ended.stderr
    report = json.loads((tmp_path / "r" / "report.json").read_text())
    assert report["subtasks"][0]["controller"] == "torque-field"
    refused = adonis("run", "short.yaml", "--controller", "magic", cwd=tmp_path)
    assert refused.returncode == 2
    assert "unknown controller 'magic'" in refused.stderr


@pytest.mark.parametrize(
    ("style", "said"),
    [
        ("mermaid", "flowchart TD"),
        ("dot", "digraph"),
        ("graphml", "<graphml"),
        ("json", '"edges"'),
        ("timeline", "░"),
    ],
)
def test_graph_prints_in_every_format(tmp_path: Path, style: str, said: str) -> None:
    ended = adonis("graph", "macarena", "--format", style, cwd=tmp_path)
    assert ended.returncode == 0
    assert said in ended.stdout
    assert "right" in ended.stdout, "what is claimed"


def test_a_graph_in_json_is_a_task_file(tmp_path: Path) -> None:
    (tmp_path / "wave.json").write_text(
        adonis("graph", "wave", "--format", "json", cwd=tmp_path).stdout
    )
    ended = adonis("check", "wave.json", cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert "3 sub-tasks, 5.40 s" in ended.stdout


def test_a_run_has_a_timeline(finished, tmp_path: Path) -> None:
    _, folder = finished
    assert (folder / "timeline.png").read_bytes().startswith(b"\x89PNG")
    ended = adonis("graph", str(folder), "--format", "timeline", cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.count("done") == 12
    assert "from right-to-shoulder" in ended.stdout
    refused = adonis("graph", str(folder), "--tempo", "90", cwd=tmp_path)
    assert refused.returncode == 2
    assert "a run has had its own" in refused.stderr
    refused = adonis("graph", str(tmp_path), cwd=tmp_path)
    assert refused.returncode == 2
    assert "there is no recording" in refused.stderr


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
    assert "Folder for the results. [default: (runs/TASK)]" in ended.stdout
    ended = adonis("trials", "--help", cwd=tmp_path)
    assert "Folder for the table. [default: (runs/TASK-trials)]" in ended.stdout

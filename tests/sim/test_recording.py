"""Recordings come back as they were, and survive a kill."""

import os
import signal
import subprocess
import sys
import textwrap
from dataclasses import fields

import numpy as np
import pytest

from sim import Recording, RecordingError


def test_it_comes_back_as_it_was(dance, tmp_path) -> None:
    path = tmp_path / "recording.npz"
    dance.recording.save(path)
    again = Recording.load(path)
    for field in fields(Recording):
        before, after = getattr(dance.recording, field.name), getattr(again, field.name)
        if field.name == "about":
            assert {k: after[k] for k in before} == dict(before)
        else:
            np.testing.assert_equal(after, before)
    assert [p.name for p in tmp_path.iterdir()] == ["recording.npz"], "no draft is left"


def test_the_file_holds_what_the_documentation_promises(dance, tmp_path) -> None:
    dance.recording.save(tmp_path / "r.npz")
    steps = len(dance.recording.time)
    with np.load(tmp_path / "r.npz") as file:
        nv, names = 20, file["names"]
        assert file["time"].shape == (steps,)
        assert file["qpos"].shape == file["qvel"].shape == file["torque"].shape == (steps, nv)
        assert file["contribution"].shape == (steps, len(names), nv)
        assert "guard" in names


def test_contributions_add_up_to_the_torque(dance) -> None:
    recording = dance.recording
    asked = recording.contribution.sum(axis=1)
    limit = dance.task.body.torque_limit
    np.testing.assert_allclose(np.clip(asked, -limit, limit), recording.torque, atol=1e-3)


def test_two_runs_write_the_same_bytes(dance, tmp_path) -> None:
    from adonis.dancing import run_task

    (again,) = run_task(dance.task)
    dance.recording.save(tmp_path / "a.npz")
    again.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_a_killed_run_leaves_a_readable_recording(tmp_path) -> None:
    part = tmp_path / "recording.npz.part"
    script = textwrap.dedent(f"""
        import os, signal
        from pathlib import Path
        from adonis.dancing import run_task
        from sim import adonis
        from specs import bind_task, load_task
        spec, document = load_task("macarena")
        kill = lambda share, what: os.kill(os.getpid(), signal.SIGKILL) if share > 0.3 else None
        run_task(bind_task(spec, adonis(), document), part=Path({str(part)!r}), progress=kill)
    """)
    ended = subprocess.run([sys.executable, "-c", script], env={**os.environ}, check=False)
    assert ended.returncode == -signal.SIGKILL
    recording = Recording.load(tmp_path)
    assert not recording.complete
    assert 1.5 < recording.time[-1] < 2.5, "all but the last half second of what was simulated"
    assert recording.names
    np.testing.assert_allclose(np.diff(recording.time), recording.timestep)


@pytest.mark.parametrize("content", [b"", b"not a recording", b"PK\x03\x04 nor this"])
def test_a_file_that_is_no_recording_is_refused(tmp_path, content) -> None:
    (tmp_path / "recording.npz").write_bytes(content)
    with pytest.raises(RecordingError, match="cannot read"):
        Recording.load(tmp_path)


def test_a_missing_recording_is_refused(tmp_path) -> None:
    with pytest.raises(RecordingError, match="there is no recording"):
        Recording.load(tmp_path)

"""Running: a run that breaks off says why and keeps what it has."""

from typing import Literal

import numpy as np
import pytest

from adonis.dancing import Stopped, random_start, run_task
from adonis.judging import judge
from primitives import Primitive
from sim import Body, Push
from specs import BoundTask, SubTask, TaskSpec, bind_task


class Late(Primitive):
    """Asks for nonsense after a tenth of a second."""

    kind: Literal["late"] = "late"

    def torque(self, state, t):
        return np.where(t[:, None] > 0.1, np.nan, 0.0) * state.qvel


def late(body: Body) -> BoundTask:
    spec = TaskSpec(task="t", subtasks=(SubTask(name="bad-idea", does=Late()),))
    return bind_task(spec, body)


def test_a_torque_that_is_no_number_stops_the_run_and_keeps_what_there_was(body: Body) -> None:
    with pytest.raises(Stopped, match="'bad-idea' asks for a torque that is not finite") as caught:
        run_task(task := late(body))
    (recording,) = caught.value.recordings
    assert not recording.complete
    assert recording.time[-1] == pytest.approx(0.1, abs=0.01)
    assert not caught.value.interrupted
    assert np.isfinite(recording.qpos).all()
    assert not judge(recording, task.spec).success


def test_physics_that_goes_wrong_stops_the_run(dance) -> None:
    push = Push("right_hand", (1e9, 0.0, 0.0), 0.5, 0.1)
    with pytest.raises(Stopped, match=r"at 0\.\d+ s .*during right-arm-out") as caught:
        run_task(dance.task, pushes=[push], contributions=False)
    (recording,) = caught.value.recordings
    assert recording.time[-1] >= 0.48


def test_an_interrupted_run_keeps_what_there_was(dance) -> None:
    def interrupt(share: float, subtask: str) -> None:
        assert subtask
        if share > 0.2:
            raise KeyboardInterrupt

    with pytest.raises(Stopped, match=r"interrupted at 1\.6") as caught:
        run_task(dance.task, progress=interrupt)
    assert not caught.value.recordings[0].complete
    assert caught.value.interrupted


def test_random_starts_are_free_and_differ_and_come_again(body: Body) -> None:
    one = random_start(body, body.home, 5, seed=7)
    np.testing.assert_array_equal(one, random_start(body, body.home, 5, seed=7))
    assert np.abs(one - random_start(body, body.home, 5, seed=8)).max() > 0.5
    low, high = body.range
    for q in one:
        assert body.is_free(q)
        assert (q >= low).all()
        assert (q <= high).all()
        np.testing.assert_array_equal(q[body.joints(["waist", "neck"])], 0.0)


def test_a_recording_says_where_it_comes_from(dance) -> None:
    about = dance.recording.about
    assert about["body"] == "adonis"
    assert about["seed"] == 0
    assert about["versions"]["mujoco"].startswith("4.")
    assert "Extend right arm" in about["task"]

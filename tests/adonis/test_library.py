"""Every task of the library does what it says, each simulated once."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from adonis.attribution import attribute
from adonis.dancing import run_task
from adonis.judging import judge
from adonis.reporting import clearance, filmstrip_frames
from arbiter import Arbiter
from sim import Body, Recording, Replay, World
from specs import TaskSpec, bind_task, library, load_task

# The Macarenas by one controller alone are danced in test_comparing; of the one in words, which is
# the same task, test_rehearsal dances two sentences: a rehearsal of all twelve takes minutes.
TASKS = [name for name in library() if not name.startswith("macarena-") or name.endswith("hips")]
ROUTINES = ["ymca", "head-and-shoulders", "conductor", "box-breathing", "cloud-hands"]

Perform = Callable[[str], tuple[TaskSpec, Recording]]


@pytest.fixture(scope="module")
def perform(body: Body) -> Perform:
    @cache
    def once(name: str) -> tuple[TaskSpec, Recording]:
        spec, document = load_task(name)
        (recording,) = run_task(bind_task(spec, body, document))
        return spec, recording

    return once


@pytest.mark.parametrize("name", TASKS)
def test_a_task_of_the_library_succeeds(perform: Perform, name: str) -> None:
    spec, recording = perform(name)
    judgement = judge(recording, spec)
    assert judgement.success, [m for v in judgement.verdicts for m in v.measures if not m.success]
    if name == "all-at-once" or name in ROUTINES:
        assert attribute(recording, Replay(recording)).warnings == ()
    if name == "all-at-once":
        asked = recording.contribution.sum(axis=1)
        np.testing.assert_allclose(asked, recording.torque, atol=1e-3)


@pytest.mark.parametrize("name", ROUTINES)
def test_a_routine_keeps_its_links_apart_and_has_words(perform: Perform, name: str) -> None:
    spec, recording = perform(name)
    nearest = clearance(recording, spec)
    assert nearest.distance > 0.005, nearest.geoms
    assert all(s.words for s in spec.subtasks)
    times = [frame.time for frame in filmstrip_frames(recording, spec)]
    assert times == sorted(set(times)), "one picture of each moment"


def test_the_strokes_of_the_conductor_are_the_beats(perform: Perform) -> None:
    """The hand is lowest on each of the sixteen beats, by less than a tenth of a beat."""
    spec, recording = perform("conductor")
    beat = 60.0 / spec.tempo
    height = Replay(recording).site("right_palm").position[:, 2]
    first = 4 * beat  # the upbeat takes three and a half
    for k in range(16):
        near = np.abs(recording.time - first - k * beat) < 0.4 * beat
        lowest = recording.time[near][np.argmin(height[near])]
        assert abs(lowest - first - k * beat) < 0.1 * beat, f"beat {k + 1}"


def test_the_conductor_bows_only_for_applause(perform: Perform, body: Body) -> None:
    spec, recording = perform("conductor")
    assert {s.name: s.outcome for s in recording.spans}["bow"] == "skipped"
    last = spec.model_copy(
        update={
            "subtasks": tuple(
                s.model_copy(update={"after": None}) if s.name == "down" else s
                for s in spec.subtasks
                if s.name in ("down", "bow")
            )
        }
    )
    task = bind_task(last, body)
    world, arbiter = World(body), Arbiter(task)
    world.reset(task.start)
    arbiter.send("applause")
    while not arbiter.over.all():
        world.step(arbiter.torque(world.state))
    bowed = np.rad2deg(world.state.qpos[0, body.qpos_of_dof[body.joints("waist_y")]])
    assert bowed == pytest.approx(30, abs=3)


def test_the_clouds_are_opposite_and_the_waist_turns_with_them(perform: Perform) -> None:
    _, recording = perform("cloud-hands")
    replay = Replay(recording)
    spans = {s.name: s for s in recording.spans}
    rows = slice(
        recording.row(spans["right-clouds"].start + 3.0), recording.row(spans["right-clouds"].end)
    )
    heights = [replay.site(f"{side}_palm").position[rows, 2] for side in ("right", "left")]
    assert np.corrcoef(*heights)[0, 1] < -0.9
    side = sum(replay.site(f"{side}_palm").position[rows, 1] for side in ("right", "left"))
    turn = replay.angle("waist_z")[rows]
    assert np.corrcoef(side, turn)[0, 1] > 0.9, "to the side of the hands"

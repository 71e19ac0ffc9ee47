"""The judge of rhythms: it reads what a sine has, and sees what was not asked for."""

import numpy as np
import pytest

from adonis.dancing import run_task
from adonis.judging import judge
from adonis.judging_rhythm import asked_rhythms, seen
from primitives import Oscillate
from sim import Body, Recording
from specs import TaskSpec, bind_task, load_task


def run(name: str, body: Body) -> tuple[TaskSpec, Recording]:
    spec, document = load_task(name)
    (recording,) = run_task(bind_task(spec, body, document), contributions=False)
    return spec, recording


@pytest.fixture(scope="module")
def wave(body: Body) -> tuple[TaskSpec, Recording]:
    return run("wave", body)


@pytest.fixture(scope="module")
def sway(body: Body) -> tuple[TaskSpec, Recording]:
    return run("sway", body)


def asking(spec: TaskSpec, where: str, name: str, **changes: object) -> TaskSpec:
    """The task with other parameters for one of its steps."""
    steps = tuple(
        s
        if s.name != name
        else s.model_copy(
            update={
                "does": Oscillate.model_validate(
                    s.does.model_dump(exclude_unset=True, exclude={"kind"}) | changes
                )
            }
        )
        for s in getattr(spec, where)
    )
    return spec.model_copy(update={where: steps})


def wrong(recording: Recording, spec: TaskSpec) -> set[str]:
    judgement = judge(recording, spec)
    measures = [m for v in judgement.verdicts for m in v.measures]
    return {m.what for m in (*measures, *judgement.checks) if not m.success}


def test_a_sine_on_a_slope_is_read_as_it_is() -> None:
    time = np.arange(0.0, 3.1, 0.002)
    found = seen(time, 1.0 - 0.1 * time + 0.3 * np.sin(2 * np.pi * 1.1 * time - 0.5), 1.1)
    assert found.frequency == pytest.approx(1.1, rel=1e-4)
    assert found.phase == pytest.approx(-0.5, abs=1e-3)
    np.testing.assert_allclose(found.amplitudes, 0.3, rtol=1e-3)
    other = seen(time, 0.3 * np.sin(2 * np.pi * 1.4 * time), 1.1)
    assert other.frequency == pytest.approx(1.4, rel=0.02), "whatever was asked"
    assert seen(time, 0 * time, 1.1).frequency == 0.0


def test_what_is_measured_leaves_out_growing_dying_and_changing() -> None:
    does = Oscillate(
        joints={"neck_y": {"amplitude": 5}},
        beats_per_cycle=1,
        then=({"cycle": 4, "frequency": 0.5}, {"cycle": 5, "frequency": 1.0}),
    )
    found = [(r.start, r.end, r.frequency) for r in asked_rhythms(does.at_tempo(120), 1.0, 9.0)]
    assert found == [(1.25, 3.0, 2.0), (5.5, 8.5, 1.0)]


def test_the_wave_is_on_the_beat(wave: tuple[TaskSpec, Recording]) -> None:
    spec, recording = wave
    judgement = judge(recording, spec)
    assert judgement.success
    measures = {m.what: m for m in judgement.verdicts[1].measures}
    assert set(measures) == {"frequency off", "amplitude off", "lag off"}
    assert measures["frequency off"].value < 0.5
    assert judgement.verdicts[1].as_dict()["limb"] == "right_elbow, right_wrist_y"


@pytest.mark.parametrize(
    ("changes", "off"),
    [
        ({"beats_per_cycle": 1.05}, "frequency off"),
        ({"joints": {"right_elbow": {"amplitude": 30}}}, "amplitude off"),
        (
            {
                "joints": {
                    "right_elbow": {"amplitude": 20},
                    "right_wrist_y": {"amplitude": 12, "lag": 0},
                }
            },
            "lag off",
        ),
    ],
)
def test_another_wave_would_not_have_passed(
    wave: tuple[TaskSpec, Recording], changes: dict, off: str
) -> None:
    spec, recording = wave
    assert off in wrong(recording, asking(spec, "subtasks", "wave", **changes))


def test_hips_sway_beside_the_arms(sway: tuple[TaskSpec, Recording]) -> None:
    spec, recording = sway
    judgement = judge(recording, spec)
    assert judgement.success
    beside = [c.what for c in judgement.checks if c.what.startswith("hips")]
    assert beside == ["hips: frequency off", "hips: amplitude off", "hips: lag off"]
    other = asking(spec, "background", "hips", beats_per_cycle=1)
    assert "hips: frequency off" in wrong(recording, other)
    still = spec.model_copy(
        update={"background": tuple(b for b in spec.background if b.name != "hips")}
    )
    assert wrong(recording, still) == {"upright"}

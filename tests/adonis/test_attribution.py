"""Who pulls, who fights, and how smoothly joints are handed over: closed forms and the dance."""

import json
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from adonis.attribution import (
    Attribution,
    attribute,
    bouts,
    conflict,
    given_shares,
    pulls,
    shares,
)
from adonis.cli import app
from adonis.judging import HAND_OVER_STEP
from adonis.transitions import transitions
from sim import Recording, Replay, Span
from specs import task_from_text

ELBOW, WRIST = 9, 12  # of the right arm
NV = 20


@pytest.fixture(scope="module")
def replay(dance) -> Replay:
    return Replay(dance.recording)


@pytest.fixture(scope="module")
def found(dance, replay: Replay) -> Attribution:
    return attribute(dance.recording, replay)


def still(dance, torques: Sequence[float], seconds: float, dof: int = ELBOW) -> Attribution:
    """Attribution of a body at rest, on one joint of which constant torques pull [N m]."""
    rows = round(seconds / 0.002)
    asked = np.zeros((rows, len(torques), NV), dtype=np.float32)
    asked[:, :, dof] = torques
    first = dance.recording
    recording = replace(
        first,
        time=np.arange(rows) * 0.002,
        qpos=np.repeat(first.qpos[:1], rows, axis=0),
        qvel=np.zeros((rows, NV)),
        torque=asked.sum(axis=1, dtype=float),
        contribution=asked,
        names=("one", "other", "third")[: len(torques)],
        spans=(),
    )
    return attribute(recording, Replay(recording))


# --- closed forms ----------------------------------------------------------------------------


def test_torques_that_cancel_are_in_conflict_and_those_that_agree_are_not(dance) -> None:
    (against,) = still(dance, (10.0, -10.0), 0.6).pairs
    assert against.conflict == 1.0
    assert against.together == pytest.approx(0.6)
    assert against.cancelled == pytest.approx(20.0 * 0.6)
    (alike,) = still(dance, (10.0, 10.0), 0.6).pairs
    assert alike.conflict == 0.0
    assert alike.longest_fight is None


def test_a_warning_names_both_the_joint_and_the_time_after_half_a_second(dance) -> None:
    assert still(dance, (10.0, -10.0), 0.4).warnings == ()
    assert still(dance, (10.0, -10.0), 0.5).warnings == ()
    assert still(dance, (10.0, -10.0), 0.6).warnings == (
        "one and other fight over right_elbow from 0.00 to 0.60 s: 100 % of their torque cancels",
    )


@pytest.mark.parametrize(
    ("torques", "warned"),
    [
        ((20.0, -6.8), True),  # conflict 0.507
        ((20.0, -6.0), False),  # 0.46
        ((4.0, -4.0), True),  # 5.2 % of the elbow's 77 N m
        ((3.8, -3.8), False),  # 4.9 %
    ],
)
def test_what_is_weak_or_small_is_no_fight(dance, torques, warned: bool) -> None:
    assert bool(still(dance, torques, 0.6).warnings) is warned


def test_only_the_two_that_cancel_fight(dance) -> None:
    found = still(dance, (10.0, -10.0, 10.0), 0.6)
    assert [p.between for p in found.pairs if p.warning] == [("one", "other"), ("other", "third")]


@given(st.lists(st.floats(-1e3, 1e3), min_size=8, max_size=8))
def test_conflict_is_symmetric_and_within_bounds(values: list[float]) -> None:
    one, other = np.array(values).reshape(2, 4, 1)
    assert 0.0 <= conflict(one, other) <= 1.0
    assert conflict(one, other) == conflict(other, one)
    assert conflict(one, 0.0 * other) == 0.0
    assert conflict(one, -one) == (1.0 if one.any() else 0.0)


@given(st.lists(st.floats(-1e3, 1e3), min_size=12, max_size=12))
def test_shares_add_up_to_one_or_nobody_pulls(values: list[float]) -> None:
    asked = np.array(values).reshape(2, 3, 2)
    total = shares(asked).sum(axis=1)
    np.testing.assert_allclose(total, asked.any(axis=1), atol=1e-12)


def test_a_short_pause_does_not_end_a_fight() -> None:
    on = np.array([0, 1, 1, 0, 1, 0, 0, 0, 1], dtype=bool)
    assert bouts(on, 0) == [(1, 3), (4, 5), (8, 9)]
    assert bouts(on, 1) == [(1, 5), (8, 9)]


def test_a_motor_at_its_limit_gives_each_the_same_part() -> None:
    asked, applied = np.array([[30.0, 5.0, 0.0]]), np.array([[20.0, 5.0, 0.0]])
    np.testing.assert_allclose(given_shares(asked, applied), [[2 / 3, 1.0, 1.0]])


def test_what_a_motor_cannot_give_is_lost(dance) -> None:
    """The wrist's motor gives 15 of the 40 N m that two ask for; shares stay 3 to 1."""
    asked = np.zeros_like(dance.recording.contribution)
    asked[:, 0, WRIST], asked[:, 1, WRIST] = 30.0, 10.0
    torque = np.zeros_like(dance.recording.torque)
    torque[:, WRIST] = 15.0
    recording = replace(dance.recording, contribution=asked, torque=torque)
    found = attribute(recording, Replay(recording))
    assert found.lost == pytest.approx(25.0 / 40.0)
    assert [p.share for p in found.primitives[:2]] == [0.75, 0.25]
    done = np.trapezoid((torque * recording.qvel).sum(axis=1), dx=recording.timestep)
    assert sum(p.work for p in found.primitives) == pytest.approx(done, rel=1e-6)


# --- weight ----------------------------------------------------------------------------------


def test_carrying_the_weight_is_no_fight_and_carrying_it_twice_is() -> None:
    weight = np.linspace(5.0, 9.0, 50)[:, None] * np.array([[1.0, -2.0]])
    spring = np.where(np.arange(50)[:, None] % 7 < 4, -6.0, 4.0) * np.ones((1, 2))
    pulled, carries = pulls(np.stack([weight, spring], axis=1), weight)
    assert carries.tolist() == [True, False]
    assert not pulled[:, 0].any()
    np.testing.assert_array_equal(pulled[:, 1], spring)
    half, carries = pulls(np.stack([0.5 * weight, 0.5 * weight], axis=1), weight)
    assert carries.all()
    assert not half.any()
    twice, carries = pulls(np.stack([weight, weight], axis=1), weight)
    assert carries.all()
    np.testing.assert_allclose(twice.sum(axis=1), weight)
    _, carries = pulls(np.stack([-weight, spring], axis=1), weight)
    assert not carries.any(), "what adds to the weight carries nothing"
    constant = np.full((50, 1, 1), 5.0)
    _, carries = pulls(constant, np.full((50, 1), 7.0))
    assert not carries.any(), "a constant torque on one joint at rest proves nothing"


def test_the_weight_of_a_replay_is_what_compensate_gravity_makes(dance, replay: Replay) -> None:
    asked = dance.recording.contribution[:, dance.recording.names.index("weight")]
    np.testing.assert_allclose(asked, replay.weight(), atol=1e-5)


# --- the dance -------------------------------------------------------------------------------


def test_contributions_are_all_of_the_torque(dance) -> None:
    asked = dance.recording.contribution.sum(axis=1, dtype=float)
    np.testing.assert_allclose(asked, dance.recording.torque, atol=2e-5)


def test_the_table_of_the_dance(dance, found: Attribution) -> None:
    table = {p.name: p for p in found.primitives}
    assert tuple(table) == dance.recording.names
    assert sum(p.share for p in found.primitives) == pytest.approx(1.0)
    assert [name for name, p in table.items() if p.carries_weight] == ["weight"]
    assert max(table, key=lambda name: table[name].share) == "weight"
    assert all(0.0 < p.peak < 1.0 for p in found.primitives)
    assert found.lost == 0.0
    recording = dance.recording
    done = np.trapezoid((recording.torque * recording.qvel).sum(axis=1), dx=recording.timestep)
    assert sum(p.work for p in found.primitives) == pytest.approx(done, abs=1e-2)


def test_nobody_fights_for_long_in_the_dance(found: Attribution) -> None:
    """Collision avoidance holds hands up for a fifth of a second; sub-tasks only hand over."""
    assert found.warnings == ()
    pairs = {p.between: p for p in found.pairs}
    assert not any("weight" in pair for pair in pairs)
    for (one, other), pair in pairs.items():
        if "guard" not in (one, other):
            assert pair.together <= 0.11, f"{one} and {other} share joints after the hand-over"
    worst = found.pairs[0]
    assert worst.between == ("guard", "left-to-shoulder")
    assert 0.4 < worst.conflict < 0.7
    assert 0.1 < worst.longest_fight.seconds < 0.4


# --- hand-overs ------------------------------------------------------------------------------


def test_every_hand_over_is_reported_within_its_bound(dance, replay: Replay) -> None:
    spec, _ = task_from_text(dance.recording.about["task"])
    found = transitions(dance.recording, spec, replay)
    assert [t.taking for t in found] == [s.name for s in spec.subtasks]
    givers = ["arms-at-rest", "arms-at-rest", *(s.name for s in spec.subtasks[:-2])]
    assert [t.giving for t in found] == [(name,) for name in givers]
    for transition in found:
        assert len(transition.joints) == 7
        assert transition.within
        assert transition.jerk > 0.0
        assert transition.settling <= 60.0 / 103.0
    smooth = {t.taking for t in found if t.jerk_share < 1.0}
    assert {t.taking for t in found} - smooth == {"right-to-head"}
    (judged,) = (c for c in dance.judgement.checks if c.what == "hand-over torque step")
    assert judged.limit == HAND_OVER_STEP
    assert max(t.torque_step for t in found) == judged.value


def test_a_hand_over_without_a_fade_is_seen(dance) -> None:
    """A torque that jumps by a fifth of the elbow's limit, and whoever lets go, are named."""
    first, rows = dance.recording, 500
    asked = np.zeros((rows, 2, NV), dtype=np.float32)
    limit = Replay(first).torque_limits()[ELBOW]
    asked[:250, 0, ELBOW], asked[250:, 1, ELBOW] = 0.1 * limit, -0.1 * limit
    recording = replace(
        first, time=first.time[:rows], qpos=first.qpos[:rows], qvel=np.zeros((rows, NV)),
        torque=asked.sum(axis=1, dtype=float), contribution=asked, names=("before", "after"),
        spans=(Span("before", 0.0, 0.5, "done"), Span("after", 0.5, 1.0, "done")),
    )  # fmt: skip
    spec, _ = task_from_text(
        "task: t\nsubtasks:\n"
        + "".join(
            f"  - {{name: {name}, primitive: get-posture, joints: [right_elbow],"
            " posture: rest, seconds: 0.5}\n"
            for name in ("before", "after")
        )
    )
    _, switch = transitions(recording, spec, Replay(recording))
    assert (switch.giving, switch.taking) == (("before",), "after")
    assert switch.joints == ("right_elbow",)
    assert switch.torque_step == pytest.approx(0.2)
    assert not switch.within
    assert switch.jerk == 0.0
    assert 0.0 <= switch.settling <= 0.004


# --- two that fight on purpose ---------------------------------------------------------------


BEND = '''
from typing import Literal
import numpy as np
from primitives import Primitive


class Bend(Primitive):
    """A constant torque on the right elbow."""

    kind: Literal["bend"] = "bend"
    torque_of_elbow: float  # [N m]

    def torque(self, state, t):
        torque = np.zeros_like(state.qvel)
        torque[:, 9] = self.torque_of_elbow
        return torque
'''
QUARREL = """
task: quarrel
background:
  - {name: weight, primitive: compensate-gravity}
  - {name: biceps, primitive: bend, torque_of_elbow: 12}
  - {name: triceps, primitive: bend, torque_of_elbow: -11}
  - {name: posture, primitive: get-posture, joints: [all], posture: rest}
subtasks: [{name: left, primitive: get-posture, limb: left_arm, posture: rest, seconds: 0.7}]
coda: 0.3
"""


def test_two_that_fight_on_purpose_are_warned_of(tmp_path) -> None:
    (tmp_path / "bend.py").write_text(BEND)
    (tmp_path / "quarrel.yaml").write_text(QUARREL)
    files = [f"{tmp_path}/quarrel.yaml", "--primitives", f"{tmp_path}/bend.py"]
    said = CliRunner().invoke(app, ["run", *files, "--out", str(tmp_path)])
    assert said.exit_code == 0, said.output
    warning = "biceps and triceps fight over right_elbow from 0.00 to 1.00 s: 96 % of their torque"
    assert said.output.count(" fight over ") == 1
    assert warning in said.output
    recording = Recording.load(tmp_path)
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["warnings"] == [f"{warning} cancels"]
    (pair,) = (p for p in report["attribution"]["pairs"] if p["between"] == ["biceps", "triceps"])
    assert pair["conflict"] == pytest.approx(22.0 / 23.0)
    assert pair["longest_fight"]["joint"] == "right_elbow"
    assert [p["name"] for p in report["attribution"]["primitives"]] == list(recording.names)
    assert report["transitions"][0]["from"] == ["posture"]
    assert (tmp_path / "attribution.png").read_bytes().startswith(b"\x89PNG")


def test_a_recording_without_contributions_has_nothing_to_attribute(dance, replay) -> None:
    recording = replace(dance.recording, names=(), contribution=dance.recording.contribution[:, :0])
    found = attribute(recording, replay)
    assert found == Attribution((), (), 0.0)
    assert transitions(recording, dance.task.spec, replay) == ()

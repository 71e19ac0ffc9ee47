"""Lint: each kind of finding has a task that triggers it, and one that nearly does."""

import dataclasses

import numpy as np
import pytest

from primitives import GoToPoint, ViaPlace
from sim import Body
from specs import KINDS, Finding, SpecError, bind_task, lint_task, load_task, refusal
from specs import task_from_text as read

HEAD = """task: t
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: arms, primitive: get-posture, joints: [right_arm, left_arm], posture: rest}
  - {name: weight, primitive: compensate-gravity}
"""
REACH = "{name: a, primitive: go-to-point, limb: right_arm, beats: 2, to: %s}"
BEND = "{name: a, primitive: get-posture, joints: [right_elbow], posture: {right_elbow: %s}}"
SWING = (
    "{name: a, primitive: oscillate, joints: {neck_y: {amplitude: 20}}, frequency: 0.5, beats: 4,"
    " centre: {neck_y: %s}}"
)
SPLINE = (
    "{name: a, primitive: get-posture, joints: [right_elbow], posture: {right_elbow: 90},"
    " via: [{posture: {right_elbow: 140}, at: %s}]}"
)
ACROSS = "{near: head.front, away: 0.15}"
OUT = "{name: a, primitive: get-posture, limb: right_arm, posture: {arm: forward}, seconds: %s}"
IF = (
    "{name: a, primitive: get-posture, limb: right_arm, posture: rest,"
    " if: {near: right_elbow.inside, limb: right_arm, distance: %s}}"
)
WAITS = BEND.replace("name: a", "name: a, if: {%s}") % ("%s", "90")
FIGHT = """  - {name: b, primitive: get-posture, joints: [neck],
     posture: {neck_x: %s, neck_y: 0, neck_z: 0}}
subtasks:
  - {name: a, primitive: hold, limb: left_arm}
"""

# Kind -> what triggers it, and what nearly does.
STEPS = {
    "out-of-reach": (REACH % "{point: [0.75, -0.2, 0.4]}", REACH % "{point: [0.62, -0.2, 0.4]}"),
    "inside-body": (
        REACH % "{near: belly.front, away: -0.03}",
        REACH % "{near: belly.front, away: -0.01}",
    ),
    "joint-limit": (SWING % "45", SWING % "39"),
    "too-fast": (OUT % "0.15", OUT % "0.3"),
    # It goes 7 mm into the ribs, or passes them at 2 mm.
    "collision": (REACH % "{point: [0.3, -0.1, 0.3]}", REACH % "{point: [0.3, -0.12, 0.3]}"),
    "stuck": (REACH % "head.back_right", REACH % "head.right"),
    "never": (IF % "0.15", IF % "0.2"),
    "event": (WAITS % "event: go", WAITS % "near: head.front, limb: left_arm, distance: 0.4"),
}
OF_A_PAIR = ("fight", "claims", "refused")  # kinds that have tests of their own


def found(body: Body, step: str, *more: str) -> list[Finding]:
    return linted(body, HEAD + "subtasks:\n" + "".join(f"  - {s}\n" for s in (step, *more)))


def linted(body: Body, text: str) -> list[Finding]:
    spec, document = read(text, "t.yaml")
    return lint_task(bind_task(spec, body, document), document)


@pytest.mark.parametrize("kind", STEPS)
def test_a_kind_of_finding_is_triggered_and_nearly_triggered(body: Body, kind: str) -> None:
    bad, good = STEPS[kind]
    (finding,) = [f for f in found(body, bad) if f.code == kind]
    assert finding.subtask == "a"
    assert finding.place.startswith("t.yaml:7:")
    assert finding.what
    assert finding.advice
    assert kind not in {f.code for f in found(body, good)}


def test_each_kind_of_finding_has_a_task_that_triggers_it() -> None:
    assert {*STEPS, *OF_A_PAIR} == set(KINDS)


def test_what_is_refused_is_a_finding_with_the_same_words(body: Body) -> None:
    for step, kind in ((BEND % "160", "joint-limit"), (REACH % "nowhere", "refused")):
        with pytest.raises(SpecError) as caught:
            found(body, step)
        finding = refusal(caught.value)
        assert (finding.severity, finding.code) == ("error", kind)
        assert f"{finding.place}: {finding.what}" == str(caught.value)
    assert found(body, BEND % "150") == []  # just at the end
    assert "refused" not in {f.code for f in found(body, REACH % "head.front")}


def test_claims_of_the_same_joint_are_a_finding(body: Body) -> None:
    both = "{name: b, after: [], primitive: get-posture, joints: [%s], posture: rest}"
    with pytest.raises(SpecError) as caught:
        found(body, BEND % "90", both % "right_elbow")
    assert refusal(caught.value).code == "claims"
    assert found(body, BEND % "90", both % "left_elbow") == []


def test_a_spline_that_swings_past_the_end_of_a_joint(body: Body) -> None:
    (finding,) = [f for f in found(body, SPLINE % "0.3") if f.code == "joint-limit"]
    assert dict(finding.numbers)["joint"] == "right_elbow"
    assert "joint-limit" not in {f.code for f in found(body, SPLINE % "0.7")}


def test_backgrounds_that_pull_the_same_joints_fight_unless_they_want_the_same(body: Body) -> None:
    (finding,) = linted(body, HEAD + FIGHT % "10")
    assert (finding.code, finding.subtask, finding.severity) == ("fight", "b", "warning")
    assert "neck_z" in finding.what
    assert linted(body, HEAD + FIGHT % "0.5") == []


@pytest.mark.parametrize(("rule", "fights"), [("sum", True), ("dominant", False)])
def test_members_of_a_group_fight_if_their_torques_add_up(
    body: Body, rule: str, fights: bool
) -> None:
    text = HEAD + f"groups: [{{name: g, rule: {rule}, members: [a, arms]}}]\nsubtasks:\n"
    text += f"  - {REACH % 'chest.front'}\n"
    assert ("fight" in {f.code for f in linted(body, text)}) is fights


def test_a_goal_out_of_reach_says_how_far_and_what_is_near(body: Body) -> None:
    (finding,) = found(body, REACH % "{point: [-0.3, 0.2, 0.4]}")
    numbers = dict(finding.numbers)
    assert numbers["short"] == pytest.approx(0.043, abs=0.003)
    gap = np.subtract(numbers["nearest"], (-0.3, 0.2, 0.4))
    assert np.linalg.norm(gap) == pytest.approx(numbers["short"], abs=1e-3)
    x, y, z = numbers["nearest"]
    codes = {f.code for f in found(body, REACH % f"{{point: [{x}, {y}, {z}]}}")}
    assert "out-of-reach" not in codes  # what is advised is itself in reach


def test_what_is_farther_than_the_arm_is_long_is_never_short_by_0_cm(body: Body) -> None:
    arm = body.arm("right_arm")
    shoulder = body.at_home(arm.upper_arm, np.zeros(3)) - body.at_home(arm.root, np.zeros(3))
    x, y, z = shoulder + np.array([body.reach(arm), 0.0, 0.0])
    goals = [f"{{point: [{x + more}, {y}, {z}]}}" for more in (-0.05, 0.001, 0.02, 1.0)]
    steps = [(REACH % goal).replace("name: a", f"name: s{k}") for k, goal in enumerate(goals)]
    short = {f.subtask: dict(f.numbers)["short"] for f in found(body, *steps) if "reach" in f.code}
    assert short == {"s2": pytest.approx(0.02, abs=0.002), "s3": pytest.approx(1.0, abs=0.002)}


def test_no_verdict_where_the_task_moves_the_goal(body: Body) -> None:
    """Out of reach at home; with the other arm raised nobody can tell without simulating."""
    step = REACH % "{near: left_elbow.inside, offset: [0, 0.6, 0]}"
    raised = "{name: r, primitive: get-posture, limb: left_arm, posture: {arm: forward}}"
    assert "out-of-reach" in {f.code for f in found(body, step)}
    assert "out-of-reach" not in {f.code for f in found(body, raised, step)}


def test_the_shortest_time_is_itself_long_enough(body: Body) -> None:
    (finding,) = found(body, OUT % "0.15")
    shortest = dict(finding.numbers)["shortest"]
    assert f"give it {shortest:.2f} s" in finding.advice
    assert found(body, OUT % shortest) == []
    assert found(body, OUT % (0.7 * shortest)) != []


def test_speed_alone_is_a_warning_unless_the_filter_keeps_it(body: Body) -> None:
    quick = "{name: a, primitive: go-to-point, limb: right_arm, seconds: 0.25, to: %s}"
    step = quick % "{point: [0.35, -0.25, 0.35]}"
    (finding,) = found(body, step)
    assert (finding.code, finding.severity) == ("too-fast", "warning")
    assert "degrees per second" in finding.what
    (finding,) = linted(body, HEAD + f"safety: filter\nsubtasks:\n  - {step}\n")
    assert finding.severity == "error"


def test_the_via_point_that_is_given_leads_round(body: Body) -> None:
    (finding,) = found(body, REACH % ACROSS)
    assert finding.code == "collision"
    via = dict(finding.numbers)["via"]
    assert via is not None
    text = HEAD + "subtasks:\n  - " + REACH % ACROSS + "\n"
    spec, document = read(text)
    (subtask,) = spec.subtasks
    assert isinstance(subtask.does, GoToPoint)
    does = subtask.does.model_copy(update={"via": (ViaPlace.model_validate(via),)})
    changed = subtask.model_copy(update={"does": does})
    task = bind_task(spec.model_copy(update={"subtasks": (changed,)}), body, document)
    assert "collision" not in {f.code for f in lint_task(task)}


def test_what_is_stuck_says_what_holds_it(body: Body) -> None:
    (finding,) = [f for f in found(body, REACH % "head.back_right") if f.code == "stuck"]
    assert finding.severity == "warning"
    assert dict(finding.numbers)["short"] > 0.05
    assert "at the end of its range" in finding.what
    text = HEAD.replace("  - {name: weight, primitive: compensate-gravity}\n", "")
    weak = OUT % "2, stiffness: 30, damping: 5"
    (finding,) = linted(body, f"{text}subtasks:\n  - {weak}\n")
    assert finding.code == "stuck"
    assert "nothing carries the weight" in finding.what


@pytest.mark.parametrize(("away", "hits"), [("after: [a]", True), ("after: [first]", False)])
def test_where_the_other_arm_is_by_then(body: Body, away: str, hits: bool) -> None:
    """A hand goes where the other is, which leaves afterwards or at the same time."""
    first = "{name: first, primitive: go-to-point, limb: left_arm, to: {point: [0.36, -0.1, 0.3]}}"
    then = REACH.replace("name: a", "name: a, after: [first]") % "{point: [0.36, -0.15, 0.3]}"
    leave = f"{{name: b, primitive: get-posture, limb: left_arm, posture: rest, {away}}}"
    codes = {f.code for f in found(body, first, then, leave) if f.subtask == "a"}
    assert codes == ({"collision"} if hits else set())


def test_a_way_that_a_rehearsal_looks_for_is_noted_only(body: Body) -> None:
    (plain,) = found(body, REACH % ACROSS)
    text = HEAD.replace("task: t\n", "task: t\nrehearse: true\n")
    (noted,) = linted(body, text + "subtasks:\n  - " + REACH % ACROSS + "\n")
    assert (plain.severity, noted.severity) == ("warning", "note")
    assert "rehearsal" in noted.advice


def test_a_branch_that_is_never_taken_is_said_with_what_comes_after_it(body: Body) -> None:
    text = (
        HEAD
        + """subtasks:
  - {name: a, primitive: get-posture, limb: right_arm, posture: rest, otherwise: d,
     if: {near: head.back, limb: right_arm, distance: 9}}
  - {name: b, primitive: get-posture, limb: left_arm, posture: rest}
  - {name: d, primitive: get-posture, limb: left_arm, posture: rest}
  - {name: e, primitive: get-posture, limb: right_arm, posture: rest}
"""
    )
    findings = linted(body, text)
    assert [(f.subtask, f.code, f.severity) for f in findings] == [
        ("a", "never", "warning"), ("d", "never", "warning"), ("e", "never", "warning")
    ]  # fmt: skip
    assert "always holds" in findings[0].what
    assert linted(body, text.replace("distance: 9", "distance: 0.3")) == []


def test_a_sub_task_that_waits_for_an_event_is_noted(body: Body) -> None:
    (finding,) = found(body, BEND.replace("name: a", "name: a, if: {event: go}") % "90")
    assert (finding.severity, finding.code) == ("note", "event")
    assert "arbiter.send('go')" in finding.advice


@pytest.mark.parametrize("name", ["all-at-once", "macarena", "macarena-pd-servo", "sway"])
def test_no_task_of_the_library_has_an_error(body: Body, name: str) -> None:
    spec, document = load_task(name)
    findings = lint_task(bind_task(spec, body, document), document)
    assert {f.code for f in findings} <= KINDS.keys()
    assert [f for f in findings if f.severity == "error"] == []


def test_findings_are_the_same_each_time_and_gravest_first(body: Body) -> None:
    steps = [BEND % "90", REACH % "head.back", REACH % "{point: [2, 0, 0]}"]
    steps = [s.replace("name: a", f"name: s{k}") for k, s in enumerate(steps)]
    first, again = found(body, *steps), found(body, *steps)
    assert [dataclasses.astuple(f) for f in first] == [dataclasses.astuple(f) for f in again]
    assert [f.severity for f in first] == sorted(f.severity for f in first)

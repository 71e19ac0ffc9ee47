"""Binding: what does not fit is said at its place, and goals out of reach are doubted."""

from typing import Literal

import numpy as np
import pytest

from primitives import Primitive
from sim import Body
from specs import SpecError, bind_task, doubts, load_task, task_from_text


class Own(Primitive):
    """A primitive of somebody's own, with a mistake in it."""

    kind: Literal["own"] = "own"
    makes: str = ""

    def bind(self, body: Body, duration: float):
        match self.makes:
            case "nothing":
                return None
            case "raises":
                raise ValueError("two\nlines")
            case "ends":
                raise SystemExit(3)
        return OwnField(self.makes)


class OwnField:
    """Some of a field."""

    def __init__(self, makes: str) -> None:
        self.claims = np.zeros(0, dtype=np.int32) if makes != "far claims" else np.array([99])
        if makes == "float claims":
            self.claims = np.zeros(0)
        self.unit = "" if makes == "no goal" else "m"
        if makes != "no torque":
            self.torque = self._torque
        if makes == "no method":
            self.begin = 3  # and nothing to shadow

    def _torque(self, state, t):
        return 0.0 * state.qvel + 0.0 * t[:, None]

    def begin(self, state, who) -> None:
        """Nothing to remember."""

    def error(self, state):
        return np.zeros(state.n)


class Silent(Primitive):
    """Neither a torque nor a bind of its own."""

    kind: Literal["silent"] = "silent"


def refused(text: str, body: Body) -> str:
    spec, document = task_from_text(text, "t.yaml", primitives=[Own, Silent])
    with pytest.raises(SpecError) as caught:
        bind_task(spec, body, document)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def one(step: str) -> str:
    return f"task: t\nsubtasks:\n  - {{name: a, {step}}}\n"


@pytest.mark.parametrize(
    ("step", "said"),
    [
        (
            "primitive: silent",
            "a: Silent makes no torque: it needs a method torque(self, state, t)",
        ),
        (
            "primitive: own, makes: nothing",
            "a: bind of Own returned None, which lacks claims, unit",
        ),
        ("primitive: own, makes: no torque", "of type OwnField, which lacks torque (a field has"),
        ("primitive: own, makes: no method", "of type OwnField, which lacks begin (a field has"),
        ("primitive: own, makes: far claims", "claims joints beyond 0 to 19: [99]"),
        ("primitive: own, makes: float claims", "expected an array of integers"),
        ("primitive: own, makes: raises", "a: bind of Own raised ValueError: two lines ("),
        ("primitive: own, makes: ends", "a: bind of Own raised SystemExit: 3 ("),
    ],
)
def test_what_is_no_field_is_refused_at_its_place(body: Body, step: str, said: str) -> None:
    message = refused(one(step), body)
    assert message.startswith("t.yaml:3:5: a: ")
    assert said in message
    if "raised" in said:
        assert "test_binding.py:" in message


def test_waiting_to_reach_needs_a_goal(body: Body) -> None:
    waits = "done: reached, tolerance: 1, timeout: 1"
    message = refused(one(f"primitive: own, makes: no goal, {waits}"), body)
    assert message.startswith("t.yaml:3:53: a: 'done: reached' needs a goal, and own has none")
    text = one(f"primitive: own, makes: all, {waits}")
    spec, document = task_from_text(text, "t.yaml", primitives=[Own])
    bind_task(spec, body, document)


REACH = "primitive: go-to-point, limb: right_arm, to: head.top"
POSTURE = "primitive: get-posture, limb: left_arm, posture: rest"


@pytest.mark.parametrize(
    ("step", "old", "new", "said"),
    [
        (REACH, "right_arm", "rihgt_arm", "unknown limb 'rihgt_arm'; did you mean 'right_arm'"),
        (REACH, "head.top", "moon", "unknown landmark 'moon'"),
        (REACH, "head.top", "head.top, palm: dwn", "unknown direction 'dwn'"),
        (REACH, "head.top", "head.top, via: [{near: haed.top}]", "unknown landmark 'haed.top'"),
        (POSTURE, "rest", "resst", "unknown posture 'resst'"),
        (POSTURE, "rest", "{arm: forward, elbw: 3}", "'elbw'; did you mean 'elbow'"),
        (POSTURE, "rest", "{arm: forward, right_elbow: 3}", "part of left_arm 'right_elbow'"),
        (POSTURE, "limb: left_arm", "joints: [waist, tail]", "unknown joint or joint group 'tail'"),
    ],
)
def test_a_name_that_the_body_lacks_is_pointed_at(body: Body, step, old, new, said) -> None:
    assert old in step
    text = one(step.replace(old, new))
    message = refused(text, body)
    assert said in message
    word = said.split("'")[1]
    line = text.splitlines()[2]
    assert message.startswith(f"t.yaml:3:{line.index(word) + 1}: a: "), message


@pytest.mark.parametrize(
    ("posture", "joint", "one_key", "other"),
    [
        (
            "{arm: forward, left_wrist_z: 10, wrist_z: 20}",
            "left_wrist_z",
            "left_wrist_z",
            "wrist_z",
        ),
        ("{arm: forward, elbow: 30, left_elbow: 40}", "left_elbow", "elbow", "left_elbow"),
        ("{left_arm: 0, wrist_z: 40}", "left_wrist_z", "left_arm", "wrist_z"),
    ],
)
def test_a_joint_that_is_named_twice_is_refused(body: Body, posture, joint, one_key, other) -> None:
    message = refused(one(POSTURE.replace("rest", posture)), body)
    assert f"a: {joint} is given twice: by '{one_key}' and by '{other}'" in message


def test_a_wrong_part_lists_what_an_arm_can_be_told(body: Body) -> None:
    message = refused(one(POSTURE.replace("rest", "{arm: forward, elbw: 3}")), body)
    assert "(there are: arm, elbow, left_elbow," in message
    assert "palm" in message
    assert "wrist_z)" in message


# --- doubts --------------------------------------------------------------------------------


def doubted(body: Body, *goals: str, more: str = "") -> list[str]:
    steps = [
        f"  - {{name: s{k}, primitive: go-to-point, limb: right_arm, to: {goal}}}\n"
        for k, goal in enumerate(goals)
    ]
    spec, document = task_from_text("task: t\nsubtasks:\n" + more + "".join(steps), "t.yaml")
    return doubts(bind_task(spec, body, document))


def test_what_is_near_and_yet_out_of_reach_is_doubted(body: Body) -> None:
    """On the arm itself, and behind the back where no joint lets it go."""
    elbow, behind = doubted(body, "right_elbow.inside", "{point: [-0.3, 0.2, 0.4]}")
    assert elbow == "s0: at best the palm of adonis stays 17.8 cm short of the goal"
    assert behind == "s1: at best the palm of adonis stays 4.3 cm short of the goal"


def test_what_is_farther_than_the_arm_is_long_is_doubted_but_never_by_0_cm(body: Body) -> None:
    arm = body.arm("right_arm")
    shoulder = body.at_home(arm.upper_arm, np.zeros(3)) - body.at_home(arm.root, np.zeros(3))
    x, y, z = shoulder + np.array([body.reach(arm), 0.0, 0.0])
    far = [f"{{point: [{x + more}, {y}, {z}]}}" for more in (-0.05, 0.001, 0.02, 1.0)]
    assert doubted(body, *far) == [
        f"s{k}: the goal is {cm} cm farther from the shoulder than the arm of adonis is long"
        for k, cm in ((2, "2.0"), (3, "100.0"))
    ]


def test_the_macarena_raises_no_doubt(body: Body) -> None:
    spec, document = load_task("macarena")
    assert doubts(bind_task(spec, body, document)) == []


def test_no_doubt_where_the_task_moves_the_goal(body: Body) -> None:
    """Out of reach at home; with the other arm raised nobody can tell without simulating."""
    far = "left_elbow.inside, offset: [-0.3, 0, 0.17]"
    goal = f"{{near: {far}}}"
    assert len(doubted(body, goal)) == 1
    raised = "  - {name: r, primitive: get-posture, limb: left_arm, posture: {arm: forward}}\n"
    assert doubted(body, goal, more=raised) == []

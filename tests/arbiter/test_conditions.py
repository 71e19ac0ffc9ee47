"""Conditions in the graph: branches, joins, repeats, events, pauses; each by itself in a batch."""

import re
from pathlib import Path
from time import perf_counter
from typing import Literal

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from adonis.dancing import run_task
from adonis.judging import judge
from arbiter import Arbiter, ArbiterError
from primitives import AvoidCollisions, CompensateGravity, GetPosture, GoToPoint, Place, Primitive
from sim import Body, Push, World
from specs import (
    Background,
    Condition,
    Join,
    Repeat,
    SpecError,
    SubTask,
    TaskSpec,
    bind_task,
    task_from_text,
)

IN_FRONT = Place(point=(0.40, -0.15, 0.40))
GO = Condition(event="go")


class Constant(Primitive):
    """The same torque on some joints all the time: what comes out is its activation."""

    kind: Literal["constant"] = "constant"
    joints: tuple[str, ...]
    value: float

    def bind(self, body: Body, duration: float):
        return ConstantField(body.joints(self.joints), self.value, body.nv)


class ConstantField:
    unit = "rad"

    def __init__(self, dofs, value: float, nv: int) -> None:
        self.claims = dofs
        self._torque = np.zeros(nv)
        self._torque[dofs] = value

    def begin(self, state, who) -> None:
        """Nothing to remember."""

    def torque(self, state, t):
        return np.tile(self._torque, (state.n, 1))

    def error(self, state):
        return np.zeros(state.n)


def constant(*joints: str, value: float = 1.0) -> Constant:
    return Constant(joints=joints, value=value)


def task_of(body: Body, *subtasks: SubTask, **more):
    return bind_task(TaskSpec(task="t", subtasks=subtasks, tempo=60, **more), body)


def outcomes(arbiter: Arbiter, simulation: int = 0) -> dict[str, str]:
    return {s.name: s.outcome for s in arbiter.spans(simulation)}


def spans(arbiter: Arbiter, simulation: int = 0) -> dict[str, tuple[float, float]]:
    return {s.name: (s.start, s.end) for s in arbiter.spans(simulation)}


class Stage:
    """A task on a body that nothing moves, played bit by bit."""

    def __init__(self, bound, n: int = 1) -> None:
        self.bound, self.world, self.arbiter = bound, World(bound.body, n), Arbiter(bound, n)
        self.asked: list[np.ndarray] = []

    def play(self, seconds: float) -> "Stage":
        for _ in range(round(seconds / self.bound.body.timestep)):
            self.asked.append(self.arbiter.torque(self.world.state).copy())
            self.world.step(np.array(self.world.state.qfrc_bias))
        return self


def step(name: str, *joints: str, value: float = 1.0, **more) -> SubTask:
    """A tenth of a second of a constant torque, unless told otherwise."""
    given = {"seconds": 0.1, **more}
    return SubTask(name=name, does=constant(*(joints or ("neck",)), value=value), **given)


# --- done, within, near ------------------------------------------------------------------------


def test_an_event_ends_what_waits_for_it_in_the_simulations_that_it_is_sent_to(body: Body) -> None:
    stage = Stage(task_of(body, step("wait", done=GO, timeout=1.0), step("next")), n=3)
    stage.play(0.2)
    stage.arbiter.send("go", [1])
    stage.play(0.01)
    assert outcomes(stage.arbiter, 0) == {"wait": "running", "next": "pending"}
    assert outcomes(stage.arbiter, 1) == {"wait": "done", "next": "running"}
    assert spans(stage.arbiter, 1)["wait"][1] == pytest.approx(0.2)
    stage.arbiter.send("go")
    stage.play(0.01)
    assert [outcomes(stage.arbiter, i)["wait"] for i in range(3)] == ["done"] * 3


def test_an_event_counts_only_if_it_is_sent_after_the_beginning(body: Body) -> None:
    """One event does not end two that follow each other."""
    first, second = (step(n, done=GO, timeout=0.5) for n in ("a", "b"))
    stage = Stage(task_of(body, first, second))
    stage.arbiter.send("go")
    stage.play(0.2)
    assert outcomes(stage.arbiter)["a"] == "running"
    stage.arbiter.send("go")
    stage.play(0.2)
    assert outcomes(stage.arbiter) == {"a": "done", "b": "running"}
    stage.play(0.5)
    assert outcomes(stage.arbiter)["b"] == "timed out"
    assert spans(stage.arbiter)["b"][1] == pytest.approx(0.7)


def test_what_ends_one_ends_it_no_sooner_than_its_hand_over(body: Body) -> None:
    stage = Stage(task_of(body, step("a", done=GO, timeout=1.0), hand_over=0.08)).play(0.02)
    stage.arbiter.send("go")
    stage.play(0.2)
    assert spans(stage.arbiter)["a"][1] == pytest.approx(0.08)


@pytest.mark.parametrize(("more", "reached"), [(0.005, True), (-0.005, False)])
def test_a_hand_is_near_or_nearly(body: Body, more: float, reached: bool) -> None:
    """The body stands still: the distance from the palm to the head is known beforehand."""
    arm, mark = body.arm("right_arm"), body.landmark("head.top")
    palm = body.at_home(arm.hand, arm.palm.point)
    distance = float(np.linalg.norm(palm - body.at_home(mark.link, mark.point)))
    near = Condition(near="head.top", limb="right_arm", distance=distance + more)
    stage = Stage(
        task_of(
            body,
            step("wait", done=near, timeout=0.3),
            step("optional", if_=near),
            step("again", repeat=Repeat(until=near, times=2)),
        )
    ).play(0.12)
    assert outcomes(stage.arbiter)["wait"] == ("done" if reached else "running")
    stage.play(1.0)
    became = ["done", "done", "done"] if reached else ["timed out", "skipped", "timed out"]
    assert list(outcomes(stage.arbiter).values()) == became


def test_after_a_time_out_the_other_branch_is_taken_and_both_meet_again(body: Body) -> None:
    for sent in (True, False):
        bound = task_of(
            body,
            step("try", done=GO, timeout=0.3, otherwise="give-up"),
            step("cheer"),
            step("bow"),
            step("give-up", seconds=0.2),
            step("end", after=("bow", "give-up")),
        )
        stage = Stage(bound).play(0.2)
        if sent:
            stage.arbiter.send("go")
        stage.play(0.8)
        found, when = outcomes(stage.arbiter), spans(stage.arbiter)
        if sent:
            assert [found[k] for k in ("try", "cheer", "bow", "give-up")] == ["done"] * 3 + [
                "skipped"
            ]
            assert when["end"][0] == when["bow"][1] == pytest.approx(0.4)
        else:
            assert [found[k] for k in ("try", "cheer", "bow", "give-up")] == [
                "timed out",
                "skipped",
                "skipped",
                "done",
            ]
            assert when["give-up"][0] == pytest.approx(0.3)
            assert when["end"][0] == when["give-up"][1] == pytest.approx(0.5)
        assert found["end"] == "done"
        assert stage.arbiter.over.all()


# --- while, if, repeat ---------------------------------------------------------------------------


def test_while_one_is_on_another_is_and_then_lets_go(body: Body) -> None:
    bound = task_of(
        body,
        step("before"),
        step("wave", repeat=3),
        step("sway", "waist", value=5.0, while_="wave"),
        step("after", "neck"),
        background=(Background(name="rest", does=constant("all")),),
        hand_over=0.05,
    )
    stage = Stage(bound).play(0.7)
    when, waist = spans(stage.arbiter), body.joints("waist")[0]
    assert when["sway"] == pytest.approx((0.1, 0.4)), "through all the rounds"
    assert when["after"][0] == pytest.approx(0.4)
    torque = np.array(stage.asked)[:, 0, waist]
    at = {t: torque[round(t / body.timestep)] for t in (0.05, 0.3, 0.39, 0.6)}
    assert at == pytest.approx({0.05: 1.0, 0.3: 5.0, 0.39: 5.0, 0.6: 1.0})
    assert np.abs(np.diff(torque)).max() < 4.0 * 2.0 * body.timestep / 0.05, "softly"


def test_one_whose_condition_does_not_hold_is_skipped_and_the_next_begins(body: Body) -> None:
    for sent in (True, False):
        stage = Stage(task_of(body, step("a"), step("b", if_=GO), step("c")))
        if sent:
            stage.arbiter.send("go")
        stage.play(0.25)
        assert outcomes(stage.arbiter)["b"] == ("done" if sent else "skipped")
        assert spans(stage.arbiter)["c"][0] == pytest.approx(0.2 if sent else 0.1)


def test_if_chooses_between_two_branches(body: Body) -> None:
    for sent in (True, False):
        bound = task_of(
            body,
            step("a"),
            step("left", if_=GO, otherwise="right"),
            step("more-left"),
            step("right"),
            step("end", after=("more-left", "right")),
        )
        stage = Stage(bound)
        if sent:
            stage.arbiter.send("go")
        stage.play(0.5)
        done = {k for k, outcome in outcomes(stage.arbiter).items() if outcome == "done"}
        assert done == {"a", "end"} | ({"left", "more-left"} if sent else {"right"})


def test_rounds_follow_each_other_without_drift_and_hand_over_softly(body: Body) -> None:
    bound = task_of(
        body,
        step("lift", value=3.0, seconds=1 / 30, repeat=9),
        step("end"),
        background=(Background(name="rest", does=constant("all")),),
        hand_over=0.02,
    )
    stage = Stage(bound).play(0.4)
    assert spans(stage.arbiter)["lift"] == pytest.approx((8 / 30, 9 / 30), abs=1e-9)
    torque = np.array(stage.asked)[:, 0, body.joints("neck")[0]]
    np.testing.assert_allclose(torque[10:149], 3.0, atol=1e-9), "from one round to the next"


def test_repeating_until_an_event_ends_with_the_round(body: Body) -> None:
    bound = task_of(body, step("a", repeat=Repeat(until=GO, times=5)), step("b"))
    stage = Stage(bound).play(0.25)
    stage.arbiter.send("go")
    stage.play(0.1)
    assert outcomes(stage.arbiter) == {"a": "done", "b": "running"}
    assert spans(stage.arbiter)["b"][0] == pytest.approx(0.3)
    never = Stage(bound).play(0.7)
    assert outcomes(never.arbiter) == {"a": "timed out", "b": "done"}
    assert spans(never.arbiter)["b"][0] == pytest.approx(0.5)


# --- joins ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("policy", "begins", "long", "later"),
    [
        ("all", 0.5, "done", "done"),
        ("any", 0.2, "done", "done"),
        ("first", 0.2, "ended", "skipped"),
    ],
)
def test_a_join_waits_for_all_for_any_or_for_the_first(body, policy, begins, long, later) -> None:
    bound = task_of(
        body,
        step("short", "right_arm", seconds=0.2, after=()),
        step("long", "left_arm", value=5.0, seconds=0.4, after=()),
        step("later", "left_arm", value=5.0),
        step("join", after=Join(**{policy: ("short", "later")})),
        background=(Background(name="rest", does=constant("all")),),
        hand_over=0.05,
    )
    stage = Stage(bound).play(0.9)
    assert spans(stage.arbiter)["join"][0] == pytest.approx(begins)
    found = outcomes(stage.arbiter)
    assert (found["short"], found["long"], found["later"]) == ("done", long, later)
    left = np.array(stage.asked)[:, 0, body.joints("left_arm")[0]]
    assert left[-1] == pytest.approx(1.0 if policy == "first" else 5.0), "released, or held"
    assert np.abs(np.diff(left)).max() < 4.0 * 2.0 * body.timestep / 0.05


def test_many_that_are_cut_short_at_once_wait_for_room_and_all_get_their_turn(body: Body) -> None:
    """Races on one joint, each over before the hand-over of the last one is."""
    subtasks = [step("s", seconds=0.01)]
    for k in range(12):
        above = subtasks[-1].name
        subtasks.append(step(f"a{k}", seconds=0.4, after=(above,)))
        subtasks.append(step(f"b{k}", "waist", seconds=0.004, after=(above,)))
        subtasks.append(
            step(f"c{k}", "left_elbow", seconds=0.002, after=Join(first=(f"a{k}", f"b{k}")))
        )
    bound = task_of(body, *subtasks, hand_over=0.3)
    stage = Stage(bound).play(0.6)
    found = outcomes(stage.arbiter)
    assert all(found[f"a{k}"] == "ended" for k in range(12))
    assert all(found[f"c{k}"] == "done" for k in range(12))
    assert stage.arbiter.over.all()


# --- from outside --------------------------------------------------------------------------------


def test_a_pause_lets_time_stand_still_and_the_task_goes_on_as_if_nothing_were(body: Body) -> None:
    bound = task_of(body, step("a", seconds=0.3), step("b", seconds=0.3), hand_over=0.05)
    stage = Stage(bound, n=2).play(0.2)
    stage.arbiter.pause([1])
    stage.play(1.0)
    assert outcomes(stage.arbiter, 0) == {"a": "done", "b": "done"}
    assert outcomes(stage.arbiter, 1) == {"a": "running", "b": "pending"}
    stage.arbiter.resume([1])
    stage.play(0.5)
    (start, end), late = spans(stage.arbiter, 1)["b"], 1.0
    assert end - start == pytest.approx(0.3)
    assert start == pytest.approx(0.3 + late, abs=2 * body.timestep)


def reach_task(body: Body):
    """A real reach, with what a body needs beside it."""
    spec = TaskSpec(
        task="t",
        subtasks=(
            SubTask(name="up", does=GoToPoint(limb="right_arm", to=IN_FRONT), seconds=1.0),
            SubTask(
                name="out",
                does=GetPosture(limb="left_arm", posture={"arm": "forward", "palm": "up"}),
            ),
        ),
        background=(
            Background(name="hold", does=GetPosture(joints=("all",), posture="rest")),
            Background(name="weight", does=CompensateGravity()),
            Background(name="guard", does=AvoidCollisions()),
        ),
    )
    return bind_task(spec, body)


@pytest.mark.parametrize("what", ["pause", "stop"])
def test_a_body_that_is_paused_or_stopped_midway_comes_to_rest_softly(body: Body, what) -> None:
    bound = reach_task(body)
    world, arbiter = World(body), Arbiter(bound)
    world.reset(bound.start)
    torque, moved = [], []
    for k in range(1500):
        if k == 250:
            getattr(arbiter, what)()
        torque.append(arbiter.torque(world.state)[0].copy())
        world.step(arbiter.torque(world.state))
        moved.append(np.array(world.state.qvel[0]))
    steps = np.abs(np.diff(torque, axis=0)) / body.torque_limit
    assert steps[249:].max() < 0.10, "the bound of a hand-over, of the limit in 2 ms"
    assert np.abs(moved[240]).max() > 0.5, "it was on its way"
    assert np.abs(moved[-1]).max() < 0.02, "and came to rest"
    arm = body.qpos_of_dof[body.joints("right_arm")]
    away = np.abs(np.array(world.state.qpos[0])[arm] - body.home[arm]).max()
    if what == "stop":
        assert away < np.deg2rad(5.0), "back in the background's posture"
        assert set(outcomes(arbiter).values()) == {"ended", "skipped"}
        assert arbiter.over.all()
        arbiter.reset()
        arbiter.torque(world.state)
        assert outcomes(arbiter)["up"] == "running"
    else:
        assert away > np.deg2rad(15.0), "held where it was"
        arbiter.resume()
        for _ in range(1000):
            world.step(arbiter.torque(world.state))
        assert outcomes(arbiter)["up"] == "done"


def test_an_event_that_nobody_waits_for_is_refused(body: Body) -> None:
    arbiter = Arbiter(task_of(body, step("a", done=GO, timeout=1.0)))
    with pytest.raises(ArbiterError, match=r"unknown event 'og'.*go"):
        arbiter.send("og")


def test_an_event_in_a_pause_counts_when_it_is_over(body: Body) -> None:
    stage = Stage(task_of(body, step("a", done=GO, timeout=1.0))).play(0.2)
    stage.arbiter.pause()
    stage.play(0.2)
    stage.arbiter.send("go")
    stage.play(0.2)
    assert outcomes(stage.arbiter) == {"a": "running"}
    stage.arbiter.resume()
    stage.play(0.01)
    assert outcomes(stage.arbiter) == {"a": "done"}


# --- any graph at all ----------------------------------------------------------------------------

PARTS = ("neck_x", "neck_y", "neck_z", "waist_x", "waist_y")


@st.composite
def graphs(draw: st.DrawFn) -> tuple[SubTask, ...]:
    """Any sub-tasks after any others, under any conditions that fit together."""
    subtasks: list[SubTask] = []
    count = draw(st.integers(2, 9))
    spared: set[str] = set()
    for k in range(count):
        name, more = f"s{k}", {}
        above = [s.name for s in subtasks]
        kind = draw(st.sampled_from(["plain", "event", "if", "while", "repeat"]))
        if name not in spared and above and kind == "while":
            more["while_"] = draw(st.sampled_from(above))
        else:
            if name not in spared:
                names = tuple(draw(st.lists(st.sampled_from(above), unique=True))) if above else ()
                policy = draw(st.sampled_from(["all", "any", "first"])) if names else "plain"
                more["after"] = Join(**{policy: names}) if policy != "plain" else ()
            event = Condition(event=draw(st.sampled_from(["e0", "e1"])))
            if kind == "event":
                more |= {"done": event, "timeout": draw(st.sampled_from([0.01, 0.03]))}
            elif kind == "if":
                more["if_"] = event
            elif kind == "repeat":
                more["repeat"] = draw(st.sampled_from([2, Repeat(until=event, times=2)]))
            branches = kind in ("event", "if") and k + 1 < count and draw(st.booleans())
            if branches and (
                free := [f"s{j}" for j in range(k + 1, count) if f"s{j}" not in spared]
            ):
                more["otherwise"] = draw(st.sampled_from(free))
                spared.add(more["otherwise"])
        joint = draw(st.sampled_from(PARTS))
        seconds = draw(st.sampled_from([0.004, 0.01, 0.03]))
        subtasks.append(step(name, joint, seconds=seconds, **more))
    return tuple(subtasks)


@given(graphs(), st.lists(st.integers(0, 60), max_size=4))
@settings(max_examples=150, suppress_health_check=[HealthCheck.filter_too_much])
def test_every_graph_comes_to_its_end_and_no_joint_is_claimed_twice_at_once(
    body: Body, subtasks: tuple[SubTask, ...], sent: list[int]
) -> None:
    try:
        bound = task_of(body, *subtasks, hand_over=0.006)
    except SpecError:
        assume(False)
    world, arbiter = World(body), Arbiter(bound)
    still = np.zeros((1, body.nv))
    for k in range(500):
        for number in (n for n, at in enumerate(sent) if at == k and bound.events):
            arbiter.send(bound.events[number % len(bound.events)])
        torque = arbiter.torque(world.state)
        assert (torque <= 1.0 + 1e-9).all()
        assert (torque >= 0.0).all()
        world.step(still)
        running = {s.name for s in arbiter.spans() if s.outcome == "running"}
        claimed = [s.does.joints[0] for s in subtasks if s.name in running]
        assert len(claimed) == len(set(claimed)), running
        if arbiter.over.all():
            break
    assert arbiter.over.all(), outcomes(arbiter)
    used = [(s.start, s.end, subtasks[int(s.name[1:])]) for s in arbiter.spans() if s.end == s.end]
    for start, end, one in used:
        for begun, _, other in used:
            if one is not other and one.does.joints == other.does.joints:
                assert not start + 1e-9 < begun < end - 1e-9, (one.name, other.name)


# --- in a batch ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def branching(body: Body):
    """Whoever is pushed misses the chest in time, and takes the other branch."""
    up = GoToPoint(limb="right_arm", to="chest.front")
    near = Condition(near="chest.front", limb="right_arm", distance=0.05)
    waist = GetPosture(joints=("waist",), posture="upright")
    neck = GetPosture(joints=("neck",), posture="upright")
    salute = GetPosture(limb="right_arm", posture="rest")
    out, wave = (
        GetPosture(limb=limb, posture={"arm": "forward", "palm": "up"})
        for limb in ("right_arm", "left_arm")
    )
    rest = GetPosture(limb="left_arm", posture="rest")
    reached = {"done": "reached", "tolerance": 0.05, "timeout": 0.4}
    all_over = ("wave", "salute", "out")
    spec = TaskSpec(
        task="t",
        coda=0.2,
        subtasks=(
            SubTask(name="up", does=up, seconds=0.7, done=near, timeout=0.62, otherwise="out"),
            SubTask(name="turn", does=waist, seconds=0.2, after=()),
            SubTask(name="salute", does=salute, seconds=0.3, after=("up",)),
            SubTask(name="out", does=out, seconds=0.2),
            SubTask(name="beside", does=neck, while_="out"),
            SubTask(
                name="wave", does=wave, seconds=0.2, repeat=2, after=Join(any=("turn", "salute"))
            ),
            SubTask(name="rest", does=rest, seconds=0.3, after=all_over, **reached),
        ),
        background=(
            Background(name="hold", does=GetPosture(joints=("all",), posture="rest")),
            Background(name="weight", does=CompensateGravity()),
            Background(name="guard", does=AvoidCollisions()),
        ),
    )  # fmt: skip
    return bind_task(spec, body)


def test_256_simulations_of_a_branching_graph_end_where_each_would_alone(branching) -> None:
    """Done-when 7: every one with a push of its own, on one thread and on two."""
    n = 256
    rng = np.random.default_rng(5)
    force, when = rng.uniform(-60, 60, (n, 3)), rng.uniform(0.2, 0.5, n)
    pushes = [Push("right_hand", tuple(force[i]), when[i], 0.1, simulations=(i,)) for i in range(n)]
    one, two = (
        run_task(branching, n=n, threads=k, pushes=pushes, contributions=False) for k in (1, 2)
    )
    ways = [{s.name: s.outcome for s in r.spans}["out"] for r in one]
    assert 20 < ways.count("done") < n - 20, "both branches are taken often"
    for a, b in zip(one, two, strict=True):
        assert a.spans == b.spans or str(a.spans) == str(b.spans)
        np.testing.assert_array_equal(a.qpos, b.qpos)
    body = branching.body
    for i, recording in enumerate(one):
        push = Push("right_hand", tuple(force[i]), when[i], 0.1)
        world, arbiter = World(body, pushes=[push]), Arbiter(branching, contributions=False)
        world.reset(branching.start)
        qpos = np.empty_like(recording.qpos)
        for row in qpos:
            row[:] = world.state.qpos[0]
            world.step(arbiter.torque(world.state))
        np.testing.assert_array_equal(qpos, recording.qpos)
        assert str(arbiter.spans()) == str(recording.spans)


def test_the_judge_takes_a_branch_that_was_not_taken_for_what_it_is(branching) -> None:
    (recording,) = run_task(branching, contributions=False)
    verdicts = {v.subtask.name: v for v in judge(recording, branching.spec).verdicts}
    assert verdicts["up"].span.outcome == "done"
    for name in ("out", "beside"):
        assert verdicts[name].span.outcome == "skipped"
        assert verdicts[name].success
        assert verdicts[name].measures == ()


def test_a_branching_graph_of_ten_thousand_runs_as_fast_as_a_small_one(body: Body) -> None:
    """The best of many short measurements: others may use the machine."""
    neck = GetPosture(joints=("neck",), posture="upright")

    def seconds_per_step(count: int) -> float:
        subtasks = [SubTask(name="s", does=neck, seconds=0.01)]
        for k in range(count // 2):
            above = subtasks[-1].name
            wait = {"done": GO, "timeout": 9.0, "otherwise": f"b{k}", "after": (above,)}
            subtasks.append(SubTask(name=f"a{k}", does=neck, seconds=0.05, **wait))
            subtasks.append(SubTask(name=f"b{k}", does=neck, seconds=0.05))
        world, arbiter = World(body), Arbiter(task_of(body, *subtasks))
        for _ in range(100):
            world.step(arbiter.torque(world.state))
        assert arbiter.spans()[1].outcome == "running"
        took = []
        for _ in range(40):
            begun = perf_counter()
            for _ in range(20):
                arbiter.torque(world.state)
            took.append(perf_counter() - begun)
        return min(took)

    assert seconds_per_step(10_000) < 1.5 * seconds_per_step(12)


@pytest.mark.parametrize("patience", [2, 0.3])
def test_the_task_in_the_documentation_does_what_it_says(body: Body, patience: float) -> None:
    page = (Path(__file__).parents[2] / "docs" / "tasks.md").read_text(encoding="utf-8")
    (text,) = (t for t in re.findall(r"```yaml\n(.*?)```", page, re.DOTALL) if "task: knock" in t)
    text = text.replace("timeout: 2\n", f"timeout: {patience}\n")
    spec, document = task_from_text(text, "knock.yaml")
    (recording,) = run_task(bind_task(spec, body, document))
    found = {s.name: s.outcome for s in recording.spans}
    left_out = {"bow", "give-up"} if patience == 2 else {"knock", "nod", "bow"}
    assert {name for name, outcome in found.items() if outcome == "skipped"} == left_out
    assert found["reach"] == ("done" if patience == 2 else "timed out")
    assert found["home"] == "done"
    assert all(v.success for v in judge(recording, spec).verdicts)

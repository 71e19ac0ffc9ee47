"""Rhythms: their frequency, amplitude, lags, and how they listen to the limb."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from pydantic import ValidationError

from adonis.dancing import run_task
from adonis.judging_rhythm import seen
from primitives import GetPosture, Oscillate, PrimitiveError
from primitives.limit_cycle import limit_cycle
from primitives.oscillator import BETA, GAMMA
from sim import Body, BodyError, BodyMap, State, World
from sim.state import read_only
from specs import SpecError, bind_task, task_from_text

DT = 0.002  # [s]
STIFFNESS = 100.0  # [N m/rad]
KINDS = ("sine", "hopf", "matsuoka")
ASKED = 20.0  # [deg]
A = np.deg2rad(ASKED)

PENDULUMS = """
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <body name="left" pos="0 0.3 1">
      <joint name="one" axis="0 1 0" damping="{damping}"/>
      <geom name="a" type="capsule" fromto="0 0 0 0 0 -0.5" size="0.02" mass="1"/>
    </body>
    <body name="right" pos="0 -0.3 1">
      <joint name="two" axis="0 1 0" damping="{damping}"/>
      <geom name="b" type="capsule" fromto="0 0 0 0 0 -0.5" size="0.02" mass="1"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="one" joint="one" ctrllimited="true" ctrlrange="-200 200"/>
    <motor name="two" joint="two" ctrllimited="true" ctrlrange="-200 200"/>
  </actuator>
</mujoco>"""


def pendulums(damping: float = 0.0) -> Body:
    """Two pendulums, side by side."""
    names = BodyMap(
        name="pendulums",
        limbs={},
        groups={"both": ("one", "two")},
        postures={"rest": {"one": 0, "two": 0}, "half": {"one": 10}},
        servos={joint: {"stiffness": 20, "damping": 4} for joint in ("one", "two")},
    )
    return Body(mujoco.MjSpec.from_string(PENDULUMS.format(damping=damping)), names)


@pytest.fixture(scope="module")
def pair() -> Body:
    return pendulums()


def at_rest(body: Body, n: int = 1) -> State:
    world = World(body, n)
    world.reset(np.zeros((n, 2)))
    return world.state


def one(**given: object) -> Oscillate:
    """A swing of the first joint that is there at once; its torque is its output times k."""
    plain = {"joints": {"one": {"amplitude": ASKED}}, "ease": 0, "claims": False}
    return Oscillate(**plain | {"stiffness": STIFFNESS, "damping": 0} | given)


def outputs(does: Oscillate, body: Body, time: np.ndarray, angles: np.ndarray | None = None):
    """What the oscillators say (T, n, 2) [rad] while the joints are led along angles (T, n, 2)."""
    n = 1 if angles is None else angles.shape[1]
    state, field = at_rest(body, n), does.bind(body, np.inf)
    field.begin(state, np.ones(n, dtype=bool))
    said = np.empty((len(time), n, 2))
    for k, t in enumerate(time):
        led = state if angles is None else replace(state, qpos=read_only(angles[k]))
        said[k] = field.torque(led, np.full(n, t)) / STIFFNESS
    return said


def until(seconds: float) -> np.ndarray:
    return np.arange(round(seconds / DT)) * DT


def late(time: np.ndarray, angle: np.ndarray, frequency: float):
    """What is to be seen in the second half."""
    half = slice(len(time) // 2, None)
    return seen(time[half], angle[half], frequency)


# --- by itself ------------------------------------------------------------------------------


def test_a_sine_is_exact(pair: Body) -> None:
    time = until(3.0)
    said = outputs(one(frequency=1.3, phase=40), pair, time)[:, 0, 0]
    np.testing.assert_allclose(
        said, A * np.sin(2 * np.pi * 1.3 * time + np.deg2rad(40)), atol=1e-12
    )


@pytest.mark.parametrize("frequency", [0.5, 1.0, 2.0, 5.0])
def test_matsuoka_keeps_to_the_formula_and_to_what_was_asked(pair: Body, frequency: float) -> None:
    """Matsuoka (2011): omega = sqrt(((t1 + t2) beta - t1 gamma) / (t1 gamma)) / t2."""
    t1 = limit_cycle().pace / frequency
    t2 = 2.0 * t1
    formula = np.sqrt(((t1 + t2) * BETA - t1 * GAMMA) / (t1 * GAMMA)) / t2 / (2 * np.pi)
    time = until(12.0 / frequency)
    said = late(time, outputs(one(frequency=frequency, oscillator="matsuoka"), pair, time)[:, 0, 0],
                frequency)  # fmt: skip
    assert said.frequency == pytest.approx(formula, rel=0.02)
    assert said.frequency == pytest.approx(frequency, rel=2e-3)
    np.testing.assert_allclose(said.amplitudes, A, rtol=0.01)


def test_the_amplitude_of_matsuoka_goes_with_its_input_and_its_frequency_does_not(
    pair: Body,
) -> None:
    assert limit_cycle().swing == pytest.approx(0.48, rel=0.01)
    time, frequencies = until(12.0), []
    for degrees in (1.0, 10.0, 90.0):
        does = one(
            frequency=1, oscillator="matsuoka", joints={"one": {"amplitude": degrees}},
        )  # fmt: skip
        said = late(time, outputs(does, pair, time)[:, 0, 0], 1.0)
        np.testing.assert_allclose(np.rad2deg(said.amplitudes), degrees, rtol=0.01)
        frequencies.append(said.frequency)
    np.testing.assert_allclose(frequencies, frequencies[0], rtol=1e-6)


@pytest.mark.parametrize("oscillator", KINDS)
def test_it_begins_at_its_phase(pair: Body, oscillator: str) -> None:
    time = until(6.0)
    said = outputs(one(frequency=1, phase=30, oscillator=oscillator), pair, time)[:, 0, 0]
    assert np.rad2deg(seen(time, said, 1.0).phase) == pytest.approx(30, abs=2)


@pytest.mark.parametrize("oscillator", KINDS)
def test_a_change_of_tempo_makes_no_jump(pair: Body, oscillator: str) -> None:
    time = until(9.0)
    does = one(frequency=0.8, then=[{"cycle": 2.3, "frequency": 2}], oscillator=oscillator)
    said = outputs(does, pair, time)[:, 0, 0]
    change = 2.3 / 0.8
    cycles = np.where(time < change, 0.8 * time, 2.3 + 2 * (time - change))
    steady = outputs(one(frequency=0.8, oscillator=oscillator), pair, until(20.0))[:, 0, 0]
    wanted = np.interp(cycles / 0.8, until(20.0), steady)
    np.testing.assert_allclose(said, wanted, atol=2e-3 * A)
    steepest = np.abs(np.diff(steady)).max() * 2 / 0.8
    assert np.abs(np.diff(said)).max() < 1.05 * steepest
    after = time > change + 0.5
    assert seen(time[after], said[after], 2.0).frequency == pytest.approx(2, rel=2e-3)


@pytest.mark.parametrize("oscillator", KINDS)
def test_asking_twice_does_not_hurry_it_and_a_pause_does_not_stop_it(
    pair: Body, oscillator: str
) -> None:
    does, time = one(frequency=1, oscillator=oscillator), until(2.0)
    once = outputs(does, pair, time)
    np.testing.assert_array_equal(outputs(does, pair, np.repeat(time, 2))[::2], once)
    paused = outputs(does, pair, np.concatenate([time[:100], time[-100:]]))
    np.testing.assert_allclose(paused[-100:], once[-100:], atol=5e-4 * A)


# --- with the limb ----------------------------------------------------------------------------


def test_matsuoka_locks_to_a_weak_input(pair: Body) -> None:
    """1:1 over 0.4 to 1.4 of its own frequency, the input being 0.3 of its own drive c."""
    ratios = np.arange(0.4, 1.41, 0.1)
    time, c = until(40.0), A / limit_cycle().swing
    led = np.zeros((len(time), len(ratios), 2))
    led[:, :, 0] = 0.3 * c * np.sin(2 * np.pi * ratios * time[:, None])
    does = one(frequency=1, oscillator="matsuoka", feedback=1)

    def off(said: np.ndarray) -> np.ndarray:
        found = [late(time, said[:, k, 0], r).frequency / r for k, r in enumerate(ratios)]
        return np.abs(np.array(found) - 1)

    assert off(outputs(does, pair, time, led)).max() < 0.005
    assert off(outputs(does, pair, time, 0.1 * led))[[0, -1]].min() > 0.05, "not to any input"


WEAKLY = [(3.0, 0.023, share) for share in (0.5, 0.65, 0.8, 0.95)]
STRONGLY = [(0.023, 0.5), (0.023, 1.1), (0.023, 1.6), (0.046, 1.1), (0.092, 0.8)]


@pytest.mark.parametrize(
    ("feedback", "critical", "share"), [*WEAKLY, *((30.0, *case) for case in STRONGLY)]
)
def test_matsuoka_finds_the_resonance_of_a_pendulum(
    feedback: float, critical: float, share: float
) -> None:
    """It comes to swing the limb at its natural frequency.

    With weak feedback an oscillator that is slower than the limb does so, and the limb swings
    much further than it is driven. With strong feedback a faster one does so too, and the limb
    swings less. The arm is damped by a share of what is critical, its spring is 0.4 of its weight.
    The more it is damped, the slower the oscillator has to be."""
    body = pendulums(damping=critical / 0.92)
    model, data = body.model, mujoco.MjData(body.model)
    data.qpos[0] = 0.01
    mujoco.mj_forward(model, data)
    mass = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    weight = data.qfrc_bias[0] / 0.01  # m g l [N m/rad]
    spring = 0.4 * weight
    natural = np.sqrt((weight + spring) / mass[0, 0]) / (2 * np.pi)
    does = one(
        joints={"one": {"amplitude": 3}}, frequency=share * natural, oscillator="matsuoka",
        claims=True, feedback=feedback, stiffness=spring,
    )  # fmt: skip
    world, field = World(body), does.bind(body, np.inf)
    world.reset(np.zeros(2))
    field.begin(world.state, np.ones(1, dtype=bool))
    time = until(24.0)
    angle = np.empty(len(time))
    for k in range(len(time)):
        angle[k] = world.state.qpos[0, 0]
        world.step(field.torque(world.state, world.state.time))
    found = late(time, angle, natural)
    assert found.frequency == pytest.approx(natural, rel=0.05)
    least = 2 * 3 if feedback == 3.0 else 2.0
    assert np.rad2deg(found.amplitudes.min()) > least, "and it does swing"


def test_hopf_comes_back_to_its_circle(pair: Body) -> None:
    time = until(4.0)
    led = np.zeros((len(time), 1, 2))
    led[(time > 1.0) & (time < 1.4), 0, 0] = -2 * A
    said = outputs(one(frequency=1, oscillator="hopf", feedback=1), pair, time, led)[:, 0, 0]
    assert np.abs(said[(time > 1) & (time < 1.5)]).max() > 1.3 * A, "it was disturbed"
    np.testing.assert_allclose(seen(time[time > 2], said[time > 2], 1.0).amplitudes, A, rtol=0.005)


@pytest.mark.parametrize("oscillator", ["hopf", "matsuoka"])
def test_joints_find_back_to_their_lags(pair: Body, oscillator: str) -> None:
    """One of them is held aside for a while; without coupling the lag stays what it became."""
    time = until(12.0)
    led = np.zeros((len(time), 1, 2))
    led[(time > 1.0) & (time < 1.3), 0, 1] = A
    lags = {}
    for coupling in (0.5, 0.0):
        joints = {"one": {"amplitude": ASKED}, "two": {"amplitude": 10, "lag": 90}}
        does = one(frequency=1, joints=joints, oscillator=oscillator, feedback=1, coupling=coupling)
        said = outputs(does, pair, time, led)[:, 0]
        first, second = (late(time, said[:, j], 1.0).phase for j in (0, 1))
        lags[coupling] = np.rad2deg(first - second) % 360
    assert lags[0.5] == pytest.approx(90, abs=2)
    assert abs(lags[0.0] - 90) > 10


# --- as a field -------------------------------------------------------------------------------


@pytest.mark.parametrize("oscillator", KINDS)
def test_at_rest_on_the_centre_it_asks_for_nothing(pair: Body, oscillator: str) -> None:
    does = Oscillate(joints={"one": {"amplitude": 20}}, frequency=1, phase=50,
                     oscillator=oscillator)  # fmt: skip
    state, field = at_rest(pair), does.bind(pair, 3.0)
    field.begin(state, np.ones(1, dtype=bool))
    moving = [np.abs(field.torque(state, np.array([t]))).max() for t in (0.0, 1.0, 3.0, 5.0)]
    assert moving[0] == moving[2] == moving[3] == 0.0
    assert moving[1] > 1.0


@pytest.mark.parametrize("oscillator", KINDS)
def test_beside_a_servo_it_moves_what_the_servo_holds(pair: Body, oscillator: str) -> None:
    """A claiming swing about a centre is a servo there and a swing beside it."""
    swing = {"joints": {"one": {"amplitude": 20}}, "frequency": 1, "oscillator": oscillator}
    held = Oscillate(**swing, centre="rest", ease=0).bind(pair, np.inf)
    beside = Oscillate(**swing, claims=False, ease=0).bind(pair, np.inf)
    servo = GetPosture(joints=("one",), posture="rest").bind(pair, 0.01)
    world = World(pair)
    world.reset(np.zeros(2))
    for field in (held, beside, servo):
        field.begin(world.state, np.ones(1, dtype=bool))
    world.reset(np.array([0.1, 0.0]), np.array([0.3, 0.0]))
    assert held.claims.tolist() == [0]
    assert beside.claims.tolist() == []
    for t in np.array([[0.02], [0.4], [1.7]]):
        both = beside.torque(world.state, t) + servo.torque(world.state, t)
        np.testing.assert_allclose(held.torque(world.state, t), both, atol=1e-12)


def test_it_goes_smoothly_to_its_centre(pair: Body) -> None:
    does = Oscillate(joints={"one": {"amplitude": 5}}, frequency=1, centre={"one": 30}, damping=0,
                     stiffness=1)  # fmt: skip
    state, field = at_rest(pair), does.bind(pair, np.inf)
    field.begin(state, np.ones(1, dtype=bool))
    said = np.array([field.torque(state, np.array([t]))[0, 0] for t in until(2.0)])
    assert said[0] == 0.0
    assert np.abs(np.diff(said)).max() < 0.01
    assert np.rad2deg(said[500:].mean()) == pytest.approx(30, abs=0.1)


TASK = """
task: swing
tempo: 120
background:
  - name: sway
    primitive: oscillate
    joints: {one: {amplitude: 10}, two: {amplitude: 20, lag: 60}}
    beats_per_cycle: 2
    oscillator: OSCILLATOR
    feedback: 0.5
subtasks:
  - {name: wait, primitive: get-posture, joints: [two], posture: rest}
  - name: more
    primitive: oscillate
    joints: {two: {amplitude: 15}}
    frequency: 2
    beats: 4
"""


@pytest.mark.parametrize("oscillator", ["hopf", "matsuoka"])
def test_a_batch_does_what_each_would_do_alone(pair: Body, oscillator: str) -> None:
    task = bind_task(task_from_text(TASK.replace("OSCILLATOR", oscillator))[0], pair)
    starts = np.random.default_rng(0).normal(0, 0.3, (3, 2))
    together = run_task(task, n=3, start=starts)
    for recording, start in zip(together, starts, strict=True):
        (alone,) = run_task(task, start=start)
        np.testing.assert_array_equal(alone.qpos, recording.qpos)
        np.testing.assert_array_equal(alone.torque, recording.torque)


def test_beats_become_hertz_at_the_tempo_of_the_task(pair: Body) -> None:
    does = Oscillate(joints={"one": {"amplitude": 5}}, beats_per_cycle=2,
                     then=({"cycle": 3, "beats_per_cycle": 0.5},))  # fmt: skip
    paced = does.at_tempo(90)
    assert (paced.frequency, paced.beats_per_cycle) == (0.75, None)
    assert paced.then[0].frequency == 3.0
    with pytest.raises(PrimitiveError, match="needs a tempo"):
        does.bind(pair, np.inf)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"frequency": -1}, "greater than 0"),
        ({"frequency": 1, "beats_per_cycle": 1}, "either frequency or beats_per_cycle"),
        ({}, "either frequency or beats_per_cycle"),
        ({"frequency": 1, "joints": {}}, "at least 1"),
        ({"frequency": 1, "joints": {"one": {"amplitude": -3}}}, "greater than 0"),
        ({"frequency": 1, "joints": {"one": {}}}, "Field required"),
        ({"frequency": 1, "oscillator": "sine", "feedback": 1}, "hopf and matsuoka"),
        ({"frequency": 1, "oscillator": "hopf", "coupling": 1}, "less than 1"),
        ({"frequency": 1, "claims": False, "centre": "rest"}, "leave 'centre' out"),
        ({"frequency": 1, "then": [{"cycle": 2}]}, "either frequency or beats_per_cycle"),
        (
            {"frequency": 1, "then": [{"cycle": c, "frequency": 1} for c in (2, 1)]},
            "must rise",
        ),
    ],
)
def test_parameters_that_mean_nothing_are_refused(wrong: dict, said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Oscillate(**{"joints": {"one": {"amplitude": 5}}} | wrong)


@pytest.mark.parametrize(
    ("wrong", "error", "said"),
    [
        ({"joints": {"tow": {"amplitude": 5}}}, BodyError, "'tow'.*did you mean 'two'"),
        ({"joints": {"both": {"amplitude": 5}}}, PrimitiveError, "'both' is 2 joints"),
        ({"frequency": 60}, PrimitiveError, "60 Hz is too fast.*at most 50 Hz"),
        ({"centre": {"two": 5}}, PrimitiveError, "'two', which does not swing"),
        ({"joints": {"two": {"amplitude": 5}}, "centre": "half"}, PrimitiveError, "nothing about"),
        ({"frequency": 0.5}, PrimitiveError, "1 s are too short.*takes 2 s"),
    ],
)
def test_what_does_not_fit_the_body_is_refused(
    pair: Body, wrong: dict, error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said):
        Oscillate(**{"joints": {"one": {"amplitude": 5}}, "frequency": 1} | wrong).bind(pair, 1.0)


def test_an_error_says_where_it_stands_in_the_file(pair: Body) -> None:
    spec, document = task_from_text(
        TASK.replace("OSCILLATOR", "hopf").replace(
            "{two: {amplitude: 15}}", "{tow: {amplitude: 5}}"
        )
    )
    with pytest.raises(SpecError, match=r"15:14: more: unknown joint.*'tow'"):
        bind_task(spec, pair, document)

"""Conformance kit: what anyone's primitive must do, for use in a test.

    from primitives.testing import check_primitive

    def test_my_primitive():
        check_primitive(MyPrimitive(limb="right_arm"))

`check_primitive` makes a `Trial` and runs every check of `CHECKS` on it; each can also be called by
itself. A check that fails raises an AssertionError that says what was found and what to do.

A field that is `passive` promises that, once its set point has arrived and while the joints that it
does not claim stand still, it gives back no more energy than it was given (passivity; Willems 1972,
Dissipative dynamical systems, ARMA 45:321). Without knowing its energy this is checked twice:

* around a closed path of its joints it does no work: the integral of tau . dq is zero when the
  path is taken infinitely slowly, and not positive at speed;
* pushed away from rest it never gives the body energy: the integral of tau . dq from there, where
  its energy is least, is never positive.
"""

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from primitives.primitive import FloatArray, Primitive
from primitives.trial import Held, Trial
from sim import Body, World

LATE = 100.0  # time by which every set point has arrived [s]
REST_TORQUE = 0.05  # at the goal and at rest, as a share of what is asked for elsewhere
REST_TORQUE_LEAST = 0.05  # and what is nothing anyway [N m]
WORK = 2e-3  # error of an integral of work, as a share of the work done to and fro
LEAST_WORK = 1e-4  # [J]
GIVEN_BACK = 0.02  # more than a field took since a push, as a share of what it took
PARTS = ("claims", "unit", "begin", "torque", "error")


@dataclass(frozen=True)
class Conformance:
    """What the kit measured on the way; none of it is asserted."""

    kind: str
    seconds: float  # for one step of one simulation, called by itself
    seconds_in_batch: float  # for each simulation of a step of 256
    passive: bool

    def __str__(self) -> str:
        """One line."""
        promise = "passive" if self.passive else "makes no promise of passivity"
        return (
            f"{self.kind}: {1e6 * self.seconds:.1f} us a step, in a batch of 256"
            f" {1e6 * self.seconds_in_batch:.2f} us each; {promise}"
        )


# --- the checks ------------------------------------------------------------------------------


def check_parts(trial: Trial) -> None:
    """A field has its parts; its claims are joints of the body."""
    field = trial.bind()
    lacks = [part for part in PARTS if not hasattr(field, part)]
    _expect(not lacks, trial, f"its field lacks {', '.join(lacks)}: give it {', '.join(PARTS)} all")
    claims = field.claims
    whole = isinstance(claims, np.ndarray) and claims.ndim == 1 and claims.dtype.kind in "iu"
    _expect(
        whole and all(0 <= dof < trial.body.nv for dof in claims),
        trial,
        f"its claims are {claims!r}: return what body.joints(...) returns, or NO_JOINTS",
    )


def check_shapes(trial: Trial) -> None:
    """Torques are (n, nv), errors (n,), and no torque is on a joint that is not claimed."""
    n, nv = 3, trial.body.nv
    state = trial.state(trial.postures(n), trial.velocities(n))
    field = trial.begun(state)
    torque, error = field.torque(state, np.full(n, LATE)), field.error(state)
    for what, got, shape in (("torque", torque, (n, nv)), ("error", error, (n,))):
        found = getattr(got, "shape", None)
        numbers = found is not None and got.dtype.kind in "fiu"
        _expect(
            numbers and found == shape,
            trial,
            f"its {what} is {'of shape ' + str(found) if numbers else repr(got)[:60]}; return one"
            f" row for each of the n simulations of the state, here an array of numbers {shape}",
        )
    if len(field.claims):
        others = np.delete(torque, field.claims, axis=1)
        _expect(
            not others.any(),
            trial,
            "it makes torque on joints that it does not claim: claim them, or claim none if it"
            " is only to be added to what others do",
        )


def check_units(trial: Trial) -> None:
    """Whoever has a goal names the unit of its error; whoever has none returns NaN."""
    state = trial.state(trial.postures(3))
    field = trial.begun(state)
    error = np.asarray(field.error(state), dtype=float)
    _expect(
        isinstance(field.unit, str), trial, f"its unit is {field.unit!r}: 'rad', 'm' or '' for none"
    )
    if field.unit:
        _expect(
            bool(np.isfinite(error).all() and (error >= 0.0).all()),
            trial,
            f"its unit is {field.unit!r}, but its error is {error}: return a distance from the goal"
            " that is not negative, or say unit = '' if there is no goal",
        )
    else:
        _expect(
            bool(np.isnan(error).all()),
            trial,
            f"its error is {error}, but it names no unit: say unit = 'rad' or 'm', or return NaN if"
            " there is no goal",
        )


def check_finite(trial: Trial) -> None:
    """Torques and errors are finite wherever the joints can be, however fast, at any time."""
    n = 64
    rng = np.random.default_rng(trial.seed)
    low, high = (np.clip(limit, -np.pi, np.pi) for limit in trial.body.range)
    qpos = trial.postures(n)
    qpos[:, trial.body.qpos_of_dof] = rng.uniform(low, high, (n, trial.body.nv))
    away = trial.state(qpos, trial.velocities(n, spread=5.0))
    field = trial.begun(trial.state(qpos[::-1].copy()))
    for t in (0.0, 1e-6, 0.5 * trial.duration, trial.duration, LATE):
        with np.errstate(all="ignore"):  # what matters is what comes out
            torque = np.asarray(field.torque(away, np.full(n, t)))
        row, dof = np.unravel_index(int(np.argmin(np.isfinite(torque))), torque.shape)
        _expect(
            bool(np.isfinite(torque).all()),
            trial,
            f"it asks for {torque[row, dof]} N m at {trial.body.dof_name(int(dof))}, {t:g} s after"
            " it was switched on: look for a division by a distance or a duration that may be 0",
        )
    if field.unit:
        error = np.asarray(field.error(away))
        _expect(bool(np.isfinite(error).all()), trial, "its error is not finite in every posture")


def check_determinism(trial: Trial) -> None:
    """The same twice: no random numbers, no clock, nothing that a call leaves behind."""
    n = 4
    state = trial.state(trial.postures(n), trial.velocities(n))
    t = np.linspace(0.0, trial.duration, n)
    field = trial.begun(state)
    first = np.array(field.torque(state, t))
    _expect(
        np.array_equal(first, field.torque(state, t)),
        trial,
        "asked twice, it makes different torques: torque() must depend on the state, the time and"
        " what begin() remembered, and on nothing that an earlier call left behind",
    )
    _expect(
        np.array_equal(first, trial.begun(state).torque(state, t)),
        trial,
        "bound anew, it makes different torques: keep random numbers and clocks out of it, and keep"
        " what it remembers in the field, not in the class",
    )


def check_batch(trial: Trial) -> None:
    """Alone as in a batch, bit by bit; and begin() minds only the simulations it is told."""
    n = 5
    qpos, qvel = trial.postures(n), trial.velocities(n)
    t = np.array([0.0, 0.1, 0.5, 1.0, 5.0]) * trial.duration
    state = trial.state(qpos, qvel)
    together = np.array(trial.begun(state).torque(state, t))
    for k in range(n):
        one = trial.state(qpos[k : k + 1], qvel[k : k + 1])
        alone = np.asarray(trial.begun(one).torque(one, t[k : k + 1]))[0]
        _expect(
            np.array_equal(alone, together[k]),
            trial,
            f"alone it makes other torques than in a batch (up to"
            f" {np.abs(alone - together[k]).max():.2g} N m): let no row see another, and avoid sums"
            " and matrix products whose order depends on how many rows there are",
        )
    later = trial.state(trial.postures(n)[::-1].copy())
    field, some = trial.begun(state), np.arange(n) % 2 == 0
    before = np.array(field.torque(later, t))
    field.begin(later, some)
    _expect(
        np.array_equal(before[~some], np.asarray(field.torque(later, t))[~some]),
        trial,
        "begin() changed simulations that were not switched on: remember only rows of `who`",
    )


def check_goal(trial: Trial) -> None:
    """It comes to its goal when nothing is in its way, and asks for nothing once it is there."""
    if not trial.bind().unit:
        return
    qpos, field = trial.settled
    state = trial.state(qpos)
    error = float(np.max(field.error(state)))
    _expect(
        error <= trial.goal_error,
        trial,
        f"with nothing in its way it stays {error:.3g} {field.unit} from its goal (allowed:"
        f" {trial.goal_error:g}): error() must be 0 where the torque comes to rest; if what is"
        " asked for can not be reached, try a goal that can, or say goal_error=...",
    )
    t = np.full(state.n, LATE)
    asked = np.abs(trial.begun(trial.state(trial.postures(8))).torque(
        trial.state(trial.postures(8)[::-1].copy()), np.full(8, LATE)
    )).max()  # fmt: skip
    left = float(np.abs(field.torque(state, t)).max())
    allowed = max(REST_TORQUE * float(asked), REST_TORQUE_LEAST)
    _expect(
        left <= allowed,
        trial,
        f"at its goal and at rest it still asks for {left:.3g} N m (allowed: {allowed:.2g}): leave"
        " the weight to compensate-gravity, and let the torque vanish with the error",
    )


def check_passivity(trial: Trial) -> None:
    """What is `passive` gives back no more energy than it was given; see the module."""
    if not getattr(trial.bind(), "passive", False):
        return
    for speed in (0.0, 1.0, 5.0):
        work, to_and_fro = _work_around(trial, speed)
        done = np.abs(work) if speed == 0.0 else work
        k = int(np.argmax(done - WORK * to_and_fro))
        slowly = f"at {speed:g} rad/s" if speed else "infinitely slowly"
        _expect(
            bool(done[k] <= WORK * to_and_fro[k] + LEAST_WORK),
            trial,
            f"it is passive, but once around a closed path of its joints, {slowly}, it does"
            f" {done[k]:.3g} J of work: its spring is not the gradient of an energy, or its"
            " damping is negative; mend that, or do not say that it is passive",
        )
    given, taken = _work_after_a_push(trial)
    _expect(
        given <= GIVEN_BACK * taken + LEAST_WORK,
        trial,
        f"it is passive, but when it is pushed away from rest it gives the body {given:.3g} J (it"
        f" took {taken:.3g} J at most): its damping must not be negative, and its spring"
        " must not pull away from where it comes to rest",
    )


CHECKS: tuple[Callable[[Trial], None], ...] = (
    check_parts,
    check_shapes,
    check_units,
    check_finite,
    check_determinism,
    check_batch,
    check_goal,
    check_passivity,
)


def check_primitive(
    primitive: Primitive,
    body: Body | None = None,
    *,
    duration: float = 0.6,
    goal_error: float = 0.02,
    seed: int = 0,
) -> Conformance:
    """Run every check, and print how long a step takes.

    Args:
        primitive: what is tried.
        body: on which; default: Adonis.
        duration: time that it is given [s].
        goal_error: how near its goal it must come, in its own unit.
        seed: of the random states.

    Raises:
        AssertionError: saying what was found and what to do.
    """
    trial = Trial(primitive, body, duration=duration, goal_error=goal_error, seed=seed)
    for check in CHECKS:
        check(trial)
    passive = bool(getattr(trial.bind(), "passive", False))
    found = Conformance(primitive.kind, time_per_step(trial), time_per_step(trial, 256), passive)
    print(found)
    return found


def time_per_step(trial: Trial, n: int = 1) -> float:
    """Seconds that a step takes for each of n simulations, the best of a few rounds."""
    state = trial.state(trial.postures(n), trial.velocities(n))
    field, t = trial.begun(state), np.full(n, 0.5 * trial.duration)
    best = np.inf
    for _ in range(5):
        begun = perf_counter()
        for _ in range(20):
            field.torque(state, t)
        best = min(best, perf_counter() - begun)
    return best / (20 * n)


# --- inside ----------------------------------------------------------------------------------


def _expect(holds: bool, trial: Trial, message: str) -> None:
    if not holds:
        raise AssertionError(
            f"{trial.primitive.kind} ({type(trial.primitive).__name__}): {message}"
        )


def _work_around(trial: Trial, speed: float) -> tuple[FloatArray, FloatArray]:
    """Work of the field around closed paths (n,), and that done to and fro on the way [J]."""
    n, points = 12, 240
    body, columns = trial.body, trial.body.qpos_of_dof
    middle = trial.postures(n)
    world = World(body, n)
    world.reset(middle)
    field = trial.begun(world.state)
    free = trial.free(field)
    rng = np.random.default_rng(trial.seed + 2)
    sine, cosine = (0.25 * rng.normal(size=(n, body.nv)) * free for _ in range(2))
    work, to_and_fro = np.zeros(n), np.zeros(n)
    for angle in np.linspace(0.0, 2.0 * np.pi, points, endpoint=False):
        qpos = middle.copy()
        qpos[:, columns] += sine * np.sin(angle) + cosine * np.cos(angle)
        pace = sine * np.cos(angle) - cosine * np.sin(angle)  # [rad per rad of the path]
        world.reset(qpos, speed * pace)
        power = (np.asarray(field.torque(world.state, np.full(n, LATE))) * pace).sum(axis=1)
        work += power * 2.0 * np.pi / points
        to_and_fro += np.abs(power) * 2.0 * np.pi / points
    return work, to_and_fro


def _work_after_a_push(trial: Trial) -> tuple[float, float]:
    """Most energy that a field gave since a push from rest, and the most that it took [J]."""
    rest, field = trial.settled
    world = World(trial.body, len(rest))
    push = 0.5 * trial.velocities(len(rest)) * trial.free(field)
    world.reset(rest, push)
    held = Held(trial.body, trial.free(field), world.state)
    late, columns = np.full(len(rest), LATE), trial.body.qpos_of_dof
    before, torque = world.state.qpos[:, columns].copy(), np.array(field.torque(world.state, late))
    work, given, taken = np.zeros(len(rest)), 0.0, 0.0
    for _ in range(int(0.5 / trial.body.timestep)):
        world.step(held.torque(world.state) + torque)
        now, asked = world.state.qpos[:, columns].copy(), np.array(field.torque(world.state, late))
        work += (0.5 * (torque + asked) * (now - before)).sum(axis=1)
        before, torque = now, asked
        given, taken = max(given, float(work.max())), max(taken, -float(work.min()))
    return given, taken


__all__ = [
    "CHECKS",
    "Conformance",
    "Trial",
    "check_batch",
    "check_determinism",
    "check_finite",
    "check_goal",
    "check_parts",
    "check_passivity",
    "check_primitive",
    "check_shapes",
    "check_units",
    "time_per_step",
]

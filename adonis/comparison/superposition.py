"""Wanted movements as sums of force fields: does least squares scale from 2 joints to 20?

Mussa-Ivaldi (1997, "Nonlinear force fields: a distributed system of control primitives for
representing and learning movements", IEEE CIRA) adds up fields phi_i to a wanted movement,

    tau(t) = sum_i [a_i w(t) + sum_k b_ik v_k(t)] phi_i(theta),      a_i, b_ik >= 0,

with steps w and pulses v (eq 5 and 6 of Mataric, Zordan & Williamson 1999), by least squares
along the wanted path. That paper did so on two joints; the 1998 paper on Adonis left open
whether it scales to 20. Here the same code does it on a two-joint arm in the plane, on one arm
of Adonis (7 joints, the other 13 held by servos) and on all of Adonis.

The fields are wells (see `primitives.torque_field`) around postures drawn at random near the
path. With one pulse, as in eq 4, a path of many joints is too poor in time; so each field also
has pulses over shorter windows. The well of the start posture fades with 1 - w and damping is
constant, both outside the weights. Weight is carried apart, as everywhere in the project.
Nothing follows the path: the weights are functions of time alone.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from primitives import CompensateGravity, GetPosture
from primitives.primitive import BoolArray, Field, FloatArray, IntArray
from primitives.profiles import pulse, step
from sim import Body, Motion, State, World, adonis, planar_arm, site_paths, straight_motion

PULSES = 6  # for each field: one over the whole movement, five over a third of it
SPREAD = 1.2  # of the wells' centres about the path, in every joint [rad]
WIDTH = 1.0  # of the wells [rad]; narrower ones fit better, but push away from the path
EVERY = 5  # steps from one row of the least squares to the next
REST = 0.3  # for which the end of the movement is held [s]
COUNTS = (4, 8, 16, 32, 64, 128, 256)
SEEDS = (0, 1, 2)

_step, _pulse = (np.vectorize(f, otypes=[float]) for f in (step, pulse))


# --- fields and their weights ---------------------------------------------------------------


@dataclass(frozen=True)
class Choice:
    """Which fields there are to choose from."""

    fields: int  # how many
    coupled: bool = False  # whether the wells are Mussa-Ivaldi's or those of eq 3
    width: float = WIDTH  # of the wells [rad]
    pulses: int = PULSES  # of each
    seed: int = 0  # with which they are drawn


@dataclass(frozen=True)
class Wells:
    """Wells of m postures in j joints, of the same amplitude and width."""

    centres: FloatArray  # (m, j) [rad]
    amplitude: FloatArray  # A (j,) [N m/rad]
    width: FloatArray  # s (j,) [rad]
    coupled: bool = False  # whether the exponent sums over the joints (Mussa-Ivaldi's form)

    def torque(self, q: FloatArray) -> FloatArray:
        """Torques (m, T, j) [N m] of each well with weight 1 in postures (T, j) [rad]."""
        return self.pull(q - self.centres[:, None])

    def pull(self, e: FloatArray) -> FloatArray:
        """Torques (..., j) [N m] of a well at distances (..., j) [rad] from its centre: eq 3."""
        exponent = 0.5 * (e / self.width) ** 2
        if self.coupled:
            exponent = exponent.sum(axis=-1, keepdims=True)
        torque: FloatArray = -self.amplitude * e * np.exp(-exponent)
        return torque


def draw_wells(body: Body, motion: Motion, dofs: IntArray, choice: Choice) -> Wells:
    """Wells at random about the path of some joints, within their ranges.

    A larger set of the same seed holds the smaller one. The amplitudes are the stiffnesses of
    the servos. A coupled well of j joints is wider by sqrt(j), so that the spread of the
    centres spends no more of its depth than in one joint.
    """
    j = len(dofs)
    drawn = np.random.default_rng(choice.seed).random((choice.fields, 1 + j))
    moving = np.flatnonzero(motion.time <= motion.duration)
    on_path = motion.qpos[(drawn[:, 0] * len(moving)).astype(int)][:, dofs]
    low, high = (limit[dofs] for limit in body.range)
    centres = np.clip(on_path + SPREAD * (2.0 * drawn[:, 1:] - 1.0), low, high)
    width = np.full(j, choice.width * (np.sqrt(j) if choice.coupled else 1.0))
    return Wells(centres, _of_servos(body, dofs)[0], width, choice.coupled)


def time_courses(s: FloatArray, pulses: int = PULSES) -> FloatArray:
    """Step and pulses (1 + pulses, T) at shares s (T,) of the movement.

    The first pulse lasts for the whole movement; the others for 2 / pulses of it each, and one
    begins every 1 / pulses.
    """
    short = [_pulse((s - k / pulses) * pulses / 2.0) for k in range(pulses - 1)]
    return np.array([_step(s), _pulse(s), *short])


def linear_system(wells: Wells, courses: FloatArray, q: FloatArray) -> FloatArray:
    """The matrix (T j, c m) that makes torques along a path of weights.

    Args:
        wells: m of them in j joints.
        courses: how a weight of 1 goes on and off in time (c, T).
        q: the path (T, j) [rad].
    """
    parts = courses[:, None, :, None] * wells.torque(q)
    return parts.reshape(-1, q.size).T


@dataclass(frozen=True)
class Fit:
    """Weights, and how well they fit.

    A torque error counts as the angle by which it would shift the joint's servo, so that wrist
    and waist weigh alike: all figures are of torques over stiffnesses of servos.
    """

    weights: FloatArray  # (1 + pulses, m): of step and pulses
    residual: float  # RMS of the torque error over the RMS of the wanted torque tau*
    misfit: float  # the same over the RMS of what is asked of the wells; 1 without any
    seconds: float  # that the least squares took

    @property
    def used(self) -> int:
        """How many fields have a weight that is not zero."""
        return int(np.count_nonzero(self.weights.any(axis=0)))


def fit(body: Body, motion: Motion, dofs: IntArray, wells: Wells, *, pulses: int = PULSES) -> Fit:
    """Weights >= 0 with which wells come nearest to the torques of a motion.

    What is asked of them is tau*, the torque by inverse dynamics less the weight, and what
    the damping takes, and less what the well of the start gives.
    """
    rows = slice(None, None, EVERY)
    q, v, torque = (x[rows][:, dofs] for x in (motion.qpos, motion.qvel, motion.torque))
    courses = time_courses(motion.time[rows] / motion.duration, pulses)
    stiffness, damping = _of_servos(body, dofs)
    start = (1.0 - courses[0])[:, None] * wells.pull(q - q[0])
    asked = ((torque + damping * v - start) / stiffness).ravel()
    matrix = linear_system(wells, courses, q) / np.tile(stiffness, len(q))[:, None]
    began = time.perf_counter()
    weights, error = nnls(matrix, asked, maxiter=20 * matrix.shape[1])
    seconds = time.perf_counter() - began
    return Fit(
        weights=weights.reshape(1 + pulses, -1),
        residual=float(error / np.linalg.norm(torque / stiffness)),
        misfit=float(error / np.linalg.norm(asked)),
        seconds=seconds,
    )


class Superposition(Field):
    """Weighted wells as one field: see the module.

    Args:
        body: whose joints.
        dofs: which of them (j,).
        wells: the m fields.
        weights: (1 + pulses, m), of step and pulses.
        duration: of the movement [s].
        goal: posture (j,) at its end [rad], for `error`.
    """

    def __init__(
        self,
        body: Body,
        dofs: IntArray,
        wells: Wells,
        weights: FloatArray,
        duration: float,
        goal: FloatArray,
    ) -> None:
        self.claims, self.unit = dofs, "rad"
        self._places = body.qpos_of_dof[dofs]
        self._wells, self._weights = wells, weights
        self._duration, self._goal = duration, goal
        self._damping = _of_servos(body, dofs)[1]
        self._nv, self._start = body.nv, np.zeros((0, len(dofs)))

    def begin(self, state: State, who: BoolArray) -> None:
        """See `Field.begin`: the start posture is the one they are in."""
        if len(self._start) != state.n:
            self._start = np.zeros((state.n, len(self.claims)))
        self._start[who] = state.qpos[who][:, self._places]

    def torque(self, state: State, t: FloatArray) -> FloatArray:
        """See `Field.torque`."""
        q = state.qpos[:, self._places]
        courses = time_courses(t / self._duration, len(self._weights) - 1)
        strength = self._weights.T @ courses  # (m, n)
        made = np.einsum("mn,mnj->nj", strength, self._wells.torque(q))
        made += (1.0 - courses[0])[:, None] * self._wells.pull(q - self._start)
        torque = np.zeros((state.n, self._nv))
        torque[:, self.claims] = made - self._damping * state.qvel[:, self.claims]
        return torque

    def error(self, state: State) -> FloatArray:
        """See `Field.error`: the angle of the joint that is farthest from its goal."""
        farthest: FloatArray = np.abs(state.qpos[:, self._places] - self._goal).max(axis=1)
        return farthest


def _of_servos(body: Body, dofs: IntArray) -> tuple[FloatArray, FloatArray]:
    """Stiffness [N m/rad] and damping [N m s/rad] of the joints' servos, (j,) each."""
    servos = [body.servo(int(dof)) for dof in dofs]
    return np.array([s.stiffness for s in servos]), np.array([s.damping for s in servos])


# --- the three systems ----------------------------------------------------------------------


@dataclass(frozen=True)
class System:
    """A body, the joints that fields move, and how the hands are to go."""

    name: str
    body: Body
    joints: str
    moves: dict[str, tuple[float, float, float]]  # site -> displacement [m]
    duration: float  # [s]

    @property
    def dofs(self) -> IntArray:
        """The joints that fields move (j,)."""
        return self.body.joints(self.joints)

    def motion(self) -> Motion:
        """The movement that is wanted."""
        moves = {site: np.array(move) for site, move in self.moves.items()}
        return straight_motion(self.body, moves, self.dofs, self.duration, rest=REST)


def systems() -> tuple[System, ...]:
    """The arm in the plane, Adonis' right arm, and all of Adonis."""
    body = adonis()
    right, left = (0.30, 0.10, 0.30), (0.25, 0.05, 0.15)
    return (
        System("planar arm", planar_arm(), "arm", {"hand": (-0.25, 0.0, 0.0)}, 0.8),
        System("right arm", body, "right_arm", {"right_palm": right}, 1.0),
        System("Adonis", body, "all", {"right_palm": right, "left_palm": left}, 1.0),
    )


@dataclass(frozen=True)
class Run:
    """What the hands did."""

    paths: FloatArray  # (hands, T, 3) [m]
    lines: FloatArray  # (hands, 2, 3) start and end that were wanted [m]
    peak: float  # largest torque of any motor, as a share of its limit

    @property
    def deviation(self) -> float:
        """Largest distance of any hand from its line between start and end [m]."""
        return max(_off_line(p, *line) for p, line in zip(self.paths, self.lines, strict=True))

    @property
    def end_error(self) -> float:
        """Largest distance of any hand from the end of its line, when all is over [m]."""
        return float(np.linalg.norm(self.paths[:, -1] - self.lines[:, 1], axis=-1).max())


def simulate(system: System, motion: Motion, field: Field) -> Run:
    """Let a field move a system in closed loop with the whole physics."""
    body = system.body
    world, t = World(body), np.zeros(1)
    applied = world.torque
    fields: list[Field] = [field, CompensateGravity().bind(body, np.inf)]
    held = [body.dof_name(d) for d in range(body.nv) if d not in set(field.claims)]
    if held:
        home = np.rad2deg(body.home[body.qpos_of_dof[body.joints(held)]])
        posture = dict(zip(held, map(float, home), strict=True))
        hold = GetPosture(joints=tuple(held), posture=posture, controller="pd-servo")
        fields.append(hold.bind(body, system.duration))
    for one in fields:
        one.begin(world.state, np.ones(1, dtype=bool))
    postures, peak = [], 0.0
    for now in motion.time:
        postures.append(world.state.qpos[0].copy())
        t[0] = now
        world.step(np.sum([one.torque(world.state, t) for one in fields], axis=0))
        peak = max(peak, float((np.abs(applied[0]) / body.torque_limit).max()))
    world.check()
    paths = site_paths(body, tuple(system.moves), np.array(postures))
    return Run(paths, motion.line, peak)


def _off_line(path: FloatArray, start: FloatArray, end: FloatArray) -> float:
    """Largest distance of a path (T, 3) from the segment between two points [m]."""
    way = end - start
    along = np.clip((path - start) @ way / (way @ way), 0.0, 1.0)
    return float(np.linalg.norm(path - start - along[:, None] * way, axis=1).max())


# --- the study ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Row:
    """One set of fields on one system."""

    body: str
    dof: int  # joints that fields move
    choice: Choice
    used: int  # how many fields got a weight
    residual: float  # see `Fit`
    misfit: float  # see `Fit`
    seconds: float  # that the least squares took
    deviation: float  # see `Run` [m]
    end_error: float  # see `Run` [m]
    peak: float  # see `Run`

    @property
    def fields(self) -> int:
        """How many fields there were to choose from."""
        return self.choice.fields


def superpose(system: System, choice: Choice, motion: Motion | None = None) -> tuple[Row, Run]:
    """Draw fields, find their weights, and let them move the system.

    Args:
        system: what moves, and where to.
        choice: of the fields.
        motion: what is wanted, if it is known already.
    """
    motion = motion or system.motion()
    body, dofs = system.body, system.dofs
    wells = draw_wells(body, motion, dofs, choice)
    found = fit(body, motion, dofs, wells, pulses=choice.pulses)
    goal = motion.qpos[-1][dofs]
    field = Superposition(body, dofs, wells, found.weights, motion.duration, goal)
    run = simulate(system, motion, field)
    row = Row(
        *(system.name, len(dofs), choice, found.used),
        *(found.residual, found.misfit, found.seconds),
        *(run.deviation, run.end_error, run.peak),
    )
    return row, run


def study(
    *,
    counts: Sequence[int] = COUNTS,
    seeds: Sequence[int] = SEEDS,
    progress: Callable[[float, str], None] | None = None,
) -> list[Row]:
    """How far the three systems come with more and more fields.

    Args:
        counts: numbers of fields.
        seeds: for each of which the fields are drawn.
        progress: told the share that is done and what is next.

    Returns:
        A row for each system, form of the wells (eq 3 and coupled), count and seed; and for
        the largest count also with one pulse alone, as in eq 4, and with wells half as wide.
    """
    jobs = [Choice(n, form, seed=k) for form in (False, True) for n in counts for k in seeds]
    jobs += [Choice(max(counts), pulses=1, seed=k) for k in seeds]
    jobs += [Choice(max(counts), width=0.5 * WIDTH, seed=k) for k in seeds]
    rows: list[Row] = []
    every = systems()
    for system in every:
        motion = system.motion()
        for choice in jobs:
            if progress is not None:
                share = len(rows) / (len(every) * len(jobs))
                progress(share, f"{system.name}, {choice.fields} fields")
            rows.append(superpose(system, choice, motion)[0])
    return rows


def star(choice: Choice = Choice(16), *, length: float = 0.18, ways: int = 8) -> list[Run]:
    """The arm in the plane, from one place `length` [m] in several directions."""
    system = systems()[0]
    runs = []
    for angle in 2.0 * np.pi * np.arange(ways) / ways:
        move = (length * float(np.cos(angle)), length * float(np.sin(angle)), 0.0)
        runs.append(superpose(replace(system, moves={"hand": move}), choice)[1])
    return runs


def as_table(rows: Sequence[Row]) -> tuple[list[str], list[list[str]]]:
    """Heads and cells of the study: for each system and count the median over the seeds."""
    heads = ["system", "joints", "fields", "used", "torque error", "off the line [mm]"]
    heads += ["off at the end [mm]", "peak torque", "least squares [s]"]
    plain = [r for r in rows if r.choice == Choice(r.choice.fields, seed=r.choice.seed)]
    cells = []
    for key in dict.fromkeys((r.body, r.dof, r.choice.fields) for r in plain):
        same = [r for r in plain if (r.body, r.dof, r.choice.fields) == key]

        def middle(name: str, same: Sequence[Row] = same) -> float:
            return float(np.median([getattr(r, name) for r in same]))

        cells.append(
            [
                *(str(k) for k in key),
                f"{middle('used'):.0f}",
                f"{middle('residual'):.2f}",
                f"{1000 * middle('deviation'):.1f}",
                f"{1000 * middle('end_error'):.1f}",
                f"{middle('peak'):.2f}",
                f"{middle('seconds'):.3f}",
            ]
        )
    return heads, cells

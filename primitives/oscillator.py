"""Rhythms: oscillators that move the equilibrium of joint springs.

    tau = k (x + y - theta) + k_d (x' + y' - theta')

is eq 1 of Mataric et al. (1999) about a centre x, with y the output of the joint's oscillator
(`hand_rhythm` swings a hand in the same way):

    sine      y = A sin(2 pi f t + phase - lag)
    Hopf      y = A Im z,   z' = (alpha (1 - |z|^2) + i omega) z - i omega h g / A
    Matsuoka  y = [x1]+ - [x2]+,
              t1 x1' = c - x1 - beta v1 - gamma [x2]+ - [h g]+,   t2 v1' = -v1 + [x1]+
              and x2, v2 the mirror of it with [-h g]+   (Matsuoka 1985; Williamson 1998)

with t2 = 2 t1, beta = gamma = 2.5. g is how far the joint is from its centre and h the gain of
that feedback, which holds back whatever pushes the joint further: the oscillator then falls in
with the limb. The tonic input c, an angle, sets the amplitude of y and nothing else.

Oscillators of several joints keep their lags as coupled phases do (Kuramoto 1975): each hurries
or waits, f_k = f (1 + kappa Im(m / u_k)), where u_k is its phase as a unit vector, turned by its
lag, and m the mean of all u_k. Their own shapes and amplitudes stay as they are.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import compiled
from primitives.mechanics import Row
from primitives.profiles import minimum_jerk, minimum_jerk_rate

FloatArray = NDArray[np.float64]
States = tuple[float, float, float, float]

SINE, HOPF, MATSUOKA = range(3)
# A rhythm is a row of numbers: these, then its stretches of time, then its joints.
KIND, HOLDS, FEEDBACK, COUPLING, JOINTS, STRETCHES, EASE_IN, EASE_OUT = range(8)
PACE, SWING, AHEAD, ASIDE, TURN_COS, TURN_SIN = range(8, 14)  # of Matsuoka's: see `LimitCycle`
HEAD = 14
BEGINS, UNTIL, FREQUENCY, STRETCH = range(4)  # [s], cycles until then, [Hz]; and how many
# SI units; CENTRE may be NaN.
DOF, STIFFNESS, DAMPING, CENTRE, AMPLITUDE, LAG, LAG_COS, LAG_SIN, FIRST = range(9)
STATES = 4
JOINT = FIRST + STATES
# Remembered per joint: where it was, how far it is from its centre, and its oscillator; before
# all of them the time.
START, OFF, STATE = range(3)
REMEMBERS = STATE + STATES

BETA = GAMMA = 2.5
RETURN = 0.5  # alpha of the Hopf oscillator, as a share of omega
LONGEST = 1.0 / 100.0  # of the steps in which oscillators are integrated [cycles]


@compiled
def begin_rhythm(x: Row, own: FloatArray, memory: FloatArray) -> None:
    """Remember where the joints are, and put their oscillators where they begin."""
    begin_oscillators(own, memory)
    for k in range(int(own[JOINTS])):
        memory[1 + REMEMBERS * k + START] = x.qpos[x.dofs[int(own[joint_row(own, k) + DOF])].qpos]


@compiled
def begin_oscillators(own: FloatArray, memory: FloatArray) -> None:
    """Put the oscillators where they begin."""
    memory[0] = 0.0
    for k in range(int(own[JOINTS])):
        row, at = joint_row(own, k), 1 + REMEMBERS * k
        memory[at + START] = memory[at + OFF] = 0.0
        for s in range(STATES):
            memory[at + STATE + s] = own[row + FIRST + s]


@compiled
def rhythm(
    x: Row, own: FloatArray, memory: FloatArray, t: float, duration: float, out: FloatArray
) -> None:
    """out += the torques [N m] of springs whose equilibrium swings.

    Args:
        x: the simulation.
        own: the numbers of the rhythm.
        memory: what `begin_rhythm` remembered; the oscillators go on to the time t, if it is
            later than when they were last asked.
        t: since it began [s].
        duration: when it is to be at rest again [s]; may be infinite.
        out: (nv,) [N m]
    """
    moved, speed = arrival(own, t)
    for k in range(int(own[JOINTS])):
        row, at = joint_row(own, k), 1 + REMEMBERS * k
        angle = x.qpos[x.dofs[int(own[row + DOF])].qpos]
        memory[at + OFF] = angle - memory[at + START] - moved * way_of(own, row, memory[at + START])
    go_on(own, memory, t)
    grown, growth = envelope(own, t, duration)
    cycles, frequency = cycles_at(own, t), frequency_at(own, t)
    for k in range(int(own[JOINTS])):
        row, at = joint_row(own, k), 1 + REMEMBERS * k
        j = int(own[row + DOF])
        y, rate = output(own, memory, k, cycles, frequency)
        pull, lead = grown * y, grown * rate + growth * y
        if own[HOLDS] != 0.0:
            pull -= memory[at + OFF]
            lead += speed * way_of(own, row, memory[at + START]) - x.qvel[j]
        out[j] += own[row + STIFFNESS] * pull + own[row + DAMPING] * lead


@compiled
def output(
    own: FloatArray, memory: FloatArray, k: int, cycles: float, frequency: float
) -> tuple[float, float]:
    """What the k-th oscillator says, fully grown, and its rate [1/s]."""
    row, at = joint_row(own, k), 1 + REMEMBERS * k
    turning = own[row + AMPLITUDE] * 2.0 * np.pi * frequency
    if own[KIND] == SINE:
        phase = 2.0 * np.pi * cycles - own[row + LAG]
        return own[row + AMPLITUDE] * np.sin(phase), turning * np.cos(phase)
    if own[KIND] == HOPF:
        return own[row + AMPLITUDE] * memory[at + STATE + 1], turning * memory[at + STATE]
    s, drive = states(memory, at), own[row + AMPLITUDE] / own[SWING]
    d = _matsuoka(s, drive, own[FEEDBACK] * memory[at + OFF], own[PACE] / frequency)
    rate = (d[0] if s[0] > 0.0 else 0.0) - (d[2] if s[2] > 0.0 else 0.0)
    return max(s[0], 0.0) - max(s[2], 0.0), rate


@compiled
def joint_row(own: FloatArray, k: int) -> int:
    """Where the numbers of the k-th joint begin."""
    return HEAD + STRETCH * int(own[STRETCHES]) + JOINT * k


@compiled
def way_of(own: FloatArray, row: int, start: float) -> float:
    """From where a joint was to its centre [rad]; none if that is the same."""
    way: float = 0.0 if np.isnan(own[row + CENTRE]) else own[row + CENTRE] - start
    return way


@compiled
def states(memory: FloatArray, at: int) -> States:
    """The oscillator of the joint whose memory begins at `at`."""
    return memory[at + 2], memory[at + 3], memory[at + 4], memory[at + 5]


@compiled
def stretch_at(own: FloatArray, t: float) -> int:
    """Where the numbers of the stretch of one frequency begin that is on at time t."""
    at = HEAD
    for s in range(1, int(own[STRETCHES])):
        if t >= own[HEAD + STRETCH * s + BEGINS]:
            at = HEAD + STRETCH * s
    return at


@compiled
def cycles_at(own: FloatArray, t: float) -> float:
    """How many cycles have passed at time t: continuous, whatever the frequency does."""
    at = stretch_at(own, t)
    cycles: float = own[at + UNTIL] + own[at + FREQUENCY] * (t - own[at + BEGINS])
    return cycles


@compiled
def frequency_at(own: FloatArray, t: float) -> float:
    """The frequency at time t [Hz]."""
    frequency: float = own[stretch_at(own, t) + FREQUENCY]
    return frequency


@compiled
def arrival(own: FloatArray, t: float) -> tuple[float, float]:
    """Share of the way to the centre that is done at time t, and its rate [1/s]."""
    if own[EASE_IN] <= 0.0:
        return 1.0, 0.0
    s = t / own[EASE_IN]
    return minimum_jerk(s), minimum_jerk_rate(s) / own[EASE_IN]


@compiled
def envelope(own: FloatArray, t: float, duration: float) -> tuple[float, float]:
    """Share of its amplitude to which a swing has grown at time t, and its rate [1/s]."""
    if t >= duration:
        return 0.0, 0.0
    grown, growth = arrival(own, t)
    if own[EASE_OUT] > 0.0:
        s = 1.0 - (duration - t) / own[EASE_OUT]
        left = 1.0 - minimum_jerk(s)
        growth = growth * left - grown * minimum_jerk_rate(s) / own[EASE_OUT]
        grown *= left
    return grown, growth


@compiled
def go_on(own: FloatArray, memory: FloatArray, t: float) -> None:
    """Integrate the oscillators to time t, if it is later than when they were last asked.

    What they listen to, memory[at + OFF], counts as what it is now.
    """
    if t <= memory[0]:
        return
    cycles = cycles_at(own, t) - cycles_at(own, memory[0])
    memory[0] = t
    if own[KIND] == SINE:
        return
    steps, joints = int(cycles / LONGEST) + 1, int(own[JOINTS])
    turn, coupled = cycles / steps, joints > 1 and own[COUPLING] > 0.0
    for _step in range(steps):
        mean_cos = mean_sin = 0.0
        if coupled:
            for k in range(joints):
                c, s = phase_of(own, k, memory)
                mean_cos += c / joints
                mean_sin += s / joints
        for k in range(joints):
            row, at = joint_row(own, k), 1 + REMEMBERS * k
            push, own_turn = own[FEEDBACK] * memory[at + OFF], turn
            if coupled:
                c, s = phase_of(own, k, memory)
                own_turn *= 1.0 + own[COUPLING] * (mean_sin * c - mean_cos * s)
            if own[KIND] == HOPF:
                hopf_step(memory, at + STATE, push / own[row + AMPLITUDE], own_turn)
            else:
                drive = own[row + AMPLITUDE] / own[SWING]
                matsuoka_step(memory, at, drive, push, own_turn / own[PACE])


@compiled
def phase_of(own: FloatArray, k: int, memory: FloatArray) -> tuple[float, float]:
    """Cosine and sine of the k-th oscillator's phase, its lag taken out."""
    row, at = joint_row(own, k), 1 + REMEMBERS * k
    s = states(memory, at)
    if own[KIND] == HOPF:
        cosine, sine = s[0], s[1]
    else:  # the plane of x1 - x2 and v1 - v2, stretched until the cycle is a circle
        drive = own[row + AMPLITUDE] / own[SWING]
        sine = (s[0] - s[2]) / (drive * own[AHEAD])
        aside = (s[1] - s[3]) / (drive * own[ASIDE])
        cosine = (sine * own[TURN_COS] - aside) / own[TURN_SIN]
    length = max(np.sqrt(cosine * cosine + sine * sine), 1e-12)
    c, d = own[row + LAG_COS] / length, own[row + LAG_SIN] / length
    return cosine * c - sine * d, sine * c + cosine * d


@compiled
def hopf_step(memory: FloatArray, at: int, push: float, turn: float) -> None:
    """Turn by a share of a cycle, be pushed, and return towards the circle: each exactly."""
    angle = 2.0 * np.pi * turn
    c, s = np.cos(angle), np.sin(angle)
    real = memory[at] * c - memory[at + 1] * s
    imaginary = memory[at] * s + memory[at + 1] * c - angle * push
    squared = real * real + imaginary * imaginary
    left = np.exp(-2.0 * RETURN * angle)
    scale = 1.0 / np.sqrt(squared + (1.0 - squared) * left)
    memory[at], memory[at + 1] = scale * real, scale * imaginary


def matsuoka(s: States, drive: float, push: float, t1: float) -> States:
    """Rates of the two neurons (x1, v1, x2, v2): c = drive, h g = push, in units of t1."""
    first, second = max(s[0], 0.0), max(s[2], 0.0)
    return (
        (drive - s[0] - BETA * s[1] - GAMMA * second - max(push, 0.0)) / t1,
        (first - s[1]) / (2.0 * t1),
        (drive - s[2] - BETA * s[3] - GAMMA * first - max(-push, 0.0)) / t1,
        (second - s[3]) / (2.0 * t1),
    )


_matsuoka = compiled(matsuoka)


@compiled
def moved_by(s: States, h: float, d: States) -> States:
    """s + h d."""
    return s[0] + h * d[0], s[1] + h * d[1], s[2] + h * d[2], s[3] + h * d[3]


@compiled
def matsuoka_step(memory: FloatArray, at: int, drive: float, push: float, h: float) -> None:
    """One step of h t1 by the classical method of Runge and Kutta."""
    s = states(memory, at)
    a = _matsuoka(s, drive, push, 1.0)
    b = _matsuoka(moved_by(s, 0.5 * h, a), drive, push, 1.0)
    c = _matsuoka(moved_by(s, 0.5 * h, b), drive, push, 1.0)
    d = _matsuoka(moved_by(s, h, c), drive, push, 1.0)
    for i, (p, q, r, v) in enumerate(zip(a, b, c, d)):  # noqa: B905
        memory[at + STATE + i] += h / 6.0 * (p + 2.0 * q + 2.0 * r + v)

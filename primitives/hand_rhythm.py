"""Rhythms of a hand: oscillators that move the equilibrium of the spring that pulls a palm.

    F = K (x + s - p) + B (x' + s' - p'),   s = sum_k y_k n_k

is eq 7 of Mataric et al. (1999) about a centre x, p being the palm, n_k directions in the frame
of the link that carries the arm, and y_k [m] the outputs of oscillators as in `oscillator`. What
they listen to is how far the palm is from the centre along n_k.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Record, Records, compiled
from primitives.impedance import REMEMBERED, begin_reach, palm_position, pull_hand, push_palm
from primitives.mechanics import (
    Row,
    Vector,
    add,
    cross,
    dot,
    point_velocity,
    rotate,
    scale,
    spin,
    subtract,
    to_world,
    vector,
)
from primitives.oscillator import (
    EASE_IN,
    HOLDS,
    JOINTS,
    OFF,
    REMEMBERS,
    begin_oscillators,
    cycles_at,
    envelope,
    frequency_at,
    go_on,
    joint_row,
    output,
)
from primitives.pursuit import catch_up, pull_to

FloatArray = NDArray[np.float64]


@compiled
def begin_hand_rhythm(x: Row, r: Record, own: FloatArray, memory: FloatArray) -> None:
    """Remember where the palm is, and put the oscillators where they begin."""
    begin_reach(x, r, memory)
    begin_oscillators(own, memory[REMEMBERED:])


@compiled
def direction(x: Row, r: Record, own: FloatArray, k: int) -> Vector:
    """The k-th direction in the world; they stand behind the numbers of the oscillators."""
    at = joint_row(own, int(own[JOINTS])) + 3 * k
    return rotate(x, r.root, (own[at], own[at + 1], own[at + 2]))


@compiled
def swing_hand(
    x: Row,
    r: Record,
    points: Records,
    own: FloatArray,
    placed: int,
    memory: FloatArray,
    t: float,
    duration: float,
    out: FloatArray,
) -> None:
    """out += the torques [N m] of a spring on the palm whose equilibrium swings.

    Args:
        x: the simulation.
        r: a row of REACH.
        points: rows of POINT; r.points is the centre, if it has one.
        own: the numbers of the rhythm, and the directions behind them.
        placed: whether it has a centre of its own; else that is where the palm was.
        memory: what `begin_hand_rhythm` remembered.
        t: since it began [s].
        duration: when it is to be at rest again [s]; may be infinite.
        out: (nv,) [N m]
    """
    link, place = r.root, (memory[0], memory[1], memory[2])
    if placed:
        link, place = points[r.points].link, vector(points[r.points].point)
    centre = to_world(x, link, place)
    velocity = point_velocity(x, link, centre)
    wanted, speed = catch_up(x, r, centre, velocity, memory, t, own[EASE_IN])
    rhythm, off = memory[REMEMBERED:], subtract(palm_position(x, r), wanted)
    for k in range(int(own[JOINTS])):
        rhythm[1 + REMEMBERS * k + OFF] = dot(off, direction(x, r, own, k))
    go_on(own, rhythm, t)
    grown, growth = envelope(own, t, duration)
    cycles, frequency = cycles_at(own, t), frequency_at(own, t)
    swing, rate = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(int(own[JOINTS])):
        y, change = output(own, rhythm, k, cycles, frequency)
        n = direction(x, r, own, k)
        swing = add(swing, scale(grown * y, n))
        rate = add(rate, scale(grown * change + growth * y, n))
    rate = add(rate, cross(spin(x, r.root), swing))
    if own[HOLDS] == 0.0:
        force = add(scale(r.stiffness, swing), scale(r.damping, rate))
        push_palm(x, r, (0.0, 0.0, 0.0), force, out)
        return
    share = t / own[EASE_IN] if own[EASE_IN] > 0.0 else 1.0
    pull_hand(x, r, memory, share, pull_to(x, r, add(wanted, swing), add(speed, rate)), out)

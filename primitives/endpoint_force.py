"""Controller endpoint-force: a force on the hand, and nothing that holds the rest of the arm.

    F = K (x_d - x) + B (x_d' - x') + c (x' - x_d') |x - x_goal|
    tau = J_h^T F - b theta'

The first two terms are eq 7 applied straight to the hand, the third is eq 10 (Mataric et al.
1999, section 7); c < 0 takes energy out, the more the farther the hand is from its goal.
Since only the hand is held, damping b in every joint of the arm has to do the rest: the paper
built this controller and set it aside.
"""

import numpy as np
from numpy.typing import NDArray

from primitives.compiled import Record, Records, compiled
from primitives.impedance import goal_place, palm_force, palm_position, push_palm
from primitives.mechanics import Row, add, dot, point_velocity, scale, subtract

FloatArray = NDArray[np.float64]


@compiled
def endpoint_force(
    x: Row,
    r: Record,
    points: Records,
    memory: FloatArray,
    weight: FloatArray,
    rate: FloatArray,
    out: FloatArray,
) -> None:
    """out += the torques [N m] of a force on the palm and of damping in the arm's joints.

    Args:
        x: the simulation.
        r: a row of REACH.
        points: rows of POINT: this reach's via points and goal begin at r.points.
        memory: what `begin_reach` remembered (REMEMBERED,).
        weight: of start, via points and goal (1 + points,).
        rate: derivative of the weights [1/s].
        out: (nv,) [N m]
    """
    force, speed = palm_force(x, r, points, memory, weight, rate)
    palm = palm_position(x, r)
    p = points[r.points + weight.shape[0] - 2]
    gap = subtract(palm, goal_place(x, r, p, memory))
    slip = subtract(point_velocity(x, r.hand, palm), speed)
    force = add(force, scale(r.approach * np.sqrt(dot(gap, gap)), slip))
    push_palm(x, r, (0.0, 0.0, 0.0), force, out)
    base = x.links[r.root].last_dof
    j = x.links[r.hand].last_dof
    while j != base:
        out[j] -= r.joint_damping * x.qvel[j]
        j = x.dofs[j].parent

"""What a controller may see: live views of the simulations, one row each."""

from dataclasses import dataclass, fields
from typing import Any, Self

import mujoco
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class State:
    """The state of n simulations of one body.

    The arrays are views: they show the present whenever they are read, and cannot be
    written. Positions are in world coordinates [m], angles in [rad].
    """

    time: FloatArray  # (n,) [s]
    qpos: FloatArray  # (n, nq)
    qvel: FloatArray  # (n, nv)
    xpos: FloatArray  # (n, nbody, 3) origins of the links
    xmat: FloatArray  # (n, nbody, 9) rotation matrices of the links, row by row
    cdof: FloatArray  # (n, nv, 6) motion axes, angular then linear, about subtree_com[root]
    cvel: FloatArray  # (n, nbody, 6) velocities of the links, likewise
    subtree_com: FloatArray  # (n, nbody, 3) centre of mass of each link and all it carries
    qfrc_bias: FloatArray  # (n, nv) gravity and Coriolis torques [N m]
    M: FloatArray | None = None  # (n, nM) joint-space inertia, packed; see `joint_inertia`

    @property
    def n(self) -> int:
        """Number of simulations."""
        return len(self.time)

    def of_one(self, simulation: int) -> Self:
        """The state of one of the simulations, as n = 1."""
        own = slice(simulation, simulation + 1)
        arrays: dict[str, Any] = {field.name: getattr(self, field.name) for field in fields(self)}
        rows: dict[str, Any] = {k: None if a is None else a[own] for k, a in arrays.items()}
        return type(self)(**rows)

    @classmethod
    def of(cls, data: mujoco.MjData) -> Self:
        """The state of one plain `MjData`, as n = 1.

        Make it anew at every step, after `mj_step1` or `mj_forward`, which bring positions
        and axes up to date: in a loop of one's own, `mj_step1`, then set `data.ctrl`, then
        `mj_step2`.
        """
        return cls(
            time=read_only(np.array([data.time])),
            qpos=read_only(data.qpos[None]),
            qvel=read_only(data.qvel[None]),
            xpos=read_only(data.xpos[None]),
            xmat=read_only(data.xmat[None]),
            cdof=read_only(data.cdof[None]),
            cvel=read_only(data.cvel[None]),
            subtree_com=read_only(data.subtree_com[None]),
            qfrc_bias=read_only(data.qfrc_bias[None]),
            M=read_only(data.M[None]),
        )


def read_only(view: FloatArray) -> FloatArray:
    """Forbid writing through a view; whoever made it keeps the array itself.

    Every `State` is made of such views, since arrays that can be written are of another type
    to compiled code, which would be compiled anew for them.
    """
    view.setflags(write=False)
    return view

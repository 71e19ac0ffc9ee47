"""What a controller may see: live views of the simulations, one row each."""

from dataclasses import dataclass, fields
from typing import Self

import mujoco
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class State:
    """The state of n simulations of one body.

    The arrays are views: they show the present whenever they are read, and are not to be
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

    @property
    def n(self) -> int:
        """Number of simulations."""
        return len(self.time)

    def of_one(self, simulation: int) -> Self:
        """The state of one of the simulations, as n = 1."""
        own = slice(simulation, simulation + 1)
        return type(self)(*(getattr(self, field.name)[own] for field in fields(self)))

    @classmethod
    def of(cls, data: mujoco.MjData) -> Self:
        """The state of one plain `MjData`, as n = 1.

        Make it anew at every step, after `mj_step1` or `mj_forward`, which bring positions
        and axes up to date: in a loop of one's own, `mj_step1`, then set `data.ctrl`, then
        `mj_step2`.
        """
        return cls(
            time=np.array([data.time]),
            qpos=data.qpos[None],
            qvel=data.qvel[None],
            xpos=data.xpos[None],
            xmat=data.xmat[None],
            cdof=data.cdof[None],
            cvel=data.cvel[None],
            subtree_com=data.subtree_com[None],
            qfrc_bias=data.qfrc_bias[None],
        )

"""What a link weighs and how that weight is spread: the constants of the equations of motion."""

from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Inertias:
    """Of every link and every degree of freedom of a body."""

    parent: NDArray[np.int32]  # (nbody,) the link that carries each link
    mass: FloatArray  # (nbody,) [kg]
    centre: FloatArray  # (nbody, 3) of mass, in the frame of the link [m]
    inertia: FloatArray  # (nbody, 3, 3) about that centre, in the frame of the link [kg m^2]
    armature: FloatArray  # (nv,) of the motors [kg m^2]
    damping: FloatArray  # (nv,) [N m s/rad]
    reflected: FloatArray  # (nv,) what each motor moves in the home posture [kg m^2]


def inertias(body: Body) -> Inertias:
    """The inertias of a body, out of its model."""
    model = body.model
    turned = np.empty((model.nbody, 9))
    for link in range(model.nbody):
        mujoco.mju_quat2Mat(turned[link], model.body_iquat[link])
    axes = turned.reshape(-1, 3, 3)
    return Inertias(
        parent=model.body_parentid.astype(np.int32),
        mass=model.body_mass.copy(),
        centre=model.body_ipos.copy(),
        inertia=np.einsum("bij,bj,bkj->bik", axes, model.body_inertia, axes),
        armature=model.dof_armature.copy(),
        damping=np.array(model.dof_damping, dtype=float).reshape(model.nv, -1)[:, 0].copy(),
        reflected=np.diag(mass_matrix(body, body.home)).copy(),
    )


def mass_matrix(body: Body, qpos: FloatArray) -> FloatArray:
    """MuJoCo's own mass matrix (nv, nv) in a posture (nq,) [kg m^2]."""
    data = mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_forward(body.model, data)
    mass: FloatArray = np.empty((body.nv, body.nv))
    mujoco.mj_fullM(body.model, data, mass)
    return mass


def joint_inertia(body: Body, packed: FloatArray) -> FloatArray:
    """Joint-space inertia (n, nv, nv) [kg m^2] of `State.M` (n, nM)."""
    rows, columns = _pattern(body)
    whole = np.zeros((len(packed), body.nv, body.nv))
    whole[:, rows, columns] = packed
    whole[:, columns, rows] = packed
    return whole


@lru_cache(maxsize=16)
def _pattern(body: Body) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Row and column of each packed element: the lower triangle, row by row."""
    rows = np.repeat(np.arange(body.nv), body.model.M_rownnz)
    return rows, body.model.M_colind.astype(np.int64)

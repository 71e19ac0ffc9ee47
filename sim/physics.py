"""How the physics of every body is stepped."""

from typing import Any

import mujoco

TIMESTEP = 0.002  # [s]


def set_physics(spec: Any, *, contacts: bool = True) -> None:
    """Set step, integrator and flags of a model.

    A state that diverges is not put back to its beginning: it is an error, see `sim.World`.

    Args:
        spec: the model, an `mujoco.MjSpec`.
        contacts: whether geoms that touch push each other away.
    """
    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    if not contacts:
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)

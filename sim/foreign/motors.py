"""What drives the joints of a model: torque limits from whatever it says of its actuators."""

from typing import Any

import mujoco
import numpy as np

MOST = 5000.0  # what is said to be stronger is no limit at all [N m]
LEAST = 1e-3  # what is said to be weaker was left out [N m]


def torque_limit(model: Any, joint: int) -> float | None:
    """The largest torque of a joint by its own limit or its actuators' [N m]; None if unsaid.

    A position or velocity servo says it by its force range, a motor by its control range too.
    """
    found = []
    if model.jnt_actfrclimited[joint]:
        found.append(float(np.abs(model.jnt_actfrcrange[joint]).min()))
    for actuator in range(model.nu):
        on = mujoco.mjtTrn(int(model.actuator_trntype[actuator]))
        if on not in (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT):
            continue
        if int(model.actuator_trnid[actuator, 0]) != joint:
            continue
        gear = abs(float(model.actuator_gear[actuator, 0]))
        if model.actuator_forcelimited[actuator]:
            found.append(gear * float(np.abs(model.actuator_forcerange[actuator]).min()))
        elif model.actuator_ctrllimited[actuator] and _is_motor(model, actuator):
            gain = abs(float(model.actuator_gainprm[actuator, 0]))
            found.append(gear * gain * float(np.abs(model.actuator_ctrlrange[actuator]).min()))
    said = [limit for limit in found if LEAST < limit < MOST]
    return min(said) if said else None


def _is_motor(model: Any, actuator: int) -> bool:
    """Whether an actuator makes a torque that is its control times a gain."""
    fixed = model.actuator_gaintype[actuator] == mujoco.mjtGain.mjGAIN_FIXED.value
    return bool(fixed and model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE.value)

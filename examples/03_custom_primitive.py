"""A primitive of one's own in ten lines, used from a task file.

From the shell: adonis run TASK --primitives examples/03_custom_primitive.py
"""

from typing import Literal

import numpy as np

from adonis.dancing import run_task
from primitives import Primitive
from sim import adonis
from specs import bind_task, task_from_text


class Damp(Primitive):
    """Resist motion as if under water."""

    kind: Literal["damp"] = "damp"
    viscosity: float = 2.0  # [N m s/rad]

    def torque(self, state, t):  # type: ignore[no-untyped-def]
        """Against every joint's velocity."""
        return -self.viscosity * state.qvel


TASK = """
task: under-water
background:
  - {name: weight, primitive: compensate-gravity}
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: water, primitive: damp, viscosity: WATER}
subtasks:
  - {name: reach, primitive: go-to-point, limb: right_arm, to: {point: [0.4, -0.2, 0.3]}}
"""

if __name__ == "__main__":
    for viscosity in (0, 10):
        text = TASK.replace("WATER", str(viscosity))
        spec, document = task_from_text(text, primitives=[Damp])
        (recording,) = run_task(bind_task(spec, adonis(), document))
        fastest = np.abs(recording.qvel).max()
        print(f"viscosity {viscosity:2}: no joint turned faster than {fastest:.1f} rad/s")

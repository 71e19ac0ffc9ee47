"""Adonis inside a MuJoCo loop of one's own: the arbiter asks for torques, the rest is yours."""

import mujoco

from arbiter import Arbiter
from sim import State, adonis
from specs import bind_task, load_task

body = adonis()
spec, document = load_task("macarena")
task = bind_task(spec, body, document)
arbiter = Arbiter(task)

model, data = body.model, mujoco.MjData(body.model)
data.qpos[:] = task.start

while data.time < 3.0:
    mujoco.mj_step1(model, data)  # positions, velocities, and what follows from them
    data.ctrl[:] = arbiter.torque(State.of(data))[0]
    mujoco.mj_step2(model, data)  # forces, and the step in time

for span in arbiter.spans():
    if span.outcome != "pending":
        print(f"{span.name:18} {span.outcome:8} since {span.start:.2f} s")

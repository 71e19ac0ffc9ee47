"""The right hand follows a moving point, the head looks at the hand, the left arm hangs loose.

The task is the file of the same name; here the point moves on a circle, as an array of NumPy.
"""

from pathlib import Path

import numpy as np

from adonis.dancing import run_task
from adonis.judging import judge
from primitives import Follow, Trajectory
from sim import adonis
from specs import SubTask, bind_task, load_task

if __name__ == "__main__":
    spec, document = load_task(Path(__file__).with_suffix(".yaml"))
    times = np.linspace(0.0, 4.0, 33)
    turn = np.pi * times
    circle = [0.42, -0.2, 0.5] + 0.12 * np.column_stack([0 * turn, np.cos(turn), np.sin(turn)])
    follow = Follow(limb="right_arm", trajectory=Trajectory(times=times, points=circle), settle=0.8)
    round_and_round = SubTask(name="follow", does=follow, after=("freeze",), beats=4)
    steps = [round_and_round if s.name == "follow" else s for s in spec.subtasks]
    spec = spec.model_copy(update={"subtasks": tuple(steps)})
    (recording,) = run_task(bind_task(spec, adonis(), document))
    for verdict in judge(recording, spec).verdicts:
        for m in verdict.measures:
            print(f"{verdict.subtask.name}: {m.what} {m.value:.3g} {m.unit} (limit {m.limit:g})")

"""The Macarena with its hips, its hands and guard combined by one rule after another."""

import time

from adonis.attribution import attribute
from adonis.dancing import run_task
from adonis.judging import judge
from arbiter import Arbiter
from sim import Replay, World, adonis
from specs import Group, bind_task, load_task

STEPS = 500  # of each whose time is taken

body = adonis()
spec, document = load_task("macarena-hips")
hands = tuple(s.name for s in spec.subtasks if s.does.kind == "go-to-point")

RULES = {
    "sum": (),
    "weighted, guard 0.1": (
        Group(name="both", rule="weighted", members=("guard", *hands), weights={"guard": 0.1}),
    ),
    "weighted, equal": (Group(name="both", rule="weighted", members=("guard", *hands)),),
    "null-space, hands over guard": (
        Group(name="hands", members=hands),
        Group(name="both", rule="null-space", members=("hands", "guard")),
    ),
    "null-space, hands over waist": (
        Group(name="hands", members=hands),
        Group(name="both", rule="null-space", members=("hands", "upright")),
    ),
    "dominant": (Group(name="both", rule="dominant", members=(*hands, "guard")),),
}

print(f"{'rule':30} sub-tasks  cancelled [N m s]  worst pair  control [us]")
for name, groups in RULES.items():
    task = bind_task(spec.model_copy(update={"groups": groups}), body, document)
    (recording,) = run_task(task)
    judgement = judge(recording, task.spec)
    pairs = attribute(recording, Replay(recording)).pairs
    cancelled = sum(pair.cancelled for pair in pairs)
    world, arbiter = World(body), Arbiter(task)
    arbiter.torque(world.state)
    began = time.perf_counter()
    for _ in range(STEPS):
        arbiter.torque(world.state)
    cost = (time.perf_counter() - began) / STEPS * 1e6
    worst = max((pair.conflict for pair in pairs), default=0.0)
    print(
        f"{name:30} {judgement.passed:2} of {len(judgement.verdicts)}"
        f" {cancelled:14.1f} {worst:14.2f} {cost:13.0f}"
    )

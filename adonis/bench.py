"""What control costs, measured against bare physics in the same run.

Machines are noisy, so every figure that matters is a ratio: the dance and bare physics take
turns, a few hundred steps each, over the same motions of the same model.
"""

import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from adonis.bench_bodies import bodies
from adonis.bench_composition import composition
from adonis.bench_safety import safety
from adonis.dancing import about, versions
from arbiter import Arbiter
from primitives import AvoidCollisions, CompensateGravity, GetPosture, GoToPoint, Primitive
from primitives.parameters import Controller
from sim import BareWorld, Body, PalmGoal, Recorder, World, adonis, reach
from specs import (
    BoundTask,
    SubTask,
    TaskSpec,
    bind_task,
    build_graph,
    load_task,
    load_variant,
    task_from_text,
)

TURN = 200  # steps
ROUNDS = 5  # turns of each of several things
FORWARD = (1.0, 0.0, 0.0)
DANCES: tuple[Controller, ...] = ("pd-servo", "torque-field", "impedance", "endpoint-force")
SIZES = ((1, 1), (1, 2), (64, 1), (64, 2), (1024, 1), (1024, 2))  # simulations, threads


def measure(*, quick: bool = False, tell: Callable[[str], None] = print) -> Any:
    """All figures, as plain data for JSON.

    Args:
        quick: measure a part of the dance only, and leave out the largest batch.
        tell: told what is being measured.
    """
    body = adonis()
    spec, document = load_task("macarena")
    task = bind_task(spec, body, document)
    figures: dict[str, Any] = {"versions": versions(), "model": "adonis, 20 hinges"}
    tell("the controllers are being prepared")
    torques = _torques(task)
    figures["dance"] = []
    for n, threads in SIZES:
        if quick and n > 64:
            continue
        tell(f"the dance, n = {n}, {threads} thread{'s' if threads > 1 else ''}")
        figures["dance"].append(_against_physics(task, torques, n, threads, quick))
    tell("recording")
    figures["recording"] = _recording(task, quick)
    tell("primitives")
    figures["primitives"] = _primitives(body)
    tell("the dance by each controller")
    figures["controllers"] = _controllers(body, quick)
    figures["safety"] = safety(body, tell)
    figures["composition"] = composition(body, tell, against_physics)
    figures["bodies"] = bodies(tell, against_physics)
    tell("a graph of 10 000 sub-tasks")
    figures["graph"] = _graphs(body, 1000 if quick else 4000)
    tell("10 000 sentences in English")
    figures["english"] = _english(1000 if quick else 10_000)
    tell("start-up")
    figures["start_up"] = _start_up()
    return figures


def _torques(task: BoundTask) -> np.ndarray:
    """The torques (T, nv) of the whole dance."""
    world, arbiter = World(task.body), Arbiter(task)
    world.reset(task.start)
    rows = []
    for _ in range(int(task.graph.duration / task.body.timestep)):
        torque = arbiter.torque(world.state)
        rows.append(torque[0].copy())
        world.step(torque)
    return np.array(rows)


def against_physics(task: BoundTask) -> dict[str, float]:
    """What a whole task costs per step at n = 1: bare physics and the task in turns [us]."""
    found = _against_physics(task, _torques(task), 1, 1, quick=False)
    return {key: found[key] for key in ("physics_us", "dance_us", "ratio")}


def _against_physics(
    task: BoundTask, torques: np.ndarray, n: int, threads: int, quick: bool
) -> dict[str, float]:
    """The dance and `Batch.step` under the same torques, in turns."""
    world = World(task.body, n, threads=threads)
    arbiter = Arbiter(task, n, threads=threads, contributions=n == 1)
    world.reset(task.start)
    bare = BareWorld(task.body, n, threads, task.start)
    steps = min(len(torques), 600) if quick else len(torques)
    spent = {"dance": 0.0, "physics": 0.0}
    turns = []
    for first in range(0, steps, TURN):
        block = torques[first : min(first + TURN, steps)]
        began = time.perf_counter()
        for _ in range(len(block)):
            world.step(arbiter.torque(world.state))
        middle = time.perf_counter()
        for torque in block:
            bare.step(torque)
        ended = time.perf_counter()
        spent["dance"] += middle - began
        spent["physics"] += ended - middle
        turns.append((middle - began) / (ended - middle))
    scale = 1e6 / (steps * n)
    return {
        "n": n,
        "threads": threads,
        "steps": steps,
        "physics_us": round(spent["physics"] * scale, 3),
        "dance_us": round(spent["dance"] * scale, 3),
        "ratio": round(float(np.median(turns)), 3),
        "ratio_of_totals": round(spent["dance"] / spent["physics"], 3),
        "contributions_kept": n == 1,
    }


def _recording(task: BoundTask, quick: bool) -> dict[str, float]:
    """What it costs to take down every step at n = 1, contributions included."""
    spent = {}
    steps = 600 if quick else 3000
    for kept in (False, True):
        world, arbiter = World(task.body), Arbiter(task)
        world.reset(task.start)
        applied = world.torque if kept else None
        channels = np.zeros((1, arbiter.most_channels), dtype=np.int32)
        recorder = Recorder(
            task.body,
            1,
            names=arbiter.names,
            channels=arbiter.most_channels,
            about=about(task, 0),
        )
        began = time.perf_counter()
        for _ in range(steps):
            torque = arbiter.torque(world.state)
            if kept:
                arbiter.channels(channels)
                recorder.take(world.state, arbiter.contribution, channels)
            world.step(torque)
            if applied is not None:
                recorder.applied(applied)
        spent[kept] = (time.perf_counter() - began) / steps * 1e6
    return {"without_us": round(spent[False], 3), "with_us": round(spent[True], 3)}


def _primitives(body: Body) -> dict[str, float]:
    """Time of each primitive alone [us per simulation], in a batch of 1024 mid-movement."""
    found = _cost_of(body, AvoidCollisions(), CompensateGravity())
    return {p.kind: us for p, us in found} | controller_costs(body)


def controller_costs(body: Body) -> dict[str, float]:
    """Time of one limb's field by each controller [us per simulation], as `_primitives`."""
    posture = {"arm": "forward", "palm": "down"}
    found = _cost_of(
        body,
        *(
            GetPosture(controller=c, limb="right_arm", posture=posture)
            for c in ("pd-servo", "torque-field")
        ),
        *(
            GoToPoint(controller=c, limb="right_arm", to="left_shoulder.top", upper_arm=FORWARD)
            for c in ("impedance", "endpoint-force")
        ),
    )
    return {p.controller: us for p, us in found if isinstance(p, GetPosture | GoToPoint)}


def _controllers(body: Body, quick: bool) -> dict[str, dict[str, float]]:
    """The dance by each controller at n = 1 [us per step], all of them in turns with physics.

    `control_us` is what the arbiter takes: background, hand-over and all fields that are on.
    """
    turns = []
    for name in DANCES:
        spec, document = load_variant("macarena", name)
        task = bind_task(spec, body, document)
        world, arbiter = World(body), Arbiter(task, contributions=False)
        world.reset(task.start)
        arbiter.torque(world.state)  # loads the compiled code
        arbiter.reset()
        turns.append((name, world, arbiter))
    spent = {name: np.zeros(2) for name in DANCES}
    steps = 600 if quick else 3400
    for _ in range(steps // TURN):
        for name, world, arbiter in turns:
            for _ in range(TURN):
                began = time.perf_counter()
                torque = arbiter.torque(world.state)
                middle = time.perf_counter()
                world.step(torque)
                spent[name] += middle - began, time.perf_counter() - middle
    scale = 1e6 / (steps // TURN * TURN)
    servo = spent["pd-servo"][0]
    return {
        name: {
            "control_us": round(float(control * scale), 3),
            "physics_us": round(float(physics * scale), 3),
            "control_over_pd_servo": round(float(control / servo), 3),
        }
        for name, (control, physics) in spent.items()
    }


def _cost_of(body: Body, *primitives: Primitive) -> list[tuple[Primitive, float]]:
    """Time of fields alone, in turns over the same states [us per simulation]."""
    n = 1024
    world = World(body, n)
    who, t = np.ones(n, dtype=bool), np.full(n, 0.3)
    bound = []
    for primitive in primitives:
        field = primitive.bind(body, 0.6)
        field.begin(world.state, who)
        field.torque(world.state, t)
        bound.append((primitive, field))
    best = dict.fromkeys(range(len(bound)), np.inf)
    for _ in range(ROUNDS):
        for k, (_, field) in enumerate(bound):
            best[k] = min(best[k], _best(partial(field.torque, world.state, t), repeat=3))
    return [(p, round(best[k] / n * 1e6, 4)) for k, (p, _) in enumerate(bound)]


def ik_cost(body: Body) -> float:
    """Time of one inverse-kinematics solution for a palm on a landmark [us]."""
    arm, mark = body.arm("right_arm"), body.landmark("left_shoulder.top")
    return round(_best(lambda: reach(body, arm, [PalmGoal(mark, touched=mark.link)])) * 1e6, 1)


def _graphs(body: Body, steps: int) -> dict[str, float]:
    """A graph of 10 000 sub-tasks against one of 12: to compile, and per step at n = 1."""
    figures: dict[str, float] = {}
    runs = {}
    for count in (12, 10_000):
        subtasks = tuple(
            SubTask(
                name=f"s{k}",
                does=GoToPoint(
                    limb=("right_arm", "left_arm")[k % 2],
                    to=("head.top", "chest.front", "belly.front")[k % 3],
                ),
                seconds=max(0.5, steps * body.timestep / 12),
            )
            for k in range(count)
        )
        spec = TaskSpec(task=f"graph-{count}", subtasks=subtasks)
        began = time.perf_counter()
        task = bind_task(spec, body)
        runs[count] = World(body), Arbiter(task)
        figures[f"compile_{count}_s"] = round(time.perf_counter() - began, 4)
    spent = dict.fromkeys(runs, 0.0)
    for _ in range(steps // TURN):
        for count, (world, arbiter) in runs.items():
            began = time.perf_counter()
            for _ in range(TURN):
                world.step(arbiter.torque(world.state))
            spent[count] += time.perf_counter() - began
    done = steps // TURN * TURN
    for count, seconds in spent.items():
        figures[f"step_{count}_us"] = round(seconds / done * 1e6, 3)
    figures["step_ratio"] = round(spent[10_000] / spent[12], 3)
    return figures


def _english(sentences: int) -> dict[str, float]:
    """Time from a text of so many sentences to its task, and on to its graph [s]."""
    said = [subtask.words for subtask in load_task("macarena-words")[0].subtasks]
    said += ["Raise your left arm and look at it.", "Put your hands on your hips, then nod twice."]
    text = "\n".join(said[k % len(said)] for k in range(sentences))
    task_from_text("Nod.", "first.txt")  # reads the vocabulary
    began = time.perf_counter()
    spec, document = task_from_text(text, "long.txt")
    parsed = time.perf_counter()
    build_graph(spec, document)
    return {
        "sentences": sentences,
        "subtasks": len(spec.subtasks),
        "to_task_s": round(parsed - began, 3),
        "to_graph_s": round(time.perf_counter() - parsed, 3),
    }


def _start_up() -> dict[str, float]:
    """Time of new processes [s]: for help, to import, to compile the task, to the first step."""
    to_first_step = (
        "import time; began = time.perf_counter()\n"
        "from specs import bind_task, load_task\n"
        "from sim import World, adonis\n"
        "from arbiter import Arbiter\n"
        "imported = time.perf_counter()\n"
        "spec, document = load_task('macarena'); body = adonis()\n"
        "task = bind_task(spec, body, document)\n"
        "bound = time.perf_counter()\n"
        "world = World(body); world.step(Arbiter(task).torque(world.state))\n"
        "print(imported - began, bound - imported, time.perf_counter() - bound)\n"
    )
    parts = [
        [float(x) for x in _output([sys.executable, "-c", to_first_step]).split()] for _ in range(3)
    ]
    imported, bound, stepped = np.min(parts, axis=0)
    help_ = [sys.executable, "-m", "adonis", "--help"]
    return {
        "help_s": round(_best(lambda: _output(help_)), 3),
        "import_s": round(float(imported), 3),
        "compile_task_s": round(float(bound), 3),
        "to_first_step_s": round(float(stepped), 3),
    }


def _output(command: Sequence[str]) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def _best(action: Callable[[], object], repeat: int = 5) -> float:
    """The shortest of several times [s]."""
    times = []
    for _ in range(repeat):
        began = time.perf_counter()
        action()
        times.append(time.perf_counter() - began)
    return min(times)

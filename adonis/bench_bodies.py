"""What each body costs: to load, to bind a task to it, and per step against its own bare physics.

Bodies of the package, and four robots that others made, proposed anew, if `example-robot-data` is
installed. The task is the same for all: every arm bends its elbow and comes to rest, while
waist and neck are held, links are kept apart and the weight is carried.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from primitives import AvoidCollisions, CompensateGravity, GetPosture
from sim import BODIES, Body, BodyError, build_body, load_body, propose, read_model
from specs import Background, BoundTask, SubTask, TaskSpec, bind_task

ROBOTS = Path("cmeel.prefix/share/example-robot-data/robots")
THEIRS = {
    "icub": "icub_description/robots/icub.urdf",
    "human": "human_description/robots/human.urdf",
    "talos": "talos_data/robots/talos_full_v2.urdf",
    "baxter": "baxter_description/urdf/baxter.urdf",
}
BENT = 60.0  # [deg]
SECONDS = 1.0  # of each sub-task


def bodies(
    tell: Callable[[str], None], against_physics: Callable[[BoundTask], dict[str, float]]
) -> dict[str, dict[str, Any]]:
    """Times [s] and costs of a step [us] of each body.

    Args:
        tell: told which body is on.
        against_physics: measures a task against bare physics.
    """
    found: dict[str, dict[str, Any]] = {}
    for name in BODIES:
        tell(f"the body {name}")
        began = time.perf_counter()
        body = load_body(name)
        found[name] = {"load_s": _since(began), **_on(body, against_physics)}
    for name, model in THEIRS.items():
        file = _file(model)
        if file is None:
            found[name] = {"not_installed": "example-robot-data"}
            continue
        tell(f"the body {name}")
        try:
            found[name] = _theirs(name, file, against_physics)
        except BodyError as problem:
            found[name] = {"problem": str(problem)}
    return found


def _theirs(
    name: str, file: Path, against_physics: Callable[[BoundTask], dict[str, float]]
) -> dict[str, Any]:
    """Of a robot that somebody else made."""
    began = time.perf_counter()
    source = read_model(file)
    read = _since(began)
    began = time.perf_counter()
    proposal = propose(source, name, str(file))
    proposed = _since(began)
    began = time.perf_counter()
    body = build_body(source, proposal.file)
    built = _since(began)
    times = {"propose_s": proposed, "load_s": round(read + built, 3)}
    return times | _on(body, against_physics)


def _on(body: Body, against_physics: Callable[[BoundTask], dict[str, float]]) -> dict[str, Any]:
    """The task on one body."""
    spec = bending(body)
    began = time.perf_counter()
    task = bind_task(spec, body)
    bound = _since(began)
    figures = {"links": body.model.nbody - 1, "hinges": body.nv, "bind_s": bound}
    return figures | against_physics(task)


def bending(body: Body) -> TaskSpec:
    """Every arm bends its elbow by 60 degrees and comes to rest; of other bodies all joints do."""
    background = [Background(name="weight", does=CompensateGravity())]
    core = tuple(group for group in ("waist", "neck") if body.map.groups.get(group))
    if core:
        upright = GetPosture(joints=core, posture="upright")
        background.append(Background(name="upright", does=upright))
    if body.map.keep_apart:
        background.append(Background(name="guard", does=AvoidCollisions()))
    rest, moves = body.map.postures["rest"], []
    for name, limb in body.map.limbs.items():
        bent = {joint: rest[joint] for joint in limb.joints} | {limb.elbow: BENT}
        moves.append((f"{name}-bent", GetPosture(limb=name, posture=bent)))
        moves.append((f"{name}-rest", GetPosture(limb=name, posture="rest")))
    if not moves:
        moves.append(("rest", GetPosture(joints=("all",), posture="rest")))
    subtasks = tuple(SubTask(name=name, does=move, seconds=SECONDS) for name, move in moves)
    return TaskSpec(task="bending", background=tuple(background), subtasks=subtasks)


def _file(model: str) -> Path | None:
    """A model of example-robot-data, if that is installed."""
    found = (Path(folder) / ROBOTS / model for folder in sys.path if folder)
    return next((path for path in found if path.is_file()), None)


def _since(began: float) -> float:
    return round(time.perf_counter() - began, 3)

"""Attacks on the safety filter: random tasks that drive the body into its limits.

    python -m adonis.safety_study [TASKS] [SEED]

Each task lets both arms reach for places inside the head, the trunk, the hips or the other
arm with springs that saturate the motors, or swing to postures at the ends of the joints'
ranges, while waist and neck are servoed anywhere; some are shaken by torques of random
sign at the motors' limits. The same tasks run with the filter, and with avoid-collisions
alone. What is measured comes from the recording, by MuJoCo's own distances (`sim.Replay`).
"""

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from adonis.dancing import random_start, run_task
from arbiter import MARGIN
from primitives import AvoidCollisions, CompensateGravity, GetPosture, GoToPoint, Place, Primitive
from sim import Body, Recording, Replay, State, adonis, clearance
from specs import Background, SubTask, TaskSpec, bind_task

FloatArray = NDArray[np.float64]
Safety = Literal["none", "filter"]
TARGETS = (
    *("head.back", "head.front", "head.top", "head.left", "head.right", "chest.front"),
    *("belly.front", "left_ribs", "right_ribs", "left_hip", "right_hip"),
    *("left_shoulder.top", "right_shoulder.top", "left_elbow.inside", "right_elbow.inside"),
)
SECONDS = 0.5  # of each attack
ATTACKS = 3  # of each arm, one after the other
LOOK_EVERY = 3  # rows from one look at the distances to the next
NOISE = 0.02  # share of its limit that a torque must cross zero by to count as a sign change


class Shake(Primitive):
    """Torques of random sign, drawn anew every so often."""

    kind: Literal["shake"] = "shake"
    seed: int = 0
    size: tuple[float, ...]  # of each joint's torque [N m]
    every: float = 0.25  # [s]

    def torque(self, state: State, t: FloatArray) -> FloatArray:
        """See `Primitive.torque`."""
        turn = int(t[0] / self.every)
        signs = np.random.default_rng((self.seed, turn)).choice((-1.0, 1.0), state.qvel.shape[1])
        return np.tile(np.array(self.size) * signs, (state.n, 1))


@dataclass(frozen=True)
class Outcome:
    """What became of one task under one kind of safety."""

    closest: float  # between links that must not touch [m]
    links: tuple[str, str]
    beyond: float  # the end of a joint's range [deg]
    joint: str
    fastest: float  # joint, as a share of its speed limit
    flips: float  # sign changes of torque per second, of the joint that has most
    seconds: float  # that the run took


def attack(body: Body, seed: int, safety: Safety) -> TaskSpec:
    """A random task; the same for every kind of safety."""
    rng = np.random.default_rng(seed)
    subtasks = []
    for limb in body.map.limbs:
        before: tuple[str, ...] = ()
        for k in range(ATTACKS):
            name = f"{limb}-{k}"
            does = _posture(body, limb, rng) if rng.random() < 0.25 else _reach(limb, rng)
            subtasks.append(SubTask(name=name, does=does, seconds=SECONDS, after=before))
            before = (name,)
    background = [
        Background(
            name="trunk", does=GetPosture(joints=("waist", "neck"), posture=_trunk(body, rng))
        )
    ]
    if rng.random() < 0.7:
        background.append(Background(name="weight", does=CompensateGravity()))
    if rng.random() < 0.3:
        background.append(
            Background(name="shake", does=Shake(seed=seed, size=tuple(body.torque_limit)))
        )
    if safety == "none":
        background.append(Background(name="guard", does=AvoidCollisions()))
    return TaskSpec(
        task=f"attack-{seed}",
        safety=safety,
        coda=0.3,
        background=tuple(background),
        subtasks=tuple(subtasks),
    )


def _reach(limb: str, rng: np.random.Generator) -> GoToPoint:
    place = Place(near=str(rng.choice(TARGETS)), away=-float(rng.uniform(0.02, 0.08)))
    stiffness = float(rng.uniform(3000.0, 20000.0))
    return GoToPoint(
        limb=limb, to=place, stiffness=stiffness, damping=float(rng.uniform(0.0, 2.0 * 85.0))
    )


def _posture(body: Body, limb: str, rng: np.random.Generator) -> GetPosture:
    """The ends of the joints' ranges, or somewhere between."""
    posture = _ends(body, limb, rng, 1.0)
    return GetPosture(limb=limb, posture=posture, stiffness=float(rng.uniform(100.0, 600.0)))


def _trunk(body: Body, rng: np.random.Generator) -> dict[str, Any]:
    return _ends(body, "waist", rng, 0.5) | _ends(body, "neck", rng, 1.0)


def _ends(body: Body, names: str, rng: np.random.Generator, share: float) -> dict[str, Any]:
    low, high = (np.rad2deg(side) for side in body.range)
    return {
        body.dof_name(int(j)): float(
            share * rng.choice((low[j], high[j], rng.uniform(low[j], high[j])))
        )
        for j in body.joints(names)
    }


def try_task(body: Body, seed: int, safety: Safety) -> tuple[Outcome, Recording]:
    """Run a random task from a random start and measure it."""
    task = bind_task(attack(body, seed, safety), body)
    start = _clear_start(body, task.start, seed)
    began = time.perf_counter()
    (recording,) = run_task(task, start=start)
    return measure(body, recording, time.perf_counter() - began), recording


def _clear_start(body: Body, start: FloatArray, seed: int) -> FloatArray:
    """A start in which every margin is kept."""
    for k in range(100):
        qpos: FloatArray = random_start(body, start, 1, 1000 * seed + k)
        if clearance(body, qpos) > MARGIN:
            return qpos
    raise ValueError("no start keeps its margins")


def measure(body: Body, recording: Recording, seconds: float = 0.0) -> Outcome:
    """What became of a recording."""
    closest = Replay(recording).clearance(body.map.keep_apart, every=LOOK_EVERY)
    low, high = body.range
    beyond = np.rad2deg(np.maximum(recording.qpos - high, low - recording.qpos)).max(axis=0)
    worst = int(np.argmax(beyond))
    speed = np.abs(recording.qvel) / body.speed_limit
    flips = max(
        sign_changes(recording.torque[:, j], NOISE * body.torque_limit[j]) for j in range(body.nv)
    )
    return Outcome(
        closest.distance,
        closest.geoms,
        float(beyond[worst]),
        body.dof_name(worst),
        float(speed.max()),
        flips / float(recording.time[-1]),
        seconds,
    )


def sign_changes(values: FloatArray, least: float) -> int:
    """How often values change their sign, those smaller than `least` not counted."""
    signs = np.sign(values[np.abs(values) > least])
    return int(np.count_nonzero(np.diff(signs)))


def study(tasks: int, seed: int = 0) -> str:
    """Run so many random tasks both ways; returns a table in Markdown."""
    body = adonis()
    rows: dict[Safety, list[Outcome]] = {"filter": [], "none": []}
    for k in range(tasks):
        for safety, found in rows.items():
            found.append(try_task(body, seed + k, safety)[0])
        if (k + 1) % 50 == 0:
            print(f"{k + 1} tasks", file=sys.stderr)
    return table(rows["filter"], rows["none"])


def table(filtered: list[Outcome], repelled: list[Outcome]) -> str:
    """Both outcomes side by side."""

    def row(what: str, form: str, of: Callable[[list[Outcome]], float]) -> str:
        return f"| {what} | {of(filtered):{form}} | {of(repelled):{form}} |"

    def short(found: list[Outcome]) -> FloatArray:
        return 1000.0 * (MARGIN - np.array([o.closest for o in found]))

    def beyond(found: list[Outcome]) -> FloatArray:
        return np.array([o.beyond for o in found])

    def flips(found: list[Outcome]) -> FloatArray:
        return np.array([o.flips for o in found])

    busiest = "torque sign changes per second of the busiest joint"
    lines = [
        f"| {len(filtered)} random tasks | `safety: filter` | avoid-collisions alone |",
        "|---|---|---|",
        row("tasks with a margin passed by more than 1 mm", "d", lambda f: sum(short(f) > 1)),
        row("margin passed by at most [mm]", ".2f", lambda f: max(short(f))),
        row("tasks with a joint past its end by more than 0.5°", "d",
            lambda f: sum(beyond(f) > 0.5)),
        row("end of a joint passed by at most [°]", ".2f", lambda f: max(beyond(f))),
        row("fastest joint, of its limit", ".2f", lambda f: max(o.fastest for o in f)),
        row(busiest + ", median", ".0f", lambda f: float(np.median(flips(f)))),
        row(busiest + ", at most", ".0f", lambda f: max(flips(f))),
    ]  # fmt: skip
    return "\n".join(lines)


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:3]]
    print(study(*numbers or (1000,)))

"""The stage of a rehearsal: a task as it goes, and what would become of it in other ways.

One simulation goes through the task. Where a sub-task is about to begin, its moment is taken
down, and any number of variants of the task go on from there, each with an arbiter of its own,
in one batch of simulations.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from adonis.dancing import about
from arbiter import Arbiter, ArbiterError, Place
from sim import Moment, Recorder, Recording, World
from specs import BoundTask

FloatArray = NDArray[np.float64]
EARLY = 1e-9  # [s] for rounding


@dataclass(frozen=True)
class Scene:
    """The moment before a sub-task begins."""

    subtask: str  # none, at the opening of a task
    time: float  # [s]
    qpos: FloatArray  # (nq,)
    physics: Moment  # where to go on from: this moment, or the beginning if there is no place
    place: Place | None  # in the task; None: the arbiter of such a task cannot be put there


class Walk:
    """One simulation of a task that stops before each of some sub-tasks.

    Args:
        task: the task as it is so far.
    """

    def __init__(self, task: BoundTask) -> None:
        self._world = World(task.body)
        self._world.reset(task.start)
        self._first = self._world.moment()
        self._arbiter = Arbiter(task, contributions=False)

    def next(self, wanted: set[str]) -> Scene | None:
        """Go on until one of the sub-tasks begins; None if none of them ever does."""
        arbiter, world = self._arbiter, self._world
        spec = arbiter.task.spec
        longest = arbiter.task.graph.duration + sum(s.timeout or 0.0 for s in spec.subtasks)
        while world.state.time[0] <= longest and not arbiter.over.all():
            time, physics = float(world.state.time[0]), world.moment()
            place = arbiter.place() if arbiter.forkable else None
            torque = arbiter.torque(world.state)
            begun = [s.name for s in arbiter.spans() if s.name in wanted and s.outcome == "running"]
            if begun:
                begin = self._first if place is None else physics
                return Scene(begun[0], time, physics.qpos, begin, place)
            world.step(torque)
        return None

    def go_on(self, task: BoundTask, scene: Scene) -> None:
        """Go on from a scene in a variant of the task."""
        self._arbiter = Arbiter(task, contributions=False)
        self._world.go_back(scene.physics)
        if scene.place is not None:
            self._arbiter.go_on_from(scene.place)


def opening(task: BoundTask) -> Scene:
    """The moment before a task begins."""
    world = World(task.body)
    world.reset(task.start)
    return Scene("", 0.0, task.start, world.moment(), None)


def play(
    variants: Sequence[BoundTask],
    scene: Scene,
    seconds: float,
    *,
    alone: bool = False,
) -> list[Recording | None]:
    """Let variants of a task go on from a scene, each in a simulation of its own.

    Args:
        variants: the task with other parameters.
        scene: where they go on from.
        seconds: for how long from there on.
        alone: hold back what is planned to begin when the scene's sub-task is over.

    Returns:
        A recording of each from the scene on (from the beginning, if the scene has no place);
        None where the physics went wrong or a primitive asked for nonsense.
    """
    body, n = variants[0].body, len(variants)
    world = World(body, n)
    world.go_back(scene.physics)
    arbiters = [Arbiter(task, contributions=False) for task in variants]
    if scene.place is not None:
        for arbiter in arbiters:
            arbiter.go_on_from(scene.place)
    planned = variants[0].graph.planned
    over = planned[scene.subtask][1] - EARLY if alone else np.inf
    for arbiter in arbiters:
        arbiter.hold_back([name for name, when in planned.items() if when[0] >= over])
    states = [world.state.of_one(i) for i in range(n)]
    recorder = Recorder(body, n, about=about(variants[0], 0))
    nobody = np.zeros((n, 0), dtype=np.int32)
    torque, failed = np.zeros((n, body.nv)), np.zeros(n, dtype=bool)
    for _ in range(round((scene.time + seconds - scene.physics.time) / body.timestep)):
        for i in np.flatnonzero(~failed):
            try:
                torque[i] = arbiters[i].torque(states[i])[0]
            except ArbiterError:
                torque[i], failed[i] = 0.0, True
        recorder.take(world.state, None, nobody)
        world.step(torque)
        recorder.applied(world.torque)
    recordings = recorder.finish([arbiter.spans() for arbiter in arbiters])
    whole = [bool(np.isfinite(r.qpos).all() and np.isfinite(r.qvel).all()) for r in recordings]
    return [
        r if ok and not bad else None for r, ok, bad in zip(recordings, whole, failed, strict=True)
    ]

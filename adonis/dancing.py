"""From a bound task to recordings: the loop in which arbiter and physics take turns."""

import platform
from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arbiter import Arbiter, ArbiterError
from sim import Body, Diverged, Push, Recorder, Recording, World, unknown
from specs import BoundTask, task_to_yaml

FloatArray = NDArray[np.float64]
EARLY = 1e-9  # [s] rounding of sums of time steps
LOOK_EVERY = 50  # steps between looks at the health of the physics


class Stopped(Exception):
    """A run that broke off.

    Args:
        message: why.
        recordings: what there was until then.
        interrupted: whether the user wanted it so.
    """

    def __init__(
        self, message: str, recordings: tuple[Recording, ...], *, interrupted: bool = False
    ) -> None:
        super().__init__(message)
        self.recordings = recordings
        self.interrupted = interrupted


def run_task(
    task: BoundTask,
    *,
    n: int = 1,
    threads: int = 1,
    start: FloatArray | None = None,
    pushes: Sequence[Push] = (),
    events: Sequence[tuple[float, str]] = (),
    seed: int = 0,
    contributions: bool = True,
    becoming: Sequence[tuple[float, BoundTask]] = (),
    part: Path | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> tuple[Recording, ...]:
    """Let n simulations do a task from beginning to end.

    Args:
        task: what to do, on which body.
        n: number of simulations.
        threads: on which they are stepped; the result does not depend on it.
        start: postures to begin in (nq,) or (n, nq); default: the task's.
        pushes: forces from outside.
        events: when each is sent to all simulations [s], and its name.
        seed: written into the recording; whoever drew `start` at random used it.
        contributions: whether to keep which primitive made which torque.
        becoming: the task on bodies with other shapes that the body becomes, and from when [s].
        part: file that holds what was recorded so far, while the run lasts.
        progress: told the share that is done and the sub-task that is on.

    Returns:
        One recording for each simulation.

    Raises:
        Stopped: the physics went wrong, a primitive asked for nonsense, or the user
            interrupted; it carries what was recorded until then.
        RecordingError: the part cannot be written.
        BodyError: a push names a link that the body lacks.
        ArbiterError: no condition of the task is about such an event.
    """
    body = task.body
    world = World(body, n, threads=threads, pushes=pushes)
    world.reset(task.start if start is None else start)
    arbiter = Arbiter(task, n, threads=threads, contributions=contributions)
    recorder = Recorder(
        body,
        n,
        names=arbiter.names if contributions else (),
        channels=arbiter.most_channels,
        about=about(task, seed) | _becomes(becoming),
        part=part,
        later_models=tuple((time, other.body.xml) for time, other in becoming),
    )
    coming = sorted(becoming, key=lambda b: -b[0])
    channels = np.zeros((n, arbiter.most_channels), dtype=np.int32)
    asked, applied = arbiter.contribution if contributions else None, world.torque
    planned = int(np.ceil(task.graph.duration / body.timestep))
    coda = int(np.ceil(task.graph.coda / body.timestep))
    last: int | None = None if task.may_wait else planned
    step = 0
    for _, event in events:
        if event not in task.events:
            raise ArbiterError(unknown("event", event, task.events))
    waiting = sorted(events, reverse=True)
    problem, interrupted = None, False
    try:
        while last is None or step < last:
            while waiting and step * body.timestep >= waiting[-1][0] - EARLY:
                arbiter.send(waiting.pop()[1])
            while coming and step * body.timestep >= coming[-1][0] - EARLY:
                _, other = coming.pop()
                world, arbiter = _become(other, world, arbiter, pushes)
                asked, applied = arbiter.contribution if contributions else None, world.torque
            torque = arbiter.torque(world.state)
            if contributions:
                arbiter.channels(channels)
            recorder.take(world.state, asked, channels)
            world.step(torque)
            recorder.applied(applied)
            step += 1
            if step % LOOK_EVERY == 0:
                world.check()
                if last is None and arbiter.over.all():
                    last = step + coda
                if progress is not None:
                    progress(min(step / planned, 1.0), _present(arbiter))
        world.check()
    except (Diverged, ArbiterError) as error:
        problem = f"{_cause(world, error)}, during {_present(arbiter) or 'the background'}"
    except KeyboardInterrupt:
        problem, interrupted = f"interrupted at {step * body.timestep:.3f} s", True
    spans, rounds = ([each(i) for i in range(n)] for each in (arbiter.spans, arbiter.rounds))
    recordings = recorder.finish(spans, rounds, complete=problem is None)
    if problem is not None:
        raise Stopped(problem, recordings, interrupted=interrupted)
    recorder.discard_part()
    return recordings


def _becomes(becoming: Sequence[tuple[float, BoundTask]]) -> dict[str, Any]:
    """What a recording should say of a body that becomes others."""
    return {"becomes": becoming[-1][1].body.map.name} if becoming else {}


def _become(
    task: BoundTask, world: World, arbiter: Arbiter, pushes: Sequence[Push]
) -> tuple[World, Arbiter]:
    """The world and the arbiter on another body, where all simulations go on as the first.

    Angles, angular velocities and the place in the task stay as they are.
    """
    changed = World(task.body, world.n, threads=world.threads, pushes=pushes)
    changed.go_back(world.moment())
    going_on = Arbiter(task, world.n, threads=world.threads, contributions=arbiter.keeps)
    going_on.go_on_from(arbiter.place())
    return changed, going_on


def random_start(body: Body, task_start: FloatArray, count: int, seed: int) -> FloatArray:
    """Postures (count, nq) with the arms anywhere they can be without touching anything.

    Waist and neck stay as the task starts them; without arms all joints are anywhere.
    """
    rng = np.random.default_rng(seed)
    dofs = body.joints(list(body.map.limbs) or "all")
    low, high = (limit[dofs] for limit in body.range)
    low, high = np.maximum(low, -np.pi), np.minimum(high, np.pi)
    found: list[FloatArray] = []
    while len(found) < count:
        q = task_start.copy()
        q[body.qpos_of_dof[dofs]] = rng.uniform(low, high)
        if body.is_free(q):
            found.append(q)
    return np.array(found)


def about(task: BoundTask, seed: int) -> dict[str, Any]:
    """What a recording should say about its origin."""
    return {
        "task": task_to_yaml(task.spec),
        "body": task.body.map.name,
        "body_map": task.body.map.model_dump(mode="json"),
        "seed": seed,
        "versions": versions(),
    }


def versions() -> dict[str, str]:
    """Versions of what makes the numbers."""
    found = {"python": platform.python_version()}
    for name in ("adonis", "mujoco", "numpy", "numba"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def _cause(world: World, error: Exception) -> Exception:
    """The physics, if it was at fault: then a torque that is no number is but a consequence."""
    try:
        world.check()
    except Diverged as diverged:
        return diverged
    return error


def _present(arbiter: Arbiter) -> str:
    """The sub-tasks that are under way in the first simulation."""
    return ", ".join(s.name for s in arbiter.spans(0) if s.outcome == "running")


__all__ = ["Stopped", "about", "random_start", "run_task", "versions"]

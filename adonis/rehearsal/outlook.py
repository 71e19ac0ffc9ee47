"""What comes after a sub-task, as far as its way has to know."""

from dataclasses import dataclass

from adonis.rehearsal.stage import EARLY
from primitives import GoToPoint
from specs import BoundTask, SubTask

AFTERWARDS = 0.25  # [s] for which a goal is watched when its time is over, at most
AHEAD = 1.2  # [s] the same, where all that comes later has its way already
BEYOND = 0.02  # [s] and a little more, so that what is to end meanwhile does


@dataclass(frozen=True)
class Outlook:
    """How long a way is watched, and what is known of the time after it."""

    seconds: float  # from the beginning of the sub-task on [s]
    alone: bool  # whether what comes later is held back: nobody knows its ways yet
    freed: bool  # whether another limb moves on as soon as it is over, and may give way
    next_hand: str | None  # the first go-to-point of another arm while the goal is held


def outlook(task: BoundTask, subtask: SubTask, *, alone: bool) -> Outlook:
    """What comes after a sub-task that moves a hand.

    Args:
        task: the task.
        subtask: the sub-task.
        alone: whether what comes later is held back.
    """
    own = max(task.graph.lasts(subtask.name) * subtask.times, subtask.timeout or 0.0)
    rest = _rest(task, subtask, AFTERWARDS if alone else AHEAD) + BEYOND
    freed = alone and _freed(task, subtask)
    return Outlook(own + rest, alone, freed, _next_hand(task, subtask) if alone else None)


def carries(task: BoundTask, dofs: set[int], name: str) -> bool:
    """Whether these joints move the goal of a sub-task, and not the hand that is to go there."""
    does = task.graph.subtasks[name].does
    if not isinstance(does, GoToPoint):
        return False
    moved, joints = task.body.ancestors, sorted(dofs)
    goal, hand = does.palm_goal(task.body).place.link, task.body.arm(does.limb).hand
    return bool((moved[goal] & ~moved[hand])[joints].any())


def claims(task: BoundTask) -> dict[str, set[int]]:
    """The degrees of freedom that each sub-task claims."""
    return dict(zip(task.graph.order, (set(f.claims.tolist()) for f in task.fields), strict=True))


def _later(task: BoundTask, subtask: SubTask) -> list[tuple[float, str]]:
    """How long after its end the others are planned to begin, one after the other [s]."""
    end = task.graph.planned[subtask.name][1]
    return sorted(
        (start - end, name)
        for name, (start, _) in task.graph.planned.items()
        if name != subtask.name and start >= end - EARLY
    )


def _rest(task: BoundTask, subtask: SubTask, longest: float) -> float:
    """How long a goal is held, as it is planned, before hand or goal move on; or is watched [s]."""
    claimed = claims(task)
    starts = [
        start
        for start, name in _later(task, subtask)
        if claimed[name] & claimed[subtask.name] or carries(task, claimed[name], subtask.name)
    ]
    return min([*starts, longest])


def _freed(task: BoundTask, subtask: SubTask) -> bool:
    own = getattr(subtask.does, "limb", None)
    return any(
        start < EARLY and getattr(task.graph.subtasks[name].does, "limb", None) not in (None, own)
        for start, name in _later(task, subtask)
    )


def _next_hand(task: BoundTask, subtask: SubTask) -> str | None:
    claimed = claims(task)
    for _, name in _later(task, subtask):
        if claimed[name] & claimed[subtask.name]:
            return None
        if isinstance(task.graph.subtasks[name].does, GoToPoint):
            return name
    return None

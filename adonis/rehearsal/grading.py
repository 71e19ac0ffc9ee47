"""What a rehearsal thinks of a way: does it pass the judge, and would a person move so?"""

from dataclasses import dataclass, replace

import numpy as np

from adonis.judging import judge
from adonis.measures import speed
from adonis.rehearsal.outlook import carries, claims
from adonis.rehearsal.stage import EARLY
from adonis.verdicts import Measure
from primitives import GoToPoint
from sim import Body, Recording, Replay, reach, way_gone
from specs import BoundTask

AMPLE = 0.75  # share of what is allowed that a way may use up, to be called comfortable
LOOKS = 20  # at the geometry of a movement
BEYOND, NEARLY = 20.0, 4.0  # costs of a measure beyond its limit, and of one that is near to it
FAR = 0.08  # of the palm from its goal: such a way is not looked at any further [m]
MISSED = 1e4  # cost of that: more than of anything else
HOPELESS = 150.0  # cost from which on it does not matter how a movement looks
FAST = 0.15  # cost of the hand's peak speed [s/m]
BENT = 2.0  # cost of a joint near the end of its range
ROOMY = 0.012  # miss of the hand that goes next, by inverse kinematics, that hinders nobody [m]
HINDERED, MOST_HINDERED = 600.0, 18.0  # cost of a miss beyond that [1/m], and the most it costs
EASY = 0.85  # share of a joint's range, from its middle, that is not near the end


@dataclass(frozen=True)
class Grade:
    """Of one way to do a sub-task."""

    passes: bool  # by the judge
    comfortable: bool  # it passes with room to spare, and goes round everything
    cost: float


FAILED = Grade(passes=False, comfortable=False, cost=np.inf)


def hindered(
    mark: Grade, recording: Recording | None, task: BoundTask, subtask: str, other: str
) -> Grade:
    """The grade of a way, knowing whether it leaves room for the hand that goes next.

    Inverse kinematics tells by how much that hand misses its goal beside the arm, as it is in
    the end. That costs less than failing, and more than most else.

    Args:
        mark: the grade for itself.
        recording: of the way; None: it is not looked at, and the worst is taken for granted.
        task: that was done.
        subtask: whose way it is.
        other: the sub-task that begins while the goal is held: a go-to-point of another arm.
    """
    if recording is None:
        return replace(mark, comfortable=False, cost=mark.cost + MOST_HINDERED)
    body, does = task.body_for(other), task.graph.subtasks[other].does
    assert isinstance(does, GoToPoint)
    end = next(s.end for s in recording.spans if s.name == subtask)
    posture = recording.qpos[recording.row(end)]
    _, (miss,) = reach(body, body.arm(does.limb), [does.palm_goal(body)], posture=posture)
    short = max(0.0, float(miss) - ROOMY)
    return replace(
        mark,
        comfortable=mark.comfortable and short == 0.0,
        cost=mark.cost + min(HINDERED * short, MOST_HINDERED),
    )


def grade(
    recording: Recording | None, task: BoundTask, subtask: str, *, freed: bool = False
) -> Grade:
    """Grade the recording of a sub-task that moves a hand.

    The judge's own measures come first: of the sub-task, of those before it whose goals are
    held meanwhile, of those after it that are over, and those of every run. Then the movement is
    looked at: how near the arm comes to what it should keep away from, how far hand and joints
    travel, how fast.

    Args:
        recording: of the sub-task and a little more; None if it broke off.
        task: that was done.
        subtask: which of its sub-tasks: one that is done by go-to-point.
        freed: whether another limb moves on as soon as it is over, and may give way: then it is
            wished, and not demanded, that the palm settles beside that limb.
    """
    if recording is None:
        return FAILED
    body, miss = task.body_for(subtask), _miss(recording, task, subtask)
    if not miss < FAR:
        return Grade(passes=False, comfortable=False, cost=MISSED * miss / FAR)
    replay = Replay(recording)
    judgement = judge(recording, task.spec, replay)
    own = next(v for v in judgement.verdicts if v.subtask.name == subtask)
    does = own.subtask.does
    assert isinstance(does, GoToPoint)  # else it would have missed
    held = _held(task, recording, subtask)
    others = [m for v in judgement.verdicts if v.subtask.name in held for m in v.measures]
    later = [v for v in judgement.verdicts if v.span.start >= own.span.end - EARLY]
    others += [measure for v in later for measure in v.measures[:1]]
    reached = own.measures[:1] if freed else own.measures
    measures = [*reached, *judgement.checks, *others]
    shares = np.array([_share(m) for m in measures])
    cost = float(
        np.sum(NEARLY * np.maximum(0.0, shares - AMPLE))
        + np.sum(np.where(shares > 1.0, BEYOND * shares, 0.0))
    )
    if cost > HOPELESS:
        return Grade(passes=False, comfortable=False, cost=cost + HOPELESS)
    cost += sum(NEARLY * max(0.0, _share(m) - AMPLE) for m in own.measures[len(reached) :])
    arm, goal = body.arm(does.limb), does.palm_goal(body)
    moving = slice(recording.row(own.span.start), recording.row(own.span.end) + 1)
    palm = replay.site(arm.limb.palm).position[moving]
    postures = recording.qpos[moving]
    rows = np.unique(np.linspace(0, len(palm) - 1, LOOKS).astype(int))
    way = way_gone(body, arm, goal, palm[rows], postures[rows])
    cost += way.cost + FAST * float(speed(palm, recording.timestep).max())
    cost += BENT * _bent(body, postures[-1], arm.dofs)
    passes = all(measure.success for measure in measures)
    comfortable = passes and bool((shares <= AMPLE).all()) and way.clearance > 0.0
    return Grade(passes, comfortable, cost)


def _miss(recording: Recording, task: BoundTask, subtask: str) -> float:
    """By how much the palm misses its goal in the end [m]; nothing else is looked at."""
    does = task.graph.subtasks[subtask].does
    span = next(s for s in recording.spans if s.name == subtask)
    if not isinstance(does, GoToPoint) or not np.isfinite(span.end):
        return np.inf
    end = recording.row(span.end)
    rows = {name: getattr(recording, name)[end : end + 1] for name in ("time", "qpos", "qvel")}
    last = Replay(replace(recording, **rows))
    palm = last.site(task.body.arm(does.limb).limb.palm).position
    return float(np.linalg.norm(palm - last.point(does.palm_goal(task.body).place)))


def _held(task: BoundTask, recording: Recording, subtask: str) -> set[str]:
    """Sub-tasks that were over as the recording began, and whose goals are still held.

    Not those whose goal is on what the sub-task itself moves: it cannot help to take it away.
    """
    claimed = claims(task)
    begun = {s.name: s for s in recording.spans if np.isfinite(s.start)}
    return {
        name
        for name, span in begun.items()
        if span.end <= recording.time[0] + recording.timestep
        and not carries(task, claimed[subtask], name)
        and not any(
            other.start > span.start and claimed[name] & claimed[other.name]
            for other in begun.values()
        )
    }


def _share(measure: Measure) -> float:
    """How much of what is allowed is used up; at most ten times that."""
    share = measure.value / measure.limit
    return min(share, 10.0) if np.isfinite(share) else 10.0


def _bent(body: Body, qpos: np.ndarray, dofs: np.ndarray) -> float:
    """How near the joints of an arm are to the ends of their ranges, 0 if none is."""
    low, high = (limit[dofs] for limit in body.range)
    if not np.isfinite(low).all() or not np.isfinite(high).all():
        return 0.0
    off = np.abs(qpos[body.qpos_of_dof[dofs]] - 0.5 * (low + high)) / (0.5 * (high - low))
    return float(np.sum(np.maximum(0.0, (off - EASY) / (1.0 - EASY)) ** 2))

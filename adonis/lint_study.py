"""Verdicts of the lint against simulation, on tasks that are drawn at random.

    python -m adonis.lint_study [TASKS] [SEED]

Each task is linted first and simulated then. What is true comes from the recording:

* a goal is out of reach if the palm comes within 15 mm of it from none of eight starts in four
  seconds, by two controllers, and by way of a place outside where there is a surface;
* a time is too short if the judge fails the sub-task, or a joint passes its speed limit;
* a way collides if links touch that must not;
* a range is passed if the joint runs into its end;
* a sub-task can never begin if it does not from any of eight starts, though the hand is sent to
  where its condition would hold;
* primitives fight if the joints settle elsewhere.

The margins of the lint were chosen on seeds below 10 000; the table is of those from 10 000 on.
"""

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adonis.dancing import random_start, run_task
from adonis.judging import judge
from primitives import (
    CompensateGravity,
    GetPosture,
    GoToPoint,
    Oscillate,
    Place,
    Primitive,
    Swing,
    ViaPlace,
    ViaPosture,
)
from sim import Body, Recording, Replay, World, adonis, clearance, clearances
from specs import (
    Background,
    BoundTask,
    Condition,
    Finding,
    Group,
    SpecError,
    SubTask,
    TaskSpec,
    bind_task,
    lint_task,
)
from specs.tolerances import TOUCH_BEFORE_NEXT

FloatArray = NDArray[np.float64]

FIRST = 10_000  # seeds below this are for choosing margins
STARTS = 8
AMPLE = 4.0  # [s]
OUTSIDE = 0.20  # [m] from the surface, a via point
CALM = 1.5  # [s] for ways that are looked at for collisions
ENOUGH = 0.7  # of the shortest time does not work
DRAWN, ROUNDS = 256, 8  # postures that are drawn at a time, and how often
SETTLED = 0.5  # [deg] off where a joint was asked to be
LOOK_EVERY = 3  # rows from one look at the distances to the next
SHARES = {"out of reach": 0.25, "too fast": 0.25, "collision": 0.2, "joint limit": 0.14,
          "never": 0.08, "fight": 0.08}  # of the tasks  # fmt: skip
MARKS = ("head.back", "head.right", "head.front", "chest.front", "belly.front", "left_ribs",
         "right_ribs", "left_hip", "right_hip", "left_shoulder.top",
         "right_shoulder.top")  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One task: what the lint said, and what was true."""

    kind: str
    seed: int
    said: bool
    true: bool
    # Of a finding that says what to do instead: whether that works, and (of a time) whether
    # less does not.
    advice: tuple[bool, ...] = ()


def study(tasks: int, seed: int = FIRST) -> list[Case]:
    """That many tasks of all kinds."""
    body = adonis()
    return [
        TRIES[kind](body, seed + k)
        for kind, share in SHARES.items()
        for k in range(max(1, round(share * tasks)))
    ]


# --- goals ---------------------------------------------------------------------------------


def try_goal(body: Body, seed: int) -> Case:
    """A goal of the right hand, near and beyond its reach, or in the body."""
    rng = np.random.default_rng(seed)
    task = _task(body, [SubTask(name="go", does=_goal(body, rng), seconds=AMPLE)])
    said = _has(lint_task(task), "out-of-reach", "inside-body")
    return Case("out of reach", seed, said, not _reached(task, seed))


def _goal(body: Body, rng: np.random.Generator) -> GoToPoint:
    arm = body.arm("right_arm")
    if rng.random() < 0.4:
        place = Place(near=str(rng.choice(MARKS)), away=float(rng.uniform(-0.08, 0.12)))
        return GoToPoint(limb=arm.name, to=place)
    shoulder = body.at_home(arm.upper_arm, np.zeros(3)) - body.at_home(arm.root, np.zeros(3))
    way = rng.standard_normal(3)
    way[0] = abs(way[0])
    far = rng.uniform(0.6, 1.15) * body.reach(arm) * way / np.linalg.norm(way)
    return GoToPoint(limb=arm.name, to=Place(point=_vector(shoulder + far)))


def _reached(task: BoundTask, seed: int) -> bool:
    """Whether any of several starts and ways of doing it brings the palm to its goal."""
    starts, does = _starts(task, seed), task.spec.subtasks[0].does
    assert isinstance(does, GoToPoint)
    ways: list[dict[str, Any]] = [{}, {"controller": "pd-servo"}]
    if isinstance(does.to, Place) and does.to.near is not None:  # from outside, and facing it
        outside = ViaPlace(near=does.to.near, away=OUTSIDE)
        inwards = tuple(-task.body.from_link(*_normal(task.body, does.to.near)))
        ways.append({"via": (outside,), "palm": inwards})
    for way in ways:
        changed = does.model_copy(update=way)
        subtask = task.spec.subtasks[0].model_copy(update={"does": changed})
        spec = task.spec.model_copy(update={"subtasks": (subtask,)})
        runs = _run(bind_task(spec, task.body), starts)
        if min(_last_measure(r, spec) for r in runs) <= TOUCH_BEFORE_NEXT:
            return True
    return False


def _normal(body: Body, landmark: str) -> tuple[int, FloatArray]:
    spot = body.landmark(landmark)
    return spot.link, spot.normal


def _last_measure(recording: Recording, spec: TaskSpec) -> float:
    """How far the palm is from its goal in the end [m]."""
    (verdict,) = judge(recording, spec).verdicts
    return float(verdict.measures[-1].value)


# --- times ---------------------------------------------------------------------------------


def try_time(body: Body, seed: int) -> Case:
    """A posture or a reach of the right arm that is done in 1.5 s, in a time drawn at random."""
    rng = np.random.default_rng(seed)
    while True:
        does = _posture(body, rng) if rng.random() < 0.5 else _goal(body, rng)
        if _in_time(_timed(body, does, CALM)):  # so that nothing but time is short
            break
    task = _timed(body, does, float(np.exp(rng.uniform(np.log(0.1), np.log(1.0)))))
    short = [f for f in lint_task(task) if f.code == "too-fast"]
    advice: tuple[bool, ...] = ()
    if short:
        time = dict(short[0].numbers)["shortest"]
        advice = (
            _in_time(_timed(body, does, time)),
            not _in_time(_timed(body, does, ENOUGH * time)),
        )
    return Case("too fast", seed, bool(short), not _in_time(task), advice)


def _timed(body: Body, does: Primitive, seconds: float) -> BoundTask:
    return _task(body, [SubTask(name="go", does=does, seconds=seconds)])


def _in_time(task: BoundTask) -> bool:
    (recording,) = _run(task)
    fastest = np.abs(recording.qvel).max(axis=0) <= task.body.speed_limit
    (verdict,) = judge(recording, task.spec).verdicts
    return verdict.success and bool(fastest.all())


# --- ways ----------------------------------------------------------------------------------


def try_way(body: Body, seed: int) -> Case:
    """A way of the right hand from anywhere to a place beside the body, or to a posture."""
    rng = np.random.default_rng(seed)
    while True:
        task = _timed(body, _beside(body, rng), CALM)
        task = replace(task, start=random_start(body, task.start, 1, int(rng.integers(1 << 30)))[0])
        task.start[body.qpos_of_dof[body.joints("left_arm")]] = body.home[
            body.qpos_of_dof[body.joints("left_arm")]
        ]
        ends = _has(found := lint_task(task), "out-of-reach", "inside-body", "too-fast")
        if clearance(body, task.start) > 0.0 and not ends:
            break
    hits = [f for f in found if f.code == "collision"]
    advice: tuple[bool, ...] = ()
    round_ = _advised(body, task, hits[0]) if hits else None
    if round_ is not None:
        advice = (not _touches(round_),)
    return Case("collision", seed, bool(hits), _touches(task), advice)


def _beside(body: Body, rng: np.random.Generator) -> Primitive:
    if rng.random() < 0.3:
        return _posture(body, rng)
    away = float(rng.uniform(0.06, 0.15))
    return GoToPoint(limb="right_arm", to=Place(near=str(rng.choice(MARKS)), away=away))


def _advised(body: Body, task: BoundTask, hit: Finding) -> BoundTask | None:
    """The task with the via point that a finding names."""
    via = dict(hit.numbers).get("via")
    if via is None:
        return None
    does = task.spec.subtasks[0].does
    kind = ViaPlace if isinstance(does, GoToPoint) else ViaPosture
    changed = does.model_copy(update={"via": (kind.model_validate(via),)})
    return replace(_timed(body, changed, CALM), start=task.start)


def _touches(task: BoundTask) -> bool:
    (recording,) = _run(task, task.start)
    body = task.body
    mine = {body.map.limbs["right_arm"].upper_arm, *_links(body)}
    pairs = [pair for pair in body.map.keep_apart if set(pair) & mine]
    return bool(clearances(body, recording.qpos[::LOOK_EVERY], pairs).min() < 0.0)


def _links(body: Body) -> tuple[str, str]:
    limb = body.map.limbs["right_arm"]
    return limb.forearm, limb.hand


# --- ranges --------------------------------------------------------------------------------


def try_range(body: Body, seed: int) -> Case:
    """A posture or a swing of one joint about the end of its range."""
    rng = np.random.default_rng(seed)
    names = [body.dof_name(int(d)) for d in body.joints(["right_arm", "neck"])]
    joint = str(rng.choice([n for n in names if "neck" in n or "elbow" in n or "wrist_z" in n]))
    (dof,) = body.joints(joint)
    low, high = (float(np.rad2deg(limit[dof])) for limit in body.range)
    past = float(rng.uniform(-20.0, 20.0))
    swings = rng.random() < 0.4
    asked = high + past
    does: Primitive = GetPosture(joints=(joint,), posture={joint: asked})
    if swings:
        amplitude = 0.3 * (high - low)
        centre = asked - amplitude
        does = Oscillate(joints={joint: Swing(amplitude=amplitude)}, frequency=0.5,
                         centre={joint: centre}, ease=0.5)  # fmt: skip
    try:
        said = _has(lint_task(_timed(body, does, AMPLE)), "joint-limit")
    except SpecError as problem:
        said = problem.code == "joint-limit"
    # The same on a body that is told of no limits, moved in the world of one that has them.
    free = adonis(limits=False)
    task = replace(_timed(free, does, AMPLE), body=body)
    (recording,) = _run(task)
    angle = np.rad2deg(Replay(recording).angle(joint))
    reached = float(angle.max()) if swings else float(angle[recording.row(AMPLE)])
    return Case("joint limit", seed, said, reached >= high)


# --- conditions ----------------------------------------------------------------------------


def try_condition(body: Body, seed: int) -> Case:
    """A sub-task that begins only near a landmark, to which the hand is sent before."""
    rng = np.random.default_rng(seed)
    own = bool(rng.random() < 0.6)
    mark = "right_elbow.inside" if own else str(rng.choice(("left_hip", "right_hip", "head.back")))
    distance = float(rng.uniform(0.1, 0.4) if own else rng.uniform(0.02, 0.2))
    near = Condition(near=mark, limb="right_arm", distance=distance)
    send: Primitive = GoToPoint(limb="right_arm", to=Place(near=mark))
    if own:
        send = GetPosture(limb="right_arm", posture=_folded(body, mark, rng))
    rest = GetPosture(limb="right_arm", posture="rest")
    subtasks = [
        SubTask(name="send", does=send, seconds=AMPLE),
        SubTask(name="then", does=rest, seconds=1.0, if_=near),
    ]
    task = _task(body, subtasks)
    said = any(f.subtask == "then" and f.code == "never" for f in lint_task(task))
    runs = _run(task, _starts(task, seed))
    begun = any(s.outcome == "done" for r in runs for s in r.spans if s.name == "then")
    return Case("never", seed, said, not begun)


def _folded(body: Body, mark: str, rng: np.random.Generator) -> dict[str, float]:
    """Angles [deg] that bring the right palm as near to a mark on its own arm as it gets.

    They are drawn at random, then ever nearer to the best so far.
    """
    arm, spot = body.arm("right_arm"), body.landmark(mark)
    dofs, world = body.joints("right_arm"), World(body, DRAWN)
    low, high = (side[dofs] for side in body.range)
    best, spread = 0.5 * (low + high), 0.5 * (high - low)
    for _ in range(ROUNDS):
        drawn = np.clip(best + spread * rng.uniform(-1.0, 1.0, (DRAWN, len(dofs))), low, high)
        drawn[0] = best
        qpos = np.tile(body.home, (DRAWN, 1))
        qpos[:, body.qpos_of_dof[dofs]] = drawn
        world.reset(qpos)
        palm, place = (
            world.state.xpos[:, on.link] + world.state.xmat[:, on.link].reshape(-1, 3, 3) @ on.point
            for on in (arm.palm, spot)
        )
        best = drawn[np.argmin(np.linalg.norm(palm - place, axis=1))]
        spread = 0.5 * spread
    return {body.dof_name(int(j)): float(np.rad2deg(q)) for j, q in zip(dofs, best, strict=True)}


# --- fights --------------------------------------------------------------------------------


def try_fight(body: Body, seed: int) -> Case:
    """A posture in the background that does not give way to that of a sub-task."""
    rng = np.random.default_rng(seed)
    wanted = _posture(body, rng, "neck")
    assert isinstance(wanted.posture, dict)
    off = float(rng.choice((0.3, 5.0, 15.0)))
    other = {k: float(a) - off * np.sign(float(a)) for k, a in wanted.posture.items()
             if not isinstance(a, str | tuple)}  # fmt: skip
    stays = Background(name="stays", does=GetPosture(joints=("neck",), posture=dict(other)))
    rule = str(rng.choice(("sum", "dominant", "none")))
    groups: tuple[Group, ...] = ()
    if rule != "none":
        weights: dict[str, Any] = {"weights": {"go": 2.0}} if rule == "dominant" else {}
        group = {"name": "both", "rule": rule, "members": ("go", "stays"), **weights}
        groups = (Group.model_validate(group),)
    task = _task(body, [SubTask(name="go", does=wanted, seconds=AMPLE)], (stays,), groups)
    said = _has(lint_task(task), "fight")
    (recording,) = _run(task)
    replay, end = Replay(recording), recording.row(AMPLE)
    missed = [abs(np.rad2deg(replay.angle(j)[end]) - float(a)) for j, a in wanted.posture.items()
              if not isinstance(a, str | tuple)]  # fmt: skip
    return Case("fight", seed, said, max(missed) > SETTLED)


TRIES: dict[str, Callable[[Body, int], Case]] = {
    "out of reach": try_goal, "too fast": try_time, "collision": try_way,
    "joint limit": try_range, "never": try_condition, "fight": try_fight,
}  # fmt: skip


# --- what they share -----------------------------------------------------------------------


def _task(
    body: Body,
    subtasks: Sequence[SubTask],
    beside: Sequence[Background] = (),
    groups: tuple[Group, ...] = (),
) -> BoundTask:
    upright = "waist" if any(b.name == "stays" for b in beside) else ("waist", "neck")
    names = (upright,) if isinstance(upright, str) else upright
    background = (
        Background(name="upright", does=GetPosture(joints=names, posture="upright")),
        Background(name="arms", does=GetPosture(joints=("right_arm", "left_arm"), posture="rest")),
        Background(name="weight", does=CompensateGravity()),
        *beside,
    )
    spec = TaskSpec(
        task="lint", coda=0.5, background=background, groups=groups, subtasks=tuple(subtasks)
    )
    return bind_task(spec, body)


def _posture(body: Body, rng: np.random.Generator, group: str = "right_arm") -> GetPosture:
    """Anywhere within nine tenths of the ranges."""
    low, high = (np.rad2deg(limit) for limit in body.range)
    dofs = body.joints(group).tolist()
    posture = {body.dof_name(d): float(0.9 * rng.uniform(low[d], high[d])) for d in dofs}
    return (
        GetPosture(joints=tuple(posture), posture=dict(posture))
        if group == "neck"
        else (GetPosture(limb=group, posture=dict(posture)))
    )


def _starts(task: BoundTask, seed: int) -> FloatArray:
    """Home, and some postures of the arms that touch nothing."""
    others = random_start(task.body, task.start, STARTS - 1, seed)
    whole: FloatArray = np.vstack([task.start, others])
    return whole


def _run(task: BoundTask, start: FloatArray | None = None) -> tuple[Recording, ...]:
    n = 1 if start is None or start.ndim == 1 else len(start)
    return run_task(task, n=n, threads=min(n, 2), start=start, contributions=False)


def _has(findings: Sequence[Finding], *codes: str) -> bool:
    return any(f.code in codes for f in findings)


def _vector(values: FloatArray) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z


def table(cases: Sequence[Case]) -> str:
    """Precision and recall, kind by kind."""
    lines = [
        "| kind | tasks | called | true | both | precision | recall |",
        "|---|---|---|---|---|---|---|",
    ]
    for kind in SHARES:
        own = [c for c in cases if c.kind == kind]
        called, true = [c for c in own if c.said], [c for c in own if c.true]
        both = sum(c.said and c.true for c in own)
        numbers = (len(own), len(called), len(true), both)
        shares = (_share(both, len(called)), _share(both, len(true)))
        lines.append(f"| {kind} | {' | '.join(map(str, numbers))} | {' | '.join(shares)} |")
    return "\n".join([*lines, "", *_advice(cases)])


def _share(part: int, whole: int) -> str:
    return f"{part / whole:.2f}" if whole else "-"


def _advice(cases: Sequence[Case]) -> Iterator[str]:
    timed = [c.advice for c in cases if c.kind == "too fast" and c.advice]
    if timed:
        works, less = (sum(a[k] for a in timed) for k in (0, 1))
        yield f"The shortest time given works in {works} of {len(timed)} tasks;"
        yield f"{ENOUGH:g} of it does not work in {less} of {len(timed)}."
    ways = [c.advice for c in cases if c.kind == "collision" and c.advice]
    if ways:
        yield f"The via point given avoids the collision in {sum(a[0] for a in ways)}"
        yield f"of {len(ways)} tasks."


if __name__ == "__main__":
    found = study(*[int(word) for word in sys.argv[1:3]] or (200,))
    print(table(found))
    wrong = [c for c in found if c.said != c.true or not all(c.advice)]
    for case in wrong:
        print(f"  {case.kind} {case.seed}: said {case.said}, true {case.true} {case.advice}")

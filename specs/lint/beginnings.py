"""never, event: sub-tasks that can never begin, and conditions that nothing can decide."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from primitives.primitive import FloatArray
from sim import moving_dofs
from specs.binding import BoundTask
from specs.conditions import Condition
from specs.graph import OTHERWISE, WHILE
from specs.lint.finding import Finding, Places, cm
from specs.lint.nearest import miss_itself, moved_from_home, nearest
from specs.task import SubTask
from specs.tolerances import size_of

Holds = Literal["never", "always", "perhaps"]
# [m] that is left to a condition that is called impossible, on Adonis: inverse kinematics is so
# exact, and the search for what a palm misses on its own arm.
SPARE, SPARE_ITSELF = 0.005, 0.001


def never_begins(task: BoundTask, places: Places) -> list[Finding]:
    """Sub-tasks that no run reaches, each with the condition that is the reason."""
    conditions = {c for s in task.spec.subtasks for c in s.conditions.values()}
    verdicts = {c: _judged(task, c) for c in conditions if c.event is None}
    found, closed, skipped = [], set[tuple[str, str]](), dict[str, str]()
    for name in task.graph.order:
        subtask = task.graph.subtasks[name]
        for key, condition in subtask.conditions.items():
            holds, why = verdicts.get(condition, ("perhaps", ""))
            if holds == "perhaps":
                continue
            untaken = _untaken(task, subtask, key, holds)
            closed |= {(name, other) for other in untaken}
            if key == "if" and holds == "never":
                skipped[name] = name
            finding = _said(places, subtask, key, holds, why)
            if finding is not None:
                found.append(finding)
    found += _consequences(task, places, closed, skipped)
    return found + list(_events(task, places))


def _judged(task: BoundTask, condition: Condition) -> tuple[Holds, str]:
    """Whether a palm can be so near to a landmark, and whether it can be farther."""
    body, distance = task.body, condition.distance or 0.0
    arm, mark = body.arm(condition.limb or ""), body.landmark(condition.near or "")
    where, shoulder = body.at_home(mark.link, mark.point), body.at_home(arm.upper_arm, _ORIGIN)
    apart = moving_dofs(body, mark.link) ^ moving_dofs(body, arm.root)
    if apart & set(arm.dofs.tolist()):
        least, spare = miss_itself(body, arm, mark), SPARE_ITSELF * size_of(body)
        return ("never", _at_best(least)) if distance < least - spare else ("perhaps", "")
    if apart & moved_from_home(task):
        return "perhaps", ""
    most = float(np.linalg.norm(where - shoulder)) + body.reach(arm)
    if distance > most:
        return "always", f"the palm is never farther from it than {cm(most)}"
    least, spare = nearest(body, arm, mark, None).miss, SPARE * size_of(body)
    return ("never", _at_best(least)) if distance < least - spare else ("perhaps", "")


_ORIGIN: FloatArray = np.zeros(3)


def _at_best(distance: float) -> str:
    return f"at best the palm comes within {cm(distance)}"


def _untaken(task: BoundTask, subtask: SubTask, key: str, holds: Holds) -> list[str]:
    """The sub-tasks to which one never leads."""
    graph = task.graph.graph
    kinds = {other: graph.edges[subtask.name, other]["kind"] for other in
             graph.successors(subtask.name)}  # fmt: skip
    other_ways = [key for key in subtask.conditions if key != "if"]
    if holds == "always":  # it neither gives up nor is passed by
        only = len(subtask.conditions) == 1 and (key == "if" or subtask.if_ is None)
        only = only and not (key == "if" and (other_ways or subtask.timeout))
        return [o for o, kind in kinds.items() if kind == OTHERWISE and only]
    if key == "if":
        passed = subtask.otherwise is not None
        return [o for o, kind in kinds.items() if kind == WHILE or (passed and kind != OTHERWISE)]
    return [o for o, kind in kinds.items() if subtask.otherwise is not None and kind == "after"]


def _said(places: Places, subtask: SubTask, key: str, holds: Holds, why: str) -> Finding | None:
    name, condition = subtask.name, subtask.conditions[key]
    below = (key, "until", "distance") if key == "repeat" else (key, "distance")
    then = f", so {subtask.otherwise} begins instead" if subtask.otherwise else ""
    if holds == "always":
        if key != "if" and subtask.otherwise is None:
            return None
        what = f"its '{key}' always holds ({condition}): {why}"
        advice = "leave the condition out, or take a shorter distance"
        return places.finding("warning", "never", name, what, advice, *below, condition=key)
    result = {
        "if": f"it can never begin{then}",
        "done": f"it always waits until it gives up{then}",
        "repeat": f"it is always repeated until it gives up{then}",
    }[key]
    return places.finding(
        "error" if key == "if" or not then else "warning", "never", name,
        f"{result}: {condition} can never hold, {why}",
        "take a longer distance, or another landmark", *below, condition=key,
    )  # fmt: skip


def _consequences(
    task: BoundTask, places: Places, closed: set[tuple[str, str]], skipped: dict[str, str]
) -> Iterator[Finding]:
    """What is never begun because what it comes after does not lead to it."""
    graph, dead = task.graph.graph, dict[str, str]()
    for name in task.graph.order:
        before = list(graph.predecessors(name))
        reasons = [p for p in before if (p, name) in closed or p in dead]
        reasons += [p for p in before if p in skipped and graph.edges[p, name]["kind"] == WHILE]
        if before and len(set(reasons)) == len(before):
            dead[name] = reasons[0]
            yield places.finding(
                "warning", "never", name,
                f"it never begins: {' and '.join(map(repr, dict.fromkeys(reasons)))} never"
                " lead(s) to it",
                "see there", because=reasons,
            )  # fmt: skip


def _events(task: BoundTask, places: Places) -> Iterator[Finding]:
    """`adonis run` sends no events."""
    what = {
        "if": "it is passed by unless a program sends {}",
        "done": "it waits until it gives up unless a program sends {}",
        "repeat": "it is repeated until it gives up unless a program sends {}",
    }
    for subtask in task.spec.subtasks:
        for key, condition in subtask.conditions.items():
            if condition.event is not None:
                yield places.finding(
                    "note", "event", subtask.name,
                    what[key].format(f"the event {condition.event!r}"),
                    f"'adonis run' sends none: arbiter.send({condition.event!r}) does",
                    key, event=condition.event,
                )  # fmt: skip

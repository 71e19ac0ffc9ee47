"""fight: primitives that pull the same joints to different places at the same time."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from primitives.posture_field import PostureField
from primitives.primitive import Field, FloatArray
from primitives.stay_field import StayField
from specs.binding import BoundTask
from specs.groups import Group, Rule, leaves
from specs.lint.finding import Finding, Places

ALIKE = np.deg2rad(1.0)  # goals that are nearer to each other do not fight


def fighting_primitives(task: BoundTask, places: Places) -> list[Finding]:
    """Pairs whose torques add up though each wants a place of its own for the same joints."""
    return list(_pairs(task, places))


def _pairs(task: BoundTask, places: Places) -> Iterator[Finding]:
    background = dict(zip((b.name for b in task.spec.background), task.background, strict=True))
    subtasks = dict(zip(task.graph.order, task.fields, strict=True))
    stays = {name: field for name, field in background.items() if len(field.claims)}
    # In the background everything is on; a grouped entry stays on under sub-tasks too.
    pairs = [(a, b) for a, b in combinations(stays, 2)]
    pairs += [(a, b) for a in stays if a in task.grouped for b in subtasks]
    for one, other in pairs:
        a, b = background[one], (background | subtasks)[other]
        shared = sorted(set(a.claims.tolist()) & set(b.claims.tolist()))
        if not shared or _rule(task.spec.groups, one, other) != "sum" or _alike(task, a, b, shared):
            continue
        joints = ", ".join(task.body.dof_name(d) for d in shared[:3])
        more = f" and {len(shared) - 3} more" if len(shared) > 3 else ""
        yield places.finding(
            "warning", "fight", other,
            f"it and {one!r} pull {joints}{more} at once, each to a place of its own; they will"
            " come to rest between the two",
            "leave those joints out of one of them, or put both into a group with the rule"
            " null-space or dominant",
            other=one, joints=[task.body.dof_name(d) for d in shared],
        )  # fmt: skip


def _alike(task: BoundTask, one: Field, other: Field, shared: list[int]) -> bool:
    """Whether two want the same of the joints that they share."""
    goals = [_goal(task, field) for field in (one, other)]
    if goals[0] is None or goals[1] is None:
        return False
    return bool(np.abs(goals[0][shared] - goals[1][shared]).max() < ALIKE)


def _goal(task: BoundTask, field: Field) -> FloatArray | None:
    """The angles (nv,) that a field wants; None if nobody can tell."""
    if isinstance(field, PostureField):
        goal: FloatArray = field.goal
        return goal
    if isinstance(field, StayField) and field in task.background:
        return task.start[task.body.qpos_of_dof]
    return None


def _rule(groups: tuple[Group, ...], one: str, other: str) -> Rule:
    """How the torques of two become one: the rule of the innermost group that has both."""
    for group in groups:  # inner ones come first
        members = [leaves(member, groups) for member in group.members]
        if any(one in m for m in members) and any(other in m for m in members):
            return group.rule
    return "sum"

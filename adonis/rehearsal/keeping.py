"""Rehearsals that are kept: what was found once need not be looked for again.

A file in the user's cache folder holds the ways of one task on one body, found by this very code.
It is written anew after each sub-task, so that a rehearsal that was interrupted goes on from
there. A cache that cannot be read or written is none, and no error.
"""

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from adonis.keeping import keep, kept_file, read_kept
from adonis.rehearsal.grading import Grade
from adonis.rehearsal.rehearsing import TURNS, Progress, rehearse
from adonis.rehearsal.searching import Rehearsed, with_ways
from primitives import GoToPoint
from sim import Body
from specs import (
    GONE,
    SpecError,
    TaskSpec,
    places_of_steps,
    resized,
    set_values,
    task_to_yaml,
)

WAY = ("upper_arm", "palm", "travel", "via")  # what a rehearsal fills in


def rehearsed(
    spec: TaskSpec,
    body: Body,
    *,
    seed: int = 0,
    afresh: bool = False,
    turns: int = TURNS,
    progress: Progress | None = None,
) -> tuple[TaskSpec, dict[str, Rehearsed]]:
    """The task with the ways filled in that it lacks, and those ways.

    Args:
        spec: the task.
        body: that is to do it.
        seed: of what is drawn.
        afresh: look for the ways again, even if they are in the user's cache.
        turns: how often the task is gone through at most.
        progress: told the share that is done and the sub-task that is on.

    Raises:
        SpecError: the task does not fit the body.
    """
    file = kept_file("rehearsals", spec, body, seed)
    ways = {} if afresh else _ways_in(read_kept(file), spec)

    def put_away(name: str, way: Rehearsed) -> None:
        ways[name] = way
        keep(file, _plain(ways))

    found = rehearse(
        spec, body, seed=seed, turns=turns, known=ways, progress=progress, found=put_away
    )
    done = with_ways(spec, {name: way.does for name, way in found.items()})
    return done.model_copy(update={"rehearse": False}), found


def task_text(spec: TaskSpec, found: Mapping[str, Rehearsed], text: str, size: float = 1.0) -> str:
    """A task file with the ways filled in.

    Args:
        spec: the task with the ways filled in.
        found: the ways.
        text: of the file that the task was read from; its comments stay. Where the task is not
            written there, sub-task by sub-task, it is written anew.
        size: how much larger the body of the ways is than that of the file, whose metres are kept.
    """
    try:
        places, changes = places_of_steps(text), dict[tuple[str | int, ...], object]()
        for name, way in found.items():
            written = resized(way.does, 1.0 / size).model_dump(mode="json", exclude_defaults=True)
            changes |= {(*places[name], key): written[key] for key in WAY if key in written}
        return set_values(text, {("rehearse",): GONE, **changes})
    except (SpecError, KeyError):  # what it says is written somewhere else
        return task_to_yaml(spec)


def _ways_in(kept: Any, spec: TaskSpec) -> dict[str, Rehearsed]:
    """The ways that a file has; none if there is none, or it is damaged."""
    names = {subtask.name for subtask in spec.subtasks}
    try:
        return {
            name: Rehearsed(
                GoToPoint.model_validate(way["does"]),
                Grade(**way["grade"]),
                int(way["tried"]),
                int(way["turns"]),
            )
            for name, way in kept.items()
            if name in names
        }
    except (ValueError, TypeError, KeyError, AttributeError, ValidationError):
        return {}


def _plain(ways: Mapping[str, Rehearsed]) -> dict[str, Any]:
    """Ways as JSON has them."""
    return {
        name: {
            "does": way.does.model_dump(mode="json", exclude_unset=True),
            "grade": vars(way.grade),
            "tried": way.tried,
            "turns": way.turns,
        }
        for name, way in ways.items()
    }

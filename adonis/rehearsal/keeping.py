"""Rehearsals that are kept: what was found once need not be looked for again.

A file in the user's cache folder holds the ways of one task on one body, found by this very code.
It is written anew after each sub-task, so that a rehearsal that was interrupted goes on from
there. A cache that cannot be read or written is none, and no error.
"""

import hashlib
import json
import os
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import platformdirs
from pydantic import ValidationError

from adonis.dancing import versions
from adonis.rehearsal.grading import Grade
from adonis.rehearsal.rehearsing import Progress, rehearse
from adonis.rehearsal.searching import Rehearsed, with_ways
from primitives import GoToPoint
from sim import Body
from specs import SpecError, TaskSpec, amended, task_to_yaml

CODE = Path(__file__).parents[2]
FLOORS = ("sim", "primitives", "specs", "arbiter", "adonis")
WAY = ("upper_arm", "palm", "travel", "via")  # what a rehearsal fills in


def rehearsed(
    spec: TaskSpec,
    body: Body,
    *,
    seed: int = 0,
    afresh: bool = False,
    progress: Progress | None = None,
) -> tuple[TaskSpec, dict[str, Rehearsed]]:
    """The task with the ways filled in that it lacks, and those ways.

    Args:
        spec: the task.
        body: that is to do it.
        seed: of what is drawn.
        afresh: look for the ways again, even if they are in the user's cache.
        progress: told the share that is done and the sub-task that is on.

    Raises:
        SpecError: the task does not fit the body.
    """
    file = _file(spec, body, seed)
    ways = {} if afresh or file is None else _read(file, spec)

    def keep(name: str, way: Rehearsed) -> None:
        ways[name] = way
        if file is not None:
            _write(file, ways)

    found = rehearse(spec, body, seed=seed, known=ways, progress=progress, found=keep)
    done = with_ways(spec, {name: way.does for name, way in found.items()})
    return done.model_copy(update={"rehearse": False}), found


def task_text(spec: TaskSpec, found: Mapping[str, Rehearsed], text: str) -> str:
    """A task file with the ways filled in.

    Args:
        spec: the task with the ways filled in.
        found: the ways.
        text: of the file that the task was read from; its comments stay. Where the task is not
            written there, sub-task by sub-task, it is written anew.
    """
    changes: dict[str, dict[str, object]] = {"": {"rehearse": None}}
    for name, way in found.items():
        written = way.does.model_dump(mode="json", exclude_defaults=True)
        changes[name] = {key: written[key] for key in WAY if key in written}
    try:
        return amended(text, changes)
    except SpecError:
        return task_to_yaml(spec)


def _file(spec: TaskSpec, body: Body, seed: int) -> Path | None:
    """Where the ways of a task are kept; nowhere if it uses primitives of somebody's own."""
    steps = (*spec.background, *spec.subtasks)
    if any(type(step.does).__module__.split(".")[0] != "primitives" for step in steps):
        return None
    said = [task_to_yaml(spec), body.xml, body.map.model_dump(mode="json"), versions(), seed]
    key = hashlib.sha256((json.dumps(said, sort_keys=True) + _code()).encode()).hexdigest()
    return platformdirs.user_cache_path("adonis") / "rehearsals" / f"{key[:32]}.json"


@lru_cache(maxsize=1)
def _code() -> str:
    """A digest of this program: other code may find other ways."""
    digest = hashlib.sha256()
    for path in sorted(path for floor in FLOORS for path in (CODE / floor).rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _read(file: Path, spec: TaskSpec) -> dict[str, Rehearsed]:
    """The ways in a file; none if there is none, or it is damaged."""
    names = {subtask.name for subtask in spec.subtasks}
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
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
    except (OSError, ValueError, TypeError, KeyError, AttributeError, ValidationError):
        return {}


def _write(file: Path, ways: Mapping[str, Rehearsed]) -> None:
    kept = {
        name: {
            "does": way.does.model_dump(mode="json", exclude_unset=True),
            "grade": vars(way.grade),
            "tried": way.tried,
            "turns": way.turns,
        }
        for name, way in ways.items()
    }
    draft = file.with_suffix(f".{os.getpid()}.tmp")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        draft.write_text(json.dumps(kept), encoding="utf-8")
        os.replace(draft, file)
    except OSError:
        draft.unlink(missing_ok=True)

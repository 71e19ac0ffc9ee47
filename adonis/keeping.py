"""What was found once need not be looked for again: files in the user's cache folder.

A file is named by a digest of all that its content follows from, this very program among it. A
cache that cannot be read or written is none, and no error.
"""

import hashlib
import json
import os
from functools import lru_cache
from pathlib import Path
from typing import Any

import platformdirs

from adonis.dancing import versions
from sim import Body
from specs import TaskSpec, task_to_yaml

CODE = Path(__file__).parents[1]
FLOORS = ("sim", "primitives", "specs", "arbiter", "adonis")


def kept_file(kind: str, spec: TaskSpec, body: Body, *more: Any) -> Path | None:
    """Where something about a task on a body is kept.

    Args:
        kind: of thing: the name of a folder.
        spec: the task.
        body: the body.
        more: what else it follows from, as JSON has it.

    Returns:
        The file; None if the task uses primitives of somebody's own, whose code is not known.
    """
    steps = (*spec.background, *spec.subtasks)
    if any(type(step.does).__module__.split(".")[0] != "primitives" for step in steps):
        return None
    said = [task_to_yaml(spec), body.xml, body.map.model_dump(mode="json"), versions(), *more]
    key = hashlib.sha256((json.dumps(said, sort_keys=True) + _code()).encode()).hexdigest()
    return platformdirs.user_cache_path("adonis") / kind / f"{key[:32]}.json"


def read_kept(file: Path | None) -> Any:
    """What is in a file; None if there is none, or it is damaged."""
    try:
        return None if file is None else json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def keep(file: Path | None, content: Any) -> None:
    """Write a file, whole or not at all."""
    if file is None:
        return
    draft = file.with_suffix(f".{os.getpid()}.tmp")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        draft.write_text(json.dumps(content), encoding="utf-8")
        os.replace(draft, file)
    except OSError:
        draft.unlink(missing_ok=True)


@lru_cache(maxsize=1)
def _code() -> str:
    """A digest of this program: other code may find something else."""
    digest = hashlib.sha256()
    for path in sorted(path for floor in FLOORS for path in (CODE / floor).rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()

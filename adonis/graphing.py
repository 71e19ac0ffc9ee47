"""The task graph on the terminal, in any of its formats, and as a timeline."""

from collections.abc import Iterable
from pathlib import Path

from rich.console import Console

from adonis.arguments import fit, whose
from adonis.timeline import timeline
from adonis.timeline_text import print_timeline
from primitives import Primitive
from sim import Recording
from specs import (
    SpecError,
    bind_task,
    build_graph,
    claims_of,
    find_body,
    library,
    load_task,
    task_from_text,
    to_dot,
    to_graphml,
    to_json,
    to_mermaid,
)

PRINTERS = {"mermaid": to_mermaid, "dot": to_dot, "graphml": to_graphml, "json": to_json}


def print_graph(
    task: str,
    style: str,
    body: str | None,
    tempo: float | None = None,
    primitives: Iterable[type[Primitive]] = (),
) -> None:
    """Print a task, or the folder of a run.

    Args:
        task: a name of the library, a file, or the folder of a run.
        style: `timeline` or one of `PRINTERS`.
        body: by name or by its file, of which claims are; default: the task's own.
        tempo: instead of the task's own.
        primitives: classes of one's own that the task may use.

    Raises:
        SpecError, BodyError: the task makes no sense.
        RecordingError: the folder holds no recording.
    """
    recording = None
    if task not in library() and task.strip() and Path(task).is_dir():
        if tempo is not None:
            raise SpecError("--tempo goes with a task; a run has had its own", file=task)
        recording = Recording.load(task)
        text = str(recording.about["task"])
        spec, document = task_from_text(text, f"the task of {task}", primitives=primitives)
    else:
        spec, document = load_task(task, primitives=primitives)
    if recording is not None and style == "timeline":
        print_timeline(Console(), timeline(build_graph(spec, document), recording))
        return
    on = find_body(whose(spec, body))
    if recording is None:
        spec = fit(spec, on, document, tempo)
    if style == "timeline":
        print_timeline(Console(), timeline(build_graph(spec, document)))
        return
    bound = bind_task(spec, on, document)
    print(PRINTERS[style](bound.graph, claims_of(bound)), end="")

"""One run as the command line does it: the task, a bar meanwhile, and what is left behind."""

from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from adonis.dancing import FloatArray, Stopped, run_task
from adonis.reporting import Results, prepare_folder, remove_folders, write_results
from sim import Recording
from specs import BoundTask

FEWEST_ROWS = 2  # of a recording that is worth keeping: fewer are no movement


def perform(
    console: Console,
    bound: BoundTask,
    folder: Path,
    *,
    start: FloatArray | None,
    seed: int,
    video: bool,
) -> tuple[Results, Stopped | None]:
    """Do a task and write its results, with a bar that says how far it is.

    Args:
        console: where the bar is shown.
        bound: the task.
        folder: where the results go; it is left as it was if nothing was recorded.
        start: posture to begin in; default: the task's.
        seed: see `run_task`.
        video: whether to render an MP4 as well.

    Returns:
        The results, and why the run broke off if it did.

    Raises:
        Stopped: before anything was recorded.
        OutputError, RecordingError: a file cannot be written.
    """
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
    )
    part = folder / "recording.npz.part"
    recordings: tuple[Recording, ...] = ()
    stopped: Stopped | None = None
    made: tuple[Path, ...] = ()
    ours = False
    try:
        made = prepare_folder(folder)
        ours = not part.exists()
        with Progress(*columns, console=console, transient=True) as bar:
            shown = bar.add_task("preparing the controllers (slow only the first time)", total=1.0)

            def moving(share: float, subtask: str) -> None:
                bar.update(shown, completed=share, description=subtask or "holding")

            def writing(what: str, share: float) -> None:
                bar.update(shown, completed=share, description=f"writing: {what}")

            try:
                recordings = run_task(bound, start=start, seed=seed, part=part, progress=moving)
            except Stopped as problem:
                if len(problem.recordings[0].time) < FEWEST_ROWS:
                    raise
                stopped, recordings = problem, problem.recordings
            results = write_results(
                recordings[0], bound.spec, folder, video=video and not stopped, progress=writing
            )
            part.unlink(missing_ok=True)
    finally:
        if not recordings:
            if ours:
                part.unlink(missing_ok=True)
            remove_folders(made)
    return results, stopped

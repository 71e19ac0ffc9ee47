"""Runs as the command line does them: a bar meanwhile, and what is left behind."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from rich.console import Console

from adonis.comparison.human import Human
from adonis.comparison.report import compare_and_write
from adonis.dancing import FloatArray, Stopped, run_task
from adonis.errors import InputError
from adonis.morphing import Becoming, morph
from adonis.progress import COMPILING, KEPT, progress
from adonis.rehearsal.keeping import rehearsed
from adonis.rehearsal.searching import Rehearsed
from adonis.reporting import Results, prepare_folder, remove_folders, write_results
from adonis.showing import print_comparison
from primitives import Primitive
from sim import Body, Recording, unknown
from specs import BestEffort, BoundTask, bind_task

FEWEST_ROWS = 2  # of a recording that is worth keeping: fewer are no movement


def perform(
    console: Console,
    bound: BoundTask,
    folder: Path,
    *,
    start: FloatArray | None,
    seed: int,
    video: bool,
    events: Sequence[tuple[float, str]] = (),
    becoming: Sequence[tuple[float, BoundTask]] = (),
    effort: BestEffort | None = None,
) -> tuple[Results, Stopped | None]:
    """Do a task and write its results, with a bar that says how far it is.

    Args:
        console: where the bar is shown.
        bound: the task.
        folder: where the results go; it is left as it was if nothing was recorded.
        start: posture to begin in; default: the task's.
        seed: see `run_task`.
        video: whether to render an MP4 as well.
        events: see `run_task`.
        becoming: see `run_task`.
        effort: what was asked for, if the task is only as far as the body can do that.

    Returns:
        The results, and why the run broke off if it did.

    Raises:
        Stopped: before anything was recorded.
        OutputError, RecordingError: a file cannot be written.
    """
    part = folder / "recording.npz.part"
    recordings: tuple[Recording, ...] = ()
    stopped: Stopped | None = None
    made: tuple[Path, ...] = ()
    ours = False
    try:
        made = prepare_folder(folder)
        ours = not part.exists()
        with progress(console, COMPILING) as tell:
            try:
                recordings = run_task(
                    bound, start=start, seed=seed, part=part, events=events, becoming=becoming,
                    progress=lambda share, subtask: tell(share, subtask or "holding"),
                )  # fmt: skip
            except Stopped as problem:
                if len(problem.recordings[0].time) < FEWEST_ROWS:
                    raise
                stopped, recordings = problem, problem.recordings
            asked = bound.spec if effort is None else effort.to_judge(bound.spec)
            results = write_results(
                recordings[0], asked, folder, fitness=effort.fitness if effort else (),
                video=video and not stopped,
                progress=lambda what, share: tell(share, f"writing: {what}"),
            )  # fmt: skip
            part.unlink(missing_ok=True)
    finally:
        if not recordings:
            if ours:
                part.unlink(missing_ok=True)
            remove_folders(made)
    return results, stopped


def events_of(asked: Iterable[str], known: Sequence[str]) -> list[tuple[float, str]]:
    """When to send what, from `NAME@SECONDS`.

    Args:
        asked: one for each time that something is sent.
        known: the events that conditions of the task name.

    Raises:
        InputError: no such event, or no such time.
    """
    found = []
    for said in asked:
        name, _, when = said.rpartition("@")
        try:
            seconds = float(when)
        except ValueError:
            seconds = -1.0
        if not name or not 0.0 <= seconds < np.inf:
            raise InputError(f"--send: expected EVENT@SECONDS, such as go@1.5, not {said!r}")
        if name not in known:
            raise InputError(f"--send: {unknown('event', name, known)}")
        found.append((seconds, name))
    return found


def perform_morph(
    console: Console, bound: BoundTask, to: str, *, limits: bool, contacts: bool
) -> Becoming:
    """Make the bodies on the way to another person, with a bar: see `morph`."""
    with progress(console, "") as tell:
        return morph(bound, to, limits=limits, contacts=contacts, progress=tell)


def perform_rehearsal(
    console: Console, bound: BoundTask, *, seed: int, afresh: bool
) -> tuple[BoundTask, dict[str, Rehearsed]]:
    """Find the ways that a task lacks, with a bar: see `rehearsed`."""
    try:
        with progress(console, "rehearsing (minutes, the first time)") as tell:
            spec, found = rehearsed(
                bound.spec, bound.on, seed=seed, afresh=afresh,
                progress=lambda share, subtask: tell(share, f"rehearsing: {subtask}"),
            )  # fmt: skip
    except KeyboardInterrupt:
        console.print(KEPT)
        raise
    return bind_task(spec, bound.on), found


def perform_comparison(
    task: str,
    body: Body,
    folder: Path,
    *,
    dancers: Sequence[str],
    human: Human | None,
    quick: bool,
    seed: int,
    primitives: Sequence[type[Primitive]] = (),
) -> None:
    """Compare controllers and write the report, with a bar and a table: see `compare_and_write`.

    Raises:
        InputError, OutputError, SimError, SpecError, Stopped: see `compare_and_write`; a folder
            that was made is gone again.
    """
    console = Console()
    made = prepare_folder(folder)
    done = False
    try:
        with progress(console, COMPILING) as tell:
            comparison, written = compare_and_write(
                task, body, folder, dancers=dancers, human=human, quick=quick, seed=seed,
                primitives=primitives, progress=lambda what, share: tell(share, what),
            )  # fmt: skip
        done = True
    finally:
        if not done:
            remove_folders(made)
    print_comparison(console, comparison, written)

"""What a run leaves behind: the folder with recording, model, task, report and pictures."""

import json
import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from adonis.attribution import Attribution, attribute
from adonis.attribution_figure import plot_attribution
from adonis.errors import OutputError
from adonis.fitness import notes
from adonis.judging import judge, torque_steps
from adonis.plotting import plot_hand_speed, plot_torque
from adonis.timeline import timeline
from adonis.timeline_figure import plot_timeline
from adonis.transitions import transitions
from adonis.verdicts import Judgement
from primitives import Follow, GoToPoint
from sim import (
    BodyMap,
    Closest,
    Frame,
    NoDisplay,
    Recording,
    Replay,
    render_filmstrip,
    render_video,
)
from specs import Fitness, TaskSpec, build_graph


@dataclass(frozen=True)
class Results:
    """The files of a run, by what they are.

    Notices say which primitives fought, and which files could not be made.
    """

    folder: Path
    judgement: Judgement
    files: dict[str, Path]
    notices: tuple[str, ...]


def prepare_folder(folder: Path) -> tuple[Path, ...]:
    """Make a folder for results.

    Returns:
        The folders that had to be made for it, the innermost first.

    Raises:
        OutputError: nothing can be written there.
    """
    made: tuple[Path, ...] = ()
    try:
        made = tuple(path for path in (folder, *folder.parents) if not path.exists())
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        remove_folders(made)
        raise OutputError(f"cannot make the folder {folder}: {problem.strerror}") from None
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(f"cannot write into the folder {folder}")
    return made


def remove_folders(made: Iterable[Path]) -> None:
    """Remove folders that were made for nothing, the innermost first, if they are empty."""
    for folder in made:
        with suppress(OSError):
            folder.rmdir()


def prepare_file(path: Path) -> None:
    """Make sure that a text file can be written, before work is put into what it is to hold.

    Raises:
        OutputError: it cannot.
    """
    prepare_folder(path.parent)
    if path.is_dir():
        raise OutputError(f"cannot write {path}: it is a folder")
    draft = _draft(path)
    try:
        draft.touch()
        draft.unlink()
    except OSError as problem:
        raise OutputError(f"cannot write {path}: {problem.strerror}") from None


def write_results(
    recording: Recording,
    spec: TaskSpec,
    folder: Path,
    *,
    fitness: Sequence[Fitness] = (),
    video: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> Results:
    """Judge a recording and write everything that a run leaves behind.

    Args:
        recording: what happened.
        spec: the task that was asked for: as it ran, unless the body can only do part of it.
        folder: where to; it exists.
        fitness: what the body can do of the task, if it was done as far as that.
        video: whether to render an MP4 as well.
        progress: told what is being written and how far it is.

    Raises:
        OutputError, RecordingError: a file cannot be written.
    """

    def tell(what: str, share: float = 0.0) -> None:
        if progress is not None:
            progress(what, share)

    files = {
        "recording": folder / "recording.npz",
        "model": folder / "model.xml",
        "task": folder / "task.yaml",
        "report": folder / "report.json",
    }
    tell("recording")
    recording.save(files["recording"])
    write_text(files["model"], recording.model_xml)
    write_text(files["task"], str(recording.about["task"]))
    tell("judging")
    replay = Replay(recording)
    judgement = judge(recording, spec, replay, fitness=fitness)
    found = attribute(recording, replay)
    report = report_of(recording, spec, judgement, replay, found)
    write_text(files["report"], json.dumps(report, indent=2, ensure_ascii=False) + "\n")
    tell("plots")
    names = BodyMap.model_validate(recording.about["body_map"])
    files["hand speed"] = folder / "hand_speed.png"
    plot_hand_speed(recording, replay, names, files["hand speed"])
    files["torque"] = folder / "torque.png"
    plot_torque(recording, replay, names, files["torque"])
    files["timeline"] = folder / "timeline.png"
    plot_timeline(timeline(build_graph(spec), recording), files["timeline"])
    if found.primitives:
        files["attribution"] = folder / "attribution.png"
        plot_attribution(recording, replay, names, found, files["attribution"])
    notices = [*notes(fitness), *found.warnings]
    if (became := report["morph"]) is not None:
        notices.append(
            f"it became {became['to']} in {became['bodies']} bodies; at each step kinetic energy"
            f" changed by at most {became['largest_kinetic_energy_change']:.3f} J, and a palm was"
            f" moved by at most {1000.0 * became['largest_shift_of_a_palm']:.2f} mm"
        )
    palms = [limb.palm for limb in names.limbs.values()]
    try:
        tell("filmstrip")
        strip = folder / "filmstrip.png"
        render_filmstrip(recording, filmstrip_frames(recording, spec), strip, palms=palms)
        files["filmstrip"] = strip
        if video:
            clip = folder / "video.mp4"
            render_video(recording, clip, progress=lambda share: tell("video", share))
            files["video"] = clip
    except NoDisplay as notice:
        notices.append(str(notice))
    return Results(folder, judgement, files, tuple(notices))


def report_of(
    recording: Recording,
    spec: TaskSpec,
    judgement: Judgement,
    replay: Replay,
    found: Attribution,
) -> dict[str, Any]:
    """The report as plain data; times in seconds of the recording."""
    about = recording.about
    checks = {c.what: c for c in judgement.checks}
    names = BodyMap.model_validate(about["body_map"])
    nearest = clearance(recording, spec)
    return {
        "success": judgement.success,
        "task": spec.task,
        "title": spec.title,
        "body": about["body"],
        "morph": morph_of(recording, replay, names),
        "tempo": spec.tempo,
        "seed": about["seed"],
        "duration": float(recording.time[-1]) if len(recording.time) else 0.0,
        "timestep": recording.timestep,
        "complete": recording.complete,
        "passed": judgement.passed,
        "subtasks": [v.as_dict() for v in judgement.verdicts],
        "checks": [c.as_dict() for c in judgement.checks],
        "worst_penetration": checks["worst penetration"].value,
        "smallest_clearance": nearest.distance,
        "smallest_clearance_between": list(nearest.geoms),
        "largest_hand_over_torque_step": checks["hand-over torque step"].value,
        "largest_torque_step": _largest_step(recording),
        "peak_torque_share": checks["peak torque"].value,
        "torque_saturation": saturation(recording),
        "warnings": list(found.warnings),
        "transitions": [t.as_dict() for t in transitions(recording, spec, replay)],
        "attribution": found.as_dict(),
        "versions": about["versions"],
    }


def clearance(recording: Recording, spec: TaskSpec) -> Closest:
    """Smallest distance of links that must not touch and that the task does not bring together."""
    names = BodyMap.model_validate(recording.about["body_map"])
    replay = Replay(recording)
    meant = set()
    for subtask in spec.subtasks:
        does = subtask.does
        if isinstance(does, GoToPoint | Follow) and isinstance(does.to, str):
            meant.add((names.limbs[does.limb].hand, replay.link_of_site(does.to)))
    pairs = [p for p in names.keep_apart if p not in meant and p[::-1] not in meant]
    return replay.clearance(pairs)


def filmstrip_frames(recording: Recording, spec: TaskSpec) -> list[Frame]:
    """One frame for each moment in which sub-tasks end; the last row if it came to none."""
    graph = build_graph(spec)
    last = float(recording.time[-1])
    moments: dict[int, list[tuple[int, str]]] = {}
    for number, span in enumerate(sorted_spans(recording), start=1):
        row = recording.row(span.end if np.isfinite(span.end) else last)
        moments.setdefault(row, []).append((number, span.name))
    frames = [
        Frame(
            float(recording.time[row]),
            ", ".join(str(number) for number, _ in ended)
            + "  "
            + "; ".join(graph.subtasks[name].words or name for _, name in ended),
            max(graph.lasts(name) for _, name in ended),
        )
        for row, ended in sorted(moments.items())
    ]
    return frames or [Frame(last, "the end")]


def sorted_spans(recording: Recording) -> list[Any]:
    """The sub-tasks that began, in the order in which they did."""
    return sorted((s for s in recording.spans if np.isfinite(s.start)), key=lambda s: s.first)


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all.

    Raises:
        OutputError: it cannot be written.
    """
    draft = _draft(path)
    try:
        draft.write_text(text, encoding="utf-8")
        os.replace(draft, path)
    except OSError as problem:
        with suppress(OSError):
            draft.unlink(missing_ok=True)
        raise OutputError(f"cannot write {path}: {problem.strerror}") from None


def morph_of(recording: Recording, replay: Replay, names: BodyMap) -> dict[str, Any] | None:
    """What became of a body that became others; None of one that stayed as it was."""
    kinetic, moved = replay.changes([limb.palm for limb in names.limbs.values()])
    if not len(kinetic):
        return None
    return {
        "to": recording.about["becomes"],
        "bodies": len(kinetic) + 1,
        "largest_kinetic_energy_change": float(np.abs(kinetic).max()),
        "largest_shift_of_a_palm": float(moved.max()),
    }


def _draft(path: Path) -> Path:
    return path.with_name(path.name + ".tmp")


def _largest_step(recording: Recording) -> float:
    """Largest change of a torque in 2 ms at any time, as a share of its limit."""
    limits = Replay(recording).torque_limits()
    return float(np.nanmax(torque_steps(recording, limits)))


def saturation(recording: Recording) -> float:
    """Share of the recorded steps in which any motor is at its limit."""
    at_limit = np.abs(Replay(recording).torque_share()) >= 1.0 - 1e-9  # never without a motor
    return float(at_limit.any(axis=1).mean())

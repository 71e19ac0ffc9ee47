"""Pictures of a recording: a filmstrip, a video.

Rendering happens in a process of its own, so that a machine without OpenGL, or with a broken
one, costs a run its pictures and nothing else.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.errors import NoDisplay
from sim.recording import Recording

VIEWS: dict[str, tuple[float, float]] = {  # azimuth, elevation [deg]
    "front": (180.0, -8.0),
    "oblique": (152.0, -10.0),
    "side": (90.0, -8.0),
    "back": (-28.0, -10.0),
}
PATIENCE = 600.0  # [s] for a whole job


@dataclass(frozen=True)
class Frame:
    """One picture of a filmstrip."""

    time: float  # [s]
    caption: str
    trail: float = 0.0  # the way of the palms over so many seconds before is drawn
    ghosts: int = 0  # so many moments of that time are shown faintly: a time-lapse


def render_filmstrip(
    recording: Recording,
    frames: Sequence[Frame],
    path: str | Path,
    *,
    view: str = "oblique",
    palms: Sequence[str] = (),
    columns: int = 6,
    size: tuple[int, int] = (320, 400),
) -> None:
    """Write a PNG of several moments of a recording, side by side.

    Args:
        recording: what is shown.
        frames: when, and what is written below.
        path: of the PNG.
        view: one of `VIEWS`.
        palms: sites whose way is drawn.
        columns: frames in a row.
        size: width and height of each frame [pixels].

    Raises:
        NoDisplay: this machine cannot render; one line says why.
    """
    job = {
        "what": "filmstrip",
        "frames": [(f.time, f.caption, f.trail, f.ghosts) for f in frames],
        "palms": list(palms),
        "columns": columns,
        "view": VIEWS[view],
        "size": size,
        "path": str(Path(path).absolute()),
    }
    render(recording, job)


def render_video(
    recording: Recording,
    path: str | Path,
    *,
    view: str = "oblique",
    fps: int = 30,
    size: tuple[int, int] = (640, 720),
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write an MP4 of a recording in real time; `progress` is told the share that is done.

    Raises:
        NoDisplay: this machine cannot render; one line says why.
    """
    job = {
        "what": "video",
        "view": VIEWS[view],
        "fps": fps,
        "size": size,
        "path": str(Path(path).absolute()),
    }
    render(recording, job, progress)


def render(
    recording: Recording, job: dict[str, Any], progress: Callable[[float], None] | None = None
) -> None:
    """Let a process of its own do a job, with one OpenGL backend after the other.

    Raises:
        NoDisplay: none of them works.
    """
    tried = []
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "recording.npz"
        recording.save(source)
        task = Path(folder) / "job.json"
        task.write_text(json.dumps({**job, "recording": str(source)}))
        for backend in _backends():
            problem = _try(task, backend, progress)
            if problem is None:
                return
            tried.append(f"{backend}: {problem}")
    raise NoDisplay(f"no pictures: this machine cannot render ({'; '.join(tried)})")


def _backends() -> Iterator[str]:
    """The backend the user wishes, else those that may work here."""
    wished = os.environ.get("ADONIS_GL") or os.environ.get("MUJOCO_GL")
    if wished and wished != "disable":
        yield wished
        return
    if sys.platform != "linux" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        yield "glfw"
    if sys.platform == "linux":
        yield "egl"
        yield "osmesa"


def _try(task: Path, backend: str, progress: Callable[[float], None] | None) -> str | None:
    """Run the job; returns why it failed, in a few words, or None."""
    root = str(Path(__file__).parents[1])
    path = os.pathsep.join([root, *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, "MUJOCO_GL": backend, "PYTHONPATH": path}
    environment.pop("PYOPENGL_PLATFORM", None)
    command = [sys.executable, "-W", "ignore", "-m", "sim.rendering_worker", str(task)]
    worker = subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert worker.stdout is not None
    for line in worker.stdout:
        if progress is not None and line.startswith("progress "):
            progress(float(line.split()[1]))
    try:
        _, said = worker.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        worker.kill()
        return "took too long"
    if worker.returncode == 0:
        return None
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    return lines[-1][:120] if lines else f"ended with code {worker.returncode}"

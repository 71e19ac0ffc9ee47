"""The process that renders: `python -m sim.rendering_worker job.json` (see `rendering`)."""

import json
import sys
import textwrap
from bisect import bisect_right
from itertools import pairwise
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from sim.recording import Recording

Picture = NDArray[np.uint8]
TRAIL_COLORS = ((0.86, 0.33, 0.16, 0.9), (0.10, 0.55, 0.42, 0.9))
CAPTION = 44  # height [pixels]
THICK = 0.004  # radius of the way of a palm, as a share of what is shown
SHAPES = (  # of a model, what a body changes that becomes another one
    *("body_pos", "body_quat", "geom_pos", "geom_quat", "geom_size", "geom_rbound"),
    *("site_pos", "site_quat", "jnt_pos"),
)
DIFFERENT = 24.0  # of 255: pixels that differ by more show something that moved


class Camera:
    """Renders one row of a recording after another."""

    def __init__(self, recording: Recording, view: tuple[float, float], size: list[int]) -> None:
        self.recording, self.model = recording, recording.model
        self._models = [mujoco.MjModel.from_xml_string(xml) for _, xml in recording.models]
        self._shown = 0
        self._data = mujoco.MjData(self.model)
        self.model.vis.global_.offwidth = max(self.model.vis.global_.offwidth, size[0])
        self.model.vis.global_.offheight = max(self.model.vis.global_.offheight, size[1])
        self._renderer = mujoco.Renderer(self.model, size[1], size[0])
        self._camera = mujoco.MjvCamera()
        self._camera.lookat[:] = self.model.stat.center
        self._camera.distance = 1.65 * self.model.stat.extent
        self._camera.azimuth, self._camera.elevation = view

    def shoot(self, row: int, palms: list[str] | None = None, since: int = 0) -> Picture:
        """The picture of a row, with the way that the palms came from the row `since`."""
        self._set(row)
        self._renderer.update_scene(self._data, self._camera)
        for palm, color in zip(palms or (), TRAIL_COLORS * 4, strict=False):
            self._draw_trail(palm, since, row, color)
        return np.array(self._renderer.render())

    def lapse(self, row: int, palms: list[str], since: int, ghosts: int) -> Picture:
        """The picture of a row over fainter ones of moments before it."""
        rows = np.linspace(since, row, ghosts + 1).astype(int)
        shots = np.array([self.shoot(int(k)) for k in rows], dtype=np.float32)
        still = np.median(shots, axis=0)  # what does not move
        whole = still
        for strength, shot in zip(np.linspace(0.3, 1.0, len(shots)), shots, strict=True):
            moved = np.abs(shot - still).max(axis=2, keepdims=True) > DIFFERENT
            whole = np.where(moved, (1.0 - strength) * whole + strength * shot, whole)
        way = self.shoot(row, palms, since).astype(np.float32)
        drawn = np.abs(way - shots[-1]).max(axis=2, keepdims=True) > DIFFERENT
        return np.where(drawn, way, whole).astype(np.uint8)

    def _become(self, row: int) -> None:
        """Give what is drawn the shapes of the model that was run in a row."""
        which = bisect_right([first for first, _ in self.recording.models], row) - 1
        if which != self._shown:
            for part in SHAPES:
                getattr(self.model, part)[:] = getattr(self._models[which], part)
            self._shown = which

    def _set(self, row: int) -> None:
        self._become(row)
        self._data.qpos[:] = self.recording.qpos[row]
        mujoco.mj_kinematics(self.model, self._data)
        mujoco.mj_camlight(self.model, self._data)
        mujoco.mj_comPos(self.model, self._data)

    def _draw_trail(self, site: str, first: int, last: int, rgba: tuple[float, ...]) -> None:
        points = []
        for row in range(first, last + 1, 8):
            self._become(row)
            self._data.qpos[:] = self.recording.qpos[row]
            mujoco.mj_kinematics(self.model, self._data)
            points.append(self._data.site(site).xpos.copy())
        scene = self._renderer.scene
        for start, end in pairwise(points):
            if scene.ngeom >= scene.maxgeom or np.linalg.norm(end - start) < 1e-3:
                continue
            geom = scene.geoms[scene.ngeom]
            kind = mujoco.mjtGeom.mjGEOM_CAPSULE
            mujoco.mjv_initGeom(
                geom, kind, np.zeros(3), np.zeros(3), np.zeros(9), np.array(rgba, np.float32)
            )
            mujoco.mjv_connector(geom, kind, THICK * self.model.stat.extent, start, end)
            scene.ngeom += 1


def filmstrip(recording: Recording, job: dict[str, Any]) -> None:
    """Several moments side by side, each with its caption."""
    camera = Camera(recording, job["view"], job["size"])
    width, height = job["size"]
    columns = min(job["columns"], len(job["frames"]))
    rows = -(-len(job["frames"]) // columns)
    strip = Image.new("RGB", (columns * width, rows * (height + CAPTION)), "white")
    pen, font = ImageDraw.Draw(strip), ImageFont.load_default(size=14)
    for index, (time, caption, trail, ghosts) in enumerate(job["frames"]):
        row = recording.row(time)
        since = recording.row(max(time - trail, 0.0))
        if ghosts:
            picture = camera.lapse(row, job["palms"], since, ghosts)
        else:
            picture = camera.shoot(row, job["palms"], since)
        x, y = index % columns * width, index // columns * (height + CAPTION)
        strip.paste(Image.fromarray(picture), (x, y))
        lines = textwrap.wrap(caption, max(12, width // 8), max_lines=2, placeholder=" …")
        pen.multiline_text((x + 8, y + height + 4), "\n".join(lines), fill="#222222", font=font)
    strip.save(job["path"], optimize=True)


def video(recording: Recording, job: dict[str, Any]) -> None:
    """The whole recording in real time."""
    camera = Camera(recording, job["view"], job["size"])
    count = max(1, int(recording.time[-1] * job["fps"]))
    writer = imageio_ffmpeg.write_frames(
        job["path"], tuple(job["size"]), fps=job["fps"], quality=7, macro_block_size=8
    )
    writer.send(None)
    for k in range(count):
        writer.send(camera.shoot(recording.row(k / job["fps"])).tobytes())
        print(f"progress {(k + 1) / count:.4f}", flush=True)
    writer.close()


def main() -> None:
    """Do the job that the first argument describes."""
    job = json.loads(Path(sys.argv[1]).read_text())
    recording = Recording.load(job["recording"])
    {"filmstrip": filmstrip, "video": video}[job["what"]](recording, job)


if __name__ == "__main__":
    main()

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
Pixels = tuple[float, float]
TRAIL_COLORS = ((0.86, 0.33, 0.16, 0.9), (0.10, 0.55, 0.42, 0.9))
CAPTION = 44  # height [pixels]
LINE = 18.0  # height of a name [pixels]
LOOKS, MATTER = 1, 3  # groups of geoms: meshes to be looked at, and capsules that collide
SEEN, HIDDEN = "#b3202a", "#5f6570"  # of landmarks that face us, and of those on the far side
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
        self._option = mujoco.MjvOption()

    def shoot(self, row: int, palms: list[str] | None = None, since: int = 0) -> Picture:
        """The picture of a row, with the way that the palms came from the row `since`."""
        self._set(row)
        self._renderer.update_scene(self._data, self._camera, self._option)
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

    def look(self, view: tuple[float, float], closeness: float, *, shapes: bool) -> None:
        """Look from elsewhere.

        Args:
            view: azimuth and elevation [deg].
            closeness: 1 for as near as before.
            shapes: whether what collides is shown, in place of what is only looked at.
        """
        self._camera.azimuth, self._camera.elevation = view
        self._camera.distance = 1.65 * self.model.stat.extent / closeness
        self._option.geomgroup[LOOKS], self._option.geomgroup[MATTER] = not shapes, shapes

    def spot(self, site: str) -> tuple[Pixels, Pixels, bool]:
        """Where a site is in the last picture, where its +x axis points, and if it faces us."""
        data = self._data.site(site)
        normal = data.xmat.reshape(3, 3)[:, 0]
        facing = bool(normal @ (self._eye() - data.xpos) > 0.0)
        out = data.xpos + 0.05 * self.model.stat.extent * normal
        return self._pixels(data.xpos), self._pixels(out), facing

    def _eye(self) -> NDArray[np.float64]:
        """Where the camera is (3,): between its two eyes."""
        left, right = (np.array(camera.pos) for camera in self._renderer.scene.camera)
        middle: NDArray[np.float64] = 0.5 * (left + right)
        return middle

    def _pixels(self, point: NDArray[np.float64]) -> Pixels:
        """Where a point (3,) of the world is in the picture."""
        eye = self._renderer.scene.camera[0]
        forward, up = np.array(eye.forward), np.array(eye.up)
        right = np.cross(forward, up)
        away = point - self._eye()
        depth = float(away @ forward)
        half = 0.5 * self._renderer.height
        scale = half * eye.frustum_near / eye.frustum_top / depth
        x = 0.5 * self._renderer.width + scale * float(away @ right)
        return x, half - scale * float(away @ up)

    def _become(self, row: int) -> None:
        """Give what is drawn the shapes of the model that was run in a row."""
        which = bisect_right([first for first, _ in self.recording.models], row) - 1
        if which != self._shown:
            for part in SHAPES:
                getattr(self.model, part)[:] = getattr(self._models[which], part)
            self._shown = which

    def _pose(self, row: int) -> None:
        self._become(row)
        self._data.qpos[:] = self.recording.qpos[row]
        if self.model.nmocap:
            self._data.mocap_pos[:] = self.recording.objects[row]
        mujoco.mj_kinematics(self.model, self._data)

    def _set(self, row: int) -> None:
        self._pose(row)
        mujoco.mj_camlight(self.model, self._data)
        mujoco.mj_comPos(self.model, self._data)

    def _draw_trail(self, site: str, first: int, last: int, rgba: tuple[float, ...]) -> None:
        points = []
        for row in range(first, last + 1, 8):
            self._pose(row)
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


def portrait(recording: Recording, job: dict[str, Any]) -> None:
    """A body from several sides, with the names of its landmarks at the edges of the picture."""
    width, height = job["size"]
    camera = Camera(recording, job["views"][0], job["size"])
    strip = Image.new("RGB", (len(job["views"]) * width, height), "white")
    pen, font = ImageDraw.Draw(strip), ImageFont.load_default(size=13)
    for k, (view, shapes) in enumerate(zip(job["views"], job["shapes"], strict=True)):
        camera.look(view, 0.8, shapes=shapes)
        strip.paste(Image.fromarray(camera.shoot(0)), (k * width, 0))
        spots = [(name, *camera.spot(name)) for name in job["marks"]]
        middle = float(np.median([at[0] for _, at, _, _ in spots])) if spots else 0.5 * width
        for left in (True, False):
            column = sorted(
                (spot for spot in spots if (spot[1][0] < middle) == left), key=lambda s: s[1][1]
            )
            _name_spots(pen, font, column, k * width, width, height, left)
    strip.save(job["path"], optimize=True)


def _name_spots(
    pen: ImageDraw.ImageDraw,
    font: Any,
    column: list[tuple[str, Pixels, Pixels, bool]],
    shift: int,
    width: int,
    height: int,
    left: bool,
) -> None:
    """Write the names of spots one below the other at an edge, each with a line to its spot."""
    free = 8.0
    lowest = [height - 8.0 - LINE * (len(column) - k) for k in range(len(column))]
    for (name, (x, y), (out_x, out_y), facing), last in zip(column, lowest, strict=True):
        place = min(max(free, y - 0.5 * LINE), last)
        free = place + LINE
        color = SEEN if facing else HIDDEN
        wide = pen.textlength(name, font=font)
        start = shift + (6 if left else width - 6 - wide)
        edge = start + wide + 3 if left else start - 3
        pen.line([(edge, place + 0.5 * LINE), (shift + x, y)], fill=color, width=1)
        pen.line([(shift + x, y), (shift + out_x, out_y)], fill=color, width=3)
        pen.ellipse([shift + x - 4, y - 4, shift + x + 4, y + 4], fill=color, outline="white")
        pen.text((start, place), name, fill=color, font=font, stroke_width=2, stroke_fill="white")


def main() -> None:
    """Do the job that the first argument describes."""
    job = json.loads(Path(sys.argv[1]).read_text())
    recording = Recording.load(job["recording"])
    {"filmstrip": filmstrip, "video": video, "portrait": portrait}[job["what"]](recording, job)


if __name__ == "__main__":
    main()

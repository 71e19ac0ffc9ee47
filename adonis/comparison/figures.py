"""Figures of a comparison: those of Mataric, Zordan & Williamson (1999), and more."""

import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from adonis.comparison.comparing import COMBINED, Comparison
from adonis.reporting import filmstrip_frames
from primitives import GetPosture
from sim import Body, Frame, World, render_filmstrip

FloatArray = NDArray[np.float64]
HUMAN = "human"
COLORS = {
    "pd-servo": "#3b6fb6",
    "torque-field": "#d1542a",
    "impedance": "#1a8c6b",
    "endpoint-force": "#8a5aa8",
    COMBINED: "#222222",
    HUMAN: "#b58900",
}
IN_PAPER = (2, 6, 8, 10)  # sub-tasks of its figure 6
LAPSE = 10  # sub-task of its figure 5
FACTOR = 2.0  # within which a peak speed counts as the human's


@dataclass(frozen=True)
class Drawn:
    """A figure that was made."""

    title: str
    caption: str
    files: tuple[Path, ...]  # the first is the one to show


def draw_all(
    comparison: Comparison, folder: Path, progress: Callable[[str, float], None]
) -> Iterator[Drawn]:
    """Draw every figure into a folder; pictures need OpenGL and raise `NoDisplay` without."""
    plots: Sequence[tuple[str, str, str, Callable[[Comparison], Figure]]] = PLOTS
    for k, (name, title, caption, draw) in enumerate(plots):
        progress(title, k / len(plots))
        figure = draw(comparison)
        files = tuple(folder / f"{name}.{kind}" for kind in ("svg", "png"))
        for file in files:
            figure.savefig(file, dpi=130)
        plt.close(figure)
        yield Drawn(title, caption, files)


def draw_pictures(
    comparison: Comparison, folder: Path, progress: Callable[[str, float], None]
) -> Iterator[Drawn]:
    """Render the time-lapse of one sub-task and everybody's filmstrip.

    Raises:
        NoDisplay: this machine cannot render.
    """
    number = LAPSE if len(comparison.subtasks) >= LAPSE else len(comparison.subtasks)
    progress("time-lapse", 0.0)
    path = folder / "figure_5_time_lapse.png"
    _time_lapse(comparison, number, path)
    words = comparison.subtasks[number - 1].words or comparison.subtasks[number - 1].name
    yield Drawn(
        "Figure 5: the way of the hand",
        f"Time-lapse of sub-task {number} ({words}), from the same camera for each controller.",
        (path,),
    )
    for k, dancer in enumerate(comparison.dancers):
        progress(f"filmstrip of {dancer.name}", (k + 1) / (len(comparison.dancers) + 1))
        strip = folder / f"figure_4_filmstrip_{dancer.name}.png"
        frames = filmstrip_frames(dancer.recording, dancer.spec)
        palms = [limb.palm for limb in comparison.body.map.limbs.values()]
        render_filmstrip(dancer.recording, frames, strip, palms=palms)
        yield Drawn(f"Figure 4: the dance by {dancer.name}", "At the end of each move.", (strip,))


def _time_lapse(comparison: Comparison, number: int, path: Path) -> None:
    tiles = []
    for dancer in comparison.dancers:
        subtask = dancer.spec.subtasks[number - 1]
        span = dancer.spans[subtask.name]
        end = span.end if np.isfinite(span.end) else float(dancer.recording.time[-1])
        limb = comparison.body.map.limbs.get(getattr(subtask.does, "limb", None) or "")
        palms = [limb.palm] if limb else []
        frame = Frame(end, dancer.name, end - span.start, ghosts=5)
        tile = path.with_name(f".{dancer.name}.png")
        render_filmstrip(dancer.recording, [frame], tile, palms=palms, size=(380, 460))
        tiles.append(Image.open(tile).convert("RGB"))
        tile.unlink()
    whole = Image.new("RGB", (sum(t.width for t in tiles), tiles[0].height), "white")
    for k, tile_ in enumerate(tiles):
        whole.paste(tile_, (k * tiles[0].width, 0))
    whole.save(path, optimize=True)


# --- plots ----------------------------------------------------------------------------------


def torque_against_error(comparison: Comparison) -> Figure:
    """Figure 2: what the joint controllers ask for, by how far a joint is off."""
    body = comparison.body
    figure, axes = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
    joint = next(iter(body.map.limbs.values())).shoulder[0]
    stiffness = body.map.servos[joint].stiffness
    error = np.linspace(-2.5, 2.5, 401)
    kinds = (
        ("pd-servo", GetPosture(joints=(joint,), posture={joint: 0}), "-", "linear (eq 1)"),
        (
            "torque-field",
            GetPosture(joints=(joint,), posture={joint: 0}, controller="torque-field"),
            "-",
            "non-linear, this body's width",
        ),
        (
            "torque-field",
            GetPosture(
                joints=(joint,), posture={joint: 0}, controller="torque-field", stiffness=stiffness
            ),
            ":",
            "non-linear, width of eq 3",
        ),
    )
    for name, primitive, style, label in kinds:
        torque = _torque_at(body, primitive, joint, error)
        axes.plot(np.rad2deg(error), torque, style, color=COLORS[name], label=label)
    axes.axhline(0, color="#999999", lw=0.6)
    top = 1.6 * stiffness * 0.61
    axes.set(xlabel="angle error [deg]", ylabel=f"torque of {joint} [N m]", ylim=(-top, top))
    axes.legend(frameon=False, fontsize=8)
    _plain(axes)
    return figure


def _torque_at(body: Body, primitive: GetPosture, joint: str, error: FloatArray) -> FloatArray:
    """Torques (k,) of a settled posture, the joint being off by so much (k,) [rad]."""
    field = primitive.bind(body, 1.0)
    world = World(body, len(error))
    start = np.tile(body.home, (len(error), 1))
    dof = int(body.joints(joint)[0])
    start[:, body.qpos_of_dof[dof]] = error
    world.reset(start)
    field.begin(world.state, np.ones(len(error), dtype=bool))
    torque: FloatArray = field.torque(world.state, np.full(len(error), 10.0))[:, dof]
    return torque


def speeds_in_paper(comparison: Comparison) -> Figure:
    """Figure 6: hand speed in four sub-tasks."""
    count = len(comparison.subtasks)
    return _speeds(comparison, [k for k in IN_PAPER if k <= count] or list(range(1, count + 1))[:4])


def speeds_of_all(comparison: Comparison) -> Figure:
    """Figure 6 for every sub-task."""
    return _speeds(comparison, list(range(1, len(comparison.subtasks) + 1))[:24])


def _speeds(comparison: Comparison, numbers: Sequence[int]) -> Figure:
    columns = 2 if len(numbers) <= 4 else 4
    rows = -(-len(numbers) // columns)
    figure, grid = plt.subplots(
        rows, columns, figsize=(3.0 * columns + 1.5, 2.3 * rows + 0.6), layout="constrained",
        sharey=True, squeeze=False,
    )  # fmt: skip
    share = np.linspace(0.0, 1.0, 101)
    for axes, number in zip(grid.flat, numbers, strict=False):
        for dancer in comparison.dancers:
            axes.plot(share, dancer.speed(number), color=COLORS.get(dancer.name), label=dancer.name)
        move = comparison.human.moves.get(number) if comparison.human else None
        if move is not None and move.speed.size:
            at = np.linspace(0.0, 1.0, move.speed.size)
            axes.plot(at, move.speed, color=COLORS[HUMAN], label=HUMAN, lw=1, marker=".", ms=4)
        axes.set_title(f"{number}  {_words(comparison, number)}", fontsize=8, loc="left")
        axes.set(xlim=(0, 1), xticks=(0, 0.5, 1))
        _plain(axes)
    grid[0, 0].set_ylim(0, None)
    for axes in list(grid.flat)[len(numbers) :]:
        axes.set_axis_off()
    figure.supxlabel("share of the sub-task's time", fontsize=9)
    figure.supylabel("hand speed [m/s]", fontsize=9)
    handles = _handles(grid.flat)
    figure.legend(
        handles.values(), handles.keys(), loc="outside right upper", frameon=False, fontsize=8
    )
    return figure


def jerk(comparison: Comparison) -> Figure:
    """Figure 7: jerk of the hand in every sub-task, on a log scale."""
    return _by_subtask(comparison, "jerk", "jerk index (eq 11) [m²/s⁵]", log=True)


def peaks(comparison: Comparison) -> Figure:
    """Peak speed in every sub-task, with the band of a factor two about the human's."""
    figure = _by_subtask(comparison, "peak_speed", "peak hand speed [m/s]", log=False)
    if comparison.human is not None:
        number = np.arange(1, len(comparison.subtasks) + 1)
        peak = comparison.human.column("peak_speed", len(number))
        band = figure.axes[0].fill_between(
            number, peak / FACTOR, peak * FACTOR, color=COLORS[HUMAN], alpha=0.15, lw=0
        )
        band.set_zorder(0)
    return figure


def _by_subtask(comparison: Comparison, measure: str, label: str, *, log: bool) -> Figure:
    figure, axes = plt.subplots(figsize=(8.5, 3.6), layout="constrained")
    number = np.arange(1, len(comparison.subtasks) + 1)
    series = [(d.name, d.column(measure)) for d in comparison.dancers]
    if comparison.human is not None:
        series.append((HUMAN, comparison.human.column(measure, len(number))))
    for name, values in series:
        axes.plot(number, values, marker="o", ms=4, lw=1, color=COLORS.get(name), label=name)
    axes.set(xlabel="sub-task", ylabel=label, xticks=number)
    axes.set_yscale("log") if log else axes.set_ylim(0, None)
    axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    _plain(axes)
    return figure


def _handles(grid: Iterable[Axes]) -> dict[str, Artist]:
    """Every label once."""
    return {
        label: handle
        for axes in grid
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }


def _words(comparison: Comparison, number: int) -> str:
    subtask = comparison.subtasks[number - 1]
    return textwrap.fill(subtask.words or subtask.name, 34)


def _plain(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)


PLOTS: tuple[tuple[str, str, str, Callable[[Comparison], Figure]], ...] = (
    (
        "figure_2_torque_against_error",
        "Figure 2: torque against angle error",
        "A servo pulls the harder the farther a joint is off; a torque field lets go. With the"
        " width of eq 3 and this body's stiffness it has let go long before a movement's length.",
        torque_against_error,
    ),
    (
        "figure_6_hand_speed",
        "Figure 6: hand speed",
        "Speed of the wrist over each sub-task's time, filtered at 8 Hz as the human's.",
        speeds_in_paper,
    ),
    (
        "figure_7_jerk",
        "Figure 7: jerk of the hand",
        "Lines only guide the eye: sub-tasks are measured one by one.",
        jerk,
    ),
    (
        "peak_speeds",
        "Peak speeds",
        "The band is a factor two about the human's.",
        peaks,
    ),
    (
        "all_hand_speeds",
        "Hand speed in all sub-tasks",
        "As figure 6.",
        speeds_of_all,
    ),
)

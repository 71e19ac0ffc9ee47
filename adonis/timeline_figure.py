"""A timeline as a figure."""

import textwrap
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from adonis.plotting import COLORS, GREY
from adonis.timeline import Row, Timeline

OTHER = "#5b6aa8"  # what moves neither arm alone
QUIET = "#8a8a86"
WRONG = "#c0282d"
MOST_LABELS = 80  # of sub-tasks; above, nobody could read them
MOST_BEATS = 200
PLAN, RUN = (-0.40, 0.22), (-0.10, 0.42)  # of a row: top of its bars, and their heights


def plot_timeline(shown: Timeline, path: Path) -> None:
    """Write a Gantt chart: planned bars hollow, what ran below them solid."""
    count = len(shown.rows)
    labelled = count <= MOST_LABELS
    height = 1.3 + (0.46 * count if labelled else 10.0)
    figure, axes = plt.subplots(figsize=(11, height), layout="constrained")
    if shown.end / shown.beat <= MOST_BEATS:
        for k in range(int(shown.end / shown.beat) + 1):
            axes.axvline(k * shown.beat, color=GREY, lw=0.8, zorder=0)
    if labelled:
        for y, row in enumerate(shown.rows):
            _draw(axes, y, row, shown)
        axes.set_yticks(range(count), [_label(row) for row in shown.rows], fontsize=8)
        _hand_overs(axes, shown)
    else:
        _draw_many(axes, shown)
        axes.set_yticks([])
        axes.set_ylabel(f"{count} sub-tasks")
    axes.set(xlim=(0.0, shown.end), ylim=(count - 0.4, -0.6), xlabel="time [s]")
    axes.tick_params(axis="y", length=0)
    axes.spines[["top", "right", "left"]].set_visible(False)
    _legend(axes, shown)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def _draw(axes: Axes, y: float, row: Row, shown: Timeline) -> None:
    color = _color(row)
    start, end = row.planned
    top, high = y + PLAN[0], PLAN[1]
    left_out = shown.recorded and not row.ran
    axes.broken_barh(
        [(start, end - start)],
        (top, high),
        facecolor="white",
        edgecolor=QUIET if left_out else color,
        lw=0.9,
        ls=":" if left_out else "-",
    )
    axes.vlines(row.rounds, top, top + high, color=color, lw=0.6)
    if not shown.recorded:
        return
    if row.ran:
        over = row.ended if np.isfinite(row.ended) else row.let_go
        top, high = y + RUN[0], RUN[1]
        axes.broken_barh([(row.began, over - row.began)], (top, high), facecolor=color, lw=0)
        if row.took_from:
            fade = min(row.hand_over, over - row.began)
            axes.broken_barh(
                [(row.began, fade)], (top, high), facecolor=color, edgecolor="white",
                hatch="//////", lw=0,
            )  # fmt: skip
        middle = top + 0.5 * high
        axes.plot([over, row.let_go], [middle, middle], color=color, lw=1.6, alpha=0.55)
    if row.outcome != "done":
        beside = row.let_go if row.ran else end
        late = beside > 0.85 * shown.end
        axes.annotate(
            row.became,
            (start if late else beside, y + (RUN[0] + 0.5 * RUN[1])),
            xytext=(-4 if late else 4, 0),
            textcoords="offset points",
            ha="right" if late else "left",
            va="center",
            fontsize=8,
            color=WRONG if row.outcome == "timed out" else QUIET,
        )


def _draw_many(axes: Axes, shown: Timeline) -> None:
    """Lines instead of bars: grey as planned, coloured as it ran."""
    y = np.arange(len(shown.rows))
    plan = np.array([row.planned for row in shown.rows])
    axes.hlines(y - 0.2, *plan.T, color=QUIET, lw=0.8)
    if shown.recorded:
        over = [row.ended if np.isfinite(row.ended) else row.let_go for row in shown.rows]
        colors = [_color(row) for row in shown.rows]
        axes.hlines(y + 0.2, [row.began for row in shown.rows], over, colors=colors, lw=1.2)


def _hand_overs(axes: Axes, shown: Timeline) -> None:
    """An arrow from whoever gave joints to whoever took them."""
    places = {row.subtask.name: y for y, row in enumerate(shown.rows)}
    for y, row in enumerate(shown.rows):
        for giver in row.took_from:
            down = places[giver] < y
            begin = places[giver] + RUN[0] + 0.5 * RUN[1]
            finish = y + RUN[0] + (0.0 if down else RUN[1])
            axes.annotate(
                "",
                (row.began, finish),
                xytext=(row.began, begin),
                arrowprops={"arrowstyle": "->", "color": "#333333", "lw": 0.8, "shrinkA": 0,
                            "shrinkB": 0},
            )  # fmt: skip


def _legend(axes: Axes, shown: Timeline) -> None:
    if len(shown.rows) > MOST_LABELS:
        axes.set_title(shown.title, loc="left", fontsize=10)
        return
    box = ((0, 0), 1, 1)
    proxies: list[Artist] = [Rectangle(*box, facecolor="white", edgecolor=QUIET)]
    names = ["planned"]
    if shown.recorded:
        proxies += [
            Rectangle(*box, facecolor=QUIET, lw=0),
            Rectangle(*box, facecolor=QUIET, edgecolor="white", hatch="//////", lw=0),
            Line2D([], [], color=QUIET, lw=1.6),
        ]
        names += ["ran", "took over", "held its goal"]
    axes.legend(
        proxies, names, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False,
        fontsize=8, title=shown.title, alignment="left",
    )  # fmt: skip


def _color(row: Row) -> str:
    sides = {part.split("_")[0] for part in row.moves}
    return COLORS[sides.pop()] if len(sides) == 1 and sides <= COLORS.keys() else OTHER


def _label(row: Row) -> str:
    subtask = row.subtask
    said = textwrap.shorten(subtask.words or subtask.name, 56, placeholder=" …")
    more = ", ".join(row.moves).replace("_", " ")
    if subtask.circumstances:
        more += ("; " if more else "") + subtask.circumstances
    return f"{said}\n{textwrap.shorten(more, 56, placeholder=' …')}" if more else said

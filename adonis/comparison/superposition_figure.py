"""Figure of the least-squares study: see `superposition`."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from adonis.comparison.superposition import Choice, Row, Run
from primitives.primitive import FloatArray

COLORS = ("#1a8c6b", "#d1542a", "#28649e")


def draw_superposition(rows: Sequence[Row], runs: Sequence[Run], path: Path) -> None:
    """Residual and deviation over the number of fields, and the paths of a planar hand."""
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    _draw_scaling(left, rows, "residual", 1.0)
    _draw_scaling(middle, rows, "deviation", 1000.0)
    left.set_ylabel("RMS torque error, share of the wanted torque")
    left.set_ylim(top=100.0)
    left.legend(frameon=False, fontsize=8, loc="upper right")
    middle.set_ylabel("largest distance of a hand from its line [mm]")
    middle.axhline(10.0, color="#999999", lw=0.8)
    for run in runs:
        for hand, line in zip(run.paths, run.lines, strict=True):
            # Seen from above, forward up.
            right.plot(-line[:, 1], line[:, 0], color="#cccccc", lw=4, solid_capstyle="round")
            right.plot(-hand[:, 1], hand[:, 0], color=COLORS[0], lw=1)
    worst = 1000.0 * max((run.deviation for run in runs), default=0.0)
    right.set_title(f"planar arm: at most {worst:.1f} mm off the line", fontsize=9)
    right.locator_params(axis="x", nbins=5)
    right.set(xlabel="to the right [m]", ylabel="forward [m]", aspect="equal")
    for axes in (left, middle, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def _draw_scaling(axes: Axes, rows: Sequence[Row], figure: str, scale: float) -> None:
    """One figure of the rows over the number of fields: median and range of the seeds."""
    bodies = dict.fromkeys((row.body, row.dof) for row in rows)
    for (body, dof), color in zip(bodies, COLORS, strict=False):
        for coupled, style in ((False, "o-"), (True, "--")):
            n, low, median, high = _over_fields(rows, body, figure, coupled)
            name = f"{body}, {dof} joints" if not coupled else None
            axes.plot(n, scale * median, style, color=color, ms=4, lw=1.4, label=name)
            if not coupled:
                axes.fill_between(n, scale * low, scale * high, color=color, alpha=0.15, lw=0)
    axes.plot([], [], "--", color="#777777", label="wells coupled over the joints")
    axes.set(xscale="log", yscale="log", xlabel="fields to choose from")
    axes.set_xticks(n, [f"{int(k)}" for k in n])
    axes.minorticks_off()


def _over_fields(rows: Sequence[Row], body: str, figure: str, coupled: bool) -> FloatArray:
    """Counts of fields, and least, median and largest value over the seeds (4, counts)."""
    found: dict[int, list[float]] = {}
    for row in rows:
        if row.body == body and replace(row.choice, seed=0) == Choice(row.fields, coupled):
            found.setdefault(row.fields, []).append(getattr(row, figure))
    values = [(n, min(v), float(np.median(v)), max(v)) for n, v in sorted(found.items())]
    return np.array(values, dtype=float).reshape(-1, 4).T

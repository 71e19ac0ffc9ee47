"""The figure of a run's attribution: who pulls each part of the body, and who against whom."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from numpy.typing import NDArray

from adonis.attribution import (
    FIGHT,
    STRENGTH,
    Attribution,
    Pair,
    asked_torques,
    cancelled,
    fighting,
    pulls,
)
from sim import BodyMap, Recording, Replay, Span

FloatArray = NDArray[np.floating[Any]]

BACKGROUND = ("#7f9cc4", "#5f8a8b", "#7b3fa0", "#e6e3da", "#a58f6f", "#b9bec6")  # in order
SUBTASKS = ("#d1542a", "#f2b880")  # taking turns on each part of the body
INK = "#444444"
STRIPS = 8  # pairs that are shown
LANES = 3  # of the timeline, so that names find room
NAMED = 40  # sub-tasks up to which they are named
COLUMNS = 500  # of time: what is finer is averaged
DARKEST = 0.2  # torque cancelled, as a share of the joint's limit


def plot_attribution(
    recording: Recording, replay: Replay, names: BodyMap, found: Attribution, path: Path
) -> None:
    """Shares of the torque, part by part, under the timeline; then the pairs that cancel most."""
    limits = replay.torque_limits()
    asked = asked_torques(recording, limits)
    parts = _parts(names, replay, asked)
    colors = _colors(recording, asked, parts)
    pairs = [pair for pair in found.pairs if pair.cancelled > 0.0][:STRIPS]
    heights = [0.55, *[1.35] * len(parts), 0.24 * max(len(pairs), 1)]
    figure, rows = plt.subplots(
        len(heights), 1, figsize=(11, sum(heights) + 1.5), sharex=True, layout="constrained",
        height_ratios=heights,
    )  # fmt: skip
    begun = sorted((s for s in recording.spans if np.isfinite(s.start)), key=lambda s: s.first)
    _timeline(rows[0], recording, begun, colors)
    numbers = {span.name: k for k, span in enumerate(begun, start=1)}
    carriers = {p.name for p in found.primitives if p.carries_weight}
    order = sorted(  # the weight at the bottom, then the background, then the sub-tasks
        range(len(recording.names)),
        key=lambda p: (recording.names[p] in numbers, recording.names[p] not in carriers),
    )
    for axes, (part, dofs) in zip(rows[1:-1], parts.items(), strict=True):
        _stack(axes, recording, asked[:, :, dofs], colors, numbers, order)
        axes.set_ylabel(part.replace("_", " "))
    pulled, _ = pulls(asked, replay.weight())
    _strips(rows[-1], recording, pulled, limits, pairs)
    for axes in rows[1:]:
        for span in begun:
            axes.axvline(span.first, color=INK, lw=0.4, alpha=0.5)
    rows[-1].set(xlabel="time [s]", xlim=(0.0, float(recording.time[-1])))
    said = "share of each primitive in the torque of the part; black, how much all of them make"
    rows[1].set_title(said, fontsize=8, loc="left")
    background = [name for name in recording.names if name not in numbers and name in colors]
    figure.legend(
        handles=[Patch(color=colors[name], label=name) for name in background]
        + [Patch(color=color, label=f"sub-task, {k}") for color, k in
           zip(SUBTASKS, ("odd on its part", "even"), strict=True)],
        loc="outside upper center", ncols=6, frameon=False, fontsize=8.5,
    )  # fmt: skip
    figure.savefig(path, dpi=130)
    plt.close(figure)


def _parts(names: BodyMap, replay: Replay, asked: FloatArray) -> Mapping[str, list[int]]:
    """Degrees of freedom of the limbs and joint groups that anyone pulls; all, if none has any."""
    parts = {name: limb.joints for name, limb in names.limbs.items()} | dict(names.groups)
    dofs = {part: [replay.dof(joint) for joint in joints] for part, joints in parts.items()}
    pulled = {part: own for part, own in dofs.items() if asked[:, :, own].any()}
    return pulled or {"body": list(range(asked.shape[2]))}


def _colors(
    recording: Recording, asked: FloatArray, parts: Mapping[str, Sequence[int]]
) -> dict[str, str]:
    """Of each primitive: the background's in the order of the task, sub-tasks taking turns."""
    starts = {s.name: s.first for s in recording.spans}
    background = [name for name in recording.names if name not in starts]
    colors = {name: BACKGROUND[k % len(BACKGROUND)] for k, name in enumerate(background)}
    order = sorted((n for n in starts if n in recording.names), key=lambda n: starts[n])
    for dofs in parts.values():
        own = [n for n in order if asked[:, recording.names.index(n)][:, dofs].any()]
        for k, name in enumerate(own):
            colors.setdefault(name, SUBTASKS[k % 2])
    return colors


def _columns(samples: FloatArray) -> FloatArray:
    """Rows (T, ...) averaged into the columns of the figure."""
    first = np.unique(np.linspace(0, len(samples), min(COLUMNS, len(samples)), endpoint=False))
    edges = first.astype(np.intp)
    counts = np.diff(np.append(edges, len(samples)))
    mean: FloatArray = np.add.reduceat(samples, edges, axis=0) / counts.reshape(
        -1, *[1] * (samples.ndim - 1)
    )
    return mean


def _timeline(
    axes: Axes, recording: Recording, begun: Sequence[Span], colors: Mapping[str, str]
) -> None:
    """The sub-tasks, numbered and named, each as long as its time."""
    last = float(recording.time[-1])
    lanes = LANES if len(begun) > 1 else 1
    for number, span in enumerate(begun, start=1):
        end = span.end if np.isfinite(span.end) else last
        lane = (number - 1) % lanes
        color = colors.get(span.name, INK)
        axes.barh(lane, end - span.first, left=span.first, height=0.22, color=color)
        if len(begun) <= NAMED:
            axes.annotate(
                f"{number} {span.name}", (span.first, lane), (0, -2.5), fontsize=7,
                textcoords="offset points", va="top" if lanes > 1 else "bottom", color=INK,
            )  # fmt: skip
    axes.set(ylim=(lanes - 0.1, -0.4), yticks=[])
    axes.spines[:].set_visible(False)
    axes.tick_params(axis="x", bottom=False)


def _stack(
    axes: Axes,
    recording: Recording,
    asked: FloatArray,
    colors: Mapping[str, str],
    numbers: Mapping[str, int],
    order: Sequence[int],
) -> None:
    """Shares of each primitive in the absolute torque of some joints, summed over them."""
    size = _columns(np.abs(asked).sum(axis=2))
    total = size.sum(axis=1, keepdims=True)
    share = np.divide(size, total, out=np.zeros_like(size), where=total > 0.0)
    edges = np.linspace(0.0, float(recording.time[-1]), len(share) + 1)
    top = np.zeros(len(share))
    for p in order:
        name = recording.names[p]
        if not share[:, p].any():
            continue
        axes.stairs(top + share[:, p], edges, baseline=top, fill=True, color=colors[name], lw=0)
        k = int(np.argmax(np.convolve(share[:, p], np.ones(15), mode="same")))
        if name in numbers and len(numbers) <= NAMED and share[k, p] > 0.12:
            axes.text(
                0.5 * (edges[k] + edges[k + 1]), top[k] + 0.5 * share[k, p], str(numbers[name]),
                ha="center", va="center", fontsize=8, color="black",
            )  # fmt: skip
        top = top + share[:, p]
    axes.set(ylim=(0.0, 1.0), yticks=[0, 0.5, 1], yticklabels=["0", "½", "1"])
    axes.spines[["top"]].set_visible(False)
    amount = axes.twinx()
    amount.plot(0.5 * (edges[1:] + edges[:-1]), total[:, 0], color="black", lw=0.9)
    amount.set_ylim(0.0, 1.1 * float(total.max()) if total.any() else 1.0)
    amount.set_ylabel("N m", fontsize=8)
    amount.tick_params(labelsize=8)
    amount.spines[["top"]].set_visible(False)


def _strips(
    axes: Axes, recording: Recording, pulled: FloatArray, limits: FloatArray, pairs: Sequence[Pair]
) -> None:
    """When two cancel each other's torque: the darker the more; underlined where they fight."""
    last, step = float(recording.time[-1]), recording.timestep
    for row, pair in enumerate(pairs):
        one, other = (pulled[:, recording.names.index(name)] for name in pair.between)
        gone = np.nan_to_num(0.5 * cancelled(one, other) / limits).max(axis=1)
        axes.imshow(
            _columns(gone)[None], aspect="auto", cmap="Reds", vmin=0.0, vmax=DARKEST,
            extent=(0.0, last, row + 0.4, row - 0.4), interpolation="nearest",
        )  # fmt: skip
        fight = fighting(one, other, limits).any(axis=1)
        begin = np.flatnonzero(np.diff(np.append(False, fight).astype(int)) > 0)
        over = np.flatnonzero(np.diff(np.append(fight, False).astype(int)) < 0) + 1
        axes.hlines(
            np.full(len(begin), row + 0.36), begin * step, over * step, color="black", lw=2.0
        )
    axes.set(
        ylim=(max(len(pairs), 1) - 0.5, -0.5),
        yticks=range(len(pairs)),
        yticklabels=[
            f"{a}, {b}   {pair.conflict:.2f}" for pair in pairs for a, b in [pair.between]
        ],
    )
    axes.tick_params(axis="y", labelsize=7.5, length=0)
    axes.spines[:].set_visible(False)
    said = (
        f"conflict of the pairs that cancel most: red, torque cancelled (darkest {DARKEST:.0%} of a"
        f" joint's limit); black line, a fight (more than {FIGHT:.0%} cancels, both above"
        f" {STRENGTH:.0%} of the limit)"
    )
    axes.set_title(said if pairs else "no two primitives cancel any torque", fontsize=8, loc="left")

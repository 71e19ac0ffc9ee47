"""Figures of a run."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from sim import BodyMap, Recording, Replay

FloatArray = NDArray[np.float64]
COLORS = {"right": "#d1542a", "left": "#1a8c6b"}
GREY = "#f1f1ee"


def hand_speed(replay: Replay, palm: str) -> FloatArray:
    """Speed of a palm (T,) [m/s], by central differences."""
    recording = replay.recording
    velocity = np.gradient(replay.site(palm).position, recording.timestep, axis=0)
    speed: FloatArray = np.linalg.norm(velocity, axis=1)
    return speed


def plot_hand_speed(recording: Recording, replay: Replay, names: BodyMap, path: Path) -> None:
    """Speed of each hand over time, with the sub-tasks."""
    figure, axes = plt.subplots(figsize=(11, 3.6), layout="constrained")
    for limb in names.limbs.values():
        color = COLORS[limb.side]
        axes.plot(recording.time, hand_speed(replay, limb.palm), color=color, label=limb.side)
    axes.set(ylabel="hand speed [m/s]", xlabel="time [s]", ylim=(0, None))
    _mark_subtasks(axes, recording)
    if names.limbs:
        axes.legend(loc="upper right", frameon=False, title="hand")
    figure.savefig(path, dpi=130)
    plt.close(figure)


def plot_torque(recording: Recording, replay: Replay, names: BodyMap, path: Path) -> None:
    """Torque of every joint as a share of its limit, limb by limb."""
    share = replay.torque_share()
    parts = {name: limb.joints for name, limb in names.limbs.items()}
    parts |= {name: joints for name, joints in names.groups.items() if joints}
    figure, rows = plt.subplots(
        len(parts), 1, figsize=(11, 2.2 * len(parts)), sharex=True, layout="constrained"
    )
    for axes, (part, joints) in zip(np.atleast_1d(rows), parts.items(), strict=True):
        for joint in joints:
            dof = replay.dof(joint)
            label = joint.removeprefix("right_").removeprefix("left_")
            axes.plot(recording.time, share[:, dof], label=label, lw=1)
        axes.axhline(0, color="#999999", lw=0.6)
        top = 1.15 * max(0.2, float(np.max(np.abs(axes.get_ylim()))))
        axes.set(ylim=(-min(top, 1.05), min(top, 1.05)), ylabel=part.replace("_", " "))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8)
        _mark_subtasks(axes, recording, words=axes is np.atleast_1d(rows)[0])
    figure.supylabel("torque, share of the motor's limit", fontsize=10)
    np.atleast_1d(rows)[-1].set_xlabel("time [s]")
    figure.savefig(path, dpi=130)
    plt.close(figure)


def _mark_subtasks(axes: Axes, recording: Recording, *, words: bool = True) -> None:
    """Shade every other sub-task and number it."""
    begun = sorted((s for s in recording.spans if np.isfinite(s.start)), key=lambda s: s.first)
    last = float(recording.time[-1])
    for number, span in enumerate(begun, start=1):
        end = span.end if np.isfinite(span.end) else last
        if number % 2:
            axes.axvspan(span.first, end, color=GREY, lw=0)
        if words and len(begun) <= 40:
            middle = 0.5 * (span.first + end)
            axes.annotate(
                str(number),
                (middle, 1.0),
                xycoords=("data", "axes fraction"),
                ha="center",
                va="bottom",
                fontsize=8,
                color="#666666",
            )
    axes.set_xlim(0, last)
    axes.spines[["top", "right"]].set_visible(False)

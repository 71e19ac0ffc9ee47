"""The timeline: what was planned, and what the recording says became of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from adonis.dancing import run_task
from adonis.timeline import Timeline, timeline
from adonis.timeline_figure import plot_timeline
from adonis.timeline_text import PLANNED, RUNS, extent, print_timeline
from adonis.transitions import transitions
from primitives import Relax
from sim import Body, Recording, Replay, Span
from specs import SubTask, TaskSpec, bind_task, build_graph, task_from_text

TASK = """task: knock
tempo: 240
background:
  - {name: still, primitive: get-posture, joints: [all], posture: rest}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - {name: reach, primitive: go-to-point, limb: right_arm, to: chest.front,
     done: {event: never}, timeout: 0.4, otherwise: give-up}
  - {name: knock, primitive: go-to-point, limb: right_arm, to: chest.front}
  - {name: give-up, primitive: get-posture, limb: right_arm, posture: rest, repeat: 3}
  - {name: nod, while: give-up, primitive: get-posture, joints: [neck_y], posture: {neck_y: 15}}
  - {name: bow, if: {event: audience}, after: [give-up],
     primitive: get-posture, joints: [waist_y], posture: {waist_y: 20}}
"""


@pytest.fixture(scope="module")
def ran(body: Body) -> tuple[TaskSpec, Recording, Timeline]:
    spec, document = task_from_text(TASK)
    (recording,) = run_task(bind_task(spec, body, document))
    return spec, recording, timeline(build_graph(spec), recording)


def text_of(shown: Timeline, width: int = 100) -> str:
    console = Console(width=width, force_terminal=False)
    with console.capture() as caught:
        print_timeline(console, shown)
    return caught.get()


def test_branches_rounds_and_hand_overs(ran) -> None:
    spec, _, shown = ran
    rows = {row.subtask.name: row for row in shown.rows}
    assert {name: row.became for name, row in rows.items()} == {
        "reach": "timed out", "knock": "not taken", "give-up": "done", "nod": "done",
        "bow": "not taken",
    }  # fmt: skip
    assert not rows["knock"].ran
    again = rows["give-up"]
    assert again.began == pytest.approx(0.4, abs=0.01), "its first round, not its last"
    assert again.ended == pytest.approx(0.4 + 0.75, abs=0.01)
    assert len(again.rounds) == 2
    assert again.took_from == ("reach",)
    assert rows["reach"].let_go == pytest.approx(0.4 + spec.hand_over, abs=0.01)
    assert rows["nod"].moves == ("neck_y",)
    assert {n: r.planned for n, r in rows.items()} == build_graph(spec).planned
    assert shown.beat == 0.25


def test_hand_overs_are_those_of_the_report(dance) -> None:
    recording, spec = dance.recording, dance.task.spec
    shown = timeline(dance.task.graph, recording)
    assert shown.recorded
    names = {row.subtask.name for row in shown.rows}
    reported = {
        (giver, t.taking)
        for t in transitions(recording, spec, Replay(recording))
        for giver in t.giving
        if giver in names
    }
    assert {(g, r.subtask.name) for r in shown.rows for g in r.took_from} == reported
    assert len(reported) == 10, "all but the first move of each arm"
    for row, span in zip(shown.rows, recording.spans, strict=True):
        assert (row.began, row.ended) == (span.start, span.end)


def test_a_killed_run_has_a_plan_all_the_same(ran, tmp_path: Path) -> None:
    spec, recording, _ = ran
    shown = timeline(build_graph(spec), replace(recording, spans=(), complete=False))
    assert {row.became for row in shown.rows} == {"unknown"}
    assert "unknown" in text_of(shown)
    plot_timeline(shown, tmp_path / "t.png")


def test_the_text_says_it_all(ran) -> None:
    spec, _, shown = ran
    said = text_of(shown)
    for words in ("if event audience", "while give-up", "from reach", "neck y", "not taken"):
        assert words in said
    planned = text_of(timeline(build_graph(spec)))
    assert PLANNED in planned
    assert RUNS not in planned


@given(st.floats(0, 1), st.floats(0, 1), st.integers(1, 300))
def test_bars_are_to_scale(one: float, other: float, cells: int) -> None:
    """A bar covers all of its time, less than a cell more, and at least one cell."""
    start, end = sorted((one, other))
    first, last = extent(start, end, cells)
    assert 0 <= first < last <= cells
    assert first <= start * cells
    assert last >= end * cells - 1e-6
    assert last - first < (end - start) * cells + 2


@given(st.text(max_size=30), st.integers(60, 200))
def test_lines_fit(words: str, width: int) -> None:
    names = ["a", "of-a-great-many-letters-more-than-fit"]
    steps = [SubTask(name=n, does=Relax(limb="right_arm"), words=words) for n in names]
    shown = timeline(build_graph(TaskSpec(task="t", title="wave", subtasks=steps)))
    lines = text_of(shown, width).splitlines()
    assert max(map(len, lines)) <= width
    assert sum(PLANNED in line for line in lines) == 3, "two bars and the legend"


def test_figures_of_few_and_of_many(ran, tmp_path: Path) -> None:
    many = [SubTask(name=f"s{k}", does=Relax(limb="left_arm"), seconds=0.1) for k in range(150)]
    graph = build_graph(TaskSpec(task="t", subtasks=many))
    spec, recording, few = ran
    running = [replace(s, end=np.nan, outcome="running") for s in recording.spans[:1]]
    pending = [replace(s, start=np.nan, end=np.nan, outcome="pending") for s in recording.spans[1:]]
    stopped = timeline(build_graph(spec), replace(recording, spans=(*running, *pending)))
    assert [row.became for row in stopped.rows] == ["running"] + ["not begun"] * 4
    spans = tuple(Span(s.name, 0.1, 0.2, "done") for s in many)
    all_ran = timeline(graph, replace(recording, spans=spans))
    shapes = {"few": few, "stopped": stopped, "many": timeline(graph), "all-ran": all_ran}
    for name, shown in shapes.items():
        plot_timeline(shown, tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")

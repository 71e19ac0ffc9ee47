"""Tempo maps: what takes how long, and what swings how fast, when the tempo changes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from primitives import Oscillate
from sim import Body
from specs import SpecError, bind_task, build_graph, task_from_text, with_tempo
from specs.tempo import Clock

STEP = "primitive: get-posture, joints: [neck_y], posture: {neck_y: 0}"


def task(steps: str, tempo_map: str, tempo: float = 60) -> str:
    return f"task: x\ntempo: {tempo}\ntempo_map: {tempo_map}\nsubtasks:\n{steps}"


def planned(text: str) -> dict[str, tuple[float, float]]:
    spec, document = task_from_text(text, "x.yaml")
    return build_graph(spec, document).planned


def test_the_tempo_changes_at_a_beat_and_at_a_subtask() -> None:
    steps = "".join(f"  - {{name: s{k}, {STEP}}}\n" for k in range(6))
    steps += f"  - {{name: last, {STEP}, seconds: 3}}\n"
    text = task(steps, "[{beat: 2, tempo: 120}, {subtask: s4, tempo: 30}]")
    starts = [start for start, _ in planned(text).values()]
    assert starts == pytest.approx([0, 1, 2, 2.5, 3, 5, 7])
    assert planned(text)["last"][1] == pytest.approx(10), "seconds are seconds at any tempo"
    spec, document = task_from_text(text)
    assert build_graph(spec, document).coda == 2.0, "one beat at the last tempo"


def test_beats_across_a_change_take_the_time_of_both_tempos() -> None:
    """Four short ones beside a long one: they begin and end together."""
    steps = "".join(f"  - {{name: s{k}, {STEP}}}\n" for k in range(4))
    steps += "  - {name: long, primitive: hold, limb: right_arm, beats: 4, after: []}\n"
    found = planned(task(steps, "[{beat: 1.5, tempo: 90}, {subtask: s3, tempo: 200}]"))
    assert found["long"] == pytest.approx((0.0, found["s3"][1]))


def test_a_change_at_a_subtask_moves_what_changes_later() -> None:
    """Each change depends on those before it, in whatever order they are written."""
    names = [f"s{k}" for k in range(8)]
    steps = "".join(f"  - {{name: {n}, {STEP}, seconds: 1}}\n" for n in names)
    steps += "  - {name: beside, primitive: hold, limb: left_arm, beats: 10, after: []}\n"
    tempos = dict(zip(names, (60, 120, 60, 240, 30, 60, 90, 60), strict=True))
    given_map = ", ".join(f"{{subtask: {n}, tempo: {t}}}" for n, t in reversed(tempos.items()))
    beats = sum(t / 60 for t in tempos.values())
    assert beats > 10
    end = planned(task(steps, f"[{given_map}]"))["beside"][1]
    passed = sum(min(max(end - k, 0), 1) * t / 60 for k, t in enumerate(tempos.values()))
    assert passed == pytest.approx(10)


@given(
    st.lists(st.tuples(st.floats(0.1, 5), st.floats(20, 300)), max_size=5),
    st.floats(0, 10),
    st.floats(0.01, 20),
)
def test_a_clock_runs_alike_both_ways(
    steps: list[tuple[float, float]], start: float, beats: float
) -> None:
    clock = Clock((0.0, *np.cumsum([b for b, _ in steps]).tolist()), (60.0, *(t for _, t in steps)))
    lasts = clock.lasts(start, beats)
    assert clock.beat(start + lasts) == pytest.approx(clock.beat(start) + beats, abs=1e-6)
    half = clock.lasts(start, beats / 2)
    assert half + clock.lasts(start + half, beats / 2) == pytest.approx(lasts, abs=1e-6)


def test_a_rhythm_stays_on_the_beat(body: Body) -> None:
    """In the background and in a sub-task: its cycles are counted in beats."""
    text = task(
        "  - {name: s, primitive: hold, limb: left_arm, beats: 4}\n"
        "  - {name: nod, primitive: oscillate, joints: {neck_y: {amplitude: 5}},"
        " beats_per_cycle: 1, beats: 8}\n",
        "[{beat: 3, tempo: 120}, {beat: 8, tempo: 90}, {beat: 100, tempo: 60}]",
    )
    spec, document = task_from_text(text)
    graph = build_graph(spec, document)
    start, end = graph.planned["nod"]
    assert (start, end) == pytest.approx((3.5, 3.5 + 4 / 2 + 4 / 1.5))
    does = graph.paced(spec.subtasks[1].does, start, end - start)
    assert isinstance(does, Oscillate)
    assert does.frequency == 2.0
    assert [(c.cycle, c.frequency) for c in does.then] == [(pytest.approx(4), 1.5)]
    sway = Oscillate(
        joints={"waist_x": {"amplitude": 5}},
        beats_per_cycle=2,
        then=({"cycle": 2, "frequency": 3}, {"cycle": 5, "beats_per_cycle": 1}),
    ).at_tempo(60, [(3.0, 120.0)])
    found = [(c.cycle, c.frequency) for c in sway.then]
    assert sway.frequency == 0.5
    assert np.array(found) == pytest.approx(np.array([(1.5, 1.0), (2.0, 3.0), (5.0, 2.0)]))
    bind_task(spec, body, document)


def test_another_tempo_keeps_the_proportions() -> None:
    spec, _ = task_from_text(task(f"  - {{name: a, {STEP}}}\n", "[{beat: 4, tempo: 90}]"))
    assert [s.tempo for s in with_tempo(spec, 120).tempo_map] == [180]
    with pytest.raises(SpecError, match="between 1 and 1000 beats per minute, not 1500"):
        with_tempo(spec, 1000)


@pytest.mark.parametrize(
    ("tempo_map", "said"),
    [
        ("[{tempo: 90}]", "x.yaml:3:13: give either beat or subtask"),
        ("[{beat: 1, subtask: a, tempo: 90}]", "x.yaml:3:13: give either beat or subtask"),
        ("[{beat: 1, tempo: 0}]", "x.yaml:3:30: tempo should be greater than or equal to 1"),
        ("[{subtask: b, tempo: 90}]", "x.yaml:3:23: unknown sub-task 'b'"),
        ("[{beat: -1, tempo: 90}]", "x.yaml:3:20: beat should be greater than or equal to 0"),
    ],
)
def test_a_tempo_map_that_makes_no_sense_is_refused(tempo_map: str, said: str) -> None:
    with pytest.raises(SpecError) as caught:
        planned(task(f"  - {{name: a, {STEP}}}\n", tempo_map))
    assert said in str(caught.value)

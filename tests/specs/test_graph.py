"""The graph: order, planned times, claims, and its pictures."""

import json

import networkx as nx
import pytest

from primitives import GetPosture, GoToPoint
from sim import Body
from specs import (
    SpecError,
    SubTask,
    TaskSpec,
    bind_task,
    build_graph,
    task_from_text,
    to_dot,
    to_json,
    to_mermaid,
    with_tempo,
)

RIGHT = GoToPoint(limb="right_arm", to="head.top")
LEFT = GoToPoint(limb="left_arm", to="head.back")


def task(*subtasks: SubTask, **more) -> TaskSpec:
    return TaskSpec(task="t", subtasks=subtasks, **more)


def test_each_comes_after_the_one_above_unless_told() -> None:
    spec = task(
        SubTask(name="a", does=RIGHT),
        SubTask(name="b", does=LEFT, after=()),
        SubTask(name="c", does=RIGHT, after=("a", "b"), beats=2),
        SubTask(name="d", does=LEFT),
        tempo=120,
    )
    graph = build_graph(spec)
    assert set(graph.graph.edges) == {("a", "c"), ("b", "c"), ("c", "d")}
    assert graph.planned == {"a": (0, 0.5), "b": (0, 0.5), "c": (0.5, 1.5), "d": (1.5, 2.0)}
    assert graph.duration == 2.5, "and a beat of coda"


def test_tempo_scales_the_plan() -> None:
    spec = task(SubTask(name="a", does=RIGHT), SubTask(name="b", does=RIGHT, seconds=0.7))
    slow, fast = build_graph(with_tempo(spec, 30)), build_graph(with_tempo(spec, 120))
    assert slow.planned["a"] == (0, 2.0)
    assert fast.planned["a"] == (0, 0.5)
    assert slow.planned["b"][1] - slow.planned["b"][0] == pytest.approx(0.7)


def test_waiting_in_a_circle_is_refused_with_the_circle() -> None:
    text = """task: t
subtasks:
  - {name: a, primitive: go-to-point, limb: right_arm, to: head.top, after: [b]}
  - {name: b, primitive: go-to-point, limb: right_arm, to: head.top, after: [a]}
"""
    spec, document = task_from_text(text, "t.yaml")
    with pytest.raises(SpecError, match=r"t.yaml:[34]:\d+: .* wait for each other: a -> b -> a"):
        build_graph(spec, document)


def test_waiting_for_nobody_is_refused() -> None:
    with pytest.raises(SpecError, match="unknown sub-task 'x'"):
        build_graph(task(SubTask(name="a", does=RIGHT, after=("x",))))


@pytest.mark.parametrize(
    ("other", "joint"),
    [
        (GoToPoint(limb="right_arm", to="head.back"), "right_shoulder_y"),
        (GetPosture(joints=("right_elbow",), posture={"right_elbow": 30}), "right_elbow"),
    ],
)  # fmt: skip
def test_two_that_claim_a_joint_at_once_are_refused(body: Body, other, joint: str) -> None:
    spec = task(SubTask(name="a", does=RIGHT), SubTask(name="b", does=other, after=()))
    with pytest.raises(SpecError, match=f"'b' and 'a' both claim {joint}"):
        bind_task(spec, body)


def test_claims_are_in_order_however_the_graph_winds(body: Body) -> None:
    """A diamond: both arms at once, then one arm again."""
    spec = task(
        SubTask(name="a", does=RIGHT),
        SubTask(name="b", does=LEFT, after=("a",)),
        SubTask(name="c", does=RIGHT, after=("a",)),
        SubTask(name="d", does=RIGHT, after=("b", "c")),
    )
    bind_task(spec, body)
    broken = (*spec.subtasks[:3], SubTask(name="d", does=RIGHT, after=("b",)))
    with pytest.raises(SpecError, match="'d' and 'c' both claim"):
        bind_task(spec.model_copy(update={"subtasks": broken}), body)


def test_an_error_of_binding_says_where_it_stands(body: Body) -> None:
    text = """task: t
subtasks:
  - {name: a, primitive: go-to-point, limb: right_arm, to: head.top}
  - {name: b, primitive: go-to-point, limb: right_arm, to: moon}
"""
    spec, document = task_from_text(text, "t.yaml")
    with pytest.raises(SpecError, match=r"t.yaml:4:60: b: unknown landmark 'moon'.*head.top"):
        bind_task(spec, body, document)
    spec, document = task_from_text("start: yoga\n" + text, "t.yaml")
    with pytest.raises(SpecError, match=r"unknown"):
        bind_task(spec, body, document)


def test_the_graph_is_drawn_with_words_and_times() -> None:
    spec = task(
        SubTask(name="a", does=RIGHT, words='say "hello"'), SubTask(name="b", does=LEFT), tempo=60
    )
    graph = build_graph(spec)
    whole = json.loads(to_json(graph))
    assert whole["edges"] == [{"from": "a", "to": "b"}]
    assert whole["nodes"][1]["limb"] == "left_arm"
    assert whole["planned"]["b"] == {"start": 1.0, "end": 2.0}
    mermaid, dot = to_mermaid(graph), to_dot(graph)
    assert mermaid.startswith("flowchart TD\n")
    assert "s0 --> s1" in mermaid
    assert "say #34;hello#34;" in mermaid
    assert "s0 -> s1;" in dot
    assert dot.count("{") == dot.count("}") == 1


def test_a_large_graph_compiles(body: Body) -> None:
    subtasks = [
        SubTask(name=f"s{k}", does=RIGHT if k % 2 else LEFT, seconds=0.01) for k in range(2000)
    ]
    bound = bind_task(task(*subtasks), body)
    assert len(bound.fields) == 2000
    assert nx.is_directed_acyclic_graph(bound.graph.graph)

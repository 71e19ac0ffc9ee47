"""A graph written as JSON is the same task; every format holds any words; mistakes are placed."""

import json

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from adonis.dancing import run_task
from primitives import GetPosture, GoToPoint, Oscillate, Place
from sim import Body
from specs import (
    Background,
    Condition,
    Join,
    Repeat,
    SpecError,
    SubTask,
    TaskSpec,
    bind_task,
    build_graph,
    claims_of,
    library,
    load_task,
    task_from_text,
    to_dot,
    to_graphml,
    to_json,
    to_mermaid,
)

CONDITIONS = (
    Condition(event="go"),
    Condition(near="head.top", limb="right_arm", distance=0.1 / 3.0),
)
DOES = (
    GoToPoint(limb="right_arm", to=Place(point=(0.4, -0.1, 1e-5)), palm=(0, 0, 1)),
    GoToPoint(limb="left_arm", to="head.top", stiffness=500),
    GetPosture(joints=("neck",), posture={"neck_y": 15, "neck_x": 0, "neck_z": 0}),
    Oscillate(joints={"waist_x": {"amplitude": 3}}, beats_per_cycle=0.3, centre={"waist_x": 1}),
)
positive = st.floats(1e-6, 1e6)


@st.composite
def tasks(draw) -> TaskSpec:
    """Any task whose graph can be built: branches, joins, loops, conditions, any words."""
    count = draw(st.integers(1, 7))
    subtasks: list[SubTask] = []
    spared: set[str] = set()
    for i in range(count):
        name, earlier = f"s{i}", [f"s{j}" for j in range(i)]
        said: dict = {"name": name, "does": draw(st.sampled_from(DOES))}
        said["words"] = draw(st.text(max_size=12))
        if draw(st.booleans()):
            said[draw(st.sampled_from(["beats", "seconds"]))] = draw(positive)
        if earlier and name not in spared and draw(st.integers(0, 4)) == 0:
            said["while"] = draw(st.sampled_from(earlier))
        else:
            some = st.lists(st.sampled_from(earlier), unique=True) if earlier else st.just([])
            some = some.map(tuple)
            if name not in spared and draw(st.booleans()):
                said["after"] = draw(some)
                policy = draw(st.sampled_from([None, "all", "any", "first"]))
                if policy and said["after"]:
                    said["after"] = Join(**{policy: said["after"]})
            if draw(st.booleans()):
                said |= {"done": draw(st.sampled_from(CONDITIONS)), "timeout": draw(positive)}
            if draw(st.booleans()):
                said["repeat"] = Repeat(until=CONDITIONS[0], times=3)
            if draw(st.booleans()):
                said["if"] = draw(st.sampled_from(CONDITIONS))
            later = [f"s{j}" for j in range(i + 1, count) if f"s{j}" not in spared]
            if later and {"timeout", "if", "repeat"} & said.keys() and draw(st.booleans()):
                said["otherwise"] = draw(st.sampled_from(later))
                spared.add(said["otherwise"])
        subtasks.append(SubTask(**said))
    return TaskSpec(
        task="t",
        title=draw(st.text(max_size=12)),
        tempo=draw(st.floats(1, 1000)),
        background=(Background(name="b", does=DOES[2]),),
        subtasks=tuple(subtasks),
    )


@given(tasks())
def test_a_graph_written_as_json_is_the_same_task(spec: TaskSpec) -> None:
    graph = build_graph(spec)
    text = to_json(graph)
    json.loads(text)
    again, document = task_from_text(text, "t.json")
    regained = build_graph(again, document)
    assert regained.edges == graph.edges
    assert regained.planned == graph.planned
    assert to_json(regained) == text
    free = {"after": None}  # the edges have it, and there may be several ways to say it
    assert [s.model_copy(update=free) for s in again.subtasks] == [
        s.model_copy(update=free) for s in spec.subtasks
    ]
    assert again.model_copy(update={"subtasks": spec.subtasks}) == spec


@given(st.text(max_size=40))
def test_pictures_hold_any_words(words: str) -> None:
    spec = TaskSpec(task="t", title=words, subtasks=[SubTask(name="a", does=DOES[0], words=words)])
    graph = build_graph(spec)
    (line,) = to_mermaid(graph).splitlines()[1:]
    assert line.count('"') == 2
    assert to_dot(graph).count("\n") == 4
    read = nx.parse_graphml(to_graphml(graph))
    assert set(read.nodes) == {"a"}


@pytest.mark.parametrize("name", library())
def test_every_task_of_the_library_survives(name: str) -> None:
    spec, document = load_task(name)
    text = to_json(build_graph(spec, document))
    for indent in (2, None, "\t"):  # as other programs may write it
        again, _ = task_from_text(json.dumps(json.loads(text), indent=indent))
        assert to_json(build_graph(again)) == text


def test_it_moves_the_same_bit_by_bit(body: Body) -> None:
    text = """task: t
tempo: 200
background: [{name: weight, primitive: compensate-gravity}]
subtasks:
  - {name: a, primitive: go-to-point, limb: right_arm, to: chest.front}
  - {name: b, primitive: get-posture, limb: left_arm, posture: rest, after: []}
  - {name: nod, primitive: get-posture, joints: [neck], posture: upright, while: a}
  - {name: c, primitive: go-to-point, limb: right_arm, to: belly.front, after: {any: [a, b]}}
"""
    text = text.replace("after: {any: [a, b]}", "after: [a, b], repeat: 2")
    spec, document = task_from_text(text)
    again, _ = task_from_text(to_json(build_graph(spec, document)))
    one, two = (run_task(bind_task(s, body), contributions=False)[0] for s in (spec, again))
    np.testing.assert_array_equal(one.qpos, two.qpos)
    assert one.spans == two.spans


def test_claims_are_named(body: Body) -> None:
    spec, document = load_task("all-at-once")
    bound = bind_task(spec, body, document)
    claims = claims_of(bound)
    assert claims["reach-out"] == ("right_arm",)
    assert claims["look"] == ("neck",)
    assert set(claims["wave"]) == {"left_elbow", "left_wrist_y"}
    whole = json.loads(to_json(bound.graph, claims))
    assert whole["planned"]["look"]["claims"] == ["neck"]
    graph = nx.parse_graphml(to_graphml(bound.graph, claims))
    assert graph.nodes["wave"]["claims"] == "left_elbow, left_wrist_y"
    assert graph.nodes["wave"]["start"] == pytest.approx(bound.graph.planned["wave"][0])
    assert graph.edges["raise", "wave"]["kind"] == "after"
    for shown in (to_mermaid(bound.graph, claims), to_dot(bound.graph, claims)):
        assert "left elbow, left wrist y" in shown


GRAPH = """{
  "task": "t",
  "nodes": [
    {"name": "a", "primitive": "get-posture", "limb": "right_arm", "posture": "rest"},
    {"name": "b", "primitive": "get-posture", "limb": "right_arm", "posture": "rest"},
    {"name": "c", "primitive": "get-posture", "limb": "left_arm", "posture": "rest"}
  ],
  "edges": [
    {"from": "a", "to": "b"},
    {"from": "b", "to": "c"}
  ]
}
"""
LAST = '{"from": "b", "to": "c"}'
WRONG = {
    "an unknown node": (LAST.replace('"c"', '"d"'), r"t.json:10:25: unknown node 'd'.*a, b, c"),
    "an unknown kind": (
        LAST.replace("}", ', "kind": "befor"}'),
        r"t.json:10:38: unknown kind of edge 'befor'.*after",
    ),
    "an unknown key": (LAST.replace("to", "too"), "t.json:10:19: unknown key of an edge 'too'"),
    "no end": ('{"from": "b"}', "t.json:10:5: 'to' is missing"),
    "no edge": ("3", "t.json:10:5: edges, item 2, expected keys and values"),
    "a circle": (LAST.replace('"c"', '"a"'), r"t.json:(9|10):\d+: .* each other: a -> b -> a"),
    "two kinds": (
        LAST + ', {"from": "a", "to": "c", "kind": "any"}',
        "t.json:10:31: 'c' comes after others by edges of kind after and any",
    ),
    "two otherwise": (
        ", ".join(f'{{"from": "a", "to": "{to}", "kind": "otherwise"}}' for to in "bc"),
        "t.json:10:.*: an edge of kind otherwise leaves 'a' already",
    ),
    "two reasons": (
        '{"from": "a", "to": "c"}, {"from": "b", "to": "c", "kind": "while"}',
        "while goes without after",
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", WRONG)
def test_mistakes_in_edges_are_placed(kind: str) -> None:
    edges, said = WRONG[kind]
    with pytest.raises(SpecError, match=said):
        build_graph(*task_from_text(GRAPH.replace(LAST, edges), "t.json"))


def test_mistakes_in_nodes_are_placed(body: Body) -> None:
    bad = GRAPH.replace('"left_arm"', '"third_arm"')
    spec, document = task_from_text(bad, "t.json")
    with pytest.raises(SpecError, match=r"t.json:6:\d+: c: unknown limb 'third_arm'"):
        bind_task(spec, body, document)
    with pytest.raises(SpecError, match=r"t.json:4:\d+: in a graph the edges say 'after'"):
        task_from_text(GRAPH.replace('"name": "a",', '"name": "a", "after": [],'), "t.json")
    with pytest.raises(SpecError, match=r"give one of the two"):
        task_from_text(GRAPH.replace('"edges"', '"subtasks": [], "edges"'), "t.json")
    with pytest.raises(SpecError, match=r"'edges' is missing"):
        task_from_text('{"task": "t", "nodes": []}', "t.json")
    unnamed = (
        GRAPH.replace('"name": "c"', '"name": ["c"]')
        .replace(LAST, "")[:-1]
        .replace('"b"},\n', '"b"}\n')
    )
    with pytest.raises(SpecError, match=r"t.json:6:\d+: name should be a valid string"):
        task_from_text(unnamed, "t.json")


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.floats() | st.sampled_from(["a", "b", "after", "kind", ""]),
    lambda inside: (
        st.lists(inside, max_size=3)
        | st.dictionaries(st.sampled_from(["name", "from", "to", "kind", "x"]), inside, max_size=3)
    ),
    max_leaves=6,
)


@given(st.sampled_from(["nodes", "edges", "planned"]), st.integers(0, 3), ANYTHING)
def test_whatever_stands_in_a_graph_there_is_one_message(
    key: str, place: int, thing: object
) -> None:
    whole = json.loads(GRAPH)
    if key in whole and place < len(whole[key]):
        whole[key][place] = thing
    else:
        whole[key] = thing
    said = "t.json: nothing"
    try:
        build_graph(*task_from_text(json.dumps(whole), "t.json"))
    except SpecError as problem:
        said = str(problem)
    assert said.startswith("t.json:")
    assert "\n" not in said

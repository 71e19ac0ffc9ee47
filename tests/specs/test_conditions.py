"""Conditions in a task file: read, written again, drawn, planned; nonsense is refused."""

import json
import textwrap

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from primitives import GetPosture
from sim import Body
from specs import (
    Join,
    SpecError,
    SubTask,
    TaskSpec,
    bind_task,
    build_graph,
    task_from_text,
    task_to_yaml,
    to_dot,
    to_json,
    to_mermaid,
)
from specs.ordering import order_of

TASK = textwrap.dedent("""\
    task: t
    subtasks:
      - {name: a, primitive: get-posture, joints: [neck], posture: upright, done: {event: go},
         timeout: 3, otherwise: c}
      - {name: b, primitive: get-posture, limb: right_arm, posture: rest, seconds: 2,
         if: {near: head.top, limb: right_arm, distance: 0.5}}
      - {name: c, primitive: get-posture, limb: right_arm, posture: rest, repeat: 3}
      - {name: d, primitive: get-posture, limb: right_arm, posture: rest, after: {first: [b, c]},
         repeat: {until: {event: stop}, times: 4}}
      - {name: e, primitive: get-posture, joints: [waist], posture: upright, while: d}
    """)


def test_a_task_with_conditions_is_read_written_and_read_the_same(body: Body) -> None:
    spec, document = task_from_text(TASK, "t.yaml")
    again, _ = task_from_text(task_to_yaml(spec))
    assert again == spec
    bound = bind_task(spec, body, document)
    assert bound.events == ("go", "stop")
    assert bound.may_wait
    assert spec.subtasks[3].after == Join(first=("b", "c"))


def test_the_plan_leaves_no_branch_out() -> None:
    planned = build_graph(task_from_text(TASK)[0]).planned
    assert planned == {"a": (0, 1), "b": (1, 3), "c": (3, 6), "d": (3, 7), "e": (3, 7)}


def test_the_graph_shows_conditions() -> None:
    graph = build_graph(task_from_text(TASK)[0])
    mermaid, dot, whole = to_mermaid(graph), to_dot(graph), json.loads(to_json(graph))
    ids = {name: f"s{k}" for k, name in enumerate(graph.order)}
    assert f"{ids['a']} -. otherwise .-> {ids['c']}" in mermaid
    assert f"{ids['d']} -. while .-> {ids['e']}" in mermaid
    assert f"{ids['b']} -->|first| {ids['d']}" in mermaid
    assert "until event go" in mermaid
    assert f'{ids["a"]} -> {ids["c"]} [label="otherwise" style=dashed];' in dot
    assert {"from": "b", "to": "d", "kind": "first"} in whole["edges"]
    assert {"from": "a", "to": "b"} in whole["edges"]
    said = {name: planned.get("circumstances") for name, planned in whole["planned"].items()}
    assert said == {
        "a": "until event go",
        "b": "if right_arm within 0.5 m of head.top",
        "c": "3 times",
        "d": "repeated until event stop, at most 4 times",
        "e": "while d",
    }


def read_and_bind(text: str, body: Body) -> None:
    spec, document = task_from_text(text, "t.yaml")
    bind_task(spec, body, document)


@pytest.mark.parametrize(
    ("old", "new", "at", "said"),
    [
        ("otherwise: c", "otherwise: x", "x}", "unknown sub-task 'x'"),
        ("{first: [b, c]}", "{first: [b, x]}", "x]}", "unknown sub-task 'x'"),
        ("while: d", "while: x", "x}", "unknown sub-task 'x'"),
        ("{first: [b, c]}", "{frist: [b, c]}", "frist:", "'frist'; did you mean 'first'"),
        ("{first: [b, c]}", "{first: [b], any: [c]}", "{first:", "one of all, any and first"),
        ("{first: [b, c]}", "{first: []}", "{first:", "one of all, any and first"),
        ("{event: go}", "{evnet: go}", "evnet:", "unknown key 'evnet'; did you mean 'event'"),
        ("{event: go}", "{event: go, near: head.top}", "{event", "a condition is {event: NAME}"),
        (", distance: 0.5", "", "{near:", "near needs a landmark, a limb and a distance"),
        ("{near: head.top", "{near: haed.top", "haed.top", "b: unknown landmark 'haed.top'"),
        ("limb: right_arm, distance", "limb: tail, distance", "tail", "b: unknown limb 'tail'"),
        ("distance: 0.5", "distance: -1", "-1", "distance should be greater than 0"),
        ("timeout: 3, otherwise: c", "otherwise: c", "{name: a", "needs a time"),
        ("{event: go}", "on-time", "{name: a", "tolerance and timeout go with done: reached"),
        ("{event: go}", "reachd", "reachd,", "done should be 'on-time' or 'reached'"),
        ("repeat: 3", "repeat: 0", "0}", "repeat should be greater than or equal to 1"),
        ("repeat: 3", "repeat: 2.5", "2.5}", "repeat"),
        (", times: 4", "", "{until:", "'times' is missing"),
        ("repeat: 3", "after: [a]", "after:", "'c' is the 'otherwise' of 'a', and so takes"),
        ("while: d", "while: d, after: [a]", "{name: e,", "while goes without after, if, done"),
        ("while: d", "otherwise: b", "{name: e,", "otherwise goes with a timeout, with if"),
        ("repeat: 3", "while: e", "e}", "'c' begins because of 'a' already"),
        ("while: d", "while: e", "{name: e,", "wait for each other: e -> e"),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused_at_its_place(body, old, new, at, said) -> None:
    assert TASK.count(old) == 1
    text = TASK.replace(old, new)
    with pytest.raises(SpecError) as caught:
        read_and_bind(text, body)
    file, line, column, message = str(caught.value).split(":", 3)
    assert file == "t.yaml"
    assert text.splitlines()[int(line) - 1][int(column) - 1 :].startswith(at), str(caught.value)
    assert said in message
    assert "\n" not in message


# --- claims --------------------------------------------------------------------------------------

NECK = GetPosture(joints=("neck",), posture="upright")
WAIST = GetPosture(joints=("waist",), posture="upright")
ELBOW = GetPosture(joints=("right_elbow",), posture={"right_elbow": 30})
WAIT = {"done": {"event": "go"}, "timeout": 1.0}


def bind(body: Body, *subtasks: SubTask) -> None:
    bind_task(TaskSpec(task="t", subtasks=subtasks), body)


def test_branches_that_exclude_each_other_may_claim_one_joint(body: Body) -> None:
    bind(
        body,
        SubTask(name="try", does=WAIST, otherwise="c", **WAIT),
        SubTask(name="b", does=NECK),
        SubTask(name="b2", does=NECK),
        SubTask(name="c", does=NECK),
        SubTask(name="c2", does=NECK),
        SubTask(name="d", does=NECK, after=("b2", "c2")),
    )


@pytest.mark.parametrize(
    ("subtasks", "pair"),
    [
        (  # `any` lets the other run on
            (
                SubTask(name="a", does=NECK, after=()),
                SubTask(name="b", does=WAIST, after=()),
                SubTask(name="c", does=NECK, after=Join(any=("a", "b"))),
            ),
            "'c' and 'a'",
        ),
        (  # on the way there it does too
            (
                SubTask(name="a", does=NECK, after=()),
                SubTask(name="b", does=WAIST, after=()),
                SubTask(name="m", does=WAIST, after=Join(any=("a", "b"))),
                SubTask(name="c", does=NECK, after=("m",)),
            ),
            "'m' and 'b'",
        ),
        (  # two that are on together
            (SubTask(name="a", does=NECK), SubTask(name="b", does=NECK, while_="a")),
            "'b' and 'a'",
        ),
        (  # what follows one branch may meet the other
            (
                SubTask(name="try", does=WAIST, otherwise="c", **WAIT),
                SubTask(name="b", does=WAIST, after=("try",)),
                SubTask(name="c", does=NECK),
                SubTask(name="m", does=ELBOW, after=Join(any=("b", "c"))),
                SubTask(name="x", does=NECK, after=()),
            ),
            "'c' and 'x'",
        ),
    ],
)
def test_what_may_run_at_once_may_not_claim_one_joint(body: Body, subtasks, pair: str) -> None:
    first, second = pair.replace("'", "").split(" and ")
    either = f"'({first}|{second})'"
    said = f"{either} and .*at once: name one in|{either} may still run then, but both claim"
    with pytest.raises(SpecError, match=said):
        bind(body, *subtasks)


def test_after_the_first_nothing_that_leads_to_it_runs(body: Body) -> None:
    bind(
        body,
        SubTask(name="a", does=NECK, after=()),
        SubTask(name="a2", does=NECK),
        SubTask(name="b", does=WAIST, after=()),
        SubTask(name="c", does=NECK, after=Join(first=("a2", "b"))),
    )


@given(st.data())
@settings(max_examples=200)
def test_without_conditions_what_is_over_is_what_leads_to_it(data) -> None:
    count = data.draw(st.integers(1, 12))
    subtasks = tuple(
        SubTask(
            name=f"s{k}",
            does=NECK,
            after=tuple(f"s{j}" for j in sorted(data.draw(st.sets(st.integers(0, k - 1)))))
            if k
            else (),
        )
        for k in range(count)
    )
    task = build_graph(TaskSpec(task="t", subtasks=subtasks))
    for name, known in zip(task.order, order_of(task), strict=True):
        above = {task.order.index(a) for a in nx.ancestors(task.graph, name)}
        assert known.over == sum(1 << a for a in above)

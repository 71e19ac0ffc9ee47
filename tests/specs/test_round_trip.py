"""Text to task to graph to text keeps the meaning; and the schema allows all that is written."""

import json
from functools import cache

from hypothesis import assume, given, settings
from hypothesis import strategies as st
from jsonschema import Draft7Validator

from primitives import (
    AvoidCollisions,
    CompensateGravity,
    Follow,
    GetPosture,
    GoToPoint,
    Hold,
    LookAt,
    Oscillate,
    PointAt,
    Primitive,
    Relax,
)
from specs import (
    SHIPPED_SCHEMA,
    Background,
    Condition,
    Group,
    Join,
    Repeat,
    SpecError,
    SubTask,
    TaskSpec,
    build_graph,
    task_from_text,
    task_to_yaml,
)
from specs.definitions import Landmark, NamedPosture
from specs.reading import read_text
from specs.tempo import TempoStep

NUMBERS = st.floats(0.001, 1000, allow_nan=False)
SIGNED = st.floats(-10, 10, allow_nan=False)
VECTORS = st.tuples(SIGNED, SIGNED, SIGNED)
NAMES = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,8}", fullmatch=True)
WORDS = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=40)
PLACES = st.one_of(
    NAMES,
    st.builds(lambda n, a, o: {"near": n, "away": a, "offset": o}, NAMES, SIGNED, VECTORS),
    st.builds(lambda p: {"point": p}, VECTORS),
)
TARGETS = PLACES | st.builds(lambda h: {"hand": h}, NAMES)
DIRECTIONS = st.sampled_from(["forward", "up"]) | VECTORS
POSTURES = NAMES | st.dictionaries(NAMES, SIGNED | DIRECTIONS, min_size=1, max_size=3)
CONDITIONS = st.builds(lambda e: Condition(event=e), NAMES) | st.builds(
    lambda n, limb, d: Condition(near=n, limb=limb, distance=d), NAMES, NAMES, NUMBERS
)


@st.composite
def primitives(draw: st.DrawFn) -> Primitive:
    """Any primitive of the package with some of its parameters."""
    via = draw(
        st.lists(st.fixed_dictionaries({"near": NAMES, "at": st.floats(0.1, 0.9)}), max_size=2)
    )
    swings = draw(st.dictionaries(NAMES, st.builds(lambda a: {"amplitude": a}, st.floats(1, 90)),
                                  min_size=1, max_size=3))  # fmt: skip
    rises = draw(st.lists(NUMBERS, min_size=2, max_size=4, unique=True).map(sorted))
    points = [draw(VECTORS) for _ in rises]
    makers = [
        lambda: GetPosture(limb=draw(NAMES), posture=draw(POSTURES), stiffness=draw(NUMBERS)),
        lambda: GetPosture(joints=draw(st.lists(NAMES, min_size=1, max_size=3)),
                           posture=draw(POSTURES), via=[{"posture": draw(POSTURES)}]),
        lambda: GoToPoint(limb=draw(NAMES), to=draw(PLACES), via=via, palm=draw(DIRECTIONS)),
        lambda: GoToPoint(limb=draw(NAMES), to=draw(PLACES), controller="torque-field", width=1.5),
        lambda: Oscillate(joints=swings, beats_per_cycle=draw(NUMBERS),
                          then=[{"cycle": draw(NUMBERS), "frequency": draw(NUMBERS)}]),
        lambda: Follow(limb=draw(NAMES), trajectory={"times": rises, "points": points}),
        lambda: Follow(limb=draw(NAMES), to=draw(TARGETS)),
        lambda: LookAt(at=draw(TARGETS), settle=draw(NUMBERS)),
        lambda: PointAt(limb=draw(NAMES), at=draw(TARGETS)),
        lambda: Hold(limb=draw(NAMES)),
        lambda: Relax(joints=draw(st.lists(NAMES, min_size=1, max_size=3)), limp=True),
        lambda: AvoidCollisions(pairs=[(draw(NAMES), draw(NAMES))]),
        CompensateGravity,
    ]  # fmt: skip
    return draw(st.sampled_from(makers))()


@st.composite
def subtasks(draw: st.DrawFn, name: str, others: list[str]) -> SubTask:
    """A sub-task that may come after those above it."""
    given = {"name": name, "does": draw(primitives()), "words": draw(WORDS)}
    timing = draw(st.sampled_from([{}, {"beats": draw(NUMBERS)}, {"seconds": draw(NUMBERS)}]))
    waits = draw(st.sampled_from([
        {}, {"done": "reached", "tolerance": draw(NUMBERS), "timeout": draw(NUMBERS)},
        {"done": draw(CONDITIONS), "timeout": draw(NUMBERS)}, {"if": draw(CONDITIONS)},
        {"repeat": draw(st.integers(1, 9))},
        {"repeat": Repeat(until=draw(CONDITIONS), times=3)}, {"hand_over": draw(NUMBERS)},
    ]))  # fmt: skip
    if others:
        few = draw(st.lists(st.sampled_from(others), min_size=1, max_size=3, unique=True))
        after = draw(st.sampled_from([{}, {"after": few}, {"after": []}, {"after": Join(any=few)}]))
        if not waits:
            after = draw(st.sampled_from([after, {"while": few[0]}]))
        given |= after
    return SubTask(**given, **timing, **waits)


@st.composite
def tasks(draw: st.DrawFn) -> TaskSpec:
    """A task with whatever a task can have."""
    names = draw(st.lists(NAMES, min_size=1, max_size=5, unique=True))
    steps = [draw(subtasks(name, names[:k])) for k, name in enumerate(names)]
    beside = draw(st.lists(NAMES.filter(lambda n: n not in names), max_size=2, unique=True))
    tempo_map = [TempoStep(beat=draw(NUMBERS), tempo=90)] if draw(st.booleans()) else []
    tempo_map += [TempoStep(subtask=draw(st.sampled_from(names)), tempo=draw(st.floats(1, 1000)))]
    landmark = draw(st.sampled_from([
        {"near": draw(NAMES), "away": draw(SIGNED), "offset": draw(VECTORS)},
        {"between": (draw(NAMES), draw(NAMES))},
    ]))  # fmt: skip
    posture = draw(st.dictionaries(NAMES.filter(lambda n: n != "from"), SIGNED, max_size=2))
    return TaskSpec(
        task=draw(NAMES),
        title=draw(WORDS),
        source=draw(WORDS),
        tempo=draw(st.floats(1, 1000)),
        tempo_map=tempo_map,
        start=draw(st.none() | NAMES),
        coda=draw(NUMBERS),
        safety=draw(st.sampled_from(["none", "filter"])),
        landmarks={draw(NAMES): Landmark(**landmark)},
        postures={draw(NAMES): NamedPosture(**{"from": draw(NAMES), **posture})},
        background=[Background(name=name, does=draw(primitives())) for name in beside],
        groups=[Group(name="g", rule="weighted", members=names, weights={names[0]: 2.5})],
        subtasks=steps,
    )


@cache
def schema() -> Draft7Validator:
    return Draft7Validator(json.loads(SHIPPED_SCHEMA.read_text(encoding="utf-8")))


@settings(max_examples=100)
@given(tasks())
def test_a_task_means_the_same_after_it_was_written_and_read(spec: TaskSpec) -> None:
    try:
        graph = build_graph(spec)
    except SpecError:
        assume(False)
    text = task_to_yaml(spec)
    again, document = task_from_text(text, "again.yaml")
    assert again == spec
    other = build_graph(again, document)
    assert other.planned == graph.planned
    assert set(other.graph.edges(data="kind")) == set(graph.graph.edges(data="kind"))
    assert task_to_yaml(other.spec) == text
    found = [f"{list(e.path)}: {e.message}" for e in schema().iter_errors(document.data)]
    assert not found, "what Adonis reads, an editor allows"
    assert read_text(text, "x").data == document.data

"""Characters dance by rule; a search tunes what is left, and goes on where it was broken off."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from adonis.adapting import adapting
from adonis.adapting.adapting import adapt
from adonis.adapting.knobs import KNOBS, turned
from adonis.adapting.searching import Factors, search
from adonis.adapting.trying import Mark, marks
from adonis.adapting.writing import adapted_text, difference
from adonis.cli import app
from adonis.dancing import run_task
from adonis.judging import judge
from primitives import GoToPoint
from sim import Body, Gains, load_body, renamed
from specs import Firmness, bind_task, fitted, load_task, task_from_text

# A reach and a way back, which a giant does too slowly at the tempo of Adonis.
TEXT = """\
# Up and down.
task: brisk
body: adonis
tempo: 150   # quick
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: arms, primitive: get-posture, joints: [right_arm, left_arm], posture: rest}
  - {name: guard, primitive: avoid-collisions}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - name: out      # to the side
    primitive: go-to-point
    limb: right_arm
    to: {point: [0.40, -0.30, 0.35]}
    via: [{near: belly.front, away: 0.3, at: 0.4}]
  - {name: up, primitive: get-posture, limb: left_arm, posture: {arm: forward, palm: up}}
"""
BUDGET = 19


@pytest.fixture(autouse=True)
def cache(tmp_path: Path) -> Iterator[Path]:
    """A cache of our own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("platformdirs.user_cache_path", lambda name: tmp_path / name)
        yield tmp_path


@pytest.fixture(scope="module")
def giant() -> Body:
    return load_body("adonis-giant")


@pytest.mark.parametrize("name", ["adonis-child", "adonis-weight", "adonis-giant"])
def test_the_family_dances_the_macarena_from_the_same_file(name: str) -> None:
    spec, document = load_task("macarena")
    task = bind_task(spec, load_body(name), document)
    (recording,) = run_task(task, contributions=False)
    judgement = judge(recording, task.spec)
    assert judgement.passed == 12
    assert judgement.success, [check for check in judgement.checks if not check.success]


def test_gains_that_are_not_scaled_do_worse(giant: Body) -> None:
    """The man's gains on a giant: what the laws are for."""
    spec, _ = load_task("macarena")
    man, fits = load_body("adonis"), fitted(spec, giant)
    weak = renamed(giant, Gains.of(man.map).on(giant.map))
    (recording,) = run_task(bind_task(fits, weak), contributions=False)
    assert judge(recording, fits).passed < 6


def test_a_search_is_never_worse_than_its_start_and_gets_better(giant: Body) -> None:
    spec, _ = task_from_text(TEXT)
    begun = fitted(spec, giant, tempo=150)
    made = adapt(begun, giant, budget=BUDGET, keep_tempo=True)
    found = made.found
    assert found.tried == BUDGET
    assert found.start == marks([bind_task(begun, giant)])[0]
    assert found.mark.key < found.start.key
    assert made.spec.tempo == begun.tempo
    assert "time" not in found.factors
    again = marks([bind_task(made.spec, giant)])[0]
    assert again == found.mark, "what is written is what was tried"


def bowl(candidates: Sequence[Factors]) -> list[Mark]:
    """Better the nearer the stiffness of the hands is to 1.5, and the less else is turned."""
    costs = [
        50.0
        * sum(np.log(f / (1.5 if name == "hands" else 1.0)) ** 2 for name, f in factors.items())
        for factors in candidates
    ]
    return [Mark(0, 1, float(cost)) for cost in costs]


def test_the_same_seed_finds_the_same_and_another_something_else() -> None:
    one, same, other = (search(bowl, 60, seed=seed) for seed in (3, 3, 4))
    assert one == same
    assert one.factors != other.factors
    assert one.mark.cost < 0.8 * one.start.cost


@pytest.mark.parametrize("generations", [1, 2, 5])
def test_a_search_that_was_broken_off_goes_on_as_if_nothing_had_been(generations: int) -> None:
    every: list[Sequence[Mark]] = []
    whole = search(bowl, 60, seed=1, done=lambda seen, _: every.append(seen))
    asked = 0

    def counted(candidates: Sequence[Factors]) -> list[Mark]:
        nonlocal asked
        asked += len(candidates)
        return bowl(candidates)

    resumed = search(counted, 60, seed=1, known=every[:generations])
    assert resumed == whole
    assert asked == whole.tried - sum(len(seen) for seen in every[:generations])


def test_a_killed_adaptation_is_resumed_from_the_cache(
    giant: Body, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec, _ = task_from_text(TEXT)
    begun = fitted(spec, giant, tempo=150)
    danced = 0

    def few(tasks: Sequence[object], **options: object) -> list[Mark]:
        nonlocal danced
        if danced >= 10:
            raise KeyboardInterrupt
        danced += len(tasks)
        return marks(tasks, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(adapting, "marks", few)
    with pytest.raises(KeyboardInterrupt):
        adapt(begun, giant, budget=BUDGET, keep_tempo=True)
    danced = -100
    resumed = adapt(begun, giant, budget=BUDGET, keep_tempo=True)
    assert danced == -100 + BUDGET - 10, "the first two generations were known"
    fresh = adapt(begun, giant, budget=BUDGET, keep_tempo=True, afresh=True)
    assert resumed == fresh


@pytest.mark.parametrize("kept", [None, 3, {}, [[1]], [[["a", 1, 2]]], [[[1, 2, None]]]])
def test_damaged_marks_are_none(kept: object) -> None:
    assert adapting._marks_in(kept) == []


def test_knobs_turn_what_they_say() -> None:
    spec, _ = task_from_text(TEXT)
    names = {knob.name for knob in KNOBS}
    assert turned(spec, dict.fromkeys(names, 1.0)) == spec
    made = turned(spec, {"joints": 1.2, "travel": 1.1, "detour": 1.5, "time": 1.25})
    assert made.gains == Firmness(joints=1.2)
    assert made.tempo == 120
    does = made.subtasks[0].does
    assert isinstance(does, GoToPoint)
    assert does.travel == pytest.approx(0.935)
    assert does.via[0].away == pytest.approx(0.45)
    assert made.subtasks[1].does == spec.subtasks[1].does
    twice = turned(made, {"joints": 0.5})
    assert twice.gains == Firmness(joints=0.6)


def test_an_adapted_task_is_the_old_file_with_other_values(giant: Body) -> None:
    spec, _ = task_from_text(TEXT)
    after = turned(fitted(spec, giant), {"hands": 1.3, "travel": 0.9})
    text = adapted_text(spec, after, TEXT)
    assert task_from_text(text)[0] == after
    for comment in ("# Up and down.", "# quick", "# to the side"):
        assert comment in text
    assert "body: adonis-giant\n" in text
    assert "gains: {joints: 1.0, hands: 1.3" in text or "gains: {hands: 1.3}" in text
    lines = difference(TEXT, text, "one", "other")
    assert "-body: adonis" in lines
    assert "+body: adonis-giant" in lines
    included = "include: [steps.yaml]\n"
    assert task_from_text(adapted_text(spec, after, included))[0] == after


def test_the_command_writes_a_task_that_can_be_danced(tmp_path: Path) -> None:
    file, out = tmp_path / "brisk.yaml", tmp_path / "big.yaml"
    file.write_text(TEXT)
    asked = ["adapt", str(file), "--from", "adonis", "--to", "adonis-giant", "--budget", "1"]
    ended = CliRunner().invoke(app, [*asked, "--out", str(out)])
    assert ended.exit_code in (0, 1), ended.output
    assert "a scale model: joints" in ended.output
    assert "+body: adonis-giant" in ended.output
    spec, _ = load_task(out)
    assert spec == fitted(task_from_text(TEXT)[0], load_body("adonis-giant"))
    run = CliRunner().invoke(app, ["run", str(out), "--out", str(tmp_path / "run")])
    assert run.exit_code == ended.exit_code, "its own body does it, as it was tried"


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (["macarena", "--to", "hercules"], "unknown body 'hercules'"),
        (["macarena", "--from", "adonis-child", "--to", "adonis"], "written for adonis"),
        (["macarena", "--to", "adonis-child", "--tempo", "0"], "between 1 and 1000"),
    ],
)
def test_what_makes_no_sense_ends_with_2(asked: list[str], said: str) -> None:
    ended = CliRunner().invoke(app, ["adapt", *asked])
    assert ended.exit_code == 2
    assert said in ended.output

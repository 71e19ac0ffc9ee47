"""Comparing controllers: the four dances, what the report holds, and a human's figures."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from adonis import measures
from adonis.comparison.claims import (
    CLAIMS,
    OPEN,
    Extras,
    can_claim,
    claims,
    correlations,
    near_human,
)
from adonis.comparison.comparing import DANCERS, Comparison, compare, count_numbers
from adonis.comparison.human import known_human, load_human
from adonis.comparison.report import write_comparison
from adonis.errors import InputError
from sim import Body
from specs import load_task, load_variant, task_from_text, with_controller

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def four(body: Body) -> Comparison:
    return compare("macarena", body, human=known_human("macarena"), costs=False)


@pytest.mark.parametrize("name", DANCERS)
def test_each_of_the_four_dances_succeeds(four: Comparison, name: str) -> None:
    judgement = four[name].judgement
    assert judgement.passed == 12
    assert judgement.success, [c for c in judgement.checks if not c.success]


def test_each_dances_by_its_own_controller(four: Comparison) -> None:
    for name in DANCERS[:3]:
        assert {s.does.controller for s in four[name].spec.subtasks} == {name}
    assert {s.does.controller for s in four["combined"].spec.subtasks} == {"pd-servo", "impedance"}


@pytest.mark.parametrize("name", ["torque-field", "impedance", "combined"])
def test_peak_speeds_are_near_the_humans(four: Comparison, name: str) -> None:
    assert near_human(four, four[name])[0] >= 9


def test_the_papers_sampling_loses_peaks_as_it_does_of_the_human(four: Comparison) -> None:
    # Of the human it loses 11 to 51 %.
    losses = []
    for number in (1, 2, *range(5, 13)):
        at, place = four["combined"].hand(number)
        losses.append(measures.peak_loss(place, float(at[1] - at[0]), 5.0))
    assert 0.0 <= min(losses) < 0.15
    assert 0.3 < max(losses) < 0.6
    assert 0.11 < np.median(losses) < 0.51


def test_jerk_of_the_controllers_goes_together(four: Comparison) -> None:
    rho = {frozenset((a, b)): r for a, b, r, _ in correlations(four)}
    assert len(rho) == 10  # four dancers and a human, in pairs
    assert rho[frozenset(("pd-servo", "torque-field"))] > 0.5


def test_every_claim_says_what_was_measured(four: Comparison) -> None:
    extras = Extras(
        endpoint_force=four["pd-servo"],
        linear=four["impedance"],
        costs={"pd-servo": 1.0, "torque-field": 2.0, "impedance": 3.0, "endpoint-force": 2.0},
        ik=1000.0,
    )
    made = claims(four, extras)
    assert len(made) == len(CLAIMS)
    for claim in made:
        assert claim.said
        assert re.search(r"\d", claim.measured), claim
        assert claim.verdict != OPEN
    order = next(c for c in made if c.said.startswith("Computing cost"))
    assert order.verdict == "reproduced"
    wrong = Extras(four["pd-servo"], four["impedance"], {**extras.costs, "torque-field": 9.0}, 1.0)
    order = next(c for c in claims(four, wrong) if c.said.startswith("Computing cost"))
    assert order.verdict == "not reproduced"


def test_the_report_needs_nothing_beside_it(four: Comparison, tmp_path: Path) -> None:
    written = write_comparison(four, tmp_path, pictures=False)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    sources = re.findall(r'src="([^"]{0,30})', page)
    assert sources
    assert all(s.startswith("data:image/") for s in sources)
    assert "http" not in page.replace("http://www.w3.org", "")
    assert all(name in page for name in DANCERS)
    rows = list(csv.DictReader((tmp_path / "measures.csv").read_text().splitlines()))
    assert len(rows) == 4 * 12
    assert float(rows[0]["peak_speed"]) == pytest.approx(four.dancers[0].moves[0].peak_speed)
    whole = json.loads((tmp_path / "comparison.json").read_text())
    assert [d["passed"] for d in whole["dancers"]] == [12] * 4
    assert all(file.exists() for file in written.files)


# --- parts ------------------------------------------------------------------------------------

SHORT = """
task: short
subtasks:
  - {name: out, primitive: get-posture, limb: right_arm, posture: {arm: forward, palm: down}}
  - {name: heart, primitive: go-to-point, limb: right_arm, to: chest.front,
     via: [{near: chest.front, away: 0.2, at: 0.5}], upper_arm: [1, 0, 0]}
"""


def test_a_task_without_variants_is_swapped_word_by_word(body: Body, tmp_path: Path) -> None:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    comparison = compare(str(path), body, dancers=("pd-servo", "combined"), costs=False)
    assert {s.does.controller for s in comparison["pd-servo"].spec.subtasks} == {"pd-servo"}
    assert not can_claim(comparison)
    assert comparison["combined"].moves[0].path > 0.3
    assert comparison.human is None


def test_a_file_of_its_own_for_a_controller_is_taken(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    (tmp_path / "short-pd-servo.yaml").write_text(SHORT.replace("at: 0.5", "at: 0.7"))
    spec, _ = load_variant(str(tmp_path / "short.yaml"), "pd-servo")
    assert spec.subtasks[1].does.via[0].at == 0.7
    assert spec.subtasks[1].does.controller == "pd-servo"


def test_numbers_that_a_user_gives_are_counted() -> None:
    spec, _ = task_from_text(SHORT)
    assert [count_numbers(s) for s in spec.subtasks] == [0, 5]


def test_swapping_drops_gains_that_mean_something_else() -> None:
    spec, _ = task_from_text(SHORT.replace("to: chest.front,", "to: chest.front, stiffness: 900,"))
    swapped = with_controller(spec, "pd-servo").subtasks[1].does
    assert swapped.stiffness is None
    assert with_controller(spec, "impedance").subtasks[1].does.stiffness == 900


def test_a_controller_that_does_not_exist_is_named(body: Body) -> None:
    with pytest.raises(InputError, match="pd-servo"):
        compare("macarena", body, dancers=("pd-server",), costs=False)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a,b\n1,2\n", "expected a column 'subtask'"),
        ("subtask,jerk\n1,fast\n", ":2: could not convert"),
        ("subtask,jerk\n", "no sub-task"),
    ],
)
def test_a_human_file_that_is_not_one_is_refused(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "human.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        load_human(path)
    with pytest.raises(InputError, match="No such file"):
        load_human(tmp_path / "none.csv")


def test_the_humans_figures_are_those_of_the_package() -> None:
    human = known_human("macarena")
    assert human is not None
    assert len(human.moves) == len(load_task("macarena")[0].subtasks)
    assert human.moves[3].peak_speed == 2.9
    assert human.moves[3].speed.shape == (21,)
    assert "motion-captured" in human.about

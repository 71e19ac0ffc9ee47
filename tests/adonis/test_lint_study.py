"""The verdicts of the lint hold in simulation: a few tasks of each kind of the study."""

import pytest

from adonis.lint_study import FIRST, SHARES, TRIES, table
from sim import Body

SEED = 3000  # below FIRST: what the study measures is not looked at here
TASKS = {"out of reach": 4, "too fast": 5, "collision": 4, "stuck": 3, "joint limit": 4,
         "never": 2, "fight": 4}  # fmt: skip


@pytest.mark.parametrize("kind", TASKS)
def test_verdicts_hold(body: Body, kind: str) -> None:
    cases = [TRIES[kind](body, SEED + k) for k in range(TASKS[kind])]
    assert [case.said for case in cases] == [case.true for case in cases]
    assert all(all(case.advice) for case in cases)
    assert f"| {kind} | {len(cases)} |" in table(cases)


def test_the_study_looks_at_seeds_of_its_own() -> None:
    assert max(TASKS.values()) + SEED < FIRST
    assert set(TASKS) == set(TRIES) == set(SHARES)
    assert sum(SHARES.values()) == pytest.approx(1.0)

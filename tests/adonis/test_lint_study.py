"""The verdicts of the lint hold in simulation: a few tasks of each kind of the study."""

import pytest

from adonis.lint_study import FIRST, TRIES, table
from sim import Body

# Kind -> how many tasks, and how many of their verdicts may be wrong: see docs/measurements.md.
TASKS = {
    "out of reach": (3, 0), "too fast": (5, 1), "collision": (4, 1), "joint limit": (4, 0),
    "never": (2, 0), "fight": (4, 0),
}  # fmt: skip


@pytest.mark.parametrize("kind", TASKS)
def test_verdicts_hold(body: Body, kind: str) -> None:
    tasks, wrong = TASKS[kind]
    cases = [TRIES[kind](body, FIRST + k) for k in range(tasks)]
    assert sum(case.said != case.true for case in cases) <= wrong
    assert f"| {kind} | {tasks} |" in table(cases)

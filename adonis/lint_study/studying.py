"""All tries, and the table of their verdicts."""

from collections.abc import Callable, Iterator, Sequence

from adonis.lint_study.conditions import try_condition
from adonis.lint_study.drawing import Case
from adonis.lint_study.fights import try_fight
from adonis.lint_study.goals import try_goal
from adonis.lint_study.ranges import try_range
from adonis.lint_study.times import ENOUGH, try_time
from adonis.lint_study.ways import try_end, try_way
from sim import Body, adonis

FIRST = 20_000  # seeds below this are for choosing constants
SHARES = {"out of reach": 0.23, "too fast": 0.25, "collision": 0.2, "stuck": 0.1,
          "joint limit": 0.1, "never": 0.06, "fight": 0.06}  # of the tasks  # fmt: skip
TRIES: dict[str, Callable[[Body, int], Case]] = {
    "out of reach": try_goal, "too fast": try_time, "collision": try_way, "stuck": try_end,
    "joint limit": try_range, "never": try_condition, "fight": try_fight,
}  # fmt: skip


def study(tasks: int, seed: int = FIRST) -> list[Case]:
    """That many tasks of all kinds."""
    body = adonis()
    return [
        TRIES[kind](body, seed + k)
        for kind, share in SHARES.items()
        for k in range(max(1, round(share * tasks)))
    ]


def table(cases: Sequence[Case]) -> str:
    """Precision and recall, kind by kind."""
    lines = [
        "| kind | tasks | called | true | both | precision | recall |",
        "|---|---|---|---|---|---|---|",
    ]
    for kind in SHARES:
        own = [c for c in cases if c.kind == kind]
        called, true = [c for c in own if c.said], [c for c in own if c.true]
        both = sum(c.said and c.true for c in own)
        numbers = (len(own), len(called), len(true), both)
        shares = (_share(both, len(called)), _share(both, len(true)))
        lines.append(f"| {kind} | {' | '.join(map(str, numbers))} | {' | '.join(shares)} |")
    return "\n".join([*lines, "", *_advice(cases)])


def _share(part: int, whole: int) -> str:
    return f"{part / whole:.2f}" if whole else "-"


def _advice(cases: Sequence[Case]) -> Iterator[str]:
    timed = [c.advice for c in cases if c.kind == "too fast" and c.advice]
    if timed:
        works, less = (sum(a[k] for a in timed) for k in (0, 1))
        yield f"The shortest time given works in {works} of {len(timed)} tasks;"
        yield f"{ENOUGH:g} of it does not work in {less} of {len(timed)}."
    ways = [c.advice for c in cases if c.kind == "collision" and c.advice]
    if ways:
        yield f"The via point given avoids the collision in {sum(a[0] for a in ways)}"
        yield f"of {len(ways)} tasks."

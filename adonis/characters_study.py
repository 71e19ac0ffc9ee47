"""What each step of adapting a dance to another character is worth: a table.

    python -m adonis.characters_study [TASK]

Each character dances the task with the gains of the man, with gains scaled as if it were a scale
model of him, with gains scaled by what each joint and hand moves, and after a search; in the time
of the laws, and at the tempo of the man. Lengths are scaled in all of them.
"""

import sys
from collections.abc import Iterator

from adonis.adapting.adapting import adapt
from adonis.adapting.trying import Mark, marks
from sim import BODIES, Body, Gains, load_body, renamed, scaled_gains
from specs import TaskSpec, bind_task, fitted, load_task

BUDGET = 91  # candidates of a search


def variants(man: Body, body: Body) -> Iterator[tuple[str, Body]]:
    """A body with one kind of gains after another."""
    own = Gains.of(man.map)
    yield "the man's gains", renamed(body, own.on(body.map))
    geometric, _ = scaled_gains(man, own, body, rule="geometric")
    yield "geometric", renamed(body, geometric.on(body.map))
    yield "mass", body


def row(spec: TaskSpec, man: Body, body: Body, tempo: float | None) -> Iterator[tuple[str, Mark]]:
    """What becomes of a task, step by step."""
    fits = fitted(spec, body, tempo=tempo)
    for name, other in variants(man, body):
        (mark,) = marks([bind_task(fits, other)])
        yield name, mark
    found = adapt(fits, body, budget=BUDGET, keep_tempo=True).found
    yield f"after a search ({found.tried})", found.mark


def main(task: str = "macarena") -> None:
    """Print the table as Markdown."""
    spec, _ = load_task(task)
    man = load_body("adonis")
    head = False
    for name in BODIES:
        body = load_body(name)
        for tempo in dict.fromkeys((fitted(spec, body).tempo, spec.tempo)):
            cells = list(row(spec, man, body, tempo))
            if not head:
                print(f"| character | bpm | {' | '.join(what for what, _ in cells)} |")
                print(f"|---|---|{'---|' * len(cells)}")
                head = True
            told = " | ".join(_told(mark, len(spec.subtasks)) for _, mark in cells)
            print(f"| {name} | {tempo:.4g} | {told} |", flush=True)


def _told(mark: Mark, count: int) -> str:
    """How many sub-tasks succeed, and how many checks of the whole run fail."""
    failed = mark.failures - (count - mark.passed)
    return f"{mark.passed}{f', {failed} checks fail' if failed > 0 else ''}"


if __name__ == "__main__":
    main(*sys.argv[1:])

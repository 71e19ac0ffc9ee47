"""collision: movements on which links go into each other that must not touch."""

from collections.abc import Sequence

from specs.binding import BoundTask
from specs.lint.detours import Via, way_round
from specs.lint.finding import Finding, Places, cm
from specs.lint.move import Move
from specs.lint.together import Together
from specs.lint.touching import Clash, clash

MOST_SEARCHES = 4  # for via points in one task: each may take seconds


def colliding_ways(
    task: BoundTask, places: Places, moves: Sequence[Move], together: Together
) -> list[Finding]:
    """Movements on which links go into each other, as far as they can be foreseen."""
    found = []
    known: dict[object, tuple[Clash, str, Via] | None] = {}
    searches = 0
    for move in moves:
        key = together.key(move)
        if key not in known:
            hit, told = clash(move, together), None
            if hit is not None:
                searches += 1
                aided = searches <= MOST_SEARCHES and not task.spec.rehearse
                told = (hit, *way_round(move, hit.at, together, aided))
            known[key] = told
        told = known[key]
        if told is None:
            continue
        hit, advice, via = told
        one, other = (name.replace("_", " ") for name in hit.links)
        when = "in the end" if hit.at >= 1.0 else f"at {100.0 * hit.at:.0f} % of its way"
        found.append(
            places.finding(
                "warning", "collision", move.name,
                f"{when} the {one} runs into the {other}; it would go {cm(hit.depth)} deep", advice,
                links=list(hit.links), depth=hit.depth, at=hit.at, via=via,
            )
        )  # fmt: skip
    return found

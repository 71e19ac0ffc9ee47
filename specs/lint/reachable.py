"""out-of-reach, inside-body: goals that no posture of the body brings the palm to."""

from collections.abc import Sequence

from primitives import GoToPoint
from specs.binding import BoundTask
from specs.lint.finding import Finding, Places, cm, point
from specs.lint.move import Move
from specs.lint.nearest import Best, best, inside, moved_from_home
from specs.tolerances import TOUCH_BEFORE_NEXT, size_of


def out_of_reach(task: BoundTask, places: Places, moves: Sequence[Move]) -> list[Finding]:
    """Goals of go-to-point that lie inside the body, or where the arm cannot go.

    A movement that is foreseen to come to the goal needs no further search.
    """
    found = []
    away, allowed = moved_from_home(task), TOUCH_BEFORE_NEXT * size_of(task.body)
    arrive = {move.name for move in moves if move.short(move.foreseen) <= allowed}
    known: dict[object, tuple[float, str, Best]] = {}
    for name in task.graph.order:
        does = task.graph.subtasks[name].does
        if not isinstance(does, GoToPoint) or name in arrive:
            continue
        body = task.body_for(name)
        arm = body.arm(does.limb)
        goal = does.hand_goal(body, arm).places[-1]
        objects = body.model.body_pos[body.objects].tobytes()
        key = arm.name, repr(does.to), does.palm, objects
        if key not in known:
            sunk, link = inside(body, arm, goal, away)
            fits = Best(0.0) if sunk > allowed else best(body, does, away, link)
            known[key] = sunk, link, fits
        sunk, link, (miss, nearest, _) = known[key]
        if sunk > allowed:
            whose = "" if link in body.map.objects else f" of {body.map.name}"
            found.append(
                places.finding(
                    "error", "inside-body", name,
                    f"the goal is {cm(sunk)} inside the {link}{whose}",
                    f"move it out by {cm(sunk)} or more, or name a landmark of the surface",
                    "to", depth=sunk, link=link,
                )
            )  # fmt: skip
        elif miss > allowed:
            said = "bring the goal nearer, or let the waist help"
            if nearest is not None:
                said = f"the nearest place that it reaches is {point(nearest)}"
            found.append(
                places.finding(
                    "error", "out-of-reach", name,
                    f"at best the palm of {body.map.name} stays {cm(miss)} short of the goal",
                    said, "to", short=miss,
                    nearest=None if nearest is None else [round(float(x), 4) for x in nearest],
                )
            )  # fmt: skip
    return found

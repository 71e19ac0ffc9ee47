"""A dance during which the dancer becomes somebody else.

Every few hundredths of a second the body is built anew, a little further on the way; angles and
angular velocities stay as they are, and the arbiter goes on from where it was. The task stays as it
is, in metres and in seconds; gains that are the body's own follow the body.
"""

from collections.abc import Callable

from arbiter import Arbiter
from sim import between, person_named
from specs import BoundTask, SpecError, bind_task

INTERVAL = 0.05  # from one body to the next [s]

Becoming = list[tuple[float, BoundTask]]  # a task on other bodies, and from when [s]
Progress = Callable[[float, str], None]


def morph(
    begun: BoundTask,
    to: str,
    *,
    limits: bool = True,
    contacts: bool = True,
    interval: float = INTERVAL,
    progress: Progress | None = None,
) -> Becoming:
    """Bind a task to all the bodies on the way to another person, who is there in the end.

    Args:
        begun: the task on the body that begins it, which is modelled on a person.
        to: the name of the person who ends it.
        limits: joint limits on.
        contacts: collisions on.
        interval: from one body to the next [s].
        progress: told the share that is prepared, and what that is.

    Raises:
        BodyError: one of them is not modelled on a person.
        SpecError: the task does not fit, or an arbiter cannot go on in it on another body.
    """
    own = begun.body.map.name
    one, other = person_named(own), person_named(to)
    if not Arbiter(begun, contributions=False).forkable:
        raise SpecError(
            f"{begun.spec.task}: a body can become another one only in a task without groups,"
            " without safety: filter, and without primitives in plain Python"
        )
    duration = begun.graph.duration
    count = max(2, 1 + int(duration / interval))

    def tell(share: float) -> None:
        if progress is not None:
            progress(share, f"making {count} bodies on the way to {to}")

    bodies = between(
        one, other, count, names=(own, to), limits=limits, contacts=contacts,
        progress=lambda share: tell(0.5 * share),
    )  # fmt: skip
    becoming = []
    for k, body in enumerate(bodies[1:], start=1):
        spec = begun.spec.model_copy(update={"body": begun.spec.body and body.map.name})
        becoming.append((k * duration / count, bind_task(spec, body)))
        tell(0.5 + 0.5 * k / (count - 1))
    return becoming

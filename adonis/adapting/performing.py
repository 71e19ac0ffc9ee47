"""An adaptation as the command line does it: with a bar that says how far it is."""

from rich.console import Console

from adonis.adapting.adapting import Adapted, adapt
from adonis.adapting.searching import Found
from adonis.performing import perform_rehearsal
from adonis.progress import KEPT, progress
from sim import Body
from specs import TaskSpec, bind_task


def perform_adaptation(
    console: Console,
    spec: TaskSpec,
    body: Body,
    *,
    budget: int,
    seed: int,
    keep_tempo: bool,
    afresh: bool,
) -> Adapted:
    """Search for what suits a body better, with a bar: see `adapt`.

    Ways of hands that the task lacks are found first.
    """
    if spec.rehearse:
        bound, _ = perform_rehearsal(console, bind_task(spec, body), seed=seed, afresh=afresh)
        spec = bound.spec

    try:
        with progress(console, "dancing as the laws have it (slow only the first time)") as tell:

            def moving(tried: int, found: Found) -> None:
                best = f"{found.mark.failures} failures, cost {found.mark.cost:.2f}"
                tell(tried / budget, f"{tried} of {budget} danced; best so far: {best}")

            return adapt(
                spec, body, budget=budget, seed=seed, keep_tempo=keep_tempo, afresh=afresh,
                progress=moving,
            )  # fmt: skip
    except KeyboardInterrupt:
        console.print(KEPT)
        raise

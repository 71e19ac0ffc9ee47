"""An adaptation as the command line does it: with a bar that says how far it is."""

from rich.console import Console
from rich.progress import Progress

from adonis.adapting.adapting import Adapted, adapt
from adonis.adapting.searching import Found
from adonis.performing import bar_columns, perform_rehearsal
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
    with Progress(*bar_columns(), console=console, transient=True) as bar:
        shown = bar.add_task("dancing as the laws have it (slow only the first time)", total=1.0)

        def moving(tried: int, found: Found) -> None:
            best = f"{found.mark.failures} failures, cost {found.mark.cost:.2f}"
            said = f"{tried} of {budget} danced; best so far: {best}"
            bar.update(shown, completed=tried / budget, description=said)

        try:
            return adapt(
                spec, body, budget=budget, seed=seed, keep_tempo=keep_tempo, afresh=afresh,
                progress=moving,
            )  # fmt: skip
        except KeyboardInterrupt:
            bar.stop()
            console.print("What was found is kept: the same command goes on from there.")
            raise

"""How far long work is: a bar in a terminal, and elsewhere a line now and then."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

PAUSE = 10.0  # [s] before a line and between two, where there is no terminal
COMPILING = "preparing the controllers (slow only the first time)"
KEPT = "What was found is kept: the same command goes on from there."

Tell = Callable[[float, str], None]


@contextmanager
def progress(console: Console, what: str) -> Iterator[Tell]:
    """Show how far something is, until it is over.

    Args:
        console: the terminal; where it is none, lines go to the standard error stream.
        what: is done first.

    Yields:
        What is to be told the share that is done and what is done now.
    """
    if not console.is_terminal:
        yield _lines()
        return
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        shown = bar.add_task(what, total=1.0)
        yield lambda share, said: bar.update(shown, completed=share, description=said)


def _lines() -> Tell:
    last = time.monotonic()

    def tell(share: float, said: str) -> None:
        nonlocal last
        if time.monotonic() - last >= PAUSE:
            print(f"{100 * share:3.0f} %  {said}", file=sys.stderr, flush=True)
            last = time.monotonic()

    return tell

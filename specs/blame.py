"""Whose mistake? What somebody's own code raised, in one line that says where."""

import traceback
from pathlib import Path

HOUSE = Path(__file__).parents[1]
OURS = tuple(HOUSE / name for name in ("adonis", "arbiter", "primitives", "sim", "specs"))
LONGEST = 300  # characters of a message


def told(problem: BaseException) -> str:
    """What was raised, and the line of the user's code that it came from, in one line.

    The user's code is what ours called; of its frames the innermost one counts, not those of
    the libraries that it called in turn.
    """
    said = " ".join(str(problem).split())
    if len(said) > LONGEST:
        said = said[: LONGEST - 3] + "..."
    raised = f"{type(problem).__name__}: {said}" if said else type(problem).__name__
    frames = traceback.extract_tb(problem.__traceback__)
    theirs = [f for f in frames if not _ours(f.filename)]
    if not theirs:
        return raised
    folder = Path(theirs[0].filename).parent
    last = [f for f in theirs if folder in Path(f.filename).parents][-1]
    return f"{raised} ({last.filename}:{last.lineno})"


def _ours(file: str) -> bool:
    return any(folder in Path(file).parents for folder in OURS)

"""What can go wrong on this floor.

SimError
├── BodyError       a model or body map that does not fit, a name that does not exist
│   ├── BeyondRange an angle that a joint does not reach
│   └── Unposable   words of an arm that no posture fits
├── Diverged        the simulation left the finite numbers
├── RecordingError  a recording that cannot be read or written
└── NoDisplay       this machine has no OpenGL backend to render with
"""

from collections.abc import Iterable
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray


class SimError(Exception):
    """Base class of the errors of `sim`."""


class BodyError(SimError):
    """A body lacks what was asked of it; the message lists what it has."""


class BeyondRange(BodyError):
    """An angle beyond the end of a joint's range."""


class Unposable(BodyError):
    """An arm that cannot be held as is said.

    Args:
        message: the same in words.
        nearest: joint angles (nv,) [rad] that come nearest, NaN for all other joints.
        off: by how much they are off [rad].
    """

    def __init__(self, message: str, nearest: NDArray[np.float64], off: float) -> None:
        super().__init__(message)
        self.nearest, self.off = nearest, off


class Diverged(SimError):
    """The physics produced numbers that are not finite or that MuJoCo warned about."""


class RecordingError(SimError):
    """A recording could not be read or written."""


class NoDisplay(SimError):
    """No OpenGL backend could be started; the message says which were tried."""


def unknown(what: str, name: object, known: Iterable[str]) -> str:
    """One line: what was given, the nearest known name, and everything that exists."""
    names = sorted(known)
    close = get_close_matches(str(name), names, n=1, cutoff=0.6)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    shown = ", ".join(names) if names else "none"
    return f"unknown {what} {name!r}{hint} (there are: {shown})"

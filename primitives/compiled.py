"""Compiled code: plain functions over one simulation's arrays, made fast by Numba.

Division follows IEEE 754 and no operation is reordered, so a result does not depend on
the machine, on the thread, or on how many simulations run beside it.
"""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

# Rows of a table with named columns. NumPy's types know nothing of the columns.
Record = Any
Records = Any

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Compile a function that other compiled functions call."""
    made: Any = numba.njit(error_model="numpy")(function)
    return made  # type: ignore[no-any-return]


def compiled_entry(function: Function) -> Function:
    """Compile a function that Python calls: without the interpreter's lock, and kept on disk.

    Numba's cache on disk looks only at the file of the function itself, and at what the
    function captures. Such a function captures `fingerprint()`, so that a change of any
    compiled code is noticed.
    """
    made: Any = numba.njit(error_model="numpy", nogil=True, cache=True)(function)
    return made  # type: ignore[no-any-return]


def fingerprint() -> str:
    """A hash of all sources that compiled code comes from."""
    digest = hashlib.sha256()
    for folder in ("arbiter", "primitives"):
        for path in sorted((Path(__file__).parents[1] / folder).glob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()

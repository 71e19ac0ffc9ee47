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
_njit: Any = numba.njit


def compiled(function: Function) -> Function:
    """Compile a function that other compiled functions call; it becomes part of its caller.

    It is compiled without Numba's run-time, which would count a reference each time that an
    array is looked at, and without a call, which would pass every array by its parts. That
    was three quarters of the time. So it cannot make arrays, copies them by element, and must
    not return them to a `compiled_entry`, which does count references.
    """
    made: Function = _njit(error_model="numpy", _nrt=False, forceinline=True)(function)
    return made


def compiled_entry(function: Function) -> Function:
    """Compile a function that Python calls: without the interpreter's lock, and kept on disk.

    Numba's cache on disk looks only at the file of the function itself, and at what the
    function captures. Such a function captures `fingerprint()`, so that a change of any
    compiled code is noticed.
    """
    made: Function = _njit(error_model="numpy", nogil=True, cache=True)(function)
    return made


def fingerprint() -> str:
    """A hash of all sources that compiled code comes from."""
    digest = hashlib.sha256()
    for folder in ("arbiter", "primitives"):
        for path in sorted((Path(__file__).parents[1] / folder).glob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()

"""Compiled code: plain functions over one simulation's arrays, made fast by Numba.

Division follows IEEE 754 and no operation is reordered, so a result does not depend on
the machine, on the thread, or on how many simulations run beside it.
"""

from collections.abc import Callable
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

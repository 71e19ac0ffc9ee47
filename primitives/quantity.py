"""What kind of quantity a parameter is, so that a task can be made to fit a body of another size.

A model says it in the type:

    away: Annotated[float, Quantity.LENGTH] = 0.0

Angles, shares and cycles are the same on every body and are not marked.
"""

from enum import Enum
from typing import Any, get_args

from pydantic import BaseModel


class Quantity(Enum):
    """A quantity that is larger or smaller on another body."""

    LENGTH = "length"  # [m]
    TIME = "time"  # [s]
    FREQUENCY = "frequency"  # [Hz]
    GAIN = "gain"  # of a servo, a spring or a damper: its name says which


def quantities(model: type[BaseModel]) -> dict[str, Quantity]:
    """The fields of a model that are marked."""
    found = {
        name: _mark((*field.metadata, field.annotation))
        for name, field in model.model_fields.items()
    }
    return {name: quantity for name, quantity in found.items() if quantity is not None}


def _mark(parts: tuple[Any, ...]) -> Quantity | None:
    """The first mark in the parts of a type."""
    for part in parts:
        found = part if isinstance(part, Quantity) else _mark(get_args(part))
        if found is not None:
            return found
    return None

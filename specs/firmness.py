"""How firmly a body holds itself in a task, against how it does by itself.

gains: {joints: 1.2, damping: 1.1}   # a fifth stiffer, and more damped

The gains of the body's map are multiplied. Gains that a sub-task gives itself are as it says.
"""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from sim import Body, Gains, firmer, renamed

Factor = Annotated[float, Field(gt=0, le=100)]


class Firmness(BaseModel):
    """Factors of the body's own gains."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    joints: Factor = 1.0  # of the stiffness of joints, at the same damping ratio
    hands: Factor = 1.0  # of the stiffness with which hands are pulled, at the same damping ratio
    damping: Factor = 1.0  # of the damping ratio of both
    guard: Factor = 1.0  # of the force that keeps links apart


def firm(body: Body, how: Firmness | None) -> Body:
    """The body with its gains multiplied; the same body if nothing is."""
    if how is None:
        return body
    gains = firmer(Gains.of(body.map), **how.model_dump())
    return renamed(body, gains.on(body.map))

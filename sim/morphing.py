"""A body that becomes another one, step by step: people between two people."""

from collections.abc import Callable

import numpy as np

from sim.anthropometry import Anthropometry
from sim.bodies import PEOPLE, adonis
from sim.body import Body
from sim.errors import BodyError, unknown
from sim.people_by_name import person_of


def person_named(name: str) -> Anthropometry:
    """The person that a body of the package is modelled on, or that a name describes.

    Raises:
        BodyError: there is no such person.
    """
    described = person_of(name)
    if described is not None:
        return described
    if name not in PEOPLE:
        raise BodyError(unknown("person to become or to begin with", name, PEOPLE))
    return PEOPLE[name]


def between(
    one: Anthropometry,
    other: Anthropometry,
    count: int,
    *,
    names: tuple[str, str],
    limits: bool = True,
    contacts: bool = True,
    progress: Callable[[float], None] | None = None,
) -> list[Body]:
    """Bodies on the way from one person to another, both among them.

    Every length, mass and moment goes in a straight line; gains, motors and the rest follow as for
    any person. The physics steps as for the first.

    Args:
        one: the first.
        other: the last.
        count: how many bodies, two or more.
        names: of the two.
        limits: joint limits on.
        contacts: collisions on.
        progress: told the share that is made.
    """
    bodies: list[Body] = []
    for k, share in enumerate(np.linspace(0.0, 1.0, count), start=1):
        name = {1: names[0], count: names[1]}.get(k, "-to-".join(names))
        made = adonis(one.towards(other, float(share)), name=name, limits=limits, contacts=contacts)
        if bodies:
            made.spec.option.timestep = bodies[0].timestep
            made = Body(made.spec, made.map)
        bodies.append(made)
        if progress is not None:
            progress(k / count)
    return bodies

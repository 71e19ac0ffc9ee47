"""Looking: the head of a body as indices into its model, and which joints move what."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.body import Body, FloatArray, IntArray
from sim.errors import BodyError


@dataclass(frozen=True)
class Gaze:
    """The head of the body map, as indices into the model."""

    dofs: IntArray  # that turn it
    root: int  # the link that carries those joints
    link: int  # the head
    eyes: FloatArray  # (3,) the point between them, in the frame of the head [m]
    forward: FloatArray  # (3,) unit, where the face points, in the frame of the head


def find_gaze(body: Body) -> Gaze:
    """How a body looks.

    Raises:
        BodyError: its map has no head.
    """
    head = body.map.head
    if head is None:
        raise BodyError(f"the body map of {body.map.name!r} has no head: give it link and joints")
    dofs = body.joints(head.joints)
    return Gaze(
        dofs=dofs,
        root=carrier(body, dofs),
        link=body.link(head.link),
        eyes=np.array(head.eyes),
        forward=body.direction(head.forward),
    )


def carrier(body: Body, dofs: NDArray[np.integer]) -> int:
    """The link that carries joints of one chain: the parent of the innermost."""
    return int(body.model.body_parentid[body.model.dof_bodyid[int(min(dofs))]])


def moving_dofs(body: Body, link: int) -> frozenset[int]:
    """The degrees of freedom that move a link."""
    model, found = body.model, set()
    while link and not model.body_dofnum[link]:
        link = int(model.body_parentid[link])
    dof = int(model.body_dofadr[link] + model.body_dofnum[link] - 1) if link else -1
    while dof >= 0:
        found.add(dof)
        dof = int(model.dof_parentid[dof])
    return frozenset(found)

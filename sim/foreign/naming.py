"""What joints of a model are called in anatomy: by the way their axes lie when the arms hang.

A joint is `shoulder_y` if, with the arms hanging, it turns about the axis about which Adonis'
shoulder flexes, in this sense or the other. What lies askew to all of them keeps its own name.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from sim.adonis_character import joint_axis
from sim.foreign.hanging import Frame
from sim.foreign.tree import Tree

FloatArray = NDArray[np.float64]

ASKEW = np.cos(np.deg2rad(50.0))  # an axis farther from an anatomical one is another
# Of two joints as good for a name: rolling is done next to the elbow, bending next to the trunk.
PREFERRED = {"waist": 0.02, "neck": -0.02, "shoulder": 0.02, "wrist": -0.02}


@dataclass(frozen=True)
class Named:
    """A joint of the model and its name in anatomy."""

    name: str  # anatomical, without the side; or its own
    joint: int
    flipped: bool  # whether the anatomical angle grows as the model's falls
    anatomical: bool


def name_joints(
    tree: Tree, frame: Frame, joints: Sequence[int], part: str, side: float = 1.0
) -> list[Named]:
    """Names of some joints of one part, in their order; the tree is posed with hanging arms.

    Args:
        tree: the model.
        frame: of the body.
        joints: in any number.
        part: `waist`, `neck`, `shoulder` or `wrist`.
        side: +1 left, -1 right.
    """
    if not joints:
        return []
    names = [f"{part}_{axis}" for axis in "zxy"]
    axes = np.array([frame.axes @ tree.axis(j) for j in joints])
    wanted = np.array([joint_axis(name, side) for name in names])
    fit = axes @ wanted.T  # (joints, names)
    count = min(len(joints), len(names))
    best: tuple[float, tuple[int, ...], tuple[int, ...]] = (-1.0, (), ())
    first = max(len(joints) - 3, 0) if part == "shoulder" else 0  # before that: a collar bone
    for chosen in permutations(range(first, len(joints)), count):
        for called in permutations(range(len(names)), count):
            if list(called) != sorted(called):
                continue
            match = [abs(fit[j, n]) for j, n in zip(chosen, called, strict=True)]
            good = sum(
                m + PREFERRED[part] * j for m, j in zip(match, chosen, strict=True) if m > ASKEW
            )
            if good > best[0]:
                best = good, chosen, called
    given = dict(zip(best[1], best[2], strict=True))
    found = []
    for k, joint in enumerate(joints):
        n = given.get(k)
        if n is not None and abs(fit[k, n]) > ASKEW:
            found.append(Named(names[n], joint, bool(fit[k, n] < 0.0), True))
        else:
            found.append(Named(tree.joint_name(joint), joint, False, False))
    return found

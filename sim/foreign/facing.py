"""Which way a model faces, and which of its arms is the left one: several witnesses are heard."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.foreign.arm import ArmAnatomy
from sim.foreign.geometry import unit
from sim.foreign.hanging import Frame, hang
from sim.foreign.palm import PalmGuess
from sim.foreign.parts import Parts, words
from sim.foreign.tree import Tree

FloatArray = NDArray[np.float64]

LEFT_WORDS = re.compile(r"[Ll]eft|LEFT|(?:^|[\s_.\-/])(?:[lL](?=[_.\-\s]|$)|L(?=[A-Z]))")
RIGHT_WORDS = re.compile(r"[Rr]ight|RIGHT|(?:^|[\s_.\-/])(?:[rR](?=[_.\-\s]|$)|R(?=[A-Z]))")
SNAP = 0.9  # cosine between the line from arm to arm and an axis of the model's own
WEIGHTS = {"its x axis": 1.0, "names": 3.0, "feet": 1.5, "elbows": 1.0}  # of the witnesses
SURE = 0.75  # share of the weights that must agree
CLEARLY = np.deg2rad(30.0)  # arms that hang bend forward by so much better than backward


@dataclass(frozen=True)
class Facing:
    """The frame of a body, the side of each arm, and who said so."""

    frame: Frame
    sides: tuple[float, ...]  # +1 left, -1 right
    witnesses: tuple[str, ...]  # that agree
    against: tuple[str, ...]

    @property
    def sure(self) -> bool:
        """Whether those that agree outweigh the others, and are not the convention alone."""
        ours, theirs = (sum(WEIGHTS[w] for w in who) for who in (self.witnesses, self.against))
        return ours > WEIGHTS["its x axis"] and ours >= SURE * (ours + theirs)


def find_facing(
    tree: Tree, parts: Parts, arms: tuple[ArmAnatomy, ...], palms: tuple[PalmGuess, ...]
) -> Facing:
    """Find out which way a model faces."""
    forward = np.eye(3)[0] if abs(parts.up[0]) < 0.5 else np.eye(3)[1]
    if len(arms) < 2:
        frame = Frame.of(forward, parts.up)
        side = _named_side(tree, parts.arms[0])
        said = ("names",) if side else ()
        return Facing(frame, (side or -1.0,), ("its x axis", *said), ())
    across = arms[0].places(tree)[0] - arms[1].places(tree)[0]
    across = unit(across - parts.up * (across @ parts.up))
    nearest = int(np.argmax(np.abs(across)))
    if abs(across[nearest]) > SNAP:
        across = np.sign(across[nearest]) * np.eye(3)[nearest]
    # If the first arm is the left one, forward is across x up.
    first_is_left = Frame.of(np.cross(across, parts.up), parts.up)
    votes = {
        "its x axis": _sign(first_is_left.forward @ forward),
        "names": _names(tree, parts),
        "feet": _feet(tree, parts, first_is_left),
        "elbows": _elbows(tree, arms, palms, first_is_left),
    }
    ahead = sum(WEIGHTS[who] * vote for who, vote in votes.items()) >= 0.0
    frame = first_is_left if ahead else Frame.of(-first_is_left.forward, parts.up)
    sense = 1.0 if ahead else -1.0
    return Facing(
        frame,
        (sense, -sense),
        tuple(who for who, vote in votes.items() if sense * vote > 0.0),
        tuple(who for who, vote in votes.items() if sense * vote < 0.0),
    )


def _names(tree: Tree, parts: Parts) -> float:
    """+1 if the first arm is called the left one."""
    one, other = (_named_side(tree, chain) for chain in parts.arms)
    return one if one == -other else 0.0


def _named_side(tree: Tree, chain: tuple[int, ...]) -> float:
    """+1 if the names of a chain say left, -1 if right, 0 if neither."""
    named = [words(tree, (link,)) for link in chain]
    left = sum(bool(LEFT_WORDS.search(name)) for name in named)
    right = sum(bool(RIGHT_WORDS.search(name)) for name in named)
    return _sign(left - right)


def _feet(tree: Tree, parts: Parts, frame: Frame) -> float:
    """Feet reach farther forward of the ankle than back."""
    votes = 0.0
    if len(parts.legs) != 2:
        return 0.0
    for leg in parts.legs:
        chain = tree.below(leg)
        foot = chain[-1]
        points = tree.points(foot)
        if not len(points):
            continue
        ankle = tree.start(foot)
        reach = (points - ankle) @ frame.forward
        ahead, behind = np.quantile(reach, 0.95), -np.quantile(reach, 0.05)
        if max(ahead, behind) > 1.25 * min(ahead, behind):
            votes += _sign(ahead - behind)
    return _sign(votes)


def _elbows(
    tree: Tree, arms: tuple[ArmAnatomy, ...], palms: tuple[PalmGuess, ...], frame: Frame
) -> float:
    """Arms that hang can bend forward, and not backward."""
    behind = Frame.of(-frame.forward, frame.up)
    off = [
        min(
            hang(tree, arm, facing, side, palm.fingers, None).off
            for arm, palm, side in zip(arms, palms, sides, strict=True)
        )
        for facing, sides in ((frame, (1.0, -1.0)), (behind, (-1.0, 1.0)))
    ]
    tree.pose({})
    ahead, back = off
    return _sign(back - ahead) if abs(ahead - back) > CLEARLY else 0.0


def _sign(value: float) -> float:
    return float(np.sign(value)) if abs(value) > 1e-6 else 0.0

"""Which links of a model are its trunk, arms, head and legs: by how it branches and what it weighs.

Two long chains alike that branch off one link are a pair; of two pairs the higher one are arms.
What leads from the base to where the arms branch off is the waist, what goes up from there beside
them the neck. Names are heard last, as evidence among others.
"""

import re
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sim.errors import BodyError
from sim.foreign.tree import BASE, MOVING, Tree

FloatArray = NDArray[np.float64]

ALIKE = 0.06  # relative difference in length and mass of the two of a pair
LONG = 0.3  # an arm is at least so long, of the longest chain there is
FEWEST = 3  # joints of an arm
SMALL = 0.35  # of the arm's length: what branches off at its end is a finger
LIGHT = 0.2  # of the mass of the head: what moves on it is an eye or a jaw
HEAVY = 0.65  # of a chain: a link that weighs more carries the arm
HIGHER = 0.1  # of the size of the body: two pairs are at different heights
SNAP = 0.85  # cosine between what is up and an axis of the model's own
LEG_WORDS = re.compile("leg|hip|knee|ankle|foot|toe|thigh|shin", re.IGNORECASE)
ARM_WORDS = re.compile("arm|shoulder|elbow|wrist|hand|gripper", re.IGNORECASE)
HEAD_WORDS = re.compile("head|skull|cervical", re.IGNORECASE)


@dataclass(frozen=True)
class Parts:
    """Links of a model by what they are in anatomy."""

    arms: tuple[tuple[int, ...], ...]  # one or two chains of links, from the trunk outwards
    trunk: int  # the link that carries the arms
    waist: tuple[int, ...]  # links from the base to the trunk; empty if the trunk is the base
    neck: tuple[int, ...]  # links from the trunk to the head; empty if the head is part of it
    legs: tuple[int, ...]  # the first link of each leg
    up: FloatArray  # (3,) in the axes of the model's own world
    doubts: tuple[str, ...]  # what was hard to tell


def find_parts(tree: Tree) -> Parts:
    """Find trunk, arms, head and legs.

    Raises:
        BodyError: nothing in the model looks like an arm.
    """
    doubts: list[str] = []
    pairs = _pairs(tree)
    armed = [pair for pair in pairs if not _are_legs(tree, pair)]
    up = np.array([0.0, 0.0, 1.0])
    if armed:
        arms, up = _higher(tree, armed, pairs)
        if up[2] < SNAP:
            doubts.append("up")
    else:
        arms = _lonely(tree, pairs)
        doubts.append("arm")
    trunk = tree.parent(arms[0])
    legs = tuple(link for pair in pairs if pair != arms for link in pair)
    beside = {link for root in (*arms, *legs) for link in tree.below(root)}
    return Parts(
        arms=tuple(tuple(_chain(tree, arm)) for arm in arms),
        trunk=trunk,
        waist=tuple(tree.path(trunk)),
        neck=tuple(_neck(tree, trunk, beside, np.mean([tree.start(a) for a in arms], axis=0), up)),
        legs=legs,
        up=up,
        doubts=tuple(doubts),
    )


def words(tree: Tree, links: list[int] | tuple[int, ...]) -> str:
    """Names of links and of their joints, in one text."""
    bodies = [tree.name(body) for link in links for body in tree.bodies(link)]
    joints = [tree.joint_name(j) for link in links for j in tree.joints_on(link)]
    return " ".join([*bodies, *joints])


def _pairs(tree: Tree) -> list[tuple[int, ...]]:
    """Chains that are long and alike, two or more from one link; not those inside others."""
    longest = max((tree.length(link) for link in tree.children[BASE]), default=0.0)
    found: list[tuple[int, ...]] = []
    for link in (BASE, *tree.links):
        if any(link in tree.below(root) for group in found for root in group):
            continue
        long = [
            child
            for child in tree.children[link]
            if tree.length(child) > LONG * longest and _joints(tree, child) >= FEWEST
        ]
        for child in long:  # with all that are like it: the four legs of a horse
            group = (child, *(other for other in long if _alike(tree, child, other)))
            if len(set(group)) > 1 and not any(child in known for known in found):
                found.append(tuple(sorted(set(group))))
    return found


def _alike(tree: Tree, one: int, other: int) -> bool:
    """Whether two chains have the same joints, length and mass."""
    if _joints(tree, one) != _joints(tree, other):
        return False
    for measure in (tree.length, tree.mass_below):
        a, b = measure(one), measure(other)
        if abs(a - b) > ALIKE * max(a, b):
            return False
    return True


def _are_legs(tree: Tree, pair: tuple[int, ...]) -> bool:
    """More than two are legs; and two whose names say so, and nothing of arms."""
    named = words(tree, [link for root in pair for link in tree.below(root)])
    only_legs = bool(LEG_WORDS.search(named)) and not ARM_WORDS.search(named)
    return len(pair) > 2 or only_legs


def _higher(
    tree: Tree, armed: list[tuple[int, ...]], pairs: list[tuple[int, ...]]
) -> tuple[tuple[int, ...], FloatArray]:
    """The pair that are arms, and the way up from the legs to them."""
    middles = {pair: np.mean([tree.start(link) for link in pair], axis=0) for pair in pairs}
    size = max(tree.length(link) for link in tree.children[BASE])
    heights = [middles[pair][2] for pair in armed]
    if len(armed) > 1 and max(heights) - min(heights) < HIGHER * size:
        arms = min(armed, key=lambda pair: sum(tree.mass_below(link) for link in pair))
    else:
        arms = max(armed, key=lambda pair: float(middles[pair][2]))
    others = [middles[pair] for pair in pairs if pair != arms]
    up = np.array([0.0, 0.0, 1.0])
    if others:
        along = middles[arms] - np.mean(others, axis=0)
        along = along / max(float(np.linalg.norm(along)), 1e-9)
        nearest = int(np.argmax(np.abs(along)))
        if abs(along[nearest]) > SNAP:
            up = np.zeros(3)
            up[nearest] = np.sign(along[nearest])
    return arms, up


def _lonely(tree: Tree, pairs: list[tuple[int, ...]]) -> tuple[int, ...]:
    """A single arm: the longest chain that is no leg, from where it leaves a trunk on."""
    legs = {link for pair in pairs for root in pair for link in tree.below(root)}
    roots = [link for link in tree.links if link not in legs and _joints(tree, link) >= FEWEST]
    starts = [link for link in roots if tree.parent(link) not in roots]
    if not starts and legs:
        raise BodyError(f"{tree.source.path}: this model has legs, but nothing looks like an arm")
    if not starts:
        raise BodyError(
            f"{tree.source.path}: nothing in this model looks like an arm: expected a chain of at"
            f" least {FEWEST} hinges"
        )
    best = max(starts, key=tree.length)
    named = words(tree, tree.below(best))
    if LEG_WORDS.search(named) and not ARM_WORDS.search(named):
        raise BodyError(f"{tree.source.path}: this model has legs, but nothing looks like an arm")
    chain = _chain(tree, best)
    whole = sum(tree.mass(link) for link in chain)
    for link, after in reversed(list(pairwise(chain))):
        carries = len(tree.children[link]) > 1 or tree.mass(link) > HEAVY * whole
        if carries and _joints(tree, after) >= FEWEST:
            return (after,)
    return (best,)


def _joints(tree: Tree, root: int) -> int:
    """How many joints a chain has."""
    return sum(len(tree.joints_on(link)) for link in _chain(tree, root))


def _chain(tree: Tree, root: int) -> list[int]:
    """The links of an arm or a leg, until only fingers branch off."""
    whole, chain = tree.length(root), [root]
    while True:
        further = [c for c in tree.children[chain[-1]] if tree.length(c) > SMALL * whole]
        hinges = [c for c in tree.children[chain[-1]] if _turns(tree, c)]
        if len(further) == 1:
            chain.append(further[0])
        elif not further and len(tree.children[chain[-1]]) == 1 and hinges:
            chain.append(hinges[0])
        else:
            return chain


def _turns(tree: Tree, link: int) -> bool:
    """Whether all joints of a link are hinges."""
    hinge = MOVING[0]
    return all(tree.model.jnt_type[j] == hinge for j in tree.joints_on(link))


def _neck(
    tree: Tree, trunk: int, beside: set[int], shoulders: FloatArray, up: FloatArray
) -> list[int]:
    """The links from the trunk, or what carries it, to the head."""
    own = {*tree.path(trunk), BASE}
    candidates = [
        link
        for link in tree.links
        if tree.parent(link) in own and link not in own and link not in beside
    ]

    def top(link: int) -> float:
        points = tree.points(*tree.below(link))
        ends = np.concatenate([points, [tree.start(each) for each in tree.below(link)]])
        return float(((ends - shoulders) @ up).max())

    above = [link for link in candidates if top(link) > 0.0]
    if not above:
        return []
    heaviest = max(tree.mass_below(link) for link in above) or 1.0
    head = max(
        above,
        key=lambda link: (
            2.0 * bool(HEAD_WORDS.search(words(tree, tree.below(link))))
            + tree.mass_below(link) / heaviest
            + top(link) / max(top(each) for each in above)
        ),
    )
    chain = [head]
    while len(tree.children[chain[-1]]) == 1:
        (further,) = tree.children[chain[-1]]
        if tree.mass_below(further) < LIGHT * tree.mass_below(chain[0]):
            break
        chain.append(further)
    return chain

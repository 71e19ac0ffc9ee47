"""Which links of a body may touch: those that do not collide, and those that are kept apart."""

from collections.abc import Iterable
from itertools import combinations, product

from sim.foreign.body_file import BodyFile
from sim.foreign.layout import Layout


def excluded(layout: Layout, overlapping: Iterable[tuple[str, str]]) -> set[tuple[str, str]]:
    """Pairs of links that do not collide: neighbours but one, and what the file says.

    Args:
        layout: of the links.
        overlapping: further pairs, which a file says may overlap.
    """
    pairs: set[tuple[str, str]] = {(min(p), max(p)) for p in overlapping}
    parents = {link.name: link.parent for link in layout.links}
    chains = [list(chain) for chain in layout.chains.values()]
    for chain in chains:
        upper = next(k for k, name in enumerate(chain) if name.endswith("upper_arm"))
        own = ["trunk", *chain]
        near = [(a, b) for k, a in enumerate(own) for b in own[k + 1 : k + 3]]
        near += list(combinations(["trunk", *chain[: upper + 1]], 2))
        near += list(combinations(chain[upper + 1 :], 2))
        near.append((chain[upper], chain[-1]))
        pairs |= {(min(p), max(p)) for p in near}
    core = {"pelvis", "trunk", "head", *(x.name for x in layout.links)}
    core -= {name for chain in chains for name in chain}
    pairs |= {(min(p), max(p)) for p in combinations(sorted(core), 2)}
    names = {link.name for link in layout.links}
    fixed = {link.name for link in layout.links if not link.joints}

    def neighbours(a: str, b: str) -> bool:
        """MuJoCo leaves out parent and child by itself, unless the parent is fixed to the world."""
        return (parents[a] == b and b not in fixed) or (parents[b] == a and a not in fixed)

    return {
        (a, b) for a, b in pairs if a != b and a in names and b in names and not neighbours(a, b)
    }


def kept_apart(layout: Layout, file: BodyFile) -> tuple[tuple[str, str], ...]:
    """Forearms and hands against head, trunk and pelvis, and one arm against the other."""
    solid = set(file.shapes)
    outer = []  # of each arm: its links from the upper arm outwards
    for chain in layout.chains.values():
        upper = next(k for k, name in enumerate(chain) if name.endswith("upper_arm"))
        outer.append(chain[upper:])
    pairs = [
        (own, other)
        for chain in outer
        for own in chain[1:]
        for other in ("head", "trunk", "pelvis")
    ]
    pairs += [(chain[0], "head") for chain in outer]
    for one, other in combinations(outer, 2):
        pairs += list(product(one, other))
    never = excluded(layout, file.may_overlap)
    return tuple(pair for pair in pairs if {*pair} <= solid and (min(pair), max(pair)) not in never)

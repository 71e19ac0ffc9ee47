"""Where landmarks are: rays cast from inside at the capsules, by the proportions of the body.

Heights are measured from the shoulders down in lengths of upper arm and forearm, breadths in
distances of the shoulders, so that the same words mean the same places on any body.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.foreign.body_file import LandmarkOf
from sim.foreign.layout import Layout
from sim.foreign.shaping import head_from
from sim.landmarks import Ray, leave

FloatArray = NDArray[np.float64]

# The top of a shoulder: so far out, of the joint, and so far above it, of the arm; where rays are
# cast; what a place on a moving link, or a steep one, counts as farther off, of the arm.
TOP, ABOVE, DEEP = 0.62, 0.05, 0.3
TRUNK, BESIDE = (0.75, 0.62, 0.52, 0.42, 0.32), (0.62, 0.8, 1.0)
MOVES, STEEP = 0.1, 0.2
UPWARD = 0.4  # of its normal
RIBS, CHEST, BELLY, HIP = 0.35, 0.16, 0.55, 0.857  # below the shoulders, of the arm
CREST = 0.084  # of the arm: so far above the hip joint is the place of a hand on the hip
GAP = 0.25  # of half the distance of the shoulders: so far from the middle there is a chest
NARROW = 0.35  # of half the distance of the shoulders: what is nearer to the middle is no hip
BREAST = 0.5  # of half the distance of the shoulders: where rays to the sides begin
CROOK = 0.36  # of the forearm, from the elbow
HEAD = {
    "head.back": (-1.0, 0.0, 0.1),
    "head.back_right": (-1.0, -0.48, -0.42),
    "head.back_left": (-1.0, 0.48, 0.34),
    "head.top": (0.0, 0.0, 1.0),
    "head.right": (0.0, -1.0, 0.0),
    "head.left": (0.0, 1.0, 0.0),
    "head.front": (1.0, 0.0, 0.35),
}
EYES = 0.64  # of the height of the head


@dataclass(frozen=True)
class Hit:
    """Where a ray leaves the body, in its axes at hanging arms."""

    link: str
    point: FloatArray  # (3,) [m]
    normal: FloatArray  # (3,)


class Marker:
    """Places landmarks on one body.

    Args:
        layout: of the body.
        model: compiled, with its capsules.
        hips: heights of the hip joints, if there are legs [m].
    """

    def __init__(self, layout: Layout, model: Any, hips: float | None) -> None:
        self.layout, self.model = layout, model
        self.names = {link.name for link in layout.links}
        self.shoulders = [layout.places(limb)[0] for limb in layout.arms]
        middle = np.mean(self.shoulders, axis=0)
        self.arm = float(np.mean([layout.length(limb) for limb in layout.arms]))
        self.height, self.middle = float(middle[2]), np.array([middle[0], 0.0, 0.0])
        sides = [abs(float(s[1])) for s in self.shoulders]
        self.half = float(np.mean(sides)) or 0.3 * self.arm
        self.hips = [self.height - HIP * self.arm]
        if hips is not None:
            self.hips.append(hips + CREST * self.arm)
        on_arms = {name for chain in layout.chains.values() for name in chain}
        self.core = [n for n in self.names if n not in on_arms and n != "head"]

    def landmarks(self) -> dict[str, LandmarkOf]:
        """All that are found; on a lone arm those of the arm."""
        found: dict[str, Hit | None] = {}
        for side, s in (("right", -1.0), ("left", 1.0)):
            if s in self.layout.sides.values():
                found[f"{side}_shoulder.top"] = self._shoulder(s)
        found |= self._crooks()
        if len(self.layout.arms) > 1:
            found |= self._trunk() | self._head()
        return {name: self._said(hit) for name, hit in found.items() if hit is not None}

    def _trunk(self) -> dict[str, Hit | None]:
        found: dict[str, Hit | None] = {}
        for side, s in (("right", -1.0), ("left", 1.0)):
            found[f"{side}_ribs"] = self._out(self.height - RIBS * self.arm, s, (1.3, s, 0.0))
            for name, way in (("hip", (0.45, s, 0.15)), ("hip.front", (1.0, 0.45 * s, 0.15))):
                hits = [hit for height in self.hips if (hit := self._out(height, s, way))]
                found[f"{side}_{name}"] = max(hits, key=self._as_a_hip, default=None)
        for name, below in (("chest.front", CHEST), ("belly.front", BELLY)):
            found[name] = self._out(self.height - below * self.arm, 0.0, (1.0, 0.0, 0.0))
        return found

    def _as_a_hip(self, hit: Hit) -> tuple[bool, float]:
        """A hip is the higher place of those that are well to a side."""
        aside = abs(float(hit.point[1]))
        wide = aside > NARROW * self.half
        return wide, float(hit.point[2]) if wide else aside

    def _out(self, height: float, s: float, way: tuple[float, float, float]) -> Hit | None:
        """Where a ray leaves the trunk: at a height or near it, begun well to a side or less so."""
        for shift in (0.0, 0.06, -0.06, 0.12, -0.12):
            level = height + shift * self.arm
            for share in (BREAST, 0.35, 0.2, 0.0) if s else (0.0,):
                hit = self._cast(self._inside(level, s * share), way, self.core)
                if hit is not None:
                    return hit
            beside = None if s else self._cast(self._inside(level, GAP), way, self.core)
            if beside is not None:  # there is a gap between the left and the right side
                middle, front = np.array([1.0, 0.0, 1.0]), beside.normal * [1.0, 0.0, 1.0]
                return Hit(beside.link, beside.point * middle, front / np.linalg.norm(front))
        return None

    def eyes(self, head: str) -> FloatArray | None:
        """Between the eyes (3,), in the axes of the body; None if the head has no shape."""
        box = self._head_box(head)
        if box is None:
            return None
        low, high = box
        place = np.array([high[0], 0.0, low[2] + EYES * (high[2] - low[2])])
        origin = np.array([0.5 * (low[0] + high[0]), 0.0, place[2]])
        hit = self._cast(origin, (1.0, 0.0, 0.0), [head])
        return hit.point if hit is not None else place

    def _shoulder(self, s: float) -> Hit | None:
        """The top of a shoulder: what lies nearest to where Adonis has it.

        The trunk is better than a link that moves with the arm, and a level place than a wall.
        """
        limb = next(limb for limb, side in self.layout.sides.items() if side == s)
        joint = self.layout.places(limb)[0]
        wanted = joint * [1.0, TOP, 1.0] + [0.0, 0.0, ABOVE * self.arm]
        own = ("upper_arm", "forearm", "hand")
        carrying = [n for n in self.layout.chains[limb] if not n.endswith(own)]
        best: tuple[float, Hit] | None = None
        for links, shares, worse in ((self.core, TRUNK, 0.0), (carrying, BESIDE, MOVES)):
            for share in shares:
                origin = joint * [1.0, share, 1.0] - [0.0, 0.0, DEEP * self.arm]
                hit = self._cast(origin, (0.15, 0.0, 1.0), links)
                if hit is None:
                    continue
                off = float(np.linalg.norm((hit.point - wanted)[1:])) / self.arm
                off += worse + (STEEP if hit.normal[2] < UPWARD else 0.0)
                if best is None or off < best[0]:
                    best = off, hit
        return None if best is None else best[1]

    def _crooks(self) -> dict[str, Hit | None]:
        found = {}
        for limb, s in self.layout.sides.items():
            side = "left" if s > 0 else "right"
            _, elbow, wrist = self.layout.places(limb)
            chain = self.layout.chains[limb]
            lower = chain[chain.index(f"{side}_forearm") : -1] or chain[-1:]
            place, way = elbow + CROOK * (wrist - elbow), (1.0, -0.5 * s, 0.0)
            hit = self._cast(place, way, list(lower))
            if hit is None:  # the segment lies beside its joints
                hit = self._cast(self._middle_near(place, list(lower)), way, list(lower))
            found[f"{side}_elbow.inside"] = hit
        return found

    def _middle_near(self, place: FloatArray, links: list[str]) -> FloatArray:
        """The point on the axes of the capsules of some links that is nearest to a place."""
        best = place
        least = np.inf
        for name, start, end, _ in self._capsules(links):
            del name
            along = end - start
            share = np.clip((place - start) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
            point = start + share * along
            if np.linalg.norm(point - place) < least:
                best, least = point, float(np.linalg.norm(point - place))
        return best

    def _head(self) -> dict[str, Hit | None]:
        head = self.layout.head
        box = self._head_box(head) if head else None
        if box is None:
            return {}
        centre = self._middle_of_head(head, box[0][2], box[1][2])
        found: dict[str, Hit | None] = {}
        for name, way in HEAD.items():
            hit = self._cast(centre, way, [head, *self.core])
            above = hit is not None and hit.point[2] > head_from(self.layout)
            found[name] = hit if above else self._cast(centre, way, [head])
        return found

    def _middle_of_head(self, head: str, low: float, high: float) -> FloatArray:
        """The middle (3,) of the thickest capsule in the upper half of a head: of its skull."""
        found = [(r, 0.5 * (a + b)) for _, a, b, r in self._capsules([head])]
        upper = [(r, c) for r, c in found if c[2] > 0.5 * (low + high)] or found
        _, centre = max(upper, key=lambda each: each[0])
        return np.array(centre * [1.0, 0.0, 1.0])

    def _head_box(self, head: str) -> tuple[FloatArray, FloatArray] | None:
        """Lowest and highest corner of a head; if it is part of the trunk, of what is high up."""
        ends = self._ends([head])
        if head == "trunk":
            ends = ends[ends[:, 2] > head_from(self.layout)]
            ends = ends[np.abs(ends[:, 1]) < 0.6 * self.half] if len(ends) else ends
        if not len(ends):
            return None
        return ends.min(axis=0), ends.max(axis=0)

    def _inside(self, height: float, share: float) -> FloatArray:
        """A point inside the body at a height, so far to a side, of half its breadth."""
        ends = self._ends(self.core)
        near = ends[np.abs(ends[:, 2] - height) < 0.25 * self.arm]
        half = min(float(np.abs(near[:, 1]).max(initial=0.0)), self.half) or self.half
        deep = near[np.abs(near[:, 1]) < 0.6 * half + 0.01, 0]
        middle = 0.5 * (deep.min() + deep.max()) if len(deep) else self.middle[0]
        return np.array([middle, share * half, height])

    def _capsules(self, links: list[str]) -> list[tuple[str, FloatArray, FloatArray, float]]:
        """The capsules of some links: link, ends (3,) in the axes of the body, radius."""
        found = []
        for name in (name for name in links if name in self.names):
            origin = self.layout.link(name).origin
            own = self.model.geom_bodyid == self.model.body(name).id
            for geom in np.flatnonzero(own & (self.model.geom_contype > 0)):
                half = _along(self.model, int(geom)) * self.model.geom_size[geom, 1]
                middle = self.model.geom_pos[geom] + origin
                radius = float(self.model.geom_size[geom, 0])
                found.append((name, middle - half, middle + half, radius))
        return found

    def _ends(self, links: list[str]) -> FloatArray:
        """Points (k, 3) all over the capsules of some links, in the axes of the body."""
        points = [np.zeros((0, 3))]
        six = np.concatenate([np.eye(3), -np.eye(3)])
        for _, start, end, radius in self._capsules(links):
            points += [start + share * (end - start) + radius * six for share in (0.0, 0.5, 1.0)]
        return np.concatenate(points)

    def _cast(
        self, origin: FloatArray, way: tuple[float, float, float], links: list[str]
    ) -> Hit | None:
        """Where a ray leaves the outermost of some links."""
        best: tuple[float, Hit] | None = None
        direction = np.array(way) / np.linalg.norm(way)
        for name in (name for name in links if name in self.names):
            shift = self.layout.link(name).origin
            hit = leave(self.model, Ray("", name, origin - shift, direction))
            if hit is None:
                continue
            point = hit[0] + shift
            far = float((point - origin) @ direction)
            if far > 0.0 and (best is None or far > best[0]):
                best = far, Hit(name, point, hit[1])
        return None if best is None else best[1]

    def _said(self, hit: Hit) -> LandmarkOf:
        place = hit.point - self.layout.link(hit.link).origin
        x, y, z = (round(float(v), 4) + 0.0 for v in place)
        a, b, c = (round(float(v), 3) + 0.0 for v in hit.normal)
        return LandmarkOf(link=hit.link, point=(x, y, z), normal=(a, b, c))


def _along(model: Any, geom: int) -> FloatArray:
    """The axis (3,) of a capsule, in the frame of its link."""
    w, x, y, z = model.geom_quat[geom]
    return np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])

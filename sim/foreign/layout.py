"""The links that a body is made of, out of a model and what its parts are called.

A link has every MuJoCo body between one joint that moves and the next. Its frame is new: forward,
left and up while the arms hang straight, with its origin where anatomy has it. Joints that
nobody names stay where they are, and what they carried becomes part of what carried them.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sim.errors import BodyError, unknown
from sim.foreign.arm import ArmAnatomy, find_arm
from sim.foreign.body_file import BodyFile, JointOf
from sim.foreign.geometry import nearest_on_line
from sim.foreign.hanging import Frame
from sim.foreign.reading import LEAST_MASS
from sim.foreign.surface import Shape, solid
from sim.foreign.tree import BASE, MOVING, Tree

FloatArray = NDArray[np.float64]

AXES = {
    f"{sign}{letter}": (1.0 if sign == "+" else -1.0) * np.eye(3)[k]
    for k, letter in enumerate("xyz")
    for sign in "+-"
}
ARM_JOINTS = ("elbow", *(f"{part}_{axis}" for part in ("shoulder", "wrist") for axis in "xyz"))
ARM_LINKS = ("upper_arm", "forearm", "hand")
WAIST_BELOW = 0.67  # of upper arm and forearm: so far below the shoulders is the trunk's origin


@dataclass(frozen=True)
class Joint:
    """A joint of a link, in the axes of the body, the arms hanging."""

    name: str  # in the new model
    index: int  # in the old one
    sense: float  # -1 if its angle grows as the old one falls
    zero: float  # the old angle where the new one is 0 [rad]
    anchor: FloatArray  # (3,) [m]
    axis: FloatArray  # (3,) about which its new angle is positive
    said: JointOf


@dataclass(frozen=True)
class Link:
    """A link of the new model."""

    name: str
    parent: str  # "": the world
    origin: FloatArray  # (3,) in the axes of the body [m]
    bodies: tuple[int, ...]  # MuJoCo bodies of the old model
    joints: tuple[Joint, ...]
    beyond: FloatArray | None = None  # (3,) along the forearm, where the hand is cut off it


@dataclass(frozen=True)
class Layout:
    """All links, each after the one that carries it, and where things are."""

    tree: Tree
    axes: FloatArray  # (3, 3): takes vectors of the old world to forward, left, up
    shift: (
        FloatArray  # (3,) what is added then: feet on the floor, shoulders on either side of 0 [m]
    )
    links: tuple[Link, ...]
    arms: dict[str, ArmAnatomy]  # by limb
    sides: dict[str, float]  # by limb: +1 left, -1 right
    chains: dict[str, tuple[str, ...]]  # limb -> its links from the trunk outwards
    waist: tuple[str, ...]  # joints
    neck: tuple[str, ...]
    head: str  # link; "" if there is none

    def link(self, name: str) -> Link:
        """A link by name."""
        for link in self.links:
            if link.name == name:
                return link
        raise BodyError(unknown("link", name, [link.name for link in self.links]))

    def placed(self, points: FloatArray) -> FloatArray:
        """Points (..., 3) of the old world in the axes of the body."""
        moved: FloatArray = points @ self.axes.T + self.shift
        return moved

    def shapes(
        self, link: Link, chosen: Callable[[list[Shape]], list[Shape]], body: int | None = None
    ) -> list[Shape]:
        """Geoms of a link, or of one of its bodies, in the frame of the link.

        Args:
            link: of this layout.
            chosen: which of those of each MuJoCo body: `solid` or `drawn`.
            body: one of them; default: all.
        """
        found = []
        for own in link.bodies if body is None else (body,):
            for shape in chosen(self.tree.shapes(own)):
                points = self.placed(self.tree.where(own, shape.points)) - link.origin
                found.append(Shape(points, shape.faces, shape.rgba, shape.collides))
        return found

    def places(self, limb: str) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Shoulder, elbow and wrist (3,) of an arm that hangs, in the axes of the body."""
        shoulder, elbow, wrist = (self.placed(p) for p in self.arms[limb].places(self.tree))
        return shoulder, elbow, wrist

    def length(self, limb: str) -> float:
        """Length of upper arm and forearm [m]."""
        shoulder, elbow, wrist = self.places(limb)
        return float(np.linalg.norm(elbow - shoulder) + np.linalg.norm(wrist - elbow))


def lay_out(tree: Tree, file: BodyFile) -> Layout:
    """Lay out the links of a body; the tree is left posed with hanging arms.

    Raises:
        BodyError: the file names something that the model does not have, or in no order that
            makes sense.
    """
    frame = Frame.of(_direction(file.base.forward, "forward"), _direction(file.base.up, "up"))
    named = _named_joints(tree, file)
    tree.pose(_angles(tree, file, named))
    arms, sides, chains = {}, {}, {}
    for name, limb in file.limbs.items():
        if "elbow" not in limb.joints:
            raise BodyError(f"{name!r} has no joint 'elbow' (there are: {', '.join(limb.joints)})")
        joints = [_index(tree, of.joint) for of in limb.joints.values()]
        _check_chain(tree, joints, name)
        arms[name] = find_arm(tree, joints, limb.joints["elbow"].joint)
        sides[name] = 1.0 if limb.side == "left" else -1.0
    moving = {int(tree.model.jnt_bodyid[j]) for j in named}

    def carrier(body: int) -> int:
        while body != BASE and body not in moving:
            body = int(tree.model.body_parentid[body])
        return body

    called = _called(tree, file, arms, carrier)
    for name, arm in arms.items():
        chains[name] = tuple(called.get(link, tree.name(link)) for link in arm.links)
    half = Layout(
        tree=tree,
        axes=frame.axes,
        shift=_shift(tree, frame, list(arms.values()), file.base.height),
        links=(),
        arms=arms,
        sides=sides,
        chains=chains,
        waist=tuple(file.waist),
        neck=tuple(file.neck),
        head=called.get(carrier(_body(tree, file.head.link)), "") if file.head else "",
    )
    links = _merged(half, _links(half, named, moving, carrier, called))
    found = Layout(**{**vars(half), "links": tuple(links)})
    return _with_hands(found)


def _shift(tree: Tree, frame: Frame, arms: Sequence[ArmAnatomy], height: float) -> FloatArray:
    """What puts the base at its height, and the middle between two shoulders above the x axis."""
    sideways = [float(frame.left @ arm.places(tree)[0]) for arm in arms]
    middle = float(np.mean(sideways)) if len(sideways) > 1 else 0.0
    return np.array([0.0, -middle, height])


def _with_hands(layout: Layout) -> Layout:
    """A hand without joints of its own is cut off the forearm, and fixed to it."""
    links, chains = list(layout.links), dict(layout.chains)
    for name, arm in layout.arms.items():
        if arm.hand != arm.forearm:
            continue
        side = "left" if layout.sides[name] > 0 else "right"
        _, elbow, wrist = layout.places(name)
        forearm = layout.link(f"{side}_forearm")
        hand = Link(f"{side}_hand", forearm.name, wrist, forearm.bodies, (), beyond=wrist - elbow)
        links.insert(links.index(forearm) + 1, hand)
        chains[name] = (*chains[name], hand.name)
    return Layout(**{**vars(layout), "links": tuple(links), "chains": chains})


def _links(
    layout: Layout,
    named: dict[int, tuple[str, JointOf]],
    moving: set[int],
    carrier: Callable[[int], int],
    called: dict[int, str],
) -> list[Link]:
    """A link for the base and one for each MuJoCo body that a named joint moves."""
    tree, found = layout.tree, []
    whole: dict[int, list[int]] = {}
    for body in range(tree.model.nbody):
        whole.setdefault(carrier(body), []).append(body)
    for body in sorted({BASE, *moving}):
        joints = tuple(_joint(layout, j, *named[j]) for j in tree.joints_on(body) if j in named)
        parent = carrier(int(tree.model.body_parentid[body])) if body != BASE else BASE
        found.append(
            Link(
                name=_name_of(tree, body, called),
                parent=_name_of(tree, parent, called) if body != BASE else "",
                origin=_origin(layout, body, joints, called.get(body, "")),
                bodies=tuple(whole.get(body, ())),
                joints=joints,
            )
        )
    return found


def _merged(layout: Layout, links: list[Link]) -> list[Link]:
    """Links without mass and shape, which only stand between hinges, become one with the next."""
    kept = {"trunk", "pelvis", "head"}
    kept |= {f"{side}_{part}" for side in ("left", "right") for part in ARM_LINKS}
    result: list[Link] = []
    waiting: dict[str, Link] = {}
    for own in links:
        link = own
        if own.parent in waiting:
            before = waiting.pop(own.parent)
            link = Link(
                own.name, before.parent, own.origin,
                (*before.bodies, *own.bodies), (*before.joints, *own.joints),
            )  # fmt: skip
        carried = [other for other in links if other.parent == link.name]
        if _is_empty(layout, link) and len(carried) == 1 and link.name not in kept:
            waiting[link.name] = link
        else:
            result.append(link)
    return result


def _is_empty(layout: Layout, link: Link) -> bool:
    """Whether a link has neither mass nor shape."""
    model = layout.tree.model
    mass = sum(model.body_mass[b] for b in link.bodies if model.body_mass[b] > 2 * LEAST_MASS)
    return bool(link.joints) and mass == 0.0 and not layout.shapes(link, solid)


def _joint(layout: Layout, index: int, name: str, said: JointOf) -> Joint:
    tree, sense = layout.tree, -1.0 if said.flipped else 1.0
    return Joint(
        name=name,
        index=index,
        sense=sense,
        zero=float(np.deg2rad(said.zero)),
        anchor=layout.placed(tree.anchor(index)),
        axis=sense * (layout.axes @ tree.axis(index)),
        said=said,
    )


def _origin(layout: Layout, body: int, joints: Sequence[Joint], name: str) -> FloatArray:
    """Where a link's frame is: at the shoulder, elbow, wrist, waist, neck; else at its joint."""
    tree = layout.tree
    for limb, arm in layout.arms.items():
        ends = dict(zip((arm.upper_arm, arm.forearm, arm.hand), layout.places(limb), strict=True))
        if body in ends:
            return ends[body]
    if name == "trunk":
        return _waist_point(layout)
    if len(joints) and name == "head":
        return _meeting(joints, layout)
    return joints[0].anchor if joints else layout.placed(np.array(tree.data.xpos[body]))


def _waist_point(layout: Layout) -> FloatArray:
    """The origin of the trunk: below the middle of the shoulders, as far as on Adonis."""
    shoulders = [layout.places(limb)[0] for limb in layout.arms]
    middle = np.mean(shoulders, axis=0)
    if len(shoulders) == 1:
        middle = middle * [1.0, 0.0, 1.0]
    arm = float(np.mean([layout.length(limb) for limb in layout.arms]))
    point: FloatArray = middle - np.array([0.0, 0.0, WAIST_BELOW * arm])
    return point


def _meeting(joints: Sequence[Joint], layout: Layout) -> FloatArray:
    """Where the axes of the last two joints meet."""
    last = joints[-1]
    others = [j for link in layout.links for j in link.joints]
    for other in [*joints[:-1], *others][::-1]:
        if abs(other.axis @ last.axis) < 0.9:
            return nearest_on_line(last.anchor, last.axis, other.anchor, other.axis)
    return last.anchor


def _named_joints(tree: Tree, file: BodyFile) -> dict[int, tuple[str, JointOf]]:
    """Every joint that moves: its index, its new name, and what is said of it."""
    found: dict[int, tuple[str, JointOf]] = {}
    groups: list[tuple[str, dict[str, JointOf]]] = [("", file.waist), ("", file.neck)]
    groups += [(limb.side, limb.joints) for limb in file.limbs.values()]
    taken: set[str] = set()
    for side, joints in groups:
        for name, of in joints.items():
            index = _index(tree, of.joint)
            if tree.model.jnt_type[index] != MOVING[0]:
                raise BodyError(f"{of.joint!r} is a slide: postures are angles, so lock it")
            if index in found:
                raise BodyError(f"the joint {of.joint!r} is named twice")
            new = joint_name(side, name)
            if new in taken:
                raise BodyError(f"two joints would be called {new!r}")
            taken.add(new)
            found[index] = new, of
    return found


def joint_name(side: str, name: str) -> str:
    """The name of a joint in the new model: anatomical ones of an arm say its side."""
    return f"{side}_{name}" if side and name in ARM_JOINTS else name


def _angles(tree: Tree, file: BodyFile, named: dict[int, tuple[str, JointOf]]) -> dict[str, float]:
    """Where all joints are, in the model's own sense [rad or m]."""
    angles = {}
    for name, value in file.locked.items():
        hinge = tree.model.jnt_type[_index(tree, name)] == MOVING[0]
        angles[name] = float(np.deg2rad(value)) if hinge else value
    for index, (_, of) in named.items():
        if of.joint in angles:
            raise BodyError(f"the joint {of.joint!r} is both locked and named")
        angles[tree.joint_name(index)] = float(np.deg2rad(of.zero))
    return angles


def _check_chain(tree: Tree, joints: Sequence[int], limb: str) -> None:
    """The joints of a limb follow each other from the trunk outwards."""
    links = list(dict.fromkeys(int(tree.model.jnt_bodyid[j]) for j in joints))
    for inner, outer in pairwise(links):
        body = outer
        while body not in (inner, BASE):
            body = int(tree.model.body_parentid[body])
        if body != inner:
            names = (tree.name(inner), tree.name(outer))
            raise BodyError(
                f"{limb!r}: its joints are to follow each other from the trunk outwards, but link"
                f" {names[0]!r} does not carry {names[1]!r}"
            )


def _called(
    tree: Tree, file: BodyFile, arms: dict[str, ArmAnatomy], carrier: Callable[[int], int]
) -> dict[int, str]:
    """Anatomical names of links."""
    trunk = carrier(_body(tree, file.trunk))
    called = {} if trunk == BASE else {BASE: "pelvis"}
    called[trunk] = "trunk"
    if file.head is not None:
        head = carrier(_body(tree, file.head.link))
        called.setdefault(head, "head")
    for name, arm in arms.items():
        side = file.limbs[name].side
        for link, part in (
            (arm.upper_arm, "upper_arm"),
            (arm.forearm, "forearm"),
            (arm.hand, "hand"),
        ):
            called.setdefault(link, f"{side}_{part}")
    return called


def _name_of(tree: Tree, body: int, called: dict[int, str]) -> str:
    """The anatomical name of a link; else its own, unless that is some other's anatomical one."""
    if body in called:
        return called[body]
    own = tree.name(body)
    return f"{own}_link" if own in called.values() else own


def _direction(said: str | Iterable[float], key: str) -> FloatArray:
    if isinstance(said, str):
        if said not in AXES:
            raise BodyError(unknown(f"axis of {key}", said, AXES))
        return np.array(AXES[said])
    vector = np.array(list(said), dtype=float)
    length = float(np.linalg.norm(vector))
    if length < 1e-9:
        raise BodyError(f"base: {key!r} has no length")
    return vector / length


def _index(tree: Tree, name: str) -> int:
    names = [tree.joint_name(j) for body in range(tree.model.nbody) for j in tree.joints_on(body)]
    if name not in names:
        raise BodyError(unknown("joint of the model", name, names))
    return tree.joint(name)


def _body(tree: Tree, name: str) -> int:
    names = [tree.name(body) for body in range(tree.model.nbody)]
    if name not in names:
        raise BodyError(unknown("link of the model", name, names))
    return tree.body(name)

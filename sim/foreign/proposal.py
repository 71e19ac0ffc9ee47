"""A first body file for a model: everything that can be guessed of it, and what was guessed."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.foreign.anatomy import SIDES, Anatomy, Arm, find_anatomy
from sim.foreign.body_file import (
    Base,
    BodyFile,
    HeadOf,
    JointOf,
    LandmarkOf,
    LimbOf,
    PalmOf,
    Place,
)
from sim.foreign.building import build_spec
from sim.foreign.filling import fill_joints, fill_masses
from sim.foreign.layout import AXES, Layout, lay_out
from sim.foreign.marking import Marker
from sim.foreign.naming import Named
from sim.foreign.parts import HEAD_WORDS
from sim.foreign.reading import Source
from sim.foreign.resting import HOPELESS, clipped, rest_posture
from sim.foreign.shaping import shapes_for, surface_of
from sim.foreign.tree import Tree
from sim.landmarks import Ray, leave

FloatArray = NDArray[np.float64]

HAND = 0.45  # of the hand, from the wrist: the middle of the palm
HAND_LENGTH = 0.7  # of the forearm, of a hand that cannot be seen
HANDS_UP = 0.4  # of upper arm and forearm: so far above the floor are hands that hang
PALM_UNSEEN = 0.013  # half the thickness of such a hand [m]


@dataclass
class Proposal:
    """A body file and what there is to say about it."""

    file: BodyFile
    notes: dict[tuple[str, ...], str] = field(default_factory=dict)  # by place in the file
    said: list[str] = field(default_factory=list)  # of the model as a whole


def propose(source: Source, name: str, model: str) -> Proposal:
    """Guess a body file.

    Args:
        source: the model.
        name: of the body.
        model: how the body file is to name the model's file.

    Raises:
        BodyError: nothing in the model looks like an arm.
    """
    tree = Tree(source)
    anatomy = find_anatomy(tree)
    file, notes = _anatomical(tree, anatomy, name, model)
    layout = lay_out(tree, file)
    hangs = all(arm.hanging.off < HOPELESS for arm in anatomy.arms)
    height = _height(layout, hangs)
    file = file.model_copy(update={"base": file.base.model_copy(update={"height": height})})
    layout = lay_out(tree, file)
    shapes, unseen = shapes_for(layout)
    file = fill_masses(layout, file.model_copy(update={"shapes": shapes}))
    if unseen:
        notes["shapes",] = f"guessed without a surface: {', '.join(unseen)}"
    if file.masses:
        notes["masses",] = (
            "guessed, since the model gives none: shapes at 1000 kg/m^3, else a trifle"
        )
    file, filled = fill_joints(layout, file)
    layout = lay_out(tree, file)
    file = _with_palms(layout, anatomy, file)
    angles, overlapping = rest_posture(tree, anatomy, layout, file, hangs)
    layout = lay_out(tree, file)  # the arms hang straight again
    compiled = build_spec(layout, file, looks=False).compile()
    core = dict.fromkeys((*file.waist, *file.neck), 0.0)
    postures = {"upright": clipped(compiled, core), "rest": clipped(compiled, angles | core)}
    marks = _landmarks(layout, compiled, anatomy)
    update: dict[str, object] = {
        "postures": postures,
        "may_overlap": overlapping,
        "landmarks": marks,
    }
    if file.head is not None:
        eyes = Marker(layout, compiled, None).eyes(layout.head)
        if eyes is not None:
            eyes = eyes - layout.link(layout.head).origin
            update["head"] = file.head.model_copy(update={"eyes": _place(eyes)})
    file = file.model_copy(update=update)
    return Proposal(file, notes | _notes(anatomy, filled, hangs), _said(tree, file))


def _anatomical(
    tree: Tree, anatomy: Anatomy, name: str, model: str
) -> tuple[BodyFile, dict[tuple[str, ...], str]]:
    """The parts of the body, without shapes, postures and landmarks."""
    parts, frame = anatomy.parts, anatomy.facing.frame
    limbs = {}
    for arm in anatomy.arms:
        side = SIDES[arm.side]
        joints = {
            named.name: _joint(tree, named, arm.hanging.angles[tree.joint_name(named.joint)])
            for named in arm.joints
        }
        inward = 1.0 if side == "right" else -1.0
        palm = PalmOf(point=(0.0, 0.0, 0.0), normal=(0.0, inward, 0.0))
        limbs[f"{side}_arm"] = LimbOf(side=side, joints=joints, palm=palm)
    trunk = _main_body(tree, parts.trunk)
    heads = [body for body in tree.bodies(parts.trunk) if HEAD_WORDS.search(tree.name(body))]
    head = parts.neck[-1] if parts.neck else (heads or [trunk])[0]
    file = BodyFile(
        body=name,
        model=model,
        base=Base(forward=_axis(frame.forward), up=_axis(frame.up)),
        trunk=tree.name(trunk),
        waist=_core(tree, anatomy.waist),
        neck=_core(tree, anatomy.neck),
        head=HeadOf(link=tree.name(head), eyes=(0.0, 0.0, 0.0)),
        limbs=limbs,
        locked=_not_at_zero(tree, anatomy),
    )
    return file, {}


def _main_body(tree: Tree, link: int) -> int:
    """The heaviest of the MuJoCo bodies of a link: what it is called after."""
    return max(tree.bodies(link), key=lambda body: float(tree.model.body_mass[body]))


def _core(tree: Tree, joints: Iterable[Named]) -> dict[str, JointOf]:
    """Joints of waist or neck: upright as the model is at home."""
    places = {named.joint: tree.model.jnt_qposadr[named.joint] for named in joints}
    return {
        named.name: _joint(tree, named, float(tree.source.home[places[named.joint]]))
        for named in joints
    }


def _joint(tree: Tree, named: Named, zero: float) -> JointOf:
    return JointOf(
        joint=tree.joint_name(named.joint),
        zero=round(float(np.rad2deg(zero)), 1) + 0.0,
        flipped=named.flipped,
    )


def _not_at_zero(tree: Tree, anatomy: Anatomy) -> dict[str, float]:
    """Slides that stand between base and trunk or head: there is a choice where they stay."""
    links = (*anatomy.parts.waist, *anatomy.parts.neck)
    named = {n.joint for n in (*anatomy.waist, *anatomy.neck)}
    found = {}
    for joint in (j for link in links for j in tree.joints_on(link) if j not in named):
        found[tree.joint_name(joint)] = round(
            float(tree.source.home[tree.model.jnt_qposadr[joint]]), 4
        )
    return found


def _axis(direction: FloatArray) -> str | Place:
    """A direction as one of the model's own axes, if it is one."""
    for name, axis in AXES.items():
        if float(axis @ direction) > 1.0 - 1e-6:
            return name
    return _place(direction)


def _height(layout: Layout, hang: bool) -> float:
    """How high the model must be [m]: with its lowest point on the floor.

    If that are hands that hang, they are well above it: such a body stands on nothing.
    """
    lowest: dict[bool, float] = {True: np.inf, False: np.inf}
    on_arms = {name for chain in layout.chains.values() for name in chain}
    for link in layout.links:
        least = float(surface_of(layout, link)[:, 2].min(initial=np.inf) + link.origin[2])
        lowest[link.name in on_arms] = min(least, lowest[link.name in on_arms])
    arm = max(layout.length(limb) for limb in layout.arms)
    if hang and lowest[True] < lowest[False]:
        return round(HANDS_UP * arm - lowest[True], 3) + 0.0
    return round(-lowest[False], 3) + 0.0 if np.isfinite(lowest[False]) else 0.0


def _with_palms(layout: Layout, anatomy: Anatomy, file: BodyFile) -> BodyFile:
    """The file with the middle of each palm: on the surface of the hand, inward."""
    spec = build_spec(layout, file, looks=False)
    model = spec.compile()
    limbs = dict(file.limbs)
    for arm in anatomy.arms:
        side = SIDES[arm.side]
        name = f"{side}_arm"
        point = _palm_point(layout, model, arm, name, side)
        palm = limbs[name].palm.model_copy(update={"point": _place(point)})
        limbs[name] = limbs[name].model_copy(update={"palm": palm})
    return file.model_copy(update={"limbs": limbs})


def _palm_point(layout: Layout, model: object, arm: Arm, limb: str, side: str) -> FloatArray:
    """The middle of a palm (3,) in the frame of the hand."""
    hand = layout.link(f"{side}_hand")
    points = surface_of(layout, hand)
    _, elbow, wrist = layout.places(limb)
    length = float(-points[:, 2].min(initial=0.0)) if len(points) else 0.0
    length = length or HAND_LENGTH * float(np.linalg.norm(wrist - elbow))
    inward = np.array([0.0, -arm.side, 0.0])
    middle = np.array([0.0, 0.0, -HAND * length])
    near = points[np.abs(points[:, 2] - middle[2]) < 0.15 * length] if len(points) else points
    if len(near):
        middle[:2] = 0.5 * (near[:, :2].min(axis=0) + near[:, :2].max(axis=0))
    hit = leave(model, Ray("", hand.name, middle, inward))
    return hit[0] if hit is not None else middle + PALM_UNSEEN * inward


def _landmarks(layout: Layout, model: object, anatomy: Anatomy) -> dict[str, LandmarkOf]:
    """Landmarks, with the hips at the joints of the legs if there are two."""
    tree, hips = layout.tree, None
    if len(anatomy.parts.legs) == 2:
        starts = [layout.placed(tree.start(leg))[2] for leg in anatomy.parts.legs]
        hips = float(np.mean(starts))
    return Marker(layout, model, hips).landmarks()


def _notes(
    anatomy: Anatomy, filled: dict[str, list[str]], hangs: bool
) -> dict[tuple[str, ...], str]:
    """What to say beside the parts of the file."""
    facing = anatomy.facing
    notes: dict[tuple[str, ...], str] = {}
    heard = ", ".join(facing.witnesses)
    against = f"; against: {', '.join(facing.against)}" if facing.against else ""
    doubt = "" if facing.sure else "DOUBTFUL: look at the picture. "
    notes["base", "forward"] = f"{doubt}guessed from {heard}{against}"
    notes["base", "up"] = "guessed: from legs to arms" if anatomy.parts.legs else "guessed"
    notes["base", "height"] = "guessed: its lowest point is on the floor"
    for arm in anatomy.arms:
        limb = f"{SIDES[arm.side]}_arm"
        notes["limbs", limb, "palm"] = f"guessed: {arm.palm.why}"
        if not hangs:
            notes["limbs", limb, "joints"] = "this arm cannot hang straight within its limits"
    for joint, what in filled.items():
        notes["joint", joint] = f"guessed: {', '.join(what)}"
    return notes


def _said(tree: Tree, file: BodyFile) -> list[str]:
    """What was done to the model as a whole."""
    named = {of.joint for of in (*file.waist.values(), *file.neck.values())}
    named |= {of.joint for limb in file.limbs.values() for of in limb.joints.values()}
    others = [
        tree.joint_name(j) for link in tree.links for j in tree.joints_on(link)
        if tree.joint_name(j) not in named
    ]  # fmt: skip
    said = list(tree.source.notes)
    if others:
        some = ", ".join(others[:3]) + (f" and {len(others) - 3} more" if others[3:] else "")
        said.append(f"{len(others)} joints are locked where they are at home: {some}")
    alone = [f"{one} ({other})" for one, other in tree.source.follows.items() if one in named]
    if alone:
        said.append(f"they follow others in the model, and move by themselves: {', '.join(alone)}")
    return said


def body_name(path: Path) -> str:
    """What a body is called after its model's file: `robot` of `robot.urdf`."""
    word = re.sub(r"[^A-Za-z0-9_-]+", "-", path.name.split(".")[0]).strip("-")
    return word or "robot"


def _place(point: FloatArray) -> Place:
    x, y, z = (round(float(v), 4) + 0.0 for v in point)
    return x, y, z

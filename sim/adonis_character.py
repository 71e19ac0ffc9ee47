"""Adonis: the humanoid torso of Mataric, Zordan & Williamson (1999), section 3.

Eight moving links (trunk, head, two upper arms, forearms and hands) on static legs, and
20 hinges: waist 3, neck 3, shoulders 3 + 3, elbows 1 + 1, wrists 3 + 3. The paper never
published its masses and sizes; these come from `sim.anthropometry`, and every dimension
below scales with them. What is drawn is what collides: spheres and capsules only, so that
the distance between any two geoms has a closed form.

X is forward, Y left, Z up. At zero the arms hang straight down, palms against the thighs.
Angles are anatomical and the same for both sides: flexion, abduction, internal rotation
and pronation are positive.
"""

from typing import Any

import mujoco
import numpy as np

from sim.anthropometry import MALE, PALM, Anthropometry, Segment
from sim.landmarks import Ray, place_landmarks
from sim.physics import set_physics
from sim.scenery import set_scene

Vector = tuple[float, float, float]

SKIN = (0.85, 0.64, 0.52, 1.0)
SHIRT = (0.16, 0.42, 0.62, 1.0)
TROUSERS = (0.20, 0.21, 0.25, 1.0)
DARK = (0.13, 0.10, 0.09, 1.0)
FRICTION = 0.2  # clothed skin on skin
SOFTNESS = [0.02, 1.0]  # of flesh in contact: time constant [s] and damping ratio
EYES = (0.387, 0.0, 0.64)  # between them: forward, left, up [lengths of the head]
SIDES = {"right": -1.0, "left": 1.0}

# Range [deg], torque limit [N m] (joint torque bounds of the BSD-licensed human.urdf),
# armature [kg m^2] and damping [N m s/rad] of muscle and tendon.
JOINTS: dict[str, tuple[tuple[float, float], float, float, float]] = {
    "waist_z": ((-40, 40), 160.0, 0.10, 5.0),
    "waist_x": ((-30, 30), 160.0, 0.10, 5.0),
    "waist_y": ((-20, 70), 190.0, 0.10, 5.0),
    "neck_z": ((-75, 75), 100.0, 0.02, 1.0),
    "neck_x": ((-40, 40), 100.0, 0.02, 1.0),
    "neck_y": ((-50, 60), 100.0, 0.02, 1.0),
    "shoulder_y": ((-60, 180), 92.0, 0.02, 0.8),
    "shoulder_x": ((-50, 180), 71.0, 0.02, 0.8),
    "shoulder_z": ((-100, 100), 52.0, 0.02, 0.6),
    "elbow": ((0, 150), 77.0, 0.01, 0.4),
    "wrist_z": ((-90, 90), 20.0, 0.004, 0.10),
    "wrist_x": ((-70, 80), 15.0, 0.004, 0.08),
    "wrist_y": ((-35, 25), 15.0, 0.004, 0.08),
}


def joint_axis(name: str, side: float = 1.0) -> Vector:
    """Axis about which the anatomical angle `name` is positive; side is +1 left, -1 right."""
    return {
        "waist_z": (0.0, 0.0, 1.0),  # twist to the left
        "waist_x": (1.0, 0.0, 0.0),  # lean to the right
        "waist_y": (0.0, 1.0, 0.0),  # bow
        "neck_z": (0.0, 0.0, 1.0),
        "neck_x": (1.0, 0.0, 0.0),
        "neck_y": (0.0, 1.0, 0.0),
        "shoulder_y": (0.0, -1.0, 0.0),  # flexion: arm forward
        "shoulder_x": (side, 0.0, 0.0),  # abduction: arm to its side
        "shoulder_z": (0.0, 0.0, -side),  # internal rotation
        "elbow": (0.0, -1.0, 0.0),  # flexion
        "wrist_z": (0.0, 0.0, -side),  # pronation
        "wrist_x": (-side, 0.0, 0.0),  # flexion: fingers towards the palm
        "wrist_y": (0.0, -1.0, 0.0),  # radial deviation: towards the thumb
    }[name]


def build_adonis(person: Anthropometry, *, limits: bool = True, contacts: bool = True) -> Any:
    """The character as an `mujoco.MjSpec`, ready to be edited or compiled.

    Args:
        person: segment masses, lengths and moments.
        limits: joint limits; the paper's runs had none.
        contacts: collisions of the body with itself; the paper's runs had none.
    """
    return _Builder(person, limits, contacts).build()


def build_single_arm(
    person: Anthropometry, side: str, *, limits: bool = True, contacts: bool = True
) -> Any:
    """One arm of the character on a pedestal, which is called its trunk, as an `mujoco.MjSpec`."""
    return _Builder(person, limits, contacts).build_arm(side)


class _Builder:
    """Adds the links one by one; every coordinate is in the frame of its link [m]."""

    def __init__(self, person: Anthropometry, limits: bool, contacts: bool) -> None:
        self.person, self.limits, self.contacts = person, limits, contacts
        self.a, self.b = person.trunk_half_axes
        self.hip_height = person.stature - person.head.length - person.whole_trunk.length
        self.c7_height = person.stature - person.head.length
        self.waist_height = self.c7_height - person.waist_length
        self.shoulder = (0.0, 1.10 * self.a, person.waist_length - 0.186 * person.waist_length)
        self.spec = mujoco.MjSpec()
        self.rays: list[Ray] = []

    def build(self) -> Any:
        self._world()
        self._legs()
        trunk = self._trunk()
        self._head(trunk)
        for side in SIDES:
            self._arm(trunk, side)
        self._collisions()
        return self._finished()

    def build_arm(self, side: str) -> Any:
        self._world()
        trunk = self.spec.worldbody.add_body(name="trunk", pos=[0.0, 0.0, self.waist_height])
        self._pedestal(trunk, SIDES[side])
        self._arm(trunk, side)
        self.spec.add_exclude(bodyname1="trunk", bodyname2=f"{side}_upper_arm")
        self.spec.add_exclude(bodyname1=f"{side}_upper_arm", bodyname2=f"{side}_hand")
        return self._finished()

    def _finished(self) -> Any:
        """The model with its motors and landmarks."""
        for joint in self.spec.joints:
            self.spec.add_actuator(
                name=joint.name,
                target=joint.name,
                trntype=mujoco.mjtTrn.mjTRN_JOINT,
                ctrllimited=True,
                ctrlrange=[-joint.actfrcrange[1], joint.actfrcrange[1]],
            )
        place_landmarks(self.spec, self.rays)
        return self.spec

    # --- the parts -------------------------------------------------------------------

    def _world(self) -> None:
        spec = self.spec
        spec.modelname = "adonis"
        spec.compiler.degree = False
        spec.memory = 4 << 20
        set_physics(spec, contacts=self.contacts)
        height = self.person.stature
        set_scene(spec, (0.12, 0.0, 0.71 * height), 0.70 * height)

    def _legs(self) -> None:
        """The static lower trunk and legs, one link that is fixed to the floor."""
        person, a, b = self.person, self.a, self.b
        pelvis = self.spec.worldbody.add_body(name="pelvis", pos=[0.0, 0.0, self.hip_height])
        top = self.waist_height - self.hip_height
        half = 0.97 * a
        thigh, shank = 0.46 * self.hip_height, 0.46 * self.hip_height
        self._capsule(
            pelvis, "hips", (0, half - b, 0.32 * top), (0, b - half, 0.32 * top), b, TROUSERS
        )
        for side, s in SIDES.items():
            hip = (0.0, s * 0.50 * a, 0.0)
            knee = (0.01, s * 0.47 * a, -thigh)
            ankle = (-0.02, s * 0.47 * a, -thigh - shank)
            toe = (0.15, s * 0.55 * a, -self.hip_height + 0.04)
            heel = (-0.03, s * 0.47 * a, -self.hip_height + 0.04)
            self._capsule(pelvis, f"{side}_thigh", hip, knee, 0.44 * a, TROUSERS)
            self._capsule(pelvis, f"{side}_shank", knee, ankle, 0.30 * a, TROUSERS)
            self._capsule(pelvis, f"{side}_foot", heel, toe, 0.04, DARK)
            crest = (0.0, s * (half - b), 0.32 * top)
            self._landmark(f"{side}_hip", pelvis, crest, (0.45, s, 0.15))
        _inertial(pelvis, person.mass * 0.4, (0, 0, -0.3), (1.0, 1.0, 0.3))

    def _pedestal(self, trunk: Any, s: float) -> None:
        """A column beside the arm, and a bracket that carries it."""
        y, z = s * self.shoulder[1], self.shoulder[2]
        inner = y - s * 0.22
        self._capsule(
            trunk, "column", (0, inner, -self.waist_height), (0, inner, z), 0.06, TROUSERS
        )
        self._capsule(trunk, "bracket", (0, inner, z), (0, y - s * 0.06, z), 0.045, TROUSERS)
        side = "left" if s > 0 else "right"
        self._landmark(f"{side}_shoulder.top", trunk, (0, y - s * 0.10, z), (0.30, 0.0, 1.0))
        self._landmark("chest.front", trunk, (0, inner, z - 0.09), (1, 0, 0))

    def _trunk(self) -> Any:
        person, a, b = self.person, self.a, self.b
        trunk = self.spec.worldbody.add_body(name="trunk", pos=[0.0, 0.0, self.waist_height])
        self._joints(trunk, ("waist_z", "waist_x", "waist_y"))
        segment = person.moving_trunk
        _inertial(trunk, segment.mass, (0, 0, segment.length - segment.com), segment.inertia)
        length, sy, sz = person.waist_length, self.shoulder[1], self.shoulder[2]
        chest = 0.88 * a  # half breadth of the rib cage, narrower than the shoulders
        r = 0.90 * b
        for side, s in SIDES.items():
            y = s * (chest - r)
            self._capsule(
                trunk, f"{side}_ribcage", (0, y, 0.32 * length), (0, y, 0.58 * length), r, SHIRT
            )
            self._capsule(
                trunk,
                f"{side}_belly",
                (0, 0.75 * y, 0.03 * length),
                (0, 0.75 * y, 0.30 * length),
                0.86 * b,
                SHIRT,
            )
            self._capsule(
                trunk,
                f"{side}_shoulder_girdle",
                (-0.01, s * 0.012, 0.93 * length),
                (0.0, s * 0.74 * sy, sz + 0.010),
                0.047,
                SHIRT,
            )
            top = f"{side}_shoulder.top"
            self._landmark(top, trunk, (0, s * 0.62 * sy, sz), (0.30, 0.0, 1.0))
            self._landmark(
                f"{side}_ribs", trunk, (0, s * (chest - r), 0.39 * length), (1.3, s, 0.0)
            )
            # Front of the iliac crest, at the belt: where a hand comes to lie from across the body.
            belt = (0, 0.75 * y, 0.08 * length)
            self._landmark(f"{side}_hip.front", trunk, belt, (1.0, 0.30 * s, 0.0))
        self._capsule(trunk, "sternum", (0, 0, 0.30 * length), (0, 0, 0.56 * length), b, SHIRT)
        upper = 0.40 * chest
        self._capsule(
            trunk,
            "upper_chest",
            (0, -upper, 0.74 * length),
            (0, upper, 0.74 * length),
            0.068,
            SHIRT,
        )
        self._capsule(
            trunk, "neck_base", (-0.005, 0, 0.88 * length), (0, 0, 1.02 * length), 0.050, SKIN
        )
        self._landmark("chest.front", trunk, (0, 0, 0.62 * length), (1, 0, 0))
        self._landmark("belly.front", trunk, (0, 0, 0.15 * length), (1, 0, 0))
        return trunk

    def _head(self, trunk: Any) -> None:
        segment, length = self.person.head, self.person.head.length
        # A head that is large for its body, as a child's, is mostly skull.
        k = length / MALE.head.length
        f = k**0.5
        head = trunk.add_body(name="head", pos=[0.0, 0.0, self.person.waist_length])
        self._joints(head, ("neck_z", "neck_x", "neck_y"))
        _inertial(head, segment.mass, (0.005 * k, 0, length - segment.com), segment.inertia)
        r = 0.325 * length
        crown = length - r
        self._capsule(head, "cranium", (-0.018 * k, 0, crown), (0.022 * k, 0, crown), r, SKIN)
        mouth = (0.050 * k, 0, 0.34 * length)
        self._capsule(head, "face", (0.040 * k, 0, crown - 0.02 * k), mouth, 0.052 * f, SKIN)
        throat = (-0.005 * k, 0, 0.02 * k)
        self._capsule(head, "neck", throat, (0.0, 0, 0.40 * length), 0.047 * f, SKIN)
        for name, pos, size, color in (
            ("nose", (0.050 * k + 0.054 * f, 0, 0.53 * length), 0.013, SKIN),
            ("right_eye", (EYES[0] * length, -0.026 * k, EYES[2] * length), 0.010, DARK),
            ("left_eye", (EYES[0] * length, 0.026 * k, EYES[2] * length), 0.010, DARK),
        ):
            self._ornament(head, name, pos, size * k, color)
        centre = (-0.005 * k, 0.0, crown)
        for name, direction in (
            ("head.back", (-1, 0, 0.1)),
            ("head.back_right", (-1, -0.48, -0.42)),
            ("head.back_left", (-1, 0.48, 0.34)),
            ("head.top", (0, 0, 1)),
            ("head.right", (0, -1, 0)),
            ("head.left", (0, 1, 0)),
            ("head.front", (1, 0, 0.35)),
        ):
            self._landmark(name, head, centre, direction)

    def _arm(self, trunk: Any, side: str) -> None:
        person, s = self.person, SIDES[side]
        ua, fa, ha = person.upper_arm, person.forearm, person.hand
        upper = trunk.add_body(
            name=f"{side}_upper_arm",
            pos=[self.shoulder[0], s * self.shoulder[1], self.shoulder[2]],
        )
        self._joints(upper, (f"{side}_shoulder_y", f"{side}_shoulder_x", f"{side}_shoulder_z"))
        _hanging(upper, ua)
        r = ua.radius
        middle = 0.45 * ua.length
        self._capsule(upper, f"{side}_deltoid", (0, 0, 0), (0, 0, -middle), 1.06 * r, SHIRT)
        self._capsule(
            upper, f"{side}_upper_arm", (0, 0, -middle), (0, 0, -ua.length), 0.95 * r, SKIN
        )
        # Half a hand's length above the crook: there a hand has room when the elbow is bent, too.
        self._landmark(f"{side}_elbow.inside", upper, (0, 0, -0.70 * ua.length), (1, 0, 0))

        forearm = upper.add_body(name=f"{side}_forearm", pos=[0.0, 0.0, -ua.length])
        self._joints(forearm, (f"{side}_elbow",))
        _hanging(forearm, fa)
        r = fa.radius
        self._capsule(
            forearm, f"{side}_forearm", (0, 0, 0), (0, 0, -0.5 * fa.length), 1.05 * r, SKIN
        )
        self._capsule(
            forearm,
            f"{side}_lower_forearm",
            (0, 0, -0.5 * fa.length),
            (0, 0, -fa.length),
            0.85 * r,
            SKIN,
        )

        hand = forearm.add_body(name=f"{side}_hand", pos=[0.0, 0.0, -fa.length])
        self._joints(hand, (f"{side}_wrist_z", f"{side}_wrist_x", f"{side}_wrist_y"))
        _hanging(hand, ha)
        half = 0.070 * ha.length  # half thickness of palm and fingers
        for finger, aside, tip in (
            ("index", 0.150, 0.90),
            ("middle", 0.0, 1.0),
            ("little", -0.150, 0.86),
        ):
            x = aside * ha.length
            self._capsule(
                hand,
                f"{side}_{finger}",
                (0.75 * x, 0, -0.10 * ha.length),
                (x, 0, -tip * ha.length + half),
                half,
                SKIN,
            )
        self._capsule(
            hand,
            f"{side}_thumb",
            (0.10 * ha.length, 0, -0.15 * ha.length),
            (0.27 * ha.length, -s * 0.03 * ha.length, -0.42 * ha.length),
            0.9 * half,
            SKIN,
        )
        # Palm frame: x out of the palm (towards the thigh), z to the fingertips (down).
        rotation = np.array([[0, s, 0], [-s, 0, 0], [0, 0, -1.0]])
        rotation[:, 1] = np.cross(rotation[:, 2], rotation[:, 0])
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, rotation.ravel())
        hand.add_site(
            name=f"{side}_palm",
            pos=[0.0, -s * half, -PALM * ha.length],
            quat=quat,
            size=[0.006, 0.006, 0.006],
            group=4,
        )

    def _collisions(self) -> None:
        """Which links may collide: every pair, but for neighbours that overlap by design.

        MuJoCo leaves out parent and child; the elbow half of the upper arm is put back
        against the rib cage, so that no elbow swings through the chest.
        """
        spec = self.spec
        spec.add_exclude(bodyname1="pelvis", bodyname2="trunk")
        for side in SIDES:
            spec.add_exclude(bodyname1="head", bodyname2=f"{side}_upper_arm")
            spec.add_exclude(bodyname1=f"{side}_upper_arm", bodyname2=f"{side}_hand")
            for part in ("right_ribcage", "left_ribcage", "sternum", "right_belly", "left_belly"):
                self._pair(f"{side}_upper_arm", part)
            for part in ("cranium", "face"):
                self._pair(f"{side}_upper_arm", part)

    # --- the pieces ------------------------------------------------------------------

    def _pair(self, one: str, other: str) -> None:
        if self.contacts:
            self.spec.add_pair(
                geomname1=one,
                geomname2=other,
                condim=3,
                solref=SOFTNESS,
                friction=[FRICTION] * 2 + [0.005, 0.0001, 0.0001],
            )

    def _capsule(
        self, link: Any, name: str, start: Vector, end: Vector, radius: float, rgba: Any
    ) -> None:
        link.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=[*start, *end],
            size=[radius, 0, 0],
            rgba=list(rgba),
            condim=3,
            friction=[FRICTION, 0.005, 0.0001],
            solref=SOFTNESS,
            mass=0.0,
        )

    def _ornament(self, link: Any, name: str, pos: Vector, radius: float, rgba: Any) -> None:
        link.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            pos=list(pos),
            size=[radius, 0, 0],
            rgba=list(rgba),
            contype=0,
            conaffinity=0,
            mass=0.0,
        )

    def _landmark(self, name: str, link: Any, origin: Vector, direction: Vector) -> None:
        self.rays.append(Ray(name, link.name, np.array(origin), np.array(direction, dtype=float)))

    def _joints(self, link: Any, names: tuple[str, ...]) -> None:
        for name in names:
            side, _, plain = name.partition("_")
            kind, s = (plain, SIDES[side]) if side in SIDES else (name, 1.0)
            (low, high), torque, armature, damping = JOINTS[kind]
            link.add_joint(
                name=name,
                type=mujoco.mjtJoint.mjJNT_HINGE,
                axis=list(joint_axis(kind, s)),
                limited=self.limits,
                range=[np.deg2rad(low), np.deg2rad(high)],
                actfrclimited=True,
                actfrcrange=[-torque, torque],
                armature=armature,
                damping=[damping, 0.0, 0.0],
                solref_limit=[0.02, 1.0],
            )


def _inertial(link: Any, mass: float, com: Vector, inertia: tuple[float, float, float]) -> None:
    link.explicitinertial = True
    link.mass, link.ipos, link.inertia = mass, list(com), list(inertia)


def _hanging(link: Any, segment: Segment) -> None:
    """Inertia of a segment that hangs down from its joint."""
    _inertial(link, segment.mass, (0.0, 0.0, -segment.com), segment.inertia)

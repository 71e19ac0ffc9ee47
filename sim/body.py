"""A body: a MuJoCo model together with the anatomical names of its parts.

Nothing above this floor knows a joint, link or site of a particular model. It asks the
body, which answers with indices, points and angles, or raises a `BodyError` that lists
what there is.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body_map import BodyMap, Limb, Servo
from sim.errors import BeyondRange, BodyError, unknown

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

_ONE_DOF = (mujoco.mjtJoint.mjJNT_HINGE.value, mujoco.mjtJoint.mjJNT_SLIDE.value)

ROUNDING = 1e-5  # [rad] of the ranges of joints: the model's XML has six digits
# Directions in the frame of the body: X forward, Y left, Z up.
DIRECTIONS: dict[str, tuple[float, float, float]] = {
    "forward": (1.0, 0.0, 0.0),
    "back": (-1.0, 0.0, 0.0),
    "left": (0.0, 1.0, 0.0),
    "right": (0.0, -1.0, 0.0),
    "up": (0.0, 0.0, 1.0),
    "down": (0.0, 0.0, -1.0),
}


@dataclass(frozen=True)
class Spot:
    """A point fixed to a link, with one direction: a landmark and its outward normal."""

    link: int
    point: FloatArray  # (3,) in the frame of the link [m]
    normal: FloatArray  # (3,) unit, in the frame of the link


@dataclass(frozen=True)
class Arm:
    """A limb of the body map, as indices into the model."""

    name: str
    limb: Limb
    dofs: IntArray  # (j,) from the trunk outwards
    shoulder_dofs: IntArray
    root: int  # the link that carries the limb
    upper_arm: int  # link at the shoulder
    forearm: int  # link at the elbow
    hand: int  # link at the wrist
    links: frozenset[int]  # all from the root, which is not among them, to the hand
    palm: Spot  # centre of the palm and its normal
    fingers: FloatArray  # (3,) unit, from the wrist to the fingertips, in the hand's frame


@dataclass(frozen=True)
class Capsules:
    """The colliding geoms of the body as segments with a radius; a sphere is a short one."""

    geom: IntArray  # (c,) geom ids
    link: IntArray  # (c,)
    start: FloatArray  # (c, 3) in the frame of the link [m]
    end: FloatArray  # (c, 3)
    radius: FloatArray  # (c,) [m]


class Body:
    """A MuJoCo model and its body map.

    Args:
        spec: the model; joints that are moved must have a motor each.
        names: what its parts are called.

    Raises:
        BodyError: the map names something that the model does not have.
    """

    def __init__(self, spec: mujoco.MjSpec, names: BodyMap) -> None:
        self.spec = spec
        spec.compile()
        self.xml: str = spec.to_xml()  # what is recorded is exactly what is run
        self.model = mujoco.MjModel.from_xml_string(self.xml)
        self.map = names
        model = self.model
        self.nv: int = model.nv
        self.timestep: float = model.opt.timestep
        movable = [j for j in range(model.njnt) if model.jnt_type[j] in _ONE_DOF]
        self._joint_ids: Mapping[str, int] = {model.joint(j).name: j for j in movable}
        hinges = self._joint_ids
        self._dof_names = {int(model.jnt_dofadr[j]): name for name, j in hinges.items()}
        self.qpos_of_dof: IntArray = np.full(model.nv, -1, dtype=np.int32)
        for j in hinges.values():
            self.qpos_of_dof[model.jnt_dofadr[j]] = model.jnt_qposadr[j]
        self._check()

    # --- names to indices --------------------------------------------------------------

    def joints(self, names: str | Iterable[str]) -> IntArray:
        """Dof indices of joints, joint groups or limbs, in the order given, without doubles.

        `all` means every joint.
        """
        asked = [names] if isinstance(names, str) else list(names)
        found: list[str] = []
        for name in asked:
            if name == "all":
                found += self._joint_ids
            elif name in self.map.limbs:
                found += self.map.limbs[name].joints
            elif name in self.map.groups:
                found += self.map.groups[name]
            else:
                found.append(name)
        for name in found:
            if name not in self._joint_ids:
                known = ["all", *self.map.limbs, *self.map.groups, *self._joint_ids]
                raise BodyError(unknown("joint or joint group", name, known))
        dofs = [int(self.model.jnt_dofadr[self._joint_ids[n]]) for n in dict.fromkeys(found)]
        return np.array(dofs, dtype=np.int32)

    def dof_name(self, dof: int) -> str:
        """Name of the joint that owns a degree of freedom."""
        return str(self._dof_names.get(dof, f"dof {dof}"))

    def arm(self, name: str) -> Arm:
        """The limb called `name`, as indices."""
        if name not in self.map.limbs:
            raise BodyError(unknown("limb", name, self.map.limbs))
        limb = self.map.limbs[name]
        upper = self.link(limb.upper_arm)
        site = self._site(limb.palm)
        axes = _matrix(self.model.site_quat[site])
        dofs = self.joints(name)
        root = int(self.model.body_parentid[self.model.dof_bodyid[dofs[0]]])
        links, hand = [], self.link(limb.hand)
        while hand not in (root, 0):
            links.append(hand)
            hand = int(self.model.body_parentid[hand])
        return Arm(
            name=name,
            limb=limb,
            dofs=dofs,
            shoulder_dofs=self.joints(limb.shoulder),
            root=root,
            upper_arm=upper,
            forearm=self.link(limb.forearm),
            hand=self.link(limb.hand),
            links=frozenset(links),
            palm=Spot(self.link(limb.hand), self.model.site_pos[site].copy(), axes[:, 0]),
            fingers=axes[:, 2],
        )

    def landmark(self, name: str) -> Spot:
        """The landmark called `name`: the link it is on, the point and its outward normal."""
        if name not in self.map.landmarks:
            raise BodyError(unknown("landmark", name, self.map.landmarks))
        site = self._site(name)
        normal = _matrix(self.model.site_quat[site])[:, 0]
        return Spot(int(self.model.site_bodyid[site]), self.model.site_pos[site].copy(), normal)

    def direction(self, given: str | tuple[float, float, float]) -> FloatArray:
        """Unit vector (3,) of a direction word or a vector, in the frame of the body."""
        if isinstance(given, str):
            if given not in DIRECTIONS:
                raise BodyError(unknown("direction", given, DIRECTIONS))
            return np.array(DIRECTIONS[given])
        vector = np.array(given, dtype=float)
        length = float(np.linalg.norm(vector))
        if not np.isfinite(length) or length < 1e-9:
            raise BodyError(f"direction {given} has no length; expected a vector such as [1, 0, 0]")
        return vector / length

    def link(self, name: str) -> int:
        """Index of the link (MuJoCo body) called `name`."""
        index = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, name)
        if index < 0:
            links = [self.model.body(b).name for b in range(1, self.model.nbody)]
            raise BodyError(unknown("link", name, links))
        return int(index)

    def servo(self, dof: int) -> Servo:
        """The gains with which the body map servoes a joint."""
        name = self.dof_name(dof)
        if name not in self.map.servos:
            raise BodyError(f"the body map of {self.map.name!r} has no servo gains for {name!r}")
        return self.map.servos[name]

    # --- angles and limits -------------------------------------------------------------

    def angles(self, posture: Mapping[str, float]) -> FloatArray:
        """Joint angles (nv,) [rad] of a posture {joint: degrees}; NaN where it says nothing."""
        q = np.full(self.nv, np.nan)
        for name, degrees in posture.items():
            q[self.joints(name)] = np.deg2rad(degrees)
        low, high = self.range
        outside = np.flatnonzero((q < low - ROUNDING) | (q > high + ROUNDING))
        if outside.size:
            j = int(outside[0])
            raise BeyondRange(
                f"{self.dof_name(j)} cannot be {np.rad2deg(q[j]):.0f} degrees"
                f" (it moves from {np.rad2deg(low[j]):.0f} to {np.rad2deg(high[j]):.0f})"
            )
        return q

    def posture(self, name: str) -> FloatArray:
        """A named posture of the body map as angles (nv,) [rad]; NaN where it says nothing."""
        if name not in self.map.postures:
            raise BodyError(unknown("posture", name, self.map.postures))
        return self.angles(self.map.postures[name])

    @cached_property
    def range(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper joint limits, (nv,) each [rad]; infinite where there is none."""
        low, high = np.full(self.nv, -np.inf), np.full(self.nv, np.inf)
        for j in self._joint_ids.values():
            if self.model.jnt_limited[j]:
                dof = self.model.jnt_dofadr[j]
                low[dof], high[dof] = self.model.jnt_range[j]
        return low, high

    @cached_property
    def torque_limit(self) -> FloatArray:
        """Largest torque of each joint's motor, (nv,) [N m]; 0 where there is no motor."""
        limit: FloatArray = np.zeros(self.nv)
        for dof, motor in zip(self.motor_dofs, range(self.model.nu), strict=True):
            low, high = self.model.actuator_ctrlrange[motor]
            limited = self.model.actuator_ctrllimited[motor]
            limit[dof] = min(-low, high) if limited else np.inf
        return limit

    @cached_property
    def speed_limit(self) -> FloatArray:
        """Largest speed of each joint by the body map, (nv,) [rad/s]; infinite without one."""
        limit: FloatArray = np.full(self.nv, np.inf)
        for name, degrees in self.map.speed_limits.items():
            limit[self.joints(name)] = np.deg2rad(degrees)
        return limit

    @cached_property
    def motor_dofs(self) -> IntArray:
        """The degree of freedom that each motor drives, (nu,)."""
        dofs: IntArray = self.model.jnt_dofadr[self.model.actuator_trnid[:, 0]].astype(np.int32)
        return dofs

    @cached_property
    def home(self) -> FloatArray:
        """The posture (nq,) in which a simulation starts."""
        q: FloatArray = self.model.qpos0.copy()
        angles = self.posture(self.map.home)
        given = ~np.isnan(angles)
        q[self.qpos_of_dof[given]] = angles[given]
        return q

    @cached_property
    def gravity(self) -> FloatArray:
        """Gravity (3,) [m/s^2]."""
        return np.array(self.model.opt.gravity)

    def to_link(self, link: int, vector: FloatArray) -> FloatArray:
        """A vector (3,) of the body's frame in the frame that a link has in the home posture."""
        axes: FloatArray = self._at_home.xmat[link].reshape(3, 3)
        return axes.T @ vector

    def from_link(self, link: int, vector: FloatArray) -> FloatArray:
        """A vector (3,) of a link's frame in the body's frame, the link being at home."""
        axes: FloatArray = self._at_home.xmat[link].reshape(3, 3)
        return axes @ vector

    def at_home(self, link: int, point: FloatArray) -> FloatArray:
        """Where a point (3,) of a link is in the home posture, in the world [m]."""
        axes: FloatArray = self._at_home.xmat[link].reshape(3, 3)
        where: FloatArray = self._at_home.xpos[link] + axes @ point
        return where

    def upper_arm_at_home(self, arm: Arm) -> FloatArray:
        """Unit vector (3,) from shoulder to elbow in the home posture."""
        along = self._at_home.xpos[arm.forearm] - self._at_home.xpos[arm.upper_arm]
        unit: FloatArray = along / np.linalg.norm(along)
        return unit

    def palm_at_home(self, arm: Arm) -> FloatArray:
        """Normal of the palm (3,) in the home posture, in the frame of the forearm."""
        forearm, hand = (self._at_home.xmat[k].reshape(3, 3) for k in (arm.forearm, arm.hand))
        normal: FloatArray = forearm.T @ hand @ arm.palm.normal
        return normal

    def palm_goal(self, arm: Arm, angles: FloatArray) -> tuple[FloatArray, ...]:
        """How joint angles (nv,) [rad], NaN for home, hold an arm.

        Returns:
            (3,) each, in the frame of the link that carries the arm: the palm's place [m], and
            the directions of its normal, of the fingers and of the upper arm.
        """
        data, given = mujoco.MjData(self.model), ~np.isnan(angles)
        data.qpos[:] = self.home
        data.qpos[self.qpos_of_dof[given]] = angles[given]
        mujoco.mj_kinematics(self.model, data)
        root, hand = (data.xmat[link].reshape(3, 3) for link in (arm.root, arm.hand))
        palm = data.xpos[arm.hand] + hand @ arm.palm.point
        along = data.xpos[arm.forearm] - data.xpos[arm.upper_arm]
        turned = (hand @ arm.palm.normal, hand @ arm.fingers, along / np.linalg.norm(along))
        return root.T @ (palm - data.xpos[arm.root]), *(root.T @ v for v in turned)

    def geoms_to_keep_apart(
        self, arm: Arm, touched: int = -1, *, limbs: bool = False
    ) -> list[tuple[list[int], list[int]]]:
        """Pairs of groups of geoms: the arm's links and those that they must not touch.

        Args:
            arm: the arm.
            touched: a link that the hand may touch.
            limbs: whether pairs with other limbs are among them.
        """
        own = set(arm.links)
        others = {link for name in self.map.limbs for link in self.arm(name).links}
        left_out = own if limbs else others
        found = []
        for names in self.map.keep_apart:
            one, other = sorted((self.link(n) for n in names), key=lambda b: b not in own)
            if one not in own or other in left_out or (one == arm.hand and other == touched):
                continue
            mine, theirs = (self.colliding(link) for link in (one, other))
            if mine and theirs:
                found.append((mine, theirs))
        return found

    def reach(self, arm: Arm) -> float:
        """Distance from the shoulder to the palm of the arm held straight [m]."""
        joints = [self._at_home.xpos[link] for link in (arm.upper_arm, arm.forearm, arm.hand)]
        lengths = [np.linalg.norm(b - a) for a, b in pairwise(joints)]
        return float(sum(lengths) + np.linalg.norm(arm.palm.point))

    @cached_property
    def _at_home(self) -> mujoco.MjData:
        data = mujoco.MjData(self.model)
        data.qpos[:] = self.home
        mujoco.mj_kinematics(self.model, data)
        return data

    @cached_property
    def objects(self) -> IntArray:
        """The links that no joint moves but somebody may carry, (m,), as MuJoCo counts them."""
        found: IntArray = np.flatnonzero(self.model.body_mocapid >= 0).astype(np.int32)
        return found

    @cached_property
    def ancestors(self) -> NDArray[np.bool_]:
        """Whether a degree of freedom moves a link, (nbody, nv)."""
        moves = np.zeros((self.model.nbody, self.nv), dtype=bool)
        for link in range(1, self.model.nbody):
            moves[link] = moves[self.model.body_parentid[link]]
            first = self.model.body_dofadr[link]
            moves[link, first : first + self.model.body_dofnum[link]] = True
        return moves

    def capsules(self, links: Iterable[str]) -> Capsules:
        """The colliding geoms of some links, sorted by link.

        Raises:
            BodyError: one of them is neither a sphere nor a capsule.
        """
        model = self.model
        wanted = sorted({self.link(name) for name in links})
        ids, start, end = [], [], []
        for g in (g for link in wanted for g in self.colliding(link)):
            kind = model.geom_type[g]
            if kind == mujoco.mjtGeom.mjGEOM_CAPSULE.value:
                half = _matrix(model.geom_quat[g])[:, 2] * model.geom_size[g, 1]
            elif kind == mujoco.mjtGeom.mjGEOM_SPHERE.value:
                half = np.zeros(3)
            else:
                shape = mujoco.mjtGeom(kind).name.removeprefix("mjGEOM_").lower()
                raise BodyError(
                    f"geom {model.geom(g).name!r} is a {shape}; distances are kept between"
                    " spheres and capsules: draw the links in keep_apart with those"
                )
            ids.append(g)
            start.append(model.geom_pos[g] - half)
            end.append(model.geom_pos[g] + half)
        geom = np.array(ids, dtype=np.int32)
        return Capsules(
            geom=geom,
            link=model.geom_bodyid[geom].astype(np.int32),
            start=np.array(start).reshape(-1, 3),
            end=np.array(end).reshape(-1, 3),
            radius=model.geom_size[geom, 0].copy(),
        )

    def is_free(self, qpos: FloatArray) -> bool:
        """Whether no two geoms that can collide touch in a posture (nq,)."""
        data = mujoco.MjData(self.model)
        data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_collision(self.model, data)
        return bool(data.ncon == 0)

    def colliding(self, link: int) -> list[int]:
        """The geoms of a link that can collide."""
        of_link = np.flatnonzero(self.model.geom_bodyid == link)
        return [int(g) for g in of_link if self.model.geom_contype[g]]

    # --- inside --------------------------------------------------------------------------

    def _site(self, name: str) -> int:
        index = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, name)
        if index < 0:
            raise BodyError(f"the body map of {self.map.name!r} needs a site {name!r} in the model")
        return int(index)

    def _check(self) -> None:
        """Resolve every name of the map once, so that a wrong one is found now."""
        for motor in range(self.model.nu):
            kind, gain = self.model.actuator_trntype[motor], self.model.actuator_gainprm[motor, 0]
            plain = self.model.actuator_biastype[motor] == mujoco.mjtBias.mjBIAS_NONE.value
            if kind != mujoco.mjtTrn.mjTRN_JOINT.value or gain != 1.0 or not plain:
                name = self.model.actuator(motor).name
                raise BodyError(f"actuator {name!r} is not a torque motor with gain 1 on a joint")
        for limb in self.map.limbs:
            self.arm(limb)
        for group in self.map.groups:
            self.joints(group)
        if self.map.head is not None:
            self.link(self.map.head.link)
            self.joints(self.map.head.joints)
            self.direction(self.map.head.forward)
        for landmark in self.map.landmarks:
            self.landmark(landmark)
        for posture in self.map.postures:
            self.posture(posture)
        for name in self.map.speed_limits:
            self.joints(name)
        for pair in self.map.keep_apart:
            for name in pair:
                self.link(name)
        for name in self.map.objects:
            self.link(name)


def _matrix(quat: FloatArray) -> FloatArray:
    """Rotation matrix (3, 3) of a quaternion (wxyz)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quat)
    return matrix.reshape(3, 3)

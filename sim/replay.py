"""Replay: what a recording looks like to MuJoCo, and to nobody else.

Every figure here comes from the recorded joint angles and the recorded model by MuJoCo's
own kinematics and collision detection. Nothing is shared with the controllers.
"""

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Spot
from sim.errors import unknown
from sim.recording import Recording

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Poses:
    """Where something was, row by row."""

    position: FloatArray  # (T, 3) [m]
    axes: FloatArray  # (T, 3, 3) its axes as columns


@dataclass(frozen=True)
class Closest:
    """The closest two geoms came, or the deepest they went into each other."""

    distance: float  # [m]; negative is penetration
    time: float  # [s]
    geoms: tuple[str, str]


@lru_cache(maxsize=4)
def _compiled(xml: str) -> mujoco.MjModel:
    """A recorded model; nobody may change it."""
    model = mujoco.MjModel.from_xml_string(xml)
    # Bodies that were allowed to pass through each other are still seen to do it.
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return model


def _limits(model: mujoco.MjModel) -> FloatArray:
    """Largest torque of each joint's motor (nv,) [N m]; NaN where there is no motor."""
    limits = np.full(model.nv, np.nan)
    for motor in range(model.nu):
        dof = model.jnt_dofadr[model.actuator_trnid[motor, 0]]
        limits[dof] = np.abs(model.actuator_ctrlrange[motor]).min()
    return limits


class Replay:
    """Geometry of a recording.

    Args:
        recording: what is played back.
    """

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self._first_rows = [row for row, _ in recording.models]
        self._models = [_compiled(xml) for _, xml in recording.models]
        self.model = self._now = self._models[0]
        self._data = mujoco.MjData(self.model)
        count = len(recording.time)
        sites, links = self.model.nsite, self.model.nbody
        self._site = np.zeros((count, sites, 3)), np.zeros((count, sites, 9))
        self._link = np.zeros((count, links, 3)), np.zeros((count, links, 9))
        self.penetration = Closest(0.0, 0.0, ("", ""))
        self._play()

    def site(self, name: str) -> Poses:
        """Poses of a site: a palm or a landmark."""
        index = self._id(mujoco.mjtObj.mjOBJ_SITE, "site", name)
        return Poses(self._site[0][:, index], self._site[1][:, index].reshape(-1, 3, 3))

    def link(self, name: str) -> Poses:
        """Poses of a link."""
        index = self._id(mujoco.mjtObj.mjOBJ_BODY, "link", name)
        return Poses(self._link[0][:, index], self._link[1][:, index].reshape(-1, 3, 3))

    def turned(self, name: str, home: Mapping[str, float]) -> Poses:
        """Poses of a link; its axes are those that are forward, left and up at home.

        Args:
            name: of the link.
            home: angles of joints [deg]; the others are as the model has them.
        """
        self._data.qpos[:] = self.model.qpos0
        for joint, angle in home.items():
            index = self._id(mujoco.mjtObj.mjOBJ_JOINT, "joint", joint)
            self._data.qpos[self.model.jnt_qposadr[index]] = np.deg2rad(angle)
        mujoco.mj_kinematics(self.model, self._data)
        index, now = self._id(mujoco.mjtObj.mjOBJ_BODY, "link", name), self.link(name)
        return Poses(now.position, now.axes @ self._data.xmat[index].reshape(3, 3).T)

    def point(self, spot: Spot) -> FloatArray:
        """Where a point that is fixed to a link was (T, 3) [m]."""
        place, axes = self._link[0][:, spot.link], self._link[1][:, spot.link].reshape(-1, 3, 3)
        where: FloatArray = place + axes @ spot.point
        return where

    def hand_force(self, site: str, rows: slice) -> FloatArray:
        """The force at a site that the recorded torques amount to, gravity apart (k, 3) [N].

        F = (J M^-1 J^T)^-1 J M^-1 (tau - g), the dynamically consistent one (Khatib 1987).
        """
        index = self._id(mujoco.mjtObj.mjOBJ_SITE, "site", site)
        data, nv = self._data, self.model.nv
        jacobian, mass = np.zeros((3, nv)), np.zeros((nv, nv))
        forces = np.zeros((len(range(*rows.indices(len(self.recording.time)))), 3))
        for k, row in enumerate(range(*rows.indices(len(self.recording.time)))):
            self._rest(row)  # at rest the bias is gravity alone
            mujoco.mj_jacSite(self._now, data, jacobian, None, index)
            mujoco.mj_fullM(self._now, data, mass)
            driven = self.recording.torque[row] - data.qfrc_bias
            solved = np.linalg.solve(mass, np.column_stack([jacobian.T, driven]))
            forces[k] = np.linalg.solve(jacobian @ solved[:, :3], jacobian @ solved[:, 3])
        return forces

    def weight(self) -> FloatArray:
        """Torques that would hold the body up against its weight, row by row (T, nv) [N m]."""
        held = np.zeros_like(self.recording.qvel)
        for row in range(len(held)):
            self._rest(row)
            held[row] = self._data.qfrc_bias  # at rest the bias is gravity alone
        return held

    def mobility(self, row: int) -> FloatArray:
        """Inverse of the inertia matrix in one row (nv, nv): acceleration for each torque."""
        mass = np.zeros((self.model.nv, self.model.nv))
        self._rest(row)
        mujoco.mj_fullM(self._now, self._data, mass)
        inverse: FloatArray = np.linalg.inv(mass)
        return inverse

    def angle(self, joint: str) -> FloatArray:
        """Angle of a hinge (T,) [rad]."""
        index = self._id(mujoco.mjtObj.mjOBJ_JOINT, "joint", joint)
        angles: FloatArray = self.recording.qpos[:, self.model.jnt_qposadr[index]]
        return angles

    def link_of_site(self, name: str) -> str:
        """Name of the link that a site is on."""
        index = self._id(mujoco.mjtObj.mjOBJ_SITE, "site", name)
        return str(self.model.body(self.model.site_bodyid[index]).name)

    def dof(self, joint: str) -> int:
        """Degree of freedom of a joint."""
        index = self._id(mujoco.mjtObj.mjOBJ_JOINT, "joint", joint)
        return int(self.model.jnt_dofadr[index])

    def has_joint(self, name: str) -> bool:
        """Whether the model has a joint of that name."""
        return bool(mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name) >= 0)

    def moves(self, joint: str, site: str) -> bool:
        """Whether a joint moves the link that a site is on."""
        moved = self.model.jnt_bodyid[self._id(mujoco.mjtObj.mjOBJ_JOINT, "joint", joint)]
        link = self.model.site_bodyid[self._id(mujoco.mjtObj.mjOBJ_SITE, "site", site)]
        while link and link != moved:
            link = self.model.body_parentid[link]
        return bool(link == moved)

    def joint_of_dof(self, dof: int) -> str:
        """Name of the joint that owns a degree of freedom."""
        return str(self.model.joint(self.model.dof_jntid[dof]).name)

    def torque_limits(self) -> FloatArray:
        """Largest torque of each joint's motor (nv,) [N m]; NaN where there is no motor.

        Of a body that became others the smallest that it had.
        """
        limits: FloatArray = np.min([_limits(model) for model in self._models], axis=0)
        return limits

    def torque_share(self) -> FloatArray:
        """Torques as shares of the limits of the motors in that row (T, nv); NaN as above."""
        limits = np.array([_limits(model) for model in self._models])
        which = np.searchsorted(self._first_rows, np.arange(len(self.recording.time)), "right") - 1
        share: FloatArray = self.recording.torque / limits[which]
        return share

    def changes(self, sites: Iterable[str]) -> tuple[FloatArray, FloatArray]:
        """What each step did by which the body became another, angles and velocities being kept.

        Args:
            sites: whose places are compared.

        Returns:
            (changes,) each: kinetic energy that came or went [J], and by how far the site that
            moved most was moved [m].
        """
        ids = [self._id(mujoco.mjtObj.mjOBJ_SITE, "site", name) for name in sites]
        kinetic, moved = [], []
        for k, row in enumerate(self._first_rows[1:]):
            if row < len(self.recording.time):
                before, after = (self._stood(self._models[i], row, ids) for i in (k, k + 1))
                kinetic.append(after[0] - before[0])
                apart = np.linalg.norm(after[1] - before[1], axis=1)
                moved.append(float(apart.max(initial=0.0)))
        return np.array(kinetic), np.array(moved)

    def clearance(
        self, pairs: Iterable[tuple[str, str]], *, every: int = 5, within: float = 0.1
    ) -> Closest:
        """Smallest distance between links that must not touch.

        Args:
            pairs: of links.
            every: rows from one look to the next.
            within: distances beyond this are not measured [m].
        """
        couples = [
            (a, b) for one, other in pairs for a in self._geoms(one) for b in self._geoms(other)
        ]
        best = Closest(within, 0.0, ("", ""))
        for k in range(0, len(self.recording.time), every):
            self._set(k)
            for a, b in couples:
                distance = mujoco.mj_geomDistance(self._now, self._data, a, b, best.distance, None)
                if distance < best.distance:
                    names = self.model.geom(a).name, self.model.geom(b).name
                    best = Closest(float(distance), float(self.recording.time[k]), names)
        return best

    # --- inside --------------------------------------------------------------------------

    def _play(self) -> None:
        for k in range(len(self.recording.time)):
            self._set(k)
            data = self._data
            self._site[0][k], self._site[1][k] = data.site_xpos, data.site_xmat
            self._link[0][k], self._link[1][k] = data.xpos, data.xmat
            mujoco.mj_collision(self._now, data)
            if data.ncon:
                depths = data.contact.dist
                deepest = int(np.argmin(depths))
                if depths[deepest] < self.penetration.distance:
                    pair = data.contact.geom[deepest]
                    names = self.model.geom(pair[0]).name, self.model.geom(pair[1]).name
                    time = float(self.recording.time[k])
                    self.penetration = Closest(float(depths[deepest]), time, names)

    def _choose(self, k: int) -> None:
        """The model that was run in row k; room for the state of one is room for all."""
        self._now = self._models[bisect_right(self._first_rows, k) - 1]

    def _set(self, k: int) -> None:
        self._choose(k)
        self._place(k)
        mujoco.mj_kinematics(self._now, self._data)

    def _place(self, k: int) -> None:
        self._data.qpos[:] = self.recording.qpos[k]
        if self.model.nmocap:
            self._data.mocap_pos[:] = self.recording.objects[k]

    def _rest(self, k: int) -> None:
        """Row k, as if nothing moved."""
        self._choose(k)
        self._place(k)
        self._data.qvel[:] = 0.0
        mujoco.mj_fwdPosition(self._now, self._data)
        mujoco.mj_fwdVelocity(self._now, self._data)

    def _stood(
        self, model: mujoco.MjModel, k: int, sites: Sequence[int]
    ) -> tuple[float, FloatArray]:
        """Kinetic energy [J] and places of sites (k, 3) [m] of a model in the state of row k."""
        data = self._data
        data.qpos[:], data.qvel[:] = self.recording.qpos[k], self.recording.qvel[k]
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_energyVel(model, data)
        return float(data.energy[1]), data.site_xpos[list(sites)].copy()

    def _geoms(self, link: str) -> Sequence[int]:
        body = self._id(mujoco.mjtObj.mjOBJ_BODY, "link", link)
        own = (self.model.geom_bodyid == body) & (self.model.geom_contype > 0)
        return [int(g) for g in np.flatnonzero(own)]

    def _id(self, kind: mujoco.mjtObj, what: str, name: str) -> int:
        index = mujoco.mj_name2id(self.model, kind, name)
        if index < 0:
            raise KeyError(unknown(what, name, ()))
        return int(index)

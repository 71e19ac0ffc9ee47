"""What a body lacks for tasks, and what that costs: said before anybody finds out."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from sim import ArmWords, Body, BodyError, inverse_dynamics, load_body, pose

WHOLE = "adonis"  # the body that lacks nothing
SLOW = 2.0  # [rad/s] that a motor reaches against a joint's damping, with all its torque
HOLDING = 0.9  # of its limit: a motor that needs more to hold an arm out is too weak


@dataclass(frozen=True)
class Lack:
    """Something that a body lacks."""

    what: str
    cost: str


def lacks_of(body: Body) -> list[Lack]:
    """Everything that a body lacks, the worst first."""
    found = [*_arms(body), *_core(body), *_wrists(body), *_marks(body), *_strength(body)]
    return [*found, *_slow(body)]


def _arms(body: Body) -> list[Lack]:
    names = body.map
    if not names.limbs:
        return [Lack("no arm with shoulder, elbow, wrist and palm", "only get-posture of joints")]
    return [
        Lack(f"no {side} arm", f"sub-tasks of the {side} arm are refused")
        for side in ("right", "left")
        if f"{side}_arm" not in names.limbs
    ]


def _core(body: Body) -> list[Lack]:
    names, found = body.map, []
    joints = {joint for group in names.groups.values() for joint in group}
    for part, costs in (
        ("neck", "nods and shakes of the head are refused"),
        ("waist", "bows and sways are refused"),
    ):
        if not names.groups.get(part):
            found.append(Lack(f"no {part}", costs))
            continue
        lost = [f"{part}_{axis}" for axis in "zxy" if f"{part}_{axis}" not in joints]
        if lost:
            found.append(Lack(f"no {', '.join(lost)}", "postures and rhythms of them are refused"))
    if names.head is None:
        found.append(Lack("nothing that turns the head", "look-at is impossible"))
    elif "neck" not in names.head.joints:
        found.append(Lack("no neck to look with", "look-at turns the waist"))
    return found


def _wrists(body: Body) -> list[Lack]:
    found = []
    for name, limb in body.map.limbs.items():
        after = limb.joints[limb.joints.index(limb.elbow) + 1 :]
        if len(after) < 3:
            count = {0: "no joint", 1: "one joint", 2: "two joints"}[len(after)]
            said = f"{name}: {count} after the elbow"
            found.append(Lack(said, "a palm often cannot face what it touches"))
        if len(limb.shoulder) < 3:
            said = f"{name}: {len(limb.shoulder)} joints in the shoulder"
            found.append(
                Lack(said, "fewer places can be reached, and the elbow goes where it must")
            )
    return found


def _marks(body: Body) -> list[Lack]:
    if not body.map.limbs:
        return []
    missing = [name for name in load_body(WHOLE).map.landmarks if name not in body.map.landmarks]
    if not missing:
        return []
    return [Lack(f"no landmark {_some(missing)}", "sub-tasks that touch them are refused")]


def _strength(body: Body) -> list[Lack]:
    """Motors that cannot hold an arm straight forward."""
    found = []
    for name in body.map.limbs:
        arm = body.arm(name)
        try:
            held = pose(body, arm, ArmWords(body.direction("forward"), 0.0))
        except BodyError as problem:
            said = f"{name} cannot be held out straight"
            found.append(Lack(said, f"postures that ask for it are refused ({problem})"))
            continue
        angles = np.where(np.isnan(held), body.home[body.qpos_of_dof], held)
        still = np.zeros((1, body.nv))
        _, weight = inverse_dynamics(body, angles[None], still, still)
        short = [
            f"{body.dof_name(int(d))} ({abs(weight[0, d]):.2g} of {body.torque_limit[d]:.2g} N m)"
            for d in arm.dofs
            if abs(weight[0, d]) > HOLDING * body.torque_limit[d]
        ]
        if short:
            said = f"{name} is too weak to be held out: {_some(short)}"
            found.append(Lack(said, "it will sink"))
    return found


def _slow(body: Body) -> list[Lack]:
    """Motors that the damping of their own joints holds back."""
    fastest = body.torque_limit / np.maximum(body.model.dof_damping, 1e-9)
    found = []
    for name in body.map.limbs:
        slow = [int(dof) for dof in body.arm(name).dofs if fastest[dof] < SLOW]
        if slow:
            speeds = (f"{body.dof_name(d)} ({np.rad2deg(fastest[d]):.0f}°/s)" for d in slow)
            said = f"{name}: motors too weak for their joints' own damping: {_some(speeds)}"
            cost = "quick movements miss; if that is not so, mend `damping` in the body file"
            found.append(Lack(said, cost))
    return found


def _some(names: Iterable[str]) -> str:
    """The first few of some names."""
    known = list(names)
    return ", ".join(known[:4]) + (f" and {len(known) - 4} more" if known[4:] else "")

"""A two-joint arm in the horizontal plane, of the size of Adonis' right arm.

The system on which Mussa-Ivaldi (1997) showed that fields can be added up to a wanted
movement. Upper arm, and forearm and hand as one link, have the lengths, masses and moments of
`sim.anthropometry`; motors, armature and damping are those of Adonis' shoulder and elbow.
Both axes are vertical, so that gravity makes no torque. X is forward, Y left, as on Adonis:
at zero the arm points to the right, and flexion of both joints turns the hand to the left.
"""

from typing import Any

import mujoco
import numpy as np

from sim.adonis_character import JOINTS, SKIN
from sim.anthropometry import MALE, Anthropometry, Segment
from sim.body import Body
from sim.body_map import BodyMap, Servo
from sim.briskness import DAMPING_RATIO, FREQUENCY
from sim.physics import set_physics

RANGES = {"shoulder": (-40.0, 140.0), "elbow": (0.0, 150.0)}  # [deg]
LIKE = {"shoulder": "shoulder_y", "elbow": "elbow"}  # whose motor, armature and damping
HOME = {"shoulder": 45.0, "elbow": 90.0}  # [deg]


def planar_arm(person: Anthropometry = MALE, *, limits: bool = True, contacts: bool = True) -> Body:
    """Joints `shoulder` and `elbow`, group `arm`, links `upper_arm` and `forearm`, site `hand`.

    The hand is the tip of the second link.

    Args:
        person: segment masses, lengths and moments.
        limits: joint limits on.
        contacts: nothing of it collides, so this changes nothing; all bodies take it.
    """
    del contacts
    spec = mujoco.MjSpec()
    spec.modelname = "planar-arm"
    spec.compiler.degree = False
    set_physics(spec)
    outer = _joined(person.forearm, person.hand)
    upper = _link(spec.worldbody, "upper_arm", "shoulder", 0.0, person.upper_arm)
    forearm = _link(upper, "forearm", "elbow", person.upper_arm.length, outer)
    forearm.add_site(name="hand", pos=[0.0, -outer.length, 0.0], size=[0.01, 0.01, 0.01])
    for joint in spec.joints:
        joint.limited = limits
        spec.add_actuator(
            name=joint.name,
            target=joint.name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            ctrllimited=True,
            ctrlrange=[-joint.actfrcrange[1], joint.actfrcrange[1]],
        )
    return Body(
        spec,
        BodyMap(
            name="planar-arm",
            limbs={},
            groups={"arm": ("shoulder", "elbow")},
            postures={"rest": HOME},
            servos=_servos(spec.compile()),
        ),
    )


def _joined(near: Segment, far: Segment) -> Segment:
    """Two segments in line as one rigid one."""
    mass = near.mass + far.mass
    com = (near.mass * near.com + far.mass * (near.length + far.com)) / mass
    apart = near.length + far.com - near.com
    across = near.mass * far.mass / mass * apart**2
    moments = [a + b for a, b in zip(near.inertia, far.inertia, strict=True)]
    inertia = (moments[0] + across, moments[1] + across, moments[2])
    return Segment(mass, near.length + far.length, com, inertia)


def _link(parent: Any, name: str, joint: str, along: float, segment: Segment) -> Any:
    """A link on a vertical hinge, `along` [m] its parent, that points to the right at zero."""
    link = parent.add_body(name=name, pos=[0.0, -along, 0.0])
    _, torque, armature, damping = JOINTS[LIKE[joint]]
    link.add_joint(
        name=joint,
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=[0.0, 0.0, 1.0],
        limited=True,
        range=list(np.deg2rad(RANGES[joint])),
        actfrclimited=True,
        actfrcrange=[-torque, torque],
        armature=armature,
        damping=[damping, 0.0, 0.0],
    )
    link.explicitinertial = True
    link.mass, link.ipos = segment.mass, [0.0, -segment.com, 0.0]
    sagittal, transverse, longitudinal = segment.inertia
    link.inertia = [sagittal, longitudinal, transverse]
    link.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        fromto=[0.0, 0.0, 0.0, 0.0, -segment.length, 0.0],
        size=[segment.radius, 0.0, 0.0],
        rgba=SKIN,
        contype=0,
        conaffinity=0,
        mass=0.0,
    )
    return link


def _servos(model: mujoco.MjModel) -> dict[str, Servo]:
    """As Adonis': k = (2 pi f)^2 I, k_d = 2 zeta sqrt(k I), with the arm half bent."""
    data = mujoco.MjData(model)
    data.joint("elbow").qpos = np.deg2rad(HOME["elbow"])
    mujoco.mj_forward(model, data)
    mass = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    servos = {}
    for j, name in enumerate(RANGES):
        rate, inertia = 2.0 * np.pi * FREQUENCY[name], mass[j, j]
        servos[name] = Servo(
            stiffness=float(rate**2 * inertia), damping=float(2.0 * DAMPING_RATIO * rate * inertia)
        )
    return servos

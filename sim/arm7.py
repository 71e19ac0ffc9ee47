"""One arm on a pedestal: Adonis' right arm with its seven joints, and nothing else that moves."""

from sim.adonis_character import build_single_arm
from sim.anthropometry import MALE, Anthropometry
from sim.body import Body
from sim.body_map import BodyMap, Limb
from sim.briskness import DAMPING_RATIO, FREQUENCY, SPEED
from sim.gain_rules import hand_spring, servos

SIDE = "right"
SHOULDER = ("shoulder_y", "shoulder_x", "shoulder_z")
WRIST = ("wrist_z", "wrist_x", "wrist_y")
HANGING = {"shoulder_x": 9.0, "elbow": 14.0}  # at rest, as Adonis' [deg]; the others are at 0


def arm7(person: Anthropometry = MALE, *, limits: bool = True, contacts: bool = True) -> Body:
    """The arm of a person: joints `right_shoulder_y` and so on, links `right_upper_arm`, ....

    Args:
        person: segment masses, lengths and moments.
        limits: joint limits on.
        contacts: collisions of the arm with its pedestal on.
    """
    spec = build_single_arm(person, SIDE, limits=limits, contacts=contacts)
    plain = (*SHOULDER, "elbow", *WRIST)
    joints = tuple(f"{SIDE}_{joint}" for joint in plain)
    parts = {name: joint.partition("_")[0] for name, joint in zip(joints, plain, strict=True)}
    model = spec.compile()
    rest = {name: HANGING.get(joint, 0.0) for name, joint in zip(joints, plain, strict=True)}
    arm = Limb(
        side=SIDE,
        joints=joints,
        shoulder=joints[:3],
        elbow=joints[3],
        upper_arm=f"{SIDE}_upper_arm",
        forearm=f"{SIDE}_forearm",
        hand=f"{SIDE}_hand",
        palm=f"{SIDE}_palm",
        spring=hand_spring(model, joints, 3, f"{SIDE}_palm"),
    )
    return Body(
        spec,
        BodyMap(
            name="arm7",
            limbs={f"{SIDE}_arm": arm},
            groups={"waist": (), "neck": (), "left_arm": ()},
            landmarks=(f"{SIDE}_shoulder.top", f"{SIDE}_elbow.inside", "chest.front"),
            postures={"upright": {}, "rest": rest},
            servos=servos(model, parts, FREQUENCY, DAMPING_RATIO),
            speed_limits={name: SPEED[part] for name, part in parts.items()},
            keep_apart=((f"{SIDE}_hand", "trunk"), (f"{SIDE}_forearm", "trunk")),
        ),
    )

"""The bodies that come with the package, and their body maps."""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any

from sim.adonis_character import EYES, JOINTS, SIDES, build_adonis
from sim.anthropometry import FEMALE, MALE, Anthropometry
from sim.arm7 import arm7
from sim.body import Body
from sim.body_map import BodyMap, Head, Limb, Spring
from sim.briskness import DAMPING_RATIO, FREQUENCY, SPEED
from sim.errors import BodyError, unknown
from sim.extending import renamed
from sim.gain_rules import servos
from sim.gains import Gains, scaled_gains
from sim.laws import Law
from sim.people import person
from sim.people_by_name import person_of
from sim.planar_arm import planar_arm
from sim.scaling import scale_model, scale_motors
from sim.weight import add_weight

WAIST = ("waist_z", "waist_x", "waist_y")
NECK = ("neck_z", "neck_x", "neck_y")
ARM = ("shoulder_y", "shoulder_x", "shoulder_z", "elbow", "wrist_z", "wrist_x", "wrist_y")

WEIGHT = 2.0  # of adonis-weight [kg]

SPRING = Spring(
    stiffness=1500.0,
    damping=85.0,
    turn_stiffness=20.0,
    turn_damping=0.9,
    upper_arm_stiffness=30.0,
    upper_arm_damping=3.0,
    shoulder_damping=1.0,
)

LANDMARKS = (
    *(f"{side}_{part}" for side in SIDES for part in ("shoulder.top", "ribs", "hip", "hip.front")),
    *(f"{side}_elbow.inside" for side in SIDES),
    *("head.back", "head.back_left", "head.back_right"),
    *("head.front", "head.top", "head.left", "head.right"),
    *("chest.front", "belly.front"),
)


def adonis(
    person: Anthropometry = MALE,
    *,
    name: str = "adonis",
    limits: bool = True,
    contacts: bool = True,
) -> Body:
    """The Adonis torso with the proportions of `person` (Mataric et al. 1999, section 3).

    The man's gains are chosen; those of anybody else follow from them by the laws of `sim.laws`,
    as do the torques of the motors, armature and damping. A person is built as large as the man
    and then scaled, since what the builder draws by the centimetre is drawn for him.
    """
    if person == MALE:
        return _man(name, limits=limits, contacts=contacts)
    man = _standard(limits, contacts)
    size = Law.geometric(person.arm / MALE.arm)
    spec = build_adonis(
        person.scaled(Law.geometric(1.0 / size.length)), limits=limits, contacts=contacts
    )
    scale_model(spec, size)
    scale_motors(spec, man, size)
    return _with_gains_of(man, spec, name, person)


def adonis_with_weight(*, limits: bool = True, contacts: bool = True) -> Body:
    """The man with a weight of 2 kg on the back of his right hand.

    He is no stronger for it: motors, armature and damping are his own.
    """
    man = _standard(limits, contacts)
    spec = man.spec.copy()
    add_weight(spec, "right", WEIGHT)
    return _with_gains_of(man, spec, "adonis-weight", MALE)


def _with_gains_of(man: Body, spec: Any, name: str, person: Anthropometry) -> Body:
    """The man's body map on another model, its gains scaled to it."""
    size = Law.geometric(person.arm / MALE.arm)
    head = None if man.map.head is None else man.map.head.model_copy(update={"eyes": _eyes(person)})
    more = {"name": name, "head": head, "time_scale": size.time}
    other = Body(spec, man.map.model_copy(update=more))
    gains, _ = scaled_gains(man, Gains.of(man.map), other)
    return renamed(other, gains.on(other.map))


@lru_cache(maxsize=4)
def _standard(limits: bool, contacts: bool) -> Body:
    """The man that the others are scaled from; nobody may change him."""
    return _man("adonis", limits=limits, contacts=contacts)


def _man(name: str, *, limits: bool, contacts: bool) -> Body:
    spec = build_adonis(MALE, limits=limits, contacts=contacts)
    arms = {
        f"{side}_arm": Limb(
            side=side,
            joints=tuple(f"{side}_{joint}" for joint in ARM),
            shoulder=tuple(f"{side}_{joint}" for joint in ARM[:3]),
            elbow=f"{side}_elbow",
            upper_arm=f"{side}_upper_arm",
            forearm=f"{side}_forearm",
            hand=f"{side}_hand",
            palm=f"{side}_palm",
            spring=SPRING,
        )
        for side in SIDES
    }
    upright = dict.fromkeys((*WAIST, *NECK), 0.0)
    hanging = {"shoulder_y": 0, "shoulder_x": 9, "shoulder_z": 0, "elbow": 14}
    hanging |= {"wrist_z": 0, "wrist_x": 0, "wrist_y": 0}
    rest = {f"{side}_{joint}": float(angle) for side in SIDES for joint, angle in hanging.items()}
    parts = {name: next(part for part in FREQUENCY if part in name) for name in upright | rest}
    return Body(
        spec,
        BodyMap(
            name=name,
            limbs=arms,
            groups={"waist": WAIST, "neck": NECK},
            head=Head(
                link="head",
                forward=(1.0, 0.0, 0.0),
                eyes=_eyes(MALE),
                joints=("neck",),
            ),
            landmarks=LANDMARKS,
            postures={"upright": upright, "rest": upright | rest},
            servos=servos(spec.compile(), parts, FREQUENCY, DAMPING_RATIO),
            speed_limits={name: SPEED[part] for name, part in parts.items()},
            keep_apart=_keep_apart(),
            upright=("waist", "neck"),
        ),
    )


def _eyes(person: Anthropometry) -> tuple[float, float, float]:
    """Between them, in the frame of the head [m]."""
    forward, left, up = (share * person.head.length for share in EYES)
    return forward, left, up


PEOPLE: dict[str, Anthropometry] = {
    "adonis": MALE,
    "adonis-female": FEMALE,
    "adonis-child": person(age=6),
    "adonis-giant": MALE.scaled(Law.geometric(2.0)),
}

BODIES: dict[str, Callable[..., Body]] = {
    **{name: partial(adonis, person, name=name) for name, person in PEOPLE.items()},
    "adonis-weight": adonis_with_weight,
    "arm7": arm7,
    "planar-arm": planar_arm,
}


def load_body(name: str, *, limits: bool = True, contacts: bool = True) -> Body:
    """A body of the package by name.

    Args:
        name: one of `BODIES`, or a description of a person: see `person_of`.
        limits: joint limits on.
        contacts: collisions on.

    Raises:
        BodyError: there is no such body; the message lists those there are.
    """
    described = person_of(name)
    if described is not None:
        return adonis(described, name=name, limits=limits, contacts=contacts)
    if name not in BODIES:
        raise BodyError(unknown("body", name, BODIES))
    return BODIES[name](limits=limits, contacts=contacts)


def _keep_apart() -> tuple[tuple[str, str], ...]:
    """Arms against head, trunk and pelvis, and the links of one arm against the other's."""
    links = ("hand", "forearm", "upper_arm")
    pairs = [(f"{s}_{a}", b) for s in SIDES for a in links[:2] for b in ("head", "trunk", "pelvis")]
    pairs += [(f"{side}_upper_arm", "head") for side in SIDES]
    pairs += [(f"right_{a}", f"left_{b}") for a in links for b in links]
    return tuple(pairs)


assert set(JOINTS) == {*WAIST, *NECK, *ARM}

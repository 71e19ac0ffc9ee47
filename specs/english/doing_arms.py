"""Verbs of how arms are held: what each makes of a clause. See `senses` in vocabulary.yaml.

Each function takes the roles of a clause, the sense of its verb, and the context; it returns
stages, one after the other, each a list of steps at the same time. `USES` says which roles it has
a use for besides those of time.
"""

from dataclasses import replace
from math import cos, radians, sin
from typing import Any

from specs.english.context import HANGING, Context, Hands
from specs.english.doing import (
    Sense,
    Stages,
    hands_of,
    limb,
    quoted,
    shown,
    size_of,
    step_of,
)
from specs.english.places import OPPOSITE, VECTORS, direction, facing
from specs.english.problems import Problem
from specs.english.roles import Roles
from specs.english.steps import SIDES, Step, opposite, plain

BENT_FOR_PALM = 35  # [degrees] of the elbow; from 30 on the wrist can do it
# The upper arm hangs beside the ribs, the forearm is held out.
FOREARM_OUT: dict[str, dict[str, Any]] = {
    "right": {"arm": [1, -0.5, -1], "elbow": 90},
    "left": {"arm": [1, 0.5, -1], "elbow": 90},
}


def arm(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Hold an arm in a direction: get-posture."""
    if [way.key for way in roles.ways] in (["rest"], ["down", "rest"]):
        return rest(roles, sense, context)
    hands = hands_of(roles, context)
    steps = []
    for side in hands.sides:
        step = limb(hands, step_of(roles, "get-posture", side), side)
        posture: dict[str, Any] = {}
        ways = [way for way in roles.ways if way.key != "there"]
        if ways or "arm" not in sense:
            posture["arm"], assumed = direction(ways, side, context)
            for way in ways:
                step.because(way.words, "posture", f"arm: {shown(posture['arm'])}")
            if assumed:
                step.assume(assumed)
        else:
            posture["arm"] = sense["arm"]
            step.assume(f"arm {sense['arm']}, since no direction is said")
        if roles.angle is not None:
            posture["arm"] = _tilted(posture["arm"], roles.angle.number)
            step.because(roles.angle.words, "posture", f"arm: {shown(posture['arm'])}")
            step.assume("degrees from hanging down")
        posture["elbow"] = _elbow(roles, sense, step)
        if roles.palm:
            posture["palm"] = facing(roles.palm[-1], side, context)
            step.because(roles.palm[-1].words, "posture", f"palm: {posture['palm']}")
        elif "palm" in sense:
            _push_with_palm(posture, step)
        elif roles.object is not None and roles.object.what == "palm":
            step.assume("the palm faces as it comes")
        if not roles.elbow and not roles.states:
            _bend_for_palm(posture, step)
        step.parameters["posture"] = posture
        context.put(side, dict(posture), up=posture["arm"] == "up")
        steps.append(step)
    context.last = hands.sides
    return [steps]


def _push_with_palm(posture: dict[str, Any], step: Step) -> None:
    """What is pushed is pushed with the palm."""
    if isinstance(posture["arm"], str):
        posture["palm"] = posture["arm"]
        step.assume(f"palm {posture['palm']}, the way it is pushed")


def _bend_for_palm(posture: dict[str, Any], step: Step) -> None:
    """No wrist turns the palm the way that a straight arm points: bend the elbow, if it is free."""
    way, palm = posture["arm"], posture.get("palm")
    if not isinstance(way, str) or palm not in (way, OPPOSITE[way]):
        return
    if posture["elbow"] != "straight":
        return
    posture["elbow"] = BENT_FOR_PALM
    step.assumed = [said for said in step.assumed if said != "elbow straight"]
    step.assume(f"elbow bent by {BENT_FOR_PALM} degrees: with a straight arm no palm faces {palm}")


def _elbow(roles: Roles, sense: Sense, step: Step) -> str | float:
    said = [*roles.elbow, *roles.states]
    if not said:
        if sense.get("elbow"):
            step.assume(f"elbow {sense['elbow']}")
        return str(sense.get("elbow", "straight"))
    key = said[-1].key
    known: dict[str, str | float] = {"straight": "straight", "bent": 90}
    value = known.get(key, "")
    if value == "":
        try:
            value = plain(float(key))
        except ValueError:
            raise Problem.of(
                "an elbow is straight, bent, or bent by so many degrees", said[-1].words
            ) from None
    step.because(said[-1].words, "posture", f"elbow: {value}")
    if key == "bent":
        step.assume("elbow bent by 90 degrees")
    return value


def _tilted(way: str | list[float], degrees: float) -> list[float]:
    """So many degrees from hanging, towards a direction."""
    towards = VECTORS[way] if isinstance(way, str) else way
    a = radians(degrees)
    return [
        plain(round(sin(a) * c - (cos(a) if k == 2 else 0.0), 3)) for k, c in enumerate(towards)
    ]


def rest(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Let an arm hang as at the beginning: get-posture rest."""
    if roles.palm or roles.elbow or roles.states:  # how a lowered arm is held
        stages = arm(replace(roles, ways=[]), {"arm": "down"}, context)
        for step in stages[0]:
            side = str(step.parameters["limb"]).removesuffix("_arm")
            if step.parameters["posture"]["elbow"] == FOREARM_OUT[side]["elbow"]:
                step.parameters["posture"] |= FOREARM_OUT[side]
                context.put(side, dict(step.parameters["posture"]))
                step.assumed = [said for said in step.assumed if not said.startswith("arm down")]
                step.assume("the upper arm hangs")
        return stages
    returns = sense.get("with") == "return"
    for way in roles.ways if not returns else ():
        if way.key not in ("rest", "down"):
            raise Problem.of(f"{quoted(way.words)} has no meaning with {roles.verb!r}", way.words)
    hands = hands_of(roles, context)
    steps = []
    for side in hands.sides:
        step = limb(hands, step_of(roles, "get-posture", side, posture="rest"), side)
        for way in roles.ways:
            step.because(way.words, "posture", "rest")
        if returns:
            step.assume("'back' is to the posture of rest; behind you is 'backward'")
        if not roles.ways:
            step.assume("lowered to the posture of rest")
        context.put(side, HANGING)
        steps.append(step)
    context.last = hands.sides
    return [steps]


def elbow(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Bend or straighten elbows and leave the shoulder as it is: get-posture of that joint."""
    hands = hands_of(roles, context)
    noun = roles.object
    if noun is not None and noun.noun is not None and noun.noun.entry.key == "wrist":
        raise Problem.of(
            f"{quoted(noun.words)} does not bend alone: say 'Bend your {hands.sides[0]} elbow', or"
            " which way the palm faces, such as 'palm up'",
            noun.words,
        )
    degrees = float(sense["degrees"])
    if roles.angle is not None:
        degrees = roles.angle.number
    elif degrees:
        degrees *= size_of(roles)
    joints = [f"{side}_elbow" for side in hands.sides]
    posture = dict.fromkeys(joints, plain(degrees))
    step = Step(
        roles.clause, "get-posture", {"joints": joints, "posture": posture},
        frozenset(f"{side}_arm" for side in hands.sides),
    )  # fmt: skip
    step.because(roles.clause.words[:1], "primitive", "get-posture")
    if hands.words:
        step.because(hands.words, "joints", ", ".join(joints))
    if roles.angle is not None:
        step.because(roles.angle.words, "posture", f"{degrees:g} degrees")
    else:
        step.assume(f"elbow at {degrees:g} degrees")
    if hands.assumed:
        step.assume(hands.assumed)
    for side in hands.sides:
        context.put(side, up=side in context.raised)
    context.last = hands.sides
    return [[step]]


def palm(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Turn a palm and leave the arm where it is: get-posture with the arm as it was."""
    hands = hands_of(roles, context)
    if any(context.at[side] is not None for side in hands.sides):
        return _palm_at(roles, hands, context)
    ways = [*roles.palm, *(way for way in roles.ways if way.key not in ("there",))]
    steps = []
    for side in hands.sides:
        held = context.arms[side]
        if held is None:
            raise Problem.of(
                f"how the {side} arm is held is not known here, so only its palm cannot turn: say"
                f" both, such as 'Extend your {side} arm forward, palm up'",
                roles.clause.words,
            )
        step = limb(hands, step_of(roles, "get-posture", side), side)
        if sense.get("over") or (ways and ways[-1].key == "over"):
            if held.get("palm") not in OPPOSITE:
                raise Problem.of(
                    f"which way the {side} palm faces is not known here: say 'palm up' or"
                    " 'palm down'",
                    roles.clause.words,
                )
            facing_ = OPPOSITE[str(held["palm"])]
            step.because(
                ways[-1].words if ways else roles.clause.words[:1], "posture", f"palm: {facing_}"
            )
        elif ways:
            facing_ = facing(ways[-1], side, context)
            step.because(ways[-1].words, "posture", f"palm: {facing_}")
        else:
            raise Problem.of(
                f"{roles.verb!r} which way? say 'palm up', 'palm down', 'palm forward' or 'over'",
                roles.clause.words,
            )
        posture = {"arm": held["arm"], "elbow": held.get("elbow", "straight"), "palm": facing_}
        if held["arm"] == "down" and facing_ == "up":
            posture |= FOREARM_OUT[side]
            step.assume("elbow bent by 90 degrees: a hanging arm has no palm up")
        else:
            step.assume(f"arm {shown(held['arm'])} as before")
            step.assume(f"elbow {posture['elbow']}")
            _bend_for_palm(posture, step)
        step.parameters["posture"] = posture
        context.put(side, posture, up=side in context.raised)
        steps.append(step)
    context.last = hands.sides
    return [steps]


def _palm_at(roles: Roles, hands: Hands, context: Context) -> Stages:
    """Turn the palm of a hand that was brought to a place, and keep it there: go-to-point."""
    ways = [*roles.palm, *(way for way in roles.ways if way.key != "there")]
    steps = []
    for side in hands.sides:
        at = context.at[side]
        if not isinstance(at, dict) or not ways or ways[-1].key == "over":
            where = "" if at is None else f" (it is at {shown(at)})"
            raise Problem.of(
                f"the {side} palm cannot turn there{where}: say where the hand goes, such as 'Hold"
                f" your {side} hand in front of your belly, palm up'",
                roles.clause.words,
            )
        step = limb(hands, step_of(roles, "go-to-point", side, to=at), side)
        step.parameters["palm"] = facing(ways[-1], side, context)
        step.because(ways[-1].words, "palm", str(step.parameters["palm"]))
        steps.append(step.assume("the hand where it is"))
    context.last = hands.sides
    return [steps]


def relax(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Let arms hang loose: relax."""
    hands = (
        Hands(SIDES, (), "both arms")
        if roles.object is None and roles.hand is None
        else hands_of(roles, context)
    )
    steps = []
    for side in hands.sides:
        step = limb(hands, step_of(roles, "relax", side), side)
        if sense.get("limp"):
            step.parameters["limp"] = True
            step.assume("falls by its own weight")
        else:
            step.assume("floats where it is, its weight still carried; 'drop' lets it fall")
        step.lasting = True
        context.put(side)
        steps.append(step)
    context.last = hands.sides
    return [steps]


def hold(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Keep something as it is: hold."""
    if "joints" in sense or (roles.object is None and roles.hand is None):
        joints = list(sense.get("joints", ["all"]))
        moves = frozenset(
            {"right_arm", "left_arm", "waist", "neck"} if joints == ["all"] else joints
        )
        step = Step(roles.clause, "hold", {"joints": joints}, moves, lasting=True)
        step.because(roles.clause.words[:1], "primitive", "hold")
        if roles.object is None:
            step.assume("all joints")
        return [[step]]
    if roles.object is not None and roles.hand is not None:
        side = context.hands(roles.hand).sides[0]
        raise Problem.of(
            f"no hand holds something fast: say 'Touch your {opposite(side)} hand with your {side}"
            " hand'",
            roles.clause.words,
        )
    hands = hands_of(roles, context)
    steps = []
    for side in hands.sides:
        step = limb(hands, step_of(roles, "hold", side), side)
        step.lasting = True
        steps.append(step)
    context.last = hands.sides
    return [steps]

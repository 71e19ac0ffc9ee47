"""Verbs of arms and hands: what each makes of a clause. See `senses` in vocabulary.yaml.

Each function takes the roles of a clause, the sense of its verb, and the context; it returns
stages, one after the other, each a list of steps at the same time. `USES` says which roles it has
a use for besides those of time.
"""

from collections.abc import Mapping
from math import cos, radians, sin
from typing import Any

from specs.english.context import HANGING, Context, Hands
from specs.english.places import VECTORS, direction, facing, place
from specs.english.problems import Problem
from specs.english.roles import Roles
from specs.english.sentences import Noun, Phrase, Word
from specs.english.steps import SIDES, Step, opposite, plain

Sense = Mapping[str, Any]
Stages = list[list[Step]]
OVER = {
    "up": "down",
    "down": "up",
    "forward": "back",
    "back": "forward",
    "left": "right",
    "right": "left",
}
TAP_AWAY = 0.08  # [m] off the surface between two taps
CLAP = {"near": "chest.front", "away": 0.25}  # where hands meet
APART, TOGETHER = 0.12, 0.012  # of each palm from the middle [m]
MOST_TAPS = 1000


def limb(hands: Hands, step: Step, side: str) -> Step:
    """Say which arm a step moves, and why."""
    step.parameters["limb"] = f"{side}_arm"
    if hands.words:
        step.because(hands.words, "limb", f"{side}_arm")
    if hands.assumed:
        step.assume(hands.assumed)
    return step


def _step(roles: Roles, primitive: str, side: str, **parameters: Any) -> Step:
    step = Step(
        roles.clause, primitive, {"limb": f"{side}_arm", **parameters}, frozenset({f"{side}_arm"})
    )
    if roles.clause.verb is not None:
        step.because([roles.clause.verb], "primitive", primitive)
    return step


def _hands(roles: Roles, context: Context) -> Hands:
    """The arms that a clause moves: its object, or what it is done with."""
    noun = (
        roles.object
        if roles.object is not None and roles.object.what in ("arm", "palm", "elbow", "")
        else None
    )
    if noun is not None and roles.hand is not None:
        raise Problem.of(
            f"{_said(noun)} or {_said(roles.hand)}: which of them moves?", roles.hand.words
        )
    return context.hands(noun or roles.hand)


def arm(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Hold an arm in a direction: get-posture."""
    if [way.key for way in roles.ways] in (["rest"], ["down", "rest"]):
        return rest(roles, sense, context)
    hands = _hands(roles, context)
    steps = []
    for side in hands.sides:
        step = limb(hands, _step(roles, "get-posture", side), side)
        posture: dict[str, Any] = {}
        ways = [way for way in roles.ways if way.key not in ("there", "straight")]
        if ways or "arm" not in sense:
            posture["arm"], assumed = direction(ways, side, context)
            for way in ways:
                step.because(way.words, "posture", f"arm: {_shown(posture['arm'])}")
            if assumed:
                step.assume(assumed)
        else:
            posture["arm"] = sense["arm"]
            step.assume(f"arm {sense['arm']}, since no direction is said")
        if roles.angle is not None:
            posture["arm"] = _tilted(posture["arm"], roles.angle.number)
            step.because(roles.angle.words, "posture", f"arm: {_shown(posture['arm'])}")
            step.assume("degrees from hanging down")
        posture["elbow"] = _elbow(roles, sense, step)
        if roles.palm:
            posture["palm"] = facing(roles.palm[-1], side, context)
            step.because(roles.palm[-1].words, "posture", f"palm: {posture['palm']}")
        step.parameters["posture"] = posture
        context.arms[side] = dict(posture)
        _raise(context, side, up=posture["arm"] == "up")
        steps.append(step)
    context.last = hands.sides
    return [steps]


def _elbow(roles: Roles, sense: Sense, step: Step) -> str | float:
    said = [*roles.elbow, *roles.states]
    if not said:
        if sense.get("elbow"):
            step.assume(f"elbow {sense['elbow']}")
        return str(sense.get("elbow", "straight"))
    key = said[-1].key
    value: str | float = {"straight": "straight", "bent": 90}.get(key, "")
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
    hands = _hands(roles, context)
    steps = []
    for side in hands.sides:
        step = limb(hands, _step(roles, "get-posture", side, posture="rest"), side)
        for way in roles.ways:
            step.because(way.words, "posture", "rest")
        if not roles.ways:
            step.assume("lowered to the posture of rest")
        context.arms[side] = HANGING
        _raise(context, side, up=False)
        steps.append(step)
    context.last = hands.sides
    return [steps]


def elbow(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Bend or straighten elbows and leave the shoulder as it is: get-posture of that joint."""
    hands = _hands(roles, context)
    degrees = float(sense["degrees"])
    if roles.angle is not None:
        degrees = roles.angle.number
    elif degrees:
        degrees *= _size(roles)
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
        context.arms[side] = None
    context.last = hands.sides
    return [[step]]


def palm(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Turn a palm and leave the arm where it is: get-posture with the arm as it was."""
    hands = _hands(roles, context)
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
        step = limb(hands, _step(roles, "get-posture", side), side)
        if sense.get("over") or (ways and ways[-1].key == "over"):
            if held.get("palm") not in OVER:
                raise Problem.of(
                    f"which way the {side} palm faces is not known here: say 'palm up' or 'palm down'",
                    roles.clause.words,
                )
            facing_ = OVER[str(held["palm"])]
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
        step.parameters["posture"] = posture
        step.assume(f"arm {_shown(held['arm'])} as before, elbow {posture['elbow']}")
        context.arms[side] = posture
        steps.append(step)
    context.last = hands.sides
    return [steps]


def _goers(roles: Roles, context: Context, where: Noun) -> Hands:
    """The hands that go somewhere; if none is named, those that suit the place."""
    if (
        roles.places
        and roles.object is not None
        and roles.object.what in ("arm", "palm", "elbow", "")
    ):
        return _hands(roles, context)
    if roles.hand is not None:
        return context.hands(roles.hand)
    meaning = where.noun.entry.meaning if where.noun else {}
    if where.plural and "side" in meaning:
        return context.hands(None, both=True)
    if where.side and "side" in meaning and "head" not in str(meaning.get("place")):
        side = context.side(where.side)
        return context.hands(None, default=side if meaning["side"] == "own" else opposite(side))
    return context.hands(None)


def _target(roles: Roles) -> Phrase:
    """The one place of a clause: after a preposition, or what is touched."""
    if len(roles.places) > 1:
        raise Problem.of(
            f"two places: {roles.places[0].text!r} and {roles.places[1].text!r}; name one",
            roles.places[1].words,
        )
    if roles.places:
        return roles.places[0]
    assert roles.object is not None
    return Phrase("place", roles.object.words, noun=roles.object)


def reach(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Bring a palm to a place: go-to-point; to another hand: follow."""
    where = _target(roles)
    assert where.noun is not None
    hands = _goers(roles, context, where.noun)
    steps = []
    for side in hands.sides:
        if where.noun.what in ("arm", "palm") or where.noun.pronoun is not None:
            steps.append(_to_hand(roles, where, hands, side, context))
            continue
        to, assumed = place(where, side, context, both=hands.both)
        step = limb(hands, _step(roles, "go-to-point", side, to=to), side)
        step.because(where.words, "to", _shown(to))
        for said in assumed:
            step.assume(said)
        if roles.palm:
            step.parameters["palm"] = facing(roles.palm[-1], side, context)
            step.because(roles.palm[-1].words, "palm", str(step.parameters["palm"]))
        steps.append(step)
    _two_places(steps, where)
    _moved(context, hands)
    return [steps]


def _two_places(steps: list[Step], where: Phrase) -> None:
    """Two hands do not fit on one place."""
    if len(steps) == 2 and steps[0].parameters["to"] == steps[1].parameters["to"]:
        raise Problem.of(
            f"both hands do not fit on one place ({_shown(steps[0].parameters['to'])}): say one hand, or"
            " a place for each",
            where.words,
        )


def _to_hand(roles: Roles, where: Phrase, hands: Hands, side: str, context: Context) -> Step:
    """One hand goes to the other."""
    assert where.noun is not None
    goal = context.hands(where.noun)
    if goal.sides != (opposite(side),):
        raise Problem.of(f"the {side} hand cannot go to itself", where.words)
    step = limb(hands, _step(roles, "follow", side, to={"hand": f"{opposite(side)}_arm"}), side)
    return step.because(where.words, "to", f"{opposite(side)} hand")


def tap(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Touch a place so many times, the hand a little off it between."""
    stages = reach(roles, sense, context)
    for step in stages[0]:
        if step.primitive != "go-to-point" or not isinstance(step.parameters["to"], str):
            continue
        off = {"near": step.parameters["to"], "away": TAP_AWAY, "at": 0.5}
        step.parameters["via"] = [off]
        times = _times(roles, 1)
        if times > 1:
            step.own["repeat"] = times
    return stages


def reach_to(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Bring a palm to the place that the verb means."""
    hands = _hands(roles, context)
    steps = []
    for side in hands.sides:
        to = str(sense["to"]).format(other=opposite(side))
        step = limb(hands, _step(roles, "go-to-point", side, to=to), side)
        steps.append(step.assume(f"to {to}"))
    _moved(context, hands)
    return [steps]


def cross(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Both palms to the other side, the right one first: they cannot pass through each other."""
    where = roles.places[0] if roles.places else None
    to = str(sense["to"])
    if where is not None and where.noun is not None:
        meaning = where.noun.noun.entry.meaning if where.noun.noun else {}
        said = str(meaning.get("across") or meaning.get("place")).replace("{side}", "{other}")
        if "{other}" not in said:
            raise Problem.of(f"arms cannot be crossed {where.text!r}", where.words)
        to = said if meaning.get("side") else to
    steps = reach_to(roles, {"to": to}, context)[0]
    for step in steps:
        step.assume("the right one first")
        if where is not None:
            step.because(where.words, "to", str(step.parameters["to"]))
    return [[step] for step in steps]


def press(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Both palms together, in front of the chest or of what is said."""
    hands = _hands(roles, context)
    way = next(way for way in roles.ways if way.key == "together")
    for other in roles.ways:
        if other is not way:
            raise Problem.of(f"{_said_words(other.words)} and together?", other.words)
    near: dict[str, Any] = dict(CLAP)
    if roles.places:
        to, _ = place(_target(roles), "right", context, both=True)
        if isinstance(to, str) or "offset" in to:
            raise Problem.of(
                f"{roles.places[0].text!r}: hands come together in front of a place",
                roles.places[0].words,
            )
        near = to
    steps = [_meeting(roles, hands, side, near) for side in hands.sides]
    for step in steps:
        step.because(way.words, "to", "palm to palm")
        for phrase in roles.places:
            step.because(phrase.words, "to", _shown(near))
        if not roles.places:
            step.assume("25 cm in front of the chest")
    _moved(context, hands)
    return [steps]


def _meeting(roles: Roles, hands: Hands, side: str, near: Mapping[str, Any] = CLAP) -> Step:
    """One palm beside the middle, facing the other."""
    out = TOGETHER if side == "left" else -TOGETHER
    to = {**near, "offset": [0, out, 0]}
    return limb(hands, _step(roles, "go-to-point", side, to=to, palm=opposite(side)), side)


def clap(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Palms apart and together in front of the chest, so many times."""
    hands = Hands(SIDES, roles.object.words if roles.object else ())
    steps = []
    for side in SIDES:
        step = _meeting(roles, hands, side)
        out = APART if side == "left" else -APART
        step.parameters["via"] = [{**CLAP, "offset": [0, out, 0], "at": 0.5}]
        times = _times(roles, 1)
        if times > 1:
            step.own["repeat"] = times
        steps.append(step.assume("in front of the chest"))
    _moved(context, hands)
    return [steps]


def relax(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Let arms hang loose: relax."""
    hands = (
        Hands(SIDES, (), "both arms")
        if roles.object is None and roles.hand is None
        else _hands(roles, context)
    )
    steps = []
    for side in hands.sides:
        step = limb(hands, _step(roles, "relax", side), side)
        if sense.get("limp"):
            step.parameters["limp"] = True
            step.assume("falls by its own weight")
        else:
            step.assume("floats where it is, its weight still carried; 'drop' lets it fall")
        step.lasting = True
        context.arms[side] = None
        _raise(context, side, up=False)
        steps.append(step)
    context.last = hands.sides
    return [steps]


def hold(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Keep something as it is: hold."""
    if "joints" in sense or roles.object is None:
        joints = list(sense.get("joints", ["all"]))
        moves = frozenset(
            {"right_arm", "left_arm", "waist", "neck"} if joints == ["all"] else joints
        )
        step = Step(roles.clause, "hold", {"joints": joints}, moves, lasting=True)
        step.because(roles.clause.words[:1], "primitive", "hold")
        if roles.object is None:
            step.assume("all joints")
        return [[step]]
    hands = _hands(roles, context)
    steps = []
    for side in hands.sides:
        step = limb(hands, _step(roles, "hold", side), side)
        step.lasting = True
        steps.append(step)
    context.last = hands.sides
    return [steps]


def _times(roles: Roles, default: int) -> int:
    if roles.count is None:
        return default
    number = roles.count.number
    if number != int(number) or not 1 <= number <= MOST_TAPS:
        raise Problem.of(
            f"expected a whole number of times up to {MOST_TAPS}, not {number:g}", roles.count.words
        )
    return int(number)


def _size(roles: Roles) -> float:
    size = 1.0
    for word in roles.manners:
        size *= float(word.entry.meaning.get("size", 1.0))
    return size


def _moved(context: Context, hands: Hands) -> None:
    for side in hands.sides:
        context.arms[side] = None
        _raise(context, side, up=False)
    context.last = hands.sides


def _raise(context: Context, side: str, *, up: bool) -> None:
    (context.raised.add if up else context.raised.discard)(side)


def _said(noun: Noun) -> str:
    return _said_words(noun.words)


def _said_words(words: tuple[Word, ...]) -> str:
    return repr(" ".join(word.text for word in words))


def _shown(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {item}" for key, item in value.items()) + "}"
    return str(value)

"""Verbs of head and trunk, of rhythm, gaze and rest: see `doing_arms` for what they are."""

from dataclasses import replace
from typing import Any

from specs.english.context import HANGING, Context, Hands
from specs.english.doing import Sense, Stages, hands_of, limb, shown, size_of, step_of
from specs.english.places import VECTORS, direction, facing, landmark
from specs.english.problems import Problem
from specs.english.roles import Roles, Way
from specs.english.sentences import Phrase, Word
from specs.english.steps import SIDES, Step, opposite, plain
from specs.english.vocabulary import vocabulary

JOINTS = {"neck": ("neck_z", "neck_x", "neck_y"), "waist": ("waist_z", "waist_x", "waist_y")}
WAVING = {"elbow": 90, "palm": "forward"}  # how an arm is raised to wave
SWINGING = ("swaying", "sideways", "fore-and-aft", "up-and-down")
MOST_CYCLES = 10_000


def turn(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Turn, tilt or bend the head or the trunk: get-posture of neck or waist."""
    ways = vocabulary().data["ways"][sense["ways"]]
    group = ways["joints"]
    said = [way for way in [*roles.ways, *roles.states] if way.key not in ("there", "over")]
    angles: dict[str, float] = {}
    step = Step(roles.clause, "get-posture", {"joints": [group]}, frozenset({group}))
    step.because(roles.clause.words[:1], "primitive", "get-posture")
    if roles.object is not None:
        step.because(roles.object.words, "joints", group)
    keys = [context.side(way.key) for way in said]
    if not keys:
        if "way" not in sense:
            known = ", ".join(key for key in ways if key not in ("joints", "straight"))
            raise Problem.of(f"{roles.verb!r} which way? ({known})", roles.clause.words)
        keys = [sense["way"]]
        if sense["way"] != "straight":
            step.assume(str(sense["way"]))
    for key, words in zip(keys, [way.words for way in said] or [()], strict=True):
        if key not in ways:
            known = ", ".join(k for k in ways if k != "joints")
            raise Problem.of(f"{roles.verb!r} goes {known}, not {_text(words)!r}", words)
        for joint, degrees in ways[key].items():
            if joint in angles:
                raise Problem.of(f"{' and '.join(keys)} do not go together", words)
            angles[joint] = degrees
        if words:
            step.because(words, "posture", key)
    size = size_of(roles)
    if angles and roles.angle is not None:
        largest = roles.angle.number
        angles = {j: largest if d > 0 else -largest for j, d in angles.items()}
        step.because(roles.angle.words, "posture", f"{largest:g} degrees")
    elif angles:
        angles = {j: d * size for j, d in angles.items()}
        shown = " and ".join(f"{abs(d):g}" for d in angles.values())
        step.assume(f"by {shown} degrees")
    elif roles.angle is not None:
        raise Problem.of(f"{roles.angle.number:g} degrees which way?", roles.angle.words)
    moved = [s for s in SIDES if context.at[s] is not None or context.arms[s] != HANGING]
    if sense["ways"] == "straight-trunk" and roles.object is None and moved:
        arms = " and ".join(f"{side} arm" for side in moved)
        step.assume(f"only the trunk straightens: this leaves the {arms} where it is")
    posture = {j: plain(angles.get(j, 0.0)) for j in JOINTS[group]}
    step.parameters["posture"] = posture
    if group == "waist":
        context.turned = posture["waist_z"]
    elif context.turned and not angles:
        way, back = ("left", "right") if context.turned > 0 else ("right", "left")
        step.assume(
            f"forward of the trunk, which is turned to the {way}: to face the front say 'Turn your"
            f" head {abs(context.turned):g} degrees to the {back}'"
        )
    return [[step]]


def order(roles: Roles) -> list[Way]:
    """Left and right one after the other, each once: nothing if more is said than that."""
    if any((roles.count, roles.rate, roles.time, roles.until)):
        return []
    ways = [
        Way(word, way.words)
        for way in roles.ways
        for word in (_text(way.words).lower().split() if way.key == "sideways" else [way.key])
        if word in SIDES or way.key != "sideways"
    ]
    from_side = any(_text(way.words).lower().startswith("from") for way in roles.ways)
    return ways if len(ways) > 1 and not from_side and {w.key for w in ways} <= {*SIDES} else []


def turns(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Turn one way and then the other: a get-posture each."""
    stages: Stages = []
    for way in order(roles):
        stages += turn(replace(roles, ways=[way]), sense, context)
    return stages


def to_and_fro(ways: list[Way]) -> list[Way]:
    """Forward and back, said as two directions, are one swing."""
    if sorted(way.key for way in ways) != ["back", "forward"]:
        return ways
    return [Way("fore-and-aft", (*ways[0].words, *ways[1].words))]


def rhythm(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Swing joints to and fro: oscillate. An arm that waves is raised first."""
    rhythms = vocabulary().data["rhythms"]
    swing = rhythms[sense["rhythm"]]
    roles.ways = to_and_fro(roles.ways)
    if "sideways" in swing and any(way.key == "sideways" for way in roles.ways):
        swing = rhythms[swing["sideways"]]
    of_arms = any("{side}" in joint for joint in swing["joints"])
    if roles.hand is not None and not of_arms:
        raise Problem.of(
            f"{_text(roles.hand.words)!r} has no meaning with {roles.verb!r}", roles.hand.words
        )
    hands = _waving(roles, context) if of_arms else Hands(())
    joints: dict[str, Any] = {}
    size = size_of(roles)
    if roles.angle is not None:
        size *= roles.angle.number / max(s["amplitude"] for s in swing["joints"].values())
    behind = _alternating(roles, hands)
    for k, side in enumerate(hands.sides or ("",)):
        for joint, how in swing["joints"].items():
            lag = how.get("lag", 0) + k * behind
            swung = {"amplitude": plain(how["amplitude"] * size)}
            joints[joint.format(side=side)] = swung | ({"lag": lag} if lag else {})
    group = next(iter(joints)).split("_")[0]
    moves = frozenset({f"{side}_arm" for side in hands.sides} or {group})
    step = Step(roles.clause, "oscillate", {"joints": joints}, moves)
    step.because([roles.clause.verb] if roles.clause.verb else (), "primitive", "oscillate")
    if roles.object is not None:
        step.because(roles.object.words, "joints", ", ".join(joints))
    if roles.hand is not None:
        step.because(roles.hand.words, "joints", ", ".join(joints))
    if roles.angle is not None:
        step.because(roles.angle.words, "joints", f"{roles.angle.number:g} degrees")
    if hands.assumed:
        step.assume(hands.assumed)
    if behind:
        step.because(roles.in_turn, "joints", "one arm half a swing after the other")
    elif hands.both:
        step.assume("both together; else say 'alternately'")
    _first(roles, swing, step, context)
    _pace(roles, swing, step)
    stages: Stages = [[step]]
    low = [side for side in hands.sides if side not in context.raised]
    if swing.get("raised") and low:
        stages.insert(0, [_lifted(roles, hands, side) for side in low])
        for side in low:
            context.put(side, up=True)
    if hands.sides:
        context.last = hands.sides
    return stages


def _alternating(roles: Roles, hands: Hands) -> int:
    """By how many degrees the second arm swings later than the first."""
    if not roles.in_turn:
        return 0
    text = _text(roles.in_turn)
    if not hands.both:
        raise Problem.of(f"{text!r} goes with two arms", roles.in_turn)
    if roles.in_turn[0].entry.key != "alternately":
        raise Problem.of(
            f"{text!r}: a rhythm is said of each arm by itself, or 'alternately'", roles.in_turn
        )
    return 180


def _waving(roles: Roles, context: Context) -> Hands:
    if (
        roles.object is None
        and roles.hand is None
        and len(context.raised) == 1
        and not context.last
        and not context.mirrored
    ):
        return Hands(tuple(context.raised), (), "the raised arm")
    return hands_of(roles, context)


def _lifted(roles: Roles, hands: Hands, side: str) -> Step:
    """An arm half raised, bent, its palm forward."""
    out = 0.5 if side == "left" else -0.5
    step = step_of(roles, "get-posture", side, posture={"arm": [0.45, out, 0.6], **WAVING})
    return limb(hands, step, side).assume("the arm is raised first")


def _first(roles: Roles, swing: Sense, step: Step, context: Context) -> None:
    """Which way it swings first; several directions are as many half swings."""
    ways = [way for way in roles.ways if way.key not in SWINGING]
    for way in roles.ways:
        if way.key in ("swaying", swing["goes"]):
            step.because(way.words, "joints", way.key)
        elif way.key in SWINGING:
            raise Problem.of(f"{roles.verb!r} does not go {_text(way.words)!r}", way.words)
    if not ways:
        return
    first = swing.get("first")
    keys = [context.side(way.key) for way in ways]
    allowed = ("left", "right") if first else ("up", "down")
    if "raised" in swing or any(key not in allowed for key in keys):
        raise Problem.of(f"{roles.verb!r} does not go {_text(ways[0].words)!r}", ways[0].words)
    for one, two, way in zip(keys, keys[1:], ways[1:], strict=False):
        if one == two:
            raise Problem.of(f"a rhythm goes to and fro: {one!r} comes twice", way.words)
    if first and keys[0] != first:
        step.parameters["phase"] = 180
    if len(keys) > 1:
        step.own["_halves"] = len(keys)
    step.because([word for way in ways for word in way.words], "phase", f"{keys[0]} first")


def _pace(roles: Roles, swing: Sense, step: Step) -> None:
    """How fast and how often it swings."""
    beats = float(swing["beats"])
    halves = step.own.pop("_halves", 0)
    pace = beats
    if roles.rate is not None:
        pace = roles.rate.number
        step.because(roles.rate.words, "beats_per_cycle", f"{pace:g}")
    for word in roles.manners:
        if "time" in word.entry.meaning:
            pace *= float(word.entry.meaning["time"])
            step.because([word], "beats_per_cycle", f"{pace:g} beats each")
    cycles: float | None = 0.5 * halves if halves else None
    if roles.count is not None:
        number = roles.count.number
        cycles = 0.5 * halves * number if halves else number
        if not 0.5 <= number <= MOST_CYCLES:
            raise Problem.of(
                f"expected a number of times up to {MOST_CYCLES}, not {number:g}", roles.count.words
            )
        step.because(roles.count.words, "beats", f"{number:g} times")
    step.parameters["beats_per_cycle"] = plain(pace)
    if pace == beats != 1 and roles.rate is None and (roles.time is None or cycles is None):
        step.assume(f"{'half a beat' if beats == 0.5 else f'{beats:g} beats'} for each")
    if roles.time is not None:
        step.own["_cycles"] = cycles
        return
    step.lasting = cycles is None
    if cycles is None:
        cycles = float(swing["times"])
        step.assume(f"{cycles:g} times" if cycles != 1 else "once")
    step.own["beats"] = plain(cycles * pace)
    ease(step)


def ease(step: Step) -> None:
    """A swing that is too short to grow and die away does so in what time it has."""
    beats, pace = step.own.get("beats", 1), step.parameters.get("beats_per_cycle")
    if pace and beats < pace:
        step.parameters["ease"] = plain(0.49 * beats / pace)


def look(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Turn the head to something: look-at."""
    step = Step(roles.clause, "look-at", {}, frozenset({"neck"}), lasting=True)
    step.because(roles.clause.words[:1], "primitive", "look-at")
    at = _aim(roles, context)
    step.parameters["at"], assumed = _seen(at, context)
    step.because(at.words, "at", shown(step.parameters["at"]))
    for said in assumed:
        step.assume(said)
    return [[step]]


def point(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Stretch an arm towards something: point-at."""
    has_arm = roles.object is not None and roles.object.what in ("arm", "palm", "")
    aimed = (
        []
        if has_arm and not roles.places
        else [_aim(roles, context)]
        if roles.places or (not has_arm and roles.object)
        else []
    )
    hands = hands_of(roles, context) if has_arm else context.hands(roles.hand)
    steps = []
    for side in hands.sides:
        step = limb(hands, step_of(roles, "point-at", side), side)
        if aimed:
            step.parameters["at"], assumed = _seen(aimed[0], context)
            step.because(aimed[0].words, "at", shown(step.parameters["at"]))
        else:
            step.parameters["at"], assumed = _far(roles, side, context)
            for way in roles.ways:
                step.because(way.words, "at", shown(step.parameters["at"]))
        for said in assumed:
            step.assume(said)
        step.lasting = True
        context.put(side)
        steps.append(step)
    context.last = hands.sides
    return [steps]


def follow(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Let a palm follow another hand: follow; the head: look-at."""
    gaze = roles.hand.noun if roles.hand is not None else None
    if gaze is not None and roles.hand is not None and gaze.entry.key in ("head", "face"):
        stages = look(roles, sense, context)
        stages[0][0].because(roles.hand.words, "primitive", "look-at")
        return stages
    if roles.hand is not None and roles.hand.what not in ("arm", "palm", ""):
        raise Problem.of(
            f"{roles.verb!r} is done with a hand or the eyes, not with {_text(roles.hand.words)!r}",
            roles.hand.words,
        )
    at = _aim(roles, context)
    goal = (
        context.hands(at.noun)
        if at.noun is not None and at.noun.what in ("arm", "palm", "")
        else None
    )
    if goal is None or goal.both:
        raise Problem.of(f"a hand can follow the other hand, not {at.text!r}", at.words)
    (other,) = goal.sides
    who = roles.hand
    hands = (
        context.hands(who)
        if who is not None
        else Hands((opposite(other),), (), f"with the {opposite(other)} hand")
    )
    if hands.sides != (opposite(other),):
        raise Problem.of("a hand cannot follow itself", roles.clause.words)
    side = opposite(other)
    step = limb(
        hands, step_of(roles, "follow", side, to={"hand": f"{other}_arm", "away": 0.1}), side
    )
    step.because(at.words, "to", f"{other} hand")
    step.assume("10 cm from its palm")
    if roles.palm:
        step.parameters["palm"] = facing(roles.palm[-1], side, context)
        step.because(roles.palm[-1].words, "palm", str(step.parameters["palm"]))
    step.lasting = True
    context.put(side)
    context.last = (side,)
    return [[step]]


def _aim(roles: Roles, context: Context) -> Phrase:
    """The one thing that is looked at, pointed at or followed."""
    if len(roles.places) > 1:
        raise Problem.of(
            f"two things: {roles.places[0].text!r} and {roles.places[1].text!r}",
            roles.places[1].words,
        )
    if roles.places:
        return roles.places[0]
    if roles.object is None:
        raise Problem.of(f"{roles.verb!r} at what?", roles.clause.words)
    return Phrase("place", roles.object.words, noun=roles.object)


def _seen(phrase: Phrase, context: Context) -> tuple[Any, list[str]]:
    """A target: a hand, a landmark or a point."""
    noun = phrase.noun
    assert noun is not None
    if phrase.numbers:
        raise Problem.of(f"{phrase.text!r}: look or point at the thing itself", phrase.words)
    if noun.what == "thing" and noun.noun is not None:
        return {"point": list(noun.noun.entry.meaning["point"])}, ["where that is"]
    if noun.what in ("arm", "palm", "") or noun.pronoun is not None:
        hands = context.hands(noun)
        if hands.both:
            raise Problem.of(
                f"{phrase.text!r} could be your right hand or your left hand: say which",
                phrase.words,
            )
        context.last = hands.sides  # "look at your left hand while you wave it"
        return {"hand": f"{hands.sides[0]}_arm"}, [hands.assumed] if hands.assumed else []
    side = context.last[0] if len(context.last) == 1 else context.side("right")
    name, assumed = landmark(noun, side, context)
    return name, [assumed] if assumed else []


def _far(roles: Roles, side: str, context: Context) -> tuple[Any, list[str]]:
    """A point far away in a direction."""
    ways = [way for way in roles.ways if way.key != "there"]
    if not ways:
        raise Problem.of(f"{roles.verb!r} at what, or which way?", roles.clause.words)
    said, _ = direction(ways, side, context)
    vector = VECTORS[said] if isinstance(said, str) else said
    far = float(vocabulary().defaults["far"])
    return {"point": [plain(far * c) for c in vector]}, [f"{far:g} m away"]


def wait(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Let time pass, everything staying as it is: hold waist and neck."""
    step = Step(
        roles.clause,
        "hold",
        {"joints": ["waist", "neck"]},
        frozenset({"waist", "neck"}),
        lasting=True,
    )
    step.because(roles.clause.words[:1], "primitive", "hold")
    return [[step.assume("waist and neck stay; the arms hold their last goals")]]


def home(roles: Roles, sense: Sense, context: Context) -> Stages:
    """Back to the posture of rest, all of the body: get-posture."""
    for phrase in roles.places:
        if phrase.noun is None or phrase.noun.what != "start":
            raise Problem.of(f"{phrase.text!r}: go back there with what? name a hand", phrase.words)
    for way in roles.ways:
        if way.key != "rest":
            raise Problem.of(f"{_text(way.words)!r} has no meaning with {roles.verb!r}", way.words)
    joints = ["right_arm", "left_arm", "waist", "neck"]
    step = Step(
        roles.clause, "get-posture", {"joints": joints, "posture": "rest"}, frozenset(joints)
    )
    step.because(roles.clause.words, "posture", "rest")
    step.assume(
        "the posture of rest, with the whole body; to dance it again say 'Repeat everything'"
    )
    for side in SIDES:
        context.put(side, HANGING)
    context.both, context.turned = "", 0.0
    return [[step]]


def _text(words: tuple[Word, ...]) -> str:
    return " ".join(word.text for word in words)

"""What a clause means: the first sense of its verb that fits, and nothing left over."""

from collections.abc import Callable, Sequence

from specs.english import doing_arms, doing_body, doing_hands
from specs.english.context import Context
from specs.english.doing import Sense, Stages
from specs.english.places import convert
from specs.english.problems import Problem
from specs.english.roles import Roles, Way
from specs.english.sentences import Noun, Phrase, Word
from specs.english.timing import set_times
from specs.english.vocabulary import vocabulary

TIMES = {"time", "count", "rate", "most", "until", "together", "in_turn"}
# What each way of doing has a use for, besides times.
USES: dict[str, tuple[Callable[[Roles, Sense, Context], Stages], set[str]]] = {
    "arm": (doing_arms.arm, {"object", "hand", "ways", "palm", "elbow", "states", "angle"}),
    "rest": (doing_arms.rest, {"object", "hand", "ways", "palm", "elbow", "states"}),
    "elbow": (doing_arms.elbow, {"object", "hand", "angle", "states"}),
    "palm": (doing_arms.palm, {"object", "hand", "ways", "palm"}),
    "reach": (doing_hands.reach, {"object", "hand", "places", "palm"}),
    "tap": (doing_hands.tap, {"object", "hand", "places"}),
    "gather": (doing_hands.gather, {"object", "hand", "ways", "palm"}),
    "reach_to": (doing_hands.reach_to, {"object", "hand"}),
    "cross": (doing_hands.cross, {"object", "hand", "places"}),
    "press": (doing_hands.press, {"object", "hand", "ways", "places"}),
    "clap": (doing_hands.clap, {"object", "hand", "places", "ways"}),
    "relax": (doing_arms.relax, {"object", "hand"}),
    "hold": (doing_arms.hold, {"object", "hand", "ways"}),
    "turn": (doing_body.turn, {"object", "ways", "states", "angle"}),
    "turns": (doing_body.turns, {"object", "ways", "angle"}),
    "rhythm": (doing_body.rhythm, {"object", "hand", "ways", "angle"}),
    "look": (doing_body.look, {"object", "places"}),
    "point": (doing_body.point, {"object", "hand", "places", "ways"}),
    "follow": (doing_body.follow, {"object", "hand", "places", "palm"}),
    "wait": (doing_body.wait, {"ways"}),
    "home": (doing_body.home, {"places", "ways"}),
}
SIZED = {"elbow", "turn", "turns", "rhythm"}  # "a little" makes these smaller
TARGETED = {"look", "point", "follow"}
STILL = ("there",)


def stages_of(roles: Roles, context: Context) -> Stages:
    """The steps of a clause, in stages.

    Raises:
        Problem: the verb cannot be said of that, or words are left over.
    """
    senses = _senses(roles)
    _convert(roles, senses)
    sense = next((sense for sense in senses if _fits(sense, senses, roles)), None)
    if sense is None:
        raise _nothing_fits(roles, senses)
    does = sense["does"]
    act, uses = USES[does]
    _by_hand(roles, does, uses)
    stages = act(roles, sense, context)
    _nothing_left(roles, does, uses)
    for step in (step for stage in stages for step in stage):
        step.assume(str(sense.get("told", "")))
    for word in roles.manners:
        if "size" in word.entry.meaning:
            for step in (step for stage in stages for step in stage):
                step.because([word], "posture", f"{word.entry.meaning['size']:g} times as far")
    for way in roles.ways if does in ("hold", "wait") else ():
        for step in stages[-1]:
            step.because(way.words, "primitive", step.primitive)
    set_times(roles, stages, does, context)
    _nothing_dropped(roles, stages)
    return stages


def _by_hand(roles: Roles, does: str, uses: set[str]) -> None:
    """Only a hand does anything; a gaze follows."""
    noun = roles.hand
    if noun is None or noun.what in ("arm", "palm", "") or "hand" not in uses or does == "follow":
        return
    raise Problem.of(f"{roles.verb!r} is done with a hand, not with {_quoted(noun)}", noun.words)


def _senses(roles: Roles) -> Sequence[Sense]:
    verb = roles.clause.verb
    if verb is not None:
        found: Sequence[Sense] = verb.entry.meaning["senses"]
        return found
    if roles.object is None:
        raise Problem.of("what is to be done? a verb is missing", roles.clause.words)
    put: Sequence[Sense] = vocabulary().data["verbs"]["put"]["senses"]
    return put


def _convert(roles: Roles, senses: Sequence[Sense]) -> None:
    """Places that stand for directions, where the verb or an arm asks for one."""
    wanted = [
        s.get("with")
        for s in senses
        if s["of"] == "arm" and s.get("with") in ("place", "direction")
    ]
    posture = "direction" in wanted and wanted.index("direction") == 0
    whole = (
        roles.object is not None
        and roles.object.noun is not None
        and roles.object.noun.entry.key in ("arm", "forearm")
    )
    if any(s["does"] in TARGETED for s in senses) or not (
        posture or (whole and "direction" in wanted)
    ):
        return
    if roles.object is not None and roles.object.what == "thing":  # "reach for the sky"
        roles.places.append(Phrase("place", roles.object.words, noun=roles.object))
        roles.object = None
    for phrase in list(roles.places):
        key = convert(phrase)
        if key is not None:
            roles.places.remove(phrase)
            roles.ways.append(Way(key, phrase.words))


def _fits(sense: Sense, senses: Sequence[Sense], roles: Roles) -> bool:
    return _of(sense, senses, roles) and _with(sense, senses, roles)


def _of(sense: Sense, senses: Sequence[Sense], roles: Roles) -> bool:
    """Whether a sense is about what the verb is said of."""
    noun = roles.object
    what = "" if noun is None else noun.what
    match sense["of"]:
        case "nothing":
            return noun is None or (sense["does"] == "repeat")
        case "both":
            return noun is not None and what in ("arm", "palm", "") and _plural(noun)
        case "arm":
            if noun is None:
                return roles.hand is not None or all(s["of"] != "nothing" for s in senses)
            return what in ("arm", "palm", "")
        case "place":
            if noun is None or noun.noun is None:
                it = noun is not None and noun.pronoun is not None and roles.hand is not None
                return it or (noun is not None and sense["does"] in TARGETED)
            known = {"place", "parts", "point"} & noun.noun.entry.meaning.keys()
            hand = what in ("arm", "palm") and bool(noun.side) and not noun.plural
            return bool(known) or hand or sense["does"] in TARGETED or roles.hand is not None
        case kind:
            return bool(what == kind)
    return False


def _plural(noun: Noun) -> bool:
    return noun.plural or (noun.pronoun is not None and noun.pronoun.entry.key == "them")


def _with(sense: Sense, senses: Sequence[Sense], roles: Roles) -> bool:
    """Whether all is said that a sense needs."""
    match sense.get("with"):
        case "place" | "target":
            return bool(roles.places)
        case "direction":
            usual = any("arm" in s or s["does"] == "rest" for s in senses if "with" not in s)
            # "raise your arm, palm in": up
            return any(way.key not in STILL for way in roles.ways) or bool(
                roles.palm and roles.object and not usual
            )
        case "return":
            return [way.key for way in roles.ways] == ["back"] and _text(
                roles.ways[0].words
            ).lower() == "back"
        case "inward":
            return [way.key for way in roles.ways] == ["in"]
        case "together":
            return any(way.key == "together" for way in roles.ways)
        case "state":
            return bool(roles.states)
        case "time":
            return roles.time is not None
        case "order":
            return bool(doing_body.order(roles))
        case "swing":
            ways = doing_body.to_and_fro(roles.ways)
            half_swings = len([way for way in ways if way.key in ("left", "right")]) > 1
            swaying = any(way.key in doing_body.SWINGING for way in ways)
            return half_swings or swaying or roles.count is not None or roles.rate is not None
    return True


def _nothing_fits(roles: Roles, senses: Sequence[Sense]) -> Problem:
    """What the verb could be said of, or what is missing."""
    able = list(dict.fromkeys(str(s["of"]) for s in senses))
    named = {
        "both": "both arms",
        "nothing": "nothing",
        "arm": "an arm or hand",
        "place": "a place of the body",
    }
    shown = " or ".join(named.get(what, f"the {what}") for what in able)
    matching = [s for s in senses if _of(s, senses, roles)]
    if matching:
        needs = " or ".join(dict.fromkeys(f"a {s['with']}" for s in matching if "with" in s))
        example = {"a place": " such as 'to your head'", "a direction": " such as 'forward'"}.get(
            needs, ""
        )
        return Problem.of(f"{roles.verb!r} needs {needs}{example}", roles.clause.words)
    noun = roles.object
    said = _quoted(noun) if noun is not None else "nothing"
    words = noun.words if noun is not None else roles.clause.words
    return Problem.of(f"{roles.verb!r} is said of {shown}, not of {said}", words)


def _nothing_left(roles: Roles, does: str, uses: set[str]) -> None:
    """Every word has done something."""
    if roles.tempo is not None:
        raise Problem.of("the tempo is said in a sentence of its own", roles.tempo.words)
    used = uses | TIMES | {"manners"}
    for words in roles.unused(used):
        raise Problem.of(f"{_text(words)!r} has no meaning with {roles.verb!r}", words)
    for word in roles.manners:
        if "size" in word.entry.meaning and does not in SIZED:
            raise Problem.of(f"{word.text!r} has no meaning with {roles.verb!r}", [word])
        if "size" in word.entry.meaning and roles.angle is not None:
            raise Problem.of(
                f"{word.text!r} or {_text(roles.angle.words)!r}: which of them?", [word]
            )
    if does in ("hold", "wait"):
        for way in roles.ways:
            if way.key not in STILL:
                raise Problem.of(
                    f"{_text(way.words)!r} has no meaning with {roles.verb!r}", way.words
                )


def _nothing_dropped(roles: Roles, stages: Stages) -> None:
    """Every word is the reason of something that a step does; else it is refused."""
    told = {
        word
        for stage in stages
        for step in stage
        for reason in step.reasons
        for word in reason.words
    }
    for way in roles.ways:
        if way.key in STILL and not told.issuperset(way.words):  # "hold it out there"
            stages[-1][0].because(way.words, "posture", "stays so")
            told |= set(way.words)
    for words in roles.unused({"together"}):  # which is for the order of clauses
        if not told.issuperset(words):
            raise Problem.of(f"{_text(words)!r} has no meaning with {roles.verb!r}", words)


def _quoted(noun: Noun) -> str:
    return repr(_text(noun.words))


def _text(words: Sequence[Word]) -> str:
    return " ".join(word.text for word in words)

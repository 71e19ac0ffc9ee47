"""What each phrase of a clause is to its verb: whom it moves, where, which way, how long."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from specs.english.problems import Problem
from specs.english.sentences import Clause, Condition, Noun, Phrase, Word

LIMBS = ("arm", "palm", "elbow")


@dataclass(frozen=True)
class Way:
    """A direction, and the words that say it."""

    key: str
    words: tuple[Word, ...]


@dataclass(frozen=True)
class Amount:
    """A number, perhaps of some unit, and the words that say it."""

    number: float
    words: tuple[Word, ...]
    unit: Word | None = None


@dataclass
class Roles:
    """A clause, sorted. Whatever nobody uses is a problem."""

    clause: Clause
    object: Noun | None = None
    hand: Noun | None = None  # with which it is done
    places: list[Phrase] = field(default_factory=list)
    ways: list[Way] = field(default_factory=list)
    palm: list[Way] = field(default_factory=list)
    elbow: list[Way] = field(default_factory=list)
    states: list[Way] = field(default_factory=list)
    angle: Amount | None = None
    time: Amount | None = None
    count: Amount | None = None
    rate: Amount | None = None  # beats for once
    manners: list[Word] = field(default_factory=list)
    most: Amount | None = None
    until: Condition | None = None
    steps: list[Phrase] = field(default_factory=list)
    together: tuple[Word, ...] = ()
    in_turn: tuple[Word, ...] = ()
    tempo: Amount | None = None

    @property
    def verb(self) -> str:
        """The verb as it was said."""
        return self.clause.verb.text if self.clause.verb else self.clause.text

    def unused(self, used: set[str]) -> Iterator[tuple[Word, ...]]:
        """Words of each role that a sense has no use for."""
        for name in ("places", "ways", "palm", "elbow", "states", "manners", "steps"):
            for part in getattr(self, name) if name not in used else ():
                yield (part,) if isinstance(part, Word) else part.words
        for name in ("object", "hand", "angle", "time", "count", "rate", "most", "until", "tempo"):
            part = getattr(self, name)
            if part is not None and name not in used:
                yield part.words
        for name in ("together", "in_turn"):
            if getattr(self, name) and name not in used:
                yield getattr(self, name)


def sort(clause: Clause) -> Roles:
    """The roles of a clause.

    Raises:
        Problem: two things that cannot both be meant.
    """
    roles = Roles(clause, object=clause.subject)
    aspect: Noun | None = None  # palm or elbow, if directions are about that
    aspects: list[tuple[Noun, Phrase]] = []
    for phrase in clause.phrases:
        match phrase.kind:
            case "thing" | "place":
                before, aspect = aspect, _thing(roles, phrase, aspect)
                if aspect is not None and aspect is not before:
                    aspects.append((aspect, phrase))
            case "direction":
                _way(roles, Way(phrase.key, phrase.words), aspect)
            case "state":
                if aspect is not None and aspect.what == "elbow":
                    _way(roles, Way(phrase.key, phrase.words), aspect)
                else:
                    roles.states.append(Way(phrase.key, phrase.words))
            case "separator":
                aspect = aspect if not _filled(roles, aspect) else None
            case "manner":
                roles.manners += phrase.words
            case "amount":
                _amount(roles, phrase, aspect)
            case "tempo":
                if phrase.unit is not None and phrase.unit.entry.meaning["of"] != "tempo":
                    raise Problem.of("a tempo is so many beats per minute", phrase.words)
                _set(roles, "tempo", Amount(phrase.numbers[0], phrase.words))
            case "count":
                _set(roles, "count", Amount(phrase.numbers[0], phrase.words))
            case "rate":
                _set(roles, "rate", Amount(_beats(phrase), phrase.words))
            case "most":
                _set(roles, "most", Amount(phrase.numbers[0], phrase.words, phrase.unit))
            case "until":
                if roles.until is not None:
                    raise Problem.of("there are two things to wait for", phrase.words)
                roles.until = phrase.condition
            case "when":
                pass  # the whole sentence waits for it
            case "step" if _without_unit(phrase):
                number = phrase.words[-1].text
                raise Problem.of(
                    f"{phrase.text!r}: {number} what? say '{number} times', 'for {number} beats' or"
                    f" 'for {number} seconds'",
                    phrase.words,
                )
            case "step" | "last":
                roles.steps.append(phrase)
            case "together":
                roles.together = phrase.words
            case "in_turn":
                roles.in_turn = phrase.words
    for noun, phrase in aspects:
        _no_aspect(roles, noun, phrase)
    return roles


def _without_unit(phrase: Phrase) -> bool:
    """Whether it is a time that lacks its unit: "for two"."""
    preposition = phrase.preposition
    return preposition is not None and preposition.entry.key == "for" and len(phrase.words) == 2


def _no_aspect(roles: Roles, noun: Noun, phrase: Phrase) -> None:
    """A palm or an elbow of which nothing was said is what the clause is done with."""
    ways: list[Way] = getattr(roles, noun.what)
    if any(way.words[: len(noun.words)] == noun.words for way in ways):
        return
    if phrase.preposition is None:
        raise Problem.of(f"{phrase.text!r}: how? nothing is said of it", phrase.words)
    if roles.hand is not None:
        raise Problem.of("two hands are named to do it with", phrase.words)
    roles.hand = noun


def _thing(roles: Roles, phrase: Phrase, aspect: Noun | None) -> Noun | None:
    """A noun phrase, perhaps after a preposition; returns what directions are about now."""
    noun, preposition = phrase.noun, phrase.preposition
    if noun is None:
        return aspect
    relation = preposition.entry.key if preposition else ""
    if aspect is not None and noun.what == "thing" and noun.noun is not None:
        ways = noun.noun.entry.meaning["as"]  # "the palm facing the floor"
        _way(roles, Way(str(ways["toward"]), phrase.words), aspect)
        return None
    if not noun.what and not noun.pronoun:
        return _bare(roles, phrase, noun, relation, aspect)
    if relation == "with":
        if phrase.numbers:
            raise Problem.of(f"{phrase.text!r} has no meaning", phrase.words)
        if noun.what in ("palm", "elbow"):
            return noun
        if roles.hand is not None:
            raise Problem.of("two hands are named to do it with", phrase.words)
        roles.hand = noun
        return None
    if relation:
        roles.places.append(phrase)
        return None
    given, aside = roles.object, noun.what in ("palm", "elbow")
    if given is not None and given is roles.clause.subject and roles.hand is None and not aside:
        roles.hand, roles.object = given, noun  # "let your hand touch …"
        return None
    if aside and given is not None and (given.what == "arm" or given.pronoun is not None):
        return noun
    if roles.object is None:
        roles.object = noun
    elif roles.object.what == "palm" and noun.what == "arm":  # "Palm down, extend your arm"
        roles.palm, roles.ways, roles.object = roles.ways, [], noun
    elif roles.object.what == noun.what == "arm" and not roles.object.both:
        roles.object = replace(roles.object, both=True, words=(*roles.object.words, *noun.words))
    else:
        raise Problem.of(
            f"what is {phrase.text!r} to do here, beside {_text(roles.object)!r}?", phrase.words
        )
    return None


def _bare(
    roles: Roles, phrase: Phrase, noun: Noun, relation: str, aspect: Noun | None
) -> Noun | None:
    """A phrase without a noun: "to the left" is a direction, "your left" and "both" an arm."""
    verb = roles.clause.verb
    if noun.side and verb is not None and verb.entry.key == "repeat":
        roles.hand = noun  # "do the same on the left"
        return None
    alone = noun.side and not (noun.other or noun.both)
    on = phrase.preposition is not None and phrase.preposition.text.lower().endswith("on")
    towards = relation in ("to", "toward", "for", "from") and not on
    if noun.side and alone and (towards or (not relation and noun.words[0].kind == "SIDE")):
        measure = phrase.words[: 2 * len(phrase.numbers)]
        if measure:  # "45 degrees to the left"
            _amount(roles, replace(phrase, words=measure), aspect)
        _way(roles, Way(noun.side, phrase.words[len(measure) :]), aspect)
        return aspect
    if relation == "with" and (noun.side or noun.other or noun.both):
        roles.hand = noun
    elif not relation and (noun.side or noun.other or noun.both) and roles.object is None:
        roles.object = noun
    else:
        raise Problem.of(f"{phrase.text!r}: of what? a part of the body is missing", phrase.words)
    return None


def _way(roles: Roles, way: Way, aspect: Noun | None) -> None:
    if aspect is None:
        roles.ways.append(way)
    else:
        getattr(roles, aspect.what).append(Way(way.key, (*aspect.words, *way.words)))


def _filled(roles: Roles, aspect: Noun | None) -> bool:
    return aspect is not None and bool(getattr(roles, aspect.what))


def _amount(roles: Roles, phrase: Phrase, aspect: Noun | None) -> None:
    """A measure: a time, an angle, the tempo."""
    unit = phrase.unit
    kind = unit.entry.meaning["of"] if unit else ""
    amount = Amount(phrase.numbers[0], phrase.words, unit)
    if kind == "angle" and aspect is not None and aspect.what == "elbow":
        _way(roles, Way(f"{phrase.numbers[0]:g}", phrase.words), aspect)
    elif kind == "length":
        raise Problem.of(
            f"{phrase.text!r} from where? say a place, such as '10 cm above your head'",
            phrase.words,
        )
    else:
        _set(roles, {"time": "time", "angle": "angle", "tempo": "tempo"}[kind], amount)


def _set(roles: Roles, name: str, amount: Amount) -> None:
    if getattr(roles, name) is not None:
        before = " ".join(map(str, getattr(roles, name).words))
        raise Problem.of(
            f"{' '.join(map(str, amount.words))!r} after {before!r}: which of them?", amount.words
        )
    setattr(roles, name, amount)


def _beats(phrase: Phrase) -> float:
    """Beats for once: "every two beats" is 2, "twice a beat" is 0.5."""
    kinds = [word.kind for word in phrase.words]
    unit: Mapping[str, float] = phrase.unit.entry.meaning if phrase.unit else {}
    if "seconds" in unit:
        raise Problem.of("a rhythm goes by beats: say 'every two beats'", phrase.words)
    number = phrase.numbers[0] if phrase.numbers else 1.0
    if number <= 0:
        raise Problem.of("a rhythm needs a number above zero", phrase.words)
    if "COUNT" in kinds or "TIMES" in kinds:
        return 1.0 / number
    return number * float(unit.get("beats", 1.0))


def _text(noun: Noun) -> str:
    return " ".join(word.text for word in noun.words)


def split(clause: Clause) -> list[Clause]:
    """One clause for each thing that its verb is said of.

    "Put your right hand on your head and your left hand on your hip" are two, and so are
    "touch your head and your hips".
    """
    parts: list[list[Phrase]] = [[]]
    for phrase in clause.phrases:
        if phrase.kind == "separator":
            parts.append([])
        else:
            parts[-1].append(phrase)
    made: list[Clause] = []
    for part in parts:
        first = made[0] if made else None
        if first is None:
            made.append(replace(clause, phrases=tuple(part)))
        elif _again(first.phrases, part):
            words = tuple(word for phrase in part for word in phrase.words)
            made.append(Clause(words, tuple(part), clause.verb, None, "and"))
        elif (place := _another_place(first.phrases, part)) is not None:
            kept = tuple(p for p in first.phrases if not _is_place(p))
            rest = tuple(p for p in part if not _is_place(p))
            words = tuple(word for phrase in part for word in phrase.words)
            made.append(Clause(words, (*kept, place, *rest), clause.verb, clause.subject, "then"))
        else:
            mark = Phrase("separator", ())
            made[-1] = replace(made[-1], phrases=(*made[-1].phrases, mark, *part))
    return made


def _is_limb(phrase: Phrase) -> bool:
    return phrase.kind == "thing" and phrase.noun is not None and phrase.noun.what == "arm"


def _is_place(phrase: Phrase) -> bool:
    noun = phrase.noun
    if noun is None or noun.what == "palm" or phrase.kind not in ("thing", "place"):
        return False
    if not noun.what:
        return noun.pronoun is not None and phrase.kind == "place"
    if phrase.preposition is not None and phrase.preposition.entry.key in ("with", "for"):
        return False
    return phrase.kind == "place" or noun.what not in LIMBS


def _again(first: tuple[Phrase, ...], part: list[Phrase]) -> bool:
    """Whether a part names another arm and says where that goes."""
    goes = [any(_is_place(p) or p.kind == "direction" for p in side) for side in (first, part)]
    return any(map(_is_limb, first)) and any(map(_is_limb, part)) and all(goes)


def _another_place(first: tuple[Phrase, ...], part: list[Phrase]) -> Phrase | None:
    """A further place for what the first part did, said the same way."""
    old = next((p for p in first if _is_place(p)), None)
    new = next((p for p in part if _is_place(p)), None)
    if old is None or new is None or any(map(_is_limb, part)):
        return None
    if old.noun is not None and old.noun.what in ("hip", "hips", "trunk") and old.kind == "thing":
        return None
    if new.kind == "thing" and old.kind == "place":
        return replace(new, kind="place", preposition=old.preposition)
    return new if new.kind == old.kind else None


__all__ = ["Amount", "Roles", "Way", "sort", "split"]

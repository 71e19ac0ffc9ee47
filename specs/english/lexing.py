"""Raw words become words that mean something: the longest that the vocabulary knows."""

from collections.abc import Sequence
from functools import lru_cache

from specs.english.problems import Problem
from specs.english.sentences import Raw, Word
from specs.english.vocabulary import FILLER, Entry, vocabulary

QUOTES = '"“”'
MARKS = dict.fromkeys(",():/", "comma") | dict.fromkeys("–—-", "dash")
STRENGTH = ("comma", "comma-and", "and", "together", "then", "while")  # of links, rising
NOUN_LIKE = ("DETERMINER", "SIDE", "PREPOSITION", "PART", "BOTH", "OTHER", "SOME")
LARGEST = 1e6


def words_of(raws: Sequence[Raw]) -> tuple[list[Word], list[Word], list[Problem]]:
    """The words of a sentence, the fillers among them, and those that nobody knows."""
    found: list[tuple[tuple[Raw, ...], tuple[Entry, ...], float]] = []
    problems: list[Problem] = []
    raws = _split(raws)
    texts = [raw.text.lower().replace("’", "'") for raw in raws]
    i = 0
    while i < len(raws):
        raw = raws[i]
        if raw.text[0] in QUOTES:
            found.append(((raw,), (_signal(raw, problems),), 0.0))
        elif raw.text[0].isdecimal():
            found.append(((raw,), (Entry("NUMBER", raw.text),), _number(raw, problems)))
        elif raw.text in MARKS:
            kind = "DASH" if MARKS[raw.text] == "dash" else "MARK"
            found.append(((raw,), (Entry(kind, raw.text),), 0.0))
        else:
            length, entries = _longest(texts, i)
            if entries:
                number = float(entries[0].key) if entries[0].kind == "NUMBER" else 0.0
                found.append((tuple(raws[i : i + length]), entries, number))
                i += length - 1
            else:
                wanted = _wanted(found[-1] if found else None, problems, raw)
                said = f"unknown word {_short(raw.text)!r}"
                problems.append(Problem(said, (raw,), unknown=raw.text, wanted=wanted))
        i += 1
    words, fillers = _chosen(found)
    cannot: set[str] = set()
    for word in words:
        if word.kind == "CANNOT" and word.entry.key not in cannot:
            cannot.add(word.entry.key)
            why = word.entry.meaning["why"]
            problems.append(Problem.of(f"{word.text!r} cannot be done: {why}", [word]))
    return _linked(words), fillers, problems


def _wanted(
    before: tuple[tuple[Raw, ...], tuple[Entry, ...], float] | None,
    problems: Sequence[Problem],
    raw: Raw,
) -> str:
    """The class of word that a place in a sentence is for, if that is clear."""
    if problems and problems[-1].raws[-1].line == raw.line:
        after = problems[-1].raws[-1].column
        if before is None or before[0][-1].column < after:
            return ""  # what stands before is not known either
    if before is None:
        return "VERB"
    kinds = {entry.kind for entry in before[1]}
    if kinds & {"MARK", "LINKING"}:
        return "VERB"
    return "NOUN" if kinds & {*NOUN_LIKE} else ""


def _split(raws: Sequence[Raw]) -> list[Raw]:
    """Hyphenated words that are not known as a whole, in their parts."""
    known, found = vocabulary().entries, []
    for raw in raws:
        text = raw.text.lower().replace("’", "'")
        if "-" not in text or len(text) == 1 or text in known or raw.text[0] in QUOTES:
            found.append(raw)
            continue
        column = raw.column
        for part in raw.text.split("-"):
            found.append(Raw(part, raw.line, column))
            column += len(part) + 1
    return found


def _longest(texts: Sequence[str], i: int) -> tuple[int, tuple[Entry, ...]]:
    """How many words from the i-th on are known together, and what they mean."""
    known = vocabulary()
    for length in range(min(known.longest.get(texts[i], 0), len(texts) - i), 0, -1):
        entries = known.entries.get(" ".join(texts[i : i + length]) if length > 1 else texts[i], ())
        if entries and texts[i + length : i + length + 1] == ["of"]:
            # "to the side of your head" is a place, "to the side" a direction
            entries = tuple(entry for entry in entries if entry.kind != "DIRECTION")
        if entries:
            return length, entries
    return 1, ()


def _chosen(
    found: list[tuple[tuple[Raw, ...], tuple[Entry, ...], float]],
) -> tuple[list[Word], list[Word]]:
    """Of words with several meanings the one that fits here; fillers apart."""
    words: list[Word] = []
    fillers: list[Word] = []
    has_verb = False
    for k, (raws, entries, number) in enumerate(found):
        entry = entries[0]
        following = found[k + 1][1][0].kind if k + 1 < len(found) else ""
        if len(entries) > 1:
            entry = _fitting(entries, words, following, has_verb)
        word = Word(entry.kind, raws, entry, number)
        if entry.kind == FILLER:
            fillers.append(word)
            continue
        if entry.kind == "NUMBER" and number in (1.0, 2.0) and following == "NOUN":
            word = Word("SOME" if number == 1.0 else "BOTH", raws, entry, number)
        has_verb = has_verb or entry.kind == "VERB"
        if entry.kind in ("LINKING", "MARK") and entry.key != "comma":
            has_verb = has_verb and entry.kind == "MARK"
        words.append(word)
    return words, fillers


def _fitting(
    entries: tuple[Entry, ...], words: Sequence[Word], following: str, has_verb: bool
) -> Entry:
    """The meaning that fits between the words before and the one that follows."""
    before = words[-1] if words else None
    kinds = {entry.kind: entry for entry in reversed(entries)}
    nominal = before is not None and before.kind in NOUN_LIKE
    of_palm = before is not None and before.kind == "NOUN" and before.entry.key in ("palm", "elbow")
    if "STEP" in kinds and "CANNOT" in kinds:  # "repeat the last two steps", "two steps back"
        counted = following == "NUMBER" or "LAST" in [word.kind for word in words[-2:]]
        return kinds["STEP" if counted else "CANNOT"]
    if "UNIT" in kinds and before is not None and before.kind == "NUMBER":
        return kinds["UNIT"]
    if FILLER in kinds and "VERB" in kinds and (has_verb or of_palm):  # "palm facing down"
        return kinds[FILLER]
    if "VERB" in kinds and not nominal and not has_verb:
        return kinds["VERB"]
    if "LINKING" in kinds and following in ("VERB", "LET"):
        return kinds["LINKING"]
    if "NOUN" in kinds and "DIRECTION" in kinds:  # "your back", "forward and back"
        return kinds["NOUN" if nominal else "DIRECTION"]
    if "WHEN" in kinds and before is None and following == "SIGNAL":
        return kinds["WHEN"]
    for kind in ("BOTH", "DETERMINER"):
        if kind in kinds and ("PRONOUN" in kinds or "DIRECTION" in kinds):
            nouns = ("NOUN", "DETERMINER", "SIDE", "PART", "OTHER", "BOTH", "STEP")
            return kinds[kind] if following in nouns else next(e for e in entries if e.kind != kind)
    if "DIRECTION" in kinds and "PREPOSITION" in kinds:
        after = ("NOUN", "PRONOUN", "DETERMINER", "SIDE", "PART", "NUMBER", "BOTH", "OTHER")
        return kinds["PREPOSITION" if following in after else "DIRECTION"]
    rest = [entry for entry in entries if entry.kind not in ("VERB", "WHEN", "LINKING", FILLER)]
    return rest[0] if rest else entries[0]


def _linked(words: list[Word]) -> list[Word]:
    """Runs of separators as one word each: LINK where a clause follows, else SEP."""
    result: list[Word] = []
    i = 0
    while i < len(words):
        run = i
        while run < len(words) and _separates(words, run):
            run += 1
        if run == i:
            result.append(words[i])
            i += 1
            continue
        raws = tuple(raw for word in words[i:run] for raw in word.raws)
        key = _strongest(words[i:run])
        follows = _clause_follows(words, run)
        if key in ("then", "while") or (follows and (key != "comma" or result)):
            result.append(Word("LINK", raws, Entry("LINK", key)))
        elif result and run < len(words):
            result.append(Word("SEP", raws, Entry("SEP", key)))
        i = run
    return result


def _separates(words: list[Word], i: int) -> bool:
    word = words[i]
    if word.kind in ("MARK", "LINKING"):
        return True
    if word.kind == "DASH":
        return not (0 < i < len(words) - 1 and words[i + 1].kind == "NUMBER")
    if word.kind != "TOGETHER":
        return False
    set_off = 0 < i < len(words) - 1 and {words[i - 1].kind, words[i + 1].kind} <= {
        "MARK",
        "LINKING",
    }
    return _clause_follows(words, i + (2 if set_off else 1))


def _strongest(words: list[Word]) -> str:
    keys = [
        "together"
        if w.kind == "TOGETHER"
        else "comma"
        if w.kind in ("MARK", "DASH")
        else w.entry.key
        for w in words
    ]
    if "and" in keys and "comma" in keys:
        keys.append("comma-and")
        keys.remove("and")
    return max(keys, key=STRENGTH.index)


def _clause_follows(words: list[Word], i: int) -> bool:
    """Whether a new clause begins there: a verb, perhaps with manner before it."""
    while i < len(words) and words[i].kind in ("MANNER", "TOGETHER"):
        i += 1
    return i < len(words) and words[i].kind in ("VERB", "LET")


def _number(raw: Raw, problems: list[Problem]) -> float:
    try:
        number = float(raw.text)
    except ValueError:  # digits that Python does not count with
        number = LARGEST * 2
    if number > LARGEST:
        problems.append(Problem(f"{_short(raw.text)} is no number to work with", (raw,)))
    return min(number, LARGEST)


def _signal(raw: Raw, problems: list[Problem]) -> Entry:
    """A signal in quotes, by a name that a task can use."""
    name = raw.text.strip(QUOTES + ".,!? ").replace(" ", "-")
    if not (
        name.replace("-", "").isascii() and name.replace("-", "").isalnum() and len(name) <= 80
    ):
        problems.append(Problem('a signal is called by words, such as "go"', (raw,)))
        name = "signal"
    return Entry("SIGNAL", name)


@lru_cache(maxsize=1)
def classes() -> dict[str, str]:
    """What a person would call each class of word."""
    return {
        "VERB": "a verb", "NOUN": "a part of the body", "PRONOUN": "'it'",
        "UNIT": "a unit such as 'beats' or 'cm'",
        "NUMBER": "a number", "DIRECTION": "a direction", "SIGNAL": "a signal such as \"go\"",
        "PREPOSITION": "a word such as 'to' or 'in front of'", "SIDE": "'left' or 'right'",
        "TIMES": "'times'", "LINK": "'and' or 'then'",
    }  # fmt: skip


def _short(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."

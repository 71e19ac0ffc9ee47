"""The words that are understood, from `vocabulary.yaml`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files
from typing import Any

from specs.reading import read_text

# The class of word that the grammar knows each section by.
CLASSES = {
    "verbs": "VERB",
    "nouns": "NOUN",
    "parts": "PART",
    "sides": "SIDE",
    "both": "BOTH",
    "others": "OTHER",
    "determiners": "DETERMINER",
    "pronouns": "PRONOUN",
    "prepositions": "PREPOSITION",
    "directions": "DIRECTION",
    "states": "STATE",
    "manners": "MANNER",
    "together": "TOGETHER",
    "inturn": "INTURN",
    "counts": "COUNT",
    "times": "TIMES",
    "rates": "RATE",
    "every": "EVERY",
    "most": "MOST",
    "last": "LAST",
    "steps": "STEP",
    "units": "UNIT",
    "tempos": "TEMPO",
    "numbers": "NUMBER",
    "links": "LINKING",
    "let": "LET",
    "when": "WHEN",
    "if": "IF",
    "until": "UNTIL",
    "signals": "SIGNAL",
    "cannot": "CANNOT",
}
FILLER = "FILLER"
VOWELS = "aeiou"


@dataclass(frozen=True)
class Entry:
    """What some words mean: their class, the key they stand under, and what is said there."""

    kind: str
    key: str
    meaning: Mapping[str, Any] = field(default_factory=dict, hash=False, compare=False)
    plural: bool = False


@dataclass(frozen=True)
class Vocabulary:
    """All that `vocabulary.yaml` says."""

    data: Mapping[str, Any]
    entries: Mapping[str, tuple[Entry, ...]]  # by words, as they are said
    longest: Mapping[str, int]  # by a first word, the most words that follow each other

    @property
    def defaults(self) -> Mapping[str, Any]:
        """What a lesson gets without asking."""
        found: Mapping[str, Any] = self.data["defaults"]
        return found

    def known(self, kind: str = "") -> list[str]:
        """All single words that have an effect, or those of a class, to find the nearest."""
        useful = (
            words
            for words, found in self.entries.items()
            if (
                any(e.kind == kind for e in found) if kind else found[0].kind not in (FILLER, "LET")
            )
        )
        return sorted({word for words in useful for word in words.split()})

    def parts(self) -> list[str]:
        """The parts of the body, and the things beside it."""
        return [
            key for key, noun in self.data["nouns"].items() if noun["is"] not in ("start", "all")
        ]

    def phrases(self, word: str) -> list[str]:
        """What is said with a word that means nothing alone, the first forms only."""
        found: dict[tuple[str, str, int], str] = {}
        for words, (entry, *_) in self.entries.items():
            parts = words.split()
            if len(parts) > 1 and word.lower() in parts and entry.kind != FILLER:
                found.setdefault((entry.kind, entry.key, parts.index(word.lower())), words)
        return list(found.values())


@lru_cache(maxsize=1)
def vocabulary() -> Vocabulary:
    """The vocabulary, read once."""
    source = files("specs.english") / "vocabulary.yaml"
    data = read_text(source.read_text(encoding="utf-8"), "vocabulary.yaml").data
    entries: dict[str, list[Entry]] = {}
    longest: dict[str, int] = {}
    for words, entry in _said(data):
        found = entries.setdefault(words, [])
        if entry not in found:
            found.append(entry)
        first, *rest = words.split()
        longest[first] = max(longest.get(first, 1), 1 + len(rest))
    return Vocabulary(data, {words: tuple(found) for words, found in entries.items()}, longest)


def _said(data: Mapping[str, Any]) -> Iterator[tuple[str, Entry]]:
    """Everything that can be said, in each of its forms."""
    for section, kind in CLASSES.items():
        for key, meaning in data[section].items():
            entry = Entry(kind, key, meaning)
            for words in meaning["words"]:
                yield words, entry
                if kind == "VERB":
                    for form in _forms(words):
                        yield form, entry
                if kind == "NOUN" and "plural" not in meaning:
                    yield plural(words), Entry(kind, key, meaning, plural=True)
                if kind in ("UNIT", "STEP") and len(words) > 1 and key != "tempo":
                    yield plural(words), entry
            for words in meaning.get("plural", ()):
                yield words, Entry(kind, key, meaning, plural=True)
    for words in data["fillers"]:
        yield words, Entry(FILLER, words)


def plural(words: str) -> str:
    """Several of them."""
    if words.endswith("s"):
        return words
    return words + ("es" if words.endswith(("ch", "sh", "x")) else "s")


def _forms(words: str) -> tuple[str, str]:
    """A verb with -s and with -ing: touches, touching."""
    verb, *rest = words.split()
    third = verb + ("es" if verb.endswith(("ch", "sh", "x", "s", "o")) else "s")
    stem = verb
    if verb.endswith("e") and not verb.endswith("ee"):
        stem = verb[:-1]
    elif (
        len(verb) < 6
        and verb[-1] not in (*VOWELS, "w", "x", "y")
        and verb[-2] in VOWELS
        and verb[-3:-2] not in (*VOWELS, "")
    ):
        stem = verb + verb[-1]
    return " ".join([third, *rest]), " ".join([stem + "ing", *rest])

"""What a sentence is made of: words with their places, phrases, clauses."""

from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

from specs.english.vocabulary import Entry
from specs.errors import Position


class Raw(NamedTuple):
    """A piece of text and where it stands; columns are counted from 1."""

    text: str
    line: int
    column: int

    @property
    def end(self) -> int:
        """The column behind it."""
        return self.column + len(self.text)

    @property
    def position(self) -> Position:
        """Where it begins."""
        return Position(self.line, self.column)


@dataclass
class Sentence:
    """A sentence of a lesson: its words, and the number that was written before it."""

    words: list[Raw]
    number: int | None = None
    opens: bool = False  # whether it is the first of its item


@dataclass(frozen=True)
class Word:
    """One or more raw words that mean one thing."""

    kind: str  # class of word, as the grammar calls it
    raws: tuple[Raw, ...]
    entry: Entry
    number: float = 0.0  # of a number

    @cached_property
    def text(self) -> str:
        """As it was written."""
        return " ".join(raw.text for raw in self.raws)

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Noun:
    """A noun phrase: "the left side of your ribs", "both arms", "it"."""

    words: tuple[Word, ...]
    noun: Word | None = None
    pronoun: Word | None = None
    side: str | None = None  # left, right
    both: bool = False
    other: bool = False
    some: bool = False  # one of them, whichever
    part: str | None = None  # top, back, front, inside, side

    @property
    def what(self) -> str:
        """The kind of thing that it is: arm, palm, head, place …; nothing for a bare side."""
        return "" if self.noun is None else str(self.noun.entry.meaning["is"])

    @property
    def plural(self) -> bool:
        """Whether it is more than one."""
        return self.both or (self.noun is not None and self.noun.entry.plural)


@dataclass(frozen=True)
class Phrase:
    """A part of a clause. What it holds depends on its kind: see `grammar.lark`."""

    kind: str
    words: tuple[Word, ...]
    noun: Noun | None = None
    preposition: Word | None = None
    numbers: tuple[float, ...] = ()
    unit: Word | None = None
    condition: "Condition | None" = None

    @property
    def text(self) -> str:
        """As it was written."""
        return said(self.words)

    @property
    def key(self) -> str:
        """What its one word means."""
        return self.words[0].entry.key


@dataclass(frozen=True)
class Condition:
    """Something to wait for: a signal, or a hand that is near a place."""

    words: tuple[Word, ...]
    signal: Word | None = None
    hand: Noun | None = None
    place: Noun | None = None
    distance: tuple[float, Word] | None = None


@dataclass(frozen=True)
class Clause:
    """One verb and what goes with it; `link` is how it is tied to the clause before."""

    words: tuple[Word, ...]
    phrases: tuple[Phrase, ...]
    verb: Word | None = None
    subject: Noun | None = None  # "let your arms hang"
    link: str = ""  # "", then, and, comma, together, while
    beside: bool = False  # said with "while": lasts as long as the rest of the sentence

    @property
    def text(self) -> str:
        """As it was written."""
        return said(self.words)


@dataclass(frozen=True)
class Parsed:
    """A whole sentence, understood as far as grammar goes."""

    clauses: tuple[Clause, ...]
    when: tuple[str, Condition] | None = None  # `when` or `if`, and what
    fillers: tuple[Word, ...] = field(default=())


def said(words: tuple[Word, ...]) -> str:
    """Words as they were written, spaces where there were any."""
    raws = [raw for word in words for raw in word.raws]
    parts = [raws[0].text] if raws else []
    for before, raw in pairwise(raws):
        touching = before.line == raw.line and before.end == raw.column
        parts.append(raw.text if touching else f" {raw.text}")
    return "".join(parts)

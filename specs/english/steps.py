"""Steps of a dance before they have a name, and the reasons for what they are."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from specs.english.sentences import Clause, Word

SIDES = ("right", "left")


@dataclass(frozen=True)
class Reason:
    """Which words decided what; `key` is the key of the sub-task."""

    words: tuple[Word, ...]
    key: str
    said: str


@dataclass
class Step:
    """A sub-task to be."""

    clause: Clause
    primitive: str
    parameters: dict[str, Any]
    moves: frozenset[str]  # arms and joint groups that it claims
    reasons: list[Reason] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    own: dict[str, Any] = field(default_factory=dict)  # keys of the sub-task: beats, repeat …
    words: str = ""  # the sentence, if it says nothing else
    sentence: int = 0  # ordinal of the sentence that says it
    lasting: bool = False  # goes on for as long as something beside it, if nothing is said

    def because(self, words: Iterable[Word], key: str, said: str) -> "Step":
        """Note which words decided something."""
        self.reasons.append(Reason(tuple(words), key, said))
        return self

    def assume(self, said: str) -> "Step":
        """Note what was taken for granted."""
        if said and said not in self.assumed:
            self.assumed.append(said)
        return self


def opposite(side: str) -> str:
    """Right of left."""
    return SIDES[1 - SIDES.index(side)]


def plain(number: float) -> float | int:
    """A number as one writes it."""
    rounded = round(number, 6)
    return int(rounded) if rounded == int(rounded) else rounded

"""Problems of a text, each with its place, reported together."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from specs.english.sentences import Raw, Word
from specs.english.vocabulary import vocabulary
from specs.errors import Position, SpecError

MOST = 20  # problems that are shown
LONGEST = 40  # characters of a word that neighbours are looked for
COMMON = ("raise", "extend", "bend", "turn", "put", "touch", "wave", "look")
FEW = 5  # phrases that are shown
LIKE, ALIKE = 0.7, 0.8  # how much of a word is another; the same of another class of word
WIDEST = 160  # characters of a line that are shown


@dataclass(eq=False)
class Problem(Exception):
    """What is wrong with some words, and which."""

    message: str
    raws: tuple[Raw, ...]
    unknown: str = ""  # a word nobody knows: its neighbours are looked for when it is shown
    wanted: str = ""  # the class of word that fits there

    @classmethod
    def of(cls, message: str, words: Iterable[Word]) -> "Problem":
        """A problem with these words."""
        return cls(message, tuple(raw for word in words for raw in word.raws))

    @property
    def position(self) -> Position:
        """Where it begins."""
        return self.raws[0].position if self.raws else Position(1, 1)

    def told(self, known: Sequence[str]) -> str:
        """The message, with the nearest of the known words."""
        if not self.unknown:
            return self.message
        phrases = vocabulary().phrases(self.unknown)
        return self.message + (only_in(phrases) or _instead(self.unknown, self.wanted, known))


def _instead(word: str, wanted: str, known: Sequence[str]) -> str:
    """What can be said in the place of a word: first what fits there."""
    fitting = nearest(word, vocabulary().known(wanted)) if wanted else ""
    close = fitting or nearest(word, known, alike=ALIKE if wanted else LIKE)
    if close or not wanted:
        return close
    if wanted == "NOUN":
        return f"; there are: {', '.join(vocabulary().parts())}"
    return f"; verbs are {', '.join(COMMON)} …: 'adonis words' lists them"


def only_in(phrases: Sequence[str]) -> str:
    """The phrases that a word is known in."""
    more = ", …" if len(phrases) > FEW else ""
    return f"; it is known only in {', '.join(map(repr, phrases[:FEW]))}{more}" if phrases else ""


def nearest(word: str, known: Sequence[str], *, most: int = 3, alike: float = LIKE) -> str:
    """What may have been meant instead of a word; of several forms of one, the first."""
    close = get_close_matches(word[:LONGEST].lower(), known, n=most, cutoff=alike)
    close = [c for k, c in enumerate(close) if not any(c.startswith(d) for d in close[:k])]
    return f"; did you mean {' or '.join(map(repr, close))}?" if close else ""


def excerpt(problem: Problem, lines: Sequence[str]) -> str:
    """The line that a problem stands in, with its words underlined."""
    at = problem.position
    if not problem.raws or not 1 <= at.line <= len(lines):
        return ""
    here = [raw for raw in problem.raws if raw.line == at.line]
    first, last = at.column - 1, max(raw.end for raw in here) - 1
    begin = max(0, min(first - 20, last - WIDEST))
    shown = lines[at.line - 1][begin : begin + WIDEST].replace("\t", " ").rstrip()
    length = max(1, min(last, begin + WIDEST) - first)
    return f"    {shown}\n    {' ' * (first - begin)}{'^' * length}"


def error_of(
    problems: Sequence[Problem], lines: Sequence[str], file: str, known: Sequence[str]
) -> SpecError:
    """One error that tells all problems of a text, the first of them in its first line."""
    ordered = sorted(problems, key=lambda p: (p.position.line, p.position.column))
    told: list[str] = []
    for problem in ordered[:MOST]:
        at = problem.position
        where = f"{file}:{at.line}:{at.column}: " if told else ""
        told.append(f"{where}{problem.told(known)}\n{excerpt(problem, lines)}".rstrip())
    if len(ordered) > MOST:
        told.append(f"… and {len(ordered) - MOST} more")
    return SpecError("\n".join(told), file=file, position=ordered[0].position)

"""Words become clauses, by `grammar.lark`."""

from collections.abc import Callable, Iterator
from functools import lru_cache
from importlib.resources import files
from typing import Any

from lark import Lark, Token, Transformer
from lark.exceptions import UnexpectedToken
from lark.lexer import Lexer

from specs.english.lexing import classes
from specs.english.problems import Problem
from specs.english.sentences import Clause, Condition, Noun, Parsed, Phrase, Word, said
from specs.english.vocabulary import CLASSES

OWN = {"LINK", "SEP", "DASH", "SOME"}  # classes that are not a section of the vocabulary
PHRASES = (
    "thing", "place", "amount", "direction", "state", "manner", "together", "in_turn", "separator",
    "count", "rate", "most", "until", "step", "last", "when", "tempo",
)  # fmt: skip


class _Words(Lexer):
    """Words are found already; they only change their clothes."""

    def __init__(self, lexer_conf: Any) -> None:
        pass

    def lex(self, data: Any) -> Iterator[Token]:  # type: ignore[override]
        """A token for each word."""
        for word in data:
            yield Token(word.kind, word)


class _Clauses(Transformer[Token, Parsed]):
    """The tree of a sentence as clauses and phrases."""

    def modifier(self, parts: list[Token]) -> Word:
        return _word(parts[0])

    def np(self, parts: list[Any]) -> Noun:
        words: list[Word] = []
        known: dict[str, Any] = {}
        for part in parts:
            if isinstance(part, Noun):  # what something is a part of
                words += part.words
                own = {k: v for k, v in known.items() if k in ("side", "part", "both")}
                known = {
                    k: getattr(part, k) for k in ("noun", "pronoun", "side", "both", "other")
                } | own
                continue
            word = part if isinstance(part, Word) else _word(part)
            words.append(word)
            match word.kind:
                case "SIDE":
                    if known.get("side", word.entry.key) != word.entry.key:
                        raise Problem.of("left or right?", words)
                    known["side"] = word.entry.key
                case "BOTH":
                    known["both"] = True
                case "OTHER":
                    known["other"] = True
                case "SOME":
                    known["some"] = True
                case "PART":
                    known["part"] = word.entry.key
                case "NOUN":
                    known["noun"] = word
                case "PRONOUN":
                    known["pronoun"] = word
        return Noun(tuple(words), **known)

    def measure(self, parts: list[Token]) -> tuple[Word, Word]:
        number, unit = map(_word, parts)
        return number, unit

    def condition(self, parts: list[Any]) -> Condition:
        words = _flat(parts)
        if len(parts) == 1:
            return Condition(words, signal=_word(parts[0]))
        hand, *between, place = parts
        measured = [part for part in between if isinstance(part, tuple)]
        distance = (measured[0][0].number, measured[0][1]) if measured else None
        return Condition(words, hand=hand, place=place, distance=distance)

    def opening(self, parts: list[Any]) -> tuple[str, Condition]:
        return _word(parts[0]).entry.key, parts[1]

    def clause(self, parts: list[Any]) -> Clause:
        words = _flat(parts)
        verbs = [_word(p) for p in parts if isinstance(p, Token)]
        subject = next((p for p in parts if isinstance(p, Noun)), None)
        phrases = tuple(p for p in parts if isinstance(p, Phrase))
        return Clause(words, phrases, verb=verbs[-1] if verbs else None, subject=subject)

    def start(self, parts: list[Any]) -> Parsed:
        clauses: list[Clause] = []
        when, link = None, ""
        for part in parts:
            if isinstance(part, Token):
                link = _word(part).entry.key
            elif isinstance(part, Clause):
                for phrase in part.phrases:
                    if phrase.kind == "when" and phrase.condition is not None:
                        if when is not None:
                            raise Problem.of("there are two things to wait for", phrase.words)
                        when = phrase.words[0].entry.key, phrase.condition
                clauses.append(Clause(part.words, part.phrases, part.verb, part.subject, link))
                link = ""
            else:
                when = part
        return Parsed(tuple(clauses), when)


def _phrase(kind: str) -> Callable[[Any, list[Any]], Phrase]:
    """Makes phrases of a kind: what stands in one, sorted."""

    def make(_: Any, parts: list[Any]) -> Phrase:
        words = _flat(parts)
        nouns = [p for p in parts if isinstance(p, Noun)]
        conditions = [p for p in parts if isinstance(p, Condition)]
        apart = [w for p in parts if isinstance(p, Token | tuple) for w in _flat([p])]
        prepositions = [w for w in apart if w.kind == "PREPOSITION"]
        units = [w for w in apart if w.kind == "UNIT"]
        return Phrase(
            kind,
            words,
            noun=nouns[0] if nouns else None,
            preposition=prepositions[0] if prepositions else None,
            numbers=tuple(_count(w) for w in apart if w.kind in ("NUMBER", "COUNT")),
            unit=units[0] if units else None,
            condition=conditions[0] if conditions else None,
        )

    return make


def _count(word: Word) -> float:
    return float(word.entry.meaning["number"]) if word.kind == "COUNT" else word.number


for _kind in PHRASES:
    setattr(_Clauses, _kind, _phrase(_kind))


@lru_cache(maxsize=1)
def _parser() -> Lark:
    grammar = (files("specs.english") / "grammar.lark").read_text(encoding="utf-8")
    declared = sorted({*CLASSES.values(), *OWN} - {"LINKING", "CANNOT"})
    return Lark(
        f"{grammar}\n%declare {' '.join(declared)}\n",
        parser="lalr",
        lexer=_Words,
        transformer=_Clauses(),
    )


def parse(words: list[Word]) -> Parsed:
    """The clauses of a sentence.

    Raises:
        Problem: it is no sentence; the word at which that shows is in it.
    """
    try:
        return _parser().parse(words)  # type: ignore[return-value]
    except UnexpectedToken as problem:
        expected = sorted(classes()[kind] for kind in problem.accepts or () if kind in classes())
        wanted = f"; here could stand {', '.join(expected)}" if expected else ""
        if isinstance(problem.token.value, Word):
            word = problem.token.value
            if word.kind == "VERB":
                told = "begins something new: put 'and', 'then' or a full stop before it"
                raise Problem.of(f"{word.text!r} {told}", [word]) from None
            raise Problem.of(f"{word.text!r} does not fit here{wanted}", [word]) from None
        raise Problem.of(
            f"the sentence breaks off after {words[-1].text!r}{wanted}", words[-1:]
        ) from None


def _word(token: Token) -> Word:
    word: Word = token.value
    return word


def _flat(parts: list[Any]) -> tuple[Word, ...]:
    """All words of a part of the tree, in their order."""
    words: list[Word] = []
    for part in parts:
        if isinstance(part, Token):
            words.append(_word(part))
        elif isinstance(part, Word):
            words.append(part)
        elif isinstance(part, tuple):
            words += part
        else:
            words += part.words
    return tuple(words)


__all__ = ["parse", "said"]

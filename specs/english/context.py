"""What a sentence can refer to: the hand used last, and how each arm is held."""

from dataclasses import dataclass, field
from typing import Any

from specs.english.problems import Problem
from specs.english.sentences import Noun, Word
from specs.english.steps import SIDES, opposite

Held = dict[str, Any]  # arm, elbow, palm: as a posture says it
At = str | dict[str, Any]  # a place, as go-to-point has it
HANGING: Held = {"arm": "down", "elbow": "straight"}


@dataclass
class Hands:
    """Which hands are meant, and why."""

    sides: tuple[str, ...]
    words: tuple[Word, ...] = ()
    assumed: str = ""

    @property
    def both(self) -> bool:
        """Whether it is the two of them."""
        return len(self.sides) == 2


@dataclass(frozen=True)
class Named:
    """Which arms were named, for a sentence that does not name any: see `Context`."""

    last: tuple[str, ...] = ()
    both: str = ""
    apart: bool = False


@dataclass
class Context:
    """Goes from sentence to sentence."""

    last: tuple[str, ...] = ()  # sides of the arms that were moved last
    arms: dict[str, Held | None] = field(default_factory=lambda: dict.fromkeys(SIDES, HANGING))
    at: dict[str, At | None] = field(default_factory=lambda: dict.fromkeys(SIDES))
    raised: set[str] = field(default_factory=set)  # arms that are up, to wave
    both: str = ""  # "sentence" or "before": both arms were named last, in this sentence or before
    apart: bool = False  # each hand went its own way at the same time: "it" could be either
    turned: float = 0.0  # of the trunk, to the left [degrees]
    mirrored: bool = False  # whether left is right: "repeat with the other hand"

    def begin(self) -> None:
        """A sentence begins."""
        self.both = self.both and "before"

    @property
    def named(self) -> Named:
        """Which arms were named up to now."""
        return Named(self.last, self.both, self.apart)

    def go_back_to(self, named: Named) -> None:
        """A sentence that is repeated means the arms that it meant before, or the other ones."""
        self.last = tuple(self.side(side) for side in named.last)
        self.both, self.apart = named.both, named.apart

    def side(self, said: str) -> str:
        """The side that a word means."""
        return opposite(said) if self.mirrored and said in SIDES else said

    def put(
        self, side: str, held: Held | None = None, at: At | None = None, *, up: bool = False
    ) -> None:
        """Note what is known of an arm now.

        Args:
            side: its side.
            held: the posture it is held in, if it is a posture.
            at: the place its hand is at, if that was brought to one.
            up: whether it is up, from where it can wave.
        """
        self.arms[side], self.at[side] = held, at
        (self.raised.add if up else self.raised.discard)(side)

    def hands(
        self, noun: Noun | None, *, default: str = "", both: bool = False, place: bool = False
    ) -> Hands:
        """Which hands a noun phrase means; nothing said is the hand used last.

        Args:
            noun: what was said, if anything.
            default: the side to take when nothing was said and no hand was used.
            both: take both then.
            place: they go to a place; both only if this sentence named them.

        Raises:
            Problem: it could be one or the other.
        """
        hands = self._named(noun) if noun is not None else self._understood(default, both, place)
        named = "sentence" if noun is not None else self.both
        self.both = named if hands.both else ""
        return hands

    def _named(self, noun: Noun) -> Hands:
        words, taken = noun.words, _taken(noun)
        if noun.side and not noun.both:
            self.apart = False
            return Hands((self.side(noun.side),), words, taken)
        if noun.other:
            if len(self.last) != 1:
                raise Problem.of(
                    f"{_text(noun)!r}: other than which? no hand was used alone before", words
                )
            return Hands((opposite(self.last[0]),), words, taken)
        if noun.some:
            raise Problem.of(_which(noun), words)
        key = noun.pronoun.entry.key if noun.pronoun else ""
        if noun.plural or key == "them":
            return Hands(SIDES, words, taken)
        if len(self.last) == 1 and not self.apart:
            assumed = f"{_text(noun)!r} is the {self.last[0]} one, used last"
            return Hands(self.last, words, "; ".join(filter(None, (assumed, taken))))
        if key == "it":
            raise Problem.of(
                f"{_text(noun)!r} could be your right hand or your left hand: say which", words
            )
        raise Problem.of(_which(noun), words)

    def _understood(self, default: str, both: bool, place: bool) -> Hands:
        if both:
            return Hands(SIDES, (), "both hands")
        if self.both == "sentence" or (self.both and not place):
            return Hands(SIDES, (), "both arms, named last")
        if default:
            return Hands((default,), (), f"the {default} hand")
        if len(self.last) == 1:
            return Hands(self.last, (), f"the {self.last[0]} hand, used last")
        side = self.side("right")
        return Hands((side,), (), f"the {side} hand, since none is named")


def _which(noun: Noun) -> str:
    word = noun.noun.text if noun.noun else "hand"
    return (
        f"{_text(noun)!r} could be your right {word}, your left {word} or both {word}s: say which"
    )


def _taken(noun: Noun) -> str:
    """What moves in the stead of a part that does not move alone, in words."""
    taken = noun.noun.entry.meaning.get("taken") if noun.noun else None
    return f"{_text(noun)!r}: {taken} moves" if taken else ""


def _text(noun: Noun) -> str:
    return " ".join(word.text for word in noun.words)

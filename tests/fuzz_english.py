"""Fuzzing of English lessons: whatever the text, a task or a SpecError, soon.

    python -m tests.fuzz_english 100000 [SEED]

mutates lessons that mean something: words go, come, change places, and are replaced by others of
the vocabulary, by numbers and by noise. Half of the texts are made of the vocabulary alone.
"""

import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from specs import SpecError, build_graph, library, task_from_text
from specs.english.explaining import explain
from specs.english.lesson import read_lesson
from specs.english.vocabulary import vocabulary

LONGEST = 1.0  # [s] of processor time for one text
NOISE = [
    *("", "\x00", "“", "”", '"', "'", "’", "(", ")", "-", "–", "—", "\t", "\u2028", "é", "²", "٣"),
    *("…", "0", "-1", "1e309", "9" * 400, "nan", "a" * 300, "#", "//", "<!--", "*", "---", "==="),
    *(":", ";", ".", "?", "tempo: 0", "tempo: x", "title:", "1.", "99999999.", "0.5", "&", "°"),
]
FRAME = [
    "Repeat lines 1 to 3 twice.",
    "Repeat everything 100 times.",
    "Repeat with the other hand.",
    "Do it again.",
    "At the same time, nod.",
    "Then your left.",
    "While you wave, bow.",
    'When you hear "go", clap.',
]


@dataclass
class Found:
    """What became of the texts."""

    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    slow: str = ""


def texts(count: int, seed: int) -> Iterator[str]:
    """Mutated lessons."""
    rng = random.Random(seed)
    here = Path(__file__).parent / "specs" / "lessons"
    paths = [path for path in library().values() if path.suffix == ".txt"]
    paths += sorted(here.glob("*.txt"))
    seeds = [path.read_text(encoding="utf-8") for path in paths]
    known = sorted(vocabulary().entries)
    for _ in range(count):
        if rng.random() < 0.5:
            lines = rng.choice(seeds).splitlines()
            first = rng.randrange(len(lines))
            lines = [
                _mutated(rng, line, known) for line in lines[first : first + rng.randint(1, 3)]
            ]
        else:
            lines = [
                " ".join(rng.choice(known) for _ in range(rng.randint(1, 9)))
                for _ in range(rng.randint(1, 5))
            ]
        if rng.random() < 0.3:
            lines.insert(rng.randint(0, len(lines)), rng.choice(FRAME))
        yield rng.choice(["\n", "\n", "\n", "\r\n", " "]).join(lines)


def _mutated(rng: random.Random, line: str, known: list[str]) -> str:
    words = line.split(" ")
    for _ in range(rng.choice([0, 0, 0, 1, 1, 3])):
        i = rng.randrange(len(words))
        match rng.randrange(7):
            case 0:
                words.insert(i, rng.choice(known))
            case 1:
                words[i] = rng.choice(known)
            case 2:
                words[i] = rng.choice(NOISE)
            case 3:
                words[i] += rng.choice(NOISE)
            case 4:
                words = words[:i] + words[i + 1 :] or [""]
            case 5:
                j = rng.randrange(len(words))
                words[i], words[j] = words[j], words[i]
            case 6:
                cut = rng.randint(0, len(words[i]))
                words[i] = words[i][:cut] + rng.choice("abcdeéxyz ") + words[i][cut:]
    return " ".join(words)


def fuzz(count: int, seed: int = 0) -> Found:
    """Read so many texts; anything but a task or a SpecError is raised with its text."""
    found = Found()
    for text in texts(count, seed):
        began = time.process_time()
        try:
            spec, document = task_from_text(text, "fuzz.txt")
            build_graph(spec, document)
            outcome = "task"
        except SpecError:
            outcome = "refused"
        except Exception as problem:
            raise AssertionError(f"{type(problem).__name__} for {text!r}") from problem
        explain(read_lesson(text, "fuzz.txt"))
        spent = time.process_time() - began
        found.outcomes[outcome] += 1
        if spent > found.slowest:
            found.slowest, found.slow = spent, text
    return found


if __name__ == "__main__":
    result = fuzz(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    print(dict(result.outcomes), f"slowest {result.slowest:.3f} s: {result.slow!r}")
    sys.exit(result.slowest > LONGEST)

"""Lines of a text become sentences: lists, headings, comments and headers are told apart.

A sentence ends at . ! ? ; and at the end of its line. A line that begins in lower case goes on with
the sentence above if that began with a capital or ended with a comma.
"""

import re
from dataclasses import dataclass, field

from specs.english.problems import Problem
from specs.english.sentences import Raw, Sentence

MOST_SENTENCES = 20_000
ITEM = re.compile(
    r"\s*(?:(?:step|move)\s+)?(\d{1,6})(?:[.):]+(?!\d)\s*|\s+(?=[A-Z])|\s*$)", re.IGNORECASE
)
NUMBERED = re.compile(r"\s*(?:(?:[Ss]tep|[Mm]ove)\s+)?(\d{1,6})(?:[.):]+(?!\d)\s*|\s+(?=[A-Z]))")
BULLET = re.compile(r"\s*[-*+•·–]\s+")
HEADING = re.compile(r"\s*#+\s*(.*?)\s*#*\s*$")
UNDERLINE = re.compile(r"\s*(?:=+|-{3,}|\*{3,}|_{3,})\s*$")
COMMENT = re.compile(r"<!--.*?-->|(?:^|\s)(?:#|//).*$")
YES, NO = ("yes", "true", "on"), ("no", "false", "off")
HEADER = re.compile(
    r"\s*(title|task|tempo|body|source|coda|safety|rehearse)\s*[:=]\s*(.*?)\s*$", re.IGNORECASE
)
WORD = re.compile(
    r"\d+(?:\.\d+)?|[^\W\d_]+(?:['’\-][^\W\d_]+)*|[\"“][^\"“”]*[\"”]|\.{3}|[^\s*_`]", re.UNICODE
)
ENDS = {".", "!", "?", ";", "...", "…"}
TEMPO = re.compile(r"(\d+(?:\.\d+)?)\s*(?:bpm|beats per minute)?\.?$", re.IGNORECASE)


@dataclass
class Layout:
    """A text in its parts."""

    lines: list[str]
    sentences: list[Sentence] = field(default_factory=list)
    headers: dict[str, tuple[str, Raw]] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)


def lay_out(text: str) -> Layout:
    """The sentences of a text, and its headers."""
    layout = Layout(text.splitlines())
    open_: Sentence | None = None
    for number, line in enumerate(layout.lines, start=1):
        if HEADING.match(line):
            _title(layout, HEADING.match(line), number)
            open_ = None
            continue
        if UNDERLINE.match(line):
            if open_ is not None and line.strip()[0] in "=-":
                _underlined(layout, open_)
            open_ = None
            continue
        blanked = COMMENT.sub(lambda m: " " * len(m[0]), line)
        header = HEADER.match(blanked)
        if header:
            _header(layout, header, number)
            open_ = None
            continue
        if not blanked.strip():
            open_ = None
            continue
        open_ = _line(layout, blanked, number, open_)
    layout.sentences = [s for s in layout.sentences if s.words]
    for sentence in layout.sentences[MOST_SENTENCES:]:
        said = f"a lesson has at most {MOST_SENTENCES} sentences"
        layout.problems.append(Problem(said, tuple(sentence.words[:1])))
        break
    del layout.sentences[MOST_SENTENCES:]
    return layout


def _line(layout: Layout, line: str, number: int, before: Sentence | None) -> Sentence | None:
    """The sentences of a line; the last one may go on in the next line."""
    bullet = BULLET.match(line)
    start = bullet.end() if bullet else 0
    item = NUMBERED.match(line, start) or ITEM.fullmatch(line, start)
    label = int(item[1]) if item else None
    start = item.end() if item else start
    goes_on = not (bullet or item) and before is not None and _goes_on(before, line)
    current = before if goes_on and before is not None else Sentence([], label, opens=True)
    if current is not before:
        layout.sentences.append(current)
    ended = False
    for match in WORD.finditer(line, start):
        if match[0] in ENDS:
            ended = True
            continue
        if ended and current.words:
            current = Sentence([], label)
            layout.sentences.append(current)
        ended = False
        current.words.append(Raw(match[0], number, match.start() + 1))
    return None if ended else current


def _goes_on(before: Sentence, line: str) -> bool:
    if not before.words:
        return True
    first = line.lstrip()[:1]
    return before.words[-1].text == "," or (first.islower() and before.words[0].text[0].isupper())


def _title(layout: Layout, heading: re.Match[str] | None, number: int) -> None:
    """The first heading is the title, if nothing stands before it."""
    if heading and heading[1] and not layout.sentences and "title" not in layout.headers:
        layout.headers["title"] = heading[1], Raw(heading[1], number, heading.start(1) + 1)


def _underlined(layout: Layout, sentence: Sentence) -> None:
    """A sentence that is underlined was a heading."""
    words = sentence.words
    layout.sentences.remove(sentence)
    if words and not layout.sentences and "title" not in layout.headers:
        line = layout.lines[words[0].line - 1].strip()
        layout.headers["title"] = line, Raw(line, words[0].line, words[0].column)


def _header(layout: Layout, header: re.Match[str], number: int) -> None:
    key, value = header[1].lower(), header[2]
    raw = Raw(header[0].strip(), number, header.start(1) + 1)
    if key in layout.headers and layout.headers[key][1].text.lower().startswith(key):
        first = layout.headers[key][1].line
        layout.problems.append(Problem(f"{key!r} is said twice (line {first})", (raw,)))
    elif not value:
        layout.problems.append(Problem(f"{key!r} says nothing", (raw,)))
    elif key == "tempo" and not TEMPO.fullmatch(value):
        said = f"a tempo is a number of beats per minute, such as 'tempo: 103', not {value[:40]!r}"
        layout.problems.append(Problem(said, (raw,)))
    elif key == "rehearse" and value.lower() not in YES + NO:
        layout.problems.append(Problem(f"'rehearse' is yes or no, not {value[:40]!r}", (raw,)))
    else:
        tempo = TEMPO.fullmatch(value)
        layout.headers[key] = tempo[1] if key == "tempo" and tempo else value, raw

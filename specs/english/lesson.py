"""A lesson: all sentences of a text, one after the other, as the data of a task."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from specs.english.context import Context
from specs.english.doing import Stages
from specs.english.layout import YES, Layout, lay_out
from specs.english.lexing import words_of
from specs.english.meaning import stages_of
from specs.english.parsing import parse
from specs.english.problems import Problem, error_of
from specs.english.repeating import MOST_STEPS, Played, repeated, stands_still, without_side
from specs.english.repeating import told as repetition
from specs.english.roles import LIMBS, sort, split
from specs.english.sentences import Clause, Condition, Parsed, Raw, Sentence, Word
from specs.english.sequence import Sequence, moves
from specs.english.steps import Reason, Step
from specs.english.timing import condition_of
from specs.english.vocabulary import vocabulary
from specs.errors import Position, SpecError
from specs.reading import Document, Path_

TEMPO = 60.0  # beats per minute, if none is said
ARMS = {"right_arm", "left_arm"}


@dataclass
class Told:
    """What became of one sentence, to explain it."""

    text: str
    line: int
    fillers: tuple[Word, ...] = ()
    steps: list[Step] = field(default_factory=list)
    problem: Problem | None = None
    note: str = ""
    mirrored: bool = False  # whether left and right were exchanged in what it repeats


@dataclass
class Lesson:
    """A text and the task that it describes."""

    file: str
    layout: Layout
    told: list[Told] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    sequence: Sequence = field(default_factory=Sequence)
    tempo: float | None = None

    @property
    def document(self) -> Document:
        """The task as plain data, and where each part of it stands in the text.

        Raises:
            SpecError: what is wrong with the text, all of it.
        """
        if self.problems:
            known = vocabulary().known()
            raise error_of(self.problems, self.layout.lines, self.file, known)
        data: dict[str, Any] = {"task": _name(self.file)}
        headers = self.layout.headers
        for key in ("title", "task", "source", "coda", "safety"):
            if key in headers:
                data[key] = _value(headers[key][0])
        own = vocabulary().defaults["body"]
        data["body"] = headers["body"][0] if "body" in headers else own
        if self.tempo is not None:
            data["tempo"] = self.tempo
        data["rehearse"] = self.rehearses
        data["background"] = [dict(entry) for entry in vocabulary().defaults["background"]]
        data["subtasks"] = [step.own for step in self.sequence.steps]
        lines = {self.file: self.layout.lines}
        return Document(data, self.file, dict(self._positions()), lines=lines)

    @property
    def rehearses(self) -> bool:
        """Whether ways of the hands are to be found by rehearsal."""
        said = self.layout.headers.get("rehearse")
        return said[0].lower() in YES if said else bool(vocabulary().defaults["rehearse"])

    def _positions(self) -> Iterator[tuple[Path_, Position]]:
        yield (), Position(1, 1)
        for key, (_, raw) in self.layout.headers.items():
            yield (key,), raw.position
        for i, step in enumerate(self.sequence.steps):
            if step.clause.words:
                yield ("subtasks", i), step.clause.words[0].raws[0].position
            for reason in step.reasons:
                if reason.words:
                    yield ("subtasks", i, reason.key), reason.words[0].raws[0].position


def read_lesson(text: str, file: str) -> Lesson:
    """Understand a text as far as possible; `document` raises what could not be."""
    return _Reader(Lesson(file, lay_out(text))).read()


class _Reader:
    """Goes through the sentences of a lesson."""

    def __init__(self, lesson: Lesson) -> None:
        self._lesson, self._sequence = lesson, lesson.sequence
        self._context = Context()
        self._played: list[Played] = []
        self._clause_before: Clause | None = None
        self._repeated = 0  # steps that were added by repeating
        self._numbered = any(sentence.number is not None for sentence in lesson.layout.sentences)
        tempo = lesson.layout.headers.get("tempo")
        lesson.tempo = None if tempo is None else float(tempo[0])

    def read(self) -> Lesson:
        """Read all of it."""
        lesson = self._lesson
        lesson.problems += lesson.layout.problems
        for sentence in lesson.layout.sentences:
            told = Told(_shown(sentence, lesson.layout), sentence.words[0].line)
            lesson.told.append(told)
            self._sequence.sentence = len(lesson.told)
            self._context.begin()
            try:
                self._sentence(sentence, told)
            except Problem as problem:
                told.problem = problem
                lesson.problems.append(problem)
        self._sequence.flush(self._lesson.tempo or TEMPO)
        if not self._sequence.steps and not lesson.problems:
            lesson.problems.append(Problem("no sentence says what to do", ()))
        return lesson

    def _sentence(self, sentence: Sentence, told: Told) -> None:
        words, fillers, problems = words_of(sentence.words)
        told.fillers = tuple(fillers)
        if problems:
            self._lesson.problems += problems[1:]
            raise problems[0]
        if not words:
            raise Problem("this says nothing to do", tuple(sentence.words))
        parsed = _with_links(parse(words))
        if self._tempo(parsed, told):
            return
        number = sentence.number if self._numbered else len(self._played) + 1
        played = Played(number, told.line, parsed, told.text, self._context.named)
        if _repeats(parsed):
            (clause,) = parsed.clauses
            roles = sort(clause)
            again = repeated(roles, self._played, self._context)
            self._repeated += sum(len(one.steps) for one, _ in again)
            if self._repeated > MOST_STEPS:
                raise Problem.of(f"repeating makes more than {MOST_STEPS} steps", clause.words)
            told.note = repetition(again, roles, len(self._played))
            played.plays, told.mirrored = again, any(mirrored for _, mirrored in again)
        for one, mirrored in played.plays or [(played, False)]:
            before, self._context.mirrored = self._context.mirrored, mirrored
            if played.plays:
                self._context.go_back_to(one.named)
            try:
                steps = self._play(one.parsed)
            except Problem as problem:
                if not played.plays:
                    raise
                where = tuple(sentence.words)
                raise Problem(
                    f"line {one.line} cannot be repeated here: {problem.message}", where
                ) from None
            finally:
                self._context.mirrored = before
            played.steps += steps
        if played.plays and stands_still(played, self._played[-1]):
            more = "'Repeat the last 2 sentences', or " if len(self._played) > 1 else ""
            raise Problem(
                f"{self._played[-1].text!r} again would stand still: say {more}there and back in"
                " one sentence, with 'then' between",
                tuple(sentence.words),
            )
        if told.mirrored and (same := without_side(played, sort(parsed.clauses[0]))) is not None:
            raise same
        if len(played.parsed.clauses) == 1 and len({id(step.clause) for step in played.steps}) == 1:
            for step in played.steps:
                step.words = told.text
        told.steps = played.steps
        self._played.append(played)

    def _tempo(self, parsed: Parsed, told: Told) -> bool:
        """A sentence that only says the tempo."""
        if len(parsed.clauses) != 1 or parsed.clauses[0].verb is not None:
            return False
        roles = sort(parsed.clauses[0])
        if roles.tempo is None:
            return False
        words = roles.tempo.words
        for more in roles.unused({"tempo"}):
            raise Problem.of("a sentence about the tempo says nothing else", more)
        if self._lesson.tempo is not None:
            raise Problem.of("the tempo is said twice; a task has one", words)
        if len(self._sequence):
            raise Problem.of(
                "the tempo is that of the whole task: say it before the first move", words
            )
        if not 1 <= roles.tempo.number <= 1000:
            raise Problem.of("a tempo is between 1 and 1000 beats per minute", words)
        self._lesson.tempo = roles.tempo.number
        told.note = f"tempo {roles.tempo.number:g}"
        return True

    def _play(self, parsed: Parsed) -> list[Step]:
        """Add the steps of a sentence."""
        made: list[Step] = []
        condition = None
        if parsed.when is not None:
            made += self._when(*parsed.when)
            condition = parsed.when[1] if parsed.when[0] == "if" else None
        before: Clause | None = None
        earlier: Clause | None = None
        if set(_parts(parsed.clauses[0])) <= {"hand", "manner", "separator"}:
            before = self._clause_before  # "Now the left arm": as the right one before
        for clause in parsed.clauses:
            for one in split(_filled(clause, before)):
                stages = self._clause(one)
                for step in (step for stage in stages for step in stage):
                    if condition is not None:
                        step.own["if"] = condition_of(condition, self._context)
                        step.because(condition.words, "if", str(step.own["if"]))
                    made.append(step)
                if earlier is not None and _counted_alone(one, earlier):
                    for step in stages[-1]:
                        step.assume(
                            "so often only this: for all of the sentence, say it without a number"
                            " and 'Repeat that' after it"
                        )
                before = one if clause.verb is None and before is not None else clause
                earlier = one
        self._clause_before = before
        return made

    def _clause(self, clause: Clause) -> Stages:
        roles = sort(clause)
        stages = stages_of(roles, self._context)
        link = clause.link
        if roles.together:
            several = sum(map(len, stages)) > 1
            link = link if several else "together"
            for step in stages[-1]:
                step.because(roles.together, "after", "at the same time")
        self._sequence.add(stages, link, clause, self._lesson.tempo or TEMPO)
        if moves(stages) & ARMS:
            self._context.apart = moves(*self._sequence.block) >= ARMS and not moves(stages) >= ARMS
        return stages

    def _when(self, kind: str, condition: Condition) -> list[Step]:
        """Wait for something before the rest of the sentence."""
        wanted = condition_of(condition, self._context)
        if kind == "if":
            return []
        timeout = vocabulary().defaults["timeout"]
        joints = ["waist", "neck"]
        clause = Clause(condition.words, ())
        step = Step(clause, "hold", {"joints": joints}, frozenset(joints))
        step.own |= {"done": wanted, "timeout": timeout}
        step.because(condition.words, "done", f"waits until {wanted}")
        step.assume(f"goes on after {timeout:g} s in any case, which counts as a failure")
        self._sequence.add([[step]], "", clause, self._lesson.tempo or TEMPO)
        return [step]


def _repeats(parsed: Parsed) -> bool:
    repeating = [c for c in parsed.clauses if c.verb is not None and c.verb.entry.key == "repeat"]
    if repeating and len(parsed.clauses) > 1:
        raise Problem.of("'repeat' is a sentence of its own", repeating[0].words)
    return bool(repeating)


def _with_links(parsed: Parsed) -> Parsed:
    """How clauses follow each other: of a list with commas one after the other."""
    clauses = _joined(list(parsed.clauses))
    first = clauses[0].link
    if first == "while" and len(clauses) > 1:
        clauses[1] = replace(clauses[1], link="while")
        clauses[0] = replace(clauses[0], beside=True)
    if first not in ("together",):
        clauses[0] = replace(clauses[0], link="")
    for k, clause in enumerate(clauses[1:], start=1):
        if clause.link in ("comma", "and", "comma-and") and _participle(clause):
            clauses[k] = replace(clause, link="while")  # "…, turning your head"
    listed = any(clause.link == "comma" for clause in clauses)
    for k, clause in enumerate(clauses[1:], start=1):
        link = clause.link
        if link == "while" and first != "while":
            clauses[k] = replace(clause, beside=True)
        elif link == "comma" or (link in ("and", "comma-and") and listed):
            clauses[k] = replace(clause, link="then")
        elif link == "comma-and":
            clauses[k] = replace(clause, link="and")
    return replace(parsed, clauses=tuple(clauses))


def _participle(clause: Clause) -> bool:
    """Whether its verb is said with -ing: it goes with the clause before."""
    verb = clause.verb
    if verb is None or verb.text.lower() in verb.entry.meaning["words"]:
        return False
    return verb.text.lower().split()[0].endswith("ing")


def _filled(clause: Clause, before: Clause | None) -> Clause:
    """A clause without a verb takes that of the one before, and what it does not say itself."""
    if clause.verb is not None or before is None or before.verb is None:
        return clause
    parts, old = _parts(clause), list(zip(before.phrases, _parts(before), strict=True))
    kept = tuple(p for p, part in old if part not in parts and p.kind != "separator")
    with_hand = next((p.preposition for p, part in old if part == "hand" and p.preposition), None)
    said = tuple(
        replace(p, kind="place", preposition=with_hand)
        if part == "hand" and p.kind == "thing" and with_hand is not None
        else p
        for p, part in zip(clause.phrases, parts, strict=True)
    )
    words = (before.verb, *clause.words)
    return replace(clause, verb=before.verb, phrases=(*said, *kept), words=words)


def _counted_alone(clause: Clause, before: Clause) -> bool:
    """Whether a number of times could be meant of the clause before as well."""
    kinds = [phrase.kind for phrase in clause.phrases]
    if "count" not in kinds or any(phrase.kind == "count" for phrase in before.phrases):
        return False
    set_off = kinds[-2:] == ["separator", "count"]
    return set_off or (clause.verb is not None and clause.verb is before.verb)


def _parts(clause: Clause) -> list[str]:
    """What each phrase says of its clause: hand, object, aspect, where, or its kind."""
    parts: list[str] = []
    for phrase in clause.phrases:
        noun, preposition = phrase.noun, phrase.preposition
        relation = preposition.entry.key if preposition else ""
        if noun is None or phrase.kind not in ("thing", "place"):
            about = parts[-1:] == ["aspect"]
            parts.append(
                "aspect" if about else "where" if phrase.kind == "direction" else phrase.kind
            )
        elif (
            not noun.what
            and noun.side
            and not noun.other
            and (relation in ("to", "toward") or noun.words[0].kind == "SIDE")
        ):
            parts.append("where")
        elif noun.what in ("palm", "elbow") and (
            relation == "with" or {"hand", "object"} & set(parts)
        ):
            parts.append("aspect")
        elif relation == "with" or (not relation and noun.what in (*LIMBS, "")):
            parts.append("hand")
        else:
            parts.append("where" if relation else "object")
    return parts


def _joined(clauses: list[Clause]) -> list[Clause]:
    """Clauses that say one thing between them.

    What stands before a verb goes to it: "With your right hand, touch …". What is said only once
    goes to both: "Raise and lower your arm".
    """
    made: list[Clause] = []
    for k, clause in enumerate(clauses):
        before = made[-1] if made else None
        if (
            before is not None
            and clause.link == "comma"
            and before.verb is None
            and not any(p.kind == "thing" for p in before.phrases)
        ):
            words = (*before.words, *clause.words)
            made[-1] = replace(
                clause, phrases=(*before.phrases, *clause.phrases), words=words, link=before.link
            )
            continue
        following = clauses[k + 1] if k + 1 < len(clauses) else None
        bare = clause.verb is not None and not clause.phrases and clause.subject is None
        if (
            bare
            and following is not None
            and following.link == "and"
            and following.verb is not None
        ):
            shared = tuple(p for p in following.phrases if p.kind == "thing")
            if clause.verb is not None and all(
                s["of"] != "nothing" for s in clause.verb.entry.meaning["senses"]
            ):
                made.append(replace(clause, phrases=shared))
                continue
        made.append(clause)
    return made


def _shown(sentence: Sentence, layout: Layout) -> str:
    """A sentence as it stands in the text, on one line."""
    parts: list[str] = []
    lines: dict[int, list[Raw]] = {}
    for raw in sentence.words:
        lines.setdefault(raw.line, []).append(raw)
    for line, raws in lines.items():
        parts.append(layout.lines[line - 1][raws[0].column - 1 : raws[-1].end - 1])
    return " ".join(parts)


def _name(file: str) -> str:
    """A task is called like its file."""
    stem = re.split(r"[/\\]", file)[-1].rpartition(".")[0] or file
    return re.sub(r"[^A-Za-z0-9_.-]+", "-", stem).strip("-._")[:100] or "lesson"


def _value(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


__all__ = ["Lesson", "Reason", "SpecError", "Told", "read_lesson"]

"""What was understood of each sentence, which words decided it, and what was assumed."""

from collections.abc import Iterator

from specs.english.layout import Layout
from specs.english.lesson import TEMPO, Lesson, Told
from specs.english.problems import Problem, excerpt
from specs.english.steps import Step
from specs.english.vocabulary import vocabulary

HIDDEN = ("name", "words", "primitive", "if")


def explain(lesson: Lesson) -> str:
    """A lesson sentence by sentence, problems where they stand."""
    known = vocabulary().known()
    lines = list(_head(lesson))
    shown = {id(told.problem) for told in lesson.told}
    for told in lesson.told:
        lines.append("")
        lines += _sentence(told, lesson.layout, known)
        for problem in lesson.problems:
            if id(problem) not in shown and problem.position.line == told.line:
                shown.add(id(problem))
                lines += _problem(problem, lesson.layout, known)
    for problem in lesson.problems:
        if id(problem) not in shown:
            lines += ["", *_problem(problem, lesson.layout, known)]
    return "\n".join(lines) + "\n"


def _head(lesson: Lesson) -> Iterator[str]:
    defaults = vocabulary().defaults
    beside = ", ".join(
        f"{entry['name']} ({entry['primitive']})" for entry in defaults["background"]
    )
    tempo = f"{lesson.tempo or TEMPO:g} beats per minute{'' if lesson.tempo else ', assumed'}"
    yield f"{lesson.file}: {tempo}"
    yield f"beside it all, assumed: {beside}"
    if lesson.rehearses and "rehearse" not in lesson.layout.headers:
        yield "rehearse, assumed: ways of the hands round the body are tried out before the run"
    for key, (value, raw) in lesson.layout.headers.items():
        if key != "tempo":
            yield f"{key} (line {raw.line}): {value}"


def _sentence(told: Told, layout: Layout, known: list[str]) -> Iterator[str]:
    yield f"line {told.line}: {told.text}"
    if told.problem is not None:
        yield from _problem(told.problem, layout, known)
        return
    if told.note:
        yield f"    = {told.note}"
        if told.mirrored:
            yield "    = on the other side: left and right are exchanged"
            for step in told.steps:
                yield _named(step)
        elif told.steps:
            yield f"    -> {told.steps[0].own['name']} … {told.steps[-1].own['name']}"
        return
    for step in told.steps:
        yield from _step(step)
    if told.fillers:
        yield f"    no effect: {', '.join(word.text for word in told.fillers)}"


def _step(step: Step) -> Iterator[str]:
    yield _named(step)
    width = max((len(_words(reason.words)) for reason in step.reasons), default=0)
    for reason in step.reasons:
        yield f"         {_words(reason.words):<{min(width, 40)}}  {reason.key}: {reason.said}"
    if step.assumed:
        yield f"         assumed: {'; '.join(step.assumed)}"


def _named(step: Step) -> str:
    return f"    -> {step.own['name']}: {step.primitive}, {_parameters(step)}"


def _parameters(step: Step) -> str:
    """Its keys as a task file has them, shortly; the time in words."""
    shown = [f"{key} {_plain(value)}" for key, value in step.own.items() if key not in HIDDEN]
    if not {"beats", "seconds"} & step.own.keys():
        shown.append("1 beat")
    return ", ".join(shown)


def _plain(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_plain(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_plain, value)) + "]"
    return str(value)


def _words(words: tuple[object, ...]) -> str:
    return " ".join(map(str, words))


def _problem(problem: Problem, layout: Layout, known: list[str]) -> Iterator[str]:
    yield f"    NOT UNDERSTOOD: {problem.told(known)}"
    for line in excerpt(problem, layout.lines).splitlines():
        yield f"    {line}"

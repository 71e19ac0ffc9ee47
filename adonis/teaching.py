"""Lessons in English, at the command line: `check --explain`, `translate`, `words`."""

import sys
from typing import TYPE_CHECKING, Annotated

import typer

from adonis.arguments import BAD_INPUT, refuse

if TYPE_CHECKING:
    from specs.english.lesson import Lesson

ExplainOption = Annotated[
    bool,
    typer.Option("--explain", help="Of a lesson in English: what each word of it decided."),
]


def print_explanation(task: str) -> None:
    """Print sentence by sentence what was understood; ends the program if something was not."""
    lesson = _lesson(task)
    from specs.english.explaining import explain

    typer.echo(explain(lesson))
    if lesson.problems:
        count = len(lesson.problems)
        said = "one thing is" if count == 1 else f"{count} things are"
        typer.echo(f"adonis: {task}: {said} not understood, see above", err=True)
        sys.exit(BAD_INPUT)


def translate(
    task: Annotated[str, typer.Argument(metavar="LESSON", help="A lesson in English.")],
) -> None:
    """Print a lesson in English as the YAML task that it means."""
    from specs import SpecError, load_task, task_to_yaml

    try:
        spec, _ = load_task(task)
    except SpecError as problem:
        refuse(problem)
    typer.echo(task_to_yaml(spec), nl=False)


def words(
    word: Annotated[
        str | None, typer.Argument(metavar="WORD", help="What it means; without, all there are.")
    ] = None,
) -> None:
    """Print the words that lessons in English may use, or what one of them means."""
    from specs.english.problems import nearest, only_in
    from specs.english.reference import meanings, reference
    from specs.english.vocabulary import vocabulary

    if word is None:
        typer.echo(reference(), nl=False)
        return
    found = meanings(word)
    if not found:
        known = list(vocabulary().entries)
        phrases = only_in(vocabulary().phrases(word))
        near = nearest(word, known) or nearest(word, known, most=5, alike=0.4)
        refuse(f"unknown word {word!r}{phrases or near}")
    for line in found:
        typer.echo(line)


def _lesson(task: str) -> "Lesson":
    from specs import SpecError
    from specs.english.lesson import read_lesson
    from specs.loading import find_task
    from specs.reading import ENGLISH, text_of

    try:
        path = find_task(task)
        if path.suffix not in ENGLISH:
            raise SpecError(
                "is not in English (.txt or .md): there is nothing to explain", file=task
            )
        return read_lesson(text_of(path), str(path))
    except SpecError as problem:
        refuse(problem)

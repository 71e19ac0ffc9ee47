"""From the name of a body, or the path of a body file, to a body."""

from pathlib import Path

from sim import (
    BODIES,
    Body,
    BodyError,
    BodyFile,
    Source,
    build_body,
    load_body,
    read_model,
)
from specs.errors import SpecError
from specs.quoting import quoted_place
from specs.reading import Document, read_file
from specs.validating import validate

SUFFIXES = (".yaml", ".yml")


def find_body(name: str, *, limits: bool = True, contacts: bool = True) -> Body:
    """A body of the package by name, or that of a body file by path.

    Args:
        name: one of `sim.BODIES`, or a path that ends with .yaml.
        limits: joint limits on.
        contacts: collisions of the body with itself on.

    Raises:
        SpecError: there is neither, or the file makes no sense, with file, line and column.
    """
    if not is_body_file(name):
        try:
            return load_body(name, limits=limits, contacts=contacts)
        except BodyError as problem:
            hint = "" if name in BODIES else "; a body file ends with .yaml, see adonis body new"
            raise SpecError(f"{problem}{hint}") from None
    file, document = read_body_file(name)
    source = source_of(file, document)
    try:
        return build_body(source, file, limits=limits, contacts=contacts)
    except BodyError as problem:
        raise _placed(document, str(problem)) from None


def is_body_file(name: str) -> bool:
    """Whether a body is named by the path of its file."""
    return name not in BODIES and Path(name).suffix.lower() in SUFFIXES


def read_body_file(path: str | Path) -> tuple[BodyFile, Document]:
    """What a body file says.

    Raises:
        SpecError: with file, line and column.
    """
    document = read_file(Path(path))
    if not isinstance(document.data, dict):
        raise document.error("a body file has keys and values, as `adonis body new` writes it")
    if "task" in document.data and "body" not in document.data:
        raise document.error("this is a task, not a body", ("task",), key=True)
    return validate(document, (), document.data, BodyFile), document


def source_of(file: BodyFile, document: Document) -> Source:
    """The model that a body file is about.

    Raises:
        SpecError: it is not there, or no model.
    """
    folder = Path(document.file).parent
    try:
        return read_model(folder / file.model)
    except BodyError as problem:
        raise document.error(str(problem), ("model",)) from None


def _placed(document: Document, message: str) -> SpecError:
    """The error at the place of the first word in quotes that stands in the file."""
    path, key = quoted_place(document, (), message)
    return document.error(message, path, key=key)

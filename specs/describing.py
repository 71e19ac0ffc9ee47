"""What a parameter means: the comment beside a field of a model is its description.

    viscosity: float = 2.0  # [N m s/rad]

A comment on lines of its own is that of the field below it; one that begins with a capital says
what all fields below it have in common, down to the next comment or blank line.
"""

import ast
import inspect
import io
import textwrap
import tokenize
from functools import lru_cache

from pydantic import BaseModel


@lru_cache(maxsize=256)
def descriptions(model: type[BaseModel]) -> dict[str, str]:
    """The description of each field of a model that has one, its own or inherited."""
    found: dict[str, str] = {}
    for cls in reversed(model.__mro__):
        if issubclass(cls, BaseModel) and cls is not BaseModel:
            found |= _of_source(cls)
    named = {name: field.description for name, field in model.model_fields.items()}
    found |= {name: said for name, said in named.items() if said}
    return {name: said for name, said in found.items() if name in model.model_fields}


def summary(model: type[BaseModel]) -> str:
    """The first paragraph of a model's docstring, in one line."""
    said = inspect.cleandoc(model.__doc__ or "").split("\n\n")[0]
    return " ".join(said.split())


def _of_source(cls: type) -> dict[str, str]:
    try:
        source = textwrap.dedent(inspect.getsource(cls))
    except (OSError, TypeError):  # made while the program runs
        return {}
    beside, alone = _comments(source)
    blank = {k for k, line in enumerate(source.splitlines(), start=1) if not line.strip()}
    (tree,) = ast.parse(source).body
    assert isinstance(tree, ast.ClassDef)
    found: dict[str, str] = {}
    for node in tree.body:
        if not isinstance(node, ast.AnnAssign) or not isinstance(node.target, ast.Name):
            continue
        lines = range(node.lineno, (node.end_lineno or node.lineno) + 1)
        own = " ".join(beside[k] for k in lines if k in beside)
        common = _above(node.lineno, alone, blank)
        said = f"{common.rstrip('.')}: {own}" if own and common else own or common
        if said:
            found[node.target.id] = said
    return found


def _above(line: int, alone: dict[int, str], blank: set[int]) -> str:
    """The comment above a line, or above the fields that it is one of."""
    k = line - 1
    while k > 0 and k not in alone and k not in blank:
        k -= 1
    end = k
    while k in alone:
        k -= 1
    said = " ".join(alone[j] for j in range(k + 1, end + 1))
    return said if end == line - 1 or said[:1].isupper() else ""


def _comments(source: str) -> tuple[dict[int, str], dict[int, str]]:
    """Comments by line: those beside code, and those that have a line to themselves."""
    beside: dict[int, str] = {}
    alone: dict[int, str] = {}
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            said = token.string.lstrip("# ").strip()
            (alone if not token.line[: token.start[1]].strip() else beside)[token.start[0]] = said
    return beside, alone

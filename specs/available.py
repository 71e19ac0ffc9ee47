"""Which primitives there are: those of the package, and those that other packages add."""

import importlib
import importlib.util
import sys
from collections.abc import Iterable
from functools import lru_cache
from importlib.metadata import entry_points
from pathlib import Path

from primitives import (
    AvoidCollisions,
    CompensateGravity,
    Follow,
    GetPosture,
    GoToPoint,
    Hold,
    LookAt,
    Oscillate,
    PointAt,
    Primitive,
    Relax,
)
from specs.errors import SpecError

ENTRY_POINT = "adonis.primitives"
BUILT_IN: tuple[type[Primitive], ...] = (
    GetPosture,
    GoToPoint,
    Oscillate,
    Follow,
    PointAt,
    LookAt,
    Hold,
    Relax,
    AvoidCollisions,
    CompensateGravity,
)


def available_primitives(extra: Iterable[type[Primitive]] = ()) -> dict[str, type[Primitive]]:
    """Primitive classes by the name that a task file uses.

    Args:
        extra: classes of one's own; an installed package announces its own through an entry
            point of the group `adonis.primitives`.

    Raises:
        SpecError: two of them share a name, or a class gives its `kind` no value.
    """
    found: dict[str, type[Primitive]] = {}
    for cls in (*BUILT_IN, *_announced(), *extra):
        kind = cls.model_fields["kind"].default
        if not isinstance(kind, str) or not kind:
            raise SpecError(f"{cls.__name__} needs a name: kind: Literal['…'] = '…'")
        if kind in found and found[kind] is not cls:
            raise SpecError(
                f"two primitives are called {kind!r}: {found[kind].__qualname__} of"
                f" {found[kind].__module__} and {cls.__qualname__} of {cls.__module__}"
            )
        found[kind] = cls
    return found


def primitives_in(source: str) -> list[type[Primitive]]:
    """The primitives that a Python file or module defines.

    Args:
        source: path of a `.py` file, or the name of a module that can be imported.

    Raises:
        SpecError: there is no such file or module, it fails, or it defines none.
    """
    path = Path(source)
    try:
        if path.suffix == ".py":
            if not path.is_file():
                raise SpecError("no such file", file=source)
            name = f"_primitives_of_{path.stem}"
            found = importlib.util.spec_from_file_location(name, path)
            if found is None or found.loader is None:
                raise SpecError("is not a Python file", file=source)
            module = importlib.util.module_from_spec(found)
            sys.modules[name] = module
            found.loader.exec_module(module)
        else:
            module = importlib.import_module(source)
    except SpecError:
        raise
    except Exception as problem:  # whatever the user's own code raises
        said = f"{type(problem).__name__}: {problem}"
        raise SpecError(f"cannot be imported: {said}", file=source) from problem
    own = [
        cls
        for cls in vars(module).values()
        if isinstance(cls, type)
        and issubclass(cls, Primitive)
        and cls.__module__ == module.__name__
        and "kind" in cls.model_fields
        and cls.model_fields["kind"].default is not None
    ]
    if not own:
        raise SpecError("defines no primitive (a subclass of primitives.Primitive)", file=source)
    return own


@lru_cache(maxsize=1)
def _announced() -> tuple[type[Primitive], ...]:
    return tuple(point.load() for point in entry_points(group=ENTRY_POINT))

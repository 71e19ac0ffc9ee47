"""Which primitives there are: those of the package, and those that other packages add."""

from collections.abc import Iterable
from functools import lru_cache
from importlib.metadata import entry_points

from primitives import AvoidCollisions, CompensateGravity, GetPosture, GoToPoint, Primitive
from specs.errors import SpecError

ENTRY_POINT = "adonis.primitives"
BUILT_IN: tuple[type[Primitive], ...] = (GetPosture, GoToPoint, AvoidCollisions, CompensateGravity)


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


@lru_cache(maxsize=1)
def _announced() -> tuple[type[Primitive], ...]:
    return tuple(point.load() for point in entry_points(group=ENTRY_POINT))

"""What there is to use: `adonis list`."""

from collections.abc import Mapping

from rich.console import Console
from rich.table import Table

from primitives import Primitive
from sim import BODIES, load_body
from specs import library, load_task


def print_catalogue(console: Console, kinds: Mapping[str, type[Primitive]]) -> None:
    """The tasks of the library, the bodies with their landmarks, and the primitives."""
    table = Table("task", "what it is", "sub-tasks", title="Tasks", title_justify="left")
    for name in library():
        spec, _ = load_task(name)
        table.add_row(name, spec.title, str(len(spec.subtasks)))
    console.print(table)
    table = Table(
        "body", "limbs and joint groups", "landmarks", title="Bodies", title_justify="left"
    )
    alike: dict[tuple[tuple[str, ...], ...], list[str]] = {}
    for name in BODIES:
        names = load_body(name).map
        parts = *names.limbs, *(group for group in names.groups if names.groups[group])
        alike.setdefault((parts, tuple(sorted(names.landmarks))), []).append(name)
    for (parts, landmarks), bodies in alike.items():
        table.add_row("\n".join(bodies), "\n".join(parts), ", ".join(landmarks))
    console.print(table)
    console.print("Anybody else: --body adonis:height=1.3,weight=28,sex=female,age=9", markup=False)
    table = Table(
        "primitive", "what it does", "parameters", title="Primitives", title_justify="left"
    )
    for name, cls in kinds.items():
        said = (cls.__doc__ or "").strip().splitlines()
        parameters = ", ".join(k for k in cls.model_fields if k != "kind")
        table.add_row(name, said[0] if said else "", parameters)
    console.print(table)

"""What an adaptation says in the terminal: the factors of the laws, what was tuned, the changes."""

from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from adonis.adapting.knobs import KNOBS
from adonis.adapting.searching import Found
from adonis.adapting.trying import Mark
from sim import Body, Law, Likeness

RIGHT, LEFT = "right_", "left_"
WHOLE = (  # of the whole body: what, by which law
    ("length", "length"),
    ("time", "time"),
    ("velocity", "velocity"),
    ("angular velocity", "angular_velocity"),
    ("jerk", "jerk"),
)
OF_JOINT = ("inertia", "torque", "torsional_stiffness", "torsional_damping")
OF_HAND = ("mass", "force", "stiffness", "damping")


def print_laws(console: Console, like: Likeness, one: Body, other: Body) -> None:
    """The table of factors between two bodies (Hodgins & Pollard 1997, figure 3)."""
    whole = like.whole
    said = ", ".join(f"{what} {getattr(whole, law):.3g}" for what, law in WHOLE)
    names = f"from {escape(one.map.name)} to {escape(other.map.name)}"
    console.print(f"Factors {names}: {said}; and by what moves:", soft_wrap=True)
    table = Table("what moves")
    for head in ("I or M", "torque or force", "stiffness", "damping"):
        table.add_column(head, justify="right")
    for name, law in _joined(like.joints):
        table.add_row(escape(name), *_factors(law, OF_JOINT))
    for name, law in _joined(like.hands):
        table.add_row(escape(f"{name}, at the palm"), *_factors(law, OF_HAND))
    table.add_row("a scale model: joints", *_factors(whole, OF_JOINT), style="dim")
    table.add_row("a scale model: hands", *_factors(whole, OF_HAND), style="dim")
    console.print(table)


def print_found(console: Console, found: Found) -> None:
    """What the search came to, against what it began with."""
    console.print(
        f"By the laws alone: {_said(found.start)}. The best of {found.tried} tried:"
        f" {_said(found.mark)}.",
        soft_wrap=True,
    )
    turned = [
        f"{knob.about} {found.factors[knob.name]:g}"
        for knob in KNOBS
        if found.factors.get(knob.name, 1.0) != 1.0
    ]
    if turned:
        console.print(f"Factors that were tuned: {', '.join(turned)}.", soft_wrap=True)


def print_difference(console: Console, lines: Sequence[str]) -> None:
    """Lines of `diff -u`, coloured."""
    colors = {"+": "green", "-": "red", "@": "dim"}
    for line in lines:
        console.print(escape(line), style=colors.get(line[:1]), soft_wrap=True, highlight=False)


def _said(mark: Mark) -> str:
    if mark.failures == 0:
        return f"{mark.passed} sub-tasks and every check [green]succeed[/green]"
    of_all = "sub-task or check fails" if mark.failures == 1 else "sub-tasks or checks fail"
    return f"{mark.passed} sub-tasks succeed, [red]{mark.failures} {of_all}[/red]"


def _factors(law: Law, quantities: Sequence[str]) -> list[str]:
    return [f"{getattr(law, quantity):.3g}" for quantity in quantities]


def _joined(laws: Mapping[str, Law]) -> list[tuple[str, Law]]:
    """Laws by name; where both sides have the same, once for both."""
    rows: list[tuple[str, Law]] = []
    for name, law in laws.items():
        plain = name.removeprefix(RIGHT).removeprefix(LEFT)
        right, left = (laws.get(side + plain) for side in (RIGHT, LEFT))
        if right is None or left is None or not _near(right, left):
            rows.append((name, law))
        elif name.startswith(RIGHT):
            rows.append((plain, law))
    return rows


def _near(one: Law, other: Law) -> bool:
    pairs = ((one.mass, other.mass), (one.inertia, other.inertia))
    return all(abs(a - b) <= 1e-3 * a for a, b in pairs)

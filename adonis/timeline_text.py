"""A timeline as text for the terminal."""

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from adonis.timeline import Row, Timeline

PLANNED, TAKES_OVER, RUNS, HOLDS = "░", "▒", "█", "─"
COLORS = {"done": "green", "timed out": "red", "running": "yellow", "ended": "yellow"}
LEAST_CELLS = 24


def print_timeline(console: Console, shown: Timeline) -> None:
    """A bar for each sub-task as planned and, of a run, one below it as it ran."""
    names = [_name(row) for row in shown.rows]
    widest = max(len(line) for text in names for line in text.plain.splitlines())
    name = min(widest, max(console.width // 4, 12))
    said = [_when(shown, row) for row in shown.rows]
    when = max(len(line) for text in said for line in text.plain.splitlines())
    moves = min(max(len(_moves(row)) for row in shown.rows), 14)
    cells = max(console.width - name - moves - when - 6, LEAST_CELLS)
    table = Table(title=escape(shown.title), title_justify="left", box=None, pad_edge=False)
    table.add_column("sub-task", width=name, no_wrap=True, overflow="ellipsis")
    table.add_column("moves", width=moves, overflow="fold", style="dim")
    table.add_column(_axis(shown.end, cells), width=cells, no_wrap=True)
    table.add_column("s", width=when, no_wrap=True)
    for row, label, text in zip(shown.rows, names, said, strict=True):
        table.add_row(label, _moves(row), _bars(shown, row, cells), text)
    console.print(table)
    legend = f"{PLANNED} planned"
    if shown.recorded:
        legend += f"  {TAKES_OVER} takes over  {RUNS} runs  {HOLDS} holds its goal"
    console.print(legend, style="dim")


def extent(start: float, end: float, cells: int) -> tuple[int, int]:
    """First cell of a bar, and the one after its last: at least one, of so many.

    Args:
        start: share of the whole at which it begins.
        end: and at which it ends.
        cells: of the whole.
    """
    first = min(int(start * cells), cells - 1)
    last = max(int(np.ceil(end * cells - 1e-9)), first + 1)
    return first, min(last, cells)


def _bars(shown: Timeline, row: Row, cells: int) -> Text:
    """The planned bar and, of a run, the actual one below."""

    def draw(line: list[str], start: float, end: float, sign: str) -> None:
        first, last = extent(start / shown.end, end / shown.end, cells)
        line[first:last] = sign * (last - first)

    plan = [" "] * cells
    draw(plan, *row.planned, PLANNED)
    text = Text("".join(plan), style="dim")
    if not shown.recorded:
        return text
    ran = [" "] * cells
    if row.ran:
        over = row.ended if np.isfinite(row.ended) else row.let_go
        draw(ran, row.began, row.let_go, HOLDS)
        draw(ran, row.began, over, RUNS)
        if row.took_from:
            draw(ran, row.began, min(row.began + row.hand_over, over), TAKES_OVER)
    return text.append("\n" + "".join(ran), style=f"not dim {COLORS.get(row.outcome, '')}")


def _name(row: Row) -> Text:
    """Its name; below it its conditions, and whose joints it took."""
    said = [row.subtask.circumstances] if row.subtask.circumstances else []
    said += [f"from {', '.join(row.took_from)}"] if row.took_from else []
    text = Text(row.subtask.name)
    return text.append("".join(f"\n{line}" for line in said), style="dim")


def _when(shown: Timeline, row: Row) -> Text:
    """Planned times; below them those of the run, and what became of it."""
    text = Text(f"{row.planned[0]:.2f}-{row.planned[1]:.2f}", style="dim")
    if not shown.recorded:
        return text
    text.append("\n")
    if row.ran:
        end = f"{row.ended:.2f}" if np.isfinite(row.ended) else "…"
        text.append(f"{row.began:.2f}-{end} ", style="not dim")
    return text.append(row.became, style=f"not dim {COLORS.get(row.outcome, '')}")


def _moves(row: Row) -> str:
    return ", ".join(row.moves).replace("_", " ")


def _axis(end: float, cells: int) -> Text:
    """Seconds along the bars."""
    step = next(s for s in _nice() if s / end * cells >= 6)
    line = [" "] * cells
    for k in range(int(end / step) + 1):
        label, place = f"{k * step:g}", int(k * step / end * cells)
        if place + len(label) <= cells:
            line[place : place + len(label)] = label
    return Text("".join(line), style="not bold dim")


def _nice() -> "tuple[float, ...]":
    """Steps of an axis [s]."""
    return tuple(m * 10.0**e for e in range(-3, 9) for m in (1, 2, 5))

"""Tables in the terminal."""

from rich.console import JustifyMethod
from rich.markup import escape
from rich.table import Table


def headed(title: str, *columns: tuple[str, JustifyMethod]) -> Table:
    """An empty table: its title, and the heading of each column with the side it keeps to."""
    table = Table(title=escape(title), title_justify="left")
    for heading, justify in columns:
        table.add_column(heading, justify=justify)
    return table

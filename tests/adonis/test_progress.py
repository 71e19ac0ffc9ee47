"""Long work says how far it is, where there is no terminal too."""

import io

import pytest
from rich.console import Console

from adonis import progress as module
from adonis.progress import progress


def test_lines_are_printed_where_there_is_no_terminal(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "PAUSE", 0.0)
    with progress(Console(file=io.StringIO()), "beginning") as tell:
        tell(0.25, "rehearsing: nape")
        tell(0.5, "rehearsing: [out]")
    assert capsys.readouterr().err == " 25 %  rehearsing: nape\n 50 %  rehearsing: [out]\n"


def test_what_is_soon_over_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with progress(Console(file=io.StringIO()), "beginning") as tell:
        tell(0.25, "moving")
    assert capsys.readouterr().err == ""


def test_a_terminal_gets_a_bar_that_is_gone_again() -> None:
    shown = io.StringIO()
    console = Console(file=shown, force_terminal=True, width=80)
    with progress(console, "beginning") as tell:
        tell(0.5, "rehearsing: [out]")
    assert "rehearsing: [out]" in shown.getvalue()

"""Events on the command line: `--send EVENT@SECONDS`."""

import pytest

from adonis.errors import InputError
from adonis.performing import events_of


def test_an_event_and_its_time() -> None:
    assert events_of(["go@1.5", "a@b@2"], ["go", "a@b"]) == [(1.5, "go"), (2.0, "a@b")]


@pytest.mark.parametrize("said", ["go", "go@x", "@1", "go@-1", "go@nan", "go@inf"])
def test_what_is_no_event_at_a_time_is_refused(said: str) -> None:
    with pytest.raises(InputError, match=r"expected EVENT@SECONDS, such as go@1\.5, not"):
        events_of([said], ["go"])


def test_an_event_that_nothing_waits_for_is_refused() -> None:
    with pytest.raises(InputError, match=r"unknown event 'stpo'.*'stop'"):
        events_of(["stpo@1"], ["stop"])

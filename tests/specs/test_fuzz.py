"""A short run of `tests/fuzz_yaml.py`, which has a longer one as a command."""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_damaged_files_are_read_or_refused_and_nothing_else_happens() -> None:
    """In a process of its own: what watches a process cannot be taken off again."""
    command = [sys.executable, str(ROOT / "tests" / "fuzz_yaml.py"), "--count", "600"]
    ended = subprocess.run(
        [*command, "--processes", "1", "--patience", "10"],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert json.loads(ended.stdout)["outcomes"].keys() == {"refused", "sound"}

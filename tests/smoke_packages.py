"""Build wheel and sdist, install each into an empty place, and use it from there.

The dependencies are those of the environment that runs this: what is tested is that the
packages hold everything of ours, not that an index can be reached.
"""

import os
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
USES = (
    ["-m", "adonis", "--help"],
    ["-m", "adonis", "check", "macarena"],
    ["-c", "from specs import SHIPPED_SCHEMA; SHIPPED_SCHEMA.read_text()"],
    ["-c", "import adonis, arbiter, primitives, sim, specs; print(sim.__file__)"],
)


def call(command: list[str], **options: object) -> str:
    """Run a command; its output is shown if it fails."""
    ended = subprocess.run(command, capture_output=True, text=True, check=False, **options)  # type: ignore[call-overload]
    if ended.returncode:
        sys.exit(f"{' '.join(command)}\n{ended.stdout}{ended.stderr}")
    return str(ended.stdout)


def main() -> None:
    """Exit with an error if a package cannot be built or does not work on its own."""
    with tempfile.TemporaryDirectory() as folder:
        made, empty = Path(folder) / "dist", Path(folder) / "elsewhere"
        empty.mkdir()
        python = sys.executable
        call([python, "-m", "build", "--no-isolation", "--outdir", str(made), str(ROOT)])
        (sdist,) = made.glob("*.tar.gz")
        (wheel,) = made.glob("*.whl")
        with tarfile.open(sdist) as archive:
            names = {Path(name).name for name in archive.getnames()}
        assert {"LICENSE", "README.md", "macarena.yaml", "py.typed"} <= names
        for package in (wheel, sdist):
            target = Path(folder) / package.suffix.strip(".")
            pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
            options = ["--no-deps", "--no-build-isolation", "--target", str(target), str(package)]
            call([*pip, *options], cwd=empty)
            for use in USES:
                said = call(
                    [python, *use], cwd=empty, env={**os.environ, "PYTHONPATH": str(target)}
                )
            assert str(target) in said, f"{package.name} was not what was imported: {said}"
            print(f"{package.name}: works on its own")


if __name__ == "__main__":
    main()

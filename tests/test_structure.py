"""The house is built as its plan says: floors, public names, nothing heavy at the door."""

import ast
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FLOORS = ("sim", "primitives", "specs", "arbiter", "adonis")  # from the ground up
# Third parties that only these may import.
OWNERS = {
    "mujoco": {"sim"},
    "numba": {"primitives", "arbiter"},
    "ruamel": {"specs"},
    "lark": {"specs"},
    "networkx": {"specs", "arbiter"},
    "typer": {"adonis"},
    "cmaes": {"adonis"},
    "rich": {"adonis"},
    "matplotlib": {"adonis"},
    "mink": {"sim"},
    "daqp": {"arbiter"},
    "scipy": {"adonis", "sim"},
    "collada": {"sim"},
    "platformdirs": {"adonis"},
    "jinja2": {"adonis"},
}
FILES = [path for floor in FLOORS for path in sorted((ROOT / floor).rglob("*.py"))]


def imports(path: Path) -> set[str]:
    """Full names of everything that a file imports."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are written in full"
            found.add(node.module or "")
    return found


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


@pytest.mark.parametrize("path", FILES, ids=module_of)
def test_no_arrow_runs_up_and_libraries_stay_with_their_owners(path: Path) -> None:
    own = module_of(path)
    floor = FLOORS.index(own.split(".")[0])
    for name in imports(path):
        package = name.split(".")[0]
        if package in FLOORS:
            assert FLOORS.index(package) <= floor, f"{own} imports {name} from above"
        if package in OWNERS:
            allowed = OWNERS[package]
            assert own.split(".")[0] in allowed or own in allowed, f"{own} imports {name}"


def test_imports_have_no_cycles() -> None:
    import networkx as nx

    modules = {module_of(path): imports(path) for path in FILES}
    graph = nx.DiGraph(
        (own, name)
        for own, names in modules.items()
        for name in names
        if name in modules and name != own
    )
    # A package's own files import each other directly, never the package that gathers them.
    assert nx.is_directed_acyclic_graph(graph), nx.find_cycle(graph)


@pytest.mark.parametrize("floor", FLOORS)
def test_public_names_exist_and_are_documented(floor: str) -> None:
    package = importlib.import_module(floor)
    names = getattr(package, "__all__", [])
    assert sorted(names) == sorted(set(names))
    for name in names:
        value = getattr(package, name)
        if callable(value):
            assert value.__doc__, f"{floor}.{name} has no docstring"
    assert (ROOT / floor / "py.typed").exists()


@pytest.mark.parametrize("floor", FLOORS)
def test_everything_imported_into_a_package_is_public(floor: str) -> None:
    package = importlib.import_module(floor)
    tree = ast.parse((ROOT / floor / "__init__.py").read_text())
    brought = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert brought == set(getattr(package, "__all__", []))


def test_help_needs_nothing_heavy() -> None:
    code = "import sys, adonis.cli; print(*sys.modules)"
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    loaded = set(ended.stdout.split())
    assert not loaded & {"mujoco", "numpy", "numba", "matplotlib", "networkx", "pydantic"}


def test_every_module_can_be_imported() -> None:
    for floor in FLOORS:
        package = importlib.import_module(floor)
        for module in pkgutil.walk_packages(package.__path__, floor + "."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)


def test_files_hold_one_idea_each() -> None:
    long = [p.name for p in FILES if len(p.read_text().splitlines()) > 450]
    assert not long

"""Every example runs, and so does what README and docs show."""

import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from sim import Body
from specs import SpecError, bind_task, task_from_text
from specs.english.explaining import explain
from specs.english.lesson import read_lesson
from specs.english.reference import reference

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def shown(wanted: str) -> list:
    """The blocks of one language in all pages."""
    return [
        pytest.param(text, id=f"{page.name}-{number}")
        for page in PAGES
        for number, (kind, text) in enumerate(BLOCK.findall(page.read_text(encoding="utf-8")))
        if kind == wanted
    ]


def run(code: list[str], where: Path) -> str:
    ended = subprocess.run(
        [sys.executable, *code],
        cwd=where,
        env={**os.environ, "PYTHONPATH": str(ROOT), "MUJOCO_GL": "disable"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.name)
def test_an_example_runs_and_is_short(path: Path, tmp_path: Path) -> None:
    assert len(path.read_text().splitlines()) < 80
    assert run([str(path)], tmp_path).strip()


def test_the_salute_succeeds_at_its_tempos(tmp_path: Path) -> None:
    said = run([str(ROOT / "examples" / "02_salute.py")], tmp_path)
    for tempo in (60, 90):
        assert f"at {tempo} bpm all 2 sub-tasks succeed" in said
    place = "02_salute.yaml:16:16"
    assert f"{place}: salute: unknown landmark 'head.rihgt'; did you mean 'head.right'?" in said


def test_the_mistake_in_the_documentation_is_what_one_sees(body: Body) -> None:
    """The hello.yaml of README with the typing error of docs/tasks.md."""
    (hello,) = (text.values[0] for text in shown("yaml") if "task: hello" in text.values[0])
    spec, document = task_from_text(hello.replace("head.front", "head.font"), "hello.yaml")
    with pytest.raises(SpecError) as caught:
        bind_task(spec, body, document)
    shortened = re.sub(r"there are: .*\)", "there are: …)", str(caught.value))
    assert shortened in (ROOT / "docs" / "tasks.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("text", shown("python"))
def test_python_in_the_documentation_runs(text: str, tmp_path: Path) -> None:
    script = tmp_path / "shown.py"
    script.write_text(text)
    run([str(script)], tmp_path)


@pytest.mark.parametrize("text", shown("yaml"))
def test_tasks_in_the_documentation_bind(text: str, body: Body) -> None:
    spec, document = task_from_text(text, "shown.yaml")
    bind_task(spec, body, document)


@pytest.mark.parametrize("text", shown("lesson"))
def test_lessons_in_the_documentation_bind(text: str, body: Body) -> None:
    spec, document = task_from_text(text, "shown.txt")
    bind_task(spec, body, document)


def test_the_page_on_english_shows_what_one_sees() -> None:
    """The mistake, the explanation and the vocabulary that it prints."""
    page = (ROOT / "docs" / "english.md").read_text(encoding="utf-8")
    with pytest.raises(SpecError) as caught:
        task_from_text("Raise your arm.", "hello.txt")
    assert textwrap.indent(str(caught.value), "    ") in page
    lesson = read_lesson("Nod.\n\nPut your right hand on your hip, slowly.", "hello.txt")
    explained = explain(lesson).split("\n\n")[-1]
    assert textwrap.indent(explained, "    ") in page
    assert page.split("<!-- vocabulary -->\n")[1].split("<!-- end -->")[0] == reference()


@pytest.mark.parametrize("text", shown("sh"))
def test_commands_in_the_documentation_exist(text: str, tmp_path: Path) -> None:
    """Those of adonis are asked for their help with the same options; make targets exist."""
    makefile = (ROOT / "Makefile").read_text()
    for line in text.splitlines():
        words = line.split("#")[0].split()
        if words[:1] == ["make"]:
            assert re.search(rf"^{words[1]}:", makefile, re.MULTILINE), line
        elif words[:1] == ["adonis"]:
            helped = run(["-m", "adonis", words[1], "--help"], tmp_path)
            for word in words[2:]:
                if word.startswith("--"):
                    assert word.split("=")[0] in helped, line


def test_links_between_pages_lead_somewhere() -> None:
    for page in PAGES:
        for target in re.findall(r"\]\((?!https?:|#)([^)#]+)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"

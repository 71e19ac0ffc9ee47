"""Lessons in English at the command line."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from adonis.cli import app
from specs import load_task, task_from_text


def adonis(*arguments: str) -> tuple[int, str, str]:
    ended = CliRunner().invoke(app, list(arguments))
    return ended.exit_code, ended.stdout, ended.stderr


@pytest.fixture
def lesson(tmp_path: Path) -> Path:
    path = tmp_path / "lesson.txt"
    path.write_text("Raise your right arm slowly, please.\nLook at it.\n")
    return path


def test_check_explains_a_lesson(lesson: Path) -> None:
    code, said, _ = adonis("check", str(lesson), "--explain")
    assert code == 0
    assert "1-raise-right-arm: get-posture" in said
    assert "'it' is the right one, used last" in said
    assert "no effect: please" in said
    assert "Nothing wrong was found." in said


def test_a_mistake_is_explained_where_it_stands(lesson: Path) -> None:
    lesson.write_text("Nod.\nTouch your haed.\n")
    code, said, wrong = adonis("check", str(lesson), "--explain")
    assert code == 2
    assert "1-nod-neck-y: oscillate" in said
    assert "NOT UNDERSTOOD: unknown word 'haed'; did you mean 'head'" in said
    assert "one thing is not understood" in wrong
    code, said, wrong = adonis("check", str(lesson))
    assert code == 2
    assert f"{lesson}:2:12: unknown word 'haed'" in wrong


def test_yaml_is_not_explained() -> None:
    code, _, wrong = adonis("check", "macarena", "--explain")
    assert code == 2
    assert "is not in English" in wrong


def test_graph_and_translation_of_a_lesson(lesson: Path) -> None:
    code, said, _ = adonis("graph", str(lesson))
    assert code == 0
    assert "Raise your right arm slowly" in said
    code, said, _ = adonis("translate", str(lesson))
    assert code == 0
    assert task_from_text(said, "lesson.yaml")[0] == load_task(lesson)[0]
    code, _, wrong = adonis("translate", "nothing.txt")
    assert code == 2
    assert "nothing.txt" in wrong


def test_words_are_listed_and_looked_up() -> None:
    code, said, _ = adonis("words")
    assert code == 0
    assert "### Verbs" in said
    code, said, _ = adonis("words", "touch")
    assert code == 0
    assert "go-to-point" in said
    _, _, wrong = adonis("words", "shimmy")
    assert "did you mean 'simply' or 'tummy'" in wrong
    _, _, wrong = adonis("words", "loose")
    assert "known only in 'hang loose'" in wrong
    code, _, wrong = adonis("words", "tuch")
    assert code == 2
    assert "did you mean 'touch'" in wrong

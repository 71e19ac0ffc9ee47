"""Lessons in English: what sentences mean, what is refused and how, and nothing else."""

from pathlib import Path

import pytest

from specs import SpecError, build_graph, task_from_text, task_to_yaml
from specs.english.explaining import explain
from specs.english.lesson import read_lesson
from specs.reading import read_text

HERE = Path(__file__).parent
TABLE = read_text(
    (HERE / "english_sentences.yaml").read_text(encoding="utf-8"), "english_sentences.yaml"
).data


def meaning(text: str) -> list[dict[str, object]]:
    """The sub-tasks of a text as the table writes them."""
    subtasks = read_lesson(text, "said.txt").document.data["subtasks"]
    place = {subtask["name"]: k for k, subtask in enumerate(subtasks, start=1)}
    rows = []
    for subtask in subtasks:
        row = {k: v for k, v in subtask.items() if k not in ("name", "words")}
        if "after" in row:
            row["after"] = [place[name] for name in row["after"]]
        rows.append(row)
    return rows


@pytest.mark.parametrize("row", TABLE["means"], ids=lambda row: row["say"].strip())
def test_a_sentence_means(row: dict) -> None:
    assert meaning(row["say"]) == row["means"]
    spec, document = task_from_text(row["say"], "said.txt")
    build_graph(spec, document)
    assert task_from_text(task_to_yaml(spec))[0] == spec


@pytest.mark.parametrize("row", TABLE["refused"], ids=lambda row: row["say"])
def test_a_sentence_is_refused(row: dict) -> None:
    with pytest.raises(SpecError) as caught:
        task_from_text(row["say"], "said.txt")
    said, shown, carets, *more = str(caught.value).split("\n")
    assert not more
    assert said.split(": ", 1)[1] == row["refused"]
    assert shown.strip() == row["say"]
    begin, end = carets.index("^"), carets.rindex("^") + 1
    assert caught.value.column == begin - 3
    underlined = shown[begin:end]
    assert underlined.split()[0] == row["at"].split()[0]
    assert underlined.split()[-1] == row["at"].split()[-1]
    assert row["refused"].split(";")[0] in explain(read_lesson(row["say"], "said.txt"))

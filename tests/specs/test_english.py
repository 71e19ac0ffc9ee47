"""Lessons in English: what sentences mean, what is refused and how, and nothing else."""

import sys
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim import Body
from specs import SpecError, bind_task, build_graph, load_task, task_from_text, task_to_yaml
from specs.english.explaining import explain
from specs.english.lesson import read_lesson
from specs.english.reference import meanings, reference
from specs.english.vocabulary import vocabulary
from specs.reading import read_text

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))
from fuzz_english import fuzz  # noqa: E402

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
def test_a_sentence_means(row: dict, body: Body) -> None:
    assert meaning(row["say"]) == row["means"]
    spec, document = task_from_text(row["say"], "said.txt")
    if "beyond" not in row:
        bind_task(spec, body, document)  # what is said so is not refused by the body
    else:
        with pytest.raises(SpecError, match=row["beyond"]):
            bind_task(spec, body, document)
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


def test_the_table_is_as_large_as_was_promised() -> None:
    assert len(TABLE["means"]) >= 60
    assert len(TABLE["refused"]) >= 20


def test_the_words_of_the_paper_mean_what_macarena_yaml_does(body: Body) -> None:
    """Primitive, limb and goal of all twelve; the ways of the hands are left to a rehearsal."""
    (said, document), (written, _) = load_task("macarena-words"), load_task("macarena")
    bind_task(said, body, document)
    assert said.rehearse
    assert not written.rehearse
    lasts = build_graph(said).lasts, build_graph(written).lasts
    assert said.tempo == written.tempo
    assert said.background == written.background
    for one, other in zip(said.subtasks, written.subtasks, strict=True):
        assert one.words == other.words
        assert one.does.kind == other.does.kind
        assert lasts[0](one.name) == lasts[1](other.name)
        for key in ("limb", "to", "posture"):
            assert getattr(one.does, key, None) == getattr(other.does, key, None)


@pytest.mark.parametrize("path", sorted(HERE.glob("lessons/*")), ids=lambda path: path.stem)
def test_other_wordings_of_the_dance_compile(path: Path, body: Body) -> None:
    """Both hands go out, turn over, cross, go behind the head, down and to the hips."""
    spec, document = load_task(path)
    bind_task(spec, body, document)
    for limb, side in (("right_arm", "right"), ("left_arm", "left")):
        mine = [s.does for s in spec.subtasks if getattr(s.does, "limb", None) == limb]
        out, over, crossed, behind, down, hip = mine
        assert out.posture == {"arm": "forward", "elbow": "straight", "palm": "down"}
        assert over.posture == {"arm": "forward", "elbow": "straight", "palm": "up"}
        other = "left" if side == "right" else "right"
        assert crossed.to in (f"{other}_shoulder.top", f"{other}_elbow.inside")
        assert behind.to == f"head.back_{side}"
        assert down.to in (f"{other}_ribs", f"{other}_hip.front")
        assert hip.to == f"{side}_hip"


def test_lists_headings_comments_and_wrapped_lines() -> None:
    lesson = read_lesson(
        "Greeting\n========\n\ntempo: 90 bpm\nsource: a friend\n\n"
        "<!-- to the audience -->\n"
        "1. Raise your right arm and\n"
        "   look at it.  # slowly would be nicer\n"
        "2) Nod. Then bow;\n"
        "- Touch your head,\n"
        "Then lower your arm.\n"
        "## The end\n"
        "Wave\n"
        "***\n",
        "a greeting!.txt",
    )
    assert [told.text for told in lesson.told] == [
        "Raise your right arm and look at it",
        "Nod",
        "Then bow",
        "Touch your head, Then lower your arm",
        "Wave",
    ]
    data = lesson.document.data
    assert data["task"] == "a-greeting"
    assert data["title"] == "Greeting"
    assert data["source"] == "a friend"
    assert data["tempo"] == 90
    assert [s["words"] for s in data["subtasks"]][:3] == [
        "Raise your right arm",
        "look at it",
        "Nod",
    ]


def test_all_that_is_wrong_is_said_at_once() -> None:
    text = "Tuch your head.\nNod.\nRaise your armm and wqve.\nJump.\n"
    with pytest.raises(SpecError) as caught:
        task_from_text(text, "wrong.txt")
    said = str(caught.value)
    for place in ("wrong.txt:1:1: ", "wrong.txt:3:12: ", "wrong.txt:3:21: ", "wrong.txt:4:1: "):
        assert place in said
    assert said.count("^") == len("Tuch" + "armm" + "wqve" + "Jump")
    assert (caught.value.line, caught.value.column) == (1, 1)
    explained = explain(read_lesson(text, "wrong.txt"))
    assert explained.count("NOT UNDERSTOOD") == 4
    assert "-> 2-nod-neck-y: oscillate" in explained


def test_good_lines_are_explained_beside_bad_ones() -> None:
    """Each problem once, under its own sentence, also where sentences share a line."""
    text = "Nod. Raise your left elbow. Shimmy.\nBow.\n"
    explained = explain(read_lesson(text, "mixed.txt"))
    assert explained.count("NOT UNDERSTOOD") == 2
    for step in ("-> 1-nod-neck-y: oscillate", "-> 4-bow-waist: get-posture"):
        assert step in explained
    assert explained.index("Shimmy\n") > explained.index("not of 'your left elbow'")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Touch your left ear.", "'your left ear' is head.left"),
        ("Put your left hand on your right upper arm.", "upper arm' is right_elbow.inside"),
        ("Put your right hand on your waist.", "'your waist' is right_hip, for the right hand"),
        ("Swing your arms.", "both together; else say 'alternately'"),
        ("Clap.", "once"),
        ("Push your hands up.", "palm up, the way it is pushed; elbow bent by 35 degrees"),
        (
            "Turn your body to the left, keep your head forward.",
            "'Turn your head 30 degrees to the",
        ),
        ("Touch your left wrist.", "'your left wrist' is the palm of the left hand"),
        ("Lift your right forearm up.", "'your right forearm': the whole arm moves"),
        ("Put your right wrist on your left wrist.", "'your right wrist': the hand moves"),
        ("Touch the top of your left hand.", "'the top of your left hand' is onto the palm of the"),
        ("Slide your right hand up to the left elbow.", "through the air, not along the body"),
        ("Shake your right hand up and down.", "half a beat for each; 4 times"),
        ("Clap for four beats.", "for more say 'Clap on every beat for four beats'"),
        (
            "Tap your chest with your right hand, then your belly with your left, four times.",
            "so often only this",
        ),
        ("Nod, then clap, four times.", "so often only this"),
        (
            "Lift your left arm and bend forward, then come back up.",
            "only the trunk straightens: this leaves the left arm where it is",
        ),
        ("Look over your left shoulder.", "at it, not past it: 'over' has no effect"),
    ],
)
def test_what_was_assumed_is_told(text: str, told: str) -> None:
    """Whatever a person would not read in the sentence."""
    assumed = [
        line for line in explain(read_lesson(text, "a.txt")).split("\n") if "assumed" in line
    ]
    assert told in " ".join(assumed)


def test_words_of_a_place_without_effect_are_told() -> None:
    explained = explain(read_lesson("Cross your wrists in front of your chest.", "a.txt"))
    assert "in front of your chest  no effect: arms are crossed on the body" in explained
    assert "'your wrists': the hand moves; to left_shoulder.top" in explained


def test_how_long_what_goes_beside_lasts_is_told_once() -> None:
    explained = explain(read_lesson("Nod twice while you wave with your left hand.", "a.txt"))
    assert "assumed: for 1 beat, as long as what goes with it" in explained


def test_what_is_repeated_is_told() -> None:
    lines = "Raise your right arm.\nLower it.\n"
    for said, told in (
        (
            "Nod. Repeat this twice.",
            "repeats line 3, 'Nod', 2 times more: 3 passes with the first; for more sentences say",
        ),
        (
            "Repeat everything.",
            "repeats lines 1 to 2, once more: 2 sentences more, 2 passes with the first",
        ),
        (
            "Repeat lines 1 to 2 twice.",
            "repeats lines 1 to 2, 2 times more: 4 sentences more, 3 passes",
        ),
    ):
        assert f"= {told}" in explain(read_lesson(lines + said, "again.txt"))


def test_what_is_exchanged_between_the_sides_is_told() -> None:
    explained = explain(
        read_lesson(
            "Nod.\nBow.\nLift your left arm.\nRepeat all again on the other side.", "sides.txt"
        )
    )
    assert "= on the other side: left and right are exchanged" in explained
    for step in ("-> 4-nod-neck-y: oscillate", "-> 4-raise-right-arm: get-posture, limb right_arm"):
        assert step in explained


def test_every_word_is_explained_or_without_effect() -> None:
    """Of what was understood, nothing is dropped without being told."""
    for row in TABLE["means"]:
        for told in read_lesson(row["say"], "said.txt").told:
            if told.note:
                continue
            reasons = {
                raw for step in told.steps for r in step.reasons for w in r.words for raw in w.raws
            }
            clauses = {
                raw for step in told.steps for word in step.clause.words for raw in word.raws
            }
            fillers = {raw for word in told.fillers for raw in word.raws}
            assert reasons or fillers
            assert clauses - reasons <= _linking(told.steps), told.text


def _linking(steps: list) -> set:
    """Words that order clauses, that phrases begin with, or that only name the verb."""
    return {
        raw
        for step in steps
        for word in step.clause.words
        for raw in word.raws
        if word.kind in ("SEP", "UNTIL", "PREPOSITION", "WHEN", "IF", "LET", "VERB", "MOST")
    }


def test_errors_of_binding_point_into_the_text(body: Body) -> None:
    text = "Nod.\nExtend your right arm down, elbow straight, palm up.\n"
    spec, document = task_from_text(text, "back.txt")
    with pytest.raises(SpecError, match="cannot be held so") as caught:
        bind_task(spec, body, document)
    assert caught.value.line == 2
    assert "Extend your right arm down, elbow straight, palm up" in caught.value.excerpt


@pytest.mark.parametrize(
    ("text", "most"),
    [
        ("Turn 180 degrees to the left.", "it moves from -40 to 40"),
        ("Turn your body 45 degrees to the left.", "it moves from -40 to 40"),
        ("Turn your head 90 degrees to the left.", "it moves from -75 to 75"),
    ],
)
def test_a_number_that_is_too_large_is_refused_with_the_most(
    text: str, most: str, body: Body
) -> None:
    spec, document = task_from_text(text, "turn.txt")
    with pytest.raises(SpecError, match=most):
        bind_task(spec, body, document)


def test_repeating_cannot_explode() -> None:
    for count, times in ((1, 10_000), (12, 9)):
        text = "Nod and bow.\n" + f"Repeat everything {times} times.\n" * count
        with pytest.raises(SpecError, match="repeating makes more than 2000 steps"):
            task_from_text(text, "bomb.txt")


def test_whatever_the_text_there_is_a_task_or_an_error() -> None:
    found = fuzz(250, seed=1)
    assert found.outcomes["task"] > 10
    assert found.outcomes["refused"] > 100


@given(st.text(max_size=200))
def test_any_text_at_all(text: str) -> None:
    with suppress(SpecError):
        task_from_text(text, "any.txt")


@given(st.lists(st.sampled_from(sorted(vocabulary().entries)), max_size=12))
def test_any_words_in_any_order(words: list[str]) -> None:
    with suppress(SpecError):
        spec, document = task_from_text(" ".join(words), "any.txt")
        build_graph(spec, document)


def test_every_word_of_the_vocabulary_means_something() -> None:
    for words in vocabulary().entries:
        assert meanings(words), words
    for section in ("verbs", "nouns", "directions"):
        for entry in vocabulary().data[section].values():
            assert all(words in reference() for words in entry["words"])

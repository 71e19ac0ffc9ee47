"""Drumming follows its table and its ball: the same task, whatever their size and place."""

import pytest

from adonis.dancing import run_task
from adonis.judging import judge
from sim import Body, load_body
from specs import bind_task, lint_task, load_task

ELSEWHERE = (
    "scene.ball.moves=[{beat: 9, beats: 3, to: {near: table.edge, away: 0.3,"
    " offset: [0.15, -0.1, 0]}}, {beat: 13, beats: 3, to: {near: table.edge, away: 0.2,"
    " offset: [0.13, 0.05, 0]}}]"
)
SCENES = {
    "as it stands": [],
    "higher": ["scene.table.at=[0.5, 0, 1.03]"],
    "lower": ["scene.table.at=[0.5, 0, 0.93]"],
    "larger": ["scene.table.box=[0.6, 1.2, 0.06]", "scene.table.at=[0.57, 0, 0.97]"],
    "turned": ["scene.table.turn=12"],
    "a larger ball": ["scene.ball.sphere=0.12", "scene.ball.at.away=0.12"],
    "a ball elsewhere": ["scene.ball.at.offset=[0.17, -0.08, 0]", ELSEWHERE],
}


@pytest.mark.parametrize("scene", SCENES)
def test_it_follows_the_scene(body: Body, scene: str) -> None:
    spec, document = load_task("drumming", changes=SCENES[scene])
    bound = bind_task(spec, body, document)
    assert lint_task(bound, document) == []
    (recording,) = run_task(bound, contributions=False)
    judgement = judge(recording, spec)
    assert judgement.success, [m for v in judgement.verdicts for m in v.measures if not m.success]


def test_a_table_that_stays_as_it_is_is_too_high_for_a_child() -> None:
    child = load_body("adonis-child")
    spec, document = load_task("drumming")
    bound = bind_task(spec, child, document)
    assert lint_task(bound, document) == []
    (recording,) = run_task(bound, contributions=False)
    assert judge(recording, bound.spec).success
    spec, _ = load_task("drumming", changes=["scene.table.scales=false"])
    first = spec.model_copy(update={"subtasks": spec.subtasks[:1], "rehearse": True})
    (finding, *_) = lint_task(bind_task(first, child))
    assert finding.code == "stuck"
    assert "the right hand leans on the table" in finding.what

"""Write a task of one's own: 02_salute.yaml, read, checked, run, and changed."""

from pathlib import Path

from adonis.dancing import run_task
from adonis.judging import judge
from sim import adonis
from specs import SpecError, bind_task, load_task, task_from_text, with_tempo

path = Path(__file__).with_suffix(".yaml")
spec, document = load_task(path)
body = adonis()

for tempo in (60, 90):
    (recording,) = run_task(bind_task(with_tempo(spec, tempo), body, document))
    judgement = judge(recording)
    for verdict in judgement.verdicts:
        worst = verdict.worst
        assert worst is not None
        said = f"{worst.what} {worst.value:.3f} of {worst.limit:g} {worst.unit}"
        print(f"at {tempo} bpm {verdict.subtask.name}: {said}")
    assert judgement.success, "every sub-task succeeds, at both tempos"
    print(f"at {tempo} bpm all {judgement.passed} sub-tasks succeed")

# A mistake is found before anything moves, and the message says where and what there is.
try:
    spec, document = task_from_text(path.read_text().replace("head.right", "head.rihgt"), path.name)
    bind_task(spec, body, document)
except SpecError as mistake:
    print(mistake)

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
    print(f"at {tempo} beats per minute {judgement.passed} of {len(judgement.verdicts)} succeed")

# A mistake is found before anything moves, and the message says where and what there is.
try:
    spec, document = task_from_text(path.read_text().replace("head.front", "head.font"), path.name)
    bind_task(spec, body, document)
except SpecError as mistake:
    print(mistake)

"""Run the combined Macarena from Python, and ask how well it went."""

from adonis.dancing import run_task
from adonis.judging import judge
from sim import adonis
from specs import bind_task, load_task

spec, document = load_task("macarena")
task = bind_task(spec, adonis(), document)

(recording,) = run_task(task)
judgement = judge(recording)

for verdict in judgement.verdicts:
    worst = verdict.worst
    assert worst is not None
    print(f"{verdict.subtask.words:48} {worst.value:8.3f} of {worst.limit:g} {worst.unit}")
print(f"{judgement.passed} of {len(judgement.verdicts)} sub-tasks succeeded")

# The recording says which primitive made which torque, at every step.
guard = recording.names.index("guard")
print(f"the guard pushed with up to {abs(recording.contribution[:, guard]).max():.1f} N m")

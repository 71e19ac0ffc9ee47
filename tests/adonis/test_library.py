"""Every task of the library does what it says."""

import numpy as np
import pytest

from adonis.attribution import attribute
from adonis.dancing import run_task
from adonis.judging import judge
from sim import Body, Replay
from specs import bind_task, library, load_task

# The Macarenas by one controller alone are danced in test_comparing.
TASKS = [name for name in library() if not name.startswith("macarena-") or name.endswith("hips")]


@pytest.mark.parametrize("name", TASKS)
def test_a_task_of_the_library_succeeds(body: Body, name: str) -> None:
    spec, document = load_task(name)
    (recording,) = run_task(bind_task(spec, body, document))
    judgement = judge(recording, spec)
    assert judgement.success, [m for v in judgement.verdicts for m in v.measures if not m.success]
    if name == "all-at-once":
        assert attribute(recording, Replay(recording)).warnings == ()
        asked = recording.contribution.sum(axis=1)
        np.testing.assert_allclose(asked, recording.torque, atol=1e-3)

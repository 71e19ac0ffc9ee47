"""One dance, simulated once, for all the tests that read it."""

import os

os.environ.setdefault("MUJOCO_GL", "disable")  # pictures are rendered in a process of their own

from dataclasses import dataclass

import pytest
from hypothesis import settings

from adonis.dancing import run_task
from adonis.judging import judge
from adonis.verdicts import Judgement
from sim import Body, Recording, adonis
from specs import BoundTask, bind_task, load_task

# Compiling takes seconds, and the same examples everywhere make a failure easy to repeat.
settings.register_profile("adonis", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("adonis")


@dataclass(frozen=True)
class Dance:
    """The combined Macarena, as it stands in the library, on Adonis."""

    task: BoundTask
    recording: Recording
    judgement: Judgement


@pytest.fixture(scope="session")
def body() -> Body:
    return adonis()


@pytest.fixture(scope="session")
def dance(body: Body) -> Dance:
    spec, document = load_task("macarena")
    task = bind_task(spec, body, document)
    (recording,) = run_task(task)
    return Dance(task, recording, judge(recording, spec))

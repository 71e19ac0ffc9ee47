"""A task as far as a body can do it: the nearest goals instead of those that are out of reach."""

from dataclasses import dataclass

from primitives import Hold
from sim import Body
from specs.fitness import Fitness, fitness_of
from specs.reading import Document
from specs.task import SubTask, TaskSpec

REST = Hold(joints=())  # what is impossible: nothing moves, and the time passes


@dataclass(frozen=True)
class BestEffort:
    """What was asked, and what a body can do of it."""

    asked: TaskSpec
    fitness: tuple[Fitness, ...]

    @classmethod
    def of(cls, spec: TaskSpec, body: Body, document: Document | None = None) -> "BestEffort":
        """The best that a body can do of a task that is fitted to it.

        Raises:
            SpecError: see `fitness_of`.
        """
        return cls(spec, tuple(fitness_of(spec, body, document)))

    @property
    def tried(self) -> TaskSpec:
        """The task with what comes nearest; sub-tasks that are impossible are waited for."""
        found = {each.subtask: each for each in self.fitness}
        subtasks = tuple(_tried(s, found[s.name]) for s in self.asked.subtasks)
        return self.asked.model_copy(update={"subtasks": subtasks})

    def to_judge(self, tried: TaskSpec) -> TaskSpec:
        """The task that was tried, its ways found, with the goals that were asked for."""
        asked = {s.name: s.does for s in self.asked.subtasks}
        partly = {each.subtask for each in self.fitness if each.instead is not None}
        subtasks = tuple(
            s.model_copy(update={"does": asked[s.name]}) if s.name in partly else s
            for s in tried.subtasks
        )
        return tried.model_copy(update={"subtasks": subtasks})


def _tried(subtask: SubTask, fit: Fitness) -> SubTask:
    if fit.verdict == "impossible":
        plain = {"if_": None, "otherwise": None, "done": "on-time", "tolerance": None}
        more = {"timeout": None, "repeat": 1, "does": REST}
        return subtask.model_copy(update=plain | more)
    return subtask if fit.instead is None else subtask.model_copy(update={"does": fit.instead})

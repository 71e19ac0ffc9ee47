"""Steps in their order: one after the other, or at the same time."""

import re
from typing import Any

from specs.english.doing import Stages
from specs.english.doing_body import ease
from specs.english.problems import Problem
from specs.english.sentences import Clause
from specs.english.steps import Step, plain

PARALLEL = ("and", "together", "while")


class Sequence:
    """The steps so far. Those of a block run at the same time, and are written when it ends."""

    def __init__(self) -> None:
        self.steps: list[Step] = []  # in the order of the task, with names
        self.block: list[Stages] = []
        self._ends: list[str] = []  # who must be over before what comes now
        self._names: dict[str, int] = {}
        self.sentence = 0  # ordinal of the one that is read: steps are called by it
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(self, stages: Stages, link: str, clause: Clause, tempo: float) -> None:
        """Add the steps of a clause.

        Raises:
            Problem: they move what something else moves at the same time.
        """
        for step in (step for stage in stages for step in stage):
            step.sentence = self.sentence
        if link in PARALLEL and self.block:
            shared = moves(stages) & moves(*self.block)
            if not shared:
                self.block.append(stages)
                self._count += sum(map(len, stages))
                return
            said = " and ".join(sorted(part.replace("_", " ") for part in shared))
            if link != "and":
                elbow = any("joints" in step.parameters for step in stages[0])
                how = "; with the arm say 'elbow bent' or 'elbow straight'" if elbow else ""
                raise Problem.of(
                    f"the {said} cannot do two things at the same time{how}", clause.words
                )
            for step in stages[0]:
                step.assume(f"one after the other, since both move the {said}")
        elif link in PARALLEL and link != "and":
            raise Problem.of("at the same time as what? nothing stands before", clause.words)
        self.flush(tempo)
        self.block = [stages]
        self._count += sum(map(len, stages))

    def flush(self, tempo: float) -> None:
        """Write what runs at the same time, and begin anew after it."""
        if not self.block:
            return
        _even(self.block, tempo)
        before, ends = self._ends, []
        for stages in self.block:
            waits = before
            for stage in stages:
                waits = [self._write(step, waits) for step in stage]
            ends += waits
        _lasting(self.block)
        self.block, self._ends = [], ends

    def _write(self, step: Step, waits: list[str]) -> str:
        """Give a step its name and say what it waits for, unless that is the one above."""
        name = self._name(step)
        above = [self.steps[-1].own["name"]] if self.steps else []
        after: dict[str, Any] = {} if waits == above else {"after": list(waits)}
        own = {"name": name, "words": step.words or step.clause.text, **after, **step.own}
        step.own = own | {"primitive": step.primitive} | step.parameters
        self.steps.append(step)
        return name

    def _name(self, step: Step) -> str:
        unsaid = "wait" if step.primitive == "hold" else "put"
        verb = step.clause.verb.entry.key if step.clause.verb else unsaid
        what = step.parameters.get("limb") or next(iter(step.parameters.get("joints", ())), "")
        said = re.sub(r"[^A-Za-z0-9]+", "-", f"{step.sentence} {verb} {what}").strip("-")
        self._names[said] = count = self._names.get(said, 0) + 1
        return said if count == 1 else f"{said}-{count}"


def moves(*several: Stages) -> frozenset[str]:
    """The arms and joint groups that some stages claim."""
    return frozenset().union(
        *(step.moves for stages in several for stage in stages for step in stage)
    )


def _even(block: list[Stages], tempo: float) -> None:
    """What lasts without a time of its own lasts as long as what it goes with."""
    if len(block) < 2:
        return
    if any(isinstance(step.own.get("done"), dict) for stages in block for step in stages[-1]):
        return
    fixed = [stages for stages in block if not all(step.lasting for step in stages[-1])]
    longest = max(_seconds(stages, tempo) for stages in fixed or block)
    for stages in block:
        if stages in fixed:
            for step in stages[-1] if _seconds(stages, tempo) < longest else ():
                if step.clause.beside:
                    step.assume("stays so as long as what goes with it")
            continue
        left = longest - _seconds(stages[:-1], tempo)
        for step in stages[-1]:
            own = _seconds([[step]], tempo)
            if "done" not in step.own and (left > own or (step.clause.beside and 0 < left < own)):
                beats = step.own["beats"] = plain(left * tempo / 60.0)
                step.assumed = [said for said in step.assumed if not _length_said(said)]
                unit = "beat" if beats == 1 else "beats"
                step.assume(f"for {beats:g} {unit}, as long as what goes with it")
                step.parameters.pop("ease", None)
                ease(step)


def _length_said(said: str) -> bool:
    return said in ("one beat", "once") or said.endswith(" times")


def _seconds(stages: Stages, tempo: float) -> float:
    total = 0.0
    for stage in stages:
        lengths = [0.0]
        for step in stage:
            own = step.own
            once = own.get("seconds", own.get("beats", 1) * 60.0 / tempo)
            rounds = own.get("repeat", 1)
            lengths.append(once * (rounds if isinstance(rounds, int) else 1))
        total += max(lengths)
    return total


def _lasting(block: list[Stages]) -> None:
    """Beside something that waits, what lasts goes on until that is over."""
    waiting = [s for stages in block for s in stages[-1] if isinstance(s.own.get("done"), dict)]
    for stages in block if waiting else ():
        for step in stages[-1]:
            if step.lasting and len(stages) == 1 and step not in waiting:
                for key in ("after", "beats"):
                    step.own.pop(key, None)
                step.assumed = [said for said in step.assumed if said != "one beat"]
                step.assume("until that is over which goes with it")
                step.own |= {"while": waiting[0].own["name"], "seconds": waiting[0].own["timeout"]}

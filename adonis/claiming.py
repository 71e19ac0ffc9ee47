"""Who claimed which joints, and when: how long a goal was to be held in a recording."""

from collections.abc import Sequence

import numpy as np

from adonis.verdicts import HEAD, claimed
from primitives import GoToPoint
from sim import BodyMap, Recording, Replay, Span
from specs import SubTask, TaskSpec
from specs.groups import together


class Claims:
    """The joints that sub-tasks of a recording claim.

    Args:
        recording: what happened.
        names: of the body.
        replay: of the recording.
    """

    def __init__(self, recording: Recording, names: BodyMap, replay: Replay) -> None:
        self._recording, self._names, self._replay = recording, names, replay

    def joints(self, names: str | Sequence[str]) -> set[str]:
        """Joints of limbs, groups or single joints."""
        found: set[str] = set()
        for name in [names] if isinstance(names, str) else names:
            if name in self._names.limbs:
                found |= set(self._names.limbs[name].joints)
            elif name in self._names.groups:
                found |= set(self._names.groups[name])
            elif name == HEAD and self._names.head is not None:
                found |= self.joints(self._names.head.joints)
            elif name == "all":
                found |= set(self._names.servos)
            elif self._replay.has_joint(name):
                found.add(name)
        return found

    def let_go(self, subtask: SubTask, span: Span, task: TaskSpec) -> float:
        """When the next sub-task that claims a joint of this one began, or infinity [s].

        It may be the same in its next round. What a group puts beside it does not count until it
        is over. A goal on another limb is let go, too, when that limb moves on and takes it away.
        """
        own = self.joints(claimed(subtask)) | self._joints_below_goal(subtask)
        rivals = {s.name for s in task.subtasks if own & self.joints(claimed(s))}
        later = [
            s.start
            for s in (*self._recording.rounds, *self._recording.spans)
            if s.name in rivals
            and s.start > span.start
            and (s.start >= span.end or not together(subtask.name, s.name, task.groups))
        ]
        return min(later, default=np.inf)

    def _joints_below_goal(self, subtask: SubTask) -> set[str]:
        """The joints of another limb that carry the landmark to which a hand goes."""
        does = subtask.does
        if not isinstance(does, GoToPoint):
            return set()
        mark = does.to if isinstance(does.to, str) else does.to.near
        if mark is None:
            return set()
        others = [joint for limb in self._names.limbs.values() for joint in limb.joints]
        own = self._names.limbs[does.limb].joints
        return {joint for joint in others if self._replay.moves(joint, mark)} - set(own)

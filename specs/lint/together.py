"""Where the rest of the body is while a movement lasts: other limbs may be under way too."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from primitives.primitive import FloatArray
from sim import Foreseen
from specs.lint.move import Move

IntArray = NDArray[np.int_]


class Together:
    """The movements of a task, side by side in time.

    Args:
        moves: all of them, in the order in which they begin.
    """

    def __init__(self, moves: Sequence[Move]) -> None:
        self._moves = moves
        self._begin = np.array([move.begins for move in moves])
        self._over = np.array([move.begins + move.duration for move in moves])

    def beside(self, move: Move) -> list[Move]:
        """The others that are under way while it lasts, in the order in which they begin."""
        late, early = self._begin < move.begins + move.duration, self._over > move.begins
        found = [self._moves[int(k)] for k in np.flatnonzero(late & early)]
        own = set(move.dofs.tolist())
        return [other for other in found if other.name != move.name and own.isdisjoint(other.dofs)]

    def key(self, move: Move) -> object:
        """The same for movements that go alike, beside others that go alike."""
        others = self.beside(move)
        return id(move.foresight), *(
            (id(other.foresight), round(other.begins - move.begins, 6)) for other in others
        )

    def postures(self, move: Move, foreseen: Foreseen, rows: IntArray) -> FloatArray:
        """Postures (k, nq) of the whole body if a movement goes so, in some of its rows (k,)."""
        qpos, time = foreseen.qpos[rows], foreseen.time[rows] + move.begins
        for other in self.beside(move):
            columns = move.body.qpos_of_dof[other.dofs]
            for k in np.flatnonzero(time >= other.begins):
                qpos[k, columns] = other.foreseen.at(float(time[k]) - other.begins)[columns]
        return qpos

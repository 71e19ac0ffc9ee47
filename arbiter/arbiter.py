"""The arbiter: which primitives are on, how strongly, and what comes out together.

tau(t) = sum_i a_i(t) phi_i(q, q', t)
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arbiter.combination import Combination
from arbiter.errors import ArbiterError
from arbiter.kernel import ACT, WALK, control
from arbiter.plan import COURSE, DONE, LOG, OUTCOMES, PENDING, ROUND, SKIPPED, SLOT, Plan, make_plan
from arbiter.run import Parts, Run
from arbiter.safety import SafetyFilter
from primitives import Field
from primitives.compiled_field import CompiledField
from primitives.mechanics import dof_table, link_table
from primitives.table import PLAIN, TOUCH, TableBuilder, make_scratch, memory_size
from sim import Span, State, unknown
from specs import BoundTask
from specs.blame import told

FloatArray = NDArray[np.float64]
Place = tuple[NDArray[Any], ...]  # in a task: rows of the arrays that are called KEPT
SAFETY = "safety"  # as the safety filter is called among the primitives
KEPT = (  # in a `Place`
    *("_live", "_course", "_events", "_slots", "_log", "_rounds", "_memory"),
    *("_plain_torque", "_plain_error"),
)
SHARE_FROM = 256  # simulations: below, waking another thread costs more than it saves


class Arbiter:
    """Runs a bound task in n simulations at once.

    Call `torque(state)` at every step and apply what it returns. Time is read from the state;
    the task begins at the first call.

    Args:
        task: what to do, on which body.
        n: number of simulations.
        threads: on which a large batch is shared out; the result does not depend on it.
        contributions: whether to keep what each primitive asked for (see `contribution`).
    """

    def __init__(
        self, task: BoundTask, n: int = 1, *, threads: int = 1, contributions: bool = True
    ) -> None:
        self.task = task
        self.n = n
        self._crew = ThreadPoolExecutor(threads) if threads > 1 and n >= SHARE_FROM else None
        self._shares = threads if self._crew else 1
        self.plan: Plan = make_plan(task)
        self.names: tuple[str, ...] = (
            *(b.name for b in task.spec.background),
            *task.graph.order,
            *((SAFETY,) if task.spec.safety == "filter" else ()),
        )
        self._backgrounds = len(task.background)
        self._plain: list[tuple[int, Field]] = []  # (place among all fields, field)
        builder = TableBuilder(task.body.nv)
        for place, field in enumerate((*task.background, *task.fields)):
            if isinstance(field, CompiledField):
                field.add_to(builder)
            else:
                builder.field(PLAIN, len(self._plain), field.claims)
                self._plain.append((place, field))
        body, table = task.body, builder.build()
        slots, channels = self.plan.slots, self._backgrounds + self.plan.slots
        self._course = np.zeros(n, dtype=COURSE)
        self._events = np.full((n, len(task.events)), -np.inf)
        self._live = np.full(n, -1, dtype=np.int32)
        self._slots = np.zeros((n, slots), dtype=SLOT)
        self._log = np.zeros((n, len(task.fields)), dtype=LOG)
        self._rounds = np.zeros((n, self.plan.rounds), dtype=ROUND)
        self._memory = np.zeros((n, channels + 1, memory_size(table)))
        self._plain_torque = np.zeros((n, len(self._plain), body.nv))
        self._plain_error = np.zeros((n, len(self._plain)))
        grouped = bool(task.spec.groups)
        self._filtered = int(task.spec.safety == "filter")
        kept = (n, channels + self._filtered) if contributions or grouped else (0, 0)
        self._contribution = np.zeros((*kept, body.nv))
        self._activation = np.zeros((*(kept if grouped else (0, 0)), body.nv))
        self._torque = np.zeros((n, body.nv))
        gives_way = np.array(
            [
                len(field.claims) > 0 and entry.name not in task.grouped
                for entry, field in zip(task.spec.background, task.background, strict=True)
            ],
            dtype=np.bool_,
        )
        touches = np.zeros((n, slots + 1), dtype=TOUCH)
        parts = Parts(
            *(link_table(body), dof_table(body), *table),
            *(gives_way, self.plan.nodes, self.plan.others, self.plan.roots),
            *(self.plan.conditions, np.array([task.spec.hand_over]), self._course, self._events),
            *(self._live, self._slots, self._log, self._rounds, self._memory, touches),
            *(self._plain_torque, self._plain_error, self._contribution, self._activation),
            self._torque,
            np.linspace(0, n, self._shares + 1).astype(np.int64),
            np.zeros((self._shares, channels + 1, body.nv)),
            np.zeros((self._shares, channels, body.nv)),
            *make_scratch(table, self._shares),
        )
        self._run = Run(parts)
        self._combination = Combination(task, self.names, parts, self._crew) if grouped else None
        self._bound: tuple[State, tuple[object, ...]] | None = None
        self._safety: SafetyFilter | None = None
        if self._filtered:
            self._safety = SafetyFilter(
                *(body, self._torque, touches, self._live, self._contribution),
                *(self._backgrounds, self._shares, self._crew),
            )
        self.reset()

    def reset(self, who: Sequence[int] | None = None) -> None:
        """Begin the task anew at the next step, in all simulations or in some."""
        rows = _rows(who)
        self._live[rows] = -1
        fresh = np.zeros(len(self.task.fields), dtype=LOG)
        fresh["start"], fresh["waits"] = -np.inf, self.plan.waits
        self._log[rows] = fresh
        if self._combination is not None:
            self._combination.reset(rows)
        start = np.zeros(1, dtype=COURSE)
        start["pace"] = start["wanted"] = 1.0
        start["head"] = start["tail"] = -1
        self._course[rows] = start
        self._events[rows] = -np.inf

    @property
    def changes(self) -> int:
        """How many torques the safety filter has changed so far, all simulations together."""
        return 0 if self._safety is None else self._safety.changed

    @property
    def forkable(self) -> bool:
        """Whether `place` is all that it remembers: not so in groups, filters and plain Python."""
        return not (self._plain or self._combination or self._safety)

    def place(self, simulation: int = 0) -> Place:
        """How far one of the simulations has come in the task, and what its fields remember."""
        return tuple(getattr(self, name)[simulation].copy() for name in KEPT)

    def go_on_from(self, place: Place) -> None:
        """Let all simulations go on from a place in this task, or in one of the same shape.

        Of the same shape is a task whose sub-tasks have the same names, order and joints: their
        parameters may differ.

        Raises:
            ArbiterError: the task is of another shape, or this arbiter is not `forkable`.
        """
        for name, kept in zip(KEPT, place, strict=True):
            own = getattr(self, name)
            if own.shape[1:] != kept.shape or not self.forkable:
                raise ArbiterError("this arbiter cannot go on from there: see Arbiter.go_on_from")
            own[:] = kept

    def hold_back(self, names: Iterable[str]) -> None:
        """Let sub-tasks that have not begun never begin, nor what comes after them."""
        for name in names:
            self._log["waits"][:, self.task.graph.order.index(name)] += 1

    def torque(self, state: State) -> FloatArray:
        """The torques (n, nv) [N m] that the task asks for now, within the motors' limits.

        The array is the arbiter's own and is overwritten by the next call.

        Raises:
            ArbiterError: the state is of another size, a torque is not finite, or a primitive in
                plain Python raised something or returned what is no torque.
        """
        arrays = self._arrays(state)
        if self._plain:
            self._control(WALK, arrays)
            self._ask_plain(state)
            bad = self._control(ACT, arrays)
        else:
            bad = self._control(WALK | ACT, arrays)
        if bad >= 0:
            raise self._not_finite(state, bad)
        if self._combination is not None:
            self._combination.apply(state)
        if self._safety is not None:
            self._safety.apply(state)
        return self._torque

    # --- from outside ---------------------------------------------------------------------

    def send(self, event: str, who: Sequence[int] | None = None) -> None:
        """Let an event happen at the next step, in all simulations or in some.

        Raises:
            ArbiterError: no condition of the task is about such an event.
        """
        if event not in self.task.events:
            raise ArbiterError(unknown("event", event, self.task.events))
        self._events[_rows(who), self.task.events.index(event)] = np.inf

    def pause(self, who: Sequence[int] | None = None) -> None:
        """Let the task's time come to rest within its `hand_over`; goals are held as they are."""
        self._course["wanted"][_rows(who)] = 0.0

    def resume(self, who: Sequence[int] | None = None) -> None:
        """Let the task's time go on after a pause, as softly."""
        self._course["wanted"][_rows(who)] = 1.0

    def stop(self, who: Sequence[int] | None = None) -> None:
        """End the task: every sub-task fades to the background within its hand-over."""
        self._course["stop"][_rows(who)] = True
        self.resume(who)

    # --- what happened --------------------------------------------------------------------

    @property
    def contribution(self) -> FloatArray:
        """Torques (n, channels, nv) [N m] by who made them; see `channels` for the names.

        Raises:
            ArbiterError: this arbiter does not keep them.
        """
        if not self.keeps:
            raise ArbiterError("this arbiter was made with contributions=False")
        return self._contribution

    @property
    def keeps(self) -> bool:
        """Whether it keeps what each primitive asked for."""
        return bool(len(self._contribution))

    @property
    def most_channels(self) -> int:
        """How many primitives can be on at once."""
        return self._backgrounds + self.plan.slots + self._filtered

    def channels(self, out: NDArray[np.int32]) -> None:
        """Which of `names` makes each row of `contribution`, (n, channels); -1 for nobody."""
        b = self._backgrounds
        out[:, :b] = np.arange(b)
        used = np.arange(self.plan.slots) < self._live[:, None]
        out[:, b : b + self.plan.slots] = np.where(used, self._slots["node"] + b, -1)
        if self._filtered:
            out[:, -1] = len(self.names) - 1

    def spans(self, simulation: int = 0) -> tuple[Span, ...]:
        """What became of each sub-task so far."""
        found = []
        for name, row in zip(self.task.graph.order, self._log[simulation], strict=True):
            outcome, start, began, end = int(row["outcome"]), np.nan, np.nan, np.nan
            if outcome not in (PENDING, SKIPPED):
                start, began = float(row["start"] + row["start_lag"]), float(row["began"])
            if outcome >= DONE and outcome != SKIPPED:
                end = float(row["end"] + row["end_lag"])
            found.append(Span(name, start, end, OUTCOMES[outcome], began))
        return tuple(found)

    def rounds(self, simulation: int = 0) -> tuple[Span, ...]:
        """What sub-tasks did in the rounds before the latest; of very many, the last of them."""
        kept = int(self._course[simulation]["rounds"])
        rows = self._rounds[simulation]
        order = np.arange(max(kept - len(rows), 0), kept) % max(len(rows), 1)
        names = self.task.graph.order
        return tuple(
            Span(
                names[row["node"]],
                start := float(row["start"]),
                float(row["end"]),
                OUTCOMES[row["outcome"]],
                start,
            )
            for row in rows[order]
        )

    @property
    def over(self) -> NDArray[np.bool_]:
        """Whether every sub-task is over, (n,)."""
        done: NDArray[np.bool_] = np.all(self._log["outcome"] >= DONE, axis=1)
        return done

    # --- inside ---------------------------------------------------------------------------

    def _control(self, what: int, arrays: tuple[object, ...]) -> int:
        """Run the compiled step; returns a simulation whose torque is not finite, or -1."""
        if self._crew is None:
            return control(what, 0, *arrays)
        jobs = [self._crew.submit(control, what, k, *arrays) for k in range(1, self._shares)]
        own = control(what, 0, *arrays)
        return max(own, *(job.result() for job in jobs))

    def _arrays(self, state: State) -> tuple[object, ...]:
        if self._bound is None or self._bound[0] is not state:
            if state.n != self.n or state.qvel.shape[1] != self.task.body.nv:
                raise ArbiterError(
                    f"this arbiter runs {self.n} simulations of {self.task.body.nv} degrees of"
                    f" freedom; the state has {state.n} of {state.qvel.shape[1]}"
                )
            seen = (state.time, state.qpos, state.qvel, state.xpos, state.xmat)
            self._bound = state, (*seen, state.cdof, state.cvel, state.subtree_com, self._run)
        return self._bound[1]

    def _ask_plain(self, state: State) -> None:
        """Let the fields that are plain Python make their torques, where they are on."""
        now = state.time - self._course["lag"]
        for row, (place, field) in enumerate(self._plain):
            node = place - self._backgrounds
            if node < 0:
                on = np.ones(self.n, dtype=np.bool_)
                start = self._memory[:, -1, 0]
                fresh = state.time - start < 0.999 * self.task.body.timestep
            else:
                on = self._log["on"][:, node] > 0
                start = self._log["start"][:, node]
                fresh = self._log["fresh"][:, node].copy()
                self._log["fresh"][:, node] = False
            if not on.any():
                continue
            if fresh.any():
                self._ask(place, "begin", field.begin, state, fresh)
            since = np.where(on, now - start, 0.0)
            torque = self._ask(place, "torque", field.torque, state, since)
            self._plain_torque[:, row] = self._numbers(place, "torque", torque, ("n", "nv"))
            error = self._ask(place, "error", field.error, state)
            self._plain_error[:, row] = self._numbers(place, "error", error, ("n",))

    def _ask(self, place: int, part: str, method: Callable[..., object], *given: object) -> object:
        """Call somebody's own code; whatever it raises is told with the primitive's name."""
        try:
            return method(*given)
        except (Exception, SystemExit) as problem:
            raise ArbiterError(
                f"the {part} of {self.names[place]!r} raised {told(problem)}"
            ) from problem

    def _numbers(
        self, place: int, part: str, returned: object, shape: tuple[str, ...]
    ) -> NDArray[Any]:
        """What somebody's own code returned, if it is what was expected."""
        sizes = {"n": self.n, "nv": self.task.body.nv}
        expected = tuple(sizes[size] for size in shape)
        try:
            array = np.asarray(returned)
        except Exception:  # rows of different lengths, or whatever it makes of itself
            array = np.array(None)
        if array.shape == expected and array.dtype.kind in "fiu":
            return array
        got = "None" if returned is None else f"something of type {type(returned).__name__}"
        if array.ndim:
            got = f"{array.dtype} of shape {array.shape}"
        comma = "," if len(shape) == 1 else ""
        raise ArbiterError(
            f"the {part} of {self.names[place]!r} returned {got}; expected numbers of shape"
            f" ({', '.join(shape)}{comma}), here {expected}"
        )

    def _not_finite(self, state: State, simulation: int) -> ArbiterError:
        """Ask the fields of a simulation once more, to see which of them it is."""
        blame = Arbiter(self.task)
        for name in KEPT:
            getattr(blame, name)[0] = getattr(self, name)[simulation]
        blame._control(ACT, blame._arrays(state.of_one(simulation)))
        rows = np.empty((1, self.most_channels), dtype=np.int32)
        blame.channels(rows)
        for row, torque in zip(rows[0], blame.contribution[0], strict=True):
            wrong = np.flatnonzero(~np.isfinite(torque))
            if row >= 0 and wrong.size:
                return ArbiterError(
                    f"{self.names[row]!r} asks for a torque that is not finite at"
                    f" {self.task.body.dof_name(int(wrong[0]))}, {state.time[simulation]:.3f} s"
                    f" (simulation {simulation})"
                )
        return ArbiterError(f"a torque is not finite at {state.time[simulation]:.3f} s")


def _rows(who: Sequence[int] | None) -> Any:
    """Which simulations are meant, as an index."""
    return slice(None) if who is None else list(who)

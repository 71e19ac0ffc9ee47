"""follow: the palm follows a moving point: another hand, a landmark, or a trajectory.

The law is in `pursuit`; the springs are those of go-to-point's impedance.
"""

from itertools import pairwise
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, model_validator
from pydantic import Field as Parameter

from primitives.goal_field import GoalField
from primitives.impedance import POINT
from primitives.parameters import SETTLE, Damping, Direction, Offset, Stiffness, Time, settling
from primitives.primitive import FloatArray, Primitive
from primitives.pursuit import KNOT, spline_velocities
from primitives.quantity import Quantity
from primitives.reach_field import HandGoal, hand_springs
from primitives.table import PURSUIT, TableBuilder
from primitives.target import Target, locate, refuse_own
from sim import Arm, Body, Spot

MOST_POINTS = 1000


def _listed(given: Any) -> Any:
    """An array of NumPy as lists, which is what a task file has."""
    return given.tolist() if isinstance(given, np.ndarray) else given


class Trajectory(BaseModel):
    """A moving point: where it is when; before and after, it stands still."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    # [s] since the sub-task began
    times: Annotated[
        tuple[float, ...],
        Quantity.TIME,
        BeforeValidator(_listed),
        Parameter(min_length=2, max_length=MOST_POINTS),
    ]
    # forward, left, up of the trunk's origin [m]
    points: Annotated[
        tuple[Offset, ...],
        BeforeValidator(_listed),
        Parameter(min_length=2, max_length=MOST_POINTS),
    ]

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if len(self.times) != len(self.points):
            raise ValueError(
                f"a trajectory has one time for each point, not {len(self.times)} times and"
                f" {len(self.points)} points"
            )
        for early, late in pairwise(self.times):
            if late <= early:
                raise ValueError(f"the times of a trajectory rise: {late:g} s is after {early:g} s")
        if self.times[0] < 0.0:
            raise ValueError(f"the times of a trajectory begin at 0 s, not {self.times[0]:g} s")
        return self


class Follow(Primitive):
    """Let the palm follow a moving point: another hand, a landmark, or a trajectory."""

    kind: Literal["follow"] = "follow"
    limb: str  # an arm
    to: str | Target | None = None  # a landmark, which is touched, or {hand: LIMB}, …; or
    trajectory: Trajectory | None = None  # {times: […], points: [[…], …]}
    palm: Direction | None = None  # where it faces; default: onto the landmark, else free
    settle: Time = SETTLE  # time in which it catches up with the point [s]
    # Gains of the hand's spring; default: the body's.
    stiffness: Stiffness | None = None  # [N/m]
    damping: Damping | None = None  # [N s/m]
    turn_stiffness: Stiffness | None = None  # [N m/rad]
    turn_damping: Damping | None = None  # [N m s/rad]
    shoulder_damping: Damping | None = None  # [N m s/rad]

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.to is None) == (self.trajectory is None):
            raise ValueError("give either to or trajectory")
        return self

    def bind(self, body: Body, duration: float) -> "PursuitField":
        """See `Primitive.bind`."""
        arm = body.arm(self.limb)
        normal, touched, knots = None, -1, np.zeros((0, KNOT))
        places: tuple[Spot, ...] = ()
        if self.trajectory is not None:
            knots = _knots(body, arm, self.trajectory)
        elif self.to is not None:
            spot = locate(body, self.to, arm.root)
            refuse_own(body, spot, arm.dofs, "follow", self.to)
            places = (spot,)
            if isinstance(self.to, str):
                touched, normal = spot.link, (spot.link, -spot.normal)
        if self.palm is not None:
            normal = (arm.root, body.to_link(arm.root, body.direction(self.palm)))
        goal = HandGoal(places, normal=normal, touched=touched)
        gains = {name: getattr(self, name, None) for name in type(arm.limb.spring).model_fields}
        return PursuitField(body, arm, goal, knots, settling(self.settle, duration), gains)


class PursuitField(GoalField):
    """Lets a palm follow a point: see `pursuit`."""

    def __init__(
        self,
        body: Body,
        arm: Arm,
        goal: HandGoal,
        knots: FloatArray,
        settle: float,
        gains: dict[str, float | None],
    ) -> None:
        super().__init__(body, arm.dofs, unit="m")
        self._arm, self._goal, self._knots, self._settle = arm, goal, knots, settle
        self._reach = hand_springs(arm, body.palm_at_home(arm), goal, gains)

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        reach = self._reach.copy()
        if self._goal.places:
            points = np.zeros(1, dtype=POINT)
            (spot,) = self._goal.places
            points["link"], points["point"] = spot.link, spot.point
            reach["points"] = table.records(points)
        return table.field(
            PURSUIT,
            table.records(reach),
            self.claims,
            duration=self._settle,
            curve=table.numbers(self._knots),
            knots=len(self._knots),
            touch=(self._arm.hand, self._goal.touched),
        )


def _knots(body: Body, arm: Arm, trajectory: Trajectory) -> FloatArray:
    """Time, place and velocity (k, 7) at each point, in the frame of the arm's carrier."""
    times = np.array(trajectory.times)
    points = np.array([body.to_link(arm.root, np.array(p)) for p in trajectory.points])
    return np.column_stack([times, points, spline_velocities(times, points)])

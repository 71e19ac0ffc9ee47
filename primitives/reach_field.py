"""The field of a reach: springs or a force that bring a palm to a place."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from primitives.compiled import Records
from primitives.goal_field import GoalField
from primitives.impedance import POINT, REACH
from primitives.primitive import FloatArray
from primitives.set_point import Profile, weights_at
from primitives.table import ENDPOINT_FORCE, IMPEDANCE, TableBuilder
from sim import Arm, Body, Spot

CartesianController = Literal["impedance", "endpoint-force"]


@dataclass(frozen=True)
class HandGoal:
    """Where a palm is to be and how it is to be turned; None leaves that free."""

    places: tuple[Spot, ...]  # via points and goal, each fixed to a link
    normal: tuple[int, FloatArray] | None = None  # of the palm: a link, and (3,) in its frame
    fingers: FloatArray | None = None  # (3,) in the frame of the link that carries the arm
    upper_arm: FloatArray | None = None  # (3,) in the same
    touched: int = -1  # the link that the palm is to touch
    by_neutral: bool = False  # whether half a turn of the palm goes as the forearm can turn


class ReachField(GoalField):
    """Brings a palm through via points to a goal: see `impedance` and `endpoint_force`.

    Args:
        body: whose arm.
        arm: the arm.
        goal: where the palm is to be.
        times: of start, via points and goal, as shares of the duration.
        duration: of the movement [s].
        controller: how the torque is made.
        gains: by the names of `sim.Spring`; what is missing or None is the body's.
        profile: of the set point.
    """

    def __init__(
        self,
        body: Body,
        arm: Arm,
        goal: HandGoal,
        times: tuple[float, ...],
        duration: float,
        controller: CartesianController,
        gains: dict[str, float | None],
        *,
        profile: Profile = "minimum-jerk",
    ) -> None:
        super().__init__(body, arm.dofs, unit="m")
        self.places = goal.places  # via points and goal
        self.arm, self.hand_goal, self.controller = arm, goal, controller
        self.springs = hand_springs(arm, body.palm_at_home(arm), goal, gains)
        self._profile, self._times, self._duration = profile, times, duration

    def too_far(self) -> float:
        """By how much the goal is out of reach in the home posture [m]; 0 if it is not."""
        goal = self.hand_goal.places[-1]
        place = self._body.at_home(goal.link, goal.point)
        shoulder = self._body.at_home(self.arm.upper_arm, np.zeros(3))
        return max(0.0, float(np.linalg.norm(place - shoulder)) - self._body.reach(self.arm))

    def _on_another_limb(self) -> bool:
        """Whether another limb carries the goal: then it stays where that is in the beginning."""
        body, others = self._body, set(self._body.map.limbs) - {self.arm.name}
        moved = body.ancestors[self.hand_goal.places[-1].link]
        return any(bool(moved[body.joints(limb)].any()) for limb in others)

    def weights(self, t: FloatArray) -> FloatArray:
        """Weights (k, 1 + places) of start, via points and goal in the set point, at t (k,) [s]."""
        return weights_at(self._profile, self._times, t / self._duration)

    def add_to(self, table: TableBuilder) -> int:
        """See `CompiledField.add_to`."""
        points = np.zeros(len(self.hand_goal.places), dtype=POINT)
        for row, place in zip(points, self.hand_goal.places, strict=True):
            row["link"], row["point"] = place.link, place.point
        reach = self.springs.copy()
        reach["stays"] = self._on_another_limb()
        reach["points"] = table.records(points)
        return table.field(
            IMPEDANCE if self.controller == "impedance" else ENDPOINT_FORCE,
            table.records(reach),
            self.claims,
            duration=self._duration,
            curve=table.curve(self._profile, self._times),
            knots=len(self._times),
            touch=(self.arm.hand, self.hand_goal.touched),
        )


def hand_springs(
    arm: Arm, neutral: FloatArray, goal: HandGoal, gains: dict[str, float | None]
) -> Records:
    """A row of REACH: an arm, how its hand is to be turned, and the gains."""
    reach = np.zeros(1, dtype=REACH)
    reach["hand"], reach["upper_arm"], reach["forearm"] = arm.hand, arm.upper_arm, arm.forearm
    reach["root"], reach["palm"], reach["palm_normal"] = arm.root, arm.palm.point, arm.palm.normal
    reach["fingers"], reach["palm_neutral"] = arm.fingers, neutral
    if goal.normal is not None:
        reach["turns_palm"], reach["by_neutral"] = True, goal.by_neutral
        reach["normal_link"], reach["normal_goal"] = goal.normal
    for part in ("fingers", "upper_arm"):
        wanted = getattr(goal, part)
        if wanted is not None:
            reach[f"turns_{part}"], reach[f"{part}_goal"] = True, wanted
    for gain, default in arm.limb.spring.model_dump().items():
        given = gains.get(gain)
        reach[gain] = default if given is None else given
    return reach

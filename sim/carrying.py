"""Objects of the scene that are carried along: where they are when, and how fast.

    x(t) = x_0 + sum_k w((t - t_k) / T_k) (x_k - x_(k-1)),    w(s) = 10 s^3 - 15 s^4 + 6 s^5

one minimum-jerk movement after the other (Flash & Hogan 1985), whatever the body does meanwhile.
"""

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.body import Body
from sim.errors import BodyError, unknown

FloatArray = NDArray[np.float64]
Vector = tuple[float, float, float]
STRETCH = 500  # steps for which places are worked out at once


def places_at(body: Body, times: FloatArray) -> FloatArray:
    """Where the objects of a scene are planned to be (k, objects, 3) [m], at times (k,) [s]."""
    links = body.objects
    begin = np.array(body.model.body_pos[links], dtype=float).reshape(-1, 3)
    places = np.tile(begin, (len(times), 1, 1))
    for i, link in enumerate(links):
        before = begin[i]
        for carry in body.map.objects.get(body.model.body(int(link)).name, ()):
            s = np.clip((times - carry.start) / carry.lasts, 0.0, 1.0)
            risen = s**3 * (10.0 + s * (6.0 * s - 15.0))
            places[:, i] += risen[:, None] * (np.array(carry.to) - before)
            before = np.array(carry.to)
    return places


def standing(body: Body, time: float) -> Body:
    """The body beside its objects as they stand at a time [s]: for looking ahead, not running.

    It is the same body if nothing is carried by then.
    """
    if not any(body.map.objects.values()):
        return body
    places = places_at(body, np.array([time]))[0]
    if np.array_equal(places, body.model.body_pos[body.objects]):
        return body
    other = copy.copy(body)
    other.model = copy.copy(body.model)
    other.model.body_pos[body.objects] = places
    vars(other).pop("_at_home", None)
    return other


@dataclass(frozen=True)
class Carried:
    """Where the objects of one simulation are, and how fast they are carried."""

    place: FloatArray  # (objects, 3) [m]
    speed: FloatArray  # (objects, 3) [m/s]


class Objects:
    """The objects of a scene in n simulations, as they go on.

    MuJoCo gives what it does not move itself no velocity, so that is kept here.

    Args:
        body: with the objects.
        batch: MuJoCo's simulations.
    """

    def __init__(self, body: Body, batch: Any) -> None:
        self._body, self._links = body, body.objects
        self._place: FloatArray = batch.bind("mocap_pos")  # (n, objects, 3)
        self.speed: FloatArray = np.zeros_like(self._place)  # (n, objects, 3) [m/s]
        self._still = True  # whether all of them are 0
        planned = {name for name, carried in body.map.objects.items() if carried}
        self._names = [str(body.model.body(int(link)).name) for link in self._links]
        self._planned = np.array([name in planned for name in self._names])
        last = max((c.start + c.lasts for n in planned for c in body.map.objects[n]), default=-1.0)
        self._last = int(np.ceil(last / body.timestep))  # the last step in which one is carried
        self._first, self._course = 0, np.zeros((0, 0, 3))  # a stretch of what is planned
        self._given: dict[int, tuple[FloatArray, FloatArray]] = {}  # by a program, for one step

    def ahead(self, time: float) -> bool:
        """Whether any is carried in the step that begins at a time [s]."""
        return bool(self._given) or self._step(time) < self._last

    def go_on(self, time: float) -> None:
        """Bring what is carried to where it is one step after a time [s]."""
        self._still = False
        self.speed[:] = 0.0
        k = self._step(time)
        if k < self._last:
            before, after = self._planned_at(k)
            self._place[:, self._planned] = after
            self.speed[:, self._planned] = (after - before) / self._body.timestep
        for i, (place, speed) in self._given.items():
            self._place[:, i], self.speed[:, i] = place, speed
        self._given.clear()

    def _step(self, time: float) -> int:
        return round(time / self._body.timestep)

    def _planned_at(self, k: int) -> FloatArray:
        """Where what is carried by plan is before and after a step (2, planned, 3) [m]."""
        if not 0 <= k - self._first < len(self._course) - 1:
            times = self._body.timestep * np.arange(float(k), float(k + STRETCH))
            self._first, self._course = k, places_at(self._body, times)[:, self._planned]
        at = k - self._first
        both: FloatArray = self._course[at : at + 2]
        return both

    def show(self, cvel: FloatArray) -> None:
        """Enter the velocities into those of all links (n, nbody, 6), in MuJoCo's form."""
        if not self._still:
            cvel[:, self._links, 3:] = self.speed

    def carry(self, name: str, place: FloatArray | Vector, speed: FloatArray | Vector) -> None:
        """Put an object somewhere, see `World.carry`."""
        if name not in self._names:
            raise BodyError(unknown("object of the scene", name, self._names))
        i = self._names.index(name)
        if self._planned[i]:
            raise BodyError(f"{name!r} is carried by its task: nobody else can carry it")
        self._given[i] = np.array(place, dtype=float), np.array(speed, dtype=float)

    def of(self, simulation: int) -> Carried:
        """Those of one simulation."""
        return Carried(self._place[simulation].copy(), self.speed[simulation].copy())

    def put(self, carried: Carried) -> None:
        """Bring all simulations to where those of one are."""
        self._place[:], self.speed[:], self._still = carried.place, carried.speed, False

    def rest(self) -> None:
        """Let all stand still where MuJoCo has them."""
        self._given.clear()
        if not self._still:
            self.speed[:], self._still = 0.0, True

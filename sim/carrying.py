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
        planned = {name for name, carried in body.map.objects.items() if carried}
        self._names = [str(body.model.body(int(link)).name) for link in self._links]
        self._planned = np.array([name in planned for name in self._names])
        last = max((c.start + c.lasts for n in planned for c in body.map.objects[n]), default=0.0)
        times = np.arange(np.ceil(last / body.timestep) + 2.0) * body.timestep
        course = places_at(body, times)[:, self._planned]
        self._course, self._speeds = course, np.diff(course, axis=0, prepend=course[:1])
        self._speeds /= body.timestep

    def go_on(self, time: float) -> None:
        """Bring what is carried by plan to where it is one step after a time [s]."""
        k = round(time / self._body.timestep) + 1
        if k < len(self._course):
            self._place[:, self._planned] = self._course[k]
            self.speed[:, self._planned] = self._speeds[k]

    def show(self, cvel: FloatArray) -> None:
        """Enter the velocities into those of all links (n, nbody, 6), in MuJoCo's form."""
        cvel[:, self._links, 3:] = self.speed

    def carry(self, name: str, place: FloatArray | Vector, speed: FloatArray | Vector) -> None:
        """Put an object somewhere, see `World.carry`."""
        if name not in self._names:
            raise BodyError(unknown("object of the scene", name, self._names))
        i = self._names.index(name)
        if self._planned[i]:
            raise BodyError(f"{name!r} is carried by its task: nobody else can carry it")
        self._place[:, i], self.speed[:, i] = place, speed

    def of(self, simulation: int) -> Carried:
        """Those of one simulation."""
        return Carried(self._place[simulation].copy(), self.speed[simulation].copy())

    def put(self, carried: Carried) -> None:
        """Bring all simulations to where those of one are."""
        self._place[:], self.speed[:] = carried.place, carried.speed

    def rest(self) -> None:
        """Let all stand still; where they are MuJoCo knows."""
        self.speed[:] = 0.0

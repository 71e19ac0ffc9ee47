"""A task that is written for one body, made to fit another of another size.

Its lengths are scaled by the ratio of the arms, its times by that of the bodies' times (the beat
too), and gains that it gives by the law of what they move (`sim.scaled_gains`). What it leaves to
the body needs no fitting: the body has it in its own size. Objects of its scene are what they are,
unless they are said to scale.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import BaseModel

from primitives import (
    AvoidCollisions,
    Follow,
    GetPosture,
    GoToPoint,
    LookAt,
    Oscillate,
    PointAt,
    Primitive,
    Quantity,
)
from primitives.parameters import CARTESIAN_CONTROLLERS
from primitives.quantity import quantities
from sim import Body, BodyError, Likeness, likeness, mean_hand, mean_joint, spring_laws
from specs.body_loading import find_body
from specs.errors import SpecError
from specs.reading import Document
from specs.task import SubTask, TaskSpec, with_tempo

Model = TypeVar("Model", bound=BaseModel)
DIGITS = 4  # of a number that was scaled: nobody wants to read more


@dataclass(frozen=True)
class Fit:
    """What a task is scaled by: from the body that it is written for to another."""

    body: str  # the other
    like: Likeness
    time: float


def fit_of(spec: TaskSpec, body: Body, document: Document | None = None) -> Fit | None:
    """What a task has to be scaled by to fit a body; None if it is written for it, or for none.

    On a body without arms it stays as it is: nobody can tell how large that is.

    Raises:
        SpecError: the body that it is written for does not exist, or has no arms.
    """
    if spec.body is None or spec.body == body.map.name or not body.map.limbs:
        return None
    try:
        own = find_body(spec.body)
        time = body.map.time_scale / own.map.time_scale
        return Fit(body.map.name, likeness(own, body), time)
    except (BodyError, SpecError) as problem:
        raise (document or Document(None, "")).error(str(problem), ("body",)) from None


def fitted(
    spec: TaskSpec, body: Body, document: Document | None = None, *, tempo: float | None = None
) -> TaskSpec:
    """The task as it fits a body; the same task if it is written for it, or for none.

    Args:
        spec: the task.
        body: that is to do it.
        document: what it was read from, so that errors can say where.
        tempo: that it is to have, whatever the body [beats/min].

    Raises:
        SpecError: see `fit_of`; or there is no such tempo.
    """
    fit = fit_of(spec, body, document)
    spec = spec if fit is None else refitted(spec, body, fit)
    return spec if tempo is None else with_tempo(spec, tempo)


def refitted(spec: TaskSpec, body: Body, fit: Fit) -> TaskSpec:
    """A task scaled by what a fit says, for the body of that fit."""
    scaling = _Scaling(body, fit)
    background = tuple(_with(b, does=scaling.primitive(b.does)) for b in spec.background)
    subtasks = tuple(scaling.subtask(subtask) for subtask in spec.subtasks)
    scene = {
        name: scaling.model(thing) if thing.scales else thing for name, thing in spec.scene.items()
    }
    landmarks = {name: scaling.model(mark) for name, mark in spec.landmarks.items()}
    return _in_time(
        spec,
        fit.time,
        body=fit.body,
        scene=scene,
        landmarks=landmarks,
        background=background,
        subtasks=subtasks,
    )


def slowed(spec: TaskSpec, factor: float) -> TaskSpec:
    """A task that takes so many times as long; its lengths and gains stay."""
    times = {Quantity.TIME: factor, Quantity.FREQUENCY: 1.0 / factor}
    return _in_time(
        spec,
        factor,
        background=tuple(_with(b, does=_resized(b.does, times)) for b in spec.background),
        subtasks=tuple(
            _with(_resized(s, times), does=_resized(s.does, times)) for s in spec.subtasks
        ),
    )


def _in_time(spec: TaskSpec, factor: float, **more: Any) -> TaskSpec:
    """A task at another tempo, its hand-overs as much longer; and other values."""
    steps = tuple(_with(step, tempo=_rounded(step.tempo / factor)) for step in spec.tempo_map)
    tempo, fade = _rounded(spec.tempo / factor), _rounded(spec.hand_over * factor)
    return _with(spec, tempo=tempo, tempo_map=steps, hand_over=fade, **more)


def resized(does: Primitive, length: float) -> Primitive:
    """A primitive with its lengths scaled, and nothing else."""
    return _resized(does, {Quantity.LENGTH: length})


def _resized(model: Model, factors: Mapping[Quantity, float]) -> Model:
    """A model, and those in it, with some quantities scaled; primitives in it stay."""
    marked = quantities(type(model))
    changed = {}
    for name in type(model).model_fields:
        value = getattr(model, name)
        plain = name in marked and not isinstance(value, BaseModel)
        factor = factors.get(marked[name]) if plain else None
        changed[name] = _inside(value, factors) if factor is None else _times(value, factor)
    return _with(model, **changed)


def _inside(value: Any, factors: Mapping[Quantity, float]) -> Any:
    """Models in a value."""
    if isinstance(value, BaseModel):
        return value if isinstance(value, Primitive) else _resized(value, factors)
    if isinstance(value, tuple):
        return tuple(_inside(inner, factors) for inner in value)
    if isinstance(value, dict):
        return {key: _inside(inner, factors) for key, inner in value.items()}
    return value


class _Scaling:
    """Scales the parts of a task."""

    def __init__(self, body: Body, fit: Fit) -> None:
        self._body, self._like = body, fit.like
        self._plain = {
            Quantity.LENGTH: fit.like.length,
            Quantity.TIME: fit.time,
            Quantity.FREQUENCY: 1.0 / fit.time,
        }

    def subtask(self, subtask: SubTask) -> SubTask:
        """A sub-task and its primitive; a tolerance is of what the primitive brings near."""
        scaled = self.model(subtask)
        more: dict[str, Any] = {"does": self.primitive(subtask.does)}
        if subtask.tolerance is not None and _in_metres(subtask.does):
            more["tolerance"] = _rounded(subtask.tolerance * self._plain[Quantity.LENGTH])
        return _with(scaled, **more)

    def primitive(self, does: Primitive) -> Primitive:
        """A primitive with its gains by the law of what they move."""
        marked = quantities(type(does))
        given = {
            name: getattr(does, name)
            for name, quantity in marked.items()
            if quantity is Quantity.GAIN and getattr(does, name) is not None
        }
        factors = self._gains(does) if given else {}
        own = {name: _rounded(value * factors[name]) for name, value in given.items()}
        if "stiffness" in given and getattr(does, "controller", "") == "torque-field":
            own |= _width(does)
        return _with(self.model(does), **own)

    def model(self, model: Model) -> Model:
        """A model, and those in it, with lengths, times and frequencies scaled."""
        return _resized(model, self._plain)

    def _gains(self, does: Primitive) -> Mapping[str, float]:
        """A factor for each gain that a primitive can be given."""
        names, like = self._body.map, self._like
        if isinstance(does, AvoidCollisions):
            hand = mean_hand(like)
            return {"stiffness": hand.stiffness, "damping": hand.damping}
        if _moves_hand(does):
            limb: str = getattr(does, "limb", "")
            if limb in names.limbs:
                return spring_laws(names.limbs[limb], limb, like)
        law = mean_joint(like, [self._body.dof_name(int(d)) for d in _dofs(does, self._body)])
        return {
            name: law.torsional_damping if "damping" in name else law.torsional_stiffness
            for name in quantities(type(does))
        }


def _moves_hand(does: Primitive) -> bool:
    """Whether its gains are those of a hand."""
    if isinstance(does, GetPosture | GoToPoint):
        return does.controller in CARTESIAN_CONTROLLERS
    return isinstance(does, Follow) or (isinstance(does, Oscillate) and does.limb is not None)


def _in_metres(does: Primitive) -> bool:
    """Whether its distance from its goal is a length."""
    return isinstance(does, Follow) or (
        isinstance(does, GetPosture | GoToPoint) and does.controller in CARTESIAN_CONTROLLERS
    )


def _dofs(does: Primitive, body: Body) -> Any:
    """The joints that gains of a primitive are of; every joint if it does not say."""
    limb, joints = getattr(does, "limb", None), getattr(does, "joints", None)
    try:
        if isinstance(does, PointAt):
            return body.arm(does.limb).shoulder_dofs
        if isinstance(does, LookAt) and joints is None and body.map.head is not None:
            return body.joints(body.map.head.joints)
        return body.joints(limb or tuple(joints or ()) or "all")
    except (BodyError, TypeError):  # binding will say what is wrong
        return body.joints("all")


def _width(does: Primitive) -> dict[str, float]:
    """Wells of a torque field that were as wide as eq 3 pairs with a stiffness stay as wide."""
    stiffness, width = (getattr(does, name, None) for name in ("stiffness", "width"))
    return {"width": _rounded(stiffness**-0.5)} if stiffness and width is None else {}


def _times(value: Any, factor: float) -> Any:
    """A number, or numbers in tuples, times a factor."""
    if isinstance(value, tuple):
        return tuple(_times(inner, factor) for inner in value)
    return _rounded(value * factor) if isinstance(value, float | int) else value


def _rounded(number: float) -> float:
    return float(f"{number:.{DIGITS}g}")


def _with(model: Model, **values: Any) -> Model:
    """A model with other values; what is the same stays as unsaid as it was."""
    changed = {name: value for name, value in values.items() if value != getattr(model, name)}
    return model.model_copy(update=changed) if changed else model


__all__ = ["Fit", "fit_of", "fitted", "refitted", "resized", "slowed"]

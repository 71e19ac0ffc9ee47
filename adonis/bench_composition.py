"""What composition costs: each combination rule, and rhythms, against bare physics."""

import time
from collections.abc import Callable

import numpy as np

from primitives import Oscillate
from sim import Body, World
from specs import Background, BoundTask, Group, bind_task, load_task

N = 1024  # simulations in which a rhythm by itself is timed
JOINTS = 7  # of one arm


def composition(
    body: Body,
    tell: Callable[[str], None],
    against_physics: Callable[[BoundTask], dict[str, float]],
) -> dict[str, dict[str, float]]:
    """The Macarena with hips by each rule, and with rhythms: [us per step] at n = 1.

    Args:
        body: who dances.
        tell: told what is being measured.
        against_physics: measures a task.
    """
    spec, document = load_task("macarena-hips")
    hands = tuple(s.name for s in spec.subtasks if s.does.kind == "go-to-point")
    both = ("guard", *hands)
    nested = Group(name="hands", members=hands)
    rules: dict[str, tuple[Group, ...]] = {
        "no groups": (),
        "sum": (Group(name="both", members=both),),
        "weighted": (Group(name="both", rule="weighted", members=both),),
        "dominant": (Group(name="both", rule="dominant", members=both),),
        "null-space, hands over guard": (
            nested,
            Group(name="both", rule="null-space", members=("hands", "guard")),
        ),
        "null-space, hands over waist and neck": (
            nested,
            Group(name="both", rule="null-space", members=("hands", "upright")),
        ),
    }
    found = {}
    for name, groups in rules.items():
        tell(f"rules: {name}")
        task = bind_task(spec.model_copy(update={"groups": groups}), body, document)
        found[name] = against_physics(task)
    for oscillator in ("sine", "matsuoka"):
        tell(f"{JOINTS} joints that swing: {oscillator}")
        swing = Background(name="swing", does=_swings(body, oscillator))
        more = spec.model_copy(update={"background": (*spec.background, swing)})
        found[f"{JOINTS} joints, {oscillator}"] = {
            **against_physics(bind_task(more, body)),
            "alone_in_a_batch_us": _alone(body, _swings(body, oscillator)),
        }
    return found


def _swings(body: Body, oscillator: str) -> Oscillate:
    """All joints of an arm, coupled a little apart, beside what holds them."""
    joints = list(body.map.limbs["right_arm"].joints)[:JOINTS]
    own = {} if oscillator == "sine" else {"feedback": 0.5, "coupling": 0.5}
    given = {
        "joints": {joint: {"amplitude": 0.5, "lag": 20.0 * k} for k, joint in enumerate(joints)},
        "frequency": 1.0,
        "oscillator": oscillator,
        "claims": False,
    }
    return Oscillate.model_validate(given | own)


def _alone(body: Body, does: Oscillate, steps: int = 100) -> float:
    """Time of a rhythm by itself, integrated from step to step [us per simulation]."""
    world, field = World(body, N), does.bind(body, np.inf)
    field.begin(world.state, np.ones(N, dtype=bool))
    spent = []
    for k in range(1, steps + 1):
        t = np.full(N, k * body.timestep)
        began = time.perf_counter()
        field.torque(world.state, t)
        spent.append(time.perf_counter() - began)
    return round(float(np.median(spent)) / N * 1e6, 4)

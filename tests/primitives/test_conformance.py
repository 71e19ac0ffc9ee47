"""The conformance kit: our own primitives keep its promises, and it catches those that do not."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
import pytest

from primitives import (
    AvoidCollisions,
    CompensateGravity,
    Follow,
    GetPosture,
    GoToPoint,
    Hold,
    LookAt,
    Oscillate,
    PointAt,
    Primitive,
    Relax,
)
from primitives.primitive import NO_JOINTS
from primitives.testing import Conformance, check_primitive
from sim import Body, planar_arm
from specs.available import BUILT_IN

ROOT = Path(__file__).parents[2]
OUT = {"arm": "forward", "palm": "up"}
OWN = [
    GetPosture(limb="right_arm", posture=OUT),
    GetPosture(joints=("waist", "neck"), posture="upright"),
    GetPosture(limb="right_arm", posture=OUT, controller="torque-field"),
    GetPosture(limb="right_arm", posture=OUT, controller="torque-field", coupled=True),
    GoToPoint(limb="left_arm", to={"point": (0.4, 0.1, 0.3)}),
    Follow(limb="right_arm", to={"hand": "left_arm", "offset": (0.25, -0.2, 0.35)}),
    Follow(
        limb="right_arm",
        trajectory={"times": [0, 1, 2], "points": [[0.3, -0.1, 0.2], [0.4, 0, 0.3], [0.3, 0, 0.2]]},
    ),
    PointAt(limb="left_arm", at={"point": (1.0, 0.5, 0.4)}),
    LookAt(at={"near": "left_shoulder.top", "away": 1.0, "offset": (1.0, 0.0, -0.8)}),
    LookAt(at={"point": (1.0, 0.8, 0.4)}, joints=("waist", "neck")),
    Oscillate(joints={"left_elbow": {"amplitude": 15}}, frequency=4.0),
    Hold(limb="left_arm"),
    Relax(limb="left_arm"),
    Relax(limb="left_arm", limp=True),
    AvoidCollisions(),
    CompensateGravity(),
]
PASSIVE = (Hold, LookAt, PointAt, Relax)


@pytest.mark.parametrize("primitive", OWN, ids=lambda p: p.kind)
def test_our_own_conform(body: Body, primitive: Primitive) -> None:
    found = check_primitive(primitive, body)
    assert isinstance(found, Conformance)
    if isinstance(primitive, PASSIVE):
        assert found.passive


@pytest.mark.parametrize("primitive", [Hold(joints=("all",)), Relax(joints=("elbow",))])
def test_they_conform_on_another_body(primitive: Primitive) -> None:
    assert check_primitive(primitive, planar_arm()).passive


def test_none_of_our_own_is_left_out() -> None:
    assert {type(primitive) for primitive in OWN} == set(BUILT_IN)


# --- broken ones ----------------------------------------------------------------------------


class Band:
    """A sound field: a spring and a damper at some joints, to where they are at home."""

    unit = "rad"
    passive = True
    stiffness, damping = 20.0, 3.0

    def __init__(self, body: Body) -> None:
        self.body = body
        self.claims = body.joints("neck")
        self.mask = np.zeros(body.nv)
        self.mask[self.claims] = 1.0

    def begin(self, state, who) -> None:
        self.start = np.array(state.qpos)

    def torque(self, state, t):
        return self.mask * (
            self.stiffness * (self.body.home - state.qpos) - self.damping * state.qvel
        )

    def error(self, state):
        return np.abs(self.mask * (self.body.home - state.qpos)).max(axis=1)


class Tried(Primitive):
    """Binds to whatever field is to be tried."""

    kind: Literal["tried"] = "tried"
    field: ClassVar[type] = Band

    def bind(self, body: Body, duration: float):
        return self.field(body)


def broken(**parts):
    """A band with some of its parts replaced."""
    return type(
        "Broken", (Tried,), {"field": type("BrokenBand", (Band,), parts), "__module__": __name__}
    )()


def _remembers_all(self, state, t):
    return Band.torque(self, state, t) + self.mask * 1e-3 * (self.start - state.qpos)


def _noisy(self, state, t):
    return Band.torque(self, state, t) + self.mask * np.random.default_rng().normal()


def _counting(self, state, t):
    self.calls = getattr(self, "calls", 0) + 1
    return Band.torque(self, state, t) + 1e-3 * self.calls * self.mask


def _seeing_others(self, state, t):
    return Band.torque(self, state, t) + self.mask * 1e-3 * state.qpos.mean()


def _dividing(self, state, t):
    return Band.torque(self, state, t) + self.mask * (0.0 * t / t)[:, None]


def _leaning(self, state, t):
    return Band.torque(self, state, t) + 5.0 * self.mask


def _pushing_at_rest(self, state, t):
    still = np.abs(state.qvel).max(axis=1, keepdims=True) == 0.0
    return Band.torque(self, state, t) + self.mask * np.where(still, 5.0, 0.0)


def _turning(self, state, t):
    """A spring with a curl: each joint is pulled by the angle of the next."""
    z, x, _ = self.claims
    torque = Band.torque(self, state, t)
    torque[:, z] += 5.0 * state.qpos[:, x]
    torque[:, x] -= 5.0 * state.qpos[:, z]
    return torque


BROKEN = [
    (broken(claims=None, __init__=lambda self, body: None), "claims are None"),
    (broken(torque=lambda self, state, t: np.zeros(len(self.mask))), "one row for each"),
    (broken(torque=lambda self, state, t: None), "its torque is None"),
    (broken(error=lambda self, state: 0.0), "its error is 0.0"),
    (broken(torque=lambda self, state, t: 1.0 - 2.0 * self.mask + 0 * state.qvel), "not claim"),
    (broken(unit=""), "names no unit"),
    (broken(unit=3), "its unit is 3"),
    (broken(error=lambda self, state: np.full(state.n, np.nan)), "its unit is 'rad'"),
    (broken(error=lambda self, state: np.full(state.n, -1.0)), "not negative"),
    (broken(torque=_dividing), "division by a distance or a duration"),
    (broken(torque=_noisy), "asked twice"),
    (broken(torque=_counting), "an earlier call left behind"),
    (broken(torque=_seeing_others), "alone it makes other torques"),
    (broken(torque=_remembers_all), "changed simulations that were not"),
    (broken(torque=_leaning), "from its goal"),
    (broken(torque=_pushing_at_rest, passive=False), "at rest it still asks"),
    (broken(damping=-1.0), "gives back|does .* J of work|from its goal"),
    (broken(torque=_turning), "not the gradient of an energy"),
]


@pytest.mark.parametrize(("primitive", "said"), BROKEN, ids=[said for _, said in BROKEN])
def test_a_broken_one_is_caught(body: Body, primitive: Primitive, said: str) -> None:
    with pytest.raises(AssertionError, match=said):
        check_primitive(primitive, body)


def test_a_field_that_lacks_a_part_is_told_which(body: Body) -> None:
    class Nothing(Tried):
        def bind(self, body: Body, duration: float):
            return object()

    with pytest.raises(AssertionError, match="lacks claims, unit, begin, torque, error"):
        check_primitive(Nothing(), body)


def test_the_sound_one_and_ten_lines_pass(body: Body, capsys) -> None:
    class Damp(Primitive):
        kind: Literal["damp"] = "damp"
        passive: ClassVar[bool] = True

        def torque(self, state, t):
            return -2.0 * state.qvel

    assert check_primitive(Tried(), body).passive
    assert check_primitive(Damp(), body).passive
    assert len(Damp().bind(body, 1.0).claims) == len(NO_JOINTS)
    assert "us a step" in capsys.readouterr().out


# --- somebody else's package ----------------------------------------------------------------


def test_a_package_of_somebody_else_is_installed_and_used(tmp_path: Path) -> None:
    source, site = tmp_path / "source", tmp_path / "site"
    shutil.copytree(ROOT / "examples" / "third_party", source)

    def call(*words: str) -> str:
        path = os.pathsep.join([str(ROOT), str(site)])
        ended = subprocess.run(
            [sys.executable, *words],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": path, "MUJOCO_GL": "disable"},
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )
        assert ended.returncode == 0, ended.stdout + ended.stderr
        return ended.stdout

    quiet = ("--quiet", "--disable-pip-version-check", "--no-deps", "--no-build-isolation")
    call("-m", "pip", "install", *quiet, "--target", str(site), str(source))
    code = (
        "from adonis.dancing import run_task; from adonis.judging import judge;"
        " from sim import adonis; from specs import bind_task, load_task;"
        f" spec, document = load_task({str(source / 'snap_back.yaml')!r});"
        " (recording,) = run_task(bind_task(spec, adonis(), document));"
        " print(judge(recording).success, [s.outcome for s in recording.spans])"
    )
    assert "True ['done', 'done']" in call("-c", code)
    assert "2 passed" in call("-m", "pytest", "-q", "-p", "no:cacheprovider", str(source))

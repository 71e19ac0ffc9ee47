"""Capsules lie on the surface they are fitted to; gains by rule are Adonis' own on Adonis."""

import numpy as np
import pytest

from sim import adonis
from sim.foreign.capsule_fit import distances, fit_capsules, fit_symmetric
from sim.gain_rules import felt_inertia, guard, hand_spring


def capsule(start: np.ndarray, end: np.ndarray, radius: float, count: int = 800) -> np.ndarray:
    """Points on a capsule."""
    rng = np.random.default_rng(0)
    along = rng.uniform(-radius, np.linalg.norm(end - start) + radius, count)
    axis = (end - start) / np.linalg.norm(end - start)
    inside = np.clip(along, 0.0, np.linalg.norm(end - start))
    across = rng.normal(size=(count, 3))
    across -= np.outer(across @ axis, axis)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    rim = np.sqrt(np.maximum(radius**2 - (along - inside) ** 2, 0.0))
    return start + np.outer(along, axis) + rim[:, None] * across


def test_one_capsule_is_found_again() -> None:
    start, end = np.array([0.1, 0.0, 0.0]), np.array([0.1, 0.05, 0.4])
    (found,) = fit_capsules(capsule(start, end, 0.05), 3)
    ends = sorted((found[0], found[1]), key=lambda p: p[2])
    assert ends[0] == pytest.approx(start, abs=0.01)
    assert ends[1] == pytest.approx(end, abs=0.01)
    assert found[2] == pytest.approx(0.05, rel=0.05)


def test_two_at_an_angle_take_two() -> None:
    elbow, hand = np.array([0.0, 0.0, 0.3]), np.array([0.3, 0.0, 0.3])
    points = np.concatenate([capsule(np.zeros(3), elbow, 0.04), capsule(elbow, hand, 0.04)])
    found = fit_capsules(points, 4)
    assert len(found) >= 2
    assert np.abs(distances(points, found).min(axis=1)).mean() < 0.01


def test_a_broad_trunk_is_the_same_on_both_sides() -> None:
    left = capsule(np.array([0.0, 0.15, 0.0]), np.array([0.0, 0.12, 0.4]), 0.08)
    points = np.concatenate([left, left * [1.0, -1.0, 1.0]])
    found = fit_symmetric(points, 6)
    for start, end, radius in found:
        mirrored = [(a * [1, -1, 1], b * [1, -1, 1], r) for a, b, r in found]
        assert (
            any(
                radius == pytest.approx(r)
                and (np.allclose([start, end], [a, b]) or np.allclose([start, end], [b, a]))
                for a, b, r in mirrored
            )
            or abs(start[1] + end[1]) < 0.01
        )
    assert np.abs(distances(points, found).min(axis=1)).mean() < 0.012


def test_gains_by_rule_are_adonis_own() -> None:
    body = adonis()
    limb = body.map.limbs["right_arm"]
    spring = hand_spring(body.model, limb.joints, 3, limb.palm)
    for gain, own in limb.spring.model_dump().items():
        assert getattr(spring, gain) == pytest.approx(own, rel=0.02), gain
    mass, _, _ = felt_inertia(body.model, limb.joints, 3, limb.palm)
    arm = body.arm("right_arm")
    length = body.reach(arm) - float(np.linalg.norm(arm.palm.point))
    for gain, own in body.map.guard.model_dump().items():
        assert getattr(guard(mass, length), gain) == pytest.approx(own, rel=0.02), gain

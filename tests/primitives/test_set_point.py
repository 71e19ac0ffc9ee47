"""Set points: closed forms, and the properties that make them what they are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from primitives.profiles import minimum_jerk
from primitives.set_point import MOST_KNOTS, ORDER, knot_weights, weigh_knots

PROFILES = sorted(ORDER)


def curve(profile: str, times: tuple[float, ...], s: float) -> tuple[np.ndarray, np.ndarray]:
    """Weights and rates at s."""
    weight, rate = np.zeros(len(times)), np.zeros(len(times))
    weigh_knots(s, np.array(times), knot_weights(profile, times).ravel(), weight, rate)
    return weight, rate


knots = st.lists(
    st.floats(0.02, 0.98), max_size=MOST_KNOTS - 2, unique_by=lambda t: round(t * 40)
).map(lambda inner: (0.0, *sorted(inner), 1.0))


@given(st.sampled_from(PROFILES), knots, st.floats(-0.5, 1.5))
def test_weights_add_up_to_one(profile: str, times, s: float) -> None:
    weight, rate = curve(profile, times, s)
    assert weight.sum() == pytest.approx(1.0, abs=1e-6)
    assert rate.sum() == pytest.approx(0.0, abs=1e-4)


@given(st.sampled_from(PROFILES), knots)
def test_a_curve_passes_its_knots_on_time(profile: str, times) -> None:
    for k, time in enumerate(times):
        np.testing.assert_allclose(curve(profile, times, time)[0], np.eye(len(times))[k], atol=1e-6)


@given(st.sampled_from(["spline", "minimum-jerk"]), knots)
def test_it_starts_and_ends_at_rest(profile: str, times) -> None:
    for end in (0.0, 1.0 - 1e-12, 1.0, 2.0):
        np.testing.assert_allclose(curve(profile, times, end)[1], 0.0, atol=1e-4)


@given(st.sampled_from(PROFILES), st.floats(0.01, 0.99))
def test_rates_are_derivatives(profile: str, s: float) -> None:
    times, h = (0.0, 0.3, 0.55, 1.0), 1e-6
    if min(abs(s - t) for t in times) < 2 * h:
        return
    (after, _), (before, _) = curve(profile, times, s + h), curve(profile, times, s - h)
    np.testing.assert_allclose(curve(profile, times, s)[1], (after - before) / (2 * h), atol=1e-4)


@given(st.floats(0, 1))
def test_without_via_points_it_is_the_textbook_curve(s: float) -> None:
    assert curve("minimum-jerk", (0.0, 1.0), s)[0][1] == pytest.approx(minimum_jerk(s), abs=1e-9)
    assert curve("spline", (0.0, 1.0), s)[0][1] == pytest.approx(3 * s**2 - 2 * s**3, abs=1e-9)
    assert curve("linear", (0.0, 1.0), s)[0][1] == pytest.approx(s, abs=1e-9)


def test_minimum_jerk_peaks_at_1_875_times_the_mean_speed() -> None:
    peak = max(curve("minimum-jerk", (0.0, 1.0), s)[1][1] for s in np.linspace(0, 1, 1001))
    assert peak == pytest.approx(1.875, abs=1e-6)


@pytest.mark.parametrize(("profile", "derivative"), [("spline", 2), ("minimum-jerk", 3)])
def test_no_nearby_curve_through_the_same_knots_is_smoother(profile: str, derivative: int) -> None:
    """It minimises the integral of its squared derivative: any wiggle makes that larger."""
    times, points = (0.0, 0.35, 0.7, 1.0), np.array([0.0, 1.0, -0.5, 0.3])
    pieces = [Polynomial(c @ points) for c in knot_weights(profile, times)]
    line = Polynomial([0.0, 1.0])
    wiggle = line**3 * (1 - line) ** 3 * (line - times[1]) * (line - times[2])

    def cost(amount: float) -> float:
        total = 0.0
        for piece, start, end in zip(pieces, times, times[1:], strict=False):
            moved = piece(line - start) + amount * wiggle
            squared = (moved.deriv(derivative) ** 2).integ()
            total += squared(end) - squared(start)
        return total

    for amount in (0.5, 2.0):
        assert cost(0.0) < cost(amount)
        assert cost(0.0) < cost(-amount)


def test_linear_goes_straight_from_knot_to_knot() -> None:
    times = (0.0, 0.5, 1.0)
    np.testing.assert_allclose(curve("linear", times, 0.25)[0], [0.5, 0.5, 0.0], atol=1e-12)

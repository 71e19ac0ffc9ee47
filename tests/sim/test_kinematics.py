"""Directions turn on great circles."""

import numpy as np
import pytest

from sim import turned
from sim.kinematics import turn, turned_by_way_of, unit

X, Y, Z = np.eye(3)


def test_a_direction_turns_on_the_great_circle() -> None:
    np.testing.assert_allclose(turned(X, Y, 0.5), (X + Y) / np.sqrt(2.0), atol=1e-12)
    np.testing.assert_array_equal(turned(X, Y, 1.0), Y)
    np.testing.assert_array_equal(turned(X, X, 0.3), X)


@pytest.mark.parametrize("start", [X, Y, Z, unit(X + 2.0 * Z)])
def test_half_a_turn_goes_by_what_is_nearest_to_up(start: np.ndarray) -> None:
    middle = turned(start, -start, 0.5)
    assert np.linalg.norm(middle) == pytest.approx(1.0)
    assert middle @ start == pytest.approx(0.0, abs=1e-7)
    assert middle @ Z >= 0.0


def test_a_direction_turns_by_way_of_another() -> None:
    np.testing.assert_allclose(turned_by_way_of(X, Y, -X, 0.5), Y, atol=1e-9)
    np.testing.assert_allclose(turned_by_way_of(X, X + Y, -X, 0.5), Y, atol=1e-9)  # what is across
    np.testing.assert_array_equal(turned_by_way_of(X, X, Z, 0.5), turned(X, Z, 0.5))
    np.testing.assert_allclose(turned_by_way_of(X, Y, -X, 1.0), -X, atol=1e-9)


def test_a_turn_is_no_longer_than_one() -> None:
    np.testing.assert_allclose(turn(X, turned(X, Y, 0.1)), np.sin(0.05 * np.pi) * Z, atol=1e-12)
    assert np.linalg.norm(turn(X, unit(Y - 3.0 * X))) == pytest.approx(1.0)

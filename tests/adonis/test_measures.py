"""Every measure against movements whose measures are known in closed form."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import quad

from adonis.measures import (
    STANDSTILL,
    curvature,
    hand_effort,
    hand_work,
    jerk_index,
    joint_effort,
    line_deviation,
    low_pass,
    mechanical_work,
    normalised_jerk,
    path_length,
    peak_loss,
    resample,
    settling_time,
    spectral_arc_length,
    speed,
    speed_profile,
    tracking_error,
)

FloatArray = NDArray[np.float64]

STEP = 0.002  # [s] of a recording
DISTANCE, DURATION = 0.6, 0.58  # of a move of the Macarena [m, s]
ALONG = np.array([2.0, -1.0, 2.0]) / 3.0  # a direction in space


def minimum_jerk(s: FloatArray) -> FloatArray:
    return 10 * s**3 - 15 * s**4 + 6 * s**5


def cycloid(s: FloatArray) -> FloatArray:
    return s - np.sin(2 * np.pi * s) / (2 * np.pi)


def reach(
    profile: Callable[[FloatArray], FloatArray] = minimum_jerk,
    distance: float = DISTANCE,
    duration: float = DURATION,
    steps: int = round(DURATION / STEP),
) -> tuple[FloatArray, float]:
    """A straight reach in space, and its time step."""
    s = np.linspace(0.0, 1.0, steps + 1)
    start = np.array([0.1, 0.2, 1.3])
    return start + distance * profile(s)[:, None] * ALONG, duration / steps


def circle(radius: float, angular_speed: float, duration: float) -> FloatArray:
    """An arc at constant speed, tilted in space."""
    angle = angular_speed * time(duration)
    one, other = np.array([0.6, 0.8, 0.0]), np.array([-0.48, 0.36, 0.8])
    return radius * (np.outer(np.cos(angle), one) + np.outer(np.sin(angle), other))


def time(duration: float) -> FloatArray:
    return np.arange(round(duration / STEP) + 1) * STEP


def two_strokes() -> tuple[FloatArray, float]:
    """Two reaches, one after the other."""
    first, step = reach()
    return np.concatenate([first, (first + DISTANCE * ALONG)[1:]]), step


sizes = st.floats(0.01, 10.0)
durations = st.floats(0.1, 10.0)


# --- filtering and sampling -----------------------------------------------------------------


def test_a_slow_sine_passes_the_filter_without_lag() -> None:
    t = time(4.0)
    slow = np.stack([np.sin(np.pi * t), np.cos(np.pi * t)], axis=1)
    np.testing.assert_allclose(low_pass(slow, STEP)[200:-200], slow[200:-200], atol=1e-4)


@pytest.mark.parametrize("frequency", [4.0, 8.0, 16.0, 50.0])
def test_gain_of_the_filter_is_that_of_a_fourth_order_butterworth(frequency: float) -> None:
    t = time(4.0)
    wave = np.sin(2 * np.pi * frequency * t)
    # The bilinear transform bends the frequency axis.
    bent = np.tan(np.pi * frequency * STEP) / np.tan(np.pi * 8.0 * STEP)
    gain = 1 / (1 + bent**4)
    np.testing.assert_allclose(low_pass(wave, STEP)[500:-500], gain * wave[500:-500], atol=1e-6)
    if frequency == 8.0:
        assert gain == pytest.approx(0.5)
    if frequency == 50.0:
        assert gain < 1e-3


def test_the_filter_keeps_a_ramp_up_to_its_ends() -> None:
    ramp = np.outer(time(0.6), ALONG)
    np.testing.assert_allclose(low_pass(ramp, STEP), ramp, atol=1e-3)


@pytest.mark.parametrize("rows", [1, 2, 3, 9, 10, 40])
def test_the_filter_takes_signals_shorter_than_its_padding(rows: int) -> None:
    flat = np.full((rows, 3), 1.7)
    np.testing.assert_allclose(low_pass(flat, STEP), flat)
    ramp = np.outer(np.arange(rows) * STEP, ALONG)
    assert np.abs(low_pass(ramp, STEP) - ramp).max() < 0.02


def test_the_filter_refuses_a_cutoff_beyond_half_the_sampling_rate() -> None:
    with pytest.raises(ValueError, match="filter critical frequencies"):
        low_pass(np.zeros((50, 3)), 0.1, 8.0)


def test_resampling_takes_every_hundredth_row_at_five_per_second() -> None:
    rows = np.arange(3 * 351.0).reshape(351, 3)
    np.testing.assert_allclose(resample(rows, STEP, 5.0), rows[::100])


@pytest.mark.parametrize("intervals", range(1, 30))
def test_resampling_does_not_lose_the_last_of_whole_intervals(intervals: int) -> None:
    """29 intervals of 0.04 s are, to a computer, a little less than 29."""
    assert len(resample(np.zeros(intervals * 20 + 1), STEP, 25.0)) == intervals + 1


def test_resampling_interpolates_between_rows_and_keeps_their_shape() -> None:
    rows = np.arange(8.0)[:, None, None] * np.ones((2, 3))
    picked = resample(rows, 0.1, 4.0)
    assert picked.shape == (3, 2, 3)
    np.testing.assert_allclose(picked[:, 1, 2], [0.0, 2.5, 5.0])
    assert len(resample(rows[:1], 0.1, 4.0)) == 1


@given(steps=st.integers(1, 40), rate=st.floats(1.0, 100.0))
def test_resampling_a_ramp_gives_a_ramp(steps: int, rate: float) -> None:
    ramp = np.arange(steps + 1) * STEP
    picked = resample(ramp, STEP, rate)
    np.testing.assert_allclose(picked, np.arange(len(picked)) / rate, atol=1e-9)
    assert picked[-1] <= ramp[-1] + 1e-9 < picked[-1] + 1 / rate + 2e-9


# --- speed ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("profile", "peak"), [(minimum_jerk, 1.875), (cycloid, 2.0)])
def test_speed_profile_of_textbook_reaches(profile, peak: float) -> None:
    """At 500 Hz within a ten-thousandth."""
    found = speed_profile(*reach(profile))
    assert found.peak == pytest.approx(peak * DISTANCE / DURATION, rel=1e-4)
    assert found.mean == pytest.approx(DISTANCE / DURATION)
    assert found.peak_to_mean == pytest.approx(peak, rel=1e-4)
    assert found.time_to_peak == pytest.approx(0.5)
    assert found.symmetry == pytest.approx(1.0)


def test_speed_is_the_derivative_at_every_row() -> None:
    position, step = reach()
    s = np.linspace(0.0, 1.0, len(position))
    exact = 30 * s**2 * (1 - s) ** 2 * DISTANCE / DURATION
    np.testing.assert_allclose(speed(position, step), exact, atol=1e-3)


def test_an_impact_makes_no_faster_speed_than_there_was() -> None:
    stopped = np.outer(np.minimum(time(0.5), 0.25), ALONG)
    assert speed(stopped, STEP).max() == pytest.approx(1.0)


def test_a_movement_that_speeds_up_evenly_is_half_symmetric() -> None:
    # v = t: ∫|t - (1 - t)| dt = 1/2 and 2 ∫ t dt = 1.
    profile = speed_profile(np.outer(time(1.0) ** 2 / 2, ALONG), STEP)
    assert profile.symmetry == pytest.approx(0.5, abs=1e-5)
    assert profile.peak == pytest.approx(1.0)
    assert profile.time_to_peak == 1.0


def test_an_early_peak_is_found_and_its_mirror_image_is_as_symmetric() -> None:
    early, step = reach(lambda s: minimum_jerk(s**0.7))
    forward, back = speed_profile(early, step), speed_profile(early[::-1], step)
    assert forward.time_to_peak < 0.45
    assert back.time_to_peak == pytest.approx(1 - forward.time_to_peak)
    assert 0.5 < forward.symmetry < 0.95
    assert back.symmetry == pytest.approx(forward.symmetry)


def test_standing_still_has_no_shape() -> None:
    still = np.full((100, 3), 0.3)
    profile = speed_profile(still, STEP)
    assert (profile.peak, profile.mean) == (0.0, 0.0)
    shape = profile.peak_to_mean, profile.time_to_peak, profile.symmetry
    assert np.isnan(shape).all()
    assert np.isnan(normalised_jerk(still, STEP))
    assert np.isnan(peak_loss(still, STEP))
    assert np.isnan(spectral_arc_length(np.zeros(100), STEP))
    assert jerk_index(still, STEP) == pytest.approx(0.0, abs=1e-6)


def test_five_samples_a_second_lose_what_the_chord_loses() -> None:
    """In one second of minimum jerk the best chord is that from 0.4 s to 0.6 s."""
    chord = float(minimum_jerk(np.array(0.6)) - minimum_jerk(np.array(0.4))) * 5
    position, step = reach(duration=1.0, steps=2000)
    assert peak_loss(position, step) == pytest.approx(1 - chord / 1.875, abs=1e-5)


def test_positions_are_sampled_not_speeds() -> None:
    """Round a circle the speed is the same at every sample, but the chord cuts the corner."""
    half = 6.0 * 0.2 / 2
    assert peak_loss(circle(0.3, 6.0, 1.0), STEP) == pytest.approx(
        1 - np.sin(half) / half, abs=1e-4
    )


@given(distance=sizes, duration=st.floats(0.45, 3.0), rate=st.floats(3.0, 100.0))
def test_a_slow_tracker_never_sees_more_than_the_peak(distance, duration, rate) -> None:
    position, step = reach(distance=distance, duration=duration)
    loss = peak_loss(position, step, rate)
    assert -1e-4 < loss < 1.0


def test_a_movement_over_before_the_second_sample_is_not_seen() -> None:
    position, step = reach(duration=0.15, steps=75)
    assert np.isnan(peak_loss(position, step))


# --- smoothness -----------------------------------------------------------------------------


@pytest.mark.parametrize(("profile", "constant"), [(minimum_jerk, 360.0), (cycloid, 4 * np.pi**4)])
def test_jerk_index_of_textbook_reaches(profile, constant: float) -> None:
    """At 500 Hz within a thousandth; the cycloid's ½ ∫ (4π² cos 2πs)² ds is 4π⁴ = 389.6."""
    position, step = reach(profile)
    exact = constant * DISTANCE**2 / DURATION**5
    assert jerk_index(position, step) == pytest.approx(exact, rel=1e-3)
    assert normalised_jerk(position, step) == pytest.approx(np.sqrt(constant), rel=1e-3)


@pytest.mark.parametrize("profile", [minimum_jerk, cycloid])
@pytest.mark.parametrize("measure", [jerk_index, lambda x, h: float(speed(x, h).max())])
def test_halving_the_time_step_quarters_the_error(profile, measure) -> None:
    coarse, fine, finest = (measure(*reach(profile, steps=n)) for n in (400, 800, 1600))
    assert (coarse - fine) / (fine - finest) == pytest.approx(4.0, rel=0.1)


def test_jerk_of_a_cubic_is_exact_at_every_row() -> None:
    position = np.outer(time(0.2) ** 3, [1.0, 2.0, 2.0])  # jerk 6 · 3 all the time
    assert jerk_index(position, STEP) == pytest.approx(0.5 * 18.0**2 * 0.2, rel=1e-6)


@given(distance=sizes, duration=durations)
def test_jerk_index_scales_with_size_and_time(distance: float, duration: float) -> None:
    unit = jerk_index(*reach(distance=1.0, duration=1.0))
    scaled = jerk_index(*reach(distance=distance, duration=duration))
    assert scaled == pytest.approx(unit * distance**2 / duration**5, rel=1e-5)


@given(distance=sizes, duration=durations)
def test_normalised_jerk_does_not_see_size_and_time(distance: float, duration: float) -> None:
    unit = normalised_jerk(*reach(distance=1.0, duration=1.0))
    scaled = normalised_jerk(*reach(distance=distance, duration=duration))
    assert scaled == pytest.approx(unit, rel=1e-5)


@pytest.mark.parametrize("measure", [jerk_index, normalised_jerk, curvature])
def test_derivatives_refuse_too_few_samples(measure) -> None:
    with pytest.raises(ValueError, match="needs 5 samples; there are 4"):
        measure(np.eye(4, 3), STEP)


def test_spectral_arc_length_of_a_gaussian_stroke() -> None:
    """Its spectrum is a Gaussian that falls to the threshold 0.05 at the end of the arc."""
    bell = np.exp(-((time(2.0) - 1.0) ** 2) / (2 * 0.08**2))
    fall = np.log(20.0)
    arc, _ = quad(lambda x: np.hypot(1.0, 2 * fall * x * np.exp(-fall * x * x)), 0.0, 1.0)
    assert spectral_arc_length(bell, STEP) == pytest.approx(-arc, abs=0.01)


@given(distance=sizes, duration=st.floats(0.5, 10.0))
def test_spectral_arc_length_does_not_see_size_and_time(distance, duration) -> None:
    def arc(distance: float, duration: float) -> float:
        position, step = reach(distance=distance, duration=duration)
        return spectral_arc_length(speed(position, step), step)

    assert arc(distance, duration) == pytest.approx(arc(1.0, 1.0), rel=1e-9)


def test_a_movement_of_two_strokes_is_less_smooth_than_one_of_one() -> None:
    (one, step), (two, _) = reach(), two_strokes()
    arc, longer = (spectral_arc_length(speed(x, step), step) for x in (one, two))
    assert longer < arc - 0.3
    assert -1.5 < arc < -1.3
    assert normalised_jerk(two, step) > 2 * normalised_jerk(one, step)


# --- shape of the path ----------------------------------------------------------------------


def test_a_straight_reach_is_straight() -> None:
    position, step = reach()
    bent = curvature(position, step)
    moving = speed(position, step) > STANDSTILL + 1e-3
    np.testing.assert_allclose(bent[moving], 0.0, atol=1e-4)
    assert np.isnan(bent[[0, -1]]).all(), "it stands still at its ends"
    assert line_deviation(position) == pytest.approx(0.0, abs=1e-12)
    assert path_length(position) == pytest.approx(DISTANCE)


@given(radius=st.floats(0.05, 2.0))
def test_a_circle_has_one_curvature_and_its_length(radius: float) -> None:
    round_once = circle(radius, 2 * np.pi, 1.0)
    np.testing.assert_allclose(curvature(round_once, STEP), 1 / radius, rtol=1e-4)
    assert path_length(round_once) == pytest.approx(2 * np.pi * radius, rel=1e-4)


def test_curvature_does_not_depend_on_how_fast_the_path_is_travelled() -> None:
    s = np.linspace(0.0, 1.0, 400)
    angle = np.pi * minimum_jerk(s)
    arc = 0.4 * np.stack([np.cos(angle), np.sin(angle), 0 * s], axis=1)
    bent = curvature(arc, STEP)
    moving = np.isfinite(bent)
    assert 0.8 < moving.mean() < 1.0
    np.testing.assert_allclose(bent[moving], 2.5, rtol=1e-2)


def test_a_half_circle_deviates_by_its_radius_and_a_whole_one_by_its_diameter() -> None:
    assert line_deviation(circle(0.3, np.pi, 1.0)) == pytest.approx(0.3)
    whole = circle(0.3, 2 * np.pi, 1.0)
    whole[-1] = whole[0]
    assert line_deviation(whole) == pytest.approx(0.6)


# --- accuracy -------------------------------------------------------------------------------


def test_tracking_error_is_of_the_distance() -> None:
    wanted = np.zeros((4, 3))
    actual = np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 5.0]])
    rms, worst = tracking_error(actual, wanted)
    assert rms == pytest.approx(5 / np.sqrt(2))
    assert worst == 5.0
    assert tracking_error(actual, actual) == (0.0, 0.0)


@given(decay=st.floats(1.0, 20.0), tolerance=st.floats(0.01, 0.9))
def test_a_decay_settles_after_the_logarithm_of_its_tolerance(decay, tolerance) -> None:
    distance = np.exp(-decay * time(5.0))
    exact = -np.log(tolerance) / decay
    assert exact - 1e-9 <= settling_time(distance, STEP, tolerance) <= exact + STEP + 1e-9


def test_settling_is_for_good() -> None:
    distance = np.array([3.0, 0.5, 2.0, 0.5, 0.5])
    assert settling_time(distance, 0.1, 1.0) == pytest.approx(0.3)
    assert settling_time(distance, 0.1, 3.0) == 0.0
    assert settling_time(distance, 0.1, 0.1) == np.inf
    assert settling_time(np.array([0.0, np.nan]), 0.1, 1.0) == np.inf


# --- effort ---------------------------------------------------------------------------------

TURNS = 2 * np.pi * np.outer(time(1.0), [1.0, 2.0])  # one and two whole periods


def test_effort_of_sines_is_half_their_squares() -> None:
    torque = np.sin(TURNS) * [3.0, 4.0]
    assert joint_effort(torque, STEP) == pytest.approx((9 + 16) / 2)
    force = np.pad(torque, ((0, 0), (0, 1)))
    assert hand_effort(force, STEP) == pytest.approx((9 + 16) / 2)


def test_work_of_sines_counts_braking_as_driving() -> None:
    """In phase ∫ sin² = 1/2; a quarter period apart ∫ |sin cos| = 1/π, though the sum is 0."""
    torque = np.sin(TURNS) * [3.0, 4.0]
    velocity = np.stack([2 * np.sin(TURNS[:, 0]), np.cos(TURNS[:, 1])], axis=1)
    assert mechanical_work(torque, velocity, STEP) == pytest.approx(3 + 4 / np.pi, rel=1e-4)


def test_hand_work_is_of_the_force_along_the_motion() -> None:
    sine, cosine = np.sin(TURNS[:, :1]), np.cos(TURNS[:, :1])
    along, across = np.array([3.0, 0.0, 4.0]), np.array([4.0, 7.0, -3.0])
    velocity = 2 * cosine * along / 5.0
    force = sine * along + across  # 5 N along, and others across that do no work
    assert hand_work(force, velocity, STEP) == pytest.approx(5 * 2 / np.pi, rel=1e-4)


@given(size=sizes, longer=durations)
def test_efforts_scale_with_the_square_of_torque_and_with_time(size: float, longer: float) -> None:
    torque, velocity = np.sin(TURNS), np.cos(TURNS)
    effort, work = joint_effort(torque, STEP), mechanical_work(torque, velocity, STEP)
    assert joint_effort(size * torque, STEP * longer) == pytest.approx(effort * size**2 * longer)
    # The same path in a longer time: the speed falls as the time grows.
    slower = mechanical_work(size * torque, velocity / longer, STEP * longer)
    assert slower == pytest.approx(work * size)

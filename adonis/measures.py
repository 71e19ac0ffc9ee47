"""Measures of movement: speed, smoothness, shape, accuracy and effort, of sampled arrays.

Rows are samples, `timestep` seconds apart; a movement of T rows lasts (T - 1) timesteps. Nothing
here filters by itself: derivatives of measured data want `low_pass` first, and a comparison with
filtered data wants the same filter on both sides. Integrals are by the trapezoidal rule.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal

FloatArray = NDArray[np.float64]

CUTOFF = 8.0  # [Hz] as the human data was filtered
STANDSTILL = 0.01  # [m/s] below this a path has no direction, and so no curvature
STENCIL = 5  # samples behind each second and third derivative


# --- filtering and sampling ------------------------------------------------------------------


def low_pass(samples: FloatArray, timestep: float, cutoff: float = CUTOFF) -> FloatArray:
    """Butterworth filter without phase lag, as is usual for motion capture.

    A second-order filter runs forward and back, which makes a fourth-order filter of zero phase,
    with gain 1/(1 + (f/cutoff)⁴): a half at the cut-off (Winter, *Biomechanics and Motor Control
    of Human Movement*). The ends are continued by point reflection for two periods of the
    cut-off, or for as long as the signal is.

    Args:
        samples: (T, k) or (T,), any unit.
        timestep: [s]
        cutoff: [Hz]

    Returns:
        Filtered samples, of the same shape.

    Raises:
        ValueError: the cut-off is not below half the sampling rate.
    """
    sections = signal.butter(2, cutoff, fs=1.0 / timestep, output="sos")
    padding = min(round(2.0 / (cutoff * timestep)), len(samples) - 1)
    filtered: FloatArray = signal.sosfiltfilt(sections, samples, axis=0, padlen=padding)
    return filtered


def resample(samples: FloatArray, timestep: float, rate: float) -> FloatArray:
    """Take samples at a lower rate, from the first row on, by linear interpolation.

    There is no filter against aliasing: this is what a slow tracker would have recorded.

    Args:
        samples: (T, ...), any unit.
        timestep: [s]
        rate: samples per second [Hz].

    Returns:
        (floor(duration · rate) + 1, ...) samples; what follows the last whole interval is lost.
    """
    last = len(samples) - 1
    count = int(last * timestep * rate + 1e-9) + 1
    rows = np.minimum(np.arange(count) / (rate * timestep), last)
    before = rows.astype(np.intp)
    after = np.minimum(before + 1, last)
    share = (rows - before).reshape(-1, *[1] * (samples.ndim - 1))
    picked: FloatArray = (1.0 - share) * samples[before] + share * samples[after]
    return picked


# --- speed -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class SpeedProfile:
    """Shape of the speed of one movement; NaN for the shape of no movement."""

    peak: float  # [m/s]
    mean: float  # path length over duration [m/s]
    peak_to_mean: float  # 1.875 for minimum jerk
    time_to_peak: float  # share of the duration, 0 … 1
    symmetry: float  # share of the path, 0 … 1; 1 is symmetric in time


def speed(position: FloatArray, timestep: float) -> FloatArray:
    """Tangential speed, by central differences.

    Two neighbours on purpose: wider differences overshoot where an impact steps the velocity.

    Args:
        position: (T, 3) [m], three rows or more.
        timestep: [s]

    Returns:
        (T,) [m/s]
    """
    velocity = np.gradient(position, timestep, axis=0, edge_order=2)
    return _norm(velocity)


def speed_profile(position: FloatArray, timestep: float) -> SpeedProfile:
    """Peak, mean and shape of the speed v(t) of a movement that lasts T.

    Symmetry is 1 - ∫|v(t) - v(T - t)| dt / 2∫v dt: the area that v and its mirror image have in
    common, as a share of the area under each.

    Args:
        position: (T, 3) [m], three rows or more.
        timestep: [s]
    """
    v = speed(position, timestep)
    path = path_length(position)
    if path == 0.0:
        return SpeedProfile(0.0, 0.0, np.nan, np.nan, np.nan)
    peak, mean = float(v.max()), path / _duration(position, timestep)
    unlike = _integral(np.abs(v - v[::-1]), timestep) / _integral(2.0 * v, timestep)
    return SpeedProfile(
        peak=peak,
        mean=mean,
        peak_to_mean=peak / mean,
        time_to_peak=int(v.argmax()) / (len(v) - 1),
        symmetry=1.0 - unlike,
    )


def peak_loss(position: FloatArray, timestep: float, rate: float = 5.0) -> float:
    """Share of the peak speed that is not seen in positions sampled at a low rate.

    The peak of |x(k+1) - x(k)| · rate, the mean speed along the chords between positions sampled
    from the movement's start, is compared with the peak of `speed`. A tracker records positions,
    so this is what Mataric et al. 1998 (fig 6, about 5 samples/s) would have drawn.

    Args:
        position: (T, 3) [m]
        timestep: [s]
        rate: samples per second [Hz].

    Returns:
        0 … 1; NaN if nothing moves, or if the movement is over before the second sample.
    """
    sampled = resample(position, timestep, rate)
    true = float(speed(position, timestep).max())
    if path_length(position) == 0.0 or len(sampled) < 2:
        return float("nan")
    seen = float(_norm(np.diff(sampled, axis=0)).max()) * rate
    return 1.0 - seen / true


# --- smoothness ------------------------------------------------------------------------------


def jerk_index(position: FloatArray, timestep: float) -> float:
    """Integrated squared jerk, C = ½ ∫ (x⃛² + y⃛² + z⃛²) dt.

    Mataric et al. 1998, eq 11; Flash & Hogan 1985. The third derivative is second order in the
    timestep up to both ends.

    Args:
        position: (T, 3) [m], five rows or more.
        timestep: [s]

    Returns:
        [m²/s⁵]

    Raises:
        ValueError: there are fewer than five rows.
    """
    jerk = _derivative(position, timestep, 3)
    return _integral(0.5 * np.sum(jerk**2, axis=1), timestep)


def normalised_jerk(position: FloatArray, timestep: float) -> float:
    """Jerk without dimension, √(½ ∫|jerk|² dt · T⁵/L²), of duration T and path length L.

    Teulings, Contreras-Vidal, Stelmach & Adler 1997. A minimum-jerk reach has √360 = 18.97.

    Args:
        position: (T, 3) [m], five rows or more.
        timestep: [s]

    Returns:
        The same for a movement that is larger or slower; NaN if nothing moves.

    Raises:
        ValueError: there are fewer than five rows.
    """
    index, path = jerk_index(position, timestep), path_length(position)
    if path == 0.0:
        return float("nan")
    return float(np.sqrt(index * _duration(position, timestep) ** 5)) / path


def spectral_arc_length(
    speed: FloatArray,
    timestep: float,
    cutoff: float = 10.0,
    threshold: float = 0.05,
    padding: int = 4,
) -> float:
    """Smoothness as the length of the spectrum of the speed (SPARC).

    -∫₀^ω √((1/ω)² + (dV/df)²) df, where V(f) is the magnitude spectrum, 1 at its largest, and ω
    the last frequency up to the cut-off at which V reaches the threshold. Balasubramanian,
    Melendez-Calderon, Roby-Brami & Burdet 2015.

    Args:
        speed: (T,) [m/s]
        timestep: [s]
        cutoff: highest frequency that counts [Hz].
        threshold: share of the largest magnitude below which the spectrum's tail is noise.
        padding: powers of two by which the signal is lengthened with zeros.

    Returns:
        Negative, near -1.4 for one smooth stroke, lower for a less smooth movement; NaN if
        nothing moves.
    """
    count = 2 ** (int(np.ceil(np.log2(len(speed)))) + padding)
    spectrum = np.abs(np.fft.rfft(speed, count))
    if spectrum.max() == 0.0:
        return float("nan")
    frequency = np.fft.rfftfreq(count, timestep)
    magnitude = (spectrum / spectrum.max())[frequency <= cutoff]
    loud = np.flatnonzero(magnitude >= threshold)
    magnitude = magnitude[loud[0] : loud[-1] + 1]
    steps = np.full(len(magnitude) - 1, 1.0 / max(len(magnitude) - 1, 1))
    return -float(np.hypot(steps, np.diff(magnitude)).sum())


# --- shape of the path -----------------------------------------------------------------------


def path_length(position: FloatArray) -> float:
    """Length of the path (T, 3) [m], as the sum of the chords between its rows [m]."""
    return float(_norm(np.diff(position, axis=0)).sum())


def curvature(position: FloatArray, timestep: float, floor: float = STANDSTILL) -> FloatArray:
    """Curvature of the path, κ = |cross(ẋ, ẍ)| / |ẋ|³.

    Args:
        position: (T, 3) [m], five rows or more.
        timestep: [s]
        floor: speed up to which the hand counts as standing still [m/s].

    Returns:
        (T,) [1/m]; NaN where it stands still.

    Raises:
        ValueError: there are fewer than five rows.
    """
    velocity = _derivative(position, timestep, 1)
    acceleration = _derivative(position, timestep, 2)
    v = _norm(velocity)
    moving = v > floor
    bent = np.full(len(v), np.nan)
    bent[moving] = _norm(np.cross(velocity, acceleration)[moving]) / v[moving] ** 3
    return bent


def line_deviation(position: FloatArray) -> float:
    """Largest perpendicular distance of a path from the straight line through its ends.

    Args:
        position: (T, 3) [m]

    Returns:
        [m]; for a path that ends where it began, the largest distance from that point.
    """
    offset, chord = position - position[0], position[-1] - position[0]
    length = float(np.linalg.norm(chord))
    if length > 0.0:
        along = chord / length
        offset = offset - np.outer(offset @ along, along)
    return float(_norm(offset).max())


# --- accuracy --------------------------------------------------------------------------------


def tracking_error(actual: FloatArray, wanted: FloatArray) -> tuple[float, float]:
    """Euclidean distance between where something was and where it was to be.

    Args:
        actual: (T, k), any unit.
        wanted: (T, k), the same unit.

    Returns:
        Root mean square over the rows, and the worst row, in that unit.
    """
    distance = _norm(actual - wanted)
    return float(np.sqrt(np.mean(distance**2))), float(distance.max())


def settling_time(distance: FloatArray, timestep: float, tolerance: float) -> float:
    """When a distance came within a tolerance for good.

    Args:
        distance: (T,) from the goal, any unit; NaN counts as outside.
        timestep: [s]
        tolerance: in the same unit.

    Returns:
        Time of the first row from which on all are within [s]; infinity if the last is not.
    """
    outside = np.flatnonzero(~(distance <= tolerance))
    settled = int(outside[-1]) + 1 if len(outside) else 0
    return settled * timestep if settled < len(distance) else float("inf")


# --- effort ----------------------------------------------------------------------------------


def joint_effort(torque: FloatArray, timestep: float) -> float:
    """Effort of the joints, ∫ Σ τ² dt.

    Args:
        torque: (T, nv) [N m]
        timestep: [s]

    Returns:
        [N² m² s]
    """
    return _integral(np.sum(torque**2, axis=1), timestep)


def mechanical_work(torque: FloatArray, velocity: FloatArray, timestep: float) -> float:
    """Absolute work of the joints, ∫ Σ |τ q̇| dt: braking costs what driving costs.

    Args:
        torque: (T, nv) [N m]
        velocity: (T, nv) [rad/s]
        timestep: [s]

    Returns:
        [J]
    """
    return _integral(np.sum(np.abs(torque * velocity), axis=1), timestep)


def hand_effort(force: FloatArray, timestep: float) -> float:
    """Effort of a force on the hand, ∫ |F|² dt.

    Args:
        force: (T, 3) [N]
        timestep: [s]

    Returns:
        [N² s]
    """
    return _integral(np.sum(force**2, axis=1), timestep)


def hand_work(force: FloatArray, velocity: FloatArray, timestep: float) -> float:
    """Absolute work of a force on the hand, ∫ |F · v| dt.

    Args:
        force: (T, 3) [N]
        velocity: (T, 3) [m/s]
        timestep: [s]

    Returns:
        [J]
    """
    return _integral(np.abs(np.sum(force * velocity, axis=1)), timestep)


# --- inside ----------------------------------------------------------------------------------


def _derivative(samples: FloatArray, timestep: float, order: int) -> FloatArray:
    """Derivative of the quartic through the five nearest rows, at the ends as well (T, k).

    That is a Savitzky-Golay filter that has nothing left to smooth.
    """
    if len(samples) < STENCIL:
        raise ValueError(f"a derivative needs {STENCIL} samples; there are {len(samples)}")
    derivative: FloatArray = signal.savgol_filter(
        samples, STENCIL, STENCIL - 1, deriv=order, delta=timestep, axis=0, mode="interp"
    )
    return derivative


def _norm(rows: FloatArray) -> FloatArray:
    """Euclidean length of each row (T,) of (T, k)."""
    lengths: FloatArray = np.linalg.norm(rows, axis=1)
    return lengths


def _integral(rate: FloatArray, timestep: float) -> float:
    """∫ rate dt of (T,)."""
    return float(np.trapezoid(rate, dx=timestep))


def _duration(samples: FloatArray, timestep: float) -> float:
    return (len(samples) - 1) * timestep

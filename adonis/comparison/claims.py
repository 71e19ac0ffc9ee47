"""What Mataric, Zordan & Williamson (1999) report, held against what is measured here.

Each claim is a function from a comparison to a row: what the paper says, what was measured,
and whether that reproduces it. A verdict is a stated condition on numbers, never an opinion;
where the paper's own condition is not known, the sentence says which one was chosen.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks
from scipy.stats import spearmanr

from adonis.bench import controller_costs, ik_cost
from adonis.comparison.comparing import COMBINED, Comparison, Dancer, dance
from sim import Body
from specs import load_task

FloatArray = NDArray[np.float64]

PD, FIELD, IMPEDANCE, FORCE = "pd-servo", "torque-field", "impedance", "endpoint-force"
PAPER = (PD, FIELD, IMPEDANCE)
REPRODUCED, NOT, OPEN = "reproduced", "not reproduced", "cannot be told"
FACTOR, OF_TWELVE = 2.0, 9  # "near": within this factor in so many of twelve sub-tasks
DENT = 0.1  # a dip in speed counts from so much of the peak


@dataclass(frozen=True)
class Claim:
    """One row: what the paper says, and what became of it."""

    said: str
    measured: str
    verdict: str
    why: str


@dataclass(frozen=True)
class Extras:
    """Runs and timings that only the claims need."""

    endpoint_force: Dancer
    linear: Dancer  # impedance with set points that move at constant speed, as the paper's
    costs: dict[str, float]  # of each controller [us per simulation and step]
    ik: float  # one inverse-kinematics solution [us]


def measure_extras(task: str, body: Body) -> Extras:
    """Run and time what only the claims need."""
    return Extras(
        endpoint_force=dance(task, FORCE, body),
        linear=dance(task, IMPEDANCE, body, profile="linear"),
        costs=controller_costs(body),
        ik=ik_cost(body),
    )


def can_claim(comparison: Comparison) -> bool:
    """Whether this is the paper's task by all of the paper's controllers."""
    words = tuple(s.words for s in comparison.subtasks)
    return words == subtask_words() and all(name in comparison for name in PAPER)


@cache
def subtask_words() -> tuple[str, ...]:
    """The paper's table 1."""
    return tuple(s.words for s in load_task("macarena")[0].subtasks)


def claims(comparison: Comparison, extras: Extras) -> list[Claim]:
    """Every claim that can be made about the dancers that were run.

    There are none unless `can_claim`.
    """
    if not can_claim(comparison):
        return []
    return [claim(comparison, extras) for claim in CLAIMS]


def correlations(comparison: Comparison) -> list[tuple[str, str, float, float]]:
    """Spearman's rank correlation of jerk over the sub-tasks: who, with whom, rho, p."""
    columns = {d.name: d.column("jerk") for d in comparison.dancers}
    if comparison.human is not None:
        columns["human"] = comparison.human.column("jerk", len(comparison.subtasks))
    found = []
    for one, other in combinations(columns, 2):
        known = np.isfinite(columns[one]) & np.isfinite(columns[other])
        if known.sum() > 2:
            result = spearmanr(columns[one][known], columns[other][known])
            found.append((one, other, float(result.statistic), float(result.pvalue)))
    return found


def near_human(comparison: Comparison, dancer: Dancer) -> tuple[int, list[int]]:
    """In how many sub-tasks a peak speed is within a factor two of the human's, and where not."""
    assert comparison.human is not None
    human = comparison.human.column("peak_speed", len(dancer.moves))
    ratio = dancer.column("peak_speed") / human
    far = (ratio > FACTOR) | (ratio < 1.0 / FACTOR) | ~np.isfinite(ratio)
    return int(np.sum(~far)), [int(k) + 1 for k in np.flatnonzero(far)]


# --- speed ------------------------------------------------------------------------------------


def _pd_is_fastest(c: Comparison, _: Extras) -> Claim:
    peak = {n: c[n].column("peak_speed") for n in PAPER}
    fastest = int(np.sum([peak[PD][k] >= max(peak[n][k] for n in PAPER) for k in range(12)]))
    medians = ", ".join(f"{n} {np.median(peak[n]):.2f}" for n in PAPER)
    return Claim(
        "The PD servo makes the fastest, unnaturally fast hand movements.",
        f"Fastest of the three in {fastest} of 12 sub-tasks; median peaks [m/s]: {medians}.",
        REPRODUCED if fastest > 6 else NOT,
        "Condition: fastest in more than half. A servo's set point must arrive on the beat, and a"
        " joint-space path between postures is longer for the hand than a straight one.",
    )


def _peaks_are_near(name: str) -> Callable[[Comparison, Extras], Claim]:
    def claim(c: Comparison, _: Extras) -> Claim:
        said = f"Peak speeds of the {name} controller are near the human's."
        if c.human is None:
            return Claim(said, "No human data was given.", OPEN, "")
        near, far = near_human(c, c[name])
        where = f"; not in {', '.join(map(str, far))}" if far else ""
        return Claim(
            said,
            f"Within a factor two in {near} of 12 sub-tasks{where}.",
            REPRODUCED if near >= OF_TWELVE else NOT,
            f"Condition: {OF_TWELVE} of 12. In 3 and 4 this dancer flings the arms, where the"
            " task only turns the palms.",
        )

    return claim


def _pd_is_smooth_and_symmetric(c: Comparison, _: Extras) -> Claim:
    symmetry = {n: float(np.nanmean(c[n].column("symmetry"))) for n in PAPER}
    smooth = {n: float(np.nanmedian(c[n].column("normalised_jerk"))) for n in PAPER}
    best = symmetry[PD] >= max(symmetry.values()) and smooth[PD] <= min(smooth.values())
    return Claim(
        "The PD servo has the smoothest and most symmetric speed profiles.",
        f"Mean symmetry: {_list(symmetry, '.2f')}. Median normalised jerk: {_list(smooth, '.0f')}.",
        REPRODUCED if best else NOT,
        "Condition: the highest symmetry and the lowest jerk of the three. Contacts are on here,"
        " and were not in 1998: whoever touches, jerks.",
    )


def _field_is_consistent(c: Comparison, _: Extras) -> Claim:
    moving = [k for k in range(12) if k not in (2, 3)]
    spread = {n: _variation(c[n].column("peak_over_mean")[moving]) for n in PAPER}
    return Claim(
        "The torque field's profiles are the most consistent across tasks.",
        f"Variation of peak/mean over the sub-tasks that move the hand: {_list(spread, '.2f')}.",
        REPRODUCED if spread[FIELD] <= min(spread.values()) else NOT,
        "Condition: the lowest coefficient of variation of peak/mean speed.",
    )


def _impedance_matches_shape(c: Comparison, _: Extras) -> Claim:
    said = "In 2 and 6, without obstacles, impedance matches the shape of the human profile."
    if c.human is None or any(k not in c.human.moves for k in (2, 6)):
        return Claim(said, "No human profile was given.", OPEN, "")
    alike = {n: [_alike(c, n, k) for k in (2, 6)] for n in PAPER}
    shown = "; ".join(f"{n} {a:.2f} and {b:.2f}" for n, (a, b) in alike.items())
    best = all(alike[IMPEDANCE][k] >= max(a[k] for a in alike.values()) for k in (0, 1))
    return Claim(
        said,
        f"Correlation with the human's speed profile in 2 and 6: {shown}.",
        REPRODUCED if best else NOT,
        "Condition: the highest correlation of the three in both. One dancer is little to go by.",
    )


def _via_points_dent(c: Comparison, _: Extras) -> Claim:
    peaks = {n: _peaks(c[n], 8) for n in PAPER}
    dented = peaks[PD] > 1 and peaks[IMPEDANCE] > 1 and peaks[FIELD] == 1
    return Claim(
        "In 8 the via point dents the profiles of PD servo and impedance, not the torque field's.",
        f"Peaks of hand speed in sub-task 8: {_list(peaks, 'd')}.",
        REPRODUCED if dented else NOT,
        f"Condition: more than one peak, at least {DENT:.0%} of the highest apart. Our set points"
        " pass via points on one smooth curve; theirs changed direction there.",
    )


# --- paths and jerk ---------------------------------------------------------------------------


def _pd_curves_in_10(c: Comparison, _: Extras) -> Claim:
    path = {n: float(c[n].column("path")[9]) for n in PAPER}
    return Claim(
        "In 10 the PD servo makes an exaggerated curve.",
        f"Length of the hand's path in sub-task 10 [m]: {_list(path, '.2f')}.",
        REPRODUCED if path[PD] >= max(path.values()) else NOT,
        "Condition: the longest path of the three.",
    )


def _impedance_is_jerkier(c: Comparison, e: Extras) -> Claim:
    jerk = {n: _geometric(c[n].column("jerk")) for n in PAPER}
    linear = _geometric(e.linear.column("jerk"))
    cause = (
        "it lies in the set point" if linear > 1.5 * jerk[IMPEDANCE] else "that is not the cause"
    )
    jerkier = max(jerk[IMPEDANCE], linear) > max(jerk[PD], jerk[FIELD])
    return Claim(
        "Impedance is jerkier than the joint-space controllers: its set point moves straight.",
        f"Geometric mean of jerk over the sub-tasks [m²/s⁵]: {_list(jerk, '.0f')};"
        f" impedance with linear set points, as the paper's, {linear:.0f}.",
        REPRODUCED if jerkier else NOT,
        f"Condition: a higher mean than both. With linear set points its jerk is"
        f" {linear / jerk[IMPEDANCE]:.1f} times that with minimum-jerk set points:"
        f" {cause}.",
    )


def _jerk_by_subtask(c: Comparison, _: Extras) -> Claim:
    def groups(column: FloatArray) -> tuple[float, float, float]:
        return tuple(_geometric(column[list(k)]) for k in ((6, 7, 8, 9), (2, 3), (10, 11)))  # type: ignore[return-value]

    found = {n: groups(c[n].column("jerk")) for n in PAPER}
    holds = all(high > low and high > last for high, low, last in found.values())
    shown = "; ".join(f"{n} {a:.0f}, {b:.0f}, {d:.0f}" for n, (a, b, d) in found.items())
    human = ""
    if c.human is not None:
        a, b, d = groups(c.human.column("jerk", 12))
        human = f" The human's: {a:.0f}, {b:.0f}, {d:.0f}."
    return Claim(
        "Jerk is high in 7-10 and low in 3-4 and 11-12, for all.",
        f"Geometric means in 7-10, 3-4 and 11-12 [m²/s⁵]: {shown}.{human}",
        REPRODUCED if holds else NOT,
        "Condition: for every controller. Our human flings the arms in 3-4 and 11, so for a"
        " person it does not hold in general.",
    )


def _jerk_correlates(c: Comparison, _: Extras) -> Claim:
    rows = correlations(c)
    among = [(a, b, r) for a, b, r, _ in rows if {a, b} <= set(PAPER)]
    human = [(a, r, p) for a, b, r, p in rows if b == "human" and a in PAPER]
    shown = ", ".join(f"{a} with {b} {r:.2f}" for a, b, r in among)
    people = ", ".join(f"{a} {r:.2f} (p = {p:.2f})" for a, r, p in human)
    if c.human is not None:
        others = [k for k in range(12) if k not in (2, 3)]
        jerk = c.human.column("jerk", 12)[others]
        rho = {n: float(spearmanr(c[n].column("jerk")[others], jerk).statistic) for n in PAPER}
        people += f"; without 3 and 4, {_list(rho, '.2f')}"
    return Claim(
        "The jerk of different controllers and the human's correlate obviously over sub-tasks.",
        f"Spearman's rho: {shown}. With the human: {people or 'no data'}.",
        REPRODUCED
        if all(r > 0.6 for *_, r in among) and human and all(p < 0.05 for *_, p in human)
        else NOT,
        "Condition: rho > 0.6 among controllers, and p < 0.05 of each with the human. Among"
        " controllers it follows from the task; the human's 3, 4 and 11 are unlike any of them.",
    )


# --- use and cost -----------------------------------------------------------------------------


def _linear_for_small_errors(c: Comparison, _: Extras) -> Claim:
    servo = c.body.map.servos[next(iter(c.body.map.limbs.values())).shoulder[0]]
    s = servo.width
    small, large = (float(np.exp(-(e**2) / (2 * s**2))) for e in (0.1 * s, 3.0 * s))
    return Claim(
        "A torque field is like a servo for small errors and lets go at large ones (figure 2).",
        f"Torque as a share of the servo's: {small:.3f} at a tenth of the width ({0.1 * s:.2f}"
        f" rad), {large:.3f} at three widths ({3 * s:.1f} rad).",
        REPRODUCED if small > 0.95 and large < 0.1 else NOT,
        "Condition: more than 0.95 and less than 0.1. It follows from eq 3, with which a test"
        " compares the code.",
    )


def _cost_order(_: Comparison, e: Extras) -> Claim:
    shown = ", ".join(f"{name} {us:.3f}" for name, us in e.costs.items())
    ordered = e.costs[PD] < e.costs[FIELD] < e.costs[IMPEDANCE]
    return Claim(
        "Computing cost: PD servo < torque field < impedance.",
        f"One limb's field, in a batch [µs per simulation and step]: {shown}.",
        REPRODUCED if ordered else NOT,
        "All of them are small beside the physics: see the costs of whole dances above.",
    )


def _inverse_kinematics_costs_more(_: Comparison, e: Extras) -> Claim:
    ratio = e.ik / e.costs[IMPEDANCE]
    return Claim(
        "Impedance is considerably less complex than explicit inverse kinematics.",
        f"A posture found by iterating mink's differential IK takes {e.ik:.0f} µs, one step of"
        f" impedance {e.costs[IMPEDANCE]:.2f} µs: {ratio:.0f} times as long.",
        REPRODUCED if ratio > 1 else NOT,
        "Ours solves it only when a task is bound, never in the loop.",
    )


def _user_effort(c: Comparison, _: Extras) -> Claim:
    numbers = {d.name: int(d.column("numbers").sum()) for d in c.dancers}
    return Claim(
        "A user supplies per arm and sub-task: torque field 14 values, PD servo 7 at every step"
        " (through a spline), impedance 7.",
        f"Numbers in our task files for all twelve sub-tasks: {_list(numbers, 'd')}; a posture"
        " or landmark that is named costs none.",
        REPRODUCED if numbers[FIELD] > 1.8 * max(numbers[PD], numbers[IMPEDANCE]) else NOT,
        "Condition: the torque field needs nearly twice as many as either other. "
        "Naming places replaces most numbers: what is left are via points and elbow directions,"
        " about as many for every controller.",
    )


def _force_is_set_aside(c: Comparison, e: Extras) -> Claim:
    dancer = e.endpoint_force
    checks = {m.what: m for m in dancer.judgement.checks}
    settling = np.median(dancer.column("settling")[np.isfinite(dancer.column("settling"))])
    own = np.median(c[IMPEDANCE].column("settling"))
    return Claim(
        "A force on the hand alone needs high damping elsewhere and moves unnaturally.",
        f"{dancer.judgement.passed} of 12 sub-tasks succeed (impedance:"
        f" {c[IMPEDANCE].judgement.passed}); peak torque {checks['peak torque'].value:.2f} of the"
        f" limit; the hand settles after {settling:.2f} s (impedance {own:.2f} s).",
        REPRODUCED if dancer.judgement.passed < c[IMPEDANCE].judgement.passed else NOT,
        "Nothing turns the palm or holds the elbow: postures and palms are left to chance.",
    )


def _combination_suits_best(c: Comparison, _: Extras) -> Claim:
    said = "Combining controllers, each where it suits, would serve better than any alone."
    if COMBINED not in c:
        return Claim(said, "The combination was not run.", OPEN, "")
    passed = {d.name: d.judgement.passed for d in c.dancers}
    numbers = {d.name: int(d.column("numbers").sum()) for d in c.dancers}
    jerk = {d.name: _geometric(d.column("jerk")) for d in c.dancers}
    best = passed[COMBINED] >= max(passed.values()) and numbers[COMBINED] <= min(numbers.values())
    return Claim(
        said,
        f"Sub-tasks: {_list(passed, 'd')}. Numbers to give: {_list(numbers, 'd')}. Jerk:"
        f" {_list(jerk, '.0f')}.",
        REPRODUCED if best else NOT,
        "Condition: as many sub-tasks as the best, with as few numbers as the fewest. Proposed in"
        " the paper's section 9, not tested there.",
    )


CLAIMS: Sequence[Callable[[Comparison, Extras], Claim]] = (
    _linear_for_small_errors,
    _pd_is_fastest,
    _peaks_are_near(FIELD),
    _peaks_are_near(IMPEDANCE),
    _pd_is_smooth_and_symmetric,
    _field_is_consistent,
    _impedance_matches_shape,
    _via_points_dent,
    _pd_curves_in_10,
    _impedance_is_jerkier,
    _jerk_by_subtask,
    _jerk_correlates,
    _cost_order,
    _inverse_kinematics_costs_more,
    _user_effort,
    _force_is_set_aside,
    _combination_suits_best,
)


def _alike(c: Comparison, name: str, number: int) -> float:
    """Correlation of a speed profile with the human's, both over the share of the time."""
    assert c.human is not None
    human = c.human.moves[number].speed
    return float(np.corrcoef(c[name].speed(number, len(human)), human)[0, 1])


def _peaks(dancer: Dancer, number: int) -> int:
    """How many peaks the hand's speed has in a sub-task."""
    speed = dancer.speed(number)
    found, _ = find_peaks(np.concatenate([[0], speed, [0]]), prominence=DENT * speed.max())
    return len(found)


def _geometric(values: FloatArray) -> float:
    return float(np.exp(np.nanmean(np.log(np.maximum(values, 1e-9)))))


def _variation(values: FloatArray) -> float:
    return float(np.nanstd(values) / np.nanmean(values))


def _list(values: dict[str, float] | dict[str, int], style: str) -> str:
    return ", ".join(f"{name} {value:{style}}" for name, value in values.items())

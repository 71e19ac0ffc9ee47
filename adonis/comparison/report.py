"""What a comparison leaves behind: one HTML page, figures, and every number as CSV and JSON."""

import base64
import csv
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields
from io import StringIO
from pathlib import Path
from typing import Any

import jinja2
import numpy as np

from adonis.comparison.claims import (
    Claim,
    Extras,
    can_claim,
    claims,
    correlations,
    measure_extras,
    near_human,
)
from adonis.comparison.comparing import Comparison, Dancer, Move, compare
from adonis.comparison.figures import Drawn, draw_all, draw_pictures
from adonis.comparison.human import Human
from adonis.comparison.superposition import as_table, star, study
from adonis.comparison.superposition_figure import draw_superposition
from adonis.dancing import versions
from adonis.reporting import prepare_folder, write_text
from primitives import Primitive
from sim import Body, NoDisplay

Table = tuple[Sequence[str], Sequence[Sequence[str]]]
KINDS = {".svg": "image/svg+xml", ".png": "image/png"}

# What the page shows of each sub-task; the CSV has all of it.
SHOWN: tuple[tuple[str, str, str], ...] = (
    ("", "success", ""),
    ("peak [m/s]", "peak_speed", ".2f"),
    ("peak/mean", "peak_over_mean", ".2f"),
    ("time to peak", "time_to_peak", ".2f"),
    ("symmetry", "symmetry", ".2f"),
    ("at 5 Hz [m/s]", "peak_at_5hz", ".2f"),
    ("jerk [m²/s⁵]", "jerk", ".0f"),
    ("normalised", "normalised_jerk", ".0f"),
    ("SPARC", "spectral_arc_length", ".2f"),
    ("path [m]", "path", ".2f"),
    ("off line [m]", "line_deviation", ".2f"),
    ("curvature [1/m]", "curvature", ".1f"),
    ("settled [s]", "settling", ".2f"),
    ("tracking", "tracking", ".3f"),
    ("∫τ² [N²m²s]", "joint_effort", ".0f"),
    ("work [J]", "joint_work", ".0f"),
    ("hand work [J]", "hand_work", ".0f"),
    ("numbers", "numbers", "d"),
)


@dataclass(frozen=True)
class Written:
    """What was written where."""

    folder: Path
    files: tuple[Path, ...]
    claims: tuple[Claim, ...]
    notices: tuple[str, ...]


def compare_and_write(
    task: str,
    body: Body,
    folder: Path,
    *,
    dancers: Sequence[str],
    human: Human | None = None,
    quick: bool = False,
    seed: int = 0,
    primitives: Sequence[type[Primitive]] = (),
    progress: Callable[[str, float], None],
) -> tuple[Comparison, Written]:
    """Everything that `adonis compare` does.

    Args:
        task: a name of the library, or a path.
        body: whose task it is.
        folder: where to.
        dancers: names of controllers, or `combined`.
        human: figures of a human.
        quick: leave out timings, claims and the least-squares study.
        seed: written into the recordings.
        primitives: classes of one's own that the task may use.
        progress: told what is being done, and the share that is done.

    Raises:
        InputError, OutputError, RecordingError, SpecError, Stopped: see `compare` and
            `write_comparison`.
    """

    def part(first: float, last: float) -> Callable[[str, float], None]:
        return lambda what, share: progress(what, first + share * (last - first))

    prepare_folder(folder)
    comparison = compare(
        task, body, dancers=dancers, human=human, seed=seed, costs=not quick,
        primitives=primitives, progress=part(0.0, 0.4),
    )  # fmt: skip
    extras, table, more = None, None, []
    if not quick and can_claim(comparison):
        progress("what only the paper's claims need", 0.4)
        extras = measure_extras(task, body)
        told = part(0.5, 0.8)
        rows = study(progress=lambda share, what: told(f"least squares: {what}", share))
        table = as_table(rows)
        path = folder / "superposition.png"
        draw_superposition(rows, star(), path)
        more.append(Drawn("Weights by least squares", SUPERPOSED, (path,)))
    written = write_comparison(
        comparison, folder, extras=extras, superposition=table, more_figures=more,
        progress=part(0.8, 1.0),
    )  # fmt: skip
    return comparison, written


SUPERPOSED = (
    "Torque error and deviation of the hand from a straight line over the number of fields; at"
    " the right the paths of the planar hand over the lines that were wanted."
)


def write_comparison(
    comparison: Comparison,
    folder: Path,
    *,
    extras: Extras | None = None,
    superposition: Table | None = None,
    more_figures: Sequence[Drawn] = (),
    pictures: bool = True,
    progress: Callable[[str, float], None] | None = None,
) -> Written:
    """Write the report of a comparison.

    Args:
        comparison: of whom.
        folder: where to.
        extras: what the paper's claims need beside; without them none are made.
        superposition: table of the least-squares study, if it was made.
        more_figures: that belong into the report.
        pictures: whether to render filmstrips and the time-lapse.
        progress: told what is being made and the share that is done.

    Raises:
        OutputError, RecordingError: a file cannot be written.
    """

    def tell(what: str, share: float) -> None:
        if progress is not None:
            progress(what, share)

    prepare_folder(folder)
    made = tuple(claims(comparison, extras)) if extras else ()
    figures = list(draw_all(comparison, folder, tell))
    notices: list[str] = []
    try:
        if pictures:
            figures += draw_pictures(comparison, folder, tell)
    except NoDisplay as notice:
        notices.append(str(notice))
    figures += more_figures
    for dancer in comparison.dancers:
        dancer.recording.save(folder / f"recording_{dancer.name}.npz")
    page = _page(comparison, made, figures, notices, superposition)
    whole = {
        "task": comparison.task,
        "body": comparison.body.map.name,
        "dancers": [d.as_dict() for d in comparison.dancers],
        "claims": [asdict(c) for c in made],
        "jerk_correlations": correlations(comparison),
        "extras": _extras(extras),
        "versions": versions(),
    }
    write_text(folder / "report.html", page)
    write_text(folder / "measures.csv", _csv(comparison))
    write_text(folder / "comparison.json", json.dumps(_plain(whole), indent=2) + "\n")
    names = ("report.html", "measures.csv", "comparison.json")
    drawn = tuple(file for figure in figures for file in figure.files)
    return Written(folder, (*(folder / n for n in names), *drawn), made, tuple(notices))


def summary(comparison: Comparison) -> tuple[list[str], list[tuple[str, list[str]]]]:
    """One row for each dancer: success, checks, effort, cost."""
    heads = ["sub-tasks", "deepest [mm]", "clearance [mm]", "peak torque", "hand-over step"]
    heads += ["jerk, geometric mean", "effort [N²m²s]", "work [J]", "numbers to give"]
    heads += ["µs a step", "of physics"]
    if comparison.human is not None:
        heads.append("peaks near human")
    rows = []
    for d in comparison.dancers:
        check = {c.what: c.value for c in d.judgement.checks}
        row = [
            f"{d.judgement.passed} of {len(d.moves)}",
            f"{1000 * check['worst penetration']:.1f}",
            f"{1000 * d.clearance:.1f}",
            f"{check['peak torque']:.2f}",
            f"{check['hand-over torque step']:.3f}",
            f"{np.exp(np.nanmean(np.log(d.column('jerk')))):.0f}",
            f"{np.nansum(d.column('joint_effort')):.0f}",
            f"{np.nansum(d.column('joint_work')):.0f}",
            f"{int(d.column('numbers').sum())}",
            f"{d.cost['dance_us']:.1f}" if "dance_us" in d.cost else "-",
            f"{d.cost['ratio']:.2f}" if "ratio" in d.cost else "-",
        ]
        if comparison.human is not None:
            row.append(f"{near_human(comparison, d)[0]} of {len(d.moves)}")
        rows.append((d.name, row))
    return heads, rows


def failures(comparison: Comparison) -> list[str]:
    """One sentence for each dancer that did not do everything, and what it missed."""
    found = []
    for d in comparison.dancers:
        missed = [
            f"{k} ({v.worst.what} {v.worst.value:.3g} {v.worst.unit}, allowed {v.worst.limit:g})"
            if v.worst
            else f"{k} ({v.span.outcome})"
            for k, v in enumerate(d.judgement.verdicts, start=1)
            if not v.success
        ]
        missed += [
            f"{c.what} {c.value:.3g} {c.unit}, allowed {c.limit:g}"
            for c in d.judgement.checks
            if not c.success
        ]
        if missed:
            found.append(f"{d.name} misses {'; '.join(missed)}.")
    return found


def _page(
    comparison: Comparison,
    made: Sequence[Claim],
    figures: Sequence[Drawn],
    notices: Sequence[str],
    superposition: Table | None,
) -> str:
    """The report as one HTML page that needs nothing beside it."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("adonis"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    return environment.get_template("comparison.html").render(
        title=comparison.title,
        body=comparison.body.map.name,
        command=f"adonis compare {comparison.task}",
        versions=", ".join(f"{name} {number}" for name, number in versions().items()),
        summary=summary(comparison),
        failures=failures(comparison),
        claims=made,
        human_about=comparison.human.about if comparison.human else "",
        figures=[
            {"title": f.title, "caption": f.caption, "source": _embedded(f.files[0])}
            for f in figures
        ],
        notices=notices,
        correlations=correlations(comparison),
        superposition=superposition,
        measures=[(d.name, _measures(d)) for d in comparison.dancers],
    )


def _embedded(file: Path) -> str:
    """A picture as a data URI."""
    return f"data:{KINDS[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"


def _measures(dancer: Dancer) -> Table:
    """What the page shows of every sub-task."""
    rows = []
    for move in dancer.moves:
        cells = [f"{move.number} {move.name}"]
        for _, name, style in SHOWN:
            value = getattr(move, name)
            if name == "success":
                cells.append("ok" if value else "failed")
            elif not np.isfinite(value):
                cells.append("-")
            else:
                cells.append(
                    f"{value:{style}}" + (move.tracking_unit if name == "tracking" else "")
                )
        rows.append(cells)
    return [head for head, _, _ in SHOWN], rows


def _csv(comparison: Comparison) -> str:
    """Every measure of every sub-task by everybody."""
    stream = StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    columns = [f.name for f in fields(Move)]
    writer.writerow(["dancer", *columns])
    for dancer in comparison.dancers:
        for move in dancer.moves:
            writer.writerow([dancer.name, *(getattr(move, c) for c in columns)])
    return stream.getvalue()


def _extras(extras: Extras | None) -> dict[str, Any] | None:
    if extras is None:
        return None
    return {
        "endpoint_force": extras.endpoint_force.as_dict(),
        "impedance_linear": extras.linear.as_dict(),
        "controller_us": extras.costs,
        "inverse_kinematics_us": extras.ik,
    }


def _plain(value: Any) -> Any:
    """Plain data: what is not finite becomes null."""
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value

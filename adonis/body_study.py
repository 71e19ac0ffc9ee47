"""How often proposals for bodies are right: `python -m adonis.body_study`.

For models that others made, each with what is true of it written down by hand after a look at
pictures of it (`tests/bodies`), a body file is proposed and compared: the way the body faces,
every joint's name, sense and zero, and every landmark. A landmark is right if it is no farther
from where it should be than an eighth of upper arm and forearm (7 cm on a man). The models come
out of installed packages; one that is not installed is said to be missing.
"""

import json
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict
from rich.console import Console
from rich.progress import track
from rich.table import Table

from sim import BodyError, BodyFile, Proposal, Source, hanging_places, propose, read_model
from specs import read_checked

FloatArray = NDArray[np.float64]

TRUTHS = Path(__file__).parents[1] / "tests" / "bodies"
NEAR = 0.125  # of upper arm and forearm: a landmark that is no farther off is right
ZERO = 15.0  # of a joint from the hand-made one [deg]
MOST = 0.9  # share of the landmarks that must be right, and all joints, for a body to be right


SEEN = {
    "while": "the rules were made with these in view",
    "after": "the rules were mended after a look at these",
    "never": "the rules have never been changed for these",
}


class Truth(BaseModel):
    """What is true of a model, by hand."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    robot: str
    package: str
    model: str  # below the folder of installed packages
    seen: Literal["while", "after", "never"]  # the rules were made seeing it, mended by it, or not
    forward: str
    up: str
    joints: dict[str, dict[str, str]]  # part -> anatomical name -> joint, with - if flipped
    zeros: dict[str, float] = {}  # joint -> where the anatomical angle is 0 [deg], else 0
    arm: float  # upper arm and forearm [m]
    landmarks: dict[str, tuple[float, float, float]] = {}  # from between the shoulders [m]


@dataclass
class Score:
    """How a proposal compares."""

    truth: Truth
    seconds: float = 0.0
    faces: bool = False
    joints: int = 0  # that are right
    wrong_joints: list[str] = field(default_factory=list)
    landmarks: int = 0
    wrong_landmarks: list[str] = field(default_factory=list)
    problem: str = ""  # why there is nothing to compare

    @property
    def right(self) -> bool:
        """Whether the map is right, but for a landmark or two."""
        marks = self.landmarks + len(self.wrong_landmarks)
        good = marks == 0 or self.landmarks >= MOST * marks
        return not self.problem and self.faces and not self.wrong_joints and good


def truths(folder: Path = TRUTHS) -> list[Truth]:
    """All that were written down."""
    return [read_checked(path, Truth) for path in sorted(folder.glob("*.yaml"))]


def model_of(truth: Truth, packages: tuple[Path, ...]) -> Path | None:
    """The file of a model, if its package is installed."""
    return next((p / truth.model for p in packages if (p / truth.model).is_file()), None)


def study(truth: Truth, model: Path) -> Score:
    """Propose a body file and compare it."""
    began = time.perf_counter()
    try:
        source = read_model(model)
        proposal = propose(source, truth.robot, model.name)
    except BodyError as problem:
        return Score(truth, problem=str(problem))
    spent = time.perf_counter() - began
    score = compare(truth, source, proposal)
    score.seconds = spent
    return score


def compare(truth: Truth, source: Source, proposal: Proposal) -> Score:
    """Compare a proposal with what is true."""
    score, file = Score(truth), proposal.file
    score.faces = (file.base.forward, file.base.up) == (truth.forward, truth.up)
    _compare_joints(score, file)
    _compare_landmarks(score, proposal, hanging_places(source, file))
    return score


def _compare_joints(score: Score, file: BodyFile) -> None:
    parts = {"waist": file.waist, "neck": file.neck}
    parts |= {name: limb.joints for name, limb in file.limbs.items()}
    for part in dict.fromkeys([*score.truth.joints, *parts]):
        wanted, found = score.truth.joints.get(part, {}), parts.get(part, {})
        for name in dict.fromkeys([*wanted, *found]):
            if name in wanted and name in found:
                of = found[name]
                said = f"-{of.joint}" if of.flipped else of.joint
                zero = score.truth.zeros.get(of.joint, 0.0)
                # The two sides of a gripper are alike.
                off = min(abs(of.zero - zero), abs(of.zero + zero))
                sense = said == wanted[name] or (abs(zero) > ZERO and of.joint in wanted[name])
                if sense and off < ZERO:
                    score.joints += 1
                    continue
            score.wrong_joints.append(f"{part} {name}")


def _compare_landmarks(score: Score, proposal: Proposal, places: dict[str, FloatArray]) -> None:
    wanted = _both_sides(score.truth.landmarks)
    near = NEAR * score.truth.arm
    for name in dict.fromkeys([*wanted, *proposal.file.landmarks]):
        known = name in wanted and name in places
        if known and float(np.linalg.norm(places[name] - wanted[name])) < near:
            score.landmarks += 1
        else:
            score.wrong_landmarks.append(name)


def _both_sides(landmarks: dict[str, tuple[float, float, float]]) -> dict[str, FloatArray]:
    """Landmarks with the right ones made of the left ones in a mirror."""
    found = {name: np.array(place) for name, place in landmarks.items()}
    for name, (x, y, z) in landmarks.items():
        if name.startswith("left_"):
            found.setdefault("right_" + name.removeprefix("left_"), np.array([x, -y, z]))
    return found


def print_scores(console: Console, scores: list[Score]) -> None:
    """A row for each robot, and what was wrong."""
    table = Table("robot", "seen", "faces", "joints", "landmarks", "map", "s", "wrong")
    for score in scores:
        if score.problem:
            row = score.truth.robot, score.truth.seen, "", "", "", "-", "", score.problem
            table.add_row(*row)
            continue
        table.add_row(
            score.truth.robot,
            score.truth.seen,
            "right" if score.faces else "WRONG",
            f"{score.joints} of {score.joints + len(score.wrong_joints)}",
            f"{score.landmarks} of {score.landmarks + len(score.wrong_landmarks)}",
            "right" if score.right else "wrong",
            f"{score.seconds:.1f}",
            ", ".join([*score.wrong_joints, *score.wrong_landmarks]),
        )
    console.print(table)
    for when, said in SEEN.items():
        chosen = [s for s in scores if s.truth.seen == when and not s.problem]
        if chosen:
            maps = sum(score.right for score in chosen)
            counts = [
                (sum(right), sum(right) + sum(wrong))
                for right, wrong in (
                    ([s.joints for s in chosen], [len(s.wrong_joints) for s in chosen]),
                    ([s.landmarks for s in chosen], [len(s.wrong_landmarks) for s in chosen]),
                )
            ]
            (joints, all_joints), (marks, all_marks) = counts
            console.print(
                f"{said}: {maps} of {len(chosen)} maps, {joints} of {all_joints} joints,"
                f" {marks} of {all_marks} landmarks"
            )


def main(
    packages: Annotated[
        list[Path] | None,
        typer.Option("--packages", help="Further folders of installed packages (site-packages)."),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Write the scores as JSON.")] = None,
) -> None:
    """Propose body files for other people's robots, and count what is right."""
    console = Console()
    folders = (*(Path(p) for p in sys.path if p), *(packages or ()))
    scores = []
    for truth in track(truths(), "proposing", console=console, transient=True):
        model = model_of(truth, folders)
        missing = Score(truth, problem=f"not installed: {truth.package}")
        scores.append(study(truth, model) if model else missing)
    print_scores(console, scores)
    if out is not None:
        out.write_text(json.dumps([_plain(score) for score in scores], indent=1) + "\n")


def _plain(score: Score) -> dict[str, Any]:
    said = {key: value for key, value in vars(score).items() if key != "truth"}
    return {"robot": score.truth.robot, "seen": score.truth.seen, **said, "right": score.right}


if __name__ == "__main__":
    typer.run(main)

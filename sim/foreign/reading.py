"""Reading a model that somebody else made: MJCF or URDF, into MuJoCo's own numbers.

Only the model in memory is mended, and only as far as MuJoCo must have it: meshes that are not
there, moments that no body can have. What was done is said. The file is never changed.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.errors import BodyError
from sim.foreign.surface import shapes_of, solid, spread
from sim.foreign.urdf import Urdf, read_urdf

FloatArray = NDArray[np.float64]

LEAST_MASS = 1e-6  # stands for "none was given" in what was read [kg]
LEAST_INERTIA = 1e-9  # [kg m^2]
DENSITY = 1000.0  # of a link whose moments make no sense, taken for a ball [kg/m^3]
HOMES = ("home", "stand", "rest", "stand_bent_knees", "neutral")  # keyframes that may be one


@dataclass(frozen=True)
class Source:
    """A model as it was read, and what the file says beside."""

    path: Path
    model: Any  # mujoco.MjModel
    home: FloatArray  # (nq,) as the file has it at the beginning
    speeds: dict[str, float]  # joint -> largest [rad/s]
    follows: dict[str, str]  # joint -> the one that moves it along
    notes: tuple[str, ...]  # what was missing or mended, one sentence each


def read_model(path: str | Path) -> Source:
    """Read a model.

    Raises:
        BodyError: the file is not there, is no model, or is one that MuJoCo refuses.
    """
    path = Path(path)
    if not path.is_file():
        raise BodyError(f"there is no model {path}: expected a file in MJCF or URDF")
    urdf = None
    try:
        if _is_urdf(path):
            urdf, model, notes = _of_urdf(path)
        else:
            spec = mujoco.MjSpec.from_file(str(path))
            notes = _without_lost_meshes(spec)
            model = _compiled(spec, notes)
    except (ValueError, mujoco.FatalError) as problem:
        said = " ".join(str(problem).split())
        raise BodyError(f"{path}: MuJoCo cannot read it: {said}") from None
    return Source(
        path=path,
        model=model,
        home=_home(model),
        speeds=urdf.speeds if urdf else {},
        follows=urdf.follows if urdf else {},
        notes=tuple(notes),
    )


def _of_urdf(path: Path) -> tuple[Urdf, Any, list[str]]:
    """Compile a URDF; a Collada mesh with y upward is turned if that fits its link better."""
    plain = read_urdf(path)
    model, notes = _from_text(plain)
    files = set().union(*plain.y_up.values())
    if not files:
        return plain, model, notes
    other, _ = _from_text(read_urdf(path, files))
    better = {
        name
        for name in plain.y_up
        if misplaced(other, other.body(name).id) < misplaced(model, model.body(name).id)
    }
    turned = set().union(*(plain.y_up[name] for name in better))
    urdf = read_urdf(path, turned)
    model, notes = _from_text(urdf)
    if turned:
        notes.append(f"meshes that have y upward were turned: those of {_some(sorted(better))}")
    return urdf, model, notes


def _from_text(urdf: Urdf) -> tuple[Any, list[str]]:
    """Compile what was read of a URDF."""
    notes = _said_of_lost(urdf)
    return _compiled(mujoco.MjSpec.from_string(urdf.text, assets=urdf.assets), notes), notes


def misplaced(model: Any, body: int) -> float:
    """How little the geoms of a link fit its mass: by the middle, and by how both are spread."""
    points = spread(solid(shapes_of(model, body)), 300)
    mass = float(model.body_mass[body])
    if not len(points) or mass < 2.0 * LEAST_MASS:
        return 0.0
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, model.body_iquat[body])
    turn = axes.reshape(3, 3)
    inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
    spread_of_mass = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    spread_of_points = np.cov(points.T)
    size = float(np.sqrt(np.trace(spread_of_points)))
    apart = float(np.linalg.norm(points.mean(axis=0) - model.body_ipos[body])) / size
    unlike = spread_of_mass / np.trace(spread_of_mass) - spread_of_points / size**2
    return apart + float(np.linalg.norm(unlike))


def _is_urdf(path: Path) -> bool:
    """A URDF may be called .xml as well: its root tells."""
    if path.suffix.lower() == ".urdf":
        return True
    try:
        head = path.read_text(encoding="utf-8", errors="replace")[:4000]
    except OSError as problem:
        raise BodyError(f"cannot read {path}: {problem.strerror}") from None
    return "<robot" in head and "<mujoco" not in head


def _said_of_lost(urdf: Urdf) -> list[str]:
    lost = list(dict.fromkeys(urdf.lost))
    if not lost:
        return []
    more = f" and {len(lost) - 1} more like it" if lost[1:] else ""
    return [f"a mesh is left out: {lost[0]}{more}"]


def _without_lost_meshes(spec: Any) -> list[str]:
    """Leave out the geoms whose mesh is not there."""
    folder = Path(spec.modelfiledir) / spec.meshdir
    lost = {m.name: m.file for m in spec.meshes if m.file and not (folder / m.file).is_file()}
    if not lost:
        return []
    for geom in [g for g in spec.geoms if g.meshname in lost]:
        spec.delete(geom)
    for mesh in [m for m in spec.meshes if m.name in lost]:
        spec.delete(mesh)
    more = f" and {len(lost) - 1} more like it" if len(lost) > 1 else ""
    return [f"a mesh is left out: {next(iter(lost.values()))} is not there{more}"]


def _name_all(spec: Any) -> None:
    """Every body and joint gets a name, since the body file speaks of them by name."""
    for kind, elements in (("body", spec.bodies), ("joint", spec.joints)):
        for k, element in enumerate(elements):
            if not element.name:
                element.name = f"{kind}_{k}"


def _compiled(spec: Any, notes: list[str]) -> Any:
    """Compile, with no more mended than must be."""
    compiler = spec.compiler
    compiler.boundmass, compiler.boundinertia = LEAST_MASS, LEAST_INERTIA
    compiler.fusestatic = compiler.discardvisual = False
    _name_all(spec)
    notes += _with_real_moments(spec)
    for mend in (None, _balanced, _shells, _shells):
        if mend is not None:
            mend(spec, notes)
        try:
            return spec.compile()
        except ValueError as problem:
            failed = problem
    raise failed


def _balanced(spec: Any, notes: list[str]) -> None:
    """Let MuJoCo make moments of inertia possible: none is larger than the other two together."""
    spec.compiler.balanceinertia = True
    notes.append("moments of inertia that no body can have were evened out")


def _shells(spec: Any, notes: list[str]) -> None:
    """Meshes that are not closed have a surface but no volume."""
    for mesh in spec.meshes:
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    if "shell" not in "".join(notes):
        notes.append("meshes that are not closed were taken for shells")


def _with_real_moments(spec: Any) -> list[str]:
    """Moments of inertia that are not positive become those of a ball of the link's mass."""
    mended = []
    for body in spec.bodies:
        full = np.array(body.fullinertia)
        if not body.explicitinertial or np.isnan(full[0]):
            continue
        xx, yy, zz, xy, xz, yz = full
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if np.linalg.eigvalsh(tensor)[0] > 0.0 or not body.mass > 0.0:
            continue
        radius = (0.75 * body.mass / (np.pi * DENSITY)) ** (1 / 3)
        body.fullinertia = np.full(6, np.nan)
        body.inertia = [0.4 * body.mass * radius**2] * 3
        body.iquat = [1.0, 0.0, 0.0, 0.0]
        mended.append(body.name)
    if not mended:
        return []
    return [f"moments of inertia that are not positive became those of a ball: {_some(mended)}"]


def _some(names: list[str]) -> str:
    """The first few of some names."""
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if names[4:] else "")


def _home(model: Any) -> FloatArray:
    """The keyframe that is called home or the like, else the posture at zero."""
    names = [model.key(k).name.lower() for k in range(model.nkey)]
    for name in HOMES:
        if name in names:
            return np.array(model.key_qpos[names.index(name)])
    return np.array(model.qpos0)

"""Mesh files that MuJoCo does not read, or not whole, as what it does read.

It knows no Collada and no STL in words, and takes the first group of an OBJ for all of it.
"""

import struct
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

HEADER = 80  # bytes of a binary STL before the number of its triangles


def readable(path: Path, *, honour_up: bool = False) -> tuple[str, bytes] | None:
    """What MuJoCo can read in place of a mesh file: its kind, and its content; empty for the file.

    Args:
        path: of the mesh.
        honour_up: whether a Collada file that has y upward is turned to have z upward.

    Returns:
        None: nobody here can read it.
    """
    kind = path.suffix.lower()
    match kind:
        case ".msh":
            return kind, b""
        case ".obj":
            return kind, _in_one_group(path.read_bytes())
        case ".dae":
            made = stl_of_collada(path, honour_up=honour_up)
        case ".stl":
            if not _in_words(path):
                return kind, b""
            made = _stl_of_words(path)
        case _:
            return None
    return None if made is None else (".stl", made)


def has_y_up(path: Path) -> bool:
    """Whether a Collada file says that its y axis is upward."""
    return path.suffix.lower() == ".dae" and b"Y_UP" in path.read_bytes()[:5000]


def stl_of_collada(path: Path, *, honour_up: bool = False) -> bytes | None:
    """The triangles of a Collada file as a binary STL, in metres; None if it has none.

    Some tools honour the upward axis of the file, some do not, and models are made for either.
    """
    read = _collada(path)
    if read is None:
        return None
    corners, y_up = read
    if honour_up and y_up:
        corners = np.stack([corners[..., 0], -corners[..., 2], corners[..., 1]], axis=-1)
    return _stl(corners)


@lru_cache(maxsize=256)
def _collada(path: Path) -> tuple[NDArray[np.float64], bool] | None:
    """The triangles (k, 3, 3) of a Collada file [m], and whether its y axis is upward."""
    import collada  # noqa: PLC0415  (only models that have such meshes need it)
    from collada.common import DaeError  # noqa: PLC0415

    try:
        scene = collada.Collada(str(path), ignore=[DaeError])
    except (DaeError, OSError, ValueError, AttributeError, KeyError, SyntaxError):
        return None
    if scene.scene is None:
        return None
    with warnings.catch_warnings():  # pycollada multiplies with NumPy's old matrices
        warnings.simplefilter("ignore", PendingDeprecationWarning)
        parts = _triangles_of(scene)
    if not parts:
        return None
    y_up = scene.assetInfo.upaxis == collada.asset.UP_AXIS.Y_UP
    return np.concatenate(parts) * (scene.assetInfo.unitmeter or 1.0), y_up


def _triangles_of(scene: Any) -> list[NDArray[np.float64]]:
    """The triangles (k, 3, 3) of each part of a Collada scene, in its own unit."""
    parts: list[NDArray[np.float64]] = []
    for geometry in scene.scene.objects("geometry"):
        for primitive in geometry.primitives():
            triangles = primitive.triangleset() if hasattr(primitive, "triangleset") else primitive
            corners = getattr(triangles, "vertex_index", None)
            if corners is None or triangles.vertex is None or np.ndim(corners) != 2:
                continue  # lines
            if np.shape(corners)[1] == 3 and len(corners):
                parts.append(np.asarray(triangles.vertex, dtype=float)[corners])
    return parts


def _stl(triangles: NDArray[np.float64]) -> bytes:
    """Triangles (k, 3, 3) [m] as a binary STL."""
    rows = np.zeros(len(triangles), dtype=[("corners", "<f4", (4, 3)), ("flags", "<u2")])
    rows["corners"][:, 1:] = triangles  # the normal before them is left to the reader
    return bytes(HEADER) + struct.pack("<I", len(triangles)) + rows.tobytes()


def _in_words(path: Path) -> bool:
    """Whether an STL is written in words; some binary ones begin with `solid` as well."""
    content = path.read_bytes()
    return content[:5] == b"solid" and b"facet" in content[:1000] and b"\0" not in content[:1000]


def _stl_of_words(path: Path) -> bytes | None:
    rows = [line.split()[1:4] for line in path.read_text("ascii", "replace").splitlines()
            if line.lstrip().startswith("vertex")]  # fmt: skip
    try:
        return _stl(np.array(rows, dtype=float).reshape(-1, 3, 3))
    except ValueError:
        return None


def _in_one_group(content: bytes) -> bytes:
    """An OBJ without its groups and materials; empty if it has only one."""
    lines = content.splitlines()
    parts = (b"g ", b"o ", b"usemtl ", b"mtllib ")
    if sum(line.startswith(parts[:3]) for line in lines) < 2:
        return b""
    return b"\n".join(line for line in lines if not line.startswith(parts)) + b"\n"

"""URDF as MuJoCo wants it: meshes found, Collada made STL, nothing thrown away on the way."""

import os
import xml.etree.ElementTree as ET
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlparse

from sim.errors import BodyError
from sim.foreign.mesh_files import has_y_up, readable

FASTEST = 100.0  # what is said to be faster is no limit at all [rad/s]
SIZES = ("radius", "length", "size")  # of boxes, cylinders and spheres


@dataclass
class Urdf:
    """A URDF, ready for MuJoCo, and what MuJoCo would not tell of it."""

    text: str
    assets: dict[str, bytes] = field(default_factory=dict)
    speeds: dict[str, float] = field(default_factory=dict)  # joint -> largest [rad/s]
    follows: dict[str, str] = field(default_factory=dict)  # joint -> the one that it mimics
    lost: list[str] = field(default_factory=list)  # meshes that were not found or not read
    named: dict[Path, str] = field(default_factory=dict)  # file -> its name among the assets
    # Link -> its Collada meshes that say that y is upward.
    y_up: dict[str, set[Path]] = field(default_factory=dict)


def read_urdf(path: Path, turned: Collection[Path] = ()) -> Urdf:
    """Read a URDF; meshes are looked for in the folders above it.

    Args:
        path: of the file.
        turned: Collada meshes with y upward that are turned to have z upward.

    Raises:
        BodyError: it is no URDF.
    """
    try:
        root = ET.parse(path).getroot()
    except ET.ParseError as problem:
        line, column = problem.position
        raise BodyError(f"{path}:{line}:{column + 1}: not well-formed XML: {problem}") from None
    if root.tag != "robot":
        raise BodyError(f"{path}: expected a URDF, whose root is <robot>, not <{root.tag}>")
    if any(element.tag.startswith("{http://www.ros.org/wiki/xacro}") for element in root.iter()):
        raise BodyError(
            f"{path}: this is a xacro: expand it first, `xacro {path.name} > robot.urdf`"
        )
    urdf = Urdf("")
    for joint in root.findall("joint"):
        name = joint.get("name", "")
        speed = _number(joint, "limit", "velocity")
        if speed is not None and 0.0 < speed < FASTEST:
            urdf.speeds[name] = speed
        mimic = joint.find("mimic")
        if mimic is not None:
            urdf.follows[name] = mimic.get("joint", "")
    for link in root.findall("link"):
        for kind in ("visual", "collision"):
            for part in link.findall(kind):
                part.attrib.pop("name", None)  # often given twice, and of no use here
                if not _with_its_mesh(part, path, urdf, link.get("name", ""), turned):
                    link.remove(part)
    options = root.find("mujoco")
    if options is not None:
        root.remove(options)
    options = ET.SubElement(root, "mujoco")
    ET.SubElement(
        options,
        "compiler",
        {"strippath": "false", "discardvisual": "false", "fusestatic": "false"},
    )
    urdf.text = ET.tostring(root, encoding="unicode")
    return urdf


def _with_its_mesh(
    part: ET.Element, path: Path, urdf: Urdf, link: str, turned: Collection[Path]
) -> bool:
    """Point a visual or a collision at the file of its mesh; whether it has a shape."""
    mesh = part.find("geometry/mesh")
    if mesh is None:
        shape = part.find("geometry/*")
        return shape is not None and all(size > 0.0 for size in _sizes(shape))
    said = mesh.get("filename", "")
    file = _find(said, path.parent)
    if file is None:
        urdf.lost.append(f"{said} is not there")
        return False
    if file not in urdf.named:
        made = readable(file, honour_up=file in turned)
        if made is None:
            urdf.lost.append(f"{said} cannot be read (STL, OBJ and Collada can)")
            return False
        kind, content = made
        urdf.named[file] = f"{file.stem}-{len(urdf.assets)}{kind}" if content else str(file)
        if content:
            urdf.assets[urdf.named[file]] = content
    if has_y_up(file):
        urdf.y_up.setdefault(link, set()).add(file)
    mesh.set("filename", urdf.named[file])
    return True


def _sizes(shape: ET.Element) -> list[float]:
    """The lengths of a box, cylinder or sphere; what is no number is left to MuJoCo to refuse."""
    try:
        return [float(size) for key in SIZES for size in shape.get(key, "").split()]
    except ValueError:
        return []


def _find(said: str, folder: Path) -> Path | None:
    """The file that a mesh names: a path, or `package://NAME/…` below a folder above the URDF."""
    parsed = urlparse(said)
    inside = unquote(parsed.path).lstrip("/")
    if parsed.scheme in ("", "file"):
        file = Path(unquote(parsed.path))
        tried = [file if file.is_absolute() else folder / file]
    else:  # package://, model://: a folder of that name, or what lies in it
        above = [
            each
            for path in dict.fromkeys((Path(os.path.abspath(folder)), folder.resolve()))
            for each in (path, *path.parents)
        ]
        tried = [each / parsed.netloc / inside for each in above]
        tried += [each / inside for each in above]
    return next((file.resolve() for file in tried if file.is_file()), None)


def _number(element: ET.Element, child: str, attribute: str) -> float | None:
    found = element.find(child)
    try:
        return None if found is None else float(found.get(attribute, ""))
    except ValueError:
        return None

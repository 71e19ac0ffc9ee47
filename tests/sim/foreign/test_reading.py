"""Models as they are found: meshes elsewhere or nowhere, numbers that cannot be, no models."""

import struct
from pathlib import Path

import numpy as np
import pytest

from sim import BodyError, read_model

LINK = """
  <link name="{name}">
    <inertial><mass value="{mass}"/><inertia ixx="{moment}" iyy="{moment}" izz="{moment}"
      ixy="0" ixz="0" iyz="0"/></inertial>
    <visual name="twice"><geometry>{shape}</geometry></visual>
    <collision name="twice"><geometry>{shape}</geometry></collision>
  </link>"""
JOINT = """
  <joint name="{child}_joint" type="revolute">
    <parent link="{parent}"/><child link="{child}"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="{velocity}"/>
  </joint>"""
BOX = '<box size="0.1 0.1 0.3"/>'
# The corners of a tetrahedron, 0.2 m high along z.
CORNERS = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.2]], dtype=float)
FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


def urdf(folder: Path, shape: str = BOX, mass: float = 1.0, moment: float = 0.01) -> Path:
    path = folder / "robot.urdf"
    path.write_text(
        '<robot name="r">'
        + LINK.format(name="a", mass=1.0, moment=0.01, shape=BOX)
        + LINK.format(name="b", mass=mass, moment=moment, shape=shape)
        + JOINT.format(parent="a", child="b", velocity=3)
        + "</robot>"
    )
    return path


def height(path: Path) -> float:
    """Of what link b looks like [m]."""
    model = read_model(path).model
    return float(np.ptp(model.mesh_vert[:, np.argmax(np.ptp(model.mesh_vert, axis=0))]))


def stl(path: Path, scale: float = 1.0) -> None:
    rows = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(scale * CORNERS[list(face)]).ravel(), 0) for face in FACES
    )
    path.write_bytes(b"\0" * 80 + struct.pack("<I", len(FACES)) + rows)


def words(path: Path) -> None:
    lines = ["solid s"]
    for face in FACES:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x} {y} {z}" for x, y, z in CORNERS[list(face)]]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid s"]))


def groups(path: Path) -> None:
    """An OBJ whose last faces are in a second group, without which it has no tip."""
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS]
    for name, faces in (("g one", FACES[:1]), ("g two", FACES[1:])):
        lines += [name, *("f " + " ".join(str(k + 1) for k in face) for face in faces)]
    path.write_text("\n".join(lines) + "\n")


def collada(path: Path, unit: float = 1.0) -> None:
    numbers = " ".join(f"{v / unit:g}" for v in CORNERS.ravel())
    corners = " ".join(str(k) for face in FACES for k in face)
    path.write_text(f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><created>2026-01-01</created><modified>2026-01-01</modified>
    <unit name="u" meter="{unit}"/><up_axis>Z_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="s"><float_array id="f" count="12">{numbers}</float_array><technique_common>
      <accessor source="#f" count="4" stride="3"><param name="X" type="float"/>
      <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
    </source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
    <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{corners}</p>
    </triangles></mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="w"><node><instance_geometry url="#g"/></node>
    </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#w"/></scene>
</COLLADA>""")


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("t.stl", stl),
        ("t.STL", words),
        ("t.obj", groups),
        ("t.dae", collada),
        ("t.DAE", lambda path: collada(path, unit=0.001)),
    ],
    ids=["stl", "stl in words", "obj of two groups", "collada", "collada in millimetres"],
)
def test_meshes_of_all_kinds_are_read_whole_and_in_metres(name, write, tmp_path: Path) -> None:
    write(tmp_path / name)
    assert height(urdf(tmp_path, f'<mesh filename="{name}"/>')) == pytest.approx(0.2, abs=0.03)


@pytest.mark.parametrize("said", ["package://meshes/t.stl", "package://above/meshes/t.stl"])
def test_packages_are_looked_for_in_the_folders_above(said: str, tmp_path: Path) -> None:
    inner = tmp_path / "above" / "urdf"
    (tmp_path / "above" / "meshes").mkdir(parents=True)
    inner.mkdir()
    stl(tmp_path / "above" / "meshes" / "t.stl")
    assert height(urdf(inner, f'<mesh filename="{said}"/>')) == pytest.approx(0.2, abs=0.03)


def test_packages_are_found_from_inside_their_folder_and_through_a_link(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inner = tmp_path / "above" / "urdf"
    (tmp_path / "above" / "meshes").mkdir(parents=True)
    inner.mkdir()
    stl(tmp_path / "above" / "meshes" / "t.stl")
    said = '<mesh filename="package://above/meshes/t.stl"/>'
    monkeypatch.chdir(inner)
    assert height(urdf(Path(), said)) == pytest.approx(0.2, abs=0.03)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "link").symlink_to(inner)
    found = urdf(tmp_path / "elsewhere" / "link", said)
    assert height(found) == pytest.approx(0.2, abs=0.03)


@pytest.mark.parametrize(
    ("name", "said"), [("gone.stl", "gone.stl is not there"), ("t.glb", "t.glb cannot be read")]
)
def test_a_mesh_that_is_not_there_is_left_out_and_said(
    name: str, said: str, tmp_path: Path
) -> None:
    if name != "gone.stl":
        (tmp_path / name).write_bytes(b"glTF")
    source = read_model(urdf(tmp_path, f'<mesh filename="{name}"/>'))
    assert source.model.nmesh == 0
    assert any(said in note for note in source.notes)


def test_a_mesh_of_an_mjcf_that_is_not_there_is_left_out_and_said(tmp_path: Path) -> None:
    path = tmp_path / "m.xml"
    path.write_text(
        '<mujoco><asset><mesh name="m" file="gone.stl"/></asset><worldbody><body name="b">'
        '<joint axis="0 1 0"/><geom size="0.1"/><geom type="mesh" mesh="m"/></body></worldbody>'
        "</mujoco>"
    )
    source = read_model(path)
    assert source.model.ngeom == 1
    assert source.notes == ("a mesh is left out: gone.stl is not there",)
    assert source.model.joint(0).name == "joint_0"


@pytest.mark.parametrize("moment", [-0.01, 0.0])
def test_moments_that_cannot_be_are_mended_and_said(moment: float, tmp_path: Path) -> None:
    source = read_model(urdf(tmp_path, moment=moment))
    assert (source.model.body_inertia[source.model.body("b").id] > 0.0).all()
    if moment < 0.0:
        assert any("became those of a ball: b" in note for note in source.notes)


def test_speeds_are_read_unless_they_are_no_limit(tmp_path: Path) -> None:
    path = urdf(tmp_path)
    assert read_model(path).speeds == {"b_joint": 3.0}
    path.write_text(path.read_text().replace('velocity="3"', 'velocity="10000"'))
    assert read_model(path).speeds == {}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "there is no model"),
        ("<robot><link></robot>", "robot.urdf:1:"),
        ("<sdf/>", "expected a URDF, whose root is <robot>, not <sdf>"),
        (
            '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:if value="1"/></robot>',
            "this is a xacro: expand it first",
        ),
        ("<robot name='r'><link name='a'/><joint/></robot>", "MuJoCo cannot read it"),
    ],
)
def test_a_file_that_is_no_model(content: str | None, said: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    if content is not None:
        path.write_text(content)
    with pytest.raises(BodyError, match=said):
        read_model(path)

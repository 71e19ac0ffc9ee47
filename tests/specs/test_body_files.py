"""Body files: what is wrong with one is said at its place, and a right one makes a body."""

from pathlib import Path

import pytest

from sim import build_body, propose, read_model
from specs import SpecError, body_text, find_body, read_body_file, source_of

MODEL = """<mujoco>
  <compiler angle="degree" autolimits="true"/>
  <worldbody>
    <body name="base">
      <geom type="box" size="0.1 0.15 0.4" pos="0 0 0.4" mass="30"/>
      {arms}
    </body>
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>"""
ARM = """
<body name="{s}_one" pos="0 {y} 0.75"><joint name="{s}_pitch" axis="0 1 0" range="-180 60"/>
  <geom size="0.03" mass="0.2"/>
 <body name="{s}_two"><joint name="{s}_roll" axis="{x} 0 0" range="-20 170"/>
  <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.04" mass="1.5"/>
  <body name="{s}_three" pos="0 0 -0.3"><joint name="{s}_bend" axis="0 1 0" range="-140 0"/>
   <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.03" mass="1"/>
   <body name="{s}_four" pos="0 0 -0.25"><joint name="{s}_nod" axis="1 0 0" range="-70 70"/>
    <geom type="box" size="0.04 0.01 0.08" pos="0 0 -0.08" mass="0.4"/>
    <body name="{s}_finger" pos="0 0 -0.16"><joint name="{s}_grip" type="slide" axis="1 0 0"/>
     <geom size="0.01" mass="0.02"/></body></body></body></body></body>"""


@pytest.fixture(scope="module")
def text(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A body file, as it is proposed for a small model; beside it, the model."""
    folder = tmp_path_factory.mktemp("model")
    path = folder / "small.xml"
    sides = {"left": (0.2, 1), "right": (-0.2, -1)}
    path.write_text(
        MODEL.format(
            arms="".join(ARM.format(s=s, y=y, x=x) for s, (y, x) in sides.items()),
            motors="".join(
                f'<motor joint="{s}_{j}" ctrlrange="-50 50"/>'
                for s in sides
                for j in ("pitch", "roll", "bend", "nod")
            ),
        )
    )
    return body_text(propose(read_model(path), "small", str(path)), "small.body.png")


@pytest.fixture
def file(text: str, tmp_path: Path) -> Path:
    path = tmp_path / "small.body.yaml"
    path.write_text(text)
    return path


def test_a_body_file_makes_the_body_that_its_name_says(file: Path) -> None:
    body = find_body(str(file))
    assert body.map.name == "small"
    assert {"right_elbow", "left_shoulder_y"} <= set(body.map.postures["rest"])
    assert body.map.groups["waist"] == ()
    assert "right_grip" not in {body.dof_name(dof) for dof in range(body.nv)}
    read, document = read_body_file(file)
    assert build_body(source_of(read, document), read).xml == body.xml


def test_limits_and_contacts_can_be_switched_off(file: Path) -> None:
    free = find_body(str(file), limits=False, contacts=False)
    assert not free.model.jnt_limited.any()
    assert find_body(str(file)).model.jnt_limited.all()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("joint: left_bend", "joint: left_bent", "unknown joint of the model 'left_bent'; did you"),
        ("joint: left_bend", "joint: left_nod", "the joint 'left_nod' is named twice"),
        ("joint: left_bend", "joint: left_grip", "'left_grip' is a slide: postures are angles"),
        ("trunk: base", "trunk: torso", "unknown link of the model 'torso' (there are: base,"),
        ("forward: +x", "forward: +w", "unknown axis of forward '+w'"),
        ("side: left", "side: port", "side"),
        ("flipped: true", "flippd: true", "unknown key 'flippd'; did you mean 'flipped'?"),
        ("radius: 0.", "radius: -0.", "radius"),
        ("      elbow: {joint: left_bend", "      knee: {joint: left_bend", "has no joint 'elbow'"),
        ("model: /", "model: nowhere/", "there is no model"),
        ("link: trunk, point", "link: chest, point", "unknown link 'chest'"),
        ("postures:\n", "locked: {right_nod: 0}\n\npostures:\n", "is both locked and named"),
    ],
)
def test_what_is_wrong_is_said_at_its_place(old: str, new: str, said: str, file: Path) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(SpecError) as refused:
        find_body(str(file))
    assert said in str(refused.value)
    assert refused.value.line is not None
    assert refused.value.excerpt


def test_joints_out_of_order(file: Path) -> None:
    """The nod is carried by the bend, not the other way round."""
    lines = file.read_text().splitlines()
    bend = next(k for k, line in enumerate(lines) if "joint: left_bend" in line)
    nod = next(k for k, line in enumerate(lines) if "joint: left_nod" in line)
    lines[bend], lines[nod] = lines[nod], lines[bend]
    file.write_text("\n".join(lines))
    with pytest.raises(SpecError, match="follow each other from the trunk outwards"):
        find_body(str(file))


def test_a_model_without_torque_limits_needs_them(file: Path) -> None:
    read, document = read_body_file(file)
    model = Path(read.model)
    weak = file.parent / "weak.xml"
    weak.write_text(model.read_text().replace('ctrlrange="-50 50"', ""))
    file.write_text(file.read_text().replace(str(model), str(weak)))
    with pytest.raises(SpecError, match="no torque limit for 'left_pitch'") as refused:
        find_body(str(file))
    assert refused.value.line is not None
    assert document.data["body"] == "small"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "is empty"),
        ("[1, 2]", "a body file has keys and values"),
        ("task: wave\nsubtasks: []\n", "this is a task, not a body"),
        ("body: b\n", "'model' is missing"),
    ],
)
def test_a_file_that_is_no_body(content: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "b.yaml"
    path.write_text(content)
    with pytest.raises(SpecError, match=said):
        find_body(str(path))


def test_an_unknown_name_lists_those_there_are() -> None:
    with pytest.raises(SpecError) as refused:
        find_body("adoniss")
    assert "did you mean 'adonis'?" in str(refused.value)
    assert "planar-arm" in str(refused.value)
    assert "adonis body new" in str(refused.value)

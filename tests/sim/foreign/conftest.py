"""Models of our own that somebody else might have made: humanoids in MJCF, more or less whole."""

from collections.abc import Callable
from pathlib import Path

import pytest

# Of an arm that hangs: joint, axis for the left side, range [deg].
ARM = {
    "clavicle": ("1 0 0", "-20 20"),
    "pitch": ("0 1 0", "-180 60"),
    "roll": ("1 0 0", "-20 170"),
    "yaw": ("0 0 1", "-90 90"),
    "bend": ("0 1 0", "-140 0"),
    "twist": ("0 0 1", "-90 90"),
    "nod": ("1 0 0", "-70 70"),
    "tilt": ("0 1 0", "-30 30"),
}
SHOULDER, UPPER, FORE, HAND = 0.2, 0.3, 0.26, 0.16  # [m]
CHAINS = {  # by the number of joints
    3: ("pitch", "roll", "bend"),
    4: ("pitch", "roll", "yaw", "bend"),
    5: ("pitch", "roll", "yaw", "bend", "twist"),
    6: ("pitch", "roll", "yaw", "bend", "twist", "nod"),
    7: ("pitch", "roll", "yaw", "bend", "twist", "nod", "tilt"),
    8: ("clavicle", "pitch", "roll", "yaw", "bend", "twist", "nod", "tilt"),
}


def humanoid(
    joints: int = 7,
    *,
    arms: tuple[str, ...] = ("left", "right"),
    waist: bool = True,
    neck: bool = True,
    wheels: bool = False,
    actuator: str = "motor",
    limits: bool = True,
    named: bool = True,
) -> str:
    """A humanoid in MJCF.

    Args:
        joints: of an arm, from 3 to 8.
        arms: which there are.
        waist: whether trunk and pelvis are joined by three hinges, or are one.
        neck: whether the head turns.
        wheels: whether it stands on wheels; else on legs.
        actuator: `motor`, `position` or none.
        limits: whether the hinges have ranges.
        named: whether names of joints and links mean anything.
    """
    made = _Maker(named, limits)
    arm_text = "".join(made.arm(side, joints) for side in arms)
    head = '<geom type="sphere" size="0.1" pos="0.02 0 0.1" mass="4"/>'
    if neck:
        hinges = made.hinge("neck_yaw", "0 0 1", "-60 60") + made.hinge(
            "neck_nod", "0 1 0", "-40 40"
        )
        head = f'<body name="{made.name("head")}" pos="0 0 0.5">{hinges}{head}</body>'
    else:
        head = head.replace("0.02 0 0.1", "0.02 0 0.6")
    trunk = f"""
      <geom type="box" size="0.09 0.15 0.2" pos="0 0 0.2" mass="20"/>{head}{arm_text}"""
    if waist:
        hinges = "".join(
            made.hinge(f"waist_{k}", axis, "-40 40")
            for k, axis in enumerate(("0 0 1", "1 0 0", "0 1 0"))
        )
        trunk = f'<body name="{made.name("trunk")}" pos="0 0 0.12">{hinges}{trunk}</body>'
    below = made.wheels() if wheels else "".join(made.leg(side) for side in ("left", "right"))
    motors = "".join(
        f'<{actuator} name="{name}_a" joint="{name}" '
        + ('ctrlrange="-60 60"/>' if actuator == "motor" else 'kp="100" forcerange="-60 60"/>')
        for name in made.hinges
        if actuator
    )
    return f"""<mujoco model="somebody's">
  <compiler angle="degree" autolimits="true"/>
  <worldbody>
    <geom type="plane" size="3 3 0.1"/>
    <body name="{made.name("pelvis")}" pos="0 0 0.9">
      <freejoint name="root"/>
      <geom type="box" size="0.1 0.14 0.08" mass="10"/>
      {trunk}{below}
    </body>
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>"""


@pytest.fixture
def somebody(tmp_path: Path) -> Callable[..., Path]:
    """Writes the file of such a model."""

    def write(**options: object) -> Path:
        path = tmp_path / "somebody.xml"
        path.write_text(humanoid(**options))  # type: ignore[arg-type]
        return path

    return write


class _Maker:
    def __init__(self, named: bool, limits: bool) -> None:
        self.named, self.limits = named, limits
        self.hinges: list[str] = []
        self.count = 0

    def name(self, meaning: str) -> str:
        self.count += 1
        return meaning if self.named else f"part{self.count}"

    def hinge(self, meaning: str, axis: str, limits: str) -> str:
        name = self.name(meaning)
        self.hinges.append(name)
        span = f'range="{limits}"' if self.limits else ""
        return f'<joint name="{name}" axis="{axis}" {span} damping="0.5" armature="0.01"/>'

    def arm(self, side: str, count: int) -> str:
        """The links of an arm, one for each joint."""
        s = 1.0 if side == "left" else -1.0
        chain = CHAINS[count]
        bend = chain.index("bend")
        inner, places = "", []
        for k in range(len(chain)):
            if k == bend:
                places.append(f"0 0 {-UPPER}")
            elif k == bend + 2:
                places.append(f"0 0 {-FORE}")
            elif k == 0:
                places.append(f"0 {s * SHOULDER} 0.38")
            else:
                places.append("0 0 0")
        for k in range(len(chain) - 1, -1, -1):
            joint = chain[k]
            axis, limits = ARM[joint]
            if joint in ("roll", "yaw", "twist", "nod", "clavicle") and s < 0:
                low, high = limits.split()
                limits = f"{-float(high):g} {-float(low):g}"
            shape = '<geom type="sphere" size="0.03" mass="0.2"/>'
            if k == bend - 1:
                shape = f'<geom type="capsule" fromto="0 0 0 0 0 {-UPPER}" size="0.04" mass="1.8"/>'
            if k == min(bend + 1, len(chain) - 1):
                shape = f'<geom type="capsule" fromto="0 0 0 0 0 {-FORE}" size="0.035" mass="1"/>'
            if k == len(chain) - 1:
                top = 0.0 if k > bend + 1 else -FORE
                shape = (shape if k <= bend + 1 else "") + (
                    f'<geom type="box" size="0.04 0.012 {HAND / 2}" pos="0 0 {top - HAND / 2}"'
                    ' mass="0.4"/>'
                )
            hinge = self.hinge(f"{side}_{joint}", axis, limits)
            link = self.name(f"{side}_{joint}_link")
            inner = f'<body name="{link}" pos="{places[k]}">{hinge}{shape}{inner}</body>'
        return inner

    def leg(self, side: str) -> str:
        s = 1 if side == "left" else -1
        foot = (
            f'<body name="{self.name(side + "_foot")}" pos="0 0 -0.38">'
            + self.hinge(f"{side}_ankle", "0 1 0", "-40 40")
            + '<geom type="box" size="0.11 0.05 0.03" pos="0.06 0 -0.05" mass="1"/></body>'
        )
        shank = (
            f'<body name="{self.name(side + "_shank")}" pos="0 0 -0.4">'
            + self.hinge(f"{side}_knee", "0 1 0", "0 120")
            + f'<geom type="capsule" fromto="0 0 0 0 0 -0.35" size="0.05" mass="3"/>{foot}</body>'
        )
        hips = self.hinge(f"{side}_hip_x", "1 0 0", "-30 30") + self.hinge(
            f"{side}_hip_y", "0 1 0", "-90 30"
        )
        return (
            f'<body name="{self.name(side + "_thigh")}" pos="0 {s * 0.1} -0.05">{hips}'
            f'<geom type="capsule" fromto="0 0 0 0 0 -0.36" size="0.06" mass="6"/>{shank}</body>'
        )

    def wheels(self) -> str:
        return "".join(
            f'<body name="{self.name(f"wheel{k}")}" pos="{x} {y} -0.8">'
            + self.hinge(f"wheel{k}_axle", "0 1 0", "-9000 9000")
            + '<geom type="cylinder" size="0.1 0.02" euler="90 0 0" mass="1"/></body>'
            for k, (x, y) in enumerate(((0.2, 0.2), (0.2, -0.2), (-0.2, 0.2), (-0.2, -0.2)))
        )

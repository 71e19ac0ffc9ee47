"""What a body stands in: light, sky and floor, and from where it is looked at."""

from typing import Any

import mujoco


def set_scene(spec: Any, centre: tuple[float, float, float], extent: float) -> None:
    """Add lights, a sky and a floor that nothing collides with, and aim the cameras.

    Args:
        spec: the model, an `mujoco.MjSpec`.
        centre: what is looked at [m].
        extent: half the size of what is to be seen [m].
    """
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1080
    spec.visual.quality.shadowsize = 4096
    spec.visual.headlight.ambient = [0.45, 0.45, 0.45]
    spec.visual.headlight.diffuse = [0.35, 0.35, 0.35]
    spec.visual.headlight.specular = [0.05, 0.05, 0.05]
    spec.stat.center = list(centre)
    spec.stat.extent = extent
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.93, 0.95, 0.97],
        rgb2=[0.70, 0.77, 0.84],
        width=256,
        height=256,
    )
    spec.add_material(name="floor", rgba=[0.93, 0.93, 0.94, 1.0], emission=0.12)
    world = spec.worldbody
    for name, pos, strength, shadow in (
        ("key", [1.6, -1.2, 3.4], 0.45, True),
        ("fill", [2.0, 2.0, 2.4], 0.25, False),
        ("rim", [-2.0, 1.0, 2.6], 0.25, False),
    ):
        world.add_light(
            name=name,
            pos=pos,
            dir=[-pos[0], -pos[1], 1.0 - pos[2]],
            diffuse=[strength] * 3,
            castshadow=shadow,
        )
    world.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[6.0, 6.0, 0.1],
        material="floor",
        contype=0,
        conaffinity=0,
    )

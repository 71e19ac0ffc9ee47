"""A portrait of a body at home, from the front and the side, with its landmarks, and its shapes."""

from pathlib import Path

import numpy as np

from sim.body import Body
from sim.recording import Recording
from sim.rendering import VIEWS, render

SIDES = (("front", False), ("side", False), ("front", True))  # and whether what collides is shown
SIZE = (620, 860)  # of each view [pixels]


def render_portrait(body: Body, path: str | Path) -> None:
    """Write a PNG of a body with its landmarks and palms.

    Raises:
        NoDisplay: this machine cannot render; one line says why.
    """
    still = np.zeros((2, body.nv))
    recording = Recording(
        time=np.array([0.0, body.timestep]),
        qpos=np.tile(body.home, (2, 1)),
        qvel=still,
        torque=still,
        contribution=np.zeros((2, 0, body.nv), dtype=np.float32),
        names=(),
        spans=(),
        model_xml=body.xml,
    )
    palms = [limb.palm for limb in body.map.limbs.values()]
    job = {
        "what": "portrait",
        "views": [VIEWS[side] for side, _ in SIDES],
        "shapes": [shapes for _, shapes in SIDES],
        "size": SIZE,
        "marks": [*body.map.landmarks, *palms],
        "path": str(Path(path).absolute()),
    }
    render(recording, job)

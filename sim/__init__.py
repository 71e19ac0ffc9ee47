"""Floor 1: bodies, physics and recordings. The only floor that imports MuJoCo."""

from sim.bodies import BODIES, adonis, load_body
from sim.body import DIRECTIONS, Arm, Body, Capsules, Spot
from sim.body_map import BodyMap, Head, Limb, Servo, Spring
from sim.errors import BodyError, Diverged, NoDisplay, RecordingError, SimError, unknown
from sim.extending import extended, halfway
from sim.gaze import Gaze, carrier, find_gaze, moving_dofs
from sim.inertia import Inertias, inertias, joint_inertia, mass_matrix
from sim.motions import Motion, inverse_dynamics, site_paths, straight_motion
from sim.planar_arm import planar_arm
from sim.posing import ArmWords, pose
from sim.reaching import PalmGoal, reach
from sim.recording import Recorder, Recording, Span
from sim.rendering import VIEWS, Frame, render_filmstrip, render_video
from sim.replay import Closest, Poses, Replay
from sim.state import State
from sim.world import BareWorld, Push, World

__all__ = [
    "BODIES",
    "DIRECTIONS",
    "VIEWS",
    "Arm",
    "ArmWords",
    "BareWorld",
    "Body",
    "BodyError",
    "BodyMap",
    "Capsules",
    "Closest",
    "Diverged",
    "Frame",
    "Gaze",
    "Head",
    "Inertias",
    "Limb",
    "Motion",
    "NoDisplay",
    "PalmGoal",
    "Poses",
    "Push",
    "Recorder",
    "Recording",
    "RecordingError",
    "Replay",
    "Servo",
    "SimError",
    "Span",
    "Spot",
    "Spring",
    "State",
    "World",
    "adonis",
    "carrier",
    "extended",
    "find_gaze",
    "halfway",
    "inertias",
    "inverse_dynamics",
    "joint_inertia",
    "load_body",
    "mass_matrix",
    "moving_dofs",
    "planar_arm",
    "pose",
    "reach",
    "render_filmstrip",
    "render_video",
    "site_paths",
    "straight_motion",
    "unknown",
]

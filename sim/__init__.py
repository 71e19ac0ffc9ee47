"""Floor 1: bodies, physics and recordings. The only floor that imports MuJoCo."""

from sim.bodies import BODIES, adonis, load_body
from sim.body import DIRECTIONS, Arm, Body, Capsules, Spot
from sim.body_map import BodyMap, Head, Limb, Servo, Spring
from sim.clearance import clearances, depth_inside
from sim.errors import (
    BeyondRange,
    BodyError,
    Diverged,
    NoDisplay,
    RecordingError,
    SimError,
    unknown,
)
from sim.extending import extended, halfway
from sim.foreseeing import Foreseen, Foresight, moved
from sim.gaze import Gaze, carrier, find_gaze, moving_dofs
from sim.hand_springs import HandPath, HandSprings
from sim.inertia import Inertias, inertias, joint_inertia, mass_matrix
from sim.kinematics import axes_of, origin, places_of, turned
from sim.motions import (
    Motion,
    inverse_dynamics,
    minimum_jerk_profile,
    site_paths,
    straight_motion,
)
from sim.planar_arm import planar_arm
from sim.posing import ArmWords, pose
from sim.reaching import PalmGoal, reach
from sim.recording import Recorder, Recording, Span
from sim.rendering import VIEWS, Frame, render_filmstrip, render_video
from sim.replay import Closest, Poses, Replay
from sim.springs import JointSprings, Springs
from sim.state import State
from sim.way import Detour, Way, find_way, straight_way, way_gone
from sim.world import BareWorld, Moment, Push, World

__all__ = [
    "BODIES",
    "DIRECTIONS",
    "VIEWS",
    "Arm",
    "ArmWords",
    "BareWorld",
    "BeyondRange",
    "Body",
    "BodyError",
    "BodyMap",
    "Capsules",
    "Closest",
    "Detour",
    "Diverged",
    "Foreseen",
    "Foresight",
    "Frame",
    "Gaze",
    "HandPath",
    "HandSprings",
    "Head",
    "Inertias",
    "JointSprings",
    "Limb",
    "Moment",
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
    "Springs",
    "State",
    "Way",
    "World",
    "adonis",
    "axes_of",
    "carrier",
    "clearances",
    "depth_inside",
    "extended",
    "find_gaze",
    "find_way",
    "halfway",
    "inertias",
    "inverse_dynamics",
    "joint_inertia",
    "load_body",
    "mass_matrix",
    "minimum_jerk_profile",
    "moved",
    "moving_dofs",
    "origin",
    "places_of",
    "planar_arm",
    "pose",
    "reach",
    "render_filmstrip",
    "render_video",
    "site_paths",
    "straight_motion",
    "straight_way",
    "turned",
    "unknown",
    "way_gone",
]

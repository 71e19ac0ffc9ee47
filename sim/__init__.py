"""Floor 1: bodies, physics and recordings. The only floor that imports MuJoCo."""

from sim.arm7 import arm7
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
from sim.foreign.body_file import BodyFile
from sim.foreign.building import build_body, hanging_places
from sim.foreign.proposal import Proposal, body_name, propose
from sim.foreign.reading import Source, read_model
from sim.gaze import Gaze, carrier, find_gaze, moving_dofs
from sim.inertia import Inertias, inertias, joint_inertia, mass_matrix
from sim.lag import Haste, Lag
from sim.motions import (
    Motion,
    inverse_dynamics,
    minimum_jerk_profile,
    site_paths,
    straight_motion,
)
from sim.planar_arm import planar_arm
from sim.portrait import render_portrait
from sim.posing import ArmWords, pose
from sim.reaching import PalmGoal, reach
from sim.recording import Recorder, Recording, Span
from sim.rendering import VIEWS, Frame, render_filmstrip, render_video
from sim.replay import Closest, Poses, Replay
from sim.spring_way import (
    HandPath,
    Springs,
    axes_of,
    origin,
    palm_jacobian,
    places_of,
    spring_way,
    turned,
)
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
    "BodyFile",
    "BodyMap",
    "Capsules",
    "Closest",
    "Detour",
    "Diverged",
    "Frame",
    "Gaze",
    "HandPath",
    "Haste",
    "Head",
    "Inertias",
    "Lag",
    "Limb",
    "Moment",
    "Motion",
    "NoDisplay",
    "PalmGoal",
    "Poses",
    "Proposal",
    "Push",
    "Recorder",
    "Recording",
    "RecordingError",
    "Replay",
    "Servo",
    "SimError",
    "Source",
    "Span",
    "Spot",
    "Spring",
    "Springs",
    "State",
    "Way",
    "World",
    "adonis",
    "arm7",
    "axes_of",
    "body_name",
    "build_body",
    "carrier",
    "clearances",
    "depth_inside",
    "extended",
    "find_gaze",
    "find_way",
    "halfway",
    "hanging_places",
    "inertias",
    "inverse_dynamics",
    "joint_inertia",
    "load_body",
    "mass_matrix",
    "minimum_jerk_profile",
    "moving_dofs",
    "origin",
    "palm_jacobian",
    "places_of",
    "planar_arm",
    "pose",
    "propose",
    "reach",
    "read_model",
    "render_filmstrip",
    "render_portrait",
    "render_video",
    "site_paths",
    "spring_way",
    "straight_motion",
    "straight_way",
    "turned",
    "unknown",
    "way_gone",
]

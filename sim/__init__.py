"""Floor 1: bodies, physics and recordings. The only floor that imports MuJoCo."""

from sim.anthropometry import FEMALE, MALE, Anthropometry
from sim.arm7 import arm7
from sim.blaming import joint_to_blame
from sim.bodies import BODIES, PEOPLE, adonis, load_body
from sim.body import DIRECTIONS, Arm, Body, Capsules, Spot
from sim.body_map import BodyMap, Carry, Guard, Head, Limb, Servo, Spring
from sim.carrying import Carried, places_at, standing
from sim.clearance import clearance, clearances, depth_inside
from sim.errors import (
    BeyondRange,
    BodyError,
    Diverged,
    NoDisplay,
    RecordingError,
    SimError,
    Unposable,
    unknown,
)
from sim.extending import extended, halfway, renamed
from sim.foreign.body_file import BodyFile
from sim.foreign.building import build_body, hanging_places
from sim.foreign.proposal import Proposal, body_name, propose
from sim.foreign.reading import Source, read_model
from sim.foreseeing import Foreseen, Foresight, moved
from sim.furnishing import Thing, furnished, overlap, pushed_apart
from sim.gains import Gains, firmer, mean_hand, mean_joint, scaled_gains, spring_laws
from sim.gaze import Gaze, carrier, find_gaze, moving_dofs
from sim.hand_springs import HandPath, HandSprings
from sim.inertia import Inertias, inertias, joint_inertia, mass_matrix
from sim.kinematics import axes_of, origin, places_of, turned
from sim.laws import Law
from sim.likeness import Likeness, likeness
from sim.morphing import between, person_named
from sim.motions import Motion, inverse_dynamics, minimum_jerk_profile, site_paths, straight_motion
from sim.people import person
from sim.people_by_name import person_of
from sim.planar_arm import planar_arm
from sim.portrait import render_portrait
from sim.posing import ArmWords, off_words, pose, posed
from sim.reaching import PalmGoal, reach
from sim.recording import Recorder, Recording, Span
from sim.rendering import VIEWS, Frame, render_filmstrip, render_video
from sim.replay import Closest, Poses, Replay
from sim.scaling import scaled
from sim.springs import JointSprings, Springs
from sim.state import State
from sim.way import Detour, Way, find_way, straight_way, way_gone
from sim.world import BareWorld, Moment, Push, World

__all__ = [
    "BODIES",
    "DIRECTIONS",
    "FEMALE",
    "MALE",
    "PEOPLE",
    "VIEWS",
    "Anthropometry",
    "Arm",
    "ArmWords",
    "BareWorld",
    "BeyondRange",
    "Body",
    "BodyError",
    "BodyFile",
    "BodyMap",
    "Capsules",
    "Carried",
    "Carry",
    "Closest",
    "Detour",
    "Diverged",
    "Foreseen",
    "Foresight",
    "Frame",
    "Gains",
    "Gaze",
    "Guard",
    "HandPath",
    "HandSprings",
    "Head",
    "Inertias",
    "JointSprings",
    "Law",
    "Likeness",
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
    "Thing",
    "Unposable",
    "Way",
    "World",
    "adonis",
    "arm7",
    "axes_of",
    "between",
    "body_name",
    "build_body",
    "carrier",
    "clearance",
    "clearances",
    "depth_inside",
    "extended",
    "find_gaze",
    "find_way",
    "firmer",
    "furnished",
    "halfway",
    "hanging_places",
    "inertias",
    "inverse_dynamics",
    "joint_inertia",
    "joint_to_blame",
    "likeness",
    "load_body",
    "mass_matrix",
    "mean_hand",
    "mean_joint",
    "minimum_jerk_profile",
    "moved",
    "moving_dofs",
    "off_words",
    "origin",
    "overlap",
    "person",
    "person_named",
    "person_of",
    "places_at",
    "places_of",
    "planar_arm",
    "pose",
    "posed",
    "propose",
    "pushed_apart",
    "reach",
    "read_model",
    "renamed",
    "render_filmstrip",
    "render_portrait",
    "render_video",
    "scaled",
    "scaled_gains",
    "site_paths",
    "spring_laws",
    "standing",
    "straight_motion",
    "straight_way",
    "turned",
    "unknown",
    "way_gone",
]

"""What is guessed of robots that others made, from an installed package, against hand-made maps."""

import sys
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pytest

from adonis.body_study import Truth, compare, model_of, truths
from sim import Body, Proposal, Source, adonis, arm7, build_body, propose, read_model
from specs import body_text, read_body_file

PACKAGES = tuple(Path(folder) for folder in sys.path if folder)
CHOSEN = {"icub": 18, "human": 17, "talos": 18, "baxter": 18}  # how many landmarks must be right
KNOWN = {truth.robot: truth for truth in truths()}
# Which way a hand, or a palm, or the head goes as an anatomical angle grows, the arms hanging:
# what is looked at, its axis, and where to; s is +1 on the left.
MOVES = {
    "shoulder_y": ("hand", None, lambda s: (1, 0, 0)),
    "shoulder_x": ("hand", None, lambda s: (0, s, 0)),
    "elbow": ("hand", None, lambda s: (1, 0, 0)),
    "shoulder_z": ("palm", 0, lambda s: (-1, 0, 0)),
    "wrist_z": ("palm", 0, lambda s: (-1, 0, 0)),
    "wrist_x": ("palm", 2, lambda s: (0, -s, 0)),
    "wrist_y": ("palm", 2, lambda s: (1, 0, 0)),
}
CORE = {
    "waist_z": (0, (0, 1, 0)), "waist_x": (2, (0, -1, 0)), "waist_y": (2, (1, 0, 0)),
    "neck_z": (0, (0, 1, 0)), "neck_x": (2, (0, -1, 0)), "neck_y": (2, (1, 0, 0)),
}  # fmt: skip


def model(robot: str) -> Path:
    found = model_of(KNOWN[robot], PACKAGES)
    assert found is not None, f"{KNOWN[robot].package} is in the extra `dev`; install that"
    return found


@dataclass(frozen=True)
class Robot:
    """Somebody's robot, what was proposed for it, and the body."""

    source: Source
    proposal: Proposal
    body: Body


@pytest.fixture(scope="module")
def robots() -> dict[str, Robot]:
    found = {}
    for name in CHOSEN:
        source = read_model(model(name))
        proposal = propose(source, name, "somewhere")
        found[name] = Robot(source, proposal, build_body(source, proposal.file))
    return found


@pytest.mark.parametrize("robot", CHOSEN)
def test_the_guess_is_right(robot: str, robots: dict[str, Robot]) -> None:
    score = compare(KNOWN[robot], robots[robot].source, robots[robot].proposal)
    assert score.faces
    assert score.wrong_joints == []
    assert score.landmarks >= CHOSEN[robot], score.wrong_landmarks


def test_what_is_true_was_written_down_for_at_least_ten_robots() -> None:
    assert len(KNOWN) >= 10
    assert all(isinstance(truth, Truth) and truth.joints for truth in KNOWN.values())


@pytest.mark.parametrize("robot", [*CHOSEN, "adonis", "arm7"])
def test_angles_grow_as_anatomy_has_it(robot: str, robots: dict[str, Robot]) -> None:
    body = robots[robot].body if robot in robots else {"adonis": adonis, "arm7": arm7}[robot]()
    for limb in body.map.limbs.values():
        s = 1 if limb.side == "left" else -1
        for joint in limb.joints:
            part = joint.removeprefix(f"{limb.side}_")
            if part in MOVES:
                what, axis, way = MOVES[part]
                before, after = (_look(body, joint, turn, limb.palm, limb.hand) for turn in (0, 20))
                if what == "hand":
                    moved = after[0] - before[0]
                    moved /= np.linalg.norm(moved)
                else:
                    moved = after[1][:, axis] - before[1][:, axis]
                assert moved @ np.array(way(s)) > 0.2, joint
    head = body.map.head
    for joint, (axis, way) in CORE.items():
        if head is not None and joint in {j for g in body.map.groups.values() for j in g}:
            before, after = (_axes(body, joint, turn, head.link) for turn in (0, 20))
            assert (after[:, axis] - before[:, axis]) @ np.array(way) > 0.2, joint


@pytest.mark.parametrize("robot", CHOSEN)
def test_the_body_is_the_model(robot: str, robots: dict[str, Robot]) -> None:
    """At any angles, hands are where the model has them, and joints move the same inertia."""
    source, file, body = robots[robot].source, robots[robot].proposal.file, robots[robot].body
    old = source.model
    named = {**file.waist, **file.neck}
    for limb in file.limbs.values():
        anatomical = body.map.limbs[f"{limb.side}_arm"].joints
        named |= dict(zip(anatomical, limb.joints.values(), strict=True))
    sense = {name: -1.0 if of.flipped else 1.0 for name, of in named.items()}
    rng = np.random.default_rng(1)
    data, other = mujoco.MjData(body.model), mujoco.MjData(old)
    links = [body.link(limb.hand) for limb in body.map.limbs.values()]
    hands = [int(old.jnt_bodyid[old.joint(list(limb.joints.values())[-1].joint).id])
             for limb in file.limbs.values()]  # fmt: skip
    relative = []
    for _ in range(3):
        other.qpos[:] = source.home
        for name, of in named.items():
            turn = rng.uniform(-0.5, 0.5)
            data.qpos[body.qpos_of_dof[body.joints(name)[0]]] = turn
            other.qpos[old.jnt_qposadr[old.joint(of.joint).id]] = (
                np.deg2rad(of.zero) + sense[name] * turn
            )
        mujoco.mj_forward(body.model, data)
        mujoco.mj_forward(old, other)
        relative.append(
            [
                (data.xmat[a].reshape(3, 3).T @ _frame(file, other.xmat[b].reshape(3, 3)))
                for a, b in zip(links, hands, strict=True)
            ]
        )
        # Hands are turned as the model's, but for one turn that never changes.
        for now, first in zip(relative[-1], relative[0], strict=True):
            assert now == pytest.approx(first, abs=2e-3)
        mass, whole = np.empty((body.nv,) * 2), np.empty((old.nv,) * 2)
        mujoco.mj_fullM(body.model, data, mass)
        mujoco.mj_fullM(old, other, whole)
        dofs = [int(body.joints(name)[0]) for name in named]
        theirs = [int(old.jnt_dofadr[old.joint(of.joint).id]) for of in named.values()]
        signs = np.array(list(sense.values()))
        wanted = whole[np.ix_(theirs, theirs)] * np.outer(signs, signs)
        wanted -= np.diag(old.dof_armature[theirs])
        found = mass[np.ix_(dofs, dofs)] - np.diag(body.model.dof_armature[dofs])
        assert found == pytest.approx(wanted, abs=0.02 * np.abs(wanted).max())


def test_names_do_not_decide(tmp_path: Path, robots: dict[str, Robot]) -> None:
    """With every joint and link called something else, the same map is found."""
    source = model("human")
    text, names = source.read_text(), {}
    for k, word in enumerate(sorted(set(_names(text)), key=len, reverse=True)):
        names[word] = f"x{k}"
    for word, other in names.items():
        for key in ("name", "link", "joint"):
            text = text.replace(f'{key}="{word}"', f'{key}="{other}"')
    folder = source.parents[3]  # meshes are looked for in the folders above
    text = text.replace("package://example-robot-data", f"file://{folder}")
    copy = tmp_path / "nameless.urdf"
    copy.write_text(text)
    named, nameless = robots["human"].proposal.file, propose(read_model(copy), "h", "h").file
    assert nameless.base == named.base
    for limb in ("left_arm", "right_arm"):
        for one, other in zip(
            named.limbs[limb].joints.values(), nameless.limbs[limb].joints.values(), strict=True
        ):
            assert other.joint == names[one.joint]
            assert (other.flipped, other.zero) == (one.flipped, one.zero)


def test_the_file_says_what_was_proposed(tmp_path: Path, robots: dict[str, Robot]) -> None:
    proposal = robots["human"].proposal
    text = body_text(proposal, "human.body.png")
    written = tmp_path / "human.body.yaml"
    written.write_text(text)
    again, _ = read_body_file(written)
    assert again == proposal.file
    assert text.count("# guessed") >= 20


def _look(
    body: Body, joint: str, turn: float, palm: str, hand: str
) -> tuple[np.ndarray, np.ndarray]:
    """Where the wrist is and how the palm is turned, the arms hanging but for one joint."""
    data = mujoco.MjData(body.model)
    data.qpos[body.qpos_of_dof[body.joints(joint)[0]]] = np.deg2rad(turn)
    mujoco.mj_kinematics(body.model, data)
    site = body.model.site(palm).id
    return data.xpos[body.link(hand)].copy(), data.site_xmat[site].reshape(3, 3).copy()


def _axes(body: Body, joint: str, turn: float, link: str) -> np.ndarray:
    data = mujoco.MjData(body.model)
    data.qpos[body.qpos_of_dof[body.joints(joint)[0]]] = np.deg2rad(turn)
    mujoco.mj_kinematics(body.model, data)
    return data.xmat[body.link(link)].reshape(3, 3).copy()


def _frame(file: object, axes: np.ndarray) -> np.ndarray:
    """Axes of the model's world in those of the body."""
    rows = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0), "+z": (0, 0, 1)}
    forward, up = (
        np.array(rows[getattr(file.base, key)], dtype=float) for key in ("forward", "up")
    )
    return np.array([forward, np.cross(up, forward), up]) @ axes


def _names(text: str) -> list[str]:
    import xml.etree.ElementTree as ET

    root = ET.fromstring(text)
    return [e.get("name", "") for e in (*root.findall("link"), *root.findall("joint"))]

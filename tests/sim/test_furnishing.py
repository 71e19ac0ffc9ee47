"""Objects of the scene: where they are, what follows from their shape, and that they are solid."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from sim import (
    Body,
    BodyError,
    Carry,
    Recorder,
    Recording,
    Replay,
    Thing,
    World,
    furnished,
    overlap,
    places_at,
    places_of,
    pushed_apart,
    standing,
)

TABLE = Thing("table", "box", (0.4, 0.8, 0.04), (0.5, 0.1, 0.9))
BALL = Thing("ball", "sphere", (0.12,) * 3, (0.5, -0.3, 1.3))
CARRIED = replace(
    BALL,
    carried=(
        Carry(start=0.05, lasts=0.1, to=(0.5, -0.1, 1.35)),
        Carry(start=0.2, lasts=0.05, to=(0.45, -0.1, 1.35)),
    ),
)


def places(body: Body, thing: Thing) -> dict[str, np.ndarray]:
    made = furnished(body, thing)
    names = [name for name in made.map.landmarks if name.startswith(f"{thing.name}.")]
    where = places_of(made, made.home, [made.landmark(name) for name in names])
    return {name.partition(".")[2]: place for name, place in zip(names, where, strict=True)}


@pytest.mark.parametrize("shape", ["box", "sphere", "cylinder"])
def test_landmarks_lie_on_the_surface_and_face_outwards(body: Body, shape: str) -> None:
    lengths = (0.3, 0.3, 0.3) if shape == "sphere" else (0.3, 0.3, 0.1)
    thing = Thing("thing", shape, lengths, (0.6, 0.2, 1.0), turn=0.4)  # type: ignore[arg-type]
    made = furnished(body, thing)
    data = mujoco.MjData(made.model)
    mujoco.mj_kinematics(made.model, data)
    for name in ("top", "bottom", "front", "back", "left", "right"):
        spot = made.landmark(f"thing.{name}")
        axes = data.xmat[spot.link].reshape(3, 3)
        place, normal = data.xpos[spot.link] + axes @ spot.point, axes @ spot.normal
        hit = np.zeros(1, dtype=np.int32)
        far = mujoco.mj_ray(made.model, data, place + 0.1 * normal, -normal, None, 1, -1, hit, None)
        assert far == pytest.approx(0.1, abs=1e-6), name
        assert made.model.geom(int(hit[0])).name == "thing"


def test_landmarks_follow_size_and_place(body: Body) -> None:
    small, large = places(body, TABLE), places(body, replace(TABLE, lengths=(0.6, 1.0, 0.1)))
    moved = places(body, replace(TABLE, place=(0.6, 0.1, 1.0)))
    assert small["edge"] == pytest.approx([0.3, 0.1, 0.92])
    assert large["edge"] == pytest.approx([0.2, 0.1, 0.95])
    assert small["left"][1] > small["right"][1], "as the body sees them"
    assert small["front"][0] < small["back"][0], "the near side is in front"
    for name, place in small.items():
        assert moved[name] == pytest.approx(place + np.array([0.1, 0.0, 0.1]))


def test_a_turned_object_takes_its_sides_along(body: Body) -> None:
    turned = places(body, replace(TABLE, turn=np.pi / 2))
    assert turned["front"] == pytest.approx([0.5, 0.1 - 0.2, 0.9])
    assert turned["left"] == pytest.approx([0.5 - 0.4, 0.1, 0.9])


def test_far_away_it_changes_nothing(body: Body) -> None:
    other = furnished(body, replace(TABLE, place=(5.0, 0.0, 0.9)))
    one, two = World(body), World(other)
    torque = 5.0 * np.sin(np.arange(body.nv))[None]
    for _ in range(100):
        one.step(torque)
        two.step(torque)
    np.testing.assert_array_equal(one.state.qpos, two.state.qpos)


def test_an_arm_that_falls_onto_it_stays_above(body: Body) -> None:
    lifted = body.home.copy()
    lifted[body.qpos_of_dof[body.joints("right_elbow")]] = np.deg2rad(100.0)
    (palm,) = places_of(body, lifted, [body.arm("right_arm").palm])
    low = furnished(body, Thing("table", "box", (0.2, 0.4, 0.04), (*palm[:2], palm[2] - 0.1)))
    heights = []
    for there in (body, low):
        world = World(there)
        world.reset(lifted)
        for _ in range(600):
            world.step(np.zeros((1, body.nv)))
        arm = there.arm("right_arm")
        (now,) = places_of(there, world.state.qpos[0], [arm.palm])
        heights.append(now[2])
    assert heights[0] < palm[2] - 0.2, "without a table it falls"
    assert heights[1] > palm[2] - 0.1


def test_how_deep_an_object_stands_in_the_body_is_known(body: Body) -> None:
    assert overlap(furnished(body, TABLE), "table", body.home) == ("", 0.0)
    inside = furnished(body, replace(TABLE, place=(0.2, 0.0, 0.95)))
    link, depth = overlap(inside, "table", body.home)
    assert link == "pelvis"
    assert 0.0 < depth < 0.3
    out = furnished(body, replace(TABLE, place=(0.2 + depth + 1e-4, 0.0, 0.95)))
    assert overlap(out, "table", body.home)[1] < depth


def test_round_objects_are_kept_apart_by_distance_others_by_contact(body: Body) -> None:
    made = furnished(furnished(body, TABLE), BALL)
    new = set(made.map.keep_apart) - set(body.map.keep_apart)
    assert {pair[1] for pair in new} == {"table", "ball"}
    assert set(pushed_apart(made)) - set(pushed_apart(body)) == {p for p in new if p[1] == "ball"}


def test_it_goes_smoothly_and_its_velocity_is_known(body: Body) -> None:
    made = furnished(body, CARRIED)
    link, world = made.link("ball"), World(made, 3)
    torque, dt = np.zeros((3, body.nv)), body.timestep
    before = world.state.xpos[:, link].copy()
    seen, fastest = [before], 0.0
    for k in range(1, 150):
        world.step(torque)
        now, speed = world.state.xpos[:, link].copy(), world.state.cvel[:, link, 3:]
        np.testing.assert_allclose(speed, (now - before) / dt, atol=1e-9)
        np.testing.assert_allclose(now[0], places_at(made, np.array([k * dt]))[0, 0], atol=1e-12)
        fastest, before = max(fastest, float(np.linalg.norm(speed[0]))), now
        seen.append(now)
    way = np.array(seen)
    np.testing.assert_array_equal(way[:, 0], way[:, 2])
    np.testing.assert_array_equal(way[: int(0.05 / dt), 0], way[:1, 0].repeat(int(0.05 / dt), 0))
    assert way[-1, 0] == pytest.approx([0.45, -0.1, 1.35])
    straight = np.linalg.norm([0.2, 0.05]) / 0.1
    assert fastest == pytest.approx(1.875 * straight, rel=0.01), "minimum jerk"


def test_where_it_will_stand_can_be_foreseen(body: Body) -> None:
    made = furnished(body, CARRIED)
    assert standing(made, 0.02) is made
    later = standing(made, 1.0)
    spot = later.landmark("ball.top")
    assert later.at_home(spot.link, spot.point) == pytest.approx([0.45, -0.1, 1.41])
    assert made.at_home(spot.link, spot.point) == pytest.approx([0.5, -0.3, 1.36])


def test_a_program_can_carry_what_its_task_does_not(body: Body) -> None:
    made = furnished(furnished(body, BALL), replace(CARRIED, name="other"))
    world = World(made, 2)
    still = np.zeros((2, body.nv))
    world.carry("ball", (1.0, 0.0, 1.0), (0.5, 0.0, 0.0))
    world.step(still)
    moment = world.moment()
    link = made.link("ball")
    np.testing.assert_allclose(world.state.xpos[:, link], [[1.0, 0.0, 1.0]] * 2)
    np.testing.assert_allclose(world.state.cvel[:, link, 3:], [[0.5, 0.0, 0.0]] * 2)
    world.carry("ball", np.array([[2.0, 0.0, 1.0], [3.0, 0.0, 1.0]]))
    world.step(still)
    np.testing.assert_allclose(world.state.xpos[:, link, 0], [2.0, 3.0])
    world.go_back(moment)
    np.testing.assert_allclose(world.state.xpos[:, link, 0], [1.0, 1.0])
    np.testing.assert_allclose(world.state.cvel[:, link, 3], [0.5, 0.5])
    world.step(still)
    np.testing.assert_allclose(world.state.xpos[:, link, 0], [1.0, 1.0])
    assert not world.state.cvel[:, link].any(), "nobody carries it now"
    world.reset()
    np.testing.assert_allclose(world.state.xpos[:, link], [BALL.place] * 2)
    assert not world.state.cvel[:, link].any()
    with pytest.raises(BodyError, match="'other' is carried by its task"):
        world.carry("other", (1.0, 0.0, 1.0))
    with pytest.raises(BodyError, match=r"unknown object of the scene 'bal'; did you mean 'ball'"):
        world.carry("bal", (1.0, 0.0, 1.0))
    with pytest.raises(BodyError, match=r"unknown object of the scene 'ball' \(there are: none\)"):
        World(body).carry("ball", (1.0, 0.0, 1.0))


def test_a_recording_knows_where_it_was(body: Body, tmp_path: Path) -> None:
    made, part = furnished(body, CARRIED), tmp_path / "recording.npz.part"
    world = World(made)
    recorder = Recorder(made, 1, part=part)
    for _ in range(120):
        recorder.take(world.state, None, np.zeros((1, 0), dtype=np.int32))
        world.step(np.zeros((1, body.nv)))
        recorder.applied(world.torque)
    (recording,) = recorder.finish([()])
    recording.save(tmp_path / "recording.npz")
    for path in (tmp_path / "recording.npz", part):
        read = Recording.load(path)
        np.testing.assert_array_equal(read.objects, recording.objects)
        seen = Replay(read).site("ball.top").position
        np.testing.assert_allclose(
            seen, places_at(made, read.time)[:, 0] + [0.0, 0.0, 0.06], atol=1e-9
        )
    assert recording.until(0.1).objects.shape == (51, 1, 3)


@pytest.mark.parametrize(
    ("name", "what"),
    [("head", "link"), ("left_arm", "limb"), ("neck", "joint group"), ("neck_x", "joint"),
     ("chest", "landmark")],
)  # fmt: skip
def test_a_name_means_one_thing(body: Body, name: str, what: str) -> None:
    with pytest.raises(BodyError, match=f"is a {what} of adonis: take another name"):
        furnished(body, replace(TABLE, name=name))

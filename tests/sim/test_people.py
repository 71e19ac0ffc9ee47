"""People by height, weight, sex and age, and bodies named by them."""

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim import BODIES, FEMALE, MALE, BodyError, between, load_body, person, person_named, person_of
from sim.anthropometry import SEGMENTS
from sim.people import FRACTIONS


def test_the_mean_adults_are_those_of_the_table() -> None:
    assert person() == MALE
    assert person(sex="female", age=40) == FEMALE


@given(
    st.floats(1.0, 2.1),
    st.floats(15.0, 150.0),
    st.sampled_from(["male", "female"]),
    st.floats(6.0, 80.0),
)
def test_anybody_is_as_tall_and_heavy_as_asked(h: float, w: float, sex: str, age: float) -> None:
    who = person(height=h, weight=w, sex=sex, age=age)
    assert who.stature == pytest.approx(h)
    assert who.mass == pytest.approx(w)
    arms = 2.0 * (who.upper_arm.mass + who.forearm.mass + who.hand.mass)
    assert 0.55 * w < who.head.mass + who.whole_trunk.mass + arms < 0.8 * w, "legs are the rest"
    assert who.stature > who.head.length + who.whole_trunk.length
    assert who.trunk_half_axes[0] > who.trunk_half_axes[1] > 0.0
    assert 0 < who.waist_mass < who.whole_trunk.mass


def test_a_child_of_six_has_jensens_shares_of_its_mass() -> None:
    child = person(age=6)
    for name, share in FRACTIONS.items():
        assert getattr(child, name).mass == pytest.approx(share * child.mass)
    assert child.head.length / child.stature > 1.3 * MALE.head.length / MALE.stature
    assert child.upper_arm.length / child.stature == pytest.approx(
        MALE.upper_arm.length / MALE.stature
    )


def test_growing_up_is_a_straight_line() -> None:
    child, half, grown = (person(age=age) for age in (6, 12, 18))
    for name in SEGMENTS:
        one, middle, other = (getattr(p, name) for p in (child, half, grown))
        assert middle.mass == pytest.approx(0.5 * (one.mass + other.mass))
        assert middle.inertia[0] == pytest.approx(0.5 * (one.inertia[0] + other.inertia[0]))


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("adonis:height=2,wings=3", "unknown key 'wings'"),
        ("adonis:tall", "'tall' is no KEY=VALUE; expected adonis:KEY=VALUE"),
        ("adonis:height=high", "height is a number, not 'high'"),
        ("adonis:height=17", "height is 0.5 to 3 m, not 17"),
        ("adonis:weight=nan", "weight is 5 to 400 kg, not nan"),
        ("adonis:age=3", "age is 6 years or more (the tables begin there), not 3"),
        ("adonis:sex=other", "sex is male or female, not 'other'"),
        ("adonis:height=1.5,height=1.6", "height is given twice"),
        ("adonis:length=2,weight=80", "length goes alone"),
        ("adonis:length=50", "length is 0.1 to 10, not 50"),
    ],
)
def test_a_description_that_means_nobody_is_refused(name: str, said: str) -> None:
    with pytest.raises(BodyError) as caught:
        load_body(name)
    assert said in str(caught.value)


def test_a_description_is_a_body() -> None:
    girl = load_body("adonis:height=1.3, weight=28, sex=female, age=9")
    assert girl.map.name == "adonis:height=1.3, weight=28, sex=female, age=9"
    assert girl.map.time_scale < 1.0
    assert person_of("adonis") is None
    tall = load_body("adonis:length=2")
    giant = load_body("adonis-giant")
    np.testing.assert_allclose(tall.model.body_mass, giant.model.body_mass)


@pytest.mark.parametrize("name", BODIES)
def test_everybody_stands_free_with_landmarks_on_the_surface(name: str) -> None:
    body = load_body(name)
    assert body.is_free(body.home)
    model, data = body.model, mujoco.MjData(body.model)
    data.qpos[:] = body.home
    mujoco.mj_forward(model, data)
    for landmark in body.map.landmarks:
        site = data.site(landmark)
        normal = site.xmat.reshape(3, 3)[:, 0]
        hit = np.array([-1], dtype=np.int32)
        out = 0.05 * body.map.time_scale**2
        distance = mujoco.mj_ray(
            model, data, site.xpos + out * normal, -normal, None, True, -1, hit, None
        )
        assert model.geom_bodyid[hit[0]] == model.site_bodyid[site.id], f"{landmark} is buried"
        assert distance == pytest.approx(out, abs=2e-3), f"{landmark} is not on the surface"


@pytest.mark.parametrize("name", BODIES)
def test_limits_and_contacts_off_change_no_gain(name: str) -> None:
    free = load_body(name, limits=False, contacts=False)
    assert free.map == load_body(name).map


def test_the_weight_is_part_of_the_hand() -> None:
    man, strong = load_body("adonis"), load_body("adonis-weight")
    hand = man.link("right_hand")
    assert strong.model.body_mass[hand] == pytest.approx(man.model.body_mass[hand] + 2.0)
    np.testing.assert_array_equal(strong.torque_limit, man.torque_limit)
    elbow = "right_elbow"
    assert strong.map.servos[elbow].stiffness > 2.0 * man.map.servos[elbow].stiffness
    assert strong.map.servos["left_elbow"].stiffness == pytest.approx(
        man.map.servos["left_elbow"].stiffness, rel=1e-4
    )


def test_on_the_way_from_one_person_to_another_everything_goes_in_a_straight_line() -> None:
    bodies = between(MALE, FEMALE, 3, names=("adonis", "adonis-female"))
    assert [b.map.name for b in bodies] == ["adonis", "adonis-to-adonis-female", "adonis-female"]
    masses = np.array([b.model.body_mass for b in bodies])
    np.testing.assert_allclose(masses[1], 0.5 * (masses[0] + masses[2]), rtol=1e-4)
    assert len({b.timestep for b in bodies}) == 1
    gains = [b.map.servos["left_elbow"].stiffness for b in bodies]
    assert gains[0] > gains[1] > gains[2]
    with pytest.raises(BodyError, match="unknown person"):
        person_named("adonis-weight")

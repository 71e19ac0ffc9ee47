"""People by height, weight, sex and age.

Adults have the proportions of de Leva's mean subjects (1996). A six-year-old has the mass
fractions of Jensen (1986), "Body segment mass, radius and radius of gyration proportions of
children", and the arms of an adult in proportion to the stature (Drillis & Contini's shares of
stature, .186, .146 and .108 for upper arm, forearm and hand, differ from de Leva's by 4 % in all).
The head is as long as its mass has it at the density of an adult's, the trunk has an adult's share
of the stature, and the legs are what is left. Moments follow from masses and lengths by an adult's
radii of gyration. From six years to eighteen all of it is interpolated in a straight line.
"""

from typing import Literal

from sim.anthropometry import FEMALE, MALE, SEGMENTS, Anthropometry
from sim.errors import BodyError
from sim.laws import Law

Sex = Literal["male", "female"]

CHILD, ADULT = 6.0, 18.0  # [years] the table of children begins, and that of adults
CHILD_STATURE = {"male": 1.16, "female": 1.151}  # [m] medians at six of the WHO's reference (2007)
CHILD_MASS = {"male": 20.5, "female": 20.2}  # [kg] the same
# Jensen, at six years: shares of the body's mass, of one arm.
FRACTIONS = {
    "head": 0.182,
    "whole_trunk": 0.43,
    "upper_arm": 0.024,
    "forearm": 0.013,
    "hand": 0.008,
}
ADULTS: dict[str, Anthropometry] = {"male": MALE, "female": FEMALE}
SIZES = {"height": (0.5, 3.0), "weight": (5.0, 400.0)}  # [m], [kg] that are understood


def person(
    *,
    height: float | None = None,
    weight: float | None = None,
    sex: str = "male",
    age: float = ADULT,
) -> Anthropometry:
    """The segments of a person.

    Args:
        height: stature [m]; default: the mean of the age, in between a straight line.
        weight: mass [kg]; the same.
        sex: `male` or `female`.
        age: [years], 6 or more.

    Raises:
        BodyError: a value that no table covers.
    """
    if sex not in ADULTS:
        raise BodyError(f"sex is male or female, not {sex!r}")
    if not CHILD <= age <= 120.0:
        raise BodyError(f"age is 6 years or more (the tables begin there), not {age:g}")
    for name, given in (("height", height), ("weight", weight)):
        low, high = SIZES[name]
        if given is not None and not low <= given <= high:
            unit = "m" if name == "height" else "kg"
            raise BodyError(f"{name} is {low:g} to {high:g} {unit}, not {given:g}")
    grown, share = ADULTS[sex], min((age - CHILD) / (ADULT - CHILD), 1.0)
    usual = _child(sex).towards(grown, share)
    length = 1.0 if height is None else height / usual.stature
    mass = 1.0 if weight is None else weight / usual.mass
    return usual.scaled(Law(length, mass, mass * length**2))


def _child(sex: str) -> Anthropometry:
    """A child of six years."""
    grown, stature, mass = ADULTS[sex], CHILD_STATURE[sex], CHILD_MASS[sex]
    length = stature / grown.stature
    laws = {}
    for name in SEGMENTS:
        lighter = FRACTIONS[name] * mass / getattr(grown, name).mass
        shorter = lighter ** (1.0 / 3.0) if name == "head" else length
        laws[name] = Law(shorter, lighter, lighter * shorter**2)
    return Anthropometry(
        stature=stature,
        mass=mass,
        **{name: getattr(grown, name).scaled(law) for name, law in laws.items()},
        waist_length=grown.waist_length * length,
        waist_mass=grown.waist_mass * laws["whole_trunk"].mass,
    )

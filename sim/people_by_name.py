"""People who are named by what they are: `adonis:height=1.3,weight=30,age=9`."""

from sim.anthropometry import MALE, Anthropometry
from sim.errors import BodyError, unknown
from sim.laws import Law
from sim.people import person

PREFIX = "adonis:"
KEYS = ("height", "weight", "sex", "age", "length")
LENGTHS = (0.1, 10.0)  # of scale models that are understood
EXPECTED = (
    "expected adonis:KEY=VALUE,… with height [m], weight [kg], age [years], sex (male or female),"
    " or length alone, for a scale model of the man"
)


def person_of(name: str) -> Anthropometry | None:
    """The person that a name describes; None if it is a name of another kind.

    Raises:
        BodyError: it begins like a description and is none.
    """
    if not name.startswith(PREFIX):
        return None
    given: dict[str, str] = {}
    for part in name.removeprefix(PREFIX).split(","):
        key, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or not value:
            raise BodyError(f"body {name!r}: {part.strip()!r} is no KEY=VALUE; {EXPECTED}")
        if key not in KEYS:
            raise BodyError(f"body {name!r}: {unknown('key', key, KEYS)}")
        if key in given:
            raise BodyError(f"body {name!r}: {key} is given twice")
        given[key] = value
    sex = given.pop("sex", "male")
    numbers = {key: _number(name, key, value) for key, value in given.items()}
    if "length" not in numbers:
        return person(sex=sex, **numbers)
    low, high = LENGTHS
    if len(numbers) > 1 or "sex=" in name:
        raise BodyError(f"body {name!r}: length goes alone; {EXPECTED}")
    if not low <= numbers["length"] <= high:
        raise BodyError(f"body {name!r}: length is {low:g} to {high:g}, not {numbers['length']:g}")
    return MALE.scaled(Law.geometric(numbers["length"]))


def _number(name: str, key: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        raise BodyError(f"body {name!r}: {key} is a number, not {value!r}") from None

"""The conformance kit says whether a primitive keeps its promises."""

import pytest
from adonis_rubber_band import RubberBand

from primitives import PrimitiveError
from primitives.testing import check_primitive
from sim import adonis


def test_it_conforms() -> None:
    check_primitive(RubberBand(joints=("left_arm", "neck")))


def test_a_band_that_pushes_is_refused() -> None:
    with pytest.raises(PrimitiveError, match="positive"):
        RubberBand(joints=("neck",), stiffness=-1.0).bind(adonis(), 1.0)

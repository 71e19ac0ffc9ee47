"""Distances of links and depths of points are measured alike."""

import pytest

from sim import Body, clearance, clearances, depth_inside


def test_depth_and_clearance_of_the_same_place_agree(body: Body) -> None:
    mark = body.landmark("chest.front")
    for inside in (0.01, 0.03):
        point = body.at_home(mark.link, mark.point - inside * mark.normal)
        depth, link = depth_inside(body, body.home, point, ["head", "trunk"])
        assert link == "trunk"
        assert depth == pytest.approx(inside, abs=1e-3)
    outside = body.at_home(mark.link, mark.point + 0.01 * mark.normal)
    assert depth_inside(body, body.home, outside, ["head", "trunk"]) == (0.0, "")
    pairs = body.map.keep_apart
    least = clearances(body, body.home[None], pairs).min()
    assert least == pytest.approx(clearance(body, body.home), abs=1e-9)

"""A rest by friction right beside a balance that needs none ends in that balance."""

from __future__ import annotations

import math

import pytest

from cagepose import Run, run
from cagepose.files.scene_file import parse_scene

PEG = """
name: peg
units: {length: mm}
object:
  mass: 0.1
  shapes: [{name: peg, cylinder: {radius: 5, length: 40}, position: [0, 0, 20]}]
  pose: {position: [0, 0, -20]}
cage:
  shapes:
    - {name: plate, box: {size: [60, 60, 40]}, position: [0, 0, -20]}
    - {name: hole, hole: {radius: 5.05, depth: 20, in: [plate]}}
loads:
  - {name: push, gravity: [0, 0, -9.81], force: {direction: [%r, %r, 0], at: [0, 0, 40], magnitude: 5}}
friction: {coefficient: %r}
"""


def pushed_peg(direction_deg: float, friction: float) -> Run:
    """A peg in a blind hole, 0.05 mm wider all around, is pushed across the hole at its top."""
    along = math.radians(direction_deg)
    return run(parse_scene(PEG % (math.cos(along), math.sin(along), friction)))


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.3])
def test_a_peg_rests_in_whichever_direction_it_is_pushed(friction):
    """The pose where it leans on both edges of the hole needs no friction; 32 of 36 ended 1e-8 rad short of it."""
    smooth = pushed_peg(0.0, 0.0)
    for direction_deg in range(0, 360, 10):
        ended = pushed_peg(direction_deg, friction)
        assert (ended.verdict, ended.phases[0].proof.stability) == ("rests", "stable"), direction_deg
        assert ended.pose.rotation[2, 2] == pytest.approx(smooth.pose.rotation[2, 2], abs=1e-15)


def test_a_rest_that_needs_its_friction_stays_where_it_is():
    """On a slope of 5.7 degrees a block is held by any friction above 0.1, and slides without."""
    block = """
    name: block
    units: {length: mm}
    object: {mass: 1, boxes: [{size: [40, 40, 10], position: [0, 0, 5]}]}
    cage: {shapes: [{name: table, box: {size: [200, 200, 10]}, position: [0, 0, -5]}]}
    loads: [{name: weight, gravity: [0.0999, 0, -1]}]
    friction: {coefficient: 0.1}
    """
    ended = run(parse_scene(block))
    assert ended.verdict == "rests"
    assert ended.pose.position_m == pytest.approx([0, 0, 0], abs=1e-15)

"""Several bodies of a cage in one memory: what touches which, wherever each of them is."""

from itertools import pairwise

import numpy as np
import pytest

from cagepose import Box, Cylinder, Pose, Sphere
from cagepose.kernels.boundary.features import body_of, empty_placing, place_boundary
from cagepose.kernels.boundary.geometry import (
    Geometry,
    deepest_overlap,
    empty_placement,
    held_at,
    meetings_with,
    place_object,
)
from cagepose.kernels.boundary.overlap import empty_overlap_work
from cagepose.model.boundary.bodies import joined
from cagepose.model.boundary.features import boundary_of

TOUCH_M = 1e-9


def turned(position, euler_deg):
    return Pose(position, euler_zyx=np.radians(euler_deg))


PART = [Box((2.0, 2.0, 2.0))]
FLOOR = [Box((8.0, 8.0, 1.0), Pose((0.0, 0.0, -1.5))), np.array([0.5, 0.2, 1.0])]
ROLLERS = [
    Cylinder(0.5, 4.0, turned((-1.5, 0.0, 0.0), (0.0, 0.0, 90.0))),
    Sphere(0.25, Pose((-1.25, 0.0, 0.5))),
]
PEGS = [np.array([1.0, 0.3, 0.1]), np.array([1.0, -0.3, 0.1])]


def together(bodies, poses):
    """Return what touches the part at the origin, and the memory: bodies of a cage, each at its pose."""
    ends = np.cumsum([0, *map(len, bodies)])
    numbers = [np.arange(first, last) for first, last in pairwise(ends)]
    cage = joined([boundary_of(parts, TOUCH_M) for parts in bodies], numbers)
    memory = empty_placing(cage.own, len(bodies))
    for which, pose in enumerate(poses):
        place_boundary(body_of(cage, memory, which), *pose.as_tuples())
    geometry = Geometry(boundary_of(PART, TOUCH_M), cage, memory, TOUCH_M)
    return geometry, empty_placement(geometry)


def touched(geometry, placement, pose=None):
    """Return, of each body, the names of parts and the places, as the part has them, where it touches."""
    pose = pose or Pose()
    place_object(geometry, *pose.as_tuples(), placement)
    found = []
    for body in range(len(geometry.cage.first_nodes) - 1):
        meetings = meetings_with(placement, body)
        rows = meetings.rows[: meetings.used[0]]
        parts = geometry.cage.own.features["part"][rows["cage_feature"]]
        assert (geometry.cage.own.parts["body"][parts] == body).all()
        places = (np.array(rows["place"]) - pose.position_m) @ pose.rotation
        first = int((np.asarray(geometry.cage.own.parts)["body"] < body).sum())
        found.append(
            sorted((int(part) - first, *np.round(place, 9)) for part, place in zip(parts, places, strict=True))
        )
    return found


@pytest.fixture
def away():
    return [
        turned((0.3, -0.2, 0.7), (20.0, -35.0, 50.0)),
        turned((-4.0, 1.0, 2.0), (100.0, 5.0, 0.0)),
        Pose((0.0, 9.0, 0.0)),
    ]


def test_each_body_touches_as_it_does_alone(away):
    bodies = [FLOOR, ROLLERS, PEGS]
    found = touched(*together(bodies, [Pose()] * 3))
    assert [len(of_body) > 0 for of_body in found] == [True, True, True]
    for body, of_body in zip(bodies, found, strict=True):
        assert touched(*together([body], [Pose()])) == [of_body]
    # in another order, and with one of them elsewhere
    assert touched(*together(bodies[::-1], [Pose()] * 3)) == found[::-1]
    assert touched(*together(bodies, [Pose(), away[2], Pose()])) == [found[0], [], found[2]]


def test_bodies_that_are_moved_with_the_part_touch_it_as_before(away):
    bodies = [FLOOR, ROLLERS, PEGS]
    found = touched(*together(bodies, [Pose()] * 3))
    for pose in away:
        assert touched(*together(bodies, [pose] * 3), pose) == found


def test_what_is_in_a_body_is_told_by_the_features_of_all():
    """A pin is 0.3 deep in the top of the block; the body before it touches the block."""
    pin = [Cylinder(0.2, 1.0, Pose((0.0, 0.0, 1.2)))]
    geometry, placement = together([FLOOR, pin, PEGS], [Pose()] * 3)
    place_object(geometry, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), placement)
    found = deepest_overlap(geometry, placement, empty_overlap_work(geometry.held, geometry.cage.own, 3))
    own = geometry.cage.own
    assert found.depth_m == pytest.approx(0.3, abs=1e-9)
    assert own.parts["body"][own.features["part"][found.cage_feature]] == 1
    assert held_at(geometry, placement).own.features["part"][found.feature] == 0

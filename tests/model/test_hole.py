"""Holes: what they refuse, where they may be, and what they take away."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Cage, Chamfer, Convex, Cylinder, Hole, Load, Object, Pose, Scene, SceneError, Sphere
from cagepose.model.shape_moments import mesh_sums, shape_moments, sums_of
from cagepose.model.surface import shape_mesh
from cagepose.model.union import body_moments

PI = math.pi
TURNED = Pose((3.0, -1.0, 2.0), (0.4, 0.3, -0.6, 0.2))
CORNERS = [(x, y, z) for x in (-2, 2) for y in (-2, 2) for z in (-1, 1)]


def at(*position, euler=(0.0, 0.0, 0.0)):
    return TURNED @ Pose(position, euler_zyx=euler)


def hole(radius, depth, pose, *names, chamfer=None):
    return Hole(radius, depth, chamfer, names, pose)


def found(make):
    with pytest.raises(SceneError) as caught:
        make()
    return [str(problem) for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("make", "start"),
    [
        (lambda: Hole(0.0, 1.0), "radius: is 0.0"),
        (lambda: Hole(1.0, math.nan), "depth: is nan"),
        (lambda: Hole(1.0, 1.0, 0.1), "chamfer: is 0.1; give a cagepose.Chamfer"),
        (lambda: Hole(1.0, 1.0, Chamfer(-0.1, 0.7)), "chamfer.width: is -0.1; give a finite number of metres"),
        (lambda: Hole(1.0, 1.0, Chamfer(0.1, 0.0)), "chamfer.angle_deg: is 0 deg; give an angle above 0 and below 90"),
        (lambda: Hole(1.0, 1.0, Chamfer(1.0, 0.7)), "chamfer: reaches the bottom"),
        (lambda: Object([Box((4, 4, 4))], holes=[Hole(1.0, 1.0, None, "box2")]), "holes[0].in[0]: is 'box2', no box"),
        (lambda: Cage(shapes=[Hole(1.0, 1.0, None, ["a"], name="a")]), "shapes[0].hole.in[0]: is 'a', no box or shape"),
        (lambda: Cage(shapes=[Hole(1.0, 1.0, name="a"), Sphere(1, name="a")]), "shapes[0].name: 'a' is already the"),
    ],
)
def test_what_is_wrong_is_told(make, start):
    assert found(make)[0].startswith(start)


PLATES = [
    (Box((4, 4, 2), at(0, 0, 0), "plate"), 1.0),
    (Convex(CORNERS, 0.0, at(0, 0, 0), "plate"), 1.0),
    (Convex(CORNERS, 0.5, at(0, 0, 0), "plate"), 1.5),
    (Cylinder(2.5, 2, at(0, 0, 0), "plate"), 1.0),
]


@pytest.mark.parametrize(("plate", "top"), PLATES)
def test_a_mouth_is_on_the_face_whole_and_faces_out(plate, top):
    make = lambda x, z, **turn: Cage(shapes=[plate, hole(0.8, 1.0, at(x, 0, z, **turn), "plate")])  # noqa: E731
    assert [one.name for one in make(0.0, top).holes] == ["hole1"]
    make(1.19, top)
    assert "but its mouth is not all on a face there" in found(lambda: make(1.8, top))[0]
    assert "but its mouth is not all on a face there" in found(lambda: make(0.0, top + 0.01))[0]
    assert "but its mouth is not all on a face there" in found(lambda: make(0.0, top, euler=(0.0, 0.0, PI)))[0]
    assert "has its mouth inside plate" in found(lambda: make(0.0, top - 0.01))[0]


DOWN, UP, SIDEWAYS = (0.0, 0.0, 0.0), (0.0, 0.0, PI), (0.0, PI / 2.0, 0.0)


@pytest.mark.parametrize(
    ("one", "other", "meet"),
    [
        (((0, 0, 1), 0.8, 2.0, DOWN), ((1.0, 0, 1), 0.8, 2.0, DOWN), True),
        (((-0.8, 0, 1), 0.8, 2.0, DOWN), ((0.8, 0, 1), 0.8, 2.0, DOWN), True),  # their walls touch
        (((-0.9, 0, 1), 0.8, 2.0, DOWN), ((0.75, 0, 1), 0.8, 2.0, DOWN), False),
        (((0, 0, 1), 0.8, 0.5, DOWN), ((0, 0, -1), 0.4, 1.5, UP), True),  # a step in a bore
        (((0, 0, 1), 0.8, 0.5, DOWN), ((0, 0, -1), 0.4, 1.4, UP), False),
        (((0, 0, 1), 0.8, 3.0, DOWN), ((2, 0, 0), 0.4, 2.0, SIDEWAYS), True),
        (((0, 0, 1), 0.8, 3.0, DOWN), ((2, 0, 0), 0.4, 1.1, SIDEWAYS), False),
    ],
)
def test_holes_that_meet_are_refused(one, other, meet):
    """Where one hole cuts away the wall of another, as in a slot of round holes, edges are left that are not known."""
    plate = Box((4, 4, 2), at(0, 0, 0), "plate")

    def cage():
        return Cage(
            shapes=[
                plate,
                *(hole(radius, depth, at(*place, euler=turn), "plate") for place, radius, depth, turn in (one, other)),
            ]
        )

    if meet:
        assert found(cage)[0].startswith("shapes[2].hole: meets hole1 in plate; keep holes apart")
    else:
        assert len(cage().holes) == 2


def test_a_mouth_over_two_parts_that_meet_flush_is_within_both():
    halves = [Box((4, 4, 2), at(-2, 0, 0), "left"), Box((4, 4, 2), at(2, 0, 0), "right")]
    Cage(shapes=[*halves, hole(0.8, 1.0, at(0, 0, 1), "left", "right")])
    assert "its mouth is not all" in found(lambda: Cage(shapes=[*halves, hole(0.8, 1.0, at(0, 0, 1), "left")]))[0]


@pytest.mark.parametrize("chamfer", [None, Chamfer(0.3, math.radians(30.0))])
@pytest.mark.parametrize(("plate", "top"), PLATES)
def test_what_a_hole_in_one_part_takes_away_is_exact_without_the_extra(plate, top, chamfer, monkeypatch):
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    one = hole(0.8, 1.2, at(0.5, 0.2, top), "plate", chamfer=chamfer)
    volume = PI * 0.64 * 1.2
    if chamfer:
        height = 0.3 * math.sqrt(3.0)
        volume = PI * 0.64 * (1.2 - height) + PI * height / 3.0 * (0.64 + 0.8 * 1.1 + 1.21)
    assert_allclose(shape_moments(one).volume_m3, volume, rtol=1e-14)
    held = body_moments([plate, Sphere(1, at(0, 0, 20))], [one])
    origin = TURNED.position_m
    sums = sums_of(shape_moments(plate), origin) + sums_of(shape_moments(Sphere(1, at(0, 0, 20))), origin)
    expected = (sums + sums_of(shape_moments(one), origin).times(-1.0)).moments(origin)
    assert_allclose(held.volume_m3, expected.volume_m3, rtol=1e-14)
    assert_allclose(held.centroid_m, expected.centroid_m, rtol=1e-13)
    assert_allclose(held.second_moment_m2, expected.second_moment_m2, rtol=0.0, atol=1e-12)


def test_the_mesh_of_a_hole_is_what_it_takes_away():
    one = hole(0.8, 1.2, at(0.5, 0.2, 1.0), chamfer=Chamfer(0.3, 0.5))
    coarse, fine = (mesh_sums(shape_mesh(one, 128, halved=halved), one.nodes_body()[0]) for halved in (False, True))
    limit = fine.times(4.0 / 3.0) + coarse.times(-1.0 / 3.0)
    assert_allclose(limit.volume, shape_moments(one).volume_m3, rtol=1e-6)


BLOCK = Box((4, 4, 2), at(0, 0, 0), "a")
UNCLEAN = [
    ([BLOCK], [hole(0.8, 9.0, at(0, 0, 1), "a")], 32 - PI * 1.28),
    ([BLOCK, Box((4, 4, 2), at(0, 0, -2), "b")], [hole(0.8, 3.0, at(0, 0, 1), "a", "b")], 64 - PI * 1.92),
    ([BLOCK, Box((4, 4, 2), at(0, 0, -2), "b")], [hole(0.8, 3.0, at(0, 0, 1), "a")], 64 - PI * 1.28),
    ([BLOCK, Cylinder(0.5, 2.0, at(0, 0, 0), "pin")], [hole(0.8, 2.0, at(0, 0, 1), "a")], 32 - PI * (1.28 - 0.5)),
    ([BLOCK], [hole(0.8, 2.0, at(0, 0, 1), "a"), hole(0.5, 2.0, at(0, 0, 1), "a")], 32 - PI * 1.28),
]


@pytest.mark.parametrize(("parts", "holes", "volume"), UNCLEAN)
def test_through_holes_holes_in_several_parts_and_pins_in_holes(parts, holes, volume):
    assert_allclose(body_moments(parts, holes).volume_m3, volume, rtol=1e-7)


def test_a_part_that_is_all_hole_has_no_volume_and_a_hole_that_stands_alone_takes_nothing_away():
    bar = Cylinder(0.8, 2.0, at(0, 0, 0), "bar")
    assert body_moments([bar], [hole(0.8, 2.0, at(0, 0, 1), "bar")]) is None
    alone = body_moments([bar], [hole(0.8, 2.0, at(0, 0, 1))])
    assert alone.volume_m3 == shape_moments(bar).volume_m3


def test_holes_are_no_parts_but_count_for_size_and_names():
    held = Object([Box((4, 4, 4), name="a")], shapes=[hole(1, 2, Pose((0, 0, 2)), "a"), Sphere(1, Pose((9, 0, 0)))])
    assert [part.name for part in held.parts] == ["a", "sphere1"]
    assert held.part_paths == (("boxes", 0), ("shapes", 1, "sphere"), ("shapes", 0, "hole"))
    cage = Cage([(0, 0, 9)], shapes=[Hole(5.0, 1.0), Sphere(1.0)])
    assert cage.element_names == ("C1", "sphere1", "hole1")
    assert np.isclose(held.center_of_gravity_m[2], -PI * 2 * 1.0 / (64 - 2 * PI + 4 / 3 * PI))


def test_a_cage_point_may_start_in_a_hole_but_not_beside_it():
    held = Object([Box((4, 4, 4), name="a")], shapes=[hole(1, 2, Pose((0, 0, 2)), "a")], pose=Pose((0, 0, 5)))
    make = lambda x: Scene(held, Cage([(x, 0, 6), (9, 9, 0), (-9, 0, 0)]), [Load("g", gravity=(0, 0, -1))])  # noqa: E731
    make(0.9)
    assert found(lambda: make(1.1))[0].startswith("cage.points.C1: starts 100 mm inside object.boxes[0] (a)")

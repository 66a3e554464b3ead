"""The start check: are two bodies in each other? Against planes between convex bodies, cells, volumes and samples."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import manifold3d
import numpy as np
import pytest

from boundary.box_grid import cells_of, drawn_boxes
from boundary.convex_overlap import distance, drawn_convex, least_extent, samples
from boundary.drawn_hulls import drawn_hull
from cagepose import Box, Pose
from cagepose.kernels.boundary.features import empty_placed, place_boundary
from cagepose.kernels.boundary.overlap import Overlap, empty_overlap_work, find_overlap
from cagepose.model.boundary.features import boundary_of
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Cone, Convex, Cylinder, Shape, Sphere
from inner_kernels import as_machine_code

TOUCH_M = 1e-9
Rng = np.random.Generator
Parts = Sequence[Shape | np.ndarray]


@cache
def _kernels() -> tuple[Any, Any]:
    return as_machine_code(place_boundary), as_machine_code(find_overlap)


class Start:
    """An object and its cage, which may be turned and moved."""

    def __init__(self, held: Parts, cage: Parts, at: Pose | None = None) -> None:
        self.held, self.cage = (empty_placed(boundary_of(parts, TOUCH_M)) for parts in (held, cage))
        self.at = Pose() if at is None else at
        _kernels()[0](self.cage, *self.at.as_tuples())
        self.work = empty_overlap_work(self.held.own, self.cage.own)

    def asked(self, pose: Pose) -> Overlap:
        """Ask with the object at a pose seen from the cage."""
        _kernels()[0](self.held, *(self.at @ pose).as_tuples())
        return Overlap(*_kernels()[1](self.held, self.cage, TOUCH_M, self.work))


def drawn_turn(rng: Rng) -> Pose:
    return Pose(rng.uniform(-1.0, 1.0, 3), rng.standard_normal(4))


def test_convex_bodies_overlap_if_no_plane_is_between_them(cases):
    """Far apart, at random, and 1 mm to either side of where they first touch; depths are no more than the way out."""
    rng = np.random.default_rng(51)
    ways = rng.standard_normal((50, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    for k in range(cases(20, 1_500)):
        one, other = drawn_convex(rng), drawn_convex(rng)
        turn, way = rng.standard_normal(4), rng.standard_normal(3)
        way /= np.linalg.norm(way)
        away = rng.uniform(0.0, 1.2)
        if k % 3:
            inside, away = 0.0, 8.0
            while away - inside > 1e-4:
                half = 0.5 * (inside + away)
                is_apart = distance(one, Pose(half * way, turn), other, Pose(), 1e-6)[0] > 1e-7
                inside, away = (inside, half) if is_apart else (half, away)
            away += 1e-3 if k % 2 else -1e-3
        pose = Pose(away * way, turn)
        lower, upper = distance(one, pose, other, Pose(), 1e-8)
        assert lower > 0.0 or upper < 1e-7
        found = Start([one], [other]).asked(pose)
        assert (found.depth_m > 0.0) == (lower <= 0.0)
        assert found.depth_m == 0.0 or found.depth_m <= least_extent(one, pose, other, Pose(), ways) * (1.0 + 1e-9)


def test_unions_of_boxes_overlap_if_they_share_a_cell(cases):
    """Flush faces, edges and corners are ordinary on a grid; shifted by rounding or by less than what touches."""
    rng = np.random.default_rng(52)
    for _ in range(cases(60, 3_000)):
        size = int(rng.integers(2, 7))
        held, cage = (drawn_boxes(rng, int(rng.integers(1, 6)), size) for _ in range(2))
        start = Start(*([_box(corners) for corners in boxes] for boxes in (held, cage)), drawn_turn(rng))
        for _ in range(4):
            shift = rng.integers(-size, size + 1, 3)
            slack = rng.choice([0.0, 1e-13, 3e-10]) * rng.uniform(-1.0, 1.0, 3)
            assert (start.asked(Pose(shift + slack)).depth_m > 0.0) == _share_cells(held, cage, shift)


def _box(corners: tuple[tuple[int, ...], tuple[int, ...]]) -> Box:
    low, high = np.array(corners, float)
    return Box(high - low, Pose(0.5 * (low + high)))


def _share_cells(held: list[Any], cage: list[Any], shift: np.ndarray) -> bool:
    own, other = ({tuple(cell) for cell in np.argwhere(cells_of(boxes)).tolist()} for boxes in (held, cage))
    return bool({tuple((np.array(cell) + shift).tolist()) for cell in own} & other)


def test_unions_of_hulls_overlap_if_their_intersection_has_a_volume(cases):
    rng = np.random.default_rng(53)
    for _ in range(cases(30, 2_000)):
        held, cage = (_drawn_union(rng) for _ in range(2))
        start, own, other = Start(held, cage), _solid(held), _solid(cage)
        for _ in range(4):
            pose = Pose(0.25 * rng.uniform(-1.0, 1.0, 3) * rng.choice([0.3, 1.0]), rng.standard_normal(4))
            volume = (own.transform(np.hstack([pose.rotation, pose.position_m[:, None]])) ^ other).volume()
            if not 0.0 < volume < 1e-12:
                assert (start.asked(pose).depth_m > 0.0) == (volume > 0.0)


def _drawn_union(rng: Rng) -> list[Convex]:
    poses = [Pose(0.07 * rng.uniform(-1.0, 1.0, 3), rng.standard_normal(4)) for _ in range(int(rng.integers(1, 6)))]
    return [Convex(pose.transform(drawn_hull(rng, 0.1 * rng.uniform(0.4, 1.5)).vertices_m)) for pose in poses]


def _solid(parts: Sequence[Convex]) -> Any:
    hulls = [manifold3d.Manifold.hull_points(np.ascontiguousarray(part.vertices_m)) for part in parts]
    return manifold3d.Manifold.batch_boolean(hulls, manifold3d.OpType.Add)


def test_what_is_in_or_over_a_hole_overlaps_if_a_place_of_it_is_in_the_material(cases):
    """Sharp and chamfered holes, through and blind; of 5,000 places, and of a million where these say otherwise."""
    rng = np.random.default_rng(54)
    for _ in range(cases(60, 3_000)):
        hole, held = _drawn_hole(rng), drawn_convex(rng, 0.55)
        start = Start([held], [Box((4, 4, 1), Pose((0, 0, -0.5)), name="plate"), hole], drawn_turn(rng))
        for _ in range(4):
            tilt, aside = rng.choice([0.0, 0.05, 0.3, 3.0]), rng.choice([0.0, 0.1, 0.3, 2.6])
            place = (*aside * rng.uniform(-1.0, 1.0, 2), rng.uniform(-1.2, 0.8))
            pose = Pose(place, (1.0, *tilt * rng.uniform(-1.0, 1.0, 3)))
            is_in = start.asked(pose).depth_m > 0.0
            if is_in != (_depth_in_plate(hole, pose.transform(samples(held, 5_000, rng))) > 0.0):
                assert is_in == (_depth_in_plate(hole, pose.transform(samples(held, 1_000_000, rng))) > 0.0)


def _drawn_hole(rng: Rng) -> Hole:
    chamfer = Chamfer(0.2, rng.uniform(0.3, 1.2)) if rng.uniform() < 0.5 else None
    return Hole(0.5, 0.7 if rng.uniform() < 0.4 else 1.0, chamfer, in_=("plate",))


def _depth_in_plate(hole: Hole, places: np.ndarray) -> float:
    """How deep the deepest of some places is in a plate 4 x 4 x 1 with a hole; below zero: none is in it."""
    heights, radii = np.array(hole.rims).T
    x, y, z = places.T
    beyond = np.hypot(x, y) - np.interp(z, heights, radii)
    beyond = np.where(z < -hole.depth_m, np.maximum(beyond, -hole.depth_m - z), beyond)
    in_plate = np.minimum.reduce([-z, z + 1.0, 2.0 - np.abs(x), 2.0 - np.abs(y)])
    return float(np.minimum(in_plate, beyond).max())


PLATE = Box((4, 4, 1), Pose((0, 0, -0.5)), name="plate")
CUBE, ROD, PIN = Box((1, 1, 1)), Box((3, 0.2, 0.2)), Cylinder(0.5, 2.0)
ACROSS = Pose((0, 0, 0), euler_zyx=(np.pi / 2.0, 0, 0))
LYING = Pose((0, 0, 0), euler_zyx=(0, np.pi / 2.0, 0))
BORED = (PLATE, Hole(0.5, 1.0, in_=("plate",)))
BLIND = (PLATE, Hole(0.5, 0.5, in_=("plate",)))
SUNK = (PLATE, Hole(0.5, 1.0, Chamfer(0.2, np.pi / 4.0), in_=("plate",)))
COMB = [Box((0.1, 4, 1), Pose((x, 0, 0.5)), name=f"c{k}") for k, x in enumerate(np.arange(-2.0, 2.1, 0.4))]
COMB.append(Box((5, 5, 0.2), Pose((0, 0, -0.1))))
STUD = (PLATE, Cylinder(0.5, 2.0, name="stud"))
CROSS = (PIN, Cylinder(0.5, 2.0, LYING, name="lying"))

TOUCHING: dict[str, tuple[Parts, Parts, Pose]] = {
    "faces": ([CUBE], [CUBE], Pose((1, 0, 0))),
    "faces, aside": ([CUBE], [CUBE], Pose((0.3, 0.2, 1))),
    "a face on a plate": ([CUBE], [PLATE], Pose((0.3, 0.2, 0.5), euler_zyx=(0.3, 0, 0))),
    "edges along each other": ([CUBE], [CUBE], Pose((1, 1, 0.3))),
    "corners": ([CUBE], [CUBE], Pose((1, 1, 1))),
    "an edge on a face": ([CUBE], [PLATE], Pose((0, 0, np.sqrt(0.5)), euler_zyx=(0, np.pi / 4.0, 0))),
    "a tilt of 1e-7 rad": ([CUBE], [PLATE], Pose((0, 0, 0.5 + 0.5e-7), euler_zyx=(0, 1e-7, 0))),
    "a pin in its hole": ([PIN], BORED, Pose((0, 0, -0.5))),
    "a short pin in its hole": ([Cylinder(0.5, 0.5)], BORED, Pose((0, 0, -0.5))),
    "a plug flush with its plate": ([Cylinder(0.5, 1.0)], BORED, Pose((0, 0, -0.5))),
    "a plug in a blind hole": ([Cylinder(0.5, 0.5)], BLIND, Pose((0, 0, -0.25))),
    "a pin at its wall": ([Cylinder(0.4, 2.0)], BORED, Pose((0.1, 0, -0.5))),
    "a cone in its chamfer": ([Cone(0.5, 0.7, 0.2)], SUNK, Pose((0, 0, -0.1))),
    "a ball on a plate": ([Sphere(0.5)], [PLATE], Pose((0, 0, 0.5))),
    "a ball on the mouth of a hole": ([Sphere(0.625)], BORED, Pose((0, 0, 0.375))),
    "a ball in a hole": ([Sphere(0.5)], BORED, Pose((0, 0, -0.5))),
    "a lying pin": ([PIN], [PLATE], LYING @ Pose((-0.5, 0, 0))),
    "pins along each other": ([PIN], [PIN], Pose((0.6, 0.8, 0.3))),
    "crossed pins": ([PIN], [PIN], Pose((0, 1, 0)) @ LYING),
    "crossed bars": ([ROD], [ROD], Pose((0, 0, 0.2)) @ ACROSS),
    "a point on a plate": ([np.zeros(3)], [PLATE], Pose((0.2, 0.1, 0))),
    "a plate on points": ([PLATE], [np.array((x, y, -1.0)) for x in (-1, 1) for y in (-1, 1)], Pose()),
    "a block at a stud in a plate": ([CUBE], STUD, Pose((1, 0, 0.5))),
    "a ball in the corner of a cross of pins": ([Sphere(0.2)], CROSS, Pose((0.7, 0, 0.7))),
    "a comb in a comb": (COMB, COMB, Pose((0.1, 0, 1), euler_zyx=(0, 0, np.pi))),
}
INSIDE: dict[str, tuple[Parts, Parts, Pose, float]] = {
    "the same": ([CUBE], [CUBE], Pose(), 1.0),
    "flush, half": ([CUBE], [CUBE], Pose((0.7, 0, 0)), 0.3),
    "crossed bars": ([ROD], [ROD], ACROSS, 0.2),
    "crossed bars, aside": ([ROD], [ROD], Pose((0, 0, 0.15)) @ ACROSS, 0.05),
    "wholly inside": ([Box((0.1, 0.1, 0.1))], [CUBE], Pose(), 0.55),
    "all around": ([CUBE], [Box((0.1, 0.1, 0.1))], Pose(), 0.55),
    "a ball in a face": ([Sphere(0.5)], [PLATE], Pose((0.1, 0.2, 0.4)), 0.1),
    "a ball wholly inside": ([Sphere(0.1)], [PLATE], Pose((0.1, 0.2, -0.5)), 0.6),
    "balls in each other": ([Sphere(0.5)], [Sphere(0.5)], Pose((0, 0.9, 0)), 0.1),
    "crossed pins": ([PIN], [PIN], Pose((0, 0.99, 0)) @ LYING, 0.01),
    "crossed pins, through": ([Cylinder(0.1, 3.0)], [PIN], Pose((0, 0.1, 0)) @ LYING, 0.5),
    "a bar through a plate": ([ROD], [PLATE], Pose((0.1, 0, -0.5)) @ LYING, 1.0),
    "a pin through a plate": ([Cylinder(0.1, 3)], [PLATE], Pose((0.1, 0, -0.5)), 1.0),
    "a thick pin in a hole": ([Cylinder(0.51, 2)], BORED, Pose((0, 0, -0.5)), 0.02),
    "a thick short pin in a hole": ([Cylinder(0.51, 0.5)], BORED, Pose((0, 0, -0.5)), 0.02),
    "a thick ball in a hole": ([Sphere(0.51)], BORED, Pose((0, 0, -0.5)), 0.02),
    "a ball in the wall of a hole": ([Sphere(0.4)], BORED, Pose((0.11, 0, -0.5)), 0.01),
    "a block in a plate": ([CUBE], [PLATE], Pose((0.3, 0.1, -0.5)), 1.0),
    "a boss in a ball": ([Sphere(0.9)], [PLATE, Box((0.2, 0.2, 0.4), name="boss")], Pose((0, 0, 0.5)), 1.0),
    "a hole with a box around": ([Box((1, 1, 0.5))], [PLATE, Hole(0.4, 1.0, in_=("plate",))], Pose((0, 0, -0.5)), 0.75),
    "a box in two pins at once": ([Box((0.1, 0.1, 0.1))], CROSS, Pose((0.05, 0.03, 0.02)), 0.6),
    "a box in a stud": ([Box((0.1, 0.1, 0.1))], STUD, Pose((0.05, 0.03, 0.5)), 0.6),
    "a point in a plate": ([np.zeros(3)], [PLATE], Pose((0.2, 0.1, -0.1)), 0.1),
    "sunk by a little": ([CUBE], [PLATE], Pose((0.2, 0.1, 0.5 - 1.5 * TOUCH_M)), 1.5 * TOUCH_M),
    "combs": (COMB, COMB, Pose((0.05, 0, 1), euler_zyx=(0, 0, np.pi)), 0.05),
}


@pytest.mark.parametrize("name", TOUCHING)
def test_what_touches_is_in_nothing(name, cases):
    held, cage, pose = TOUCHING[name]
    rng = np.random.default_rng(55)
    for at in (Pose(), *(drawn_turn(rng) for _ in range(cases(5, 200)))):
        assert Start(held, cage, at).asked(pose) == (-1, -1, 0.0)
        assert Start(cage, held, at @ pose).asked(pose.inverse()) == (-1, -1, 0.0)


@pytest.mark.parametrize("name", INSIDE)
def test_what_is_in_each_other_is_told_with_a_depth_that_is_not_too_much(name, cases):
    held, cage, pose, most = INSIDE[name]
    rng = np.random.default_rng(56)
    for at in (Pose(), *(drawn_turn(rng) for _ in range(cases(5, 200)))):
        start = Start(held, cage, at)
        found = start.asked(pose)
        assert 0.0 < found.depth_m <= most * (1.0 + 1e-5)
        assert start.held.own.features[found.feature]["part"] < len(held)
        assert Start(cage, held, at @ pose).asked(pose.inverse()).depth_m > 0.0

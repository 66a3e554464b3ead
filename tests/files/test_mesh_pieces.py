"""Machined parts as meshes: cut so that holes stay whole, nothing small is lost, and what is rounded is told."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from cagepose import Box, Cone, Convex, Cylinder, Facets, Hole, Pose
from cagepose.files.meshes import around_holes
from cagepose.files.meshes.mesh_shapes import MeshShapes
from files.bodies import body, shapes_of, turned

pytest.importorskip("trimesh")

WIDTH, DEPTH, HEIGHT = 100.0, 60.0, 10.0
PLATE = Box((WIDTH, DEPTH, HEIGHT))


def drilled(x: float, y: float, radius: float = 6.0) -> Cylinder:
    return Cylinder(radius, 40.0, Pose((x, y, 0.0)))


def notch(x: float, y: float, width: float = 20.0, depth: float = 20.0) -> Box:
    return Box((width, depth, 30.0), Pose((x, y, 0.0)))


def parted(found: MeshShapes):
    parts = [shape for shape in found.shapes if not isinstance(shape, Hole)]
    return parts, [shape for shape in found.shapes if isinstance(shape, Hole)]


def divided(found: MeshShapes) -> list[str]:
    """Holes in whose opening sides of pieces would stand."""
    parts, holes = parted(found)
    return [str(hole.name) for hole in holes if hole.divided_by([part for part in parts if part.name in hole.in_])]


def off_on_average(found: MeshShapes, solid) -> float:
    """Volume of what is in one of both bodies, for their surface."""
    parts, holes = parted(found)
    one, other = body(*parts, without=tuple(holes)), turned(solid).body()
    return ((one - other).volume() + (other - one).volume()) / other.surface_area()


LYING = Pose((0, 0, 30), euler_zyx=(0, math.pi / 2, 0))
DRILLED = {
    "notch": body(PLATE, without=(notch(0, 30), drilled(30, 20), drilled(-30, 20))),
    "two notches": body(
        PLATE, without=(notch(0, 30), notch(0, -30), drilled(0, 0), drilled(30, 20), drilled(-30, -20))
    ),
    "L": body(PLATE, Box((20, 100, 10), Pose((-40, 20, 0))), without=(drilled(-40, 30), drilled(30, 0))),
    "U": body(
        PLATE,
        *(Box((10, 60, 50), Pose((x, 0, 20))) for x in (-45, 45)),
        without=(Cylinder(6, 120, LYING), drilled(0, 0)),
    ),
    "counterbores": body(
        PLATE,
        Box((5, 60, 25), Pose((0, 0, 10))),
        without=tuple(
            cut for x in (-35, 35) for y in (-20, 20) for cut in (drilled(x, y, 3), Cylinder(6, 6, Pose((x, y, 3))))
        ),
    ),
    "counterbore level with a step": body(
        PLATE, without=(Box((60, 70, 10), Pose((40, 0, 7))), drilled(-30, 0, 3), Cylinder(6, 10, Pose((-30, 0, 7))))
    ),
    "chamfer above": body(PLATE, without=(drilled(0, 0), Cone(6, 8, 2, Pose((0, 0, 4))))),
    "chamfer below": body(PLATE, without=(drilled(0, 0), Cone(8, 6, 2, Pose((0, 0, -4))))),
    "pocket": body(PLATE, without=(Box((60, 30, 10), Pose((0, 0, 5))), drilled(0, 22, 4), drilled(-40, 0))),
}


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("name", DRILLED)
def test_cuts_run_beside_holes(name, single):
    """The bottom of a notch goes on through the holes beside it, its sides do not."""
    found = shapes_of(DRILLED[name], single=single)
    n_counterbores = 4 if name == "counterbores" else name.startswith("counterbore")
    assert len(parted(found)[1]) == DRILLED[name].genus() + n_counterbores
    assert any(hole.chamfer is not None for hole in parted(found)[1]) == name.startswith("chamfer")
    assert divided(found) == []
    assert off_on_average(found, DRILLED[name]) < 0.1 * found.error  # of the chords of holes


def test_a_hole_that_every_cut_runs_along_keeps_a_block_around_it(monkeypatch):
    """In an L, one hole in each leg: either face of its inner corner goes on through one of them."""
    angle = body(
        Box((60, 60, 10), Pose((30, 30, 0))),
        without=(
            Box((40, 40, 30), Pose((50, 50, 0))),
            *(drilled(x, y, 5.0) for x, y in ((30, 10), (10, 30))),
        ),
    )
    found = shapes_of(angle)
    assert divided(found) == []
    assert all(len(hole.in_) == 1 for hole in parted(found)[1])
    assert off_on_average(found, angle) < 0.1 * found.error
    monkeypatch.setattr(around_holes, "WIDTHS", ())
    whole = shapes_of(angle)
    assert [shape.kind for shape in whole.shapes] == ["facets", "hole", "hole"]
    assert divided(whole) == []


@pytest.mark.parametrize("size", [2.0, 1.0])
def test_a_small_pocket_is_not_lost(size):
    """One of a hundredth of the side of a block, a millionth of its volume, is in its shapes to the last digits."""
    block = body(Box((100, 100, 100)), without=(Box((size, size, 2.0 * size), Pose((0, 0, 50))),))
    found = shapes_of(block)
    assert len(found.shapes) == 5
    assert sum(body(part).volume() for part in found.shapes) == pytest.approx(100.0**3 - size**3, abs=1e-6)


def test_a_flat_groove_is_not_lost():
    block = body(Box((100, 100, 100)), without=(Box((10, 120, 0.02), Pose((20, 0, 50))),))
    found = shapes_of(block)
    assert sum(body(part).volume() for part in found.shapes) == pytest.approx(100.0**3 - 10.0, abs=1e-6)


def test_a_furrow_with_blunt_edges_stays():
    """A mesh of what is round is a little hollow between its facets; a block with a shallow furrow is no box."""
    corners = [(x, y, 50.05 - 0.05 * (2 - abs(x))) for x in (-1.0, 0.0, 1.0) for y in (-60.0, 60.0)]
    furrow = Convex([*corners, *((x, y, 51.0) for x in (-20.0, 20.0) for y in (-60.0, 60.0))])
    furrowed = body(Box((100, 100, 100)), without=(furrow,))
    (block,) = shapes_of(furrowed).shapes
    assert isinstance(block, Facets)
    assert body(block).volume() == pytest.approx(1e6 - 5.0, abs=1e-4)


def rounded_slot(x: float, radius: float = 2.0, width: float = 16.0) -> tuple:
    """A notch with round corners at one side."""
    cuts = [notch(x, -30, width - 2 * radius, 20), notch(x, -30, width, 20 - 2 * radius)]
    return (*cuts, *(drilled(x + s * (width / 2 - radius), -20 - radius, radius) for s in (-1, 1)))


def test_a_part_with_many_fillets_is_facets_with_round_holes():
    """What is round in its notches stays as it is in the mesh, and a note says how far chords of a round one are in."""
    solid = body(
        PLATE, without=(*rounded_slot(-25), *rounded_slot(25), Cylinder(8, 40, Pose((0, 30, 0))), drilled(0, 0))
    )
    found = shapes_of(solid)
    plate, hole = found.shapes
    assert isinstance(plate, Facets)
    assert isinstance(hole, Hole)
    assert found.error == pytest.approx(6.0 * (1.0 - math.cos(math.pi / 64)), rel=1e-3)
    said = re.search(r"flat facets here, as in the mesh; .* they are about (.*) mm off", found.notes[1])
    assert said is not None
    assert float(said[1]) == pytest.approx(8.0 * (1.0 - math.cos(math.pi / 64)), rel=0.1)
    assert divided(found) == []
    assert off_on_average(found, solid) < 0.1 * found.error


def machined(rng: np.random.Generator):
    """A plate with one to three features and up to three holes that are clear of them."""
    added, cut, taken = [PLATE], [], []

    def take(x: float, half_width: float, y: float, half_depth: float) -> None:
        taken.append((x - half_width, x + half_width, y - half_depth, y + half_depth))

    for kind in rng.choice(["notch", "rib", "boss", "upright", "pocket", "slot", "step"], int(rng.integers(1, 4))):
        x, y, width = rng.uniform(-30, 30), rng.uniform(-10, 10), rng.uniform(6, 20)
        if kind == "notch":
            cut.append(notch(x, 30, width, width))
            take(x, width / 2, 30, width / 2)
        elif kind == "rib":
            added.append(Box((5, 60, 25), Pose((x, 0, 10))))
            take(x, 2.5, 0, 30)
        elif kind == "boss":
            added.append(Cylinder(8, 25, Pose((x, y, 8))))
            take(x, 8, y, 8)
            if rng.random() < 0.5:
                cut.append(drilled(x, y, 4))
        elif kind == "upright":
            added.append(Box((6, 60, 40), Pose((47, 0, 20))))
            take(47, 3, 0, 30)
        elif kind == "pocket":
            cut.append(Box((width, 15, 30 if rng.random() < 0.5 else 6), Pose((x, y, 5))))
            take(x, width / 2, y, 7.5)
        elif kind == "slot":
            cut.extend(rounded_slot(x))
            take(x, 8, -25, 5)
        else:
            cut.append(Box((100, 60, 10), Pose((x + 50, 0, 7))))
            take(x, 0.1, 0, 30)
    for _ in range(10):
        x, y, radius = rng.uniform(-44, 44), rng.uniform(-24, 24), rng.uniform(2, 5)
        room = radius + 1.0
        is_on = abs(x) + room < WIDTH / 2 and abs(y) + room < DEPTH / 2
        if is_on and not any(a < x + room and x - room < b and c < y + room and y - room < d for a, b, c, d in taken):
            cut.append(drilled(x, y, radius))
            take(x, radius, y, radius)
    return body(*added, without=tuple(cut))


def test_machined_parts_are_what_they_were(cases, say):
    """In double and single precision; features may overlap."""
    rng, n_facets, farthest = np.random.default_rng(81), 0, 0.0
    n_drawn = cases(10, 400)
    for index in range(n_drawn):
        solid = machined(rng)
        found = shapes_of(solid, single=index % 2 == 1)
        n_facets += any(isinstance(shape, Facets) for shape in found.shapes)
        assert divided(found) == []
        off = off_on_average(found, solid)
        assert off < 0.6 * found.error + 1e-4, f"part {index}"
        farthest = max(farthest, off)
    say(f"{n_drawn} machined parts: {n_facets} with facets; {farthest:.1e} mm off on average at most")

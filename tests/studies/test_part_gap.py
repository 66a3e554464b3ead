"""The gap of two parts that are named is their least distance, whatever else is in the scene."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from cagepose import Box, Cage, CageBody, Cylinder, Hole, Object, Pose, Scene, SceneError, load_scene, run
from cagepose.model.nearest import core_of, nearest_points
from cagepose.model.shapes import AnyShape, Capsule, Cone, Convex, Disc, Sphere
from cagepose.runs.driven_cage import CageAt, cage_at_end, cage_at_start
from cagepose.studies.between_features import Instant
from cagepose.studies.gaps import GapFinder
from cagepose.studies.part_gap import PartGap
from our_scenes import SCENES
from shaped_scenes import WEIGHT, drawn_shape, held, placed_apart

CUBE = Box((0.02, 0.02, 0.02), name="cube")


def at_start(scene: Scene, pose: Pose | None = None) -> Instant:
    return Instant(pose or scene.object.pose_world_object, cage_at_start(scene.cage), scene.touch_m)


def gap_of(scene: Scene, part: int, element: int, pose: Pose | None = None) -> float:
    return PartGap(scene, [part], [element]).at(at_start(scene, pose))


def test_what_is_between_two_parts_does_not_hide_them_from_each_other() -> None:
    wall, behind = Box((0.001, 0.2, 0.2), Pose((0.0125, 0, 0))), Box((0.01, 0.01, 0.01), Pose((0.03, 0, 0)))
    scene = Scene(held(CUBE, start=Pose()), Cage(shapes=[wall, behind]), [WEIGHT])
    assert gap_of(scene, 0, 0) == pytest.approx(0.002, rel=1e-12)
    assert gap_of(scene, 0, 1) == pytest.approx(0.015, rel=1e-12)


def test_a_gap_within_the_touch_tolerance_is_zero_and_a_wider_one_is_not() -> None:
    scene = Scene(held(CUBE, start=Pose()), Cage(shapes=[Box((0.1, 0.1, 0.01), Pose((0, 0, -0.015)))]), [WEIGHT])
    touch_m = scene.geometry.touch_m
    assert gap_of(scene, 0, 0, Pose((0, 0, 0.9 * touch_m))) == 0.0
    assert gap_of(scene, 0, 0, Pose((0, 0, 3.0 * touch_m))) == pytest.approx(3.0 * touch_m, rel=1e-6)


def test_the_gap_of_drawn_parts_is_what_a_search_without_features_finds(cases, say) -> None:
    """By the method of Gilbert, Johnson and Keerthi; of each of two parts to each of two shapes and a point."""
    random, worst = np.random.default_rng(11), 0.0
    for _ in range(cases(15, 600)):
        own = [placed_apart(random, drawn_shape(random), random.uniform(0.0, 0.02)) for _ in range(2)]
        others = [placed_apart(random, drawn_shape(random), random.uniform(0.075, 0.3)) for _ in range(2)]
        point = random.normal(size=3)
        point *= 0.06 / np.linalg.norm(point)
        moved = Pose(random.normal(size=3) * 0.02, euler_zyx=random.uniform(-3, 3, 3))
        start = Pose(moved.position_m + random.normal(size=3) * 1e-3, moved.quaternion_wxyz)
        scene = Scene(held(*own, start=start), Cage([point], shapes=others, pose=moved), [WEIGHT])
        of_cage = [core_of(moved.transform(point), moved), *(core_of(shape, moved) for shape in scene.cage.shapes)]
        for part, shape in enumerate(scene.object.parts):
            for element, core in enumerate(of_cage):
                told = math.dist(*nearest_points(core_of(shape, start), core))
                error = abs(gap_of(scene, part, element) - told) / told
                worst = max(worst, error)
                assert error < 1e-8
    say(f"off by {worst:.1e} of themselves at most")


QUARTER = math.pi / 2
IN_LINE = [
    (0, 0, 0.05),
    (0.05, 0, 0),
    (0, 0.05, 0),
    (0.05, 0.05, 0),
    (0.05, 0, 0.05),
    (0.05, 0.05, 0.05),
    (0.01, 0, 0.05),
]
TURNED = [(0, 0, 0), (0, QUARTER, 0), (0, 0, QUARTER), (QUARTER, 0, 0), (QUARTER / 2, 0, 0), (0, QUARTER / 2, 0)]
CORNERS = [(x, y, z) for x in (-0.006, 0.006) for y in (-0.006, 0.006) for z in (-0.006, 0.006)]
ROUND_AND_SHARP = [
    *(Box((0.02, 0.02, 0.02)), Box((0.06, 0.01, 0.02)), Box((0.1, 0.1, 0.004)), Convex(CORNERS, 0.003)),
    *(Sphere(0.01), Capsule(0.006, 0.02), Cylinder(0.01, 0.02), Cylinder(0.005, 0.04), Disc(0.01)),
    *(Cone(0.01, 0.005, 0.02), Cone(0.01, 0.0, 0.02), Cone(0.0, 0.01, 0.02)),
]


def test_parts_in_line_with_each_other_have_their_gap_too(cases, say) -> None:
    """Coaxial, parallel, corner over corner: what is drawn in round numbers, by the same search."""
    random, worst, n_asked = np.random.default_rng(5), 0.0, 0
    every = list(product(ROUND_AND_SHARP, ROUND_AND_SHARP, TURNED, IN_LINE))
    for which in random.permutation(len(every))[: cases(300, 9_000)].tolist():
        one, other, turned, place = every[which]
        other = other.moved(Pose(place, euler_zyx=turned))
        try:
            scene = Scene(held(one, start=Pose()), Cage(shapes=[other]), [WEIGHT])
        except SceneError:  # they overlap
            continue
        told = math.dist(*nearest_points(core_of(one, Pose()), core_of(other, Pose())))
        error = abs(gap_of(scene, 0, 0) - told) / max(told, 1e-3)
        worst, n_asked = max(worst, error), n_asked + 1
        assert error < 1e-6  # the search stops short of it by so much where faces are parallel
    assert n_asked > 200
    say(f"{n_asked} in line, off by {worst:.1e} of themselves at most")


def test_where_every_scene_ends_the_gap_is_zero_of_what_touches_alone() -> None:
    """And that of the search for all gaps, where that tells of the element."""
    n_open = 0
    for path in SCENES:
        ended = run(load_scene(path))
        scene, at, names = ended.scene, cage_at_end(ended), ended.scene.cage.element_names
        told, touched = GapFinder(scene).at(ended.pose, at), {contact.point for contact in ended.contacts}
        for element, name in enumerate(names):
            pair = PartGap(scene, range(len(scene.object.element_names)), [element])
            found = pair.at(Instant(ended.pose, at, scene.touch_m))
            counted = {name, *(str(hole.name) for hole in scene.cage.holes if name in hole.in_)}
            assert (found == 0.0) == bool(counted & touched), (path.name, name)
            gaps = told.gaps_m[[names[other] in counted for other in told.elements.tolist()]]
            if len(gaps):
                assert found == pytest.approx(gaps.min(), rel=1e-9), (path.name, name)
                n_open += found > 0.0
    assert n_open > 40


BLOCK = Box((0.06, 0.06, 0.03), Pose((0, 0, -0.015)), "block")
BORE = Hole(0.01, 0.03, in_=["block"], name="bore")


def test_a_tilted_pin_in_a_bore_has_the_gap_of_its_nearest_points(cases, say) -> None:
    """Within the bore the pin's lower edge is nearest to the wall, at the mouth its side to the edge: both sampled."""
    around = np.linspace(0.0, 2.0 * math.pi, 40_001)[:-1]
    ring = np.stack([np.cos(around), np.sin(around), np.zeros_like(around)], axis=1)
    random, radius, length, worst = np.random.default_rng(3), 0.0095, 0.05, 0.0
    pin = Cylinder(radius, length, Pose((0, 0, length / 2)), "pin")
    scene = Scene(
        held(pin, start=Pose((0, 0, -0.02))),
        Cage(shapes=[BLOCK], holes=[BORE]),
        [WEIGHT],
    )
    bore, block = (PartGap(scene, [0], [scene.cage.element_names.index(name)]) for name in ("bore", "block"))
    for _ in range(cases(20, 500)):
        pose = Pose((*random.uniform(-1e-4, 1e-4, 2), -0.02), euler_zyx=random.uniform(-0.008, 0.008, 3))
        lower = pose.transform(radius * ring)
        mouth = pose.inverse_transform(0.01 * ring)
        to_wall, to_mouth = 0.01 - np.hypot(*lower.T[:2]), np.hypot(*mouth.T[:2]) - radius
        told = min(to_wall.min(), to_mouth.min())
        assert told > 0.0
        found = bore.at(at_start(scene, pose))
        worst = max(worst, abs(found - told))
        assert found == pytest.approx(told, abs=1e-9)
        assert block.at(at_start(scene, pose)) == found  # a block counts with its holes
    say(f"off by {worst:.1e} m at most")


def test_a_hole_has_the_gap_of_its_wall_and_its_block_that_of_what_is_nearest() -> None:
    """A headed pin: its head is 1 mm above the block, its shank 0.5 mm beside the wall, or 2 mm."""
    for radius, head_gap, own_gap in ((0.0095, 0.001, 0.0005), (0.008, 0.001, 0.002)):
        head = Cylinder(0.02, 0.01, Pose((0, 0, 0.006)), "head")
        shank = Cylinder(radius, 0.02, Pose((0, 0, -0.009)), "shank")
        scene = Scene(held(head, shank, start=Pose()), Cage(shapes=[BLOCK], holes=[BORE]), [WEIGHT])
        assert gap_of(scene, 1, 1) == pytest.approx(own_gap, rel=1e-9)
        assert gap_of(scene, 0, 0) == pytest.approx(head_gap, rel=1e-9)
        whole = PartGap(scene, [0, 1], [0]).at(at_start(scene))
        assert whole == pytest.approx(min(head_gap, own_gap), rel=1e-9)


def test_a_hole_of_the_object_has_the_gap_to_a_pin_of_the_cage() -> None:
    ring = Object(
        shapes=[BLOCK],
        holes=[BORE],
        center_of_gravity_m=(0, 0, 0),
        mass_kg=1.0,
        inertia_kg_m2=np.diag((1e-5, 1e-5, 1e-5)),
        pose=Pose((0.0002, 0.0, 0.0)),
    )
    scene = Scene(ring, Cage(shapes=[Cylinder(0.0095, 0.2)]), [WEIGHT])
    assert gap_of(scene, 1, 0) == pytest.approx(0.0003, rel=1e-9)
    assert gap_of(scene, 0, 0) == pytest.approx(0.0003, rel=1e-9)


def test_of_a_hole_through_two_parts_each_has_the_wall() -> None:
    flange = Box((0.06, 0.06, 0.01), Pose((0, 0, -0.005)), "flange")
    barrel = Cylinder(0.02, 0.02, Pose((0, 0, -0.02)), "barrel")
    bore = Hole(0.01, 0.03, in_=["flange", "barrel"], name="bore")
    scene = Scene(held(Cylinder(0.0098, 0.05), start=Pose()), Cage(shapes=[flange, barrel], holes=[bore]), [WEIGHT])
    assert [gap_of(scene, 0, element) for element in range(3)] == pytest.approx([0.0002] * 3, rel=1e-9)


@pytest.mark.parametrize(
    ("part", "place", "gap"),
    [
        (Sphere(0.0095), (0.0, 0.0, -0.01), 0.0005),
        (Sphere(0.0095), (0.0, 0.0, 0.005), math.hypot(0.01, 0.005) - 0.0095),
        (Capsule(0.0095, 0.005), (0.0, 0.0, -0.015), 0.0005),
        (Capsule(0.0095, 0.1), (0.0, 0.0, 0.0), 0.0005),
        (Cylinder(0.0095, 0.01), (0.0, 0.0, -0.015), 0.0005),
        (Cylinder(0.0095, 0.1), (0.0, 0.0, 0.0), 0.0005),
        (Cylinder(0.005, 0.01), (0.0, 0.0, 0.01), math.hypot(0.005, 0.005)),
        (Cylinder(0.015, 0.01), (0.0, 0.0, 0.01), 0.005),
        (Cone(0.005, 0.0095, 0.02), (0.0, 0.0, -0.012), 0.0005),
        (Box((0.012, 0.012, 0.1)), (0.0, 0.0, 0.0), 0.01 - 0.006 * math.sqrt(2.0)),
    ],
)
def test_what_is_exactly_on_the_axis_of_a_hole_is_as_far_from_it_all_around(
    part: Box | AnyShape, place: tuple[float, float, float], gap: float
) -> None:
    """On either side: the part in the hole, and the block with the hole around the part."""
    scene = Scene(held(part, start=Pose(place)), Cage(shapes=[BLOCK], holes=[BORE]), [WEIGHT])
    assert [gap_of(scene, 0, element) for element in (0, 1)] == pytest.approx([gap, gap], rel=1e-9)
    block = Object(
        shapes=[BLOCK],
        holes=[BORE],
        center_of_gravity_m=(0, 0, 0),
        mass_kg=1.0,
        inertia_kg_m2=np.diag((1e-5, 1e-5, 1e-5)),
    )
    around = Scene(block, Cage(shapes=[part], pose=Pose(place)), [WEIGHT])
    assert [gap_of(around, own, 0) for own in (0, 1)] == pytest.approx([gap, gap], rel=1e-9)


def test_a_hole_that_the_part_does_not_face_has_none() -> None:
    """The part is under the block that the blind hole is in."""
    blind = Hole(0.01, 0.01, in_=["block"], name="blind")
    scene = Scene(held(CUBE, start=Pose((0, 0, -0.05))), Cage(shapes=[BLOCK], holes=[blind]), [WEIGHT])
    assert math.isnan(gap_of(scene, 0, 1))
    assert gap_of(scene, 0, 0) == pytest.approx(0.01, rel=1e-12)


def test_of_the_whole_object_and_of_a_body_the_least_gap_counts_where_they_are() -> None:
    jaw = CageBody("jaw", [(0.05, 0, 0)], shapes=[Box((0.01, 0.01, 0.01), Pose((0.04, 0.03, 0)))])
    ball = Box((0.01, 0.01, 0.01), Pose((0, 0.03, 0)), "ear")
    scene = Scene(held(CUBE, ball, start=Pose()), Cage([(0, 0, 0.5)], bodies=[jaw]), [WEIGHT])
    pair = PartGap(scene, [0, 1], [1, 2])
    assert pair.at(at_start(scene)) == pytest.approx(math.hypot(0.025, 0.015), rel=1e-12)
    moved = Instant(Pose(), CageAt(scene.cage, (Pose(), Pose((-0.005, 0.0, 0.0)))), scene.touch_m)
    assert pair.at(moved) == pytest.approx(math.hypot(0.02, 0.015), rel=1e-12)
    assert PartGap(scene, [0, 1], [1]).at(moved) == pytest.approx(0.035, rel=1e-12)


def test_far_apart_is_a_gap_as_any_other() -> None:
    scene = Scene(held(CUBE, start=Pose()), Cage(shapes=[Box((0.1, 0.1, 0.01), Pose((0, 0, -0.015)))]), [WEIGHT])
    assert gap_of(scene, 0, 0, Pose((0, 0, 50.0))) == pytest.approx(50.0, rel=1e-12)

"""The gaps between the object and its cage are exact: by hand, and beside a search that knows nothing of features."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, Hole, Object, Pose, Scene
from cagepose.model.checks import FloatArray
from cagepose.model.facets import Facets
from cagepose.model.shapes import AnyShape, Convex, Cylinder, Sphere
from cagepose.runs.driven_cage import cage_at_start
from cagepose.studies.gaps import GapFinder, Gaps
from cagepose.views.viewer.surface import nearest_on_object
from shaped_scenes import WEIGHT, drawn_shape, held, placed_apart

UP_X = Pose(euler_zyx=(0, math.pi / 2, 0))


def scene_of(own: list[Box | AnyShape], others: list[Box | AnyShape], points: object = (), **extra: object) -> Scene:
    return Scene(held(*own, start=Pose()), Cage(points, shapes=others, **extra), [WEIGHT])  # type: ignore[arg-type]


def gaps_of(scene: Scene, pose: Pose | None = None) -> Gaps:
    return GapFinder(scene).at(pose or scene.object.pose_world_object, cage_at_start(scene.cage))


CUBE = Box((0.02, 0.02, 0.02))
BESIDE = {
    "corner to corner": (CUBE, Box((0.02, 0.02, 0.02), Pose((0.023, 0.024, 0.025))), math.hypot(0.003, 0.004, 0.005)),
    "edge to edge, parallel": (CUBE, Box((0.02, 0.02, 0.05), Pose((0.023, 0.024, 0.0))), 0.005),
    "corner to edge": (
        CUBE,
        Convex([(0.013, 0.014, -1), (0.013, 0.014, 1), (0.1, 0.0141, 0), (0.0131, 0.1, 0)]),
        0.005,
    ),
    "face to face": (CUBE, Box((0.01, 0.03, 0.03), Pose((0.0165, 0.005, 0.0))), 0.0015),
    "ball to corner": (CUBE, Sphere(0.01, Pose((0.02, 0.02, 0.02))), 0.01 * math.sqrt(3.0) - 0.01),
    "round bars across each other": (
        Cylinder(0.01, 0.1),
        Cylinder(0.005, 0.1, Pose((0, 0.018, 0)) @ UP_X),
        0.003,
    ),
    "round bars side by side": (Cylinder(0.01, 0.1), Cylinder(0.005, 0.02, Pose((0, 0.018, 0.01))), 0.003),
    "rim to rim": (Cylinder(0.01, 0.02), Cylinder(0.01, 0.02, Pose((0.023, 0, 0.024))), 0.005),
    "corner to rim": (CUBE, Cylinder(0.01, 0.02, Pose((0.01 + 0.023, 0.01, 0.024))), math.hypot(0.013, 0.004)),
    "farther than the scene is large": (Sphere(0.01), Sphere(0.01, Pose((0.05, 0.0, 0.0))), 0.03),
    "end to plate": (Cylinder(0.01, 0.02), Box((0.1, 0.1, 0.01), Pose((0, 0, -0.017))), 0.002),
}


@pytest.mark.parametrize(("one", "other", "gap"), BESIDE.values(), ids=BESIDE)
def test_two_parts_have_the_gap_that_is_worked_out_by_hand(one, other, gap):
    """Distances along coordinates; the other way round the same."""
    for scene in (scene_of([one], [other]), scene_of([other], [one])):
        found = gaps_of(scene)
        assert found.gaps_m[0] == pytest.approx(gap, rel=1e-12)
        assert math.dist(found.places_world[0], found.others_world[0]) == pytest.approx(gap, rel=1e-12)


def test_parallel_faces_have_one_gap_in_the_middle_of_where_they_face_each_other():
    found = gaps_of(scene_of(list(BESIDE["face to face"][:1]), list(BESIDE["face to face"][1:2])))
    assert len(found.gaps_m) == 1
    assert found.places_world[0] == pytest.approx([0.01, 0.0, 0.0], abs=1e-15)
    assert found.others_world[0] == pytest.approx([0.0115, 0.0, 0.0], abs=1e-15)


def test_a_pin_in_a_hole_has_the_least_and_the_greatest_gap_of_its_play():
    """Play minus and plus how far it is off the axis, at the mouth and at its own end."""
    block = Box((0.06, 0.06, 0.03), Pose((0, 0, -0.015)), "block")
    scene = Scene(
        held(Cylinder(0.0098, 0.05, name="pin"), start=Pose((0.00005, 0.0, 0.01))),
        Cage(shapes=[block], holes=[Hole(0.01, 0.03, in_=["block"], name="bore")]),
        [WEIGHT],
    )
    found = gaps_of(scene)
    bore = found.gaps_m[found.elements == scene.cage.element_names.index("bore")]
    across = bore[bore < 0.001]
    assert sorted(set(across.round(12))) == pytest.approx([0.00015, 0.00025])
    places = found.others_world[found.elements == scene.cage.element_names.index("bore")][bore < 0.001]
    assert np.hypot(*places.T[:2]) == pytest.approx(np.full(len(across), 0.01))


@pytest.mark.parametrize(
    ("part", "height", "gap"),
    [(Sphere(0.0095), -0.01, 0.0005), (Cylinder(0.005, 0.01), 0.01, math.hypot(0.005, 0.005))],
    ids=["a ball in it", "a can over it"],
)
def test_what_is_exactly_on_the_axis_of_a_hole_has_a_gap_to_it(part, height, gap):
    """As wide all around: the wall of the ball, the two edges of the can."""
    block = Box((0.06, 0.06, 0.03), Pose((0, 0, -0.015)), "block")
    cage = Cage(shapes=[block], holes=[Hole(0.01, 0.02, in_=["block"], name="bore")])
    found = gaps_of(Scene(held(part, start=Pose((0.0, 0.0, height))), cage, [WEIGHT]))
    assert cage.element_names[found.elements[0]] == "bore"
    assert found.gaps_m[0] == pytest.approx(gap, rel=1e-12)


def test_a_hole_is_no_part_of_the_plate_that_it_is_in():
    plate = Box((0.1, 0.1, 0.01), name="plate")
    held_plate = Object(
        shapes=[plate],
        holes=[Hole(0.02, 0.01, in_=["plate"], pose_body_shape=Pose((0, 0, 0.005)), name="opening")],
        center_of_gravity_m=(0.03, 0, 0),
        mass_kg=1.0,
        inertia_kg_m2=np.diag((1e-3, 1e-3, 1e-3)),
    )
    found = gaps_of(Scene(held_plate, Cage([(0.005, 0.0, 0.0), (0.0, 0.0, 0.045)]), [WEIGHT]))
    of_first = found.gaps_m[found.elements == 0]
    assert of_first.min() == pytest.approx(0.015, rel=1e-12)  # to the wall
    assert found.gaps_m[found.elements == 1].min() == pytest.approx(math.hypot(0.02, 0.04), rel=1e-12)  # to the mouth


def test_a_body_of_triangles_that_is_not_convex_has_a_gap_for_each_side_of_its_slot():
    corners = [(0, 0), (30, 0), (30, 30), (22, 30), (22, 10), (8, 10), (8, 30), (0, 30)]  # a U
    ears = [(0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4), (0, 5, 6), (0, 6, 7)]
    vertices = [(1e-3 * x, 1e-3 * y, z) for z in (0.0, 0.02) for x, y in corners]
    caps = [(a, c, b) for a, b, c in ears] + [(a + 8, b + 8, c + 8) for a, b, c in ears]
    sides = [t for k in range(8) for j in [(k + 1) % 8] for t in ((k, j, j + 8), (k, j + 8, k + 8))]
    tongue = Box((0.013, 0.01, 0.01), Pose((0.0148, 0.0171, 0.01)), "tongue")
    found = gaps_of(scene_of([tongue], [Facets(vertices, caps + sides, name="slot")]))
    assert found.gaps_m[:3] == pytest.approx([0.0003, 0.0007, 0.0021], rel=1e-9)


def test_nothing_is_measured_through_a_part():
    """Of a wall and what is behind it, both faces of the wall have a gap, and what is behind has none to the front."""
    wall, behind = (
        Box((0.001, 0.2, 0.2), Pose((0.0125, 0, 0)), "wall"),
        Box((0.01, 0.01, 0.01), Pose((0.03, 0, 0)), "far"),
    )
    found = gaps_of(scene_of([CUBE], [wall, behind]))
    assert set(found.elements.tolist()) == {0}
    assert found.gaps_m == pytest.approx([0.002], rel=1e-12)


def test_what_touches_has_no_gap_at_all():
    found = gaps_of(scene_of([CUBE], [Box((0.1, 0.1, 0.01), Pose((0, 0, -0.015)), "table")]))
    assert set(found.gaps_m.tolist()) == {0.0}


def ball_of_triangles(radius: float, place: tuple[float, float, float], name: str) -> Facets:
    """Of 64 rings of 64 corners, turned about so that no corners of two balls face each other."""
    heights = np.linspace(-1.0, 1.0, 66)[1:-1]
    around = np.linspace(0.0, 2.0 * math.pi, 65)[:-1]
    across = np.sqrt(1.0 - heights**2)[:, None]
    rings = np.stack(np.broadcast_arrays(across * np.cos(around), across * np.sin(around), heights[:, None]), axis=2)
    corners = np.concatenate([rings.reshape(-1, 3), [(0, 0, -1), (0, 0, 1)]]) * radius
    triangles = []
    for side in range(64):
        beside = (side + 1) % 64
        triangles += [(4096, beside, side), (4097, 4032 + side, 4032 + beside)]
        for low in range(0, 4032, 64):
            one, other = low + side, low + beside
            triangles += [(one, other, other + 64), (one, other + 64, one + 64)]
    return Facets(corners, triangles, pose_body_shape=Pose(place, euler_zyx=(0.3, 0.2, 0.1)), name=name)


def test_of_bodies_of_thousands_of_triangles_the_narrowest_gap_is_told():
    """There are too many pairs to ask all that are as near; the balls are convex, so the other search can be asked."""
    scene = scene_of(
        [ball_of_triangles(0.02, (0, 0, 0), "one")], [ball_of_triangles(0.03, (0.04, 0.03, 0.02), "other")]
    )
    near = nearest_on_object(scene.object, scene.object.pose_world_object, cage_at_start(scene.cage))
    least = float(np.linalg.norm(near.places_world - near.feet_world))
    assert 0.002 < least < 0.006
    assert gaps_of(scene).gaps_m[0] == pytest.approx(least, rel=1e-9)


def least_of_each(found: Gaps, n_elements: int) -> FloatArray:
    least = np.full(n_elements, np.inf)
    np.minimum.at(least, found.elements, found.gaps_m)
    return least


def is_in_the_way(scene: Scene, element: int, one: FloatArray, other: FloatArray) -> bool:
    """Whether another shape of the cage is between two places."""
    between = one + np.linspace(0.0, 1.0, 1_000)[:, None] * (other - one)
    first = len(scene.cage.names)
    return any(shape.holds(between).any() for at, shape in enumerate(scene.cage.shapes, first) if at != element)


def test_the_narrowest_gap_is_the_distance_that_a_search_without_features_finds(cases, say):
    """Drawn convex parts about each other, by the method of Gilbert, Johnson and Keerthi."""
    random, n_asked, worst = np.random.default_rng(7), 0, 0.0
    for _ in range(cases(15, 600)):
        own = [placed_apart(random, drawn_shape(random), random.uniform(0.0, 0.01)) for _ in range(2)]
        others = [placed_apart(random, drawn_shape(random), random.uniform(0.075, 0.1)) for _ in range(3)]
        points = random.normal(size=(2, 3))
        points *= 0.06 / np.linalg.norm(points, axis=1)[:, None]
        scene = scene_of(own, others, points)
        at, pose = cage_at_start(scene.cage), scene.object.pose_world_object
        near = nearest_on_object(scene.object, pose, at)
        told = np.linalg.norm(near.places_world - near.feet_world, axis=1)
        found = gaps_of(scene)
        least = least_of_each(found, len(told))
        assert found.gaps_m[0] == pytest.approx(told.min(), rel=1e-9)
        for element, (one, other) in enumerate(zip(near.feet_world, near.places_world, strict=True)):
            if is_in_the_way(scene, element, one, other):
                assert least[element] > told[element]
                continue
            error = abs(least[element] - told[element]) / told[element]
            worst, n_asked = max(worst, error), n_asked + 1
            assert error < 1e-8
    say(f"{n_asked} gaps, off by {worst:.1e} of themselves at most")


def test_gaps_do_not_hang_on_where_the_scene_is():
    shape, other = drawn_shape(np.random.default_rng(3)), Box((0.1, 0.1, 0.01), Pose((0, 0, -0.05)), "table")
    scene = scene_of([shape], [other])
    moved = Pose((0.3, -0.2, 0.5), euler_zyx=(0.4, -1.1, 2.0))
    elsewhere = Scene(
        Object(
            shapes=[shape],
            center_of_gravity_m=(0, 0, 0),
            mass_kg=1.0,
            inertia_kg_m2=np.diag((1e-5, 2e-5, 3e-5)),
            pose=moved,
        ),
        Cage(shapes=[other], pose=moved),
        [WEIGHT],
    )
    assert gaps_of(elsewhere).gaps_m == pytest.approx(gaps_of(scene).gaps_m, rel=1e-9)

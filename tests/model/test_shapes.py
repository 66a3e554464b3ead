"""Shapes: what they refuse, their names in a body, and how far they reach."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    Capsule,
    Cone,
    Convex,
    Cylinder,
    Disc,
    Hole,
    Load,
    Object,
    Pose,
    Scene,
    SceneError,
    Sphere,
)
from cagepose.model.geometry import object_size, scene_size
from cagepose.model.shapes import Shape

DOWN = Load("gravity", gravity=(0, 0, -1))
FAR = [(50, 50, 50), (50, -50, 50), (-50, 0, -50)]
TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
GIVEN = {"center_of_gravity_m": (0, 0, 0), "mass_kg": 1.0, "inertia_kg_m2": np.eye(3)}


@pytest.mark.parametrize(
    ("make", "problem"),
    [
        (lambda: Sphere(-1.0), "radius: is -1.0; give a finite number of metres, above zero"),
        (lambda: Sphere(0), "radius: is 0; give a finite number of metres, above zero"),
        (lambda: Sphere(np.float64("nan")), "radius: is nan; give a finite number of metres, above zero"),
        (lambda: Sphere("3"), "radius: is '3'; give a finite number of metres, above zero"),
        (lambda: Sphere(True), "radius: is True; give a finite number of metres, above zero"),
        (lambda: Sphere(1.0, (0, 0, 1)), "pose: is (0, 0, 1); give a cagepose.Pose: cagepose.Pose((0, 0, 1))"),
        (lambda: Capsule(1.0, 0.0), "length: is 0.0; give a finite number of metres, above zero"),
        (lambda: Cylinder(math.inf, 1.0), "radius: is inf; give a finite number of metres, above zero"),
        (lambda: Cylinder(1.0, -2.0), "length: is -2.0; give a finite number of metres, above zero"),
        (lambda: Disc(0.0), "radius: is 0.0; give a finite number of metres, above zero"),
        (lambda: Cone(1.0, -0.5, 1.0), "radius_top: is -0.5; give a finite number of metres, zero or above"),
        (
            lambda: Cone(0.0, 0.0, 1.0),
            "radius_bottom: is zero like radius_top, which leaves a line; give one of them above zero",
        ),
        (lambda: Convex([]), "vertices: has shape (0,); give n x 3 numbers"),
        (lambda: Convex([(0, 0), (1, 0)]), "vertices: has shape (2, 2); give n x 3 numbers"),
        (lambda: Convex(TETRAHEDRON, -1e-3), "radius: is -0.001; give a finite number of metres, zero or above"),
        (
            lambda: Convex([(0, 0, 0)]),
            "vertices: are a single point, which has no volume; add a vertex elsewhere, or give the shape a radius",
        ),
        (
            lambda: Convex([(0, 0, 0), (1, 1, 1), (2, 2, 2)]),
            "vertices: lie on one line, so they have no volume; add a vertex elsewhere, or give the shape a radius",
        ),
        (
            lambda: Convex([(0, 0, 1), (1, 0, 1), (0, 1, 1), (1, 1, 1)]),
            "vertices: lie in one plane, so they have no volume; add a vertex elsewhere, or give the shape a radius",
        ),
        (lambda: Object(shapes=[]), "has neither boxes nor shapes; give at least one of them"),
        (lambda: Object(shapes=Sphere(1.0)), "shapes: is of type Sphere; give a list of cagepose.Shape"),
        (lambda: Object([Sphere(1.0)]), "boxes[0]: is of type Sphere; give a cagepose.Box"),
        (
            lambda: Object(shapes=[Sphere(1, name="a"), Box((1, 1, 1), name="a")], **GIVEN),
            "shapes[0].name: 'a' is already the name of shapes[1]; rename one",
        ),
        (
            lambda: Object([Box((1, 1, 1), name="a")], shapes=[Sphere(1, name="a")], **GIVEN),
            "shapes[0].name: 'a' is already the name of boxes[0]; rename one",
        ),
        (lambda: Cage(), "has neither points nor shapes; give at least one of them"),
        (
            lambda: Cage([(0, 0, 0)], shapes=[Sphere(1.0, name="C1")]),
            "shapes[0].name: 'C1' is already the name of points.C1; rename one",
        ),
        (
            lambda: Cage(shapes=[Sphere(1.0, name="a"), Disc(1.0, name="a")]),
            "shapes[1].name: 'a' is already the name of shapes[0]; rename one",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_place_and_a_remedy(make, problem):
    with pytest.raises(SceneError) as caught:
        make()
    assert [str(found) for found in caught.value.problems] == [problem]


def test_a_box_among_the_shapes_is_a_box_and_unnamed_ones_get_their_kind_and_number():
    held = Object(
        [Box((1, 1, 1))],
        shapes=[Cylinder(1, 2), Box((2, 2, 2)), Sphere(1), Cylinder(2, 2), Cylinder(3, 3, name="pin"), Box((3, 3, 3))],
        **GIVEN,
    )
    assert [part.name for part in held.boxes] == ["box1", "box2", "box3"]
    assert [part.name for part in held.shapes] == ["cylinder1", "sphere1", "cylinder2", "pin"]
    assert held.parts == held.boxes + held.shapes
    assert held.part_paths[:3] == (("boxes", 0), ("shapes", 1, "box"), ("shapes", 5, "box"))
    cage = Cage([(0, 0, 9)], shapes=[Box((1, 1, 1)), Capsule(1, 2), Box((1, 1, 1), name="floor")])
    assert cage.element_names == ("C1", "box1", "capsule1", "floor")


@pytest.mark.parametrize(
    "shape",
    [Box((1, 2, 3)), Capsule(1, 2), Cone(1, 2, 3), Convex(TETRAHEDRON), Hole(1, 2)],
    ids=lambda shape: shape.kind,
)
def test_a_shape_that_is_moved_says_where_it_is_then_and_the_first_where_it_was(shape: Shape) -> None:
    nodes, limits = shape.nodes_body().copy(), shape.limits_m().copy()
    travel = np.array((5.0, 6.0, 7.0))
    moved = shape.moved(Pose(travel))
    assert moved.nodes_body() == pytest.approx(nodes + travel)
    assert moved.limits_m() == pytest.approx(limits + travel)
    assert np.array_equal(shape.nodes_body(), nodes)
    assert np.array_equal(shape.limits_m(), limits)
    assert shape.renamed("other").limits_m() == pytest.approx(limits)
    with pytest.raises(ValueError, match="read-only"):
        shape.nodes_body()[0, 0] = 1.0


def test_vertices_within_the_hull_and_cones_of_two_equal_radii_do_no_harm():
    shape = Convex([*TETRAHEDRON, (0.1, 0.1, 0.1), (0, 0, 0)])
    assert len(shape.vertices_m) == 6
    assert shape.core().tolist() == np.array(TETRAHEDRON, dtype=float).tolist()
    assert Cone(1.0, 1.0, 2.0).rims == Cylinder(1.0, 2.0).rims
    for vertices, dimension in (([(1, 2, 3)], 0), ([(0, 0, 0), (1, 1, 1), (2, 2, 2)], 1), (TETRAHEDRON[:3], 2)):
        assert Convex(vertices, 0.1).hull.dimension == dimension


def material_points(shape, rng):
    """Points of the shape's surface in the body's frame, the farthest of any direction among them nearly."""
    directions = rng.normal(size=(20_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    if isinstance(shape, Box):
        local = np.sign(directions) * shape.size_m / 2.0
    elif hasattr(shape, "rims"):
        around = directions[:, :2] / np.linalg.norm(directions[:, :2], axis=1, keepdims=True)
        local = np.concatenate([np.insert(around * radius, 2, height, axis=1) for height, radius in shape.rims])
    else:
        local = (shape.core()[:, None] + shape.radius_m * directions).reshape(-1, 3)
    return shape.pose_body_shape.transform(local)


@pytest.mark.parametrize("seed", range(8))
def test_reach_and_size_are_those_of_the_material(seed):
    rng = np.random.default_rng(seed)

    def pose():
        return Pose(rng.normal(size=3), rng.normal(size=4))

    everything = [
        Sphere(0.5, pose()),
        Capsule(0.3, 2.0, pose()),
        Cylinder(0.7, 1.5, pose()),
        Cone(0.9, 0.2, 1.0, pose()),
        Convex(rng.normal(size=(9, 3)), 0.1, pose()),
        Disc(1.2, pose()),
        Box((1, 2, 3), pose()),
    ]
    for shapes in ([rng.choice(np.array(everything, dtype=object))], everything):
        held = Object(shapes=shapes, **(GIVEN | {"center_of_gravity_m": rng.normal(size=3)}))
        points = np.concatenate([material_points(shape, rng) for shape in shapes])
        reach_m = np.linalg.norm(points - held.center_of_gravity_m, axis=1).max()
        assert reach_m <= held.reach_m * (1.0 + 1e-12)
        assert reach_m == pytest.approx(held.reach_m, rel=1e-3)
        nodes = np.concatenate([part.nodes_body() for part in held.parts])
        size_m = 2.0 * np.linalg.norm(points - nodes.mean(axis=0), axis=1).max()
        assert size_m <= object_size(held) * (1.0 + 1e-12)
        assert size_m == pytest.approx(object_size(held), rel=1e-3)
        assert scene_size(held, Cage(shapes=shapes)) == object_size(held)


def test_thin_shapes_starts_far_away_and_friction_of_unknown_names_are_refused():
    thin = Object(shapes=[Sphere(1), Cylinder(1.0, 1e-9, name="foil")], **GIVEN)
    cage = Cage(FAR, shapes=[Box((1, 1, 1e-9), Pose((0, 0, -60))), Convex([(0, 0, 50), (1, 0, 50)], 1e-10)])
    with pytest.raises(SceneError) as caught:
        Scene(thin, cage, [DOWN], friction_of={"foil": 0.3, "box1": 0.2, "C1": 0.1, "box7": 0.1, "sphere1": -1.0})
    places = [str(problem).split(":")[0] for problem in caught.value.problems]
    assert places == [
        "friction.of.box7",
        "friction.of.sphere1",
        "object.shapes[1].cylinder.length",
        "cage.shapes[0].box.size[2]",
        "cage.shapes[1].convex.radius",
    ]
    with pytest.raises(SceneError, match=r"object.pose.position: starts 1e\+10 mm from the cage"):
        Scene(Object(shapes=[Sphere(1)], pose=Pose((0, 0, 1e7)), **GIVEN), Cage(shapes=[Sphere(1)]), [DOWN])


def test_a_start_inside_a_shape_is_told_at_the_shape() -> None:
    wall = Box((1.0, 1.0, 0.1), Pose((0.0, 0.0, 0.0)))
    held = Object(shapes=[Sphere(0.2)], pose=Pose((0.0, 0.0, 0.1)))
    with pytest.raises(SceneError) as caught:
        Scene(held, Cage(shapes=[Sphere(0.1, Pose((3.0, 0.0, 0.0))), wall]), [Load("weight", gravity=(0.0, 0.0, -1.0))])
    (problem,) = caught.value.problems
    assert problem.path == ("cage", "shapes", 1)
    assert problem.message.startswith("box1 starts 150 mm inside object.shapes[0] (sphere1)")

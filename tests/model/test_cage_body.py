"""Bodies of a cage: where their elements stand among those of the whole cage, and what is refused of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    CageBody,
    Cylinder,
    Facets,
    Hole,
    Load,
    Object,
    Pose,
    Scene,
    SceneError,
    Sphere,
    Spring,
    Variation,
)
from cagepose.kernels.boundary.features import features_of
from cagepose.kernels.boundary.geometry import empty_placement, meetings_with, place_object
from cagepose.model.boundary.features import boundary_of
from cagepose.model.geometry import cage_bodies
from cagepose.model.pose import quaternions_of
from cagepose.model.scope import unknown_shapes
from cagepose.runs.actions import cage_middle, cage_middles, spring_ends

QUARTER = Pose((0.3, 0.0, 0.0), euler_zyx=(np.pi / 2, 0.0, 0.0))
CUBE = Object([Box((0.2, 0.2, 0.2))])
WEIGHT = Load("weight", gravity=(0, 0, -1))


def block(name: str | None = None) -> Box:
    return Box((0.1, 0.2, 0.1), Pose((0.0, 0.3, 0.0)), name)


def mixed() -> Cage:
    bore = Hole(0.01, 0.05, None, ["bored"], Pose((0.0, 0.3, 0.05)))
    mate = CageBody("mate", [(0.1, 0, 0)], ["pin"], QUARTER, [block("bored"), bore])
    jaw = CageBody("jaw", [(0, -0.5, 0), (0.1, -0.5, 0)], shapes=[Sphere(0.05, Pose((0.0, -0.4, 0.0)))])
    lone = Hole(0.05, 0.1, None, (), Pose((0.0, 0.0, -0.5)))
    return Cage([(0, 0, -0.2)], shapes=[lone, Sphere(0.01, Pose((0.0, 0.0, 0.3)))], bodies=[mate, jaw])


def test_what_stands_still_comes_first_and_bodies_follow_where_they_start() -> None:
    cage = mixed()
    assert cage.names == ("C1", "pin", "jaw/C1", "jaw/C2")
    assert cage.element_names == (*cage.names, "sphere1", "bored", "jaw/sphere1", "hole1", "mate/hole1")
    assert cage.element_bodies == (0, 1, 2, 2, 0, 1, 2, 0, 1)
    assert cage.points_cage[1] == pytest.approx([0.3, 0.1, 0.0])
    bored, bore = cage.shapes[1].pose_body_shape, cage.holes[1].pose_body_shape
    assert bored.position_m == pytest.approx([0.0, 0.0, 0.0])
    assert bore.position_m == pytest.approx([0.0, 0.0, 0.05])
    assert bored.rotation == pytest.approx(QUARTER.rotation)
    assert cage.element_paths == (
        ("points", "C1"),
        ("bodies", "mate", "points", "pin"),
        ("bodies", "jaw", "points", "jaw/C1"),
        ("bodies", "jaw", "points", "jaw/C2"),
        ("shapes", 1),
        ("bodies", "mate", "shapes", 0),
        ("bodies", "jaw", "shapes", 0),
        ("shapes", 0),
        ("bodies", "mate", "shapes", 1),
    )
    assert cage.shape_paths[1:3] == (("bodies", "mate", "shapes", 0, "box"), ("bodies", "jaw", "shapes", 0, "sphere"))
    assert (cage.standing.names, [body.name for body in cage.bodies]) == (("C1",), ["mate", "jaw"])
    assert repr(cage) == "<Cage: 4 points, 3 shapes, 2 holes, 2 bodies>"
    assert repr(cage.bodies[0]) == "<CageBody 'mate': 1 point, 1 shape, 1 hole>"


def test_a_body_without_a_pose_starts_where_its_numbers_say() -> None:
    here = Cage(bodies=[CageBody("jaw", [(0.1, 0.2, 0.3)], shapes=[block()])])
    assert here.points_cage.tolist() == [[0.1, 0.2, 0.3]]
    assert here.shapes[0].pose_body_shape.position_m.tolist() == [0.0, 0.3, 0.0]
    assert here.element_names == ("jaw/C1", "jaw/box1")


WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "a name that is none": (lambda: CageBody(5, [(0, 0, 0)]), "name: is 5; give text"),  # type: ignore[arg-type]
    "no pose": (lambda: CageBody("jaw", [(0, 0, 0)], pose=(0, 0, 1)), "pose: is (0, 0, 1); give a cagepose.Pose"),  # type: ignore[arg-type]
    "too few names": (lambda: CageBody("jaw", [(0, 0, 0)], ["A", "B"]), "names: holds 2 names for 1 point"),
    "a hole in what is of the cage": (
        lambda: Cage(shapes=[block("wall")], bodies=[CageBody("jaw", shapes=[Hole(0.01, 0.01, None, ["wall"])])]),
        "shapes[0].hole.in[0]: is 'wall', no box or shape of this body",
    ),
    "a hole in what is of a body": (
        lambda: Cage(shapes=[Hole(0.01, 0.01, None, ["wall"])], bodies=[CageBody("jaw", shapes=[block("wall")])]),
        "shapes[0].hole.in[0]: is 'wall', no box or shape of this body",
    ),
    "a body in no list": (
        lambda: Cage(bodies=CageBody("jaw", [(0, 0, 0)])),  # type: ignore[arg-type]
        "bodies: is of type CageBody; give a list of cagepose.CageBody",
    ),
    "two bodies of a name": (
        lambda: Cage(bodies=[CageBody("jaw", [(0, 0, 0)]), CageBody("jaw", [(1, 0, 0)])]),
        "bodies.jaw: is the name of 2 bodies; rename all but one",
    ),
    "a body called as a point": (
        lambda: Cage([(0, 0, 0)], ["jaw"], bodies=[CageBody("jaw", [(1, 0, 0)])]),
        "points.jaw: 'jaw' is already the name of bodies.jaw; rename one",
    ),
    "points of two bodies": (
        lambda: Cage(bodies=[CageBody("one", [(0, 0, 0)], ["tip"]), CageBody("two", [(1, 0, 0)], ["tip"])]),
        "bodies.two.points.tip: 'tip' is already the name of bodies.one.points.tip; rename one",
    ),
    "a shape of a body called as one that stands still": (
        lambda: Cage(shapes=[block("pad")], bodies=[CageBody("jaw", shapes=[block("pad")])]),
        "bodies.jaw.shapes[0].name: 'pad' is already the name of shapes[0]; rename one",
    ),
    "a body in the part": (
        lambda: Scene(CUBE, Cage(bodies=[CageBody("jaw", shapes=[Sphere(0.05, Pose((0.14, 0, 0)))])]), [WEIGHT]),
        "cage.bodies.jaw.shapes[0]: jaw/sphere1 starts 10 mm inside object.boxes[0] (box1); move it out or move",
    ),
    "a point of a body in the part, beside shapes": (
        lambda: Scene(
            CUBE,
            Cage(shapes=[Sphere(0.1, Pose((0, 0, 1)))], bodies=[CageBody("jaw", [(0.09, 0, 0)], ["tip"])]),
            [WEIGHT],
        ),
        "cage.bodies.jaw.points.tip: starts 10 mm inside object.boxes[0] (box1); move the point out",
    ),
    "a point of a body in the part, alone": (
        lambda: Scene(CUBE, Cage(bodies=[CageBody("jaw", [(0.09, 0, 0)])]), [WEIGHT]),
        "cage.bodies.jaw.points.jaw/C1: starts 10 mm inside object.boxes[0] (box1); move the point out",
    ),
    "two points of a body at one place": (
        lambda: Scene(CUBE, Cage(bodies=[CageBody("jaw", [(1, 0, 0), (1, 0, 0)])]), [WEIGHT]),
        "cage.bodies.jaw.points.jaw/C2: lies 0 mm from jaw/C1, so they are one point",
    ),
    "too thin": (
        lambda: Scene(CUBE, Cage(bodies=[CageBody("jaw", shapes=[Box((1, 1, 1e-12), Pose((0, 0, 1)))])]), [WEIGHT]),
        "cage.bodies.jaw.shapes[0].box.size[2]: is 1e-09 mm, too thin",
    ),
}


@pytest.mark.parametrize("case", WRONG.values(), ids=WRONG.keys())
def test_what_no_body_can_be_is_refused_with_its_place(case: tuple[Callable[[], object], str]) -> None:
    make, told = case
    with pytest.raises(SceneError) as refused:
        make()
    assert told in str(refused.value)
    assert len(refused.value.problems) == 1


def test_points_of_two_bodies_may_be_at_one_place() -> None:
    Scene(CUBE, Cage([(1, 0, 0)], bodies=[CageBody("jaw", [(1, 0, 0)])]), [WEIGHT])


def test_parts_have_the_numbers_of_the_whole_cage_and_know_their_body() -> None:
    cage = mixed()
    bodies = cage_bodies(cage, 1e-9)
    parts, features = np.asarray(bodies.own.parts), np.asarray(bodies.own.features)
    assert tuple(parts["body"].tolist()) == cage.element_bodies
    middles = [*cage.points_cage, *(shape.pose_body_shape.position_m for shape in cage.shapes)]
    assert parts["middle"][: len(middles)] == pytest.approx(np.array(middles))
    for number in range(len(cage.names)):
        assert features["part"][parts["point"][number]] == number
    assert (parts["point"][len(cage.names) :] == -1).all()
    for body in range(3):
        first, last = features_of(bodies.own._replace(nodes=bodies.own.nodes[bodies.first_nodes[body] :]))
        assert (parts["body"][features["part"][first:last]] == body).all()


def test_what_touches_is_told_by_the_numbers_of_the_whole_cage() -> None:
    """A cube on a floor that stands still, between a body's two points and another body's roller."""
    touching = [CageBody("pins", [(0.1, 0.05, 0.0), (0.1, -0.05, 0.0)]), CageBody("roll", shapes=[Sphere(0.1)])]
    away = Pose((-0.2, 0.0, 0.0))
    touching[1] = CageBody("roll", pose=away, shapes=[Cylinder(0.1, 0.05)])
    floor = Box((1.0, 1.0, 0.1), Pose((0.0, 0.0, -0.15)), "floor")
    for shapes in ([floor], []):
        cage = Cage([(0.0, 0.0, 0.5)] if shapes else (), shapes=shapes, bodies=touching, pose=QUARTER)
        held = Object([Box((0.2, 0.2, 0.2))], pose=QUARTER)
        geometry = Scene(held, cage, [WEIGHT]).geometry
        placement = empty_placement(geometry)
        place_object(geometry, *QUARTER.as_tuples(), placement)
        found = []
        for body in range(3):
            meetings = meetings_with(placement, body)
            touched = meetings.rows["cage_feature"][: meetings.used[0]]  # type: ignore[call-overload]
            parts = np.asarray(geometry.cage.own.features)["part"][touched]
            found.append({cage.element_names[part] for part in parts.tolist()})
        assert found == [{"floor"} if shapes else set(), {"pins/C1", "pins/C2"}, {"roll/cylinder1"}]


def test_a_body_without_parts_has_a_boundary_without_features() -> None:
    nothing = boundary_of((), 1e-9)
    assert (len(nothing.parts), len(nothing.features), features_of(nothing)) == (0, 0, (0, 0))
    assert [node["left"] for node in np.asarray(nothing.nodes)] == [-1, -1, -1]


def test_the_middle_is_that_of_what_stands_still() -> None:
    cage = mixed()
    alone = Scene(CUBE, Cage(cage.standing.points_m, shapes=cage.standing.shapes, holes=cage.standing.holes), [WEIGHT])
    held = Object([Box((0.2, 0.2, 0.2))], pose=Pose((0.0, 2.0, 0.0)))
    whole = Scene(held, cage, [WEIGHT])
    assert np.array_equal(cage_middle(whole), cage_middle(alone))
    moved = whole.cage.points_cage + np.array([[0.3], [1.0], [1.0], [1.0]])[None]
    row = Pose().position_m[None], Pose().quaternion_wxyz[None]
    middle = (cage.points_cage[0] + 0.3 + cage.shapes[0].pose_body_shape.position_m + [0.0, 0.0, -0.55]) / 3
    assert cage_middles(whole, moved, *row)[0] == pytest.approx(middle)


def test_where_nothing_stands_still_the_middle_is_the_cages_origin() -> None:
    cage = Cage(bodies=[CageBody("jaw", [(0.2, 0, 0)])], pose=QUARTER)
    scene = Scene(Object([Box((0.1, 0.1, 0.1))]), cage, [WEIGHT])
    assert cage_middle(scene).tolist() == QUARTER.position_m.tolist()


def test_a_spring_ends_in_the_world_or_rides_on_a_body() -> None:
    cage = Cage(bodies=[CageBody("jaw", [(0.2, 0, 0)], pose=Pose((0.1, 0.0, 0.0)))], pose=QUARTER)
    still, riding = Spring((0, 0, 0), (0, 0, 1), 1.0), Spring((0, 0, 0), (0.5, 0, 1), 1.0, of="jaw")
    assert cage.spring_end_world(still).tolist() == [0, 0, 1]
    assert cage.spring_end_world(riding) == pytest.approx([0.3, 0.6, 1.0])
    scene = Scene(Object([Box((0.1, 0.1, 0.1))], mass_kg=1.0), cage, [Load("hang", springs=[still, riding])])
    turned = quaternions_of(np.array([(np.pi / 2, 0.0, 0.0), (0.0, 0.0, 0.0)]))
    ends = spring_ends(scene, riding, np.array([(0.3, 0.0, 0.0), (0.0, 0.0, 1.0)]), turned)
    assert ends == pytest.approx(np.array([(0.3, 0.6, 1.0), (0.6, 0.0, 2.0)]))


def test_points_of_bodies_vary_as_all_points_do() -> None:
    scene = Scene(CUBE, Cage([(0, 0, -0.2)], bodies=[CageBody("jaw", [(0.2, 0, 0)])]), [WEIGHT])
    rows = np.repeat(scene.cage.points_cage[None], 3, axis=0)
    n_rows, columns = Variation(points_cage_m=rows).columns(scene)
    assert n_rows == 3
    assert columns["points_cage_m"].shape == (3, 2, 3)
    with pytest.raises(SceneError, match="points_cage_m"):
        Variation(points_cage_m=rows[:, :1]).columns(scene)


def test_facets_of_one_body_are_no_part_of_another() -> None:
    """No method runs a ball that touches facets of its own body."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    facets = Facets(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], pose_body_shape=Pose((0.2, 0.2, 0.2)))
    ball = Sphere(0.05, Pose((0.2, 0.2, 0.2)))
    together, apart = CageBody("jaw", shapes=[facets, ball]), [CageBody("jaw", shapes=[facets])]
    (problem,) = unknown_shapes(Scene(CUBE, Cage(bodies=[together]), [WEIGHT]))
    assert problem.path == ("cage", "bodies", "jaw", "shapes", 1)
    assert unknown_shapes(Scene(CUBE, Cage(shapes=[ball], bodies=apart), [WEIGHT])) == []

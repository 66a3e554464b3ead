"""Cages of true shapes, proven by points within them: rollers, pins and walls, random solids, and holes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from audit.caged_families import caged
from cagepose import (
    Box,
    Cage,
    Capsule,
    Cone,
    Convex,
    Cylinder,
    Hole,
    Load,
    Object,
    Pose,
    Scene,
    SceneError,
    Shape,
    Sphere,
    play,
)
from cagepose.model.shapes import Rounded
from cagepose.studies.bounds import Bounds
from cagepose.studies.inner_cage import inner_scene
from cagepose.studies.play_frame import PlayFrame, range_goals
from cagepose.studies.pushed_play import PushedPlay
from cagepose.studies.pushes import unseated

MM = 1e-3
DOWN = (Load("weight", gravity=(0, 0, -1)),)
LYING = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)


def bar_in_its_slide(stops: bool) -> Scene:
    """A bar of 200 x 40 x 40 mm: 0.25 mm to four rollers, 0.2 mm to four pins, 0.3 mm to two stops."""
    shapes: list[Shape] = [
        Capsule(8 * MM, 80 * MM, Pose(np.array([x, 0, z]) * MM, LYING)) for x in (-90, 90) for z in (-28.25, 28.25)
    ]
    shapes += [
        Cylinder(6 * MM, 30 * MM, Pose(np.array([x, y, 0]) * MM)) for x in (-60, 60) for y in (-26.2, 26.2)
    ]  # fmt: skip
    if stops:
        shapes += [Box(np.array([20, 80, 80]) * MM, Pose(np.array([x, 0, 0]) * MM)) for x in (-110.3, 110.3)]
    return Scene(Object([Box(np.array([200, 40, 40]) * MM)]), Cage(shapes=shapes), DOWN)


def test_a_bar_among_rollers_pins_and_stops_is_caged_within_bounds_as_near_as_those_of_points():
    found = play(bar_in_its_slide(stops=True))
    assert found.verdict == "caged"
    for ends in found.freedoms.values():
        for end in (ends.low, ends.high):
            assert abs(end.reached) <= abs(end.certified) <= 1.05 * abs(end.reached)
    along = found.freedoms["x"]
    assert (along.low.reached, along.high.reached) == pytest.approx((-0.3 * MM, 0.3 * MM), abs=1e-12)
    assert along.low.status == along.high.status == "proven"


def test_without_its_stops_it_is_not():
    found = play(bar_in_its_slide(stops=False), search_s=0.0)
    assert found.verdict == "escapes"
    assert found.freedoms["z"].high.certified is None


def box_under_a_lid(hole_mm: float | None) -> Scene:
    """A cube of 10 mm amid four walls, on a floor and under a lid, 0.2 mm away each; a hole in the lid over it."""
    walls = [
        Box(np.where(axis, 10, 40) * MM, Pose(side * 10.2 * MM * axis), f"wall {number} {side}")
        for number, axis in enumerate(np.eye(3)[:2])
        for side in (-1, 1)
    ]
    floor, lid = (
        Box(np.array([40, 40, 10]) * MM, Pose((0, 0, side * 10.2 * MM)), name)
        for name, side in (("floor", -1), ("lid", 1))
    )
    holes = [Hole(hole_mm * MM, 10 * MM, in_=["lid"], pose_body_shape=Pose((0, 0, 15.2 * MM)))] if hole_mm else []
    return Scene(Object([Box((10 * MM,) * 3)]), Cage(shapes=[*walls, floor, lid], holes=holes), DOWN)


def test_a_wall_with_a_hole_holds_nothing():
    """The cube leaves by a hole of 8 mm radius; in a closed chamber it is caged, and all six ends are proven."""
    closed = play(box_under_a_lid(None))
    assert closed.verdict == "caged"
    assert play(box_under_a_lid(8.0), search_s=0.0).verdict == "escapes"
    scene = inner_scene(box_under_a_lid(8.0))
    assert not [name for name in scene.cage.names if name.startswith("lid")]
    assert [name for name in scene.cage.names if name.startswith("floor")]


def in_a_chamber(*more: Shape, but: str = "", points: dict[str, tuple[float, float, float]] | None = None) -> Scene:
    """The cube of `box_under_a_lid` in its closed chamber, with more shapes and points and without one of its walls."""
    walls = [shape for shape in box_under_a_lid(None).cage.shapes if shape.name != but]
    places = points or {}
    cage = Cage(list(places.values()), list(places), shapes=[*walls, *more])
    return Scene(Object([Box((10 * MM,) * 3)]), cage, DOWN)


def test_walls_that_overlap_and_names_of_points_that_are_taken_are_no_error():
    """Points over one face that are made of two walls are one; a point may have the name of a made one."""
    again = Box(np.array([40, 40, 20]) * MM, Pose((0, 0, -15.2 * MM)), "again")
    corner = 0.98 * 5 * MM
    for scene in (
        in_a_chamber(again),
        in_a_chamber(points={"floor 1": (30 * MM, 0, 30 * MM)}),
        in_a_chamber(points={"pin": (corner, corner, -5.2 * MM)}),
    ):
        found = play(scene, search_s=0.0)
        assert found.verdict == "caged"
        assert found.freedoms["z"].low.reached == pytest.approx(-0.2 * MM, abs=1e-9)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("euler_zyx", [(0, 0, 0), (0.3, math.pi, 0.1)])
def test_a_cone_with_a_tip_holds(euler_zyx):
    radii = (0.0, 5 * MM) if euler_zyx[1] else (5 * MM, 0.0)
    cone = Cone(*radii, 10 * MM, Pose((0, 0, -10.2 * MM), euler_zyx=euler_zyx))
    assert play(in_a_chamber(cone, but="floor"), search_s=0.0).verdict == "caged"


def test_a_wall_too_far_away_for_a_scene_of_points_proves_nothing():
    cage = Cage(shapes=[Box((10, 40, 40), Pose((25, 0, 0)), "wall")])
    scene = Scene(Object([Box((1 * MM,) * 3)]), cage, DOWN)
    assert inner_scene(scene) is None
    assert play(scene, search_s=0.0).verdict == "escapes"


def test_a_box_of_the_object_with_a_hole_does_not_count():
    scene = bar_in_its_slide(stops=True)
    bore = Hole(3 * MM, 40 * MM, in_=["box1"], pose_body_shape=Pose((0, 0, 20 * MM)))
    bar = Object(scene.object.boxes, shapes=[Sphere(1 * MM, Pose((0.05, 0, 0)))], holes=[bore])
    assert inner_scene(Scene(bar, scene.cage, DOWN)) is None


def solid_at(rng: np.random.Generator, point: np.ndarray, outward: np.ndarray) -> Shape:
    """A random solid beyond a plane through a point, which it touches there or along an edge or a face."""
    size, across = 10 ** rng.uniform(-0.5, 1) * MM, np.cross(outward, rng.normal(size=3))
    turned = np.stack([across, np.cross(outward, across), outward], axis=1) / np.linalg.norm(across) ** np.array(
        [1, 1, 0]
    )
    there = Pose(point, Rotation.from_matrix(turned).as_quat(scalar_first=True))
    on_its_side = there @ Pose((0, 0, size), LYING)
    corners = rng.uniform(-size, size, (8, 3))
    corners[:, 2] += 0.3 * size - corners[:, 2].min()
    return (
        Sphere(size, there @ Pose((0, 0, size))),
        Capsule(size, 3 * size, on_its_side),
        Cylinder(size, 4 * size, on_its_side),
        Cone(size, 0.6 * size, 2 * size, there @ Pose((0, 0, size))),
        Box((size, 2 * size, 3 * size), there @ Pose((0, 0, 1.5 * size))),
        Convex(corners, 0.3 * size, there),
    )[rng.integers(6)]


def cage_of_solids(rng: np.random.Generator) -> Scene:
    """A caged scene of points, each with a random solid behind it; some solids are left out as they reach the box."""
    scene = caged(rng)
    pose = scene.cage.pose_world_cage.inverse() @ scene.object.pose_world_object
    kept = list[Shape]()
    for point in scene.cage.points_cage:
        place = pose.inverse_transform(point) / (scene.object.boxes[0].size_m / 2)
        axis = int(np.argmax(np.abs(place)))
        outward = math.copysign(1.0, place[axis]) * pose.rotation[:, axis]
        try:
            solid = solid_at(rng, point, outward)
            Scene(scene.object, Cage(shapes=[solid], pose=scene.cage.pose_world_cage), DOWN)
        except SceneError:
            continue
        kept.append(solid)
    return Scene(scene.object, Cage(shapes=kept, pose=scene.cage.pose_world_cage), DOWN)


def depth_within(shape: Shape, point: np.ndarray) -> float:
    """How far a point of the body's frame lies outside a shape, metres, by non-negative least squares on its core."""
    if not isinstance(shape, Rounded | Box):
        return 0.0 if shape.holds(point[None])[0] else math.inf
    corners, heavy = shape.nodes_body(), 1e4
    system = np.vstack([corners.T, np.full(len(corners), heavy)])
    _, left = nnls(system, np.append(point, heavy))
    return float(left) - (shape.radius_m if isinstance(shape, Rounded) else 0.0)


def is_held_as_its_points(scene: Scene) -> bool:
    """Whether points within the solids of a cage hold the object; if so, check that the solids do, as tightly."""
    inner = inner_scene(scene)
    named = {shape.name: shape for shape in scene.cage.shapes}
    for name, point in zip(inner.cage.names, inner.cage.points_cage, strict=True):
        assert depth_within(named[name.rpartition(" ")[0]], point) < 1e-9 * scene.size_m
    frame = PlayFrame(inner)
    bounds = Bounds(frame, range_goals(frame), inner.touch_m)
    if not bounds.is_caged:
        return False
    pushed = PushedPlay(scene, unseated(scene), [])
    for ends, low, high in zip(pushed.ranges(), bounds.ends[::2], bounds.ends[1::2], strict=True):
        assert low is None or low <= (ends[0].reached or 0.0)
        assert high is None or (ends[1].reached or 0.0) <= high
    assert pushed.judge("", None, 0.3, None).verdict == "not certified"
    return True


def test_random_solids_hold_what_points_within_them_hold(cases):
    """No push leads out, none of 12 ends passes its bound, and all points lie within the solids."""
    rng, n_cases = np.random.default_rng(8), cases(3, 150)
    n_caged = sum(is_held_as_its_points(cage_of_solids(rng)) for _ in range(n_cases))
    print(f"{n_caged} of {n_cases} scenes caged")
    assert n_caged >= 0.5 * n_cases


def test_no_push_goes_into_solids_where_many_contacts_are_put_back():
    """They nearly depend on each other, and a way that puts all back is longer than the step."""
    rng = np.random.default_rng(8)
    assert is_held_as_its_points([cage_of_solids(rng) for _ in range(4)][-1])

"""What the door refuses, and what it lets in: every problem with its place, what was found and the remedy."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, SceneError, Tolerances

DOWN = Load("gravity", gravity=(0, 0, -1))
FAR = [(5, 5, 5), (5, -5, 5), (-5, 0, -5)]


def problems_of(make):
    with pytest.raises(SceneError) as caught:
        make()
    return [str(problem) for problem in caught.value.problems]


def test_a_point_inside_is_named_with_its_depth_and_the_box():
    scene = lambda: Scene(Object([Box((2, 2, 2), name="cube")]), Cage([*FAR, (0.9, 0, 0)]), [DOWN])  # noqa: E731
    (problem,) = problems_of(scene)
    assert problem.startswith("cage.points.C4: starts 100 mm inside object.boxes[0] (cube)")
    assert "move the point out" in problem


def test_all_problems_are_found_at_once():
    tolerances = Tolerances(touch=1e-4)
    thin = Object([Box((2, 2, 2)), Box((1, 1, 1e-4), Pose((0, 0, 3)))])
    found = problems_of(
        lambda: Scene(
            thin, Cage([(5, 0, 0), (5, 0, 0), (0, 0, 0)]), [DOWN, DOWN], tolerances=tolerances, friction_coefficient=-1
        )
    )
    places = [problem.split(":")[0] for problem in found]
    assert places == ["loads[1].name", "friction", "object.boxes[1].size[2]", "cage.points.C2", "cage.points.C3"]


def test_arguments_of_other_classes_are_named():
    box = Box((2, 2, 2))
    held = Object([box])
    assert problems_of(lambda: Object([box], pose=(0, 0, 1))) == [
        "pose: is (0, 0, 1); give a cagepose.Pose: cagepose.Pose((0, 0, 1))"
    ]
    assert problems_of(lambda: Object(box)) == ["boxes: is of type Box; give a list of cagepose.Box"]
    assert problems_of(lambda: Box((1, 1, 1), (0, 0, 1))) == [
        "pose: is (0, 0, 1); give a cagepose.Pose: cagepose.Pose((0, 0, 1))"
    ]
    assert problems_of(lambda: Scene(held, FAR, DOWN)) == [
        "loads: is of type Load; give a list of cagepose.Load",
        "cage: is [(5, 5, 5), (5, -5, 5), (-5, 0, -5)]; give a cagepose.Cage",
    ]


def test_points_at_one_place_are_each_told_once():
    points = [(5, 0, 0)] * 300 + [(0, 5, 0)] * 2
    found = problems_of(lambda: Scene(Object([Box((2, 2, 2))]), Cage(points), [DOWN]))
    assert len(found) == 299 + 1
    assert found[0] == "cage.points.C2: lies 0 mm from C1, so they are one point; remove or move one"
    assert {problem.split(" ")[0] for problem in found} == {f"cage.points.C{n}:" for n in [*range(2, 301), 302]}


@pytest.mark.parametrize("seed", range(20))
def test_two_points_within_the_tolerance_of_each_other_are_one_in_whatever_order(seed):
    """Clusters of a tolerance's width: who stays is nobody's business, but those who stay are all apart."""
    rng = np.random.default_rng(seed)
    points = rng.integers(-3, 3, (40, 3)) + rng.uniform(-0.6, 0.6, (40, 3)) * 1e-4 * 8
    tolerances = Tolerances(touch=1e-4)
    make = lambda kept: Scene(Object([Box((9, 9, 1), Pose((0, 0, 40)))]), Cage(kept), [DOWN], tolerances=tolerances)  # noqa: E731
    told = [
        int(problem.split(":")[0].removeprefix("cage.points.C")) - 1 for problem in problems_of(lambda: make(points))
    ]
    assert len(set(told)) == len(told)
    apart = make(np.delete(points, told, axis=0))
    assert len(apart.cage.names) + len(told) == 40


def test_a_point_on_the_surface_or_within_the_tolerance_may_start():
    for depth in (0.0, 1e-9, -1e-9):
        Scene(Object([Box((2, 2, 2))]), Cage([*FAR, (1.0 - depth, 0, 0)]), [DOWN])


def test_the_size_does_not_depend_on_the_frame():
    rng = np.random.default_rng(2)
    sizes = []
    for _ in range(5):
        pose = Pose(rng.uniform(-100, 100, 3), rng.normal(size=4))
        held = Object([Box((2, 1, 1)), Box((1, 1, 1), Pose((3, 0, 0)))], pose=pose)
        sizes.append(Scene(held, Cage(FAR, pose=pose), [DOWN]).size_m)
    assert np.ptp(sizes) < 1e-12


@pytest.mark.parametrize(
    ("make", "place"),
    [
        (lambda: Box((1, 0, 1)), "size[1]"),
        (lambda: Box((1, -2, 1)), "size[1]"),
        (lambda: Box((1, float("nan"), 1)), "size"),
        (lambda: Box((1, 1)), "size"),
        (lambda: Object([]), ""),
        (lambda: Object([Box((1, 1, 1), name="a"), Box((1, 1, 1), name="a")]), "boxes[1].name"),
        (lambda: Object([Box((1, 1, 1))], mass_kg=0.0), "mass"),
        (lambda: Object([Box((1, 1, 1))], inertia_kg_m2=np.diag([1, 1, 3])), "inertia"),
        (lambda: Object([Box((1, 1, 1))], inertia_kg_m2=[[1, 1, 0], [0, 1, 0], [0, 0, 1]]), "inertia"),
        (lambda: Cage(np.zeros((0, 3))), ""),
        (lambda: Cage([(0, 0, 0), (1, 0, 0)], ["A", "A"]), "points.A"),
        (lambda: Cage([(0, 0, 0)], ["A", "B"]), "names"),
        (lambda: Load("empty"), ""),
        (lambda: Load("none", gravity=(0, 0, 0)), "gravity"),
        (lambda: Force((0, 0, 0), (0, 0, 0)), "direction"),
        (lambda: Force((1, 0, 0), (0, 0, 0), -1.0), "magnitude"),
        (lambda: Pose(quaternion_wxyz=(0, 0, 0, 0)), "quat_wxyz"),
        (lambda: Pose(quaternion_wxyz=(1, 0, 0, 0), euler_zyx=(0, 0, 0)), ""),
        (lambda: Tolerances(touch=1.0), "touch"),
        (lambda: Tolerances(grazing_band_rad=1.0), "grazing_band_deg"),
    ],
)
def test_each_noun_names_the_place_that_is_wrong(make, place):
    found = problems_of(make)
    assert any(problem.startswith(f"{place}:" if place else "has") for problem in found), found


def test_directions_of_any_length_are_scaled_to_one():
    for length in (1e-200, 1.0, 1e200):
        assert Force(np.array([3.0, 0.0, 4.0]) * length, (0, 0, 0)).direction.tolist() == pytest.approx([0.6, 0, 0.8])


def test_nouns_do_not_change_and_do_not_follow_their_sources():
    size = np.array([1.0, 2.0, 3.0])
    box = Box(size)
    size[0] = 9.0
    assert box.size_m.tolist() == [1.0, 2.0, 3.0]
    with pytest.raises(ValueError, match="read-only"):
        box.size_m[0] = 5.0

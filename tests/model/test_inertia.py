"""The object's inertia for each unit of mass: what is given, or that of its union, by hand and against samples."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cagepose.model.parts
from cagepose import Box, Object, Pose, SceneError


def test_one_box_has_the_inertia_of_textbooks():
    held = Object([Box([1.0, 2.0, 3.0], Pose([4.0, 5.0, 6.0]))])
    assert_allclose(held.gyration_m2, np.diag([13.0, 10.0, 5.0]) / 12.0, rtol=1e-14, atol=1e-15)


def test_a_center_of_gravity_off_the_centroid_adds_its_distance_squared():
    """Off by d = (0.3, 0.4, 1.2): each axis gains the squares of the two other components, and -d_i d_j beside."""
    held = Object([Box([1.0, 2.0, 3.0], Pose([4.0, 5.0, 6.0]))], [3.7, 4.6, 4.8])
    by_hand = [
        [13.0 / 12.0 + 0.16 + 1.44, -0.12, -0.36],
        [-0.12, 10.0 / 12.0 + 0.09 + 1.44, -0.48],
        [-0.36, -0.48, 5.0 / 12.0 + 0.09 + 0.16],
    ]
    assert_allclose(held.gyration_m2, by_hand, rtol=1e-14)


def test_an_l_of_two_overlapping_bars_by_hand():
    """The corner of bars 2 x 1 x 1 and 1 x 2 x 1 counts once: three cubes with centres (0, 0), (1, 0), (0, 1).

    About the centroid (1/3, 1/3), the mean squares are 2/9 each way and the mean product is -1/9.
    """
    held = Object([Box([2, 1, 1], Pose([0.5, 0, 0])), Box([1, 2, 1], Pose([0, 0.5, 0]))])
    by_hand = np.array([[2, 1, 0], [1, 2, 0], [0, 0, 4]]) / 9.0 + np.eye(3) / 6.0
    assert_allclose(held.gyration_m2, by_hand, rtol=1e-14, atol=1e-15)


def test_it_turns_with_the_boxes_but_not_with_the_object_in_the_world():
    turn = Pose(quaternion_wxyz=(0.7, -0.1, 0.5, 0.3))
    straight = Object([Box([2, 1, 1], Pose([0.5, 0, 0])), Box([1, 2, 1], Pose([0, 0.5, 0]))], [0.1, 0.2, 0.3])
    boxes = [
        Box(box.size_m, Pose(turn.rotation @ box.pose_object_box.position_m, turn.quaternion_wxyz))
        for box in straight.boxes
    ]
    turned = Object(boxes, turn.rotation @ [0.1, 0.2, 0.3], pose=Pose([9, 9, 9], (1, 2, 3, 4)))
    assert_allclose(turned.gyration_m2, turn.rotation @ straight.gyration_m2 @ turn.rotation.T, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("seed", range(4))
def test_random_unions_match_the_integral_over_random_points(seed):
    rng = np.random.default_rng(seed)
    center = rng.uniform(-0.5, 0.5, 3)
    held = Object(
        [Box(rng.uniform(0.2, 1.2, 3), Pose(rng.uniform(-0.8, 0.8, 3), rng.normal(size=4))) for _ in range(6)],
        center,
    )
    samples = rng.uniform(-2.0, 2.0, (200_000, 3))
    inside = np.zeros(len(samples), dtype=bool)
    for box in held.boxes:
        local = (samples - box.pose_object_box.position_m) @ box.pose_object_box.rotation
        inside |= (np.abs(local) <= box.size_m / 2.0).all(axis=1)
    arms = samples[inside] - center
    values = (arms**2).sum(axis=1)[:, None, None] * np.eye(3) - arms[:, :, None] * arms[:, None, :]
    error = values.std(axis=0) / np.sqrt(len(values))
    assert (np.abs(held.gyration_m2 - values.mean(axis=0)) < 5.0 * error).all()


def test_a_thin_rod_keeps_the_digits_of_its_smallest_inertia():
    held = Object([Box([1.0, 1e-7, 1e-7]), Box([1.0, 1e-7, 1e-7], Pose([1.0, 0.0, 0.0]))])
    assert_allclose(held.gyration_m2[0, 0], 1e-14 / 6.0, rtol=1e-9)


def test_a_given_inertia_is_divided_by_the_mass():
    inertia = np.array([[2.0, 0.1, 0.0], [0.1, 3.0, 0.2], [0.0, 0.2, 4.0]])
    held = Object([Box([1, 1, 1])], mass_kg=4.0, inertia_kg_m2=inertia)
    assert np.array_equal(held.gyration_m2, inertia / 4.0)
    assert np.array_equal(held.inertia_kg_m2, inertia)


def test_a_mass_alone_changes_nothing():
    with_mass, without = Object([Box([1, 2, 3])], mass_kg=7.0), Object([Box([1, 2, 3])])
    assert np.array_equal(with_mass.gyration_m2, without.gyration_m2)


def test_an_inertia_without_a_mass_is_refused():
    with pytest.raises(SceneError) as caught:
        Object([Box([1, 1, 1])], inertia_kg_m2=np.eye(3))
    (problem,) = caught.value.problems
    assert problem.path == ("inertia",)
    assert str(problem) == "inertia: is given without a mass; give object.mass too, or leave the inertia out"


def test_an_inertia_that_is_wrong_twice_is_told_so_at_once():
    with pytest.raises(SceneError) as caught:
        Object([Box([1, 1, 1])], inertia_kg_m2=np.diag([1, 1, 3]))
    assert [problem.path for problem in caught.value.problems] == [("inertia",), ("inertia",)]


def test_it_is_read_only():
    for held in (Object([Box([1, 1, 1])]), Object([Box([1, 1, 1])], mass_kg=2.0, inertia_kg_m2=np.eye(3))):
        with pytest.raises(ValueError, match="read-only"):
            held.gyration_m2[0, 0] = 0.0


@pytest.mark.parametrize(
    ("given", "at_construction", "at_the_end"),
    [
        ({}, 1, 1),
        ({"center_of_gravity_m": [0, 0, 0]}, 0, 1),
        ({"center_of_gravity_m": [0, 0, 0], "mass_kg": 1.0, "inertia_kg_m2": np.eye(3)}, 0, 0),
    ],
)
def test_the_union_is_cut_up_at_most_once_and_only_if_needed(monkeypatch, given, at_construction, at_the_end):
    calls = []
    original = cagepose.model.parts.body_moments
    monkeypatch.setattr(cagepose.model.parts, "body_moments", lambda *args: calls.append(1) or original(*args))
    held = Object([Box([1, 2, 3])], **given)
    assert len(calls) == at_construction
    assert held.gyration_m2 is held.gyration_m2
    assert len(calls) == at_the_end

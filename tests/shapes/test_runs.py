"""Whole runs of random scenes of rounded parts, asked by what `convex_bodies` knows of each pose on the way."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from audit.families import drawn_scenes
from audit.geometry import farthest_move
from cagepose import Box, Cage, Load, Object, Pose, Scene, run
from cagepose.model.shapes import Convex
from quasistatic.paths import RESTS
from shapes.asked_runs import Asked
from shapes.convex_bodies import Body, body_of, gap
from shapes.shape_scenes import random_problem, scene_of


def bodies_of(scene: Scene) -> tuple[list[Body], list[Body]]:
    around = [*scene.cage.points_cage, *scene.cage.shapes]
    return [body_of(part) for part in scene.object.parts], [body_of(part) for part in around]


def least_gap(held: list[Body], around: list[Body], pose: Pose) -> float:
    """How far apart the object and the cage are, as far as it is nearer than the size of the parts."""
    least = np.inf
    for body in (body.at(pose) for body in held):
        for other in around:
            middle = np.linalg.norm(body.corners.mean(axis=0) - other.corners.mean(axis=0))
            if middle <= body.size + other.size:
                least = min(least, gap(body, other))
    return least


def test_nothing_goes_deep_or_up_and_rests_are_balanced(cases, say):
    rng, asked = np.random.default_rng(30), Asked()
    for number in range(cases(10, 200)):
        ask_run(asked, number, scene_of(*random_problem(rng)))
    say(f"runs of rounded parts: {asked}")
    asked.check()


def ask_run(asked: Asked, number: int, scene: Scene) -> None:
    held, around = bodies_of(scene)
    asked.ask(number, scene, run(scene, method="quasistatic"), lambda pose: -least_gap(held, around, pose))


def test_what_runs_over_a_border_while_it_is_a_little_deep_is_held_behind_it():
    """A vertex runs onto a face that lies nearly in the plane of the one it leaves. It sank in there by 2 mm."""
    rng, asked = np.random.default_rng(30), Asked()
    problems = [random_problem(rng) for _ in range(32)]
    ask_run(asked, 31, scene_of(*problems[31]))
    asked.check()


def test_scenes_in_other_lengths_end_alike(cases, say):
    """All without friction. With it an end can be one of many in a row, and ties are broken by rounding."""
    rng, n_parted, n_compared = np.random.default_rng(31), 0, 0
    for _ in range(cases(15, 600)):
        problem = random_problem(rng)
        if problem[2][0].pushes:  # where it pushes would have to be in other lengths, too
            continue
        scene = scene_of(*problem)
        result = run(scene, method="quasistatic")
        for scale in (1e-3, 1e3):
            other = run(scene_of(*problem, scale=scale), method="quasistatic")
            is_alike = other.verdict == result.verdict and (
                result.verdict not in RESTS
                or np.allclose(other.pose.position_m / scale, result.pose.position_m, atol=1e-6 * scene.size_m)
            )
            assert is_alike or scene.friction_coefficient
            n_parted, n_compared = n_parted + (not is_alike), n_compared + 1
    say(f"{n_parted} of {n_compared} runs in other lengths end elsewhere, all with friction")
    assert n_parted <= 0.02 * n_compared


PASSED_ON_THE_WAY = {
    "three points of a face": (
        (7.0, 10.0, 14.0),
        (6.398, 10.994, 4.925),
        [
            (-3.5, -4.674, -0.771),
            (1.379, -3.896, 7.0),
            (4.5, 0.345, -5.28),
            (-2.315, -3.009, 7.0),
            (0.431, 5.0, -4.202),
            (3.353, -4.223, 7.0),
            (4.273, -0.049, 23.95),
        ],
        (-0.764, -0.01, 2.231),
    ),
    "two side by side": (
        (9.0, 17.0, 18.0),
        (9.769, -1.544, -3.259),
        [
            (-1.974, 4.839, -9.0),
            (3.257, 8.5, 0.758),
            (3.23, 8.503, 0.754),
            (4.51, 0.472, -8.472),
            (-4.178, -0.771, -9.0),
            (3.304, -8.51, -1.798),
            (-4.5, -8.21, 6.892),
        ],
        (-0.037, -0.897, -0.441),
    ),
}


@pytest.mark.parametrize("name", PASSED_ON_THE_WAY)
def test_a_point_that_moves_off_a_hull_is_not_met_because_others_stray_from_it(name):
    """On a screw, contacts that slide leave their faces by the square of its length. A point that touches and moves
    away slowly is over the face then, too, and would be put on it: the hull was turned in its plane instead.
    """
    size, center, points, gravity = PASSED_ON_THE_WAY[name]
    box = Box(np.array(size) / 1e3)
    hull, cage = Convex(box.corners_object()), Cage(np.array(points) / 1e3)
    parts = (([box], []), ([], [hull]))
    bodies = [Object(boxes, np.array(center) / 1e3, shapes=shapes) for boxes, shapes in parts]
    one, two = (run(Scene(held, cage, [Load("weight", gravity=gravity)]), method="quasistatic") for held in bodies)
    assert (one.verdict, two.verdict) == ("rests", "rests")
    assert one.pose.position_m == pytest.approx(two.pose.position_m, abs=1e-9 * max(size) / 1e3)


def test_a_box_as_a_hull_of_its_corners_and_points_ends_where_the_box_does(cases, say):
    worst, n_scenes = 0.0, cases(30, 2000)
    of_one_box = (scene for scene in drawn_scenes("union", math.inf, 32) if len(scene.object.boxes) == 1)
    for scene in itertools.islice(of_one_box, n_scenes):
        box, held = scene.object.boxes[0], scene.object
        hull = Object([], held.center_of_gravity_m, shapes=[Convex(box.corners_object())], pose=held.pose_world_object)
        other = Scene(hull, Cage(scene.cage.points_cage), scene.loads)
        one, two = run(scene, method="quasistatic"), run(other, method="quasistatic")
        assert one.verdict == two.verdict
        if one.verdict in RESTS:
            worst = max(worst, farthest_move(scene, one.pose, two.pose))
    assert worst < 1e-9
    say(f"{n_scenes} boxes as hulls end at most {worst:.1e} sizes from the boxes")

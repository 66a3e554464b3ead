"""Whole runs of random scenes of rounded parts, asked by what `convex_bodies` knows of each pose on the way."""

from __future__ import annotations

import numpy as np

from cagepose import Cage, Object, Pose, Scene, SceneError, run
from cagepose.model.shapes import Convex
from quasistatic.paths import RESTS, distance
from random_scenes import random_scene
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
    for number in range(cases(40, 200)):
        scene = scene_of(*random_problem(rng))
        held, around = bodies_of(scene)

        def depth_at(pose: Pose, held=held, around=around) -> float:
            return -least_gap(held, around, pose)

        asked.ask(number, scene, run(scene, method="quasistatic"), depth_at)
    say(f"runs of rounded parts: {asked}")
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


def test_a_box_as_a_hull_of_its_corners_and_points_ends_where_the_box_does(cases, say):
    rng, compared, worst = np.random.default_rng(32), 0, 0.0
    while compared < cases(30, 2000):
        try:
            scene = random_scene(rng)
        except SceneError:
            continue
        if len(scene.object.boxes) > 1:
            continue
        box, held = scene.object.boxes[0], scene.object
        hull = Object([], held.center_of_gravity_m, shapes=[Convex(box.corners_object())], pose=held.pose_world_object)
        other = Scene(hull, Cage(scene.cage.points_cage), scene.loads)
        one, two = run(scene, method="quasistatic"), run(other, method="quasistatic")
        assert one.verdict == two.verdict
        if one.verdict in RESTS:
            worst = max(worst, distance(scene, one.pose, two.pose))
        compared += 1
    assert worst < 1e-9
    say(f"{compared} boxes as hulls end at most {worst:.1e} sizes from the boxes")

"""Whole runs of random scenes of rounded parts, asked by what `convex_bodies` knows of each pose on the way."""

from __future__ import annotations

import numpy as np

from cagepose import Cage, Object, Pose, Run, Scene, SceneError, run
from cagepose.model.shapes import Convex
from cagepose.runs.load_scaling import scaled_load
from quasistatic.paths import RESTS, VERDICTS, distance, path_of, potential
from random_scenes import random_scene
from shapes.convex_bodies import Body, body_of, gap
from shapes.shape_scenes import random_problem, scene_of

DEEP = 4.0
"""Touch tolerances."""
POSES = 40
"""Of a path, about so many are asked how deep parts are."""


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


def imbalance(scene: Scene, result: Run) -> float:
    """What is left of the forces and moments at the end, of the load."""
    phase, load = result.phases[-1], scene.loads[-1]
    weighed, about = scaled_load(scene, load), phase.pose.transform(scene.object.center_of_gravity_m)
    force, moment = np.array(weighed.gravity, dtype=float), np.zeros(3)
    total = np.linalg.norm(force)
    for push, each in zip(load.pushes, weighed.forces, strict=True):
        force, total = force + each, total + np.linalg.norm(each)
        moment = moment + np.cross(phase.pose.transform(push.at_object_m) - about, each)
    for contact in phase.contacts:
        carried = contact.force_tangential_n - contact.force_normal_n * contact.normal_world
        force, moment = force + carried, moment + np.cross(contact.place_world - about, carried)
    return max(float(np.linalg.norm(force)), float(np.linalg.norm(moment)) / scene.size_m) / float(total)


def test_nothing_goes_deep_or_up_and_rests_are_balanced(cases, say):
    rng, verdicts = np.random.default_rng(30), dict.fromkeys(sorted(VERDICTS), 0)
    n_scenes, deepest, highest, least_balanced = cases(40, 200), 0.0, 0.0, 0.0
    for number in range(n_scenes):
        scene = scene_of(*random_problem(rng))
        result = run(scene, method="quasistatic")
        phase, (held, around) = result.phases[-1], bodies_of(scene)
        path = path_of(phase)
        every = max(1, len(path) // POSES)
        depth = max(-least_gap(held, around, pose) for pose in (*path[::every], path[-1])) / scene.touch_m
        assert depth < DEEP, f"scene {number}: {depth} touch tolerances deep"
        heights = [potential(scene, scene.loads[0], pose) for pose in path]
        rise = float(np.max(np.diff(heights), initial=0.0))
        assert rise < 1e-12, f"scene {number}: its potential rises by {rise}"
        if phase.verdict in RESTS:
            left = imbalance(scene, result)
            assert left < 1e-8, f"scene {number}: {left} of the load is not balanced"
            least_balanced = max(least_balanced, left)
        deepest, highest = max(deepest, depth), max(highest, rise)
        verdicts[phase.verdict] += 1
    assert verdicts["stalled"] + verdicts["limit"] <= 0.05 * n_scenes, verdicts
    say(
        f"{n_scenes} runs of rounded parts: {verdicts}; at most {deepest:.1e} touch tolerances deep, {highest:.1e} up,"
        f" {least_balanced:.1e} of the load not balanced"
    )


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

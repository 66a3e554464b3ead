"""Linear and exact extremes against independent solvers, and what limits them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

from audit.caged_families import caged
from cagepose import Box, Cage, Load, Object, Pose, Scene, play
from cagepose.kernels.algebra.linear_program import OPTIMAL, UNBOUNDED, solve_program
from cagepose.kernels.play.polytope import empty_play_workspace, write_start
from cagepose.studies.play_frame import FREEDOMS, PlayFrame
from rails import rail_scene

MM = 1e-3

HIGHS = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}


def gaps(scene: Scene, pose: Pose) -> np.ndarray:
    """Gap of each point to each box: (2.4), by another route than the kernels'."""
    found = []
    points = scene.cage.points_world()
    for box in scene.object.boxes:
        q = box.pose_object_box.inverse_transform(pose.inverse_transform(points))
        found.append((np.abs(q) - box.size_m / 2).max(axis=1))
    return np.concatenate(found)


def relative(scene: Scene, pose: Pose) -> tuple[np.ndarray, tuple[float, float, float]]:
    """Displacement of the object's origin in the cage's axes, and (yaw, pitch, roll), both from the start."""
    cage, start = scene.cage.pose_world_cage, scene.object.pose_world_object
    shift = cage.rotation.T @ (pose.position_m - start.position_m)
    turned = cage.inverse() @ pose @ start.inverse() @ cage
    return shift, turned.euler_zyx


def value_of(scene: Scene, pose: Pose, name: str) -> float:
    shift, (yaw, pitch, roll) = relative(scene, pose)
    return dict(zip(FREEDOMS, (*shift, roll, pitch, yaw), strict=True))[name]


def test_all_twelve_programs_of_random_caged_scenes_agree_with_highs(cases):
    rng = np.random.default_rng(5)
    n_bounded, n_scenes = 0, cases(40, 250)
    for _ in range(n_scenes):
        frame = PlayFrame(caged(rng))
        work = empty_play_workspace(frame.geometry, frame.held)
        write_start(frame.geometry, work)
        n = len(work.faces)
        for objective in np.vstack([np.eye(6), -np.eye(6)]):
            work.program.objective[:] = objective
            outcome = solve_program(work.rows, work.bounds, work.program)
            known = linprog(
                -objective,
                A_ub=work.rows[:n],
                b_ub=work.bounds[:n],
                bounds=(None, None),
                method="highs-ds",
                options=HIGHS,
            )
            assert outcome == (OPTIMAL if known.status == 0 else UNBOUNDED)
            n_bounded += outcome == OPTIMAL
            if outcome == UNBOUNDED:
                continue
            assert float(objective @ work.program.x) == pytest.approx(-known.fun, abs=1e-9)
    assert n_bounded >= 11 * n_scenes


def test_every_extreme_is_a_pose_outside_that_has_the_value(cases):
    rng = np.random.default_rng(6)
    for _ in range(cases(25, 100)):
        scene = caged(rng)
        found = play(scene, search_s=0.0)
        for name, ends in found.freedoms.items():
            for end in (ends.low, ends.high):
                assert end.exact is not None
                assert end.pose_world_object is not None
                assert value_of(scene, end.pose_world_object, name) == pytest.approx(end.exact, abs=1e-12)
                assert gaps(scene, end.pose_world_object).min() >= -1e-12
                if len(scene.object.boxes) == 1:
                    touching = [scene.cage.names.index(clearance.point) for clearance in end.clearances]
                    assert touching
                    assert np.abs(gaps(scene, end.pose_world_object)[touching]).max() < 1e-10


def clamped_cube(rng: np.random.Generator, least_apart: float) -> tuple[Scene, Pose]:
    """A cube between two groups of points that touch it without any gap, 0.1 mm free to the other sides; its turn."""
    turn = Pose(rng.uniform(-20, 20, 3) * MM, rng.normal(size=4))
    points = []
    for axis in range(3):
        group = rng.uniform(least_apart, 4, (3, 3)) * np.array([[1, 1, 1], [-1, 1, 1], [1, -1, -1]])
        for side in (-1, 1):
            for point in group:
                points.append(point if axis else point.copy())
                points[-1] = points[-1].copy()
                points[-1][axis] = side * (5.0 if axis == 0 else 5.1)
    load = Load("gravity", gravity=(0, 0, -1))
    return Scene(Object([Box((10 * MM,) * 3)], pose=turn), Cage(turn.transform(np.array(points) * MM)), [load]), turn


def test_a_part_that_is_clamped_without_gap_has_every_end(cases):
    """By rounding, the points start some 1e-18 m inside or outside."""
    rng = np.random.default_rng(12)
    for _ in range(cases(20, 40)):
        scene, turn = clamped_cube(rng, 1.0)
        found = play(scene, [(0, 0, 0)], list(turn.rotation.T), search_s=0.0)
        for ends in found.freedoms.values():
            assert ends.low.exact is not None
            assert ends.high.exact is not None
        along_x = found.points[0]
        assert [along_x.low.exact, along_x.high.exact] == pytest.approx([0.0, 0.0], abs=1e-12)
        for other in found.points[1:]:
            assert other.high.exact is not None
            assert other.high.exact > 0.09 * MM


def nudged(pose: Pose, x: np.ndarray) -> Pose:
    """Shift by x[:3] times 20 mm and turn by the rotation vector x[3:] about the object's origin."""
    angle = float(np.linalg.norm(x[3:]))
    half = np.sin(angle / 2) / angle if angle > 0 else 0.5
    turn = Pose(quaternion_wxyz=[math.cos(angle / 2), *(half * x[3:])])
    turned = turn @ Pose(quaternion_wxyz=pose.quaternion_wxyz)
    return Pose(pose.position_m + 0.02 * x[:3], turned.quaternion_wxyz)


def gaps_to_faces(scene: Scene, pose: Pose, at: Pose) -> np.ndarray:
    """Gap of each point to that face of each box that it is farthest beyond at the pose ``at``."""
    found = []
    points = scene.cage.points_world()
    for box in scene.object.boxes:
        there = box.pose_object_box.inverse_transform(at.inverse_transform(points))
        axes = (np.abs(there) - box.size_m / 2).argmax(axis=1)
        q = box.pose_object_box.inverse_transform(pose.inverse_transform(points))
        rows = np.arange(len(points))
        found.append(np.sign(there[rows, axes]) * q[rows, axes] - box.size_m[axes] / 2)
    return np.concatenate(found)


def best_near(scene: Scene, pose: Pose, name: str) -> float | None:
    """The greatest value that SLSQP finds from a pose; None: it ends inside the object."""
    answer = minimize(
        lambda x: -value_of(scene, nudged(pose, x), name) * 1e3,
        np.zeros(6),
        constraints={"type": "ineq", "fun": lambda x: gaps_to_faces(scene, nudged(pose, x), pose) * 1e3},
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 200},
    )
    is_outside = gaps_to_faces(scene, nudged(pose, answer.x), pose).min() > -5e-12  # 7 mm off, that is 7e-10 rad
    return -answer.fun * 1e-3 if is_outside else None


def test_no_extreme_can_be_bettered_nearby(cases):
    rng = np.random.default_rng(7)
    n_compared, n_scenes = 0, cases(20, 40)
    for _ in range(n_scenes):
        scene = caged(rng)
        name = FREEDOMS[rng.integers(6)]
        end = play(scene, search_s=0.0).freedoms[name].high
        assert end.exact is not None
        assert end.pose_world_object is not None
        best = best_near(scene, end.pose_world_object, name)
        if best is not None:
            assert best <= end.exact + 1e-9
            n_compared += 1
    assert n_compared >= n_scenes // 2


def with_gap_wider(scene: Scene, point: str, by_m: float) -> Scene:
    """Move a cage point away from the face of the first box that it is farthest beyond."""
    index, start = scene.cage.names.index(point), scene.object.pose_world_object
    world = scene.cage.points_world().copy()
    q = start.inverse_transform(world[index])
    axis = int(np.argmax(np.abs(q) - scene.object.boxes[0].size_m / 2))
    world[index] += by_m * math.copysign(1.0, q[axis]) * start.rotation[:, axis]
    pose = scene.cage.pose_world_cage
    return Scene(scene.object, Cage(pose.inverse_transform(world), pose=pose), scene.loads)


def test_closing_and_opening_each_gap_moves_the_extreme_as_said():
    """One-sided differences over 20 nm: the two differ where several points limit an extreme."""
    rng = np.random.default_rng(8)
    deviations = []
    for _ in range(20):
        scene = caged(rng)
        if len(scene.object.boxes) > 1:
            continue
        before = play(scene, search_s=0.0)
        for name in ("x", "pitch"):
            end = before.freedoms[name].high
            for clearance in end.clearances[:3]:
                for by, worth in ((-2e-8, clearance.closing), (2e-8, clearance.opening)):
                    after = play(with_gap_wider(scene, clearance.point, by), search_s=0.0).freedoms[name].high
                    deviations.append(abs((after.exact - end.exact) / by - worth) / clearance.closing)
    assert len(deviations) >= 20
    assert max(deviations) < 3e-3


def test_points_and_directions_may_be_rows_of_an_array():
    """Arrays have no truth value: an empty sequence must be told by its length."""
    scene = rail_scene()
    (one,) = play(scene, np.array([[-600, 20, -60.747]]) * MM, np.array([[0.0, 1.0, 0.0]])).points
    *_, other, _ = play(scene, [(-0.6, 0.02, -0.060747)]).points  # x, y, z
    assert one.high.exact == pytest.approx(other.high.exact, rel=1e-12)

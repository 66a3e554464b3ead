"""Frictionless rests against two independent optimisers: scipy's SLSQP, and a sequence of linear programs."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

from audit.families import drawn_scenes
from audit.geometry import farthest_move
from cagepose import Pose, run
from quasistatic.paths import again, path_of, potential, rows_at
from rails import rail_scene


def moved(scene, pose, xi):
    """The pose moved by xi: travel of the centre of gravity (m) and rotation vector about it (rad), in the world."""
    center = pose.transform(scene.object.center_of_gravity_m)
    angle = np.linalg.norm(xi[3:])
    axis = xi[3:] / angle if angle > 0.0 else np.array([1.0, 0.0, 0.0])
    turn = Pose(quaternion_wxyz=(np.cos(angle / 2), *(np.sin(angle / 2) * axis)))
    back = Pose(-center)
    return Pose(center + xi[:3]) @ turn @ back @ pose


class Faces:
    """Gaps of cage points from the faces of boxes that they lie beyond at ``pose``, all as one array.

    The gap of a point P at another pose (R, p) is a . R' (P - p) - c, a the face's normal in the object's frame.
    """

    def __init__(self, scene, pose, within_m):
        points, axes, offsets = [], [], []
        for point in scene.cage.points_world():
            for box in scene.object.boxes:
                in_box = box.pose_object_box.inverse_transform(pose.inverse_transform(point))
                gaps = np.abs(in_box) - box.size_m / 2.0
                k = int(np.argmax(gaps))
                if gaps[k] <= within_m:
                    points.append(point)
                    axes.append(np.copysign(1.0, in_box[k]) * box.pose_object_box.rotation[:, k])
                    offsets.append(axes[-1] @ box.pose_object_box.position_m + box.size_m[k] / 2.0)
        self.points, self.axes_object, self.offsets = np.array(points), np.array(axes), np.array(offsets)

    def gaps(self, pose):
        return np.einsum("ij,ij->i", pose.inverse_transform(self.points), self.axes_object) - self.offsets


def is_isolated(result):
    """A rest that the load alone determines, with every point on one face (an edge is no smooth constraint)."""
    proof = result.phases[-1].proof
    rows = rows_at(result.scene, result.pose, 1e-6 * result.scene.size_m)
    pairs = {(row[0], str(row[1].name)) for row in rows}
    return (
        result.verdict == "rests"
        and proof.stability == "stable"
        and not proof.undetermined
        and len({pair[0] for pair in pairs}) == len(rows)
    )


def descended(scene, load, end, start_xi):
    """The pose of least potential that SLSQP finds from ``end`` moved by ``start_xi`` (in sizes and radians)."""
    size = scene.size_m
    faces = Faces(scene, end, 0.05 * size)
    scale = np.array([size] * 3 + [1.0] * 3)

    def at(z):
        return moved(scene, end, z * scale)

    result = minimize(
        lambda z: potential(scene, load, at(z)),
        start_xi,
        method="SLSQP",
        constraints={"type": "ineq", "fun": lambda z: faces.gaps(at(z)) / size},
        options={"maxiter": 500, "ftol": 1e-15},
    )
    pose = at(result.x)
    return pose, potential(scene, load, pose), float(faces.gaps(pose).min() / size)


def came_back(scene, load, end, random):
    """Where SLSQP ends from a rest of ours that is disturbed, and how far its potential is from ours; None: it stopped
    on the way, higher than our pose, or outside of the gaps. No pose nearby may have less potential.
    """
    ours = potential(scene, load, end)
    for disturbance in (1e-3, 1e-4):
        start = disturbance * random.uniform(-1.0, 1.0, 6)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            pose, theirs, least_gap = descended(scene, load, end, start)
        assert least_gap < -1e-9 or theirs >= ours - 1e-9, "a lower pose nearby"
        if least_gap >= -1e-9 and theirs <= ours + 1e-9:
            return pose, abs(theirs - ours)
    return None


def test_slsqp_comes_back_to_our_rests(say, cases):
    """From our pose disturbed by 1e-3 of the size, under the same gaps: no pose nearby has less potential (1e-9), and
    SLSQP ends at ours, as well as it can (1e-6 of the size).
    """
    rng = np.random.default_rng(7)
    n_compared = n_gave_up = 0
    worst_pose, worst_potential = 0.0, 0.0
    for number, plain in enumerate(drawn_scenes("union", cases(150, 600), seed=77)):
        result = run(again(plain), method="quasistatic")
        if not is_isolated(result):
            continue
        scene, load = result.scene, plain.loads[len(result.phases) - 1]
        back = came_back(scene, load, result.pose, rng)
        if back is None:
            n_gave_up += 1
            continue
        n_compared += 1
        worst_pose = max(worst_pose, farthest_move(scene, back[0], result.pose))
        worst_potential = max(worst_potential, back[1])
        assert farthest_move(scene, back[0], result.pose) <= 1e-6, f"scene {number}"
    say(
        f"SLSQP: {n_compared} isolated rests, {n_gave_up} given up;"
        f" poses within {worst_pose:.1e} of the size, potentials within {worst_potential:.1e}"
    )
    assert n_compared >= 5
    assert n_gave_up <= 0.1 * n_compared


def programmed(scene, load):
    """Where a sequence of linear programs ends: max w . xi with J xi <= gaps, linearised anew at each pose.

    Each is solved in units of the last step, so that the solver's tolerance (1e-7) shrinks with it. Every point keeps
    the face that it lies beyond at the start: with the play used up, a side roller is above the guide's edge too.
    """
    pose, reach = scene.object.pose_world_object, 0.05 * scene.size_m
    faces = Faces(scene, pose, scene.size_m)
    for _ in range(60):
        center = pose.transform(scene.object.center_of_gravity_m)
        at = pose.transform(load.force.at_object_m) - center
        wrench = np.concatenate([load.force.direction, np.cross(at, load.force.direction) / scene.size_m])
        arms, normals = faces.points - center, faces.axes_object @ pose.rotation.T
        # A gap falls with the object's velocity at the point along the normal.
        jacobian = np.hstack([normals, np.cross(arms, normals) / scene.size_m])
        answer = linprog(-wrench, jacobian, faces.gaps(pose) / reach, bounds=[(-1.0, 1.0)] * 6, method="highs")
        assert answer.status == 0
        xi = answer.x * reach * np.array([1.0] * 3 + [1.0 / scene.size_m] * 3)
        pose = moved(scene, pose, xi)
        step = float(np.abs(answer.x).max()) * reach
        reach = max(min(reach, 4.0 * step), 0.1 * reach)
        if reach <= 1e-14 * scene.size_m:
            break
    return pose


@pytest.mark.parametrize("pin_y_mm", [20.0, -20.0])
@pytest.mark.parametrize("play_mm", [1.0, 0.1])
@pytest.mark.parametrize("misaligned", ["pitch_deg", "yaw_deg", "roll_deg"])
def test_a_sequence_of_linear_programs_ends_in_our_rail(misaligned, play_mm, pin_y_mm):
    """The push alone, from the cage's pose: its rest is a vertex of the play, whatever came before."""
    scene = rail_scene(**{misaligned: 0.1}, play_mm=play_mm, pin_y_mm=pin_y_mm)
    result = run(scene, method="quasistatic")
    pose = programmed(scene, scene.loads[1])
    assert farthest_move(scene, pose, result.pose) * scene.size_m <= 1e-9 * play_mm * 1e-3
    assert path_of(result.phases[1])[-1] is result.pose

"""An oracle for ends of the play of boxes among points: gaps, slopes and multipliers of its own."""

from __future__ import annotations

import itertools
import math

import numpy as np
from scipy.optimize import nnls

from cagepose import Pose, Scene

TOUCHES = 1e-8
"""Lengths of the scene."""


class Start:
    """A scene in the cage's axes, lengths of the scene: gaps and values at any pose, and how they change."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.axes = scene.cage.pose_world_cage.rotation
        points = scene.cage.points_world()
        self.middle = points.mean(axis=0)
        self.length_m = float(np.linalg.norm(points - self.middle, axis=1).max())
        self.points = (points - self.middle) @ self.axes / self.length_m
        self.pose = scene.object.pose_world_object

    def gaps(self, pose: Pose) -> tuple[np.ndarray, np.ndarray]:
        """Gaps of all points to the six faces of all boxes, (n, 6), and how a twist lessens them, (n, 6, 6).

        The twist is about the object's origin.
        """
        turn = self.axes.T @ pose.rotation
        origin = self.axes.T @ (pose.position_m - self.middle) / self.length_m
        gaps, rows = [], []
        for box in self.scene.object.boxes:
            columns = turn @ box.pose_object_box.rotation
            center = origin + turn @ box.pose_object_box.position_m / self.length_m
            normals = np.concatenate([columns.T, -columns.T])
            half = np.tile(box.size_m / 2 / self.length_m, 2)
            gaps.append((self.points - center) @ normals.T - half)
            arms = np.broadcast_to((self.points - origin)[:, None], (len(self.points), 6, 3))
            rows.append(np.concatenate([np.broadcast_to(normals, arms.shape), np.cross(arms, normals)], axis=2))
        return np.concatenate(gaps), np.concatenate(rows)

    def value(self, pose: Pose, name: str) -> tuple[float, np.ndarray]:
        """The value of a freedom and its rate with the twist, (6,)."""
        shift = self.axes.T @ (pose.position_m - self.pose.position_m) / self.length_m
        turn = self.axes.T @ pose.rotation @ self.pose.rotation.T @ self.axes
        yaw, roll = math.atan2(turn[1, 0], turn[0, 0]), math.atan2(turn[2, 1], turn[2, 2])
        pitch = math.asin(max(-1.0, min(1.0, -turn[2, 0])))
        if name in "xyz":
            return float(shift["xyz".index(name)]), np.eye(6)["xyz".index(name)]
        sine, cosine = math.sin(yaw), math.cos(yaw)
        value, rate = {
            "yaw": (yaw, (cosine * math.tan(pitch), sine * math.tan(pitch), 1.0)),
            "pitch": (pitch, (-sine, cosine, 0.0)),
            "roll": (roll, (cosine / math.cos(pitch), sine / math.cos(pitch), 0.0)),
        }[name]
        return value, np.array([0.0, 0.0, 0.0, *rate])

    def unit(self, name: str) -> float:
        return self.length_m if name in "xyz" else 1.0


def missing(gaps: np.ndarray, rows: np.ndarray, slope: np.ndarray) -> float:
    """What pushes of the touching points cannot hold of a slope, part of it (Karush, Kuhn, Tucker).

    A point at an edge need only stay beyond one of its faces; every choice must hold the slope.
    """
    touching = np.flatnonzero(gaps.max(axis=1) < TOUCHES)
    choices = [np.flatnonzero(gaps[point] > -TOUCHES) for point in touching]
    slope = slope / np.linalg.norm(slope)
    if not len(touching):
        return 1.0
    taken = itertools.islice(itertools.product(*choices), 64)
    return max(float(nnls(rows[touching, list(faces)].T, slope)[1]) for faces in taken)

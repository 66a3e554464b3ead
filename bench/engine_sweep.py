"""The stepwise method's inner work in plain NumPy: how far along each of its motions all points stay out of all boxes.

The lines of motion are those of a stepwise run, so what decides them (which contacts count, slip, stability) is not
measured: a whole method in NumPy would take longer. Equations (2.1) and (2.2) of docs/theory/first-contact.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bench.rail_case import Answer, FloatArray
from cagepose import Motion, Scene, run
from cagepose.model.pose import Pose

ALLOWED_DEPTH_M = 1e-13
"""A point goes in once it is deeper than this and than at the start: far below the play, above rounding."""


class NumpySweep:
    """One scene and its lines of motion, prepared."""

    def __init__(self, scene: Scene) -> None:
        boxes = scene.object.boxes
        self._half = np.array([box.size_m for box in boxes])[:, None, :] / 2.0
        self._places = [box.pose_object_box for box in boxes]
        self._points = scene.cage.points_world()
        self._start = scene.object.pose_world_object
        self._phases = [
            [event.motion for event in phase.events if event.motion is not None]
            for phase in run(scene, "stepwise").phases
        ]

    def settings(self) -> dict[str, Any]:
        return {"allowed_depth_m": ALLOWED_DEPTH_M, "lines_of_motion": "those of the stepwise run"}

    def run(self) -> Answer:
        """Return the rotation at the end of each phase."""
        pose, ends = self._start, []
        for motions in self._phases:
            for motion in motions:
                pose = self._travel(pose, motion) if motion.kind == "travel" else self._turn(pose, motion)
            ends.append(pose.rotation)
        return Answer(tuple(ends))

    def _seen_from_boxes(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Return the boxes' rotations (n_boxes, 3, 3) and the points in their frames (n_boxes, n_points, 3)."""
        rotations = np.array([pose.rotation @ place.rotation for place in self._places])
        centers = np.array([pose.transform(place.position_m) for place in self._places])
        return rotations, (self._points[None] - centers[:, None]) @ rotations

    def _travel(self, pose: Pose, motion: Motion) -> Pose:
        assert motion.direction_world is not None
        rotations, q = self._seen_from_boxes(pose)
        velocity = (motion.direction_world @ rotations)[:, None, :]
        bound = self._bound(q)
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (q - bound) / velocity, (q + bound) / velocity
        still = velocity == 0.0
        outside = np.abs(q) >= bound
        starts = np.where(still, np.where(outside, np.inf, -np.inf), np.minimum(one, other)).max(axis=2)
        ends = np.where(still, np.where(outside, -np.inf, np.inf), np.maximum(one, other)).min(axis=2)
        entries = np.where((starts < ends) & (ends > 0.0), np.maximum(starts, 0.0), np.inf)
        return Pose(pose.position_m + entries.min() * motion.direction_world, pose.quaternion_wxyz)

    def _turn(self, pose: Pose, motion: Motion) -> Pose:
        assert motion.axis_world is not None
        assert motion.through_world is not None
        rotations, q = self._seen_from_boxes(pose)
        centers = np.array([pose.transform(place.position_m) for place in self._places])
        axis = (motion.axis_world @ rotations)[:, None, :]
        u = q - np.einsum("bij,bi->bj", rotations, motion.through_world - centers)[:, None, :]
        u_across = u - axis * (axis * u).sum(axis=2, keepdims=True)
        w = np.cross(axis, u)
        angle = self._first_entry(q, u_across, w)
        return _turned(pose, motion.axis_world, motion.through_world, angle)

    def _first_entry(self, q: FloatArray, u: FloatArray, w: FloatArray) -> float:
        """Return the least angle at which q + u (cos s - 1) - w sin s goes into a box, (2.2)."""
        bound = self._bound(q)
        roots = [np.zeros((*q.shape[:2], 1))]
        for sign in (-1.0, 1.0):  # (gap) + (slope) t + (gap at pi) t^2 = 0 in t = tan(s/2)
            gap, half_slope, gap_pi = sign * q - bound, -sign * w, sign * (q - 2.0 * u) - bound
            root = np.sqrt(np.maximum(half_slope * half_slope - gap * gap_pi, 0.0))
            pivot = -(half_slope + np.copysign(root, half_slope))
            real = half_slope * half_slope > gap * gap_pi
            with np.errstate(divide="ignore", invalid="ignore"):
                angles = 2.0 * np.arctan(np.stack([gap / pivot, pivot / gap_pi])) % (2.0 * math.pi)
            roots.extend(np.where(real & np.isfinite(angles), angles, np.inf))
        candidates = np.sort(np.concatenate(roots, axis=2), axis=2)
        following = np.concatenate([candidates[:, :, 1:], np.full((*q.shape[:2], 1), 2.0 * math.pi)], axis=2)
        middle = np.minimum(0.5 * (candidates + np.minimum(following, 2.0 * math.pi)), 2.0 * math.pi)[..., None]
        place = q[:, :, None] + u[:, :, None] * (np.cos(middle) - 1.0) - w[:, :, None] * np.sin(middle)
        inside = (np.abs(place) < bound[:, :, None]).all(axis=3) & np.isfinite(candidates)
        return float(np.where(inside, candidates, np.inf).min())

    def _bound(self, q: FloatArray) -> FloatArray:
        """Half sizes less the depth that each point may have, (n_boxes, n_points, 3)."""
        depth = np.maximum(-(np.abs(q) - self._half).max(axis=2), 0.0).max(axis=0)
        bound: FloatArray = self._half - (depth + ALLOWED_DEPTH_M)[None, :, None]
        return bound


def _turned(pose: Pose, axis: FloatArray, through: FloatArray, angle: float) -> Pose:
    turn = Pose(quaternion_wxyz=(math.cos(angle / 2.0), *(math.sin(angle / 2.0) * axis)))
    rotated = turn @ Pose(pose.position_m - through, pose.quaternion_wxyz)
    return Pose(rotated.position_m + through, rotated.quaternion_wxyz)

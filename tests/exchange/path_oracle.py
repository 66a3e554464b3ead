"""How deep two bodies are in each other, and whether one could lie lower, told by points of their surfaces that Open
CASCADE spreads and by what CAD took away and added. Shares no code with the program but for a walk over the faces of a
solid. Millimetres throughout.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from cagepose import Box, Cone, Cylinder, Pose, Shape, Sphere
from cagepose.files.step.open_cascade import each
from exchange.cad_parts import Level, Part, ball, bar, box, cone

CHORDS = 90
"""Of a circle on whose ends points are; and points of an edge."""
HALVINGS = 14
"""Of the height by which a part is lifted until it is free."""


def part_of(shape: Shape) -> Part:
    """Return a shape of ours, a box along the axes, as CAD builds it."""
    at, turn = 1e3 * shape.pose_body_shape.position_m, shape.pose_body_shape.rotation
    if isinstance(shape, Box):
        return box(tuple(at - 500.0 * shape.size_m), tuple(at + 500.0 * shape.size_m))
    if isinstance(shape, Sphere):
        return ball(tuple(at), 1e3 * shape.radius_m)
    assert isinstance(shape, Cylinder | Cone)
    way, length = turn[:, 2], 1e3 * shape.length_m
    start = tuple(at - length / 2.0 * way)
    if isinstance(shape, Cylinder):
        return bar(start, tuple(way), 1e3 * shape.radius_m, length)
    return cone(start, tuple(way), 1e3 * shape.radius_bottom_m, 1e3 * shape.radius_top_m, length)


def points_on(solid: Any) -> np.ndarray:
    """Return points of a surface: corners of its triangles, and along its edges."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.TopLoc import TopLoc_Location

    BRepTools.Clean_s(solid)
    BRepMesh_IncrementalMesh(solid, 1.0, False, 2.0 * math.pi / CHORDS, False)
    found, place = [], TopLoc_Location()
    for face in each("Face", solid):
        mesh = BRep_Tool.Triangulation_s(face, place)
        found += [mesh.Node(k).Transformed(place.Transformation()) for k in range(1, mesh.NbNodes() + 1)]
    for edge in each("Edge", solid):
        if not BRep_Tool.Degenerated_s(edge):
            curve = BRepAdaptor_Curve(edge)
            found += [curve.Value(at) for at in np.linspace(curve.FirstParameter(), curve.LastParameter(), CHORDS)]
    return np.unique(np.array([(point.X(), point.Y(), point.Z()) for point in found]).round(12), axis=0)


class Between:
    """An object and what holds it."""

    def __init__(self, held: Sequence[Part], cage: Sequence[Part]) -> None:
        self.held, self.cage = list(held), list(cage)
        self.own, self.around = (np.concatenate([points_on(one.solid) for one in parts]) for parts in (held, cage))

    def depth(self, pose: Pose) -> float:
        """Return how far points of each are in the other at most; below zero: how far they are apart, or less."""
        return float(max(self._depths(pose, self.own, self.around)))

    def _depths(self, pose: Pose, own: np.ndarray, around: np.ndarray) -> tuple[float, float]:
        turn, at = pose.rotation, 1e3 * pose.position_m
        inside = level_of(self.cage)(own @ turn.T + at).min(initial=np.inf)
        outside = level_of(self.held)((around - at) @ turn).min(initial=np.inf)
        return -float(inside), -float(outside)

    def lowest_beside(self, pose: Pose, center: np.ndarray, step: float, n_tries: int) -> float:
        """Return how much higher its centre of gravity is at least, at poses ``step`` beside where it is as low as it
        can be; below zero: it could lie lower.
        """
        random, turn, at = np.random.default_rng(1), pose.rotation, 1e3 * pose.position_m
        own, around = self.own @ turn.T + at, self.around
        reach = 4.0 * step
        own = self.own[level_of(self.cage)(own) < reach]
        around = around[level_of(self.held)((around - at) @ turn) < reach]
        size = float(np.ptp(self.own, axis=0).max())
        lowest = math.inf
        for _ in range(n_tries):
            spin, shift = random.normal(size=3), random.normal(size=3)
            spin *= step / size / np.linalg.norm(spin)
            shift *= step / np.linalg.norm(shift)
            beside = Pose((at + shift) * 1e-3, euler_zyx=tuple(spin)) @ Pose((0, 0, 0), pose.quaternion_wxyz)
            middle = 1e3 * beside.transform(center[None])[0, 2] - 1e3 * pose.transform(center[None])[0, 2]
            low, high = -4.0 * step - middle, 4.0 * step - middle
            for _ in range(HALVINGS):
                lift = (low + high) / 2.0
                moved = Pose(beside.position_m + 1e-3 * np.array([0.0, 0.0, lift]), beside.quaternion_wxyz)
                low, high = (low, lift) if max(self._depths(moved, own, around)) <= 0.0 else (lift, high)
            lowest = min(lowest, middle + high)
        return lowest


def level_of(parts: Sequence[Part]) -> Level:
    return lambda at: np.min([part.level(at) for part in parts], axis=0) if len(at) else np.zeros(0)

"""A scene as STEP: `step_bytes`."""

from __future__ import annotations

import tempfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from cagepose.exchange.solids import rounded_pieces
from cagepose.exchange.step_writer import write_step
from cagepose.exchange.stl import MM_PER_M
from cagepose.exchange.world_parts import world_parts
from cagepose.model.box import Box
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.hull import Hull, hull_of
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Capsule, Convex, Shape, Sphere, Turned
from cagepose.model.volume import BOX_SIGNS

NOTE_WITHIN = "loads, mass, friction and the start pose are in a comment for cagepose alone"


def step_bytes(scene: Scene, pose_world_object: Pose) -> tuple[bytes, tuple[str, ...]]:
    """Return a STEP file with a solid for each part, in the world, and what it cannot say, in sentences.

    Raises
    ------
    SceneError
        A part that is no solid, or that Open CASCADE cannot make.
    MissingExtraError
        Open CASCADE is not installed.
    """
    parts, notes = world_parts(scene, pose_world_object)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.step"
        write_step([step_solid(part.name, part.shape, part.holes, part.pose) for part in parts], path)
        return path.read_bytes(), (NOTE_WITHIN, *notes)


def step_solid(name: str, shape: Shape, holes: list[Hole], pose: Pose) -> dict[str, Any]:
    """Return a part with holes, in the world, for `write_step`."""
    is_rounded = isinstance(shape, Convex) and shape.radius_m > 0.0
    added = [*rounded_pieces(shape)] if isinstance(shape, Convex) and is_rounded else [shape]
    return {
        "name": name,
        "added": [_primitive(part, pose) for part in added],
        "removed": [_primitive(hole, pose) for hole in holes],
    }


def _primitive(shape: Shape, pose: Pose) -> dict[str, Any]:
    place = pose @ shape.pose_body_shape
    found: dict[str, Any] = {"rotation": place.rotation.tolist(), "position": (MM_PER_M * place.position_m).tolist()}
    if isinstance(shape, Box):
        return {**found, **_flat(hull_of(MM_PER_M * BOX_SIGNS * shape.size_m / 2.0))}
    if isinstance(shape, Convex):
        return {**found, **_flat(hull_of(MM_PER_M * shape.vertices_m))}
    if isinstance(shape, Facets):
        return {**found, "corners": (MM_PER_M * shape.vertices_m).tolist(), "loops": shape.triangles.tolist()}
    if isinstance(shape, Sphere | Capsule):
        return {
            **found,
            "profile": _round_ended(MM_PER_M * shape.radius_m, MM_PER_M * getattr(shape, "length_m", 0.0) / 2.0),
        }
    assert isinstance(shape, Turned)
    return {**found, "profile": _lathe(shape)}


def _flat(hull: Hull) -> dict[str, Any]:
    return {"corners": hull.vertices_m.tolist(), "loops": [list(face) for face in hull.faces]}


def _round_ended(radius: float, half: float) -> list[list[float]]:
    aslant = radius * np.sqrt(0.5)
    low = [0.0, -half - radius, aslant, -half - aslant, radius, -half]
    high = [radius, half, aslant, half + aslant, 0.0, half + radius]
    if half == 0.0:
        return [[0.0, -radius, radius, 0.0, 0.0, radius]]
    return [low, [radius, -half, radius, half], high]


def _lathe(shape: Turned) -> list[list[float]]:
    """Return the outline of a turned shape: from the axis along its rims and back."""
    rims = [(MM_PER_M * radius, MM_PER_M * height) for height, radius in shape.rims]
    points = [(0.0, rims[0][1]), *rims, (0.0, rims[-1][1])]
    distinct = [point for index, point in enumerate(points) if index == 0 or point != points[index - 1]]
    return [[*one, *other] for one, other in pairwise(distinct)]

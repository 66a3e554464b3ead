"""The parts of both bodies as solids in the world: `world_parts`."""

from __future__ import annotations

from typing import NamedTuple

from cagepose.errors import Problem, SceneError
from cagepose.exchange.beside import not_kept
from cagepose.exchange.solids import POINT_OF_SIZE
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Disc, Shape, Sphere


class WorldPart(NamedTuple):
    """A part of a body.

    Attributes
    ----------
    name
        With that of its body: "cage/pin".
    shape, holes
        In the frame of the body; what is cut out of it.
    pose
        Of the body in the world.
    is_point
        Whether it is a ball that stands for a cage point.
    """

    name: str
    shape: Shape
    holes: list[Hole]
    pose: Pose
    is_point: bool


def world_parts(scene: Scene, pose_world_object: Pose) -> tuple[list[WorldPart], list[str]]:
    """Return the parts with the object at a pose, and what they do not say as the scene does, in sentences.

    Raises
    ------
    SceneError
        Discs, which enclose nothing, and holes that stand alone, which are solid without end; by their names.
    """
    cage, held, radius_m = scene.cage, scene.object, POINT_OF_SIZE * scene.size_m
    points = zip(cage.points_cage, cage.names, strict=True)
    parts = [
        WorldPart(f"cage/{name}", Sphere(radius_m, Pose(point), name), [], cage.pose_world_cage, is_point=True)
        for point, name in points
    ]
    notes = [*([f"cage points are balls of radius {radius_m:.3g} m"] if parts else []), *not_kept(scene)]
    problems = []
    for body, pose, shapes, holes in (
        ("cage", cage.pose_world_cage, cage.shapes, cage.holes),
        ("object", pose_world_object, held.parts, held.holes),
    ):
        for shape in (*shapes, *(hole for hole in holes if not hole.in_)):
            if isinstance(shape, Disc | Hole):
                what = (
                    "is a disc, which encloses nothing" if isinstance(shape, Disc) else "stands alone, without an end"
                )
                problems.append(Problem((body, str(shape.name)), f"{what}; no solid is that: leave it out"))
                continue
            cuts = [hole for hole in holes if shape.name in hole.in_]
            parts.append(WorldPart(f"{body}/{shape.name}", shape, cuts, pose, is_point=False))
    if problems:
        raise SceneError(problems)
    return parts, notes

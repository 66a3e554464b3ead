"""What knows some shapes alone says so, by name, of a scene with others."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from cagepose.errors import Key, Problem, SceneError
from cagepose.model.beside_facets import meets_facets
from cagepose.model.hole import Hole
from cagepose.model.naming import place_of
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape


def unknown_shapes(scene: Scene) -> list[Problem]:
    """Return a problem for each hole that no method runs, and for each round part that meets facets of its body."""
    found = []
    for path, shape, every in _placed(scene):
        if met := meets_facets(shape, every):
            there = (
                f"is a {shape.kind} ({shape.name}) that touches or overlaps {met}, a mesh of facets of the same body"
            )
            found.append(Problem(path, f"{there}, which no method runs; draw both as one mesh"))
        if not isinstance(shape, Hole):
            continue
        solids = tuple(solid for solid in every if solid.name in shape.in_)
        if says := _unknown_in(shape, solids):
            found.append(Problem(path, says))
    return found


@lru_cache(maxsize=1024)  # each run asks, and points throughout a hole take longer than many runs
def _unknown_in(hole: Hole, solids: tuple[Shape, ...]) -> str | None:
    """Return why no method runs a hole in these parts; None: one does."""
    if hole.leaves_sideways(solids):
        says = f"is a hole ({hole.name}) that is wider than {', '.join(hole.in_)} somewhere below its mouth, or comes"
        return f"{says} out aslant, which no method runs; make it narrower or less deep"
    if divided := [str(solid.name) for solid in hole.divided_by(solids)]:
        says = f"is a hole ({hole.name}) along which the side of {' and of '.join(divided)} runs, which no method runs"
        return f"{says}; draw what is around it as one shape, or as several that meet in faces across the hole"
    return None


def other_shapes(scene: Scene, needs: str) -> list[Problem]:
    """Return a problem that names the first shape of a scene that is neither a box of the object nor a cage point.

    ``needs`` ends the message, such as "play knows boxes and points alone".
    """
    others = _placed(scene)[len(scene.object.boxes) :]
    more = f", like {len(others) - 1} more" if len(others) > 1 else ""
    return [Problem(path, f"is a {shape.kind} ({shape.name}){more}, and {needs}") for path, shape, _ in others[:1]]


def check_boxes_and_points(scene: Scene, what: str) -> None:
    """
    Raises
    ------
    SceneError
        The scene has other shapes.
    """
    problems = other_shapes(scene, f"{what} knows boxes held by points alone, so far; run works with more shapes")
    if problems:
        raise SceneError(problems)


def check_all_freedoms(scene: Scene, what: str) -> None:
    """
    Raises
    ------
    SceneError
        The scene is one in a plane.
    """
    if scene.planar is not None:
        message = f"is {scene.planar!r}, and {what} knows parts with all six freedoms alone, so far; leave planar out"
        raise SceneError([Problem(("planar",), message)])


class _Placed(NamedTuple):
    """A shape or hole of a scene: where it was given, and the shapes of its body."""

    path: tuple[Key, ...]
    shape: Shape
    beside: tuple[Shape, ...]


def _placed(scene: Scene) -> list[_Placed]:
    """Return all shapes of a scene, the boxes of the object first."""
    held, cage = scene.object, scene.cage
    of_object = zip(held.part_paths, (*held.parts, *held.holes), strict=True)
    found = [_Placed(("object", *place_of(path)), shape, held.parts) for path, shape in of_object]
    bodies, paths = cage.element_bodies[len(cage.names) :], cage.element_paths[len(cage.names) :]
    beside = [
        tuple(shape for shape, of in zip(cage.shapes, bodies, strict=False) if of == body)
        for body in range(1 + len(cage.bodies))
    ]
    of_cage = zip(paths, (*cage.shapes, *cage.holes), bodies, strict=True)
    return found + [_Placed(("cage", *path), shape, beside[body]) for path, shape, body in of_cage]

"""What knows some shapes alone says so, by name, of a scene with others."""

from __future__ import annotations

from functools import lru_cache

from cagepose.errors import Key, Problem, SceneError
from cagepose.model.beside_facets import meets_facets
from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.hole import Hole
from cagepose.model.parts import Object
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape


def unknown_shapes(scene: Scene) -> list[Problem]:
    """Return a problem for each hole that no method runs, and for each round part that meets facets of its body."""
    found = []
    for path, shape in _placed(scene):
        body: Object | Cage = scene.object if path[0] == "object" else scene.cage
        every = (*_boxes_of(body), *body.shapes)
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


def _boxes_of(body: Object | Cage) -> tuple[Box, ...]:
    return body.boxes if isinstance(body, Object) else ()


def other_shapes(scene: Scene, needs: str) -> list[Problem]:
    """Return a problem that names the first shape of a scene that is neither a box of the object nor a cage point.

    ``needs`` ends the message, such as "play knows boxes and points alone".
    """
    others = _placed(scene)[len(scene.object.boxes) :]
    more = f", like {len(others) - 1} more" if len(others) > 1 else ""
    return [Problem(path, f"is a {shape.kind} ({shape.name}){more}, and {needs}") for path, shape in others[:1]]


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


def _placed(scene: Scene) -> list[tuple[tuple[Key, ...], Shape]]:
    """Return all shapes of a scene, the boxes of the object first, and where each of them was given."""
    held, cage = scene.object, scene.cage
    of_object = zip(held.part_paths, (*held.parts, *held.holes), strict=True)
    of_cage = zip(cage.shape_paths, (*cage.shapes, *cage.holes), strict=True)
    found: list[tuple[tuple[Key, ...], Shape]] = [(("object", *path[:2]), shape) for path, shape in of_object]
    return found + [(("cage", *path[:2]), shape) for path, shape in of_cage]

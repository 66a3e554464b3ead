"""What knows some shapes alone says so, by name, of a scene with others."""

from __future__ import annotations

from cagepose.errors import Key, Problem, SceneError
from cagepose.model.features import has_features
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape

STAND_INS = {
    "cylinder": "a capsule, or a convex shape with many corners, may stand for it",
    "cone": "a convex shape with many corners may stand for it",
    "disc": "a convex shape with many corners may stand for it",
    "hole": "walls (boxes) around it may stand for it",
}
"""What may stand for a shape that no method runs yet, until one does."""


def unknown_shapes(scene: Scene) -> list[Problem]:
    """Return a problem for each shape that no method runs yet."""
    return [
        Problem(path, f"is a {shape.kind} ({shape.name}), which no method runs yet; {STAND_INS[shape.kind]}")
        for path, shape in _placed(scene)
        if not has_features(shape)
    ]


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

"""What knows boxes and points alone says so, by name, of a scene with other shapes."""

from __future__ import annotations

from cagepose.errors import Key, Problem, SceneError
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape


def has_other_shapes(scene: Scene) -> bool:
    """Whether a scene has more than boxes in the object and points in the cage."""
    return bool(scene.object.shapes or scene.cage.shapes)


def other_shapes(scene: Scene, needs: str) -> list[Problem]:
    """Return a problem for each shape of a scene that is neither a box of the object nor a point of the cage.

    ``needs`` ends the message, such as "play knows boxes and points alone".
    """
    n_boxes = len(scene.object.boxes)
    found: list[tuple[tuple[Key, ...], Shape]] = [
        (("object", *scene.object.part_paths[n_boxes + index][:2]), shape)
        for index, shape in enumerate(scene.object.shapes)
    ]
    found += [(("cage", "shapes", index), shape) for index, shape in enumerate(scene.cage.shapes)]
    return [Problem(path, f"is a {shape.kind} ({shape.name}), and {needs}") for path, shape in found]


def check_boxes_and_points(scene: Scene, what: str) -> None:
    """
    Raises
    ------
    SceneError
        The scene has other shapes.
    """
    problems = other_shapes(scene, f"{what} knows boxes held by points alone, so far; run works with all shapes")
    if problems:
        raise SceneError(problems)

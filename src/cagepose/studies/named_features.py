"""What names in a study stand for: parts of the object, elements of the cage, their places and their axes.

The first of two names is of the cage, the second of the object, so that one name may be used on both sides. ``pin`` is
a shape, and its place is the origin of its frame: of a box the middle, of a hole that of its mouth. ``pin.x``,
``pin.y`` and ``pin.z`` are the axes of that frame, through its origin: of a box the normals of its faces.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from cagepose.model.checks import FloatArray
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Capsule, Shape, Turned
from cagepose.model.wording import few
from cagepose.runs.driven_cage import CageAt

WORLD, OBJECT = "world", "object"
"""What the axes of the world and of the object's frame are called; `OBJECT` is all of the object, too."""
AXES = ("x", "y", "z")
SHOWN_NAMES = 10


class CageFeature(NamedTuple):
    """A place of the cage, or an axis through it.

    Attributes
    ----------
    element
        Index of `Cage.element_names`; None: the world.
    axis
        0, 1 or 2; None: the place alone.
    """

    element: int | None
    axis: int | None

    def frame(self, cage: CageAt) -> Pose:
        """Return where its frame is in the world; of a point it is not turned."""
        if self.element is None:
            return Pose()
        which = self.element - len(cage.cage.names)
        return cage.pose_of_shape(which) if which >= 0 else Pose(cage.points_world[self.element])


class ObjectFeature(NamedTuple):
    """A place of the object, or an axis through it: its frame in that of the object, and as in `CageFeature`."""

    pose_object_feature: Pose
    axis: int | None


def cage_elements(scene: Scene, name: str) -> tuple[int, ...]:
    """Return the indices of what a name stands for: of one element, or of all of a body.

    Raises
    ------
    ValueError
        It is no name of the cage, or that of a body without elements.
    """
    cage = scene.cage
    if name in cage.element_names:
        return (cage.element_names.index(name),)
    for number, body in enumerate(cage.bodies, 1):
        if body.name == name:
            if body.own.is_empty:
                raise ValueError(f"is {name!r}, a body with neither points nor shapes; name another")
            return tuple(element for element, of in enumerate(cage.element_bodies) if of == number)
    raise ValueError(_unknown_of_cage(scene, name, (body.name for body in cage.bodies)))


def object_parts(scene: Scene, name: str) -> tuple[int, ...]:
    """Return the indices of what a name stands for: of one part, or of all of the object.

    Raises
    ------
    ValueError
        It is no name of the object.
    """
    held = scene.object
    if name in held.element_names:
        return (held.element_names.index(name),)
    if name == OBJECT:
        return tuple(range(len(held.element_names)))
    raise ValueError(_unknown_of_object(scene, name, (OBJECT,)))


def cage_place(scene: Scene, name: str) -> CageFeature:
    """Return the place of a point or a shape, or an axis through it.

    Raises
    ------
    ValueError
        There is none of this name.
    """
    cage = scene.cage
    name, axis = _split(name, cage.element_names)
    if name not in cage.element_names:
        raise ValueError(_unknown_of_cage(scene, name))
    element = cage.element_names.index(name)
    if axis is not None and element < len(cage.names):
        raise ValueError(f"is an axis of {name!r}, a point, which has none; write {name}")
    return CageFeature(element, axis)


def object_place(scene: Scene, name: str, points: Mapping[str, FloatArray]) -> ObjectFeature:
    """Return the place of a part, or an axis through it, or a watched point of the object: ``points``, (3,) in metres.

    Raises
    ------
    ValueError
        There is none of this name, or there are two.
    """
    held = scene.object
    name, axis = _split(name, (*held.element_names, *points))
    if name in points:
        if name in held.element_names:
            raise ValueError(f"is {name!r}, a watched point and a part of the object; rename the point")
        if axis is not None:
            raise ValueError(f"is an axis of {name!r}, a watched point, which has none; write {name}")
        return ObjectFeature(Pose(points[name]), None)
    if name not in held.element_names:
        raise ValueError(_unknown_of_object(scene, name, points))
    return ObjectFeature(_part(held, name).pose_body_shape, axis)


def cage_axis(scene: Scene, name: str) -> CageFeature:
    """Return an axis of a shape, of a round one that which it is round about, or of the world.

    Raises
    ------
    ValueError
        There is none of this name, or no one axis.
    """
    cage = scene.cage
    own, axis = _split(name, cage.element_names)
    if own == WORLD and WORLD not in cage.element_names:
        return CageFeature(None, _named_axis(own, axis, "the world"))
    if own in cage.names:
        raise ValueError(f"is {own!r}, a point, which has no axis; name a shape")
    if own not in cage.element_names:
        raise ValueError(_unknown_of_cage(scene, own, (f"{WORLD}.z",)))
    element = cage.element_names.index(own)
    shape = (*cage.shapes, *cage.holes)[element - len(cage.names)]
    return CageFeature(element, _axis_of(shape, own, axis))


def object_axis(scene: Scene, name: str) -> ObjectFeature:
    """Return an axis of a part, of a round one that which it is round about, or of the object's frame.

    Raises
    ------
    ValueError
        There is none of this name, or no one axis.
    """
    held = scene.object
    own, axis = _split(name, held.element_names)
    if own == OBJECT and OBJECT not in held.element_names:
        return ObjectFeature(Pose(), _named_axis(own, axis, "the object's frame"))
    if own not in held.element_names:
        raise ValueError(_unknown_of_object(scene, own, (f"{OBJECT}.z",)))
    part = _part(held, own)
    return ObjectFeature(part.pose_body_shape, _axis_of(part, own, axis))


def _split(text: str, known: Iterable[str]) -> tuple[str, int | None]:
    """Return a name and the axis behind it; a name that is known as it stands has none."""
    name, dot, axis = text.rpartition(".")
    if dot and axis in AXES and text not in set(known):
        return name, AXES.index(axis)
    return text, None


def _part(held: Object, name: str) -> Shape:
    part: Shape = (*held.parts, *held.holes)[held.element_names.index(name)]
    return part


def _axis_of(shape: Shape, name: str, axis: int | None) -> int:
    if axis is None and isinstance(shape, Turned | Capsule):
        return AXES.index("z")
    return _named_axis(name, axis, f"a {shape.kind}")


def _named_axis(name: str, axis: int | None, what: str) -> int:
    if axis is None:
        raise ValueError(f"is {name!r}, {what}, which has more than one axis; write {name}.x, {name}.y or {name}.z")
    return axis


def _unknown_of_cage(scene: Scene, name: str, more: Iterable[str] = ()) -> str:
    if name in scene.object.element_names or name == OBJECT:
        return f"is {name!r}, which is of the object; name what is of the cage first, then what is of the object"
    return _unknown(name, "cage", (*scene.cage.element_names, *more))


def _unknown_of_object(scene: Scene, name: str, more: Iterable[str] = ()) -> str:
    cage, known = scene.cage, (*scene.object.element_names, *more)
    if name in cage.element_names or any(name == body.name for body in cage.bodies):
        return f"is {name!r}, which is of the cage; name what is of the object second: {few(known, SHOWN_NAMES)}"
    return _unknown(name, "object", known)


def _unknown(name: str, of: str, known: tuple[str, ...]) -> str:
    close = difflib.get_close_matches(name, known, n=1)
    meant = f"did you mean {close[0]}? " if close else ""
    return f"is {name!r}, no name of the {of}; {meant}use one of: {few(known, SHOWN_NAMES)}"

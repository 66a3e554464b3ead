"""The whole question: `Scene`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from inspect import signature
from typing import Any, get_args

import numpy as np

from cagepose.errors import Key, Problem, key_path
from cagepose.kernels.boundary.geometry import Geometry, empty_placement, overlap_at
from cagepose.kernels.boundary.overlap import empty_overlap_work
from cagepose.kernels.collision.boxes import BoxesAndPoints
from cagepose.kernels.collision.contacts import deepest_boxes
from cagepose.model.above import from_above
from cagepose.model.cage import Cage
from cagepose.model.checks import (
    ProblemList,
    check_choice,
    check_kind,
    check_kinds,
    check_mapping,
    check_text,
    duplicates,
    is_finite,
)
from cagepose.model.driven import check_driven
from cagepose.model.geometry import boxes_and_points, has_shapes, object_seams, scene_geometry, scene_size
from cagepose.model.hole import Hole
from cagepose.model.load import Load
from cagepose.model.methods import METHODS, Metric
from cagepose.model.naming import place_of
from cagepose.model.parts import Object
from cagepose.model.planar import AXES, LEAST_TILT, Planar, normal_axis, tilt
from cagepose.model.seams import Seams
from cagepose.model.shapes import Shape
from cagepose.model.tolerances import TOUCH_GREATEST, Tolerances
from cagepose.model.wording import few

FARTHEST_START = 1e4
"""In sizes of the scene. The rounding of a position 1e4 sizes away is about 2e-12 of the size, near the resolution."""
ASKEW = np.sqrt(np.array([1.0, 2.0, 3.0]) / 6.0)
"""A unit vector along which no two points of a grid lie at the same place."""


@dataclass(frozen=True)
class StartsInside(Problem):
    """An element of the cage and the object start in each other.

    Attributes
    ----------
    depth_m
        How deep, at least, metres.
    """

    depth_m: float


@dataclass(frozen=True)
class Adjustable:
    """A number of the scene file that sliders and studies may vary.

    Attributes
    ----------
    name
        Shown beside the slider.
    key
        Where the number stands in the scene file, such as ``cage.pose.euler_zyx_deg[1]``.
    low, high
        Its range, in the file's own unit.
    """

    name: str
    key: str
    low: float
    high: float


@dataclass(frozen=True, init=False, eq=False)
class Scene:
    """A part, a cage, and the loads that act one after the other. Checked once, here; it never changes.

    Attributes
    ----------
    object, cage, loads
        What is held, what holds it, what pushes.
    friction_coefficient
        None: each method's own default.
    friction_of
        Coefficients of single points and shapes of the cage, and of single boxes and shapes of the object, by name. A
        contact has that of the cage's, else that of the object's, else ``friction_coefficient``.
    method, metric
        How to run it; None: the default.
    planar
        The plane of the world that the object moves in, as two axes: it travels along these and turns about the third
        one; None: it has all six freedoms.
    tolerances
        What counts as touching and as grazing.
    left_out
        Names of what the scene's source has and the scene has not: each run warns of them.
    geometry
        The boundaries of object and cage, as the kernels take them.
    boxes
        Boxes, bridges over their seams and cage points, as the stepwise method and the search for a way out take them.
    open_seams
        Names of pairs of boxes that meet flush with outlines that cross: a point that moves exactly in their common
        plane would pass between them.
    size_m
        The greater of the object's and the cage's diameter (of a sphere about their middle), metres.
    has_other_shapes
        Whether the object has more than boxes, or the cage more than points.
    """

    object: Object
    cage: Cage
    loads: tuple[Load, ...]
    name: str
    friction_coefficient: float | None
    friction_of: dict[str, float]
    method: str | None
    metric: Metric | None
    planar: Planar | None
    tolerances: Tolerances
    adjustable: tuple[Adjustable, ...]
    left_out: tuple[str, ...]
    geometry: Geometry
    boxes: BoxesAndPoints
    open_seams: tuple[tuple[str, str], ...]
    size_m: float
    has_other_shapes: bool

    def __init__(
        self,
        object: Object,
        cage: Cage,
        loads: Iterable[Load],
        *,
        name: str = "scene",
        friction_coefficient: float | None = None,
        friction_of: Mapping[str, float] | None = None,
        method: str | None = None,
        metric: Metric | None = None,
        planar: Planar | None = None,
        tolerances: Tolerances | None = None,
        adjustable: Iterable[Adjustable] = (),
        left_out: Iterable[str] = (),
    ) -> None:
        """
        Raises
        ------
        SceneError
            Arguments of other classes, no loads, a phase name used twice, a negative friction coefficient, or one of
            what is neither in the cage nor in the object, cage points on top of each other, a cage point inside a box
            of the object at the start, a start too far from the cage, a box or shape thinner than what the touch
            tolerance can tell apart, a drive or a spring of a body that the cage does not have, a plane that the cage
            is tilted out of, or one in a scene whose cage is driven or presses.
        """
        tolerances = Tolerances() if tolerances is None else tolerances
        problems = ProblemList()
        loads = check_kinds(loads, Load, "loads", problems)
        check_kind(object, Object, ("object",), problems)
        check_kind(cage, Cage, ("cage",), problems)
        check_kind(tolerances, Tolerances, ("tolerances",), problems)
        check_text(name, ("name",), problems)
        adjustable = check_kinds(adjustable, Adjustable, "adjustable", problems)
        left_out = check_kinds(left_out, str, "left_out", problems)
        friction_of = {} if friction_of is None else friction_of
        check_mapping(friction_of, ("friction", "of"), problems)
        if method is not None:
            check_choice(method, METHODS, "method", problems)
        if metric is not None:
            check_choice(metric, get_args(Metric), "metric", problems)
        if planar is not None:
            check_choice(planar, get_args(Planar), "planar", problems)
        problems.raise_if_any()
        if not loads:
            problems.add(("loads",), "is empty; give at least one phase with gravity or a force")
        for load_name, indices in duplicates([load.name for load in loads]).items():
            problems.add(
                ("loads", indices[1], "name"), f"{load_name!r} is already the name of loads[{indices[0]}]; rename one"
            )
        if friction_coefficient is not None and not (is_finite(friction_coefficient) and friction_coefficient >= 0.0):
            problems.add(("friction",), f"is {friction_coefficient!r}; give a finite coefficient, zero or above")
        _check_friction_of(friction_of, object, cage, problems)
        size_m = scene_size(object, cage)
        touch_m = tolerances.touch * size_m
        _check_thickness(object, cage, touch_m, problems)
        _check_points_apart(cage, touch_m, problems)
        seams = Seams([], []) if has_shapes(object, cage) else object_seams(object, touch_m)
        geometry, boxes = scene_geometry(object, cage, touch_m), boxes_and_points(object, cage, seams.bridges)
        _check_distance(object, cage, size_m, problems)
        if has_shapes(object, cage):
            _check_shapes_apart(object, cage, geometry, problems)
        else:
            _check_points_outside(object, cage, boxes, touch_m, size_m, problems)
        check_driven(cage, loads, problems)
        if planar is not None:
            _check_planar(planar, cage, loads, problems)
        _check_loads(object, cage, loads, touch_m, problems)
        problems.raise_if_any()
        named = object.boxes
        for field, value in (
            ("object", object),
            ("cage", cage),
            ("loads", loads),
            ("name", name),
            ("friction_coefficient", None if friction_coefficient is None else float(friction_coefficient)),
            ("friction_of", {name: float(coefficient) for name, coefficient in friction_of.items()}),
            ("method", method),
            ("metric", metric),
            ("planar", planar),
            ("tolerances", tolerances),
            ("adjustable", adjustable),
            ("left_out", left_out),
            ("geometry", geometry),
            ("boxes", boxes),
            ("open_seams", tuple((str(named[one].name), str(named[other].name)) for one, other in seams.open_pairs)),
            ("size_m", size_m),
            ("has_other_shapes", bool(object.shapes or object.holes or cage.shapes or cage.holes)),
        ):
            _set_field(self, field, value)

    def __repr__(self) -> str:
        loads = f"{'load' if len(self.loads) == 1 else 'loads'} {few(load.name for load in self.loads)}"
        return f"<Scene {self.name!r}: {self.object._contents} in a cage of {self.cage._contents}, {loads}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: a picture."""
        html: str = from_above("scene as html")(self)
        return html

    def changed(
        self,
        key: str | Mapping[str, Any] | None = None,
        value: Any = None,
        *,
        friction_coefficient: float | None = None,
        metric: Metric | None = None,
        tolerances: Tolerances | None = None,
    ) -> Scene:
        """Return the same scene but for what is given.

        ``key`` is a path as in a scene file, such as ``"object.boxes[0].size[2]"``, or a mapping of several paths and
        their values, which change together. Lengths are metres, as everywhere in Python; a key that ends in ``_deg``
        takes degrees. None stands for what a file leaves out.

        >>> from cagepose.model.box import Box
        >>> from cagepose.model.pose import Pose
        >>> cube = Object([Box((1, 1, 1))], pose=Pose((0, 0, 2)))
        >>> scene = Scene(cube, Cage([(0, 0, 0)]), [Load("weight", gravity=(0, 0, -1))])
        >>> scene.changed("object.mass", 2.0).object
        <Object: 1 box, 2 kg>
        >>> scene.changed({"object.pose.position[2]": 3.0, "cage.pose.position[2]": 1.0}).object.pose_world_object
        <Pose (0, 0, 3) m>

        Raises
        ------
        SceneError
            As for a new scene; or a key that is none.
        """
        changed: Scene = self
        if key is not None:
            changed = from_above("changed scene")(self, key if isinstance(key, Mapping) else {key: value})
        given = {"friction_coefficient": friction_coefficient, "metric": metric, "tolerances": tolerances}
        others = {name: value for name, value in given.items() if value is not None}
        return changed.but_for(**others) if others else changed

    def but_for(self, **others: Any) -> Scene:
        """Return the scene made again with other arguments, by their names.

        Raises
        ------
        SceneError
            As for a new scene.
        """
        return Scene(**{name: getattr(self, name) for name in _arguments()} | others)

    @property
    def touch_m(self) -> float:
        """The touch tolerance as a length, metres."""
        return self.tolerances.touch * self.size_m


_set_field = object.__setattr__


@cache
def _arguments() -> tuple[str, ...]:
    """Return what a scene is made of, by name."""
    return tuple(signature(Scene).parameters)


def _check_friction_of(friction_of: Mapping[str, float], held: Object, cage: Cage, problems: ProblemList) -> None:
    elements, parts = set(cage.element_names), set(held.element_names)
    for name, coefficient in friction_of.items():
        at = ("friction", "of", name)
        if name in elements and name in parts:
            problems.add(at, "is a name in the cage and in the object; rename one of the two")
        elif name not in elements and name not in parts:
            problems.add(at, "is neither in the cage nor in the object; give the name of a point, a box or a shape")
        if not (is_finite(coefficient) and coefficient >= 0.0):
            problems.add(at, f"is {coefficient!r}; give a finite coefficient, zero or above")


def _check_planar(planar: Planar, cage: Cage, loads: tuple[Load, ...], problems: ProblemList) -> None:
    for index, load in enumerate(loads):
        for key, verb in (("drive", "drives"), ("press", "presses")):
            if getattr(load, key):
                problems.add(
                    ("loads", index, key),
                    f"{load.name!r} {verb} a body, which is not known in a plane; leave planar out of the scene",
                )
    tilt_rad = tilt(planar, cage.pose_world_cage)
    if tilt_rad > LEAST_TILT:
        problems.add(
            ("cage", "pose"),
            f"tilts the cage by {math.degrees(tilt_rad):.3g} degrees out of the plane {planar};"
            f" turn it about {AXES[normal_axis(planar)]} alone, or leave planar out of the scene",
        )


def _check_thickness(held: Object, cage: Cage, touch_m: float, problems: ProblemList) -> None:
    least_m = 10.0 * touch_m  # so that a point on one face is clear of the opposite one, and of probes from it
    shapes: list[tuple[tuple[Key, ...], Shape]] = [
        (("object", *path), part) for path, part in zip(held.part_paths, (*held.parts, *held.holes), strict=True)
    ]
    shapes += [
        (("cage", *path), shape) for path, shape in zip(cage.shape_paths, (*cage.shapes, *cage.holes), strict=True)
    ]
    for path, shape in shapes:
        for key, thickness in shape.thickness():
            if thickness < least_m:
                problems.add(
                    (*path, *key),
                    f"is {millimetres(thickness)}, too thin to tell its two faces apart (at least"
                    f" {millimetres(least_m)}, ten times the touch tolerance); thicken the {shape.kind} or lower"
                    " tolerances.touch",
                )


def _check_points_apart(cage: Cage, touch_m: float, problems: ProblemList) -> None:
    """Tell of each point that lies on another one of its body, once, however many lie there.

    Points are sorted along one line and compared with their neighbours on it, so that thousands stay cheap. One that is
    to be removed is compared no more: n points at one place are n comparisons and n problems, not n^2.
    """
    points, names, bodies = cage.points_cage, cage.names, cage.element_bodies
    if not names:
        return
    along = (points - points[0]) @ ASKEW
    order = np.argsort(along, kind="stable").tolist()
    near = np.searchsorted(along[order], along[order] + 2.0 * touch_m, side="right").tolist()  # twice: rounding
    is_told = [False] * len(order)
    for place, first in enumerate(order):
        for second in order[place + 1 : near[place]] if not is_told[first] else ():
            if is_told[second] or bodies[first] != bodies[second]:
                continue
            if (distance := math.dist(points[first], points[second])) > touch_m:
                continue
            one, other = sorted((first, second))
            problems.add(
                ("cage", *cage.element_paths[other]),
                f"lies {millimetres(distance)} from {names[one]}, so they are one point; remove or move one",
            )
            is_told[other] = True
            if other == first:
                break


def _check_distance(held: Object, cage: Cage, size_m: float, problems: ProblemList) -> None:
    """A start far from the cage leaves too few digits for the contact at the end of the first travel."""
    middle = held.pose_world_object.transform((*held.parts, *held.holes)[0].pose_body_shape.position_m)
    nodes_world = cage.pose_world_cage.transform(cage.nodes_cage())
    distance = float(np.linalg.norm(middle - nodes_world.mean(axis=0)))
    if distance > FARTHEST_START * size_m:
        problems.add(
            ("object", "pose", "position"),
            f"starts {millimetres(distance)} from the cage, more than {FARTHEST_START:g} times the scene's size;"
            " start nearer",
        )


def _check_points_outside(
    held: Object, cage: Cage, boxes: BoxesAndPoints, touch_m: float, size_m: float, problems: ProblemList
) -> None:
    depths, deepest = deepest_boxes(boxes, *held.pose_world_object.as_tuples())
    for point_index in np.nonzero(depths > touch_m)[0].tolist():
        box = int(deepest[point_index])
        if box < len(held.boxes):
            path = key_path(("object", *place_of(held.part_paths[box])))
            where = f"starts {millimetres(depths[point_index])} inside {path} ({held.boxes[box].name})"
        else:
            where = "starts in the seam between two boxes that meet flush, so inside the object"
        remedy = "move the point out or move the object's start pose"
        if depths[point_index] <= TOUCH_GREATEST * size_m:
            remedy = "move the point out, move the object's start pose, or raise tolerances.touch"
        problems.add(("cage", *cage.element_paths[point_index]), f"{where}; {remedy}")


def _check_shapes_apart(held: Object, cage: Cage, geometry: Geometry, problems: ProblemList) -> None:
    """Tell of the part of the object that starts deepest in a part of the cage."""
    feature, cage_feature, depth_m = overlap_at(
        geometry,
        *held.pose_world_object.as_tuples(),
        empty_placement(geometry),
        empty_overlap_work(geometry.held, geometry.cage.own, len(geometry.cage.first_nodes) - 1),
    )
    if feature < 0:
        return
    one = _solid_of(held.holes, held.element_names, geometry.held.features[feature].part)
    other = _solid_of(cage.holes, cage.element_names, geometry.cage.own.features[cage_feature].part)
    part = key_path(("object", *place_of(held.part_paths[one])))
    is_point = other < len(cage.names)
    what, remedy = ("", "move the point") if is_point else (f"{cage.element_names[other]} ", "move it")
    message = (
        f"{what}starts {millimetres(depth_m)} inside {part} ({held.element_names[one]}); {remedy} out or move the"
        " object's start pose"
    )
    problems.problems.append(StartsInside(("cage", *cage.element_paths[other]), message, depth_m))


def _solid_of(holes: Sequence[Hole], names: Sequence[str], which: int) -> int:
    """Return the part that is in the way where an element of a body is: of a hole, the first that it is cut out of."""
    first_hole = len(names) - len(holes)
    if which < first_hole or not holes[which - first_hole].in_:
        return which
    return names.index(holes[which - first_hole].in_[0])


def _check_loads(held: Object, cage: Cage, loads: tuple[Load, ...], touch_m: float, problems: ProblemList) -> None:
    known = {None, *(body.name for body in cage.bodies)}
    for index, load in enumerate(loads):
        if load.needs_newtons and load.gravity_world is not None and held.mass_kg is None:
            problems.add(
                ("object", "mass"),
                f"is missing, and gravity acts beside other loads in loads[{index}] ({load.name}); give kilograms",
            )
        for number, spring in enumerate(load.springs):
            at = held.pose_world_object.transform(spring.at_object_m)
            if spring.of in known and float(np.linalg.norm(cage.spring_end_world(spring) - at)) <= touch_m:
                problems.add(
                    ("loads", index, "springs", number, "to"),
                    "lies where the spring holds the object at the start, so it has no direction; move to or at",
                )


def millimetres(length_m: float) -> str:
    """A length for an error message.

    >>> millimetres(0.00042)
    '0.42 mm'
    """
    return f"{length_m * 1000.0:.6g} mm"

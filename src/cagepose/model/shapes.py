"""Shapes of parts and cages: `Sphere`, `Capsule`, `Cylinder`, `Cone`, `Convex`, `Disc`.

Two families. The hull of some points, blown up by a radius (sphere, capsule, convex): `core` has the points. And
what a straight line makes that turns about the shape's z axis (cylinder, cone, disc): `rims` has its round edges. A
`Box` stands beside them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, wraps
from typing import Annotated, ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cagepose.errors import Key
from cagepose.model.checks import FloatArray, ProblemList, check_kind, check_text, finite_array, is_finite, number_found
from cagepose.model.hull import Hull, hull_of
from cagepose.model.pose import Pose
from cagepose.model.tolerances import DISTANCE_OUTSIDE

Of = TypeVar("Of", bound="Shape")
KNOWN = "_known"
"""Where a shape keeps what was worked out of it; one that is moved begins anew."""


def worked_out_once(method: Callable[[Of], FloatArray]) -> Callable[[Of], FloatArray]:
    """Keep what a shape, which never changes, says of its place; the array cannot be written to."""
    name = method.__name__

    @wraps(method)
    def kept(shape: Of) -> FloatArray:
        known: dict[str, FloatArray] = shape.__dict__.setdefault(KNOWN, {})
        if name not in known:
            known[name] = method(shape)
            known[name].setflags(write=False)
        return known[name]

    return kept


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Shape(ABC):
    """What all shapes have.

    Attributes
    ----------
    kind
        As in a scene file: "sphere", ...
    is_convex
        Whether a straight line between two of its points is in it.
    pose_body_shape
        Places the shape in the frame of its body: the object or the cage.
    name
        Shown with its contacts; None becomes the kind and a number ("cylinder1") inside an `Object` or a `Cage`.
    """

    kind: ClassVar[str]
    is_convex: ClassVar[bool] = True
    pose_body_shape: Pose
    name: str | None

    def __repr__(self) -> str:
        name = "" if self.name is None else f" {self.name!r}"
        return f"<{type(self).__name__}{name}: {self._measures()}>"

    def _measures(self) -> str:
        """Return the numbers that make the shape, in words."""
        lengths = {key.removesuffix("_m"): value for key, value in vars(self).items() if key.endswith("_m")}
        return ", ".join(f"{key.replace('_', ' ')} {value:.6g} m" for key, value in lengths.items())

    def _place(self, pose: Pose | None, name: str | None, problems: ProblemList) -> None:
        """Set what all shapes have; raise what was found wrong with the whole shape."""
        pose = Pose() if pose is None else pose
        check_kind(pose, Pose, ("pose",), problems)
        if name is not None:
            check_text(name, ("name",), problems)
        problems.raise_if_any()
        _set_field(self, "pose_body_shape", pose)
        _set_field(self, "name", name)

    @property
    def form(self) -> tuple[object, ...]:
        """Kind and measures: shapes of the same form differ in place and name alone."""
        measures = (value for key, value in sorted(vars(self).items()) if key.endswith("_m") or key == "chamfer")
        return self.kind, *(value.tobytes() if isinstance(value, np.ndarray) else value for value in measures)

    @abstractmethod
    def nodes_body(self) -> FloatArray:
        """Points that tell where the shape lies, in its body's frame, (n, 3), metres: the core's, the rims' centres."""

    @abstractmethod
    def farthest_m(self, point_body: FloatArray) -> float:
        """Return the distance of the shape's farthest point from a point (3,) of its body's frame, metres."""

    def heights_m(self, directions_body: FloatArray) -> FloatArray:
        """Return how far the shape reaches along unit vectors (n, 3) of its body's frame, (n,), metres."""
        heights: FloatArray = (directions_body @ self.nodes_body().T).max(axis=1)
        return heights

    @worked_out_once
    def limits_m(self) -> FloatArray:
        """Return the lowest and the highest coordinates of the shape in its body's frame, (2, 3), metres."""
        ends: FloatArray = np.array([-self.heights_m(-np.eye(3)), self.heights_m(np.eye(3))])
        return ends

    def reach_m(self, point_body: FloatArray, direction_body: FloatArray) -> float:
        """Return how far the shape reaches from a point (3,) of its body's frame along a unit vector, metres."""
        return float(self.heights_m(direction_body[None])[0] - point_body @ direction_body)

    @abstractmethod
    def holds(self, points_body: FloatArray) -> NDArray[np.bool_]:
        """Return which of some points (n, 3) of the body's frame lie in the shape, (n,); of the rounding of a hull,
        only what lies above its faces counts.
        """

    @abstractmethod
    def thickness(self) -> list[tuple[tuple[Key, ...], float]]:
        """Return how thick the shape is from side to side, metres, each with the path of the number that says so."""

    def renamed(self, name: str) -> Self:
        """Return the same shape with another name."""
        return self._with(name=name)

    def moved(self, pose_body_shape: Pose) -> Self:
        """Return the same shape elsewhere in its body."""
        return self._with(pose_body_shape=pose_body_shape)

    def _with(self, **changes: object) -> Self:
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__, **changes)
        other.__dict__.pop(KNOWN, None)
        return other


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Rounded(Shape):
    """The hull of points, blown up by a radius."""

    radius_m: float

    @abstractmethod
    def core(self) -> FloatArray:
        """The points in the shape's own frame, (n, 3), metres."""

    @worked_out_once
    def nodes_body(self) -> FloatArray:
        return self.pose_body_shape.transform(self.core())

    def farthest_m(self, point_body: FloatArray) -> float:
        return float(np.linalg.norm(self.nodes_body() - point_body, axis=1).max()) + self.radius_m

    def heights_m(self, directions_body: FloatArray) -> FloatArray:
        return super().heights_m(directions_body) + self.radius_m

    def holds(self, points_body: FloatArray) -> NDArray[np.bool_]:
        core = self.core()
        points = self.pose_body_shape.inverse_transform(points_body) - core[0]
        span = core[-1] - core[0]
        share = np.clip(points @ span / max(float(span @ span), np.finfo(float).tiny), 0.0, 1.0)
        distances = np.linalg.norm(points - share[:, None] * span, axis=1)
        within: NDArray[np.bool_] = distances <= self.radius_m * (1.0 + DISTANCE_OUTSIDE)
        return within

    def thickness(self) -> list[tuple[tuple[Key, ...], float]]:
        return [(("radius",), 2.0 * self.radius_m)]


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Turned(Shape):
    """What a straight line makes that turns about the shape's z axis, with flat ends."""

    @property
    @abstractmethod
    def rims(self) -> tuple[tuple[float, float], ...]:
        """Height z and radius of each end, from below, metres; a radius of zero is a tip."""

    @worked_out_once
    def nodes_body(self) -> FloatArray:
        return self.pose_body_shape.transform(np.array([(0.0, 0.0, height) for height, _ in self.rims]))

    def farthest_m(self, point_body: FloatArray) -> float:
        x, y, z = self.pose_body_shape.inverse_transform(point_body).tolist()
        return max(float(np.hypot(np.hypot(x, y) + radius, z - height)) for height, radius in self.rims)

    def heights_m(self, directions_body: FloatArray) -> FloatArray:
        axis = self.pose_body_shape.rotation[:, 2]
        across = np.linalg.norm(directions_body - np.outer(directions_body @ axis, axis), axis=1)
        rises = np.outer(across, [radius for _, radius in self.rims])
        heights: FloatArray = (directions_body @ self.nodes_body().T + rises).max(axis=1)
        return heights

    def holds(self, points_body: FloatArray) -> NDArray[np.bool_]:
        x, y, z = self.pose_body_shape.inverse_transform(points_body).T
        heights, radii = np.array(self.rims).T
        slack = DISTANCE_OUTSIDE * (heights[-1] - heights[0] + radii.max())
        is_beside = np.hypot(x, y) <= np.interp(z, heights, radii) + slack
        within: NDArray[np.bool_] = is_beside & (z >= heights[0] - slack) & (z <= heights[-1] + slack)
        return within

    def thickness(self) -> list[tuple[tuple[Key, ...], float]]:
        heights, radii = zip(*self.rims, strict=True)
        along = [(("length",), heights[-1] - heights[0])] if len(heights) > 1 else []
        return [(("radius",), 2.0 * max(radii)), *along]


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Sphere(Rounded):
    """A ball about the shape's origin.

    Attributes
    ----------
    radius_m
        Metres.
    """

    kind: ClassVar[str] = "sphere"

    def __init__(self, radius_m: float, pose_body_shape: Pose | None = None, name: str | None = None) -> None:
        """
        Raises
        ------
        SceneError
            A radius that is not a finite number above zero.
        """
        problems = ProblemList()
        set_lengths(self, problems, radius=radius_m)
        self._place(pose_body_shape, name, problems)

    def core(self) -> FloatArray:
        return np.zeros((1, 3))


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Capsule(Rounded):
    """A round bar with round ends, along z, its middle at the shape's origin.

    Attributes
    ----------
    radius_m
        Metres.
    length_m
        Between the centres of the two round ends, metres.
    """

    kind: ClassVar[str] = "capsule"
    length_m: float

    def __init__(
        self, radius_m: float, length_m: float, pose_body_shape: Pose | None = None, name: str | None = None
    ) -> None:
        """
        Raises
        ------
        SceneError
            A radius or a length that is not a finite number above zero.
        """
        problems = ProblemList()
        set_lengths(self, problems, radius=radius_m, length=length_m)
        self._place(pose_body_shape, name, problems)

    def core(self) -> FloatArray:
        return np.array([(0.0, 0.0, -self.length_m / 2.0), (0.0, 0.0, self.length_m / 2.0)])


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Convex(Rounded):
    """The convex hull of some points, blown up by a radius.

    Attributes
    ----------
    vertices_m
        The points in the shape's own frame, (n, 3), metres; those inside the hull change nothing.
    radius_m
        Metres; zero: sharp edges. With a radius the points need not span a volume: a single one makes a ball, two a
        round bar, those of a polygon a plate with round edges.
    """

    kind: ClassVar[str] = "convex"
    vertices_m: Annotated[FloatArray, (-1, 3)]

    def __init__(
        self,
        vertices_m: ArrayLike,
        radius_m: float = 0.0,
        pose_body_shape: Pose | None = None,
        name: str | None = None,
    ) -> None:
        """
        Raises
        ------
        SceneError
            Vertices that are not n x 3 finite numbers, a radius below zero, or vertices that span no volume without a
            radius.
        """
        problems = ProblemList()
        vertices = finite_array(vertices_m, (-1, 3), "vertices")
        set_lengths(self, problems, may_be_zero=("radius",), radius=radius_m)
        _set_field(self, "vertices_m", vertices)
        if not problems.problems and self.radius_m == 0.0 and self.hull.dimension < 3:
            where = ("lie at one place", "lie on one line", "lie in one plane")[self.hull.dimension]
            found = "are a single point, which has" if len(vertices) == 1 else f"{where}, so they have"
            problems.add(("vertices",), f"{found} no volume; add a vertex elsewhere, or give the shape a radius")
        elif not problems.problems and not self.hull.has_sides:
            problems.add(("vertices",), "lie too far from each other beside how near others are; check the farthest")
        self._place(pose_body_shape, name, problems)

    def _measures(self) -> str:
        rounded = f", radius {self.radius_m:.6g} m" if self.radius_m else ""
        return f"{len(self.vertices_m)} vertices{rounded}"

    @cached_property
    def hull(self) -> Hull:
        """Corners, edges and faces of the hull, in the shape's own frame."""
        return hull_of(self.vertices_m)

    def core(self) -> FloatArray:
        return self.hull.vertices_m

    def holds(self, points_body: FloatArray) -> NDArray[np.bool_]:
        hull = self.hull
        if hull.dimension < 2:
            return super().holds(points_body)
        points = self.pose_body_shape.inverse_transform(points_body)
        slack = DISTANCE_OUTSIDE * float(np.ptp(hull.vertices_m, axis=0).max())
        on_faces = hull.vertices_m[[loop[0] for loop in hull.faces]]
        heights = hull.normals @ points.T - np.einsum("ij,ij->i", hull.normals, on_faces)[:, None]
        within: NDArray[np.bool_] = heights.max(axis=0) <= slack
        for loop, normal, height in zip(hull.faces, hull.normals, heights, strict=True):
            corners = hull.vertices_m[list(loop)]
            inwards = np.cross(normal, np.roll(corners, -1, axis=0) - corners)
            sides = np.einsum("ijk,jk->ij", points[:, None] - corners, inwards) / np.linalg.norm(inwards, axis=1)
            within |= (sides.min(axis=1) >= -slack) & (height >= -slack) & (height <= self.radius_m + slack)
        return within

    def thickness(self) -> list[tuple[tuple[Key, ...], float]]:
        if self.hull.dimension < 3:
            return super().thickness()
        across_faces = np.ptp(self.hull.normals @ self.hull.vertices_m.T, axis=1)
        return [(("vertices",), float(across_faces.min()) + 2.0 * self.radius_m)]


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Cylinder(Turned):
    """A round bar with flat ends and sharp rims, along z, its middle at the shape's origin.

    Attributes
    ----------
    radius_m, length_m
        Metres.
    """

    kind: ClassVar[str] = "cylinder"
    radius_m: float
    length_m: float

    def __init__(
        self, radius_m: float, length_m: float, pose_body_shape: Pose | None = None, name: str | None = None
    ) -> None:
        """
        Raises
        ------
        SceneError
            A radius or a length that is not a finite number above zero.
        """
        problems = ProblemList()
        set_lengths(self, problems, radius=radius_m, length=length_m)
        self._place(pose_body_shape, name, problems)

    @property
    def rims(self) -> tuple[tuple[float, float], ...]:
        return (-self.length_m / 2.0, self.radius_m), (self.length_m / 2.0, self.radius_m)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Cone(Turned):
    """A frustum of a cone with flat ends, along z, its middle at the shape's origin.

    Attributes
    ----------
    radius_bottom_m
        At z = -length / 2, metres; zero: a tip.
    radius_top_m
        At z = length / 2, metres; zero: a tip. Two equal radii make a cylinder.
    length_m
        Metres.
    """

    kind: ClassVar[str] = "cone"
    radius_bottom_m: float
    radius_top_m: float
    length_m: float

    def __init__(
        self,
        radius_bottom_m: float,
        radius_top_m: float,
        length_m: float,
        pose_body_shape: Pose | None = None,
        name: str | None = None,
    ) -> None:
        """
        Raises
        ------
        SceneError
            A radius below zero, both zero, or a length that is not a finite number above zero.
        """
        problems = ProblemList()
        set_lengths(
            self,
            problems,
            may_be_zero=("radius_bottom", "radius_top"),
            radius_bottom=radius_bottom_m,
            radius_top=radius_top_m,
            length=length_m,
        )
        if not problems.problems and self.radius_bottom_m == self.radius_top_m == 0.0:
            problems.add(
                ("radius_bottom",), "is zero like radius_top, which leaves a line; give one of them above zero"
            )
        self._place(pose_body_shape, name, problems)

    @property
    def rims(self) -> tuple[tuple[float, float], ...]:
        return (-self.length_m / 2.0, self.radius_bottom_m), (self.length_m / 2.0, self.radius_top_m)

    def thickness(self) -> list[tuple[tuple[Key, ...], float]]:
        widest = max((self.radius_bottom_m, "radius_bottom"), (self.radius_top_m, "radius_top"))
        return [((widest[1],), 2.0 * widest[0]), (("length",), self.length_m)]


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Disc(Turned):
    """A flat round disc without thickness, across z, its middle at the shape's origin.

    Attributes
    ----------
    radius_m
        Metres.
    """

    kind: ClassVar[str] = "disc"
    radius_m: float

    def __init__(self, radius_m: float, pose_body_shape: Pose | None = None, name: str | None = None) -> None:
        """
        Raises
        ------
        SceneError
            A radius that is not a finite number above zero.
        """
        problems = ProblemList()
        set_lengths(self, problems, radius=radius_m)
        self._place(pose_body_shape, name, problems)

    @property
    def rims(self) -> tuple[tuple[float, float], ...]:
        return ((0.0, self.radius_m),)


AnyShape = Sphere | Capsule | Convex | Cylinder | Cone | Disc
"""All but `Box`."""

_set_field = object.__setattr__


def set_lengths(shape: Shape, problems: ProblemList, *, may_be_zero: Sequence[str] = (), **lengths_m: float) -> None:
    """Check lengths and set each as the field of its key with its unit."""
    for key, length in lengths_m.items():
        if not is_finite(length) or length < 0.0 or (length == 0.0 and key not in may_be_zero):
            limit = "zero or above" if key in may_be_zero else "above zero"
            problems.add((key,), f"is {number_found(length)}; give a finite number of metres, {limit}")
        else:
            _set_field(shape, f"{key}_m", float(length))

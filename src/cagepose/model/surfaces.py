"""The surfaces that triangles stand for: planes, cylinders, cones, spheres and tori, as CAD has them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cagepose.errors import Key
from cagepose.model.checks import FloatArray, ProblemList, unit_rows
from cagepose.model.pose import Pose

PLANE, CYLINDER, CONE, SPHERE, TORUS = "plane", "cylinder", "cone", "sphere", "torus"
KINDS = PLANE, CYLINDER, CONE, SPHERE, TORUS
STEEPEST = 1e3
"""Slope of a cone: one that is flatter is a plane."""
ROUNDING = 1e-14
"""Fraction of the greatest coordinate that places are off their surface by rounding."""


@dataclass(frozen=True)
class Surface:
    """A surface without ends, in the frame of the shape that has it.

    Attributes
    ----------
    kind
        "plane", "cylinder", "cone", "sphere" or "torus".
    point_m
        A point of the plane or of the axis, or the centre, (3,), metres.
    axis
        Unit vector: the outward normal of a plane, the direction of an axis, (3,). Of a sphere: zero.
    radius_m
        Of a cylinder or a sphere; of a cone at its point; of the tube of a torus, metres; below zero where the material
        is outside.
    slope
        By how much the radius of a cone grows (in size) for a metre along its axis.
    core_m
        Radius of the circle in the middle of the tube of a torus, metres. If it is less than that of the tube, the
        torus is what is on the circle's own side of the axis.
    """

    kind: str
    point_m: tuple[float, float, float]
    axis: tuple[float, float, float]
    radius_m: float = 0.0
    slope: float = 0.0
    core_m: float = 0.0

    @property
    def is_round(self) -> bool:
        return self.kind != PLANE

    def heights(self, points_m: FloatArray) -> FloatArray:
        """Return how far points (n, 3) are from the surface, above zero outside of the material, (n,), metres."""
        seen = points_m - np.array(self.point_m)
        along = seen @ np.array(self.axis)
        sense = math.copysign(1.0, self.radius_m)
        if self.kind == PLANE:
            level: FloatArray = along
            return level
        if self.kind == SPHERE:
            found: FloatArray = sense * np.linalg.norm(seen, axis=-1) - self.radius_m
            return found
        across = np.linalg.norm(seen - along[..., None] * np.array(self.axis), axis=-1)
        if self.kind == TORUS:
            above: FloatArray = sense * np.hypot(across - self.core_m, along) - self.radius_m
            return above
        off: FloatArray = sense * (across - (abs(self.radius_m) + self.slope * along)) / math.hypot(1.0, self.slope)
        return off

    def normals(self, points_m: FloatArray) -> FloatArray:
        """Return the outward unit normals at points of it, (n, 3)."""
        axis, seen = np.array(self.axis), points_m - np.array(self.point_m)
        if self.kind == PLANE:
            return np.broadcast_to(axis, seen.shape).copy()
        sense = math.copysign(1.0, self.radius_m)
        across = seen - (seen @ axis)[..., None] * axis
        out = unit_rows(np.where(np.linalg.norm(across, axis=-1, keepdims=True) > 0.0, across, 1.0))
        if self.kind == TORUS:
            around: FloatArray = sense * unit_rows(seen - self.core_m * out)
            return around
        normals: FloatArray = sense * (out - self.slope * axis) / math.hypot(1.0, self.slope)
        return normals

    def radius_at(self, point_m: FloatArray) -> float:
        """Return the radius of a cylinder or a cone at the height of a point, metres, not below zero."""
        along = float((point_m - np.array(self.point_m)) @ np.array(self.axis))
        return max(0.0, abs(self.radius_m) + self.slope * along)

    def changed(self, factor: float, pose: Pose) -> Surface:
        """Return it with lengths times a factor, and then moved."""
        point = pose.transform(factor * np.array(self.point_m))
        axis = pose.rotation @ np.array(self.axis)
        sizes = factor * self.radius_m, factor * self.core_m
        return replace(self, point_m=three(point), axis=three(axis), radius_m=sizes[0], core_m=sizes[1])


def three(values: ArrayLike) -> tuple[float, float, float]:
    """Return three numbers as a surface has them."""
    x, y, z = np.asarray(values, dtype=np.float64).tolist()
    return x, y, z


def checked_surfaces(
    surfaces: Sequence[Surface], surface_of: ArrayLike, n_triangles: int, problems: ProblemList
) -> tuple[tuple[Surface, ...], NDArray[np.int64]]:
    """Return surfaces and which of them each triangle stands for, -1: none; note what cannot be."""
    found = tuple(surfaces) if isinstance(surfaces, tuple | list) else ()
    where: tuple[Key, ...] = ("surfaces",)
    if not all(isinstance(surface, Surface) for surface in found):
        problems.add(where, "is no list of surfaces; give a Surface each")
        found = ()
    for index, surface in enumerate(found):
        numbers = _numbers_of(surface)
        if numbers is None:
            problems.add((*where, index), "has no three numbers for its point and its axis, and one for its radius")
        elif surface.kind not in KINDS:
            problems.add((*where, index), f"is a {surface.kind!r}; give one of: {', '.join(KINDS)}")
        elif not np.isfinite(numbers).all() or abs(surface.slope) > STEEPEST:
            problems.add((*where, index), "has numbers that are not finite, or too large; correct them")
        elif surface.kind in (CYLINDER, SPHERE, TORUS) and surface.radius_m == 0.0:
            problems.add((*where, index), "has no radius; give one")
        elif surface.kind == TORUS and surface.core_m <= 0.0:
            problems.add((*where, index), "is a torus without a circle in its middle; give its radius, above zero")
        elif surface.kind != SPHERE and abs(math.hypot(*surface.axis) - 1.0) > 1e-9:
            problems.add((*where, index), "has an axis that is no unit vector; divide it by its length")
    given = np.asarray(surface_of if found else np.full(n_triangles, -1)).reshape(-1)
    of = given.astype(np.int64) if given.dtype.kind in "iu" else np.zeros(0, np.int64)
    if len(of) != n_triangles or of.min(initial=-1) < -1 or of.max(initial=-1) >= len(found):
        problems.add(("on",), f"does not give one of {len(found)} surfaces, or -1, for each of {n_triangles} triangles")
        of = np.full(n_triangles, -1, np.int64)
    of.setflags(write=False)
    return found, of


def _numbers_of(surface: Surface) -> FloatArray | None:
    """Return the nine numbers of a surface; None: it has others."""
    try:
        sizes = surface.radius_m, surface.slope, surface.core_m
        found = np.array([*surface.point_m, *surface.axis, *sizes], np.float64)
    except (TypeError, ValueError):
        return None
    return found if found.shape == (9,) else None


def check_on_surfaces(
    corners_m: FloatArray, surfaces: Sequence[Surface], on: NDArray[np.int64], flat_m: float, problems: ProblemList
) -> None:
    """Note surfaces that are not where the triangles are that stand for them, or face the other way.

    ``corners_m`` has those of all triangles, (n, 3, 3), and ``on`` the surface of each, -1: none. What is ``flat_m``
    near to a surface is on it, give or take rounding.
    """
    for index, surface in enumerate(surfaces):
        own = corners_m[on == index]
        off = float(np.abs(surface.heights(own.reshape(-1, 3))).max(initial=0.0))
        areas = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0])
        if off > flat_m + ROUNDING * float(np.abs(corners_m).max()):
            found = f"is up to {off:.3g} m from the corners of triangles that stand for it"
            problems.add(("surfaces", index), f"{found}, more than flat, {flat_m:.3g} m; correct it, or on")
        elif float(np.einsum("ij,ij->", areas, surface.normals(own.mean(axis=1)))) < 0.0:
            problems.add(
                ("surfaces", index), "faces away from its triangles; turn its normal, or make it hollow or not"
            )

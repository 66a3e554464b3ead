"""A round hole in a part: `Hole`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cagepose.errors import Key
from cagepose.model.checks import FloatArray, ProblemList, check_kind, check_kinds, degrees_of, is_finite
from cagepose.model.near_pairs import near_pairs
from cagepose.model.pose import Pose
from cagepose.model.shapes import Shape, Turned, set_lengths
from cagepose.model.tolerances import DISTANCE_OF_FACE

CORNERS_OF_CIRCLE = 64
"""Corners of the polygon around a circle that stands for it where a hole is looked for within a part."""
RING = np.array([(math.cos(t), math.sin(t), 0.0) for t in np.linspace(0.0, 2.0 * math.pi, CORNERS_OF_CIRCLE + 1)[:-1]])
"""Points of a circle that stand for all of them, (n, 3)."""
RADII_OF_SAMPLES = (0.0, 0.5, 1.0)
"""In radii of the hole. Circles of points lie throughout a hole at these."""
HEIGHTS_BETWEEN = 16
"""Heights between two ends of parts, or circles, at which it is asked what ends in a hole."""
SHARE_OF_RADIUS = 0.999
"""Share of the radius. What ends on the wall of a hole, farther out, is not in it."""


@dataclass(frozen=True)
class Chamfer:
    """The cone that widens the mouth of a hole.

    Attributes
    ----------
    width_m
        How much wider the radius is at the mouth, metres.
    angle_rad
        Between the cone's wall and the hole's axis, radians.
    """

    width_m: float
    angle_rad: float


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Hole(Turned):
    """A round hole with a flat bottom: along z, its mouth at z = 0, its bottom at z = -depth.

    Attributes
    ----------
    radius_m, depth_m
        Metres.
    chamfer
        None: the rim of the mouth is sharp.
    in_
        Names of the boxes and shapes of its own body that it is cut out of; its mouth is on their face. None: it stands
        alone, solid all around from z = -depth to 0, flat on top and open below; what is around it has no weight.
    """

    kind: ClassVar[str] = "hole"
    radius_m: float
    depth_m: float
    chamfer: Chamfer | None
    in_: tuple[str, ...]

    def __init__(
        self,
        radius_m: float,
        depth_m: float,
        chamfer: Chamfer | None = None,
        in_: Sequence[str] = (),
        pose_body_shape: Pose | None = None,
        name: str | None = None,
    ) -> None:
        """
        Raises
        ------
        SceneError
            A radius or a depth that is not a finite number above zero, or a chamfer that is none or deeper than the
            hole.
        """
        problems = ProblemList()
        set_lengths(self, problems, radius=radius_m, depth=depth_m)
        if chamfer is not None:
            check_kind(chamfer, Chamfer, ("chamfer",), problems)
            problems.raise_if_any()
            if not (is_finite(chamfer.width_m) and chamfer.width_m > 0.0):
                found = f"is {chamfer.width_m!r}; give a finite number of metres, above zero"
                problems.add(("chamfer", "width"), found)
            elif not (is_finite(chamfer.angle_rad) and 0.0 < chamfer.angle_rad < math.pi / 2.0):
                found = f"is {degrees_of(chamfer.angle_rad)}; give an angle above 0 and below 90 deg"
                problems.add(("chamfer", "angle_deg"), found)
            elif not problems.problems and chamfer.width_m / math.tan(chamfer.angle_rad) >= self.depth_m:
                problems.add(("chamfer",), "reaches the bottom; make it narrower or flatter, or the hole deeper")
        object.__setattr__(self, "chamfer", chamfer)
        names = (in_,) if isinstance(in_, str) else check_kinds(in_, str, "in", problems)
        object.__setattr__(self, "in_", names)
        self._place(pose_body_shape, name, problems)

    def cut_out_of(self, names: Sequence[str]) -> Self:
        """Return the same hole in other parts."""
        return self._with(in_=tuple(names))

    @property
    def rims(self) -> tuple[tuple[float, float], ...]:
        """Height and radius of the bottom, of the chamfer's lower end, and of the mouth."""
        bottom, mouth = (-self.depth_m, self.radius_m), (0.0, self.radius_m)
        if self.chamfer is None:
            return bottom, mouth
        height = self.chamfer.width_m / math.tan(self.chamfer.angle_rad)
        return bottom, (-height, self.radius_m), (0.0, self.radius_m + self.chamfer.width_m)

    def is_across(self, normals_body: FloatArray) -> NDArray[np.bool_]:
        """Return which planes of unit normals (n, 3) are across the hole, (n,)."""
        (a, b, c), (x, y, z) = self.pose_body_shape.rotation[:, 2], normals_body.T
        sines: FloatArray = np.sqrt((b * z - c * y) ** 2 + (c * x - a * z) ** 2 + (a * y - b * x) ** 2)
        return sines <= DISTANCE_OF_FACE

    def circle_in(self, point_body: FloatArray, normal_body: FloatArray) -> tuple[FloatArray, float] | None:
        """Return centre and radius, metres, of the circle that the hole cuts out of a plane across it, given by a point
        and a unit normal; None: it does not reach there, or the plane is aslant.
        """
        axis, mouth = self.pose_body_shape.rotation[:, 2], self.pose_body_shape.position_m
        height, slack = float((point_body - mouth) @ axis), self._slack_m
        if not (self.is_across(normal_body[None])[0] and -self.depth_m - slack <= height <= slack):
            return None
        heights, radii = zip(*self.rims, strict=True)
        return mouth + height * axis, float(np.interp(height, heights, radii))

    def run_through(self, parts: Sequence[Shape]) -> tuple[float, bool]:
        """Return how deep the hole is in the parts that it is cut out of, metres, and whether it comes out below."""
        axis, mouth = self.pose_body_shape.rotation[:, 2], self.pose_body_shape.position_m
        if not parts:
            return self.depth_m, True
        lowest = -max(part.reach_m(mouth, -axis) for part in parts)
        is_open = lowest >= -self.depth_m - self._slack_m
        return (-lowest, True) if is_open else (self.depth_m, False)

    def leaves_sideways(self, parts: Sequence[Shape]) -> bool:
        """Return whether the hole comes out of the parts that it is cut out of other than through a face across it."""
        if not parts:
            return False
        depth, _ = self.run_through(parts)
        rings = np.concatenate([self._ring(-share * depth, self.radius_m) for share in (0.01, 0.5, 0.99)])
        return not np.any([part.holds(rings) for part in parts], axis=0).all()

    def divided_by(self, parts: Sequence[Shape]) -> list[Shape]:
        """Return those of the parts that the hole is cut out of that end within it other than in a face across it, so
        that their edges would stand in the opening: asked by points between the heights where parts begin and end. Not
        asked is a bar that lies across the hole.
        """
        if len(parts) == 1 and parts[0].is_convex:  # it holds what is between the ends of the hole
            return []
        axis, mouth = self.pose_body_shape.rotation[:, 2], self.pose_body_shape.position_m
        depth, _ = self.run_through(parts)
        ends = [height for height, _ in self.rims]
        for way in (axis, -axis):
            ends += [float(way @ axis) * float(part.heights_m(way[None])[0]) - float(mouth @ axis) for part in parts]
        shares = (np.arange(HEIGHTS_BETWEEN) + 1.0 / math.sqrt(5.0)) / HEIGHTS_BETWEEN
        levels = pairwise(np.unique(np.clip(ends, -depth, 0.0)))
        steps = np.concatenate([low + shares * (high - low) for low, high in levels if high - low > self._slack_m])
        inside = self._filled(steps, SHARE_OF_RADIUS)
        asked = [part for part in parts if not _is_bar_across(part, axis)]
        held = [part.holds(inside).reshape(len(steps), -1) for part in asked]
        return [part for part, of in zip(asked, held, strict=True) if (of.any(axis=1) & ~of.all(axis=1)).any()]

    def meets(self, other: Hole, parts: Sequence[Shape]) -> bool:
        """Return whether two holes in the same parts have a place in common; of ones that are aslant to each other,
        points are asked, so that the answer may be no where they are a little in each other.
        """
        axis, mouth = self.pose_body_shape.rotation[:, 2], self.pose_body_shape.position_m
        between, along = other.pose_body_shape.position_m - mouth, other.pose_body_shape.rotation[:, 2]
        depths, slack = [hole.run_through(parts)[0] for hole in (self, other)], self._slack_m
        if float(np.linalg.norm(np.cross(axis, along))) > DISTANCE_OF_FACE:
            even = np.linspace(-1.0, 0.0, CORNERS_OF_CIRCLE)
            filled, of_other = self._filled(even * depths[0]), other._filled(even * depths[1])
            return bool(other.holds(filled).any() or self.holds(of_other).any())
        start, sense = float(between @ axis), math.copysign(1.0, float(along @ axis))
        heights, radii = np.array(self.rims).T
        others, other_radii = np.array(other.rims).T
        ends = np.sort([start, start - sense * depths[1]])
        low, high = max(-depths[0], ends[0]), min(0.0, ends[1])
        if low > high + slack:
            return False
        steps = np.clip([low, high, *heights, *(start + sense * others)], low, max(low, high))
        wide = np.interp(steps, heights, radii) + np.interp(sense * (steps - start), others, other_radii)
        return bool(float(np.linalg.norm(between - start * axis)) <= float(wide.max()) + slack)

    def _filled(self, steps: FloatArray, share: float = 1.0) -> FloatArray:
        """Points of the body's frame throughout the hole at these heights, so much of the way to its wall."""
        heights, radii = np.array(self.rims).T
        wide = share * np.interp(steps, heights, radii)
        return np.concatenate(
            [self._ring(h, part * r) for h, r in zip(steps, wide, strict=True) for part in RADII_OF_SAMPLES]
        )

    @property
    def _slack_m(self) -> float:
        return DISTANCE_OF_FACE * math.hypot(self.radius_m, self.depth_m)

    def thickness(self) -> list[tuple[tuple[Key, ...], float]]:
        found: list[tuple[tuple[Key, ...], float]] = [(("radius",), 2.0 * self.radius_m), (("depth",), self.depth_m)]
        return found if self.chamfer is None else [*found, (("chamfer", "width"), self.chamfer.width_m)]

    def is_within(self, part: Shape) -> bool:
        """Return whether all that the hole takes away lies in one part; close to its surface the answer may be no."""
        rims = [self._ring(height, radius / math.cos(math.pi / CORNERS_OF_CIRCLE)) for height, radius in self.rims]
        if not part.is_convex:
            rims.append(self._filled(np.linspace(-self.depth_m, 0.0, HEIGHTS_BETWEEN), SHARE_OF_RADIUS))
        return bool(part.holds(np.concatenate(rims)).all())

    def check_mouth(self, parts: Sequence[Shape], path: tuple[Key, ...], problems: ProblemList) -> None:
        """Note where the mouth is not on a face of the parts that the hole is cut out of."""
        _, radius = self.rims[-1]
        mouth = np.concatenate([self._ring(0.0, radius), self._ring(0.0, 0.0)])
        step = DISTANCE_OF_FACE * math.hypot(radius, self.depth_m) * self.pose_body_shape.rotation[:, 2]
        below = np.any([part.holds(mouth - step) for part in parts], axis=0)
        above = np.any([part.holds(mouth + step) for part in parts], axis=0)
        if not below.all():
            found = f"is cut out of {', '.join(self.in_)}, but its mouth is not all on a face there"
            problems.add(path, f"{found}; move it there (its axis z points out of the part), or make it smaller")
        elif above.any():
            found = f"has its mouth inside {', '.join(self.in_)}"
            problems.add(path, f"{found}; move it to the face (its axis z points out of the part)")

    def _ring(self, height: float, radius: float) -> FloatArray:
        return self.pose_body_shape.transform(RING * (radius, radius, 1.0) + (0.0, 0.0, height))


def _is_bar_across(part: Shape, axis: FloatArray) -> bool:
    return isinstance(part, Turned) and abs(float(part.pose_body_shape.rotation[:, 2] @ axis)) <= DISTANCE_OF_FACE


def check_holes(
    holes: Sequence[Hole], paths: Sequence[tuple[Key, ...]], parts: Sequence[Shape], problems: ProblemList
) -> None:
    """Note what the holes of a body are cut out of that is no part of it, mouths that are not on its faces, and holes
    that meet, where one cuts away the wall of another.
    """
    named = {str(part.name): part for part in parts}
    for hole, path in zip(holes, paths, strict=True):
        unknown = [index for index, name in enumerate(hole.in_) if name not in named]
        for index in unknown:
            there = f"its own: {', '.join(named)}" if named else "its own, which has none: leave in out"
            problems.add(
                (*path, "in", index), f"is {hole.in_[index]!r}, no box or shape of this body; name one of {there}"
            )
        if hole.in_ and not unknown:
            hole.check_mouth([named[name] for name in hole.in_], path, problems)
    if problems.problems:
        return
    for first, second in _near(holes):
        one, other, path = holes[first], holes[second], paths[second]
        shared = [named[name] for name in one.in_ if name in other.in_]
        if shared and one.meets(other, shared):
            found = f"meets {one.name} in {', '.join(str(part.name) for part in shared)}; keep holes apart"
            problems.add(path, f"{found}, or build a slot or a step in a bore from boxes and plates with one hole each")


def _near(holes: Sequence[Hole]) -> list[list[int]]:
    """Return the pairs of holes that are near each other, by their indices."""
    limits = np.array([hole.limits_m() for hole in holes]).reshape(-1, 2, 3)
    room = 2.0 * np.array([hole._slack_m for hole in holes]).reshape(-1, 1)
    pairs: list[list[int]] = near_pairs(limits[:, 0] - room, limits[:, 1] + room).tolist()
    return pairs

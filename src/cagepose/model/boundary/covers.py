"""What may cover features of a body: its other parts, and what holes take away from these.

A union of polyhedra knows by itself what its pieces cover. So only round parts and holes have covers, and polyhedra
beside them; and pieces that a hole of another one is open to, which are united apart from it. Facets cover nothing:
they are joined with polyhedra that they meet, and other parts may not touch them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.boundary.features import HALF_SPACE, HULL, SEGMENT, TURNED, Bound, Cover
from cagepose.model.boundary.convex_pieces import piece_of_box
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.hull import Hull, hull_of
from cagepose.model.pose import Pose
from cagepose.model.shapes import Convex, Disc, Rounded, Shape, Turned

Rows = NDArray[np.void]

NEAR = 8.0
"""In touch tolerances: a cover whose box is no farther from that of a feature may cover it."""
BEYOND_MOUTH = 80.0
"""In touch tolerances: how far openings lead on beyond their mouths, where there is no material."""
NOWHERE = np.zeros(3)


class Covers(NamedTuple):
    """Rows of `kernels.boundary.features.Cover`, the bounds of hulls, and which there are of each feature.

    Attributes
    ----------
    rows, bounds
        The first bound is number zero here.
    indices
        Of covers, one range after the other.
    first, last
        The range of each feature, (n_features,).
    """

    rows: Rows
    bounds: list[Rows]
    indices: list[int]
    first: NDArray[np.int64]
    last: NDArray[np.int64]


def united(solids: Mapping[int, Shape], holes: Iterable[Hole], touch_m: float) -> list[frozenset[int]]:
    """Return the numbers of polyhedra in groups that can be united: in none is one that a hole of another is open to.

    Parameters
    ----------
    solids
        Sharp polyhedra by their numbers.
    holes
        Of the same body.
    """
    boxes, in_conflict = {number: solid.limits_m() for number, solid in solids.items()}, set[tuple[int, int]]()
    for hole in holes:
        low, high = hole.limits_m() + NEAR * touch_m * np.array(((-1.0,), (1.0,)))
        opened = [number for number, solid in solids.items() if solid.name in hole.in_]
        for number, box in boxes.items():
            if opened and number not in opened and (box[0] <= high).all() and (box[1] >= low).all():
                in_conflict |= {pair for other in opened for pair in ((number, other), (other, number))}
    groups = list[set[int]]()
    for number in solids:
        for group in groups:
            if not in_conflict or not any((number, other) in in_conflict for other in group):
                group.add(number)
                break
        else:
            groups.append({number})
    return [frozenset(group) for group in groups]


def covers_of(
    parts: Sequence[Shape | FloatArray],
    boxes: FloatArray,
    owners: Sequence[frozenset[int]],
    owner_of: NDArray[np.int64],
    touch_m: float,
) -> Covers:
    """Return what may cover each feature.

    Parameters
    ----------
    parts
        Those of the body.
    boxes
        Around the features, (n, 2, 3), metres.
    owners, owner_of
        Numbers of the parts that do not cover features, their own and those that these are united with; and which of
        these sets each feature has, (n,).
    touch_m
        What is this close touches, metres.
    """
    features, of_rows = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    rows, bounds, of_parts = list[tuple[object, ...]](), list[Rows](), dict[int, int]()
    for number, part in enumerate(parts):
        if isinstance(part, np.ndarray | Hole | Disc | Facets) or all(number in owner for owner in owners):
            continue
        may_cover = np.array([number not in owner for owner in owners])
        low, high = part.limits_m() + NEAR * touch_m * np.array(((-1.0,), (1.0,)))
        is_near = may_cover[owner_of] & (boxes[:, 0] <= high).all(axis=1) & (boxes[:, 1] >= low).all(axis=1)
        if not is_near.any():
            continue
        features.append(np.flatnonzero(is_near))
        of_rows.append(np.full(len(features[-1]), len(rows)))
        of_parts[number] = len(rows)
        rows.append(_solid(part, bounds, touch_m))
    of_each = np.concatenate(features)
    indices: list[int] = np.concatenate(of_rows)[np.argsort(of_each, kind="stable")].tolist()
    counts = np.bincount(of_each, minlength=len(boxes))
    last = np.cumsum(counts)
    made = _with_openings(parts, rows, of_parts, indices, touch_m)
    return Covers(made, bounds, indices, last - counts, last)


def _with_openings(
    parts: Sequence[Shape | FloatArray],
    rows: list[tuple[object, ...]],
    of_parts: Mapping[int, int],
    indices: list[int],
    touch_m: float,
) -> NDArray[np.void]:
    """Return the rows of solids, and behind them those of what holes take away from them; append their indices.

    Parameters
    ----------
    rows
        Of solids.
    of_parts
        Which row each part has that may cover something.
    indices
        See `Covers`.
    """
    solids = [part for part in parts if isinstance(part, Shape) and not isinstance(part, Hole)]
    names = [part.name if isinstance(part, Shape) else None for part in parts]
    openings = dict[int, list[int]]()
    for hole in (part for part in parts if isinstance(part, Hole)):
        opened = [row for number, row in of_parts.items() if names[number] in hole.in_]
        if opened:
            found = _openings(hole, [solid for solid in solids if solid.name in hole.in_], touch_m)
            for row in opened:
                openings.setdefault(row, []).extend(range(len(rows), len(rows) + len(found)))
            rows += found
    made: Any = np.array(rows, dtype_of(Cover))
    for row, mine in openings.items():
        made["first_opening"][row], made["last_opening"][row] = len(indices), len(indices) + len(mine)
        indices += mine
    found_rows: NDArray[np.void] = made
    return found_rows


def _solid(part: Shape, bounds: list[Rows], touch_m: float) -> tuple[object, ...]:
    """Return a solid part as a row; append its bounds."""
    if isinstance(part, Turned):
        (low, radius), (high, other) = part.rims[0], part.rims[-1]
        return _turned(part.pose_body_shape, (low, radius), (high, other), touch_m)
    if isinstance(part, Box):
        piece = piece_of_box(part, 0)
        return _hull(piece.hull, piece.vertices_m, piece.normals, 0.0, bounds, touch_m)
    if not isinstance(part, Rounded):
        raise TypeError(f"nothing is known that a {part.kind} covers")
    hull = part.hull if isinstance(part, Convex) else hull_of(part.core())
    pose = part.pose_body_shape
    vertices, normals = pose.transform(hull.vertices_m), hull.normals @ pose.rotation.T
    return _hull(hull, vertices, normals, part.radius_m, bounds, touch_m)


def _turned(pose: Pose, low: tuple[float, float], high: tuple[float, float], touch_m: float) -> tuple[object, ...]:
    """Return what is turned about the z axis between two heights with their radii as a row."""
    (start, radius), (end, other) = low, high
    point = pose.transform(np.array((0.0, 0.0, start)))
    reach = math.hypot(end - start, max(radius, other))
    return TURNED, point, pose.rotation[:, 2], radius, other, end - start, reach, 0, 0, 0, 0, touch_m


def _hull(
    hull: Hull, vertices: FloatArray, normals: FloatArray, radius_m: float, bounds: list[Rows], touch_m: float
) -> tuple[object, ...]:
    """Return a hull, blown up by a radius, as a row; append its half-spaces and its edges. Its vertices and normals are
    given in the frame of the body.
    """
    middle, first = vertices.mean(axis=0), sum(map(len, bounds))
    seen = vertices - middle
    around, counts = np.concatenate([*hull.faces, ()]).astype(np.int64), np.array(list(map(len, hull.faces)), np.int64)
    of_corners = np.repeat(normals, counts, axis=0)
    heights = np.einsum("ij,ij->i", seen[around], of_corners)
    spaces = [(normals, np.maximum.reduceat(heights, np.cumsum(counts) - counts) if len(counts) else heights)]
    if len(hull.faces) == 2:
        following = np.concatenate([(*loop[1:], loop[0]) for loop in hull.faces])
        sides = unit_rows(np.cross(seen[following] - seen[around], of_corners))
        spaces.append((sides, np.einsum("ij,ij->i", sides, seen[around])))
    for directions, limits in spaces:
        rows = np.zeros(len(limits), dtype_of(Bound))
        rows["kind"], rows["direction"], rows["limit"] = HALF_SPACE, directions, limits
        bounds.append(rows)
    edges = hull.edges if len(hull.edges) else np.zeros((1, 2), np.int64)
    rows = np.zeros(len(edges), dtype_of(Bound))
    rows["kind"], rows["direction"], rows["end"] = SEGMENT, seen[edges[:, 0]], seen[edges[:, 1]]
    bounds.append(rows)
    reach = float(np.linalg.norm(seen, axis=1).max()) + radius_m
    return HULL, middle, NOWHERE, radius_m, 0.0, 0.0, reach, first, sum(map(len, bounds)), 0, 0, touch_m


def _openings(hole: Hole, within: Sequence[Shape], touch_m: float) -> list[tuple[object, ...]]:
    """Return what a hole takes away, beyond its mouths where it has such; one within the other, as what is between two
    of them is open.
    """
    depth, is_open = hole.run_through(within)
    beyond = BEYOND_MOUTH * touch_m
    bottom = -depth - (beyond if is_open else 0.0)
    found = [_turned(hole.pose_body_shape, (bottom, hole.radius_m), (beyond, hole.radius_m), touch_m)]
    for (low, radius), (high, wide) in pairwise(hole.rims[1:]):
        further = wide + (wide - radius) / (high - low) * beyond
        found.append(_turned(hole.pose_body_shape, (low, radius), (high + beyond, further), touch_m))
    return found

"""Bodies as boundaries: the features that kernels take, and the trees around them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    HALF_SPACE,
    INSIDE,
    LINE,
    OUTSIDE,
    SEGMENT,
    VERTEX,
    Bound,
    Boundary,
    Feature,
)
from cagepose.kernels.boundary.tree import EDGES, FACES, VERTICES, Node
from cagepose.model.boundary.body_parts import body_parts
from cagepose.model.boundary.convex_pieces import ConvexPiece, piece_of_box, piece_of_hull
from cagepose.model.boundary.covers import covers_of, united
from cagepose.model.boundary.trimmed import Edges, TrimmedUnion
from cagepose.model.boundary.union import union_of
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.hole import Hole
from cagepose.model.hull import Hull, hull_of
from cagepose.model.near_pairs import near_pairs
from cagepose.model.pose import Pose
from cagepose.model.shapes import Convex, Disc, Rounded, Shape, Turned

LEAF, FACES_IN_LEAF = 4, 32
"""Features in a leaf of a tree, at most; of faces more, as a vertex is asked about several of them at once."""
NOWHERE = np.zeros(3)
RAY = np.array((0.4127, 0.5309, 0.7401))
"""A direction that few borders of ordinary parts lie along: rays of crossing parity do."""
SAME_END_OF_LENGTH = 1e-9
"""Of the shortest edge: an end that is nearer to a vertex is at it."""
AROUND = 50.0
"""A hole that stands alone is one in a square plate: so many times its own size to each side."""


class _Row(NamedTuple):
    """A feature, its bounds apart, a box around it: lowest and highest coordinates; and which parts do not cover it."""

    kind: int
    part: int
    point: FloatArray
    direction: FloatArray
    toward: FloatArray
    length: float
    radius: float
    taper: float
    low: float
    high: float
    start: float
    width: float
    bounds: list[tuple[int, FloatArray, FloatArray, float]]
    least: float
    box: FloatArray
    apart_from: frozenset[int] = frozenset()


def boundary_of(parts: Iterable[Shape | FloatArray], touch_m: float) -> Boundary:
    """Return the boundary of a body in its frame; a single point (3,) is a part, too.

    Of polyhedra it is that of their union: what lies inside another one is no feature, and a seam between flush faces
    is no edge. Round parts and holes have all of their features, and these have covers.

    Parameters
    ----------
    parts
        Those of the body.
    touch_m
        What is this close is at one place, metres.
    """
    every = list(parts)
    solids = [part for part in every if isinstance(part, Shape) and not isinstance(part, Hole)]
    holes = [part for part in every if isinstance(part, Hole)]
    rows, polyhedra, pieces = list[_Row](), dict[int, Shape](), dict[int, ConvexPiece]()
    for number, part in enumerate(every):
        if isinstance(part, Hole):
            within = [solid for solid in solids if solid.name in part.in_]
            own = frozenset(other for other, solid in enumerate(every) if any(solid is each for each in within))
            rows += _apart(_hole_rows(part, within, number), own)
            if not within:
                rows += [_pierced(row, part) for row in _rows_of(_plate_of(part), number)]
        elif isinstance(part, Shape) and (piece := _piece_of(part, number)) is not None:
            polyhedra[number], pieces[number] = part, piece
        else:
            rows += _apart(_rows_of(part, number), frozenset((number,)))
    for group in united(polyhedra, holes, touch_m):
        rows += _apart(_union_rows(union_of([pieces[number] for number in sorted(group)], touch_m)), group)
    names = [part.name if isinstance(part, Shape) else None for part in every]
    for hole in holes:
        rows = [_pierced(row, hole) if names[row.part] in hole.in_ else row for row in rows]
    trees: list[list[_Row]] = [[], [], []]
    for row in rows:
        trees[VERTICES if row.kind == VERTEX else FACES if row.kind == FACE else EDGES].append(row)
    return _packed(trees, every, touch_m)


def _apart(rows: Sequence[_Row], parts: frozenset[int]) -> list[_Row]:
    """Return features that these parts do not cover."""
    return [row._replace(apart_from=parts) for row in rows]


def _piece_of(part: Shape | FloatArray, number: int) -> ConvexPiece | None:
    """Return a sharp polyhedron as a piece of a union; None: the part is none."""
    if isinstance(part, Box):
        return piece_of_box(part, number)
    if isinstance(part, Convex) and part.radius_m == 0.0 and len(part.hull.faces) > 3:
        return piece_of_hull(part.hull, part.pose_body_shape, number)
    return None


def _union_rows(union: TrimmedUnion) -> list[_Row]:
    """Return the features of a union of polyhedra."""
    edges, vertices, faces = union.edges, union.vertices, union.faces
    lengths = np.linalg.norm(edges.ends_m - edges.starts_m, axis=1)
    rows = []
    last, shortest = np.cumsum(vertices.n_tangents), _shortest_at(vertices.places_m, edges, lengths)
    for index, place in enumerate(vertices.places_m):
        part, end = int(vertices.parts[index]), int(last[index])
        away = vertices.tangents[end - vertices.n_tangents[index] : end]
        spaces = [(HALF_SPACE, tangent, NOWHERE, 0.0) for tangent in away]
        rows.append(_row(VERTEX, part, place, NOWHERE, NOWHERE, 0.0, 0.0, spaces, float(shortest[index]), place[None]))
    for index, (one, other) in enumerate(edges.normals):
        cosine = one @ other
        into = unit_rows(np.array([cosine * one - other, cosine * other - one]))
        spaces = [(HALF_SPACE, direction, NOWHERE, 0.0) for direction in into]
        corners, length = np.stack([edges.starts_m[index], edges.ends_m[index]]), float(lengths[index])
        part = int(edges.parts[index, 0])
        rows.append(
            _row(LINE, part, corners[0], edges.directions[index], NOWHERE, length, 0.0, spaces, length, corners)
        )
    last = np.cumsum(faces.n_borders)
    for index, (normal, part, end) in enumerate(zip(faces.normals, faces.parts.tolist(), last, strict=True)):
        borders = faces.borders[end - faces.n_borders[index] : end]
        starts, ends = borders["start"] - borders["start"].mean(axis=0), borders["end"] - borders["start"].mean(axis=0)
        if faces.is_convex[index]:
            heights = -(borders["inward"] * starts).sum(axis=1)
            across = zip(-borders["inward"], heights.tolist(), strict=True)
            bounds = [(HALF_SPACE, outward, NOWHERE, height) for outward, height in across]
        else:
            bounds = [(SEGMENT, start, ending, 0.0) for start, ending in zip(starts, ends, strict=True)]
        least, middle = float(np.linalg.norm(ends - starts, axis=1).min()), borders["start"].mean(axis=0)
        middle = middle + (faces.offsets_m[index] - normal @ middle) * normal
        ray = unit_rows(np.cross(normal, RAY)[None])[0]
        rows.append(_row(FACE, part, middle, normal, ray, 0.0, 0.0, bounds, least, borders["start"]))
    return rows


def _shortest_at(places: FloatArray, edges: Edges, lengths: FloatArray) -> FloatArray:
    """Return the length of the shortest edge that starts or ends at each place, (n,); inf: none does."""
    everywhere = np.concatenate([places, edges.starts_m, edges.ends_m])
    slack = SAME_END_OF_LENGTH * float(lengths.min(initial=0.0))
    pairs = near_pairs(everywhere - slack, everywhere + slack)
    ends = pairs[(pairs[:, 0] < len(places)) & (pairs[:, 1] >= len(places))]
    shortest = np.full(len(places), np.inf)
    np.minimum.at(shortest, ends[:, 0], np.tile(lengths, 2)[ends[:, 1] - len(places)])
    return shortest


def _row(
    kind: int,
    part: int,
    point: FloatArray,
    direction: FloatArray,
    toward: FloatArray,
    length: float,
    radius: float,
    bounds: list[tuple[int, FloatArray, FloatArray, float]],
    least: float,
    corners: FloatArray,
) -> _Row:
    """Return a straight feature, blown up by a radius."""
    box = np.stack([corners.min(axis=0) - radius, corners.max(axis=0) + radius])
    numbers = (length, radius, 0.0, 0.0, 0.0, 0.0, 0.0)
    return _Row(kind, part, point, direction, toward, *numbers, bounds, least, box)


def _rows_of(part: Shape | FloatArray, number: int) -> list[_Row]:
    if isinstance(part, np.ndarray):
        return _hull_rows(hull_of(part[None]), Pose(), 0.0, number)
    if isinstance(part, Box):
        return _hull_rows(hull_of(part.corners_object()), Pose(), 0.0, number)
    if isinstance(part, Rounded):
        hull = part.hull if isinstance(part, Convex) else hull_of(part.core())
        return _hull_rows(hull, part.pose_body_shape, part.radius_m, number)
    if isinstance(part, Turned):
        return _turned_rows(part, number)
    raise TypeError(f"no boundary is known of a {part.kind}")


def _turned_rows(part: Turned, number: int) -> list[_Row]:
    """Return the features of what is turned about an axis: flat ends, their circles, and the side between them."""
    pose, (low, wide), (high, narrow) = part.pose_body_shape, part.rims[0], part.rims[-1]
    slant = math.atan2(wide - narrow, high - low) if high > low else 0.0
    rows = []
    for height, radius, out in ((low, wide, -1.0), (high, narrow, 1.0)):
        sine = slant * out
        if radius == 0.0:
            rows.append(_tip(pose, height, out, slant, max(wide, narrow), number))
            continue
        if isinstance(part, Disc):
            sine = -0.5 * math.pi
        rows.append(_round_face(pose, height, radius, out, number))
        if not isinstance(part, Disc) or out > 0.0:
            rows.append(_circle(pose, height, radius, out, (sine, 0.5 * math.pi), number))
    if not isinstance(part, Disc):
        rows.append(_side(pose, (low, wide), (high, narrow), number))
    return rows


def _hole_rows(hole: Hole, solids: Sequence[Shape], number: int) -> list[_Row]:
    """Return the features of a hole: its walls, the circles between them, and its bottom."""
    pose = hole.pose_body_shape
    depth, is_open = hole.run_through(solids)
    heights = [(-depth, hole.radius_m), *hole.rims[1:]]
    rows = [_side(pose, (low, -radius), (high, -wide), number) for (low, radius), (high, wide) in pairwise(heights)]
    slants = [math.atan2(wide - radius, high - low) for (low, radius), (high, wide) in pairwise(heights)]
    for index, (height, radius) in enumerate(heights[1:]):
        above = math.pi - slants[index + 1] if index + 1 < len(slants) else 0.5 * math.pi
        rows.append(_circle(pose, height, radius, 1.0, (above, math.pi - slants[index]), number))
    if is_open:
        rows.append(_circle(pose, -depth, hole.radius_m, -1.0, (0.5 * math.pi, math.pi), number))
    else:
        rows.append(_round_face(pose, -depth, hole.radius_m, 1.0, number))
    return rows


def _plate_of(hole: Hole) -> Box:
    """Return the plate that a hole which stands alone is in."""
    wide = max(radius for _, radius in hole.rims)
    depth, _ = hole.run_through([])
    side = 2.0 * AROUND * (wide + depth)
    return Box((side, side, depth), hole.pose_body_shape @ Pose((0.0, 0.0, -0.5 * depth)))


def _circle(pose: Pose, height: float, radius: float, out: float, normals: tuple[float, float], number: int) -> _Row:
    """Return a circle about the shape's z axis; its own axis leads up (``out`` 1) or down (-1)."""
    turn, center = pose.rotation, pose.transform(np.array((0.0, 0.0, height)))
    axis = out * turn[:, 2]
    reach = radius * np.sqrt(np.maximum(0.0, 1.0 - axis**2))
    box = np.stack([center - reach, center + reach])
    numbers = (radius, 0.0, 0.0, *normals, 0.0, 2.0 * math.pi)
    return _Row(CIRCLE, number, center, axis, turn[:, 0], *numbers, [], radius, box)


def _round_face(pose: Pose, height: float, radius: float, out: float, number: int) -> _Row:
    """Return a flat face inside of a circle about the shape's z axis."""
    circle = _circle(pose, height, radius, out, (0.0, 0.0), number)
    bounds = [(INSIDE, NOWHERE, NOWHERE, radius)]
    return circle._replace(kind=FACE, length=0.0, width=0.0, bounds=bounds, least=radius)


def _tip(pose: Pose, height: float, out: float, slant: float, wide: float, number: int) -> _Row:
    """Return the tip of a cone, whose normals lead up (``out`` 1) or down (-1) at least as far as those of its side;
    what touches along the side is told as of the wide end, with this radius.
    """
    place = pose.transform(np.array((0.0, 0.0, height)))
    bounds = [(HALF_SPACE, -out * pose.rotation[:, 2], NOWHERE, -math.sin(slant * out))]
    numbers = (0.0,) * 7
    return _Row(VERTEX, number, place, NOWHERE, NOWHERE, *numbers, bounds, wide, np.stack([place, place]))


def _side(pose: Pose, low: tuple[float, float], high: tuple[float, float], number: int) -> _Row:
    """Return the side between two heights with their radii, those of a hole below zero."""
    (start, radius), (end, other) = low, high
    angle = math.atan2(radius - other, end - start)
    sine, cosine = math.sin(angle), math.cos(angle)
    reach = np.array((max(abs(radius), abs(other)),) * 2 + (0.5 * (end - start),))
    middle, half = pose.transform(np.array((0.0, 0.0, 0.5 * (start + end)))), np.abs(pose.rotation) @ reach
    start, end = start - radius * sine / cosine, end - other * sine / cosine
    if abs(other) > abs(radius):  # from the wide end on, as the narrow one may be a tip
        start, end, radius, sine = end, start, other, -sine
    point, along = pose.transform(np.array((0.0, 0.0, start))), math.copysign(1.0, end - start) * pose.rotation[:, 2]
    numbers = (abs(end - start), radius / cosine, sine, 0.0, 0.0, 0.0, 0.0)
    least = min(abs(end - start), *(abs(wide) for wide in (low[1], high[1]) if wide != 0.0))
    box = np.stack([middle - half, middle + half])
    return _Row(LINE, number, point, along, pose.rotation[:, 0], *numbers, [], least, box)


def _pierced(row: _Row, hole: Hole) -> _Row:
    """Return a face without what a hole cuts out of it."""
    circle = hole.circle_in(row.point + row.radius * row.direction, row.direction) if row.kind == FACE else None
    if circle is None:
        return row
    center, wide = circle
    seen = center - row.point
    across = seen - (seen @ row.direction) * row.direction
    return row._replace(bounds=[*row.bounds, (OUTSIDE, across, NOWHERE, wide)])


def _hull_rows(hull: Hull, pose: Pose, radius_m: float, number: int) -> list[_Row]:
    """Return the features of a hull, blown up by a radius."""
    vertices = pose.transform(hull.vertices_m)
    normals = hull.normals @ pose.rotation.T
    starts, ends = vertices[hull.edges[:, 0]], vertices[hull.edges[:, 1]]
    lengths = np.linalg.norm(ends - starts, axis=1)
    along = (ends - starts) / lengths[:, None]
    rows = []

    def add(
        kind: int,
        point: FloatArray,
        direction: FloatArray,
        length: float,
        bounds: Sequence[tuple[FloatArray, float]],
        least: float,
        corners: FloatArray,
    ) -> None:
        spaces = [(HALF_SPACE, across, NOWHERE, size) for across, size in bounds]
        rows.append(_row(kind, number, point, direction, NOWHERE, length, radius_m, spaces, least, corners))

    for index, vertex in enumerate(vertices):
        begins, ending = hull.edges[:, 0] == index, hull.edges[:, 1] == index
        away = [(direction, 0.0) for direction in (*along[begins], *-along[ending])]
        add(VERTEX, vertex, NOWHERE, 0.0, away, lengths[begins | ending].min(initial=np.inf), vertex[None])
    outward = [_outward_across(vertices[list(face)], normal) for face, normal in zip(hull.faces, normals, strict=True)]
    of_edge: dict[tuple[int, int], list[tuple[FloatArray, float]]] = {}
    for face, across in zip(hull.faces, outward, strict=True):
        for one, other, direction in zip(face, (*face[1:], face[0]), across, strict=True):
            of_edge.setdefault((min(one, other), max(one, other)), []).append((-direction, 0.0))
    for index, pair in enumerate(hull.edges.tolist()):
        inward, ended = of_edge.get((min(pair), max(pair)), []), vertices[pair]
        add(LINE, starts[index], along[index], float(lengths[index]), inward, float(lengths[index]), ended)
    for face, normal, across in zip(hull.faces, normals, outward, strict=True):
        corners = vertices[list(face)]
        center = corners.mean(axis=0)
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
        bounds = [
            (direction, float(direction @ (corner - center))) for direction, corner in zip(across, corners, strict=True)
        ]
        add(FACE, center, normal, 0.0, bounds, float(sides.min()), corners)
    return rows


def _outward_across(corners: FloatArray, normal: FloatArray) -> FloatArray:
    """Return the unit vectors out of a face across its sides, of which each begins at a corner."""
    return unit_rows(np.cross(np.roll(corners, -1, axis=0) - corners, normal))


def _packed(trees: Sequence[Sequence[_Row]], parts: Sequence[Shape | FloatArray], touch_m: float) -> Boundary:
    """Return features in the order of their trees' leaves, with their bounds, what covers them, and the trees."""
    nodes: list[tuple[object, ...]] = [(NOWHERE, NOWHERE, -1, -1, 0, 0, False, False)] * 3
    features, bounds = list[tuple[object, ...]](), list[tuple[int, FloatArray, FloatArray, float]]()
    ordered = list[_Row]()
    for root, rows in enumerate(trees):
        first = len(features)
        boxes = np.array([row.box for row in rows]).reshape(-1, 2, 3)
        order = np.arange(len(rows))
        _divide(boxes, order, 0, len(rows), first, FACES_IN_LEAF if root == FACES else LEAF, root, nodes)
        nodes[root] = (
            *nodes[root][:-2],
            any(row.radius != 0.0 for row in rows),
            any(row.kind == CIRCLE for row in rows),
        )
        for row in (rows[index] for index in order.tolist()):
            numbers = row[: _Row._fields.index("bounds")]
            features.append((*numbers, len(bounds), len(bounds) + len(row.bounds), row.least, 0, 0))
            bounds.extend(row.bounds)
            ordered.append(row)
    made = np.array(features, dtype_of(Feature))
    boxes = np.array([row.box for row in ordered]).reshape(-1, 2, 3)
    covers: Any = covers_of(parts, boxes, [row.apart_from for row in ordered], touch_m)
    made["first_cover"], made["last_cover"] = covers.first, covers.last
    covers.rows["first_bound"] += len(bounds)
    covers.rows["last_bound"] += len(bounds)
    bounds += covers.bounds
    heights = (made["point"] * made["direction"]).sum(axis=1) + made["radius"]
    planes = np.ascontiguousarray(np.column_stack([made["direction"], heights, made["least"]]).T)
    of_body = body_parts(parts)
    for index in np.nonzero(made["kind"] == VERTEX)[0].tolist():
        if isinstance(parts[made["part"][index]], np.ndarray):
            of_body["point"][made["part"][index]] = index
    return Boundary(
        of_body,
        made,
        np.array(bounds, dtype_of(Bound)),
        covers.rows,
        np.array(covers.indices, np.int64),
        np.array(nodes, dtype_of(Node)),
        planes,
    )


def _divide(
    boxes: FloatArray,
    order: NDArray[np.int64],
    begin: int,
    end: int,
    first: int,
    leaf: int,
    at: int,
    nodes: list[tuple[object, ...]],
) -> None:
    """Write the node of some features, and those below it; put the features into the order of the leaves, of ``leaf``
    features at most.
    """
    if begin == end:
        nodes[at] = (NOWHERE, NOWHERE, -1, -1, first + begin, first + begin, False, False)
        return
    mine = boxes[order[begin:end]]
    low, high = mine[:, 0].min(axis=0), mine[:, 1].max(axis=0)
    left = right = -1
    if end - begin > leaf:
        middles = mine.mean(axis=1)
        axis = int(np.argmax(middles.max(axis=0) - middles.min(axis=0)))
        half = (end - begin) // 2
        order[begin:end] = order[begin:end][np.argsort(middles[:, axis], kind="stable")]
        left, right = len(nodes), len(nodes) + 1
        nodes.extend([nodes[at], nodes[at]])
        _divide(boxes, order, begin, begin + half, first, leaf, left, nodes)
        _divide(boxes, order, begin + half, end, first, leaf, right, nodes)
    nodes[at] = (0.5 * (low + high), 0.5 * (high - low), left, right, first + begin, first + end, False, False)

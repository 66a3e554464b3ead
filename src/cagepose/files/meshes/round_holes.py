"""Round holes of a body with flat sides: found, filled, and told as what they are: `filled`."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.files.meshes.convex_shapes import FEWEST_SIDES
from cagepose.files.meshes.edges import edges_of, reflex_edges
from cagepose.files.meshes.joined import joined
from cagepose.files.meshes.manifolds import Triangles, circle_through, manifold3d
from cagepose.files.meshes.tolerances import DISTANCE_BEYOND, PARALLEL_SINE, ROUNDING_OF_MESH, SINGLE_PRECISION
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.sides import IntArray

COSINE_OF_END = 0.99
"""Cosine between the triangles of the wall and those of its flat ends, which is less than this."""
NEAR_WALL = 0.95
"""Share of the radius. The ends are asked there whether they are open, as in the middle there may be a narrower hole.
"""


class RoundHole(NamedTuple):
    """A hole, and by how much its wall is off at most."""

    hole: Hole
    error: float


def filled(body: Any) -> tuple[Any, list[RoundHole]]:
    """Return a body without its round holes with flat ends, and these."""
    mesh = Triangles.of(body)
    found, plugs = [], []
    for wall in _walls(mesh):
        hole = _hole(body, wall)
        if hole is not None:
            chamfered, cone = _with_chamfer(mesh, wall, hole)
            if len(cone) == 0:  # at its other end, if it is open there
                chamfered, cone = _with_chamfer(mesh, wall, RoundHole(_from_below(hole.hole), hole.error))
            found.append(chamfered if len(cone) > 0 else hole)
            plugs.append(manifold3d().Manifold.hull_points(np.concatenate([wall, cone])))
    if not plugs:
        return body, []
    whole = manifold3d().Manifold.batch_boolean([body, *plugs], manifold3d().OpType.Add)
    return whole.as_original().simplify(ROUNDING_OF_MESH * mesh.size), found


def _walls(mesh: Triangles) -> list[FloatArray]:
    """Return the corners of each wall: those of hollow edges that are parallel, equally long and in a ring."""
    allowed = ROUNDING_OF_MESH * mesh.size
    edges = reflex_edges(mesh, allowed).corners
    all_edges = edges_of(mesh)
    one_side, other_side = np.moveaxis(mesh.normals[all_edges.faces], 1, 0)
    # two holes are joined by edges within flat ends, which are not sharp
    sharp = all_edges.corners[np.einsum("ij,ij->i", one_side, other_side) < COSINE_OF_END]
    slack = 3.0 * SINGLE_PRECISION * mesh.size
    edges = edges[_in_rings(mesh.vertices, edges, sharp, slack)]
    if len(edges) < FEWEST_SIDES:
        return []
    # corners that sharp edges join: they lie on one end of a hole
    links: dict[int, set[int]] = {}
    for one, other in sharp[np.isin(sharp, edges).all(axis=1)].tolist():
        links.setdefault(one, set()).add(other)
        links.setdefault(other, set()).add(one)
    # the longest edge that is left and those that are parallel and equally long
    spans = mesh.vertices[edges[:, 1]] - mesh.vertices[edges[:, 0]]
    lengths = np.linalg.norm(spans, axis=1)
    left, walls = np.ones(len(edges), bool), []
    longest_first = np.argsort(-lengths)
    falling = -lengths[longest_first]
    for seed in longest_first.tolist():
        if not left[seed]:
            continue
        ends = np.searchsorted(falling, -lengths[seed] + (-2.0 * slack, 2.0 * slack))  # a wavy body has many edges
        rows = longest_first[slice(*ends)]
        rows = rows[left[rows]]
        if len(rows) < FEWEST_SIDES:
            continue
        axis = spans[seed] / lengths[seed]
        across = np.linalg.norm(np.cross(spans[rows], axis), axis=1)
        off = np.sort(mesh.vertices[edges[rows]] @ axis, axis=1) - np.sort(mesh.vertices[edges[seed]] @ axis)
        rows = rows[(np.abs(off) < slack).all(axis=1) & (across <= PARALLEL_SINE * lengths[rows])]
        # of these, those whose lower ends hang together in a ring
        bottoms = np.where((spans[rows] @ axis > 0.0)[:, None], edges[rows], edges[rows][:, ::-1])
        row_of = {int(bottom): int(row) for row, bottom in zip(rows, bottoms[:, 0], strict=True)}
        start = int(edges[seed, 0])
        ring, waiting = {start}, [start]
        while waiting:
            beside = (links.get(waiting.pop(), set()) & row_of.keys()) - ring
            ring |= beside
            waiting += beside
        of_ring = [row_of[bottom] for bottom in ring]
        left[of_ring] = False
        if len(ring) >= FEWEST_SIDES:
            walls.append(mesh.vertices[edges[of_ring]].reshape(-1, 3))
    return walls


def _in_rings(vertices: FloatArray, edges: IntArray, sharp: IntArray, slack: float) -> NDArray[np.bool_]:
    """Return which edges hang together with enough others that are parallel and equally long, from end to end by sharp
    edges, that they may be a wall: what is wavy has 100,000 edges, and none of these.
    """
    corner, edge = edges.ravel(), np.repeat(np.arange(len(edges)), 2)
    order = np.argsort(corner, kind="stable")
    corner, edge = corner[order], edge[order]
    begin, end = (np.searchsorted(corner, sharp, side) for side in ("left", "right"))
    counts = end - begin
    n_pairs = counts.prod(axis=1)
    row = np.repeat(np.arange(len(sharp)), n_pairs)
    k = np.arange(len(row)) - np.repeat(np.cumsum(n_pairs) - n_pairs, n_pairs)
    one, other = edge[begin[row, 0] + k // counts[row, 1]], edge[begin[row, 1] + k % counts[row, 1]]
    spans = vertices[edges[:, 1]] - vertices[edges[:, 0]]
    lengths = np.linalg.norm(spans, axis=1)
    across = np.linalg.norm(np.cross(spans[one], spans[other]), axis=1)
    is_alike = np.abs(lengths[one] - lengths[other]) < 2.0 * slack
    is_alike &= across <= 2.0 * PARALLEL_SINE * lengths[one] * lengths[other]
    ring = joined(len(edges), np.stack([one[is_alike], other[is_alike]], axis=1))
    found: NDArray[np.bool_] = np.bincount(ring, minlength=len(edges))[ring] >= FEWEST_SIDES
    return found


def _hole(body: Any, wall: FloatArray) -> RoundHole | None:
    """Return the hole of a wall; None: it is not round all around, or is closed at both ends."""
    size = float(np.ptp(wall, axis=0).max())
    half = len(wall) // 2
    spans = wall[1::2] - wall[::2]
    axis = np.sum(np.where((spans @ spans[0] > 0.0)[:, None], spans, -spans), axis=0)
    axis = axis / np.linalg.norm(axis)
    heights = (wall @ axis).reshape(half, 2)
    low, high = float(heights.min(axis=1).mean()), float(heights.max(axis=1).mean())
    circle = circle_through(wall - np.outer(wall @ axis, axis), axis)
    allowed = 3.0 * SINGLE_PRECISION * max(size, high - low)
    if circle is None or circle.n_sides < FEWEST_SIDES - 0.5 or circle.off > allowed:
        return None
    step = DISTANCE_BEYOND * circle.radius
    near_wall = NEAR_WALL * wall[0] + (1.0 - NEAR_WALL) * circle.center
    near_wall = near_wall - (near_wall @ axis) * axis
    is_open = [not _holds(body, near_wall + height * axis) for height in (low - step, high + step)]
    if not any(is_open) or _holds(body, circle.center + (low + high) / 2.0 * axis):
        return None
    up, mouth = (axis, high) if is_open[1] else (-axis, low)
    pose = Pose(circle.center + mouth * axis, turn_from_z(up))
    return RoundHole(Hole(circle.radius, high - low, None, (), pose), circle.sagitta + circle.off)


def _from_below(hole: Hole) -> Hole:
    """Return a hole with its mouth where its bottom was."""
    turn = Pose((0.0, 0.0, -hole.depth_m), np.array((0.0, 1.0, 0.0, 0.0)))
    return Hole(hole.radius_m, hole.depth_m, None, (), hole.pose_body_shape @ turn)


def _with_chamfer(mesh: Triangles, wall: FloatArray, found: RoundHole) -> tuple[RoundHole, FloatArray]:
    """Return a hole with the cone that widens its mouth, and the corners of that; without one, it as it is and none."""
    hole, error = found.hole, found.error
    local = hole.pose_body_shape.inverse_transform(mesh.vertices)
    rims = [(hole.radius_m, 0.0)]
    corners = [wall[:0]]
    while (ring := _ring_above(mesh, local, *rims[-1])) is not None:
        (radius, height), of_ring, off = ring
        angle = math.atan2(radius - hole.radius_m, height)
        if len(rims) > 1 and abs(angle - math.atan2(rims[1][0] - hole.radius_m, rims[1][1])) > PARALLEL_SINE:
            break
        rims.append((radius, height))
        corners.append(of_ring)
        error = max(error, off)
    if len(rims) == 1:
        return found, wall[:0]
    width, height = rims[-1][0] - hole.radius_m, rims[-1][1]
    pose = hole.pose_body_shape @ Pose((0.0, 0.0, height))
    chamfer = Chamfer(width, math.atan2(width, height))
    wider = Hole(hole.radius_m, hole.depth_m + height, chamfer, (), pose)
    return RoundHole(wider, error), np.concatenate(corners)


def _ring_above(
    mesh: Triangles, local: FloatArray, radius: float, height: float
) -> tuple[tuple[float, float], FloatArray, float] | None:
    """Return the circle at which all edges end that go up from a circle about a hole's axis: its radius and height, its
    corners, and how far its sides are off. None: it is none, or no wider.
    """
    allowed = 3.0 * SINGLE_PRECISION * mesh.size
    is_rim = (np.abs(local[:, 2] - height) <= allowed) & (np.abs(np.hypot(*local[:, :2].T) - radius) <= allowed)
    edges = edges_of(mesh).corners
    leaving = edges[is_rim[edges].sum(axis=1) == 1]
    ends = np.unique(leaving[~is_rim[leaving]])
    ends = ends[local[ends, 2] > height + allowed]
    circle = circle_through(local[ends], np.array((0.0, 0.0, 1.0)))
    if circle is None or circle.n_sides < FEWEST_SIDES - 0.5:
        return None
    x, y, top = circle.center.tolist()
    if max(circle.off, float(np.ptp(local[ends, 2])), math.hypot(x, y)) > allowed or circle.radius <= radius + allowed:
        return None
    return (circle.radius, top), mesh.vertices[ends], circle.sagitta + circle.off


def _holds(body: Any, point: FloatArray) -> bool:
    """Whether a point is in a body: a ray from there leaves it once more often than it enters."""
    box = body.bounding_box()
    end = np.array(box[3:]) + (np.array(box[3:]) - np.array(box[:3])) * (1.01, 1.37, 1.73)
    span = end - point
    hits = body.ray_cast(point.tolist(), end.tolist())
    return sum(1 if float(np.dot(hit.normal, span)) > 0.0 else -1 for hit in hits) > 0

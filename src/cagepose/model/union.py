"""Moments of a union of boxes and other shapes: what several of them share counts once.

Shapes that share no volume are added up in closed form. Where some overlap, what their sum counts too often is measured
on meshes: manifold3d unites them, exactly but for rounding. All vertices lie on the shapes, so that a mesh's error
falls with the square of its chords; two meshes, the second with every chord halved, tell where they go (Richardson).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cagepose.errors import MissingExtraError
from cagepose.model.apart import are_apart
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.near_pairs import near_pairs
from cagepose.model.shape_moments import NOTHING, Sums, mesh_sums, shape_moments, sums_of
from cagepose.model.shapes import Shape
from cagepose.model.surface import Mesh, shape_mesh
from cagepose.model.tolerances import LEAST_VOLUME_LEFT
from cagepose.model.volume import VolumeMoments, union_moments

CHORDS_OF_CIRCLE = 128
"""Chords of a circle in the coarser of two meshes. The overlap of balls, bars, cones and boxes then comes out to a few
parts in 1e7, and in a second at most."""


def box_moments(boxes: Sequence[Box]) -> VolumeMoments:
    """Return the moments of a union of boxes, exact but for rounding (see `union_moments`)."""
    return union_moments(
        np.array([box.size_m for box in boxes]) / 2.0,
        np.array([box.pose_object_box.position_m for box in boxes]),
        np.array([box.pose_object_box.rotation for box in boxes]),
    )


def body_moments(parts: Sequence[Shape], holes: Sequence[Hole] = ()) -> VolumeMoments | None:
    """Return the moments of a union of shapes, less holes in them, in their body's frame; None without any volume.

    Exact but for rounding where no shape but boxes overlaps another, and each hole lies in one shape and clear of the
    others and of other holes; else what overlaps, and what a hole takes away, is known to about 1e-6 of itself.

    Raises
    ------
    MissingExtraError
        The case is not exact, and manifold3d is not installed.
    """
    solid = [(part, shape_moments(part)) for part in parts if not isinstance(part, Box)]
    solid = [(part, moments) for part, moments in solid if moments.volume_m3 > 0.0]
    boxes = [part for part in parts if isinstance(part, Box)]
    holes = [hole for hole in holes if hole.in_]
    if not solid and not (boxes and holes):
        return box_moments(boxes) if boxes else None
    if len(solid) == 1 and not boxes and not holes:
        return solid[0][1]
    material = [*boxes, *(part for part, _ in solid)]
    origin = np.mean([part.nodes_body().mean(axis=0) for part in material], axis=0)
    total = sums_of(box_moments(boxes), origin) if boxes else NOTHING
    least = LEAST_VOLUME_LEFT * sum(shape_moments(part).volume_m3 for part in material)
    for _, moments in solid:
        total += sums_of(moments, origin)
    every = [*material, *holes]
    near = _near(every)
    clean = [hole for hole, by in zip(holes, near[len(material) :], strict=True) if _is_clean(hole, every, by)]
    for hole in clean:
        total += sums_of(shape_moments(hole), origin).times(-1.0)
    others = [hole for hole in holes if hole not in clean]
    for group in _groups(material, near):
        cuts = [hole for hole in others if any(part.name in hole.in_ for part in group)]
        if cuts or (len(group) > 1 and any(not isinstance(part, Box) for part in group)):
            coarse, fine = (_too_much(group, cuts, origin, halved=halved) for halved in (False, True))
            total += fine.times(-4.0 / 3.0) + coarse.times(1.0 / 3.0)
    return total.moments(origin) if total.volume > least else None


def _near(shapes: Sequence[Shape]) -> list[list[int]]:
    """Return, of each shape, the places of those that may share volume with it."""
    limits = np.array([shape.limits_m() for shape in shapes])
    found: list[list[int]] = [[] for _ in shapes]
    for one, other in near_pairs(limits[:, 0], limits[:, 1]).tolist():
        found[one].append(other)
        found[other].append(one)
    return found


def _is_clean(hole: Hole, shapes: Sequence[Shape], near: Sequence[int]) -> bool:
    """Whether a hole takes all its volume away from one shape, which has it to itself there; given the places of those
    that are near it.
    """
    around = [shapes[place] for place in near if shapes[place].name in hole.in_ and hole.is_within(shapes[place])]
    return len(around) == 1 and all(shapes[place] is around[0] or are_apart(hole, shapes[place]) for place in near)


def _groups(parts: Sequence[Shape], near: Sequence[Sequence[int]]) -> list[list[Shape]]:
    """Part shapes into groups that share no volume with each other, given the places of those near each."""
    groups = list[list[Shape]]()
    is_reached = [False] * len(parts)
    for seed in range(len(parts)):
        if is_reached[seed]:
            continue
        is_reached[seed], reached = True, [seed]
        for one in reached:
            for other in near[one]:
                if other < len(parts) and not is_reached[other] and not are_apart(parts[one], parts[other]):
                    is_reached[other] = True
                    reached.append(other)
        groups.append([parts[place] for place in sorted(reached)])
    return groups


def _too_much(group: Sequence[Shape], holes: Sequence[Hole], origin: FloatArray, *, halved: bool) -> Sums:
    """Return by how much the sum of shapes, and of the union of those that are boxes, exceeds the union of all, less
    holes in them.
    """
    try:
        import manifold3d  # 20 ms and an extra, for bodies whose round parts overlap alone
    except ImportError as error:
        raise MissingExtraError(
            "the volume of round shapes that overlap needs manifold3d, which is not installed; install the shapes"
            " extra: pip install 'cagepose[shapes]', or give the object's center_of_gravity, mass and inertia"
        ) from error

    def solid(shape: Shape) -> manifold3d.Manifold:
        mesh = shape_mesh(shape, CHORDS_OF_CIRCLE, halved=halved)
        return manifold3d.Manifold(
            manifold3d.Mesh64((mesh.vertices_m - origin) / unit_m, mesh.triangles.astype(np.uint64))
        )

    def sums(body: manifold3d.Manifold) -> Sums:
        mesh = body.to_mesh64()
        found = mesh_sums(Mesh(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.int64)), np.zeros(3))
        return Sums(found.volume * unit_m**3, found.first * unit_m**4, found.second * unit_m**5)

    unit_m = 2.0 ** float(np.frexp(max(shape.farthest_m(origin) for shape in group))[1])
    union = manifold3d.OpType.Add
    solids = [solid(shape) for shape in group]
    cut = []
    for shape, body in zip(group, solids, strict=True):
        plugs = [solid(hole) for hole in holes if shape.name in hole.in_]
        cut.append(manifold3d.Manifold.batch_boolean([body, *plugs], manifold3d.OpType.Subtract) if plugs else body)
    together = sums(manifold3d.Manifold.batch_boolean(cut, union))
    boxes = [body for shape, body in zip(group, solids, strict=True) if isinstance(shape, Box)]
    total = sums(manifold3d.Manifold.batch_boolean(boxes, union)) if boxes else NOTHING
    for shape, body in zip(group, solids, strict=True):
        if not isinstance(shape, Box):
            total += sums(body)
    return total + together.times(-1.0)

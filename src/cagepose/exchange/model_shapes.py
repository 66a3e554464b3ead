"""Geoms of a model as shapes of a scene file: `GeomShapes`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cagepose.errors import SceneError
from cagepose.exchange.compile_model import FLAT
from cagepose.exchange.ellipsoid import rounded_hull
from cagepose.exchange.solids_document import METRES
from cagepose.exchange.stl import MM_PER_M
from cagepose.exchange.tolerances import ROUNDING_OF_MEASURES, SAME_AXES, VOLUME_NOT_CONVEX
from cagepose.files.meshes import mesh_file
from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.files.meshes.pieces import MOST_CORNERS
from cagepose.files.meshes.surface_distance import farthest_from
from cagepose.files.triples import text_of, triples
from cagepose.model.pose import Pose
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Convex

Data = dict[str, Any]
"""What is known of a geom, or of a part of a scene file."""

PLANE_OF_REACH = 20.0
"""Width of the box that stands for a plane, in distances of the object's farthest point: no plane of MuJoCo ends."""
MOST_TRIANGLES = 20_000
"""Meshes of more stand for their hulls: what they are is not looked for."""
HULL_SAMPLES = 500
"""Points that are asked how far a hull is from its mesh: an arm has thirty, and more points take seconds each."""
ROUND = ("sphere", "capsule", "cylinder", "ellipsoid")
LEFT_OUT = "left out: "
UNKNOWN = {
    "hfield": "a height field; give its surface as a mesh, in convex pieces",
    "sdf": "a signed distance field; give its surface as a mesh, in convex pieces",
    FLAT: "a mesh without volume; give it a thickness",
    "other": "of a kind that no scene has; give it as boxes, balls, capsules, cylinders or meshes",
}
"""Kinds of geoms that are no shape of a scene, and what to do."""


class GeomShapes:
    """Makes shapes, and notes what they are not.

    ``notes`` is added to. ``files`` are those of meshes that are what they are, by their names, as in URDF; None: they
    stand for their hulls, as in MJCF. ``meshes`` are triangles by the names of meshes, in the frames of geoms.

    Attributes
    ----------
    off_m
        How far shapes are from their geom at most, by its label, metres; of those that are the geom nothing.
    """

    def __init__(self, notes: list[str], files: Mapping[str, str] | None, meshes: Mapping[str, Triangles]) -> None:
        self.notes, self.files, self.meshes = notes, files, meshes
        self.off_m = dict[str, float]()

    def known(self, geoms: Sequence[Data], left_out: list[str]) -> list[Data]:
        """Return the geoms that can be shapes; ``left_out`` gets the names of the others."""
        for geom in geoms:
            if geom["kind"] in UNKNOWN:
                self.notes.append(f"{LEFT_OUT}{geom['label']!r}, {UNKNOWN[geom['kind']]}")
                left_out.append(geom["label"])
        return [geom for geom in geoms if geom["kind"] not in UNKNOWN]

    def shapes(self, geom: Data, place: Pose, beside: Sequence[Data]) -> list[Data]:
        """Return a geom, which is no plane, at a place; ``beside``: all geoms of its body."""
        size = geom["size"]
        if geom["kind"] == "mesh":
            return self.mesh(geom, place, beside)
        if geom["kind"] == "box":
            numbers: Data = {"box": {"size": [2.0 * half for half in size]}}
        elif geom["kind"] == "sphere":
            numbers = {"sphere": {"radius": size[0]}}
        elif geom["kind"] == "ellipsoid":
            numbers = self.ellipsoid(geom)
        else:
            numbers = {geom["kind"]: {"radius": size[0], "length": 2.0 * size[1]}}
        return [{"name": geom["label"], **numbers, **METRES.pose(place, turn=False)}]

    def plane(self, geom: Data, place: Pose, object_at_m: Any, reach_m: float) -> Data:
        """Return a plane as a box under the object, which is at a place in the same frame."""
        width_m = PLANE_OF_REACH * reach_m
        self.notes.append(
            f"{geom['label']!r} is a plane; here, a box {width_m:.3g} m wide under the object, its top there"
        )
        x, y, _ = place.inverse_transform(object_at_m).tolist()
        place = place @ Pose((x, y, -reach_m / 2.0))
        return {
            "name": geom["label"],
            "box": {"size": [width_m, width_m, reach_m]},
            **METRES.pose(place, turn=False),
        }

    def ellipsoid(self, geom: Data) -> Data:
        semi_axes = np.array(geom["size"], dtype=np.float64)
        if np.ptp(semi_axes) <= SAME_AXES * semi_axes.max():
            return {"sphere": {"radius": semi_axes[0]}}
        found = rounded_hull(semi_axes)
        self.off_m[geom["label"]] = found.off_m
        self.notes.append(
            f"{geom['label']!r} is an ellipsoid; here, a hull of {len(found.core_m)} corners with round edges within"
            f" it, up to {1e3 * found.off_m:.2g} mm off, and nothing at the ends of its axes"
        )
        return {"convex": {"vertices": found.core_m.tolist(), "radius": found.radius_m}}

    def mesh(self, geom: Data, place: Pose, beside: Sequence[Data]) -> list[Data]:
        """Return what a mesh is, if it is to be that and is not convex; else its hull."""
        is_alone = not any(one["kind"] in ROUND for one in beside)
        corners = np.array(geom["vertices"])
        is_large = is_alone and len(corners) > MOST_CORNERS
        whole = manifold3d().Manifold.hull_points(corners) if is_large else None
        full_m3 = shape_moments(Convex(corners)).volume_m3 if whole is None else whole.volume()
        share = 1.0 - abs(geom["volume"]) / full_m3
        if not geom["is_closed"] or share > VOLUME_NOT_CONVEX:
            unusable = None
            if self.files is not None and (path := self.files.get(geom["file"] or "")):
                try:
                    return self.own_shapes(geom, Path(path), place)
                except SceneError as error:
                    unusable = error.problems[0].message
            off_m = self.off_hull(geom)
            off = f", about {MM_PER_M * off_m:.2g} mm off at most" if off_m > 0.0 else ""
            what = f"not convex: here, its hull, {share:.1%} of which is too much{off}"
            if unusable is not None:
                what = f"its hull here{off}, as it {unusable}"
            elif not geom["is_closed"]:
                what = f"open, or its sides are not all turned alike: here, its hull{off}"
            self.notes.append(f"the mesh {geom['label']!r} is {what}")
        numbers: Data = {"convex": {"vertices": geom["vertices"]}}
        if whole is not None:  # takes less time, but may touch nothing round of its own body
            mesh = Triangles.of(whole)
            vertices, triangles = text_of(mesh.vertices.tolist()), text_of(mesh.faces.tolist())
            numbers = {"facets": {"vertices": vertices, "triangles": triangles}}
        return [{"name": geom["label"], **numbers, **METRES.pose(place, turn=False)}]

    def off_hull(self, geom: Data) -> float:
        """Return how far a mesh and its hull are apart, metres, as points of both say."""
        mesh = self.meshes[geom["mesh"]]
        hull = Triangles.of(manifold3d().Manifold.hull_points(mesh.vertices))
        off_m = max(farthest_from(one, other, HULL_SAMPLES) for one, other in ((hull, mesh), (mesh, hull)))
        self.off_m[geom["label"]] = off_m if off_m > ROUNDING_OF_MEASURES * mesh.size else 0.0
        return self.off_m[geom["label"]]

    def own_shapes(self, geom: Data, path: Path, place: Pose) -> list[Data]:
        """Return the shapes of a mesh that is at a place, as those of solids are found.

        Raises
        ------
        SceneError
            It cannot be used.
        """
        surface, scale = mesh_file.read_solids(path, split=False)[""], np.array(geom["scale"])
        if len(surface.faces) > MOST_TRIANGLES:
            raise mesh_file.refused(f"has {len(surface.faces):,} triangles, more than {MOST_TRIANGLES:,}; simplify it")
        if scale.prod() <= 0.0:
            raise mesh_file.refused("is mirrored by its scale; mirror it in its file")
        given = Triangles(MM_PER_M * scale * surface.vertices, surface.faces)
        found = mesh_file.sound_shapes(given, geom["label"], "mm")
        self.notes += found.notes
        self.off_m[geom["label"]] = found.error / MM_PER_M
        of_file = place @ Pose(geom["mesh_position"], geom["mesh_quaternion"]).inverse()
        metres = [mesh_file.scaled(shape, 1.0 / MM_PER_M) for shape in found.shapes]
        return [METRES.shape(shape.moved(of_file @ shape.pose_body_shape)) for shape in metres]


def reach_m(shape: Data) -> float:
    """Return a bound on how far a shape is from its body's origin, metres."""
    kind, numbers = next((key, value) for key, value in shape.items() if isinstance(value, dict))
    if kind == "convex":
        span = float(np.linalg.norm(numbers["vertices"], axis=1).max()) + numbers.get("radius", 0.0)
    elif kind == "facets":
        span = float(np.linalg.norm(np.array(triples(numbers["vertices"], "vertices")), axis=1).max())
    else:
        span = sum(float(np.abs(value).sum()) for value in numbers.values())
    return float(np.linalg.norm(shape["position"]) + span)

"""Geoms of a model as shapes of a scene file: `GeomShapes`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cagepose.exchange.compile_model import FLAT
from cagepose.exchange.ellipsoid import rounded_hull
from cagepose.exchange.solids_document import METRES
from cagepose.exchange.tolerances import VOLUME_NOT_CONVEX
from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.files.meshes.pieces import MOST_CORNERS
from cagepose.files.triples import text_of, triples
from cagepose.model.pose import Pose
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Convex

Data = dict[str, Any]
"""What is known of a geom, or of a part of a scene file."""

PLANE_OF_REACH = 20.0
"""Width of the box that stands for a plane, in distances of the object's farthest point: no plane of MuJoCo ends."""
ROUND = ("sphere", "capsule", "cylinder", "ellipsoid")
UNKNOWN = {
    "hfield": "a height field; give its surface as a mesh, in convex pieces",
    "sdf": "a signed distance field; give its surface as a mesh, in convex pieces",
    FLAT: "a mesh without volume; give it a thickness",
    "other": "of a kind that no scene has; give it as boxes, balls, capsules, cylinders or meshes",
}
"""Kinds of geoms that are no shape of a scene, and what to do."""


class GeomShapes:
    """Makes shapes, and notes what they are not; ``notes`` is added to."""

    def __init__(self, notes: list[str]) -> None:
        self.notes = notes

    def known(self, geoms: Sequence[Data], left_out: list[str]) -> list[Data]:
        """Return the geoms that can be shapes; ``left_out`` gets the names of the others."""
        for geom in geoms:
            if geom["kind"] in UNKNOWN:
                self.notes.append(f"left out: {geom['label']!r}, {UNKNOWN[geom['kind']]}")
                left_out.append(geom["label"])
        return [geom for geom in geoms if geom["kind"] not in UNKNOWN]

    def shape(self, geom: Data, place: Pose, beside: Sequence[Data]) -> Data:
        """Return a geom, which is no plane, at a place; ``beside``: all geoms of its body."""
        size = geom["size"]
        if geom["kind"] == "box":
            numbers: Data = {"box": {"size": [2.0 * half for half in size]}}
        elif geom["kind"] == "sphere":
            numbers = {"sphere": {"radius": size[0]}}
        elif geom["kind"] == "ellipsoid":
            numbers = self.ellipsoid(geom)
        elif geom["kind"] == "mesh":
            numbers = self.hull(geom, as_facets=not any(one["kind"] in ROUND for one in beside))
        else:
            numbers = {geom["kind"]: {"radius": size[0], "length": 2.0 * size[1]}}
        return {"name": geom["label"], **numbers, **METRES.pose(place, turn=False)}

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
        if np.ptp(semi_axes) == 0.0:
            return {"sphere": {"radius": semi_axes[0]}}
        found = rounded_hull(semi_axes)
        self.notes.append(
            f"{geom['label']!r} is an ellipsoid; here, a hull of {len(found.core_m)} corners with round edges within"
            f" it, up to {1e3 * found.off_m:.2g} mm off, and nothing at the ends of its axes"
        )
        return {"convex": {"vertices": found.core_m.tolist(), "radius": found.radius_m}}

    def hull(self, geom: Data, *, as_facets: bool) -> Data:
        """Return the hull of a mesh; of many corners, as facets, which take less time but may touch nothing round."""
        label, corners = geom["label"], np.array(geom["vertices"])
        is_large = as_facets and len(corners) > MOST_CORNERS
        whole = manifold3d().Manifold.hull_points(corners) if is_large else None
        full_m3 = shape_moments(Convex(corners)).volume_m3 if whole is None else whole.volume()
        if not geom["is_closed"]:
            self.notes.append(f"the mesh {label!r} is open, or its sides are not all turned alike: here, its hull")
        elif abs(geom["volume"]) < (1.0 - VOLUME_NOT_CONVEX) * full_m3:
            share = 1.0 - abs(geom["volume"]) / full_m3
            self.notes.append(f"the mesh {label!r} is not convex: here, its hull, {share:.1%} of which is too much")
        if whole is None:
            return {"convex": {"vertices": geom["vertices"]}}
        mesh = Triangles.of(whole)
        return {"facets": {"vertices": text_of(mesh.vertices.tolist()), "triangles": text_of(mesh.faces.tolist())}}


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

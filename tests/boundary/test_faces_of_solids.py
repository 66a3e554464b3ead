"""Flat faces and moments of solids of Open CASCADE, whose triangles stand for their surfaces."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cagepose.errors import SceneError
from cagepose.files.step.exact_facets import facets_on_surfaces
from cagepose.files.step.triangles import triangles_of
from cagepose.model.boundary.exact_surface import exact_block
from cagepose.model.boundary.features import boundary_of
from cagepose.model.facets import Facets
from cagepose.model.shape_moments import shape_moments

pytest.importorskip("OCP")
FLAT_FACE = 2
RADIUS, HEIGHT = 12.0, 4.0


def facets(solid: Any) -> Facets:
    return facets_on_surfaces(triangles_of(solid), "part").shape


def pin(x: float, y: float, z: float, radius: float, length: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, z), gp_Dir(0, 0, 1)), radius, length).Shape()


def test_a_hole_near_the_rim_of_a_flange_is_in_its_face():
    """There it is beyond the chords of the rim: an arc of 60 degrees is 1.6 mm from its own."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    flange = pin(0.0, 0.0, 0.0, RADIUS, HEIGHT)
    for angle in np.arange(7) * 0.87:
        hole = pin(10.6 * math.cos(angle), 10.6 * math.sin(angle), -1.0, 1.1, 9.0)
        flange = BRepAlgoAPI_Cut(flange, hole).Shape()
    features = np.asarray(boundary_of([facets(flange)], 1e-7).features)
    faces = features[features["kind"] == FLAT_FACE]
    assert len(faces) == 2
    assert (faces["last_bound"] - faces["first_bound"]).tolist() == [8 * 6, 8 * 6]  # six arcs around each circle


def test_a_dome_that_goes_over_into_its_bar_has_the_moments_of_both():
    """Surfaces that touch along a circle do not cross there: its middles are on both, too."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt

    ball = BRepPrimAPI_MakeSphere(gp_Pnt(0.0, 0.0, HEIGHT), RADIUS).Shape()
    bar = pin(0.0, 0.0, HEIGHT - 30.0, RADIUS, 30.0)
    found = shape_moments(facets(BRepAlgoAPI_Fuse(ball, bar).Shape()))
    parts = math.pi * RADIUS**2 * 30.0, math.pi * RADIUS**3 * 2.0 / 3.0
    middles = HEIGHT - 15.0, HEIGHT + RADIUS * 3.0 / 8.0
    assert found.volume_m3 == pytest.approx(sum(parts), rel=1e-10)
    assert found.centroid_m == pytest.approx([0.0, 0.0, np.dot(parts, middles) / sum(parts)], abs=1e-9)


def test_the_box_around_a_face_holds_all_of_its_arcs():
    """An arc of a half ring bulges beyond both of its ends."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    ring = BRepAlgoAPI_Cut(pin(0.0, 0.0, 0.0, 8.4, HEIGHT), pin(0.0, 0.0, -1.0, 6.7, 9.0)).Shape()
    for side in (-3.0, 0.5, 1.0, 2.0, 3.0):
        cut = BRepPrimAPI_MakeBox(gp_Pnt(-20.0, side, -1.0), gp_Pnt(20.0, 20.0, 9.0)).Shape()
        shape = facets(BRepAlgoAPI_Cut(ring, cut).Shape())
        block = exact_block(shape, 0)
        is_face = block.features["kind"] == FLAT_FACE
        for face, (low, high) in zip(block.features[is_face], block.boxes[is_face], strict=True):
            on = [np.allclose(surface.axis, face["direction"]) for surface in shape.surfaces]
            places = shape.vertices_m[np.unique(shape.triangles[np.array(on)[shape.on]])]
            is_own = (np.abs(places - face["point"]) @ np.abs(face["direction"])) < 1e-6
            if face["last_bound"] - face["first_bound"] > 4:
                assert (places[is_own] >= low - 1e-9).all()
                assert (places[is_own] <= high + 1e-9).all()


def test_a_surface_that_is_not_where_its_triangles_are_is_an_error():
    bar = facets(pin(1.0, 2.0, 3.0, RADIUS, HEIGHT))
    for kind, changes, found in (
        ("plane", {"point_m": (0.0, 0.0, 99.0)}, r"surfaces\[\d\]: is up to 9\d m from the corners"),
        ("cylinder", {"radius_m": 11.9}, r"surfaces\[0\]: is up to 0\.1 m from the corners .* correct it, or on"),
        ("cylinder", {"radius_m": -RADIUS}, r"surfaces\[0\]: faces away from its triangles"),
    ):
        wrong = [replace(one, **changes) if one.kind == kind else one for one in bar.surfaces]
        with pytest.raises(SceneError, match=found):
            Facets(bar.vertices_m, bar.triangles, bar.flat_m, None, "part", wrong, bar.on)


def test_how_far_facets_are_off_a_spline_is_measured():
    """A cylinder whose side is written as a spline: its chords are off by their sagitta."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    radius = 10.0
    found = triangles_of(BRepBuilderAPI_NurbsConvert(BRepPrimAPI_MakeCylinder(radius, 30.0).Shape()).Shape())
    corners = np.array(found["vertices"])[np.array(found["faces"])]
    middles = np.concatenate([corners.mean(axis=1), (0.5 * (corners + np.roll(corners, 1, axis=1))).reshape(-1, 3)])
    is_beside = np.abs(middles[:, 2] - 15.0) < 14.999
    sagitta = radius - np.linalg.norm(middles[is_beside, :2], axis=1).min()
    assert found["known"] == []
    assert found["off_others"] == pytest.approx(sagitta, abs=1e-6)
    assert sagitta < 0.02

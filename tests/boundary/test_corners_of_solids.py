"""Corners of solids of Open CASCADE: whichever side is down, a feature of a part meets a floor at its lowest place."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from boundary.asked import Asked
from cagepose import Box, Pose
from cagepose.files.step.exact_facets import OnSurfaces, facets_on_surfaces
from cagepose.files.step.triangles import triangles_of
from cagepose.kernels.algebra.motion import Motion
from cagepose.model.boundary.exact_surface import surface_of
from cagepose.model.boundary.surface_corners import corners_of
from cagepose.model.finer import finer

pytest.importorskip("OCP")
TOUCH_M = 1e-7
FLOOR = Box((400.0, 400.0, 100.0), Pose((0.0, 0.0, -50.0)))
DOWN = Motion((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), 0.0, (0.0, 0.0, 0.0))


def without(solid: Any, low: tuple[float, float, float], lean_rad: float) -> OnSurfaces:
    """Return a solid less a large block that leans about x, whose lowest corner is given."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    x, y, z = low
    block, lean = BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), gp_Pnt(x + 90.0, y + 90.0, z + 90.0)).Shape(), gp_Trsf()
    lean.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, z), gp_Dir(1, 0, 0)), lean_rad)
    block = BRepBuilderAPI_Transform(block, lean, True).Shape()
    return facets_on_surfaces(triangles_of(BRepAlgoAPI_Cut(solid, block).Shape(), within=True), "part")


def too_far(part: OnSurfaces, turns: list[Pose]) -> float:
    """Return how much farther it falls than its lowest place, at most; inf: through the floor."""
    shape, farthest = part.shape, 0.0
    vertices, _, _ = finer(shape.vertices_m, shape.triangles, shape.surfaces, shape.on)
    asked = Asked([shape], [FLOOR], TOUCH_M)
    for turn in turns:
        pose = Pose((0.0, 0.0, 60.0)) @ turn
        asked.place(pose)
        farthest = max(farthest, asked.first(DOWN, 200.0).amount - float(pose.transform(vertices)[:, 2].min()))
    return farthest


def test_a_cone_that_is_cut_through_its_tip_stands_on_it(cases):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone

    half = without(BRepPrimAPI_MakeCone(8.0, 0.0, 12.0).Shape(), (0.0, -45.0, -1.0), 0.0)
    rng = np.random.default_rng(71)
    assert too_far(half, [Pose(quaternion_wxyz=rng.standard_normal(4)) for _ in range(cases(60, 2000))]) < 1e-6


def test_a_cut_cone_keeps_its_tip_wherever_it_is():
    """At the tip its side has no normal: what rounding makes of one says nothing."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone

    half = without(BRepPrimAPI_MakeCone(8.0, 0.0, 12.0).Shape(), (0.0, -45.0, -1.0), 0.0).shape
    rng = np.random.default_rng(73)
    for _ in range(20):
        pose = Pose(rng.uniform(-2000.0, 2000.0, 3), rng.standard_normal(4))
        corners = corners_of(surface_of(half.moved(pose)), 0)
        assert len(corners.places_m) == 3


def test_a_shaft_with_an_oblique_end_lies_on_its_side(cases):
    """Nearly level: the lowest place is where a generator ends at the chain of short arcs around the oblique end."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    shaft = without(BRepPrimAPI_MakeCylinder(7.5, 30.0).Shape(), (-45.0, -45.0, 20.0), 0.47)
    rng, turns = np.random.default_rng(72), list[Pose]()
    for _ in range(cases(60, 2000)):
        lean = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-9.0, -1.0)
        turns.append(
            Pose(euler_zyx=(0.0, math.pi / 2.0 + lean, 0.0)) @ Pose(euler_zyx=(rng.uniform(0.0, 7.0), 0.0, 0.0))
        )
    assert too_far(shaft, turns) < shaft.error + 1e-6

"""Rods whose round side ends at what is no circle lie on a floor along their side, however they are let go."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from boundary.test_corners_of_solids import too_far, without
from cagepose import Box, Cage, Facets, Load, Object, Pose, Scene, run
from cagepose.files.step import triangles
from cagepose.files.step.exact_facets import facets_on_surfaces
from cagepose.files.step.triangles import triangles_of
from cagepose.model.surfaces import PLANE, TORUS, Surface

pytest.importorskip("OCP")
RADIUS, LENGTH = 2.0, 30.0
FLOOR = Box((400.0, 400.0, 100.0), Pose((0.0, 0.0, -50.0)), name="floor")


def rod() -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    return BRepPrimAPI_MakeCylinder(RADIUS, LENGTH).Shape()


def rounded(by: float) -> Any:
    """Return a rod whose upper rim is rounded: a torus, which is flat facets."""
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

    from cagepose.files.step.fillets import each

    whole = rod()
    work = BRepFilletAPI_MakeFillet(whole)
    work.Add(by, next(iter(each("Edge", whole))))
    return work.Shape()


def cross_bored(along: float = 9.0, aside: float = 0.3) -> Any:
    """Return a rod with a hole across it: where both sides cross, there is no circle."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    hole = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-10.0, aside, along), gp_Dir(1.0, 0.0, 0.0)), 1.2, 20.0).Shape()
    return BRepAlgoAPI_Cut(rod(), hole).Shape()


def cut_aslant(lean: float) -> Any:
    """Return a rod that a plane which leans about y has cut."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    upwards = gp_Ax2(gp_Pnt(0.0, 0.0, 22.0), gp_Dir(math.sin(lean), 0.0, math.cos(lean)))
    return BRepAlgoAPI_Cut(rod(), BRepPrimAPI_MakeCylinder(upwards, 90.0, 90.0).Shape()).Shape()


def as_splines(solid: dict[str, Any], off: float) -> dict[str, Any]:
    """Return what is known of a solid if its torus were a spline, and corners as far off their surfaces."""
    known = np.array([kind != TORUS for kind, *_ in solid["known"]])
    on = np.array(solid["on"])
    return {**solid, "on": np.where(known[on], on, -1).tolist(), "off_surfaces": off}


PARTS = {
    "bored across": lambda: facets_on_surfaces(triangles_of(cross_bored(), within=True), "part"),
    "cut aslant": lambda: without(rod(), (-45.0, -45.0, 20.0), 0.5),
    "rounded": lambda: facets_on_surfaces(triangles_of(rounded(0.5)), "part"),
    "rounded by a spline, corners off": lambda: facets_on_surfaces(
        as_splines(triangles_of(rounded(0.5)), 2e-4), "part"
    ),
    "well rounded": lambda: facets_on_surfaces(triangles_of(rounded(1.5)), "part"),
}


@pytest.mark.parametrize("name", PARTS)
def test_a_rod_lies_on_its_side(name, cases):
    shape, rng = PARTS[name]().shape, np.random.default_rng(3)
    for _ in range(cases(2, 60)):
        start = Pose((0.0, 0.0, 50.0), rng.standard_normal(4))
        done = run(
            Scene(Object(shapes=[shape], pose=start), Cage(shapes=[FLOOR]), [Load("weight", gravity=(0, 0, -9.81))])
        )
        along = done.pose.transform(np.array([[0.0, 0.0, 4.0], [0.0, 0.0, 16.0]]))[:, 2]
        assert done.verdict == "rests"
        assert along == pytest.approx(RADIUS, abs=1e-6)


def test_a_rod_that_slides_along_one_wall_of_a_groove_does_not_pass_through_the_other():
    """Its end is cut at 20 degrees. Within one step, the arc beside the one that slides seems to be reached first."""
    shape = facets_on_surfaces(triangles_of(cut_aslant(math.radians(20.0)), within=True), "part").shape
    start = Pose(
        (1.2141321637705333, 2.022329010680191, 4.0425592885167195),
        (0.8405370587058975, 0.30595738215511553, 0.38691994635107757, -0.22401001844227125),
    )
    aside = 100.0 * math.sqrt(0.5)
    walls = [
        Box((100.0, 400.0, 100.0), Pose((x, 0.0, 0.0), euler_zyx=(0.0, math.pi / 4.0, 0.0))) for x in (-aside, aside)
    ]
    weight = Load("weight", gravity=(0.0, 0.0, -9.81))
    assert run(Scene(Object(shapes=[shape], pose=start), Cage(shapes=walls), [weight])).verdict == "rests"


def test_facets_keep_their_corners_where_round_faces_are_off_theirs(cases):
    solid = triangles_of(rounded(1.5))
    solid["off_surfaces"] = 1e-5 * LENGTH
    rng = np.random.default_rng(5)
    turns = [Pose(quaternion_wxyz=rng.standard_normal(4)) for _ in range(cases(100, 2000))]
    assert too_far(facets_on_surfaces(solid, "part"), turns) < 0.01  # its facets lie so far within the torus


def test_a_face_whose_corners_are_far_off_its_surface_is_facets(monkeypatch):
    solid = rounded(0.5)
    assert sum(k >= 0 for k in triangles_of(solid)["on"]) > 0
    monkeypatch.setattr(triangles, "FARTHEST_OFF", -1.0)
    found = triangles_of(solid)
    assert set(found["on"]) == {-1}
    assert found["off_others"] == pytest.approx(3e-3, rel=0.01)


def test_a_rod_rolls_over_the_rim_of_its_cross_hole_to_where_it_is_heavy(cases):
    """Its centre of gravity is a four-hundredth of the radius beside the axis, toward an angle beside the hole. A
    corner of the rim that all but touches holds nothing that the side on both sides of the hole does not.
    """
    heavy, away = 2.0, 0.005
    shape = facets_on_surfaces(triangles_of(cross_bored(20.0, 0.0)), "part").shape
    center = (away * math.cos(heavy), away * math.sin(heavy), 12.0)
    lying, down = Pose((0.0, 0.0, 2.5), euler_zyx=(0.0, math.pi / 2, 0.0)), np.array((0.0, 0.0, -1.0))
    for turn in np.random.default_rng(5).uniform(0.0, 2.0 * math.pi, cases(4, 100)):
        start = lying @ Pose((0.0, 0.0, 0.0), euler_zyx=(turn, 0.0, 0.0))
        held = Object(shapes=[shape], pose=start, center_of_gravity_m=center)
        done = run(Scene(held, Cage(shapes=[FLOOR]), [Load("weight", gravity=(0, 0, -9.81))]))
        x, y, _ = done.pose.rotation.T @ down
        assert done.verdict == "rests"
        assert math.atan2(y, x) == pytest.approx(heavy, abs=1e-6)


def test_an_edge_between_flat_facets_that_is_shorter_than_what_counts_as_flat_is_a_straight_edge():
    """A hip roof, its bottom the only face that is told to stand for a surface."""
    half_ridge, flat = 2e-5, 1e-4
    corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (-half_ridge, 0, 1), (half_ridge, 0, 1)]
    slopes = [(0, 1, 5), (0, 5, 4), (2, 3, 4), (2, 4, 5), (1, 2, 5), (3, 0, 4)]
    bottom = Surface(PLANE, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    roof = Facets(corners, [(0, 2, 1), (0, 3, 2), *slopes], flat, None, "roof", [bottom], [0, 0, *[-1] * 6])
    start = Pose((0.0, 0.0, 3.0), euler_zyx=(0.3, 0.2, 0.4))
    done = run(Scene(Object(shapes=[roof], pose=start), Cage(shapes=[FLOOR]), [Load("weight", gravity=(0, 0, -9.81))]))
    assert done.verdict == "rests"
    assert done.pose.transform(np.array(corners[:4], float))[:, 2] == pytest.approx(0.0, abs=1e-9)

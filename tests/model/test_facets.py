"""Facets as a shape: what a body of boxes weighs, errors that say what to do, and scenes that are read again."""

from __future__ import annotations

import numpy as np
import pytest

from boundary.drawn_facets import bumpy_ball, facets, of_boxes, united
from cagepose import (
    Box,
    Cage,
    Cylinder,
    Facets,
    Hole,
    Load,
    Object,
    Pose,
    Scene,
    SceneError,
    Sphere,
    load_scene,
    run,
    save_scene,
)
from cagepose.model.shape_moments import shape_moments
from cagepose.model.surface import shape_mesh
from cagepose.model.union import body_moments

L_BRACKET = [Box((0.04, 0.01, 0.01)), Box((0.01, 0.03, 0.01), Pose((-0.015, 0.01, 0)))]
CUBE = Facets(*(getattr(shape_mesh(Box((1, 1, 1)), 3), key) for key in ("vertices_m", "triangles")))


def test_a_mesh_of_boxes_weighs_what_they_do():
    turn = Pose((3, 2, 1), euler_zyx=(0.4, -0.7, 1.1))
    found, wanted = (
        shape_moments(of_boxes(L_BRACKET).moved(turn)),
        body_moments([b.moved(turn @ b.pose_body_shape) for b in L_BRACKET]),
    )
    assert found.volume_m3 == pytest.approx(wanted.volume_m3, rel=1e-12)
    assert found.centroid_m == pytest.approx(wanted.centroid_m, abs=1e-12)
    assert found.second_moment_m2 == pytest.approx(wanted.second_moment_m2, abs=1e-15)


def test_volume_that_it_shares_with_others_counts_once():
    shape = of_boxes(L_BRACKET)
    assert body_moments([shape, L_BRACKET[0]]).volume_m3 == pytest.approx(shape_moments(shape).volume_m3, rel=1e-9)


def test_a_hole_in_it_takes_away_what_is_in_its_way():
    """In the upper flange of a channel, and not in the lower one."""
    channel = facets(united([Box((4, 2, 2))], [Box((3, 3, 1), Pose((1, 0, 0)))]), "channel")
    hole = Hole(0.3, 0.5, pose_body_shape=Pose((1, 0, 1)), in_=["channel"])
    held = Object(shapes=[channel], holes=[hole])
    assert hole.run_through([channel]) == (pytest.approx(0.5), True)
    moments = body_moments(held.parts, held.holes)
    assert moments.volume_m3 == pytest.approx(16 - 5 - 0.5 * np.pi * 0.09, rel=1e-9)


@pytest.mark.parametrize(
    ("triangles", "message"),
    [
        (
            CUBE.triangles[1:],
            r"triangles: do not close up: 3 of their sides have no triangle beyond them; give a",
        ),
        (CUBE.triangles[:, ::-1], r"triangles: enclose no volume, or face inwards; give corners counter-clockwise"),
        (CUBE.triangles + 1, r"triangles: has indices that are not 0 to 7; give those of vertices alone"),
        (CUBE.triangles * 0, r"triangles: has a triangle with the same corner twice; leave it out"),
        (CUBE.triangles[:, :2], r"triangles: is no list of three indices each"),
        (CUBE.triangles.astype(float), r"triangles: is no list of three indices each"),
    ],
)
def test_what_is_no_closed_surface_says_why(triangles, message):
    with pytest.raises(SceneError, match=message):
        Facets(CUBE.vertices_m, triangles)


def test_a_flatness_that_is_no_rounding_is_refused():
    with pytest.raises(SceneError, match=r"flat: is 0.01 m, more than a thousandth of the size"):
        Facets(CUBE.vertices_m, CUBE.triangles, 0.01)


def test_a_saved_scene_holds_the_triangles_themselves(tmp_path):
    ball = bumpy_ball(np.random.default_rng(1), 2).moved(Pose((0, 0, 1.5)))
    cage = Cage(shapes=[Box((9, 9, 1), Pose((0, 0, -0.5)), name="table")])
    scene = Scene(Object(shapes=[ball.renamed("ball")], mass_kg=1), cage, [Load("weight", gravity=(0, 0, -9.81))])
    save_scene(scene, tmp_path / "saved.yaml")
    again = load_scene(tmp_path / "saved.yaml")
    (shape,) = again.object.shapes
    assert isinstance(shape, Facets)
    assert shape.vertices_m == pytest.approx(ball.vertices_m, abs=1e-15)
    assert (shape.triangles.tolist(), shape.flat_m) == (ball.triangles.tolist(), ball.flat_m)
    assert run(again).pose.position_m == pytest.approx(run(scene).pose.position_m, abs=1e-12)
    text = (tmp_path / "saved.yaml").read_text()
    (tmp_path / "wrong.yaml").write_text(text.replace("triangles: ", "triangles: 1 2, ", 1))
    with pytest.raises(SceneError, match=r"has 2 numbers in row 1; give three, and a comma after each row"):
        load_scene(tmp_path / "wrong.yaml")


def test_round_neighbours_in_one_body_are_refused_with_the_remedy():
    """What lies beside a mesh with room between is none of these."""
    shape = of_boxes(L_BRACKET, "bracket")
    cage = Cage(points=[[0, 0, -0.1]])
    knob = Sphere(0.002, Pose((0.03, 0, 0)), "knob")
    assert run(Scene(Object(shapes=[shape, knob]), cage, [Load("w", gravity=(0, 0, -1))])).verdict == "escapes"
    for beside in (Sphere(0.002, Pose((0.02, 0, 0)), "knob"), Cylinder(0.001, 0.02, Pose((0, 0, 0.01)), "knob")):
        with pytest.raises(SceneError, match=r"\(knob\) that touches or overlaps bracket, a mesh of facets"):
            run(Scene(Object(shapes=[shape, beside]), cage, [Load("w", gravity=(0, 0, -1))]))

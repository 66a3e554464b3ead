"""What bodies of a model became is told beside what MuJoCo says of them, in the table and on the page."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from cagepose.cli.app import main
from cagepose.exchange.imported import imported
from exchange.robots import frame_obj, mjcf, written

pytest.importorskip("mujoco")
pytestmark = pytest.mark.usefixtures("here")

ARM = """<body name="arm" pos="0 0 0.5" euler="20 30 40"><freejoint/>
<geom name="beam" type="box" size="0.05 0.02 0.01" pos="0.05 0 0" euler="0 0 30"/>
<body name="tip" pos="0.1 0 0" euler="10 0 50"><joint name="bend" axis="0 1 0"/>
<geom name="finger" type="capsule" fromto="0 0 0 0.02 0.03 0.04" size="0.008"/>
<geom name="pad" type="cylinder" size="0.01 0.004" pos="0 0.05 0"/></body></body>
<body name="frame" pos="0.3 0 0.2" euler="0 0 30"><geom name="frame" type="mesh" mesh="frame"/></body>
<body name="egg" pos="-0.3 0 0.2" euler="0 50 0"><geom name="egg" type="ellipsoid" size="0.03 0.03 0.04"/></body>"""
FRAME = '<mesh name="frame" file="frame.obj"/>'
OUTER, INNER, HEIGHT = 0.1, 0.06, 0.05
"""Half widths and the height of the frame, metres."""


def model(folder: Path) -> str:
    text = mjcf(ARM, asset=FRAME)
    return str(written(folder, frame_dot_obj=frame_obj(OUTER, INNER, HEIGHT), arm_dot_xml=text))


def test_bodies_measure_what_mujoco_says_or_are_told_how_far_they_are_off(tmp_path):
    """Primitives are the source. MuJoCo touches with the hull of the frame: the volume of its hole is too much, and the
    middle of that is half as far from the frame as it is wide. An egg has 4/3 pi a b c.
    """
    found = imported(model(tmp_path), "arm", qpos="bend=0.7")
    parts = {part.name: part for part in found.parts}
    assert {name: (part.body, part.became) for name, part in parts.items()} == {
        "arm": ("object", "1 box"),
        "tip": ("object", "1 capsule, 1 cylinder"),
        "frame": ("cage", "1 convex hull"),
        "egg": ("cage", "1 convex hull"),
    }
    for name in ("arm", "tip"):
        part = parts[name]
        assert abs(part.volume_off) < 1e-12
        assert part.center_off_m < 1e-12
        assert part.size_off_m < 1e-12
        assert part.gyration_off < 1e-12
        assert part.off_m == 0.0
    frame, egg = parts["frame"], parts["egg"]
    assert frame.source.volume_m3 == pytest.approx(4.0 * (OUTER**2 - INNER**2) * HEIGHT, rel=1e-6)
    assert frame.volume_off == pytest.approx(INNER**2 / (OUTER**2 - INNER**2), rel=1e-6)
    assert frame.center_off_m < 1e-7
    assert 0.9 * INNER < frame.off_m <= INNER
    assert f"is too much, about {1e3 * frame.off_m:.2g} mm off at most" in " ".join(found.notes)
    assert egg.source.volume_m3 == pytest.approx(4.0 / 3.0 * math.pi * 0.03**2 * 0.04, rel=1e-12)
    assert -0.05 < egg.volume_off < -1e-3
    assert egg.size_off_m < egg.off_m == pytest.approx(0.26e-3, rel=0.05)


def test_an_object_weighs_what_mujoco_adds_up(tmp_path):
    """By its composite inertia, which is another way than ours from body to body."""
    source, ours = imported(model(tmp_path), "arm", qpos="bend=0.7").weight
    assert ours.mass_kg == pytest.approx(source.mass_kg, rel=1e-12)
    assert ours.center_m == pytest.approx(source.center_m, abs=1e-12)
    assert ours.inertia_kg_m2 == pytest.approx(source.inertia_kg_m2, abs=1e-12 * np.abs(source.inertia_kg_m2).max())
    assert np.abs(source.inertia_kg_m2[0, 1:]).min() > 0.0


def test_the_page_shows_bodies_as_mujoco_has_them_and_as_they_are_here(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    model(tmp_path)
    assert main(["import", "arm.xml", "--object", "arm", "-o", "scene.yaml", "--report", "page.html"]) == 0
    out, page = capsys.readouterr().out, Path("page.html").read_text()
    assert "tip    object  1 capsule, 1 cylinder" in out
    assert "MuJoCo says of the object: 0.0954" in out
    assert page.count("data:image/png;base64,") == 8
    for said in ("<td>frame</td>", "MuJoCo says of the object", "is a plane; here, a box"):
        assert said in page

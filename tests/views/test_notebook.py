"""What notebooks show: well-formed, complete, and without any extra."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

import cagepose
from cagepose.views.viewer.page import page
from cagepose.views.viewer.playback import playback

SCENES = sorted((Path(__file__).resolve().parents[2] / "scenes").glob("*.yaml"))
SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_every_scene_has_a_picture_that_holds_all_of_it(path: Path) -> None:
    scene = cagepose.load_scene(path)
    svg = ElementTree.fromstring(scene._repr_html_()).find(f"{SVG}svg")
    assert svg is not None
    circles = [mark for mark in svg.iter(f"{SVG}circle") if mark.find(f"{SVG}title") is not None]
    assert [mark.findtext(f"{SVG}title") for mark in circles] == list(scene.cage.names)
    assert all(0 <= float(mark.attrib["cx"]) <= 360 and 0 <= float(mark.attrib["cy"]) <= 240 for mark in circles)
    lines = [mark.attrib["d"] for mark in svg.iter(f"{SVG}path")]
    assert len(lines) >= len((*scene.object.parts, *scene.object.holes, *scene.cage.shapes, *scene.cage.holes))
    assert all(lines)


def test_a_run_is_a_frame_and_its_text_is_left_where_frames_are_taken_out() -> None:
    run = cagepose.run(cagepose.load_scene(SCENES[0].with_name("rail-pitch.yaml")))
    html = run._repr_html_()
    assert len(html) < 0.4 * len(page(playback(run, "mm")))
    frame, _, left = html.partition("</iframe>")
    assert ElementTree.fromstring(frame + "</iframe>").attrib.keys() == {"title", "srcdoc", "style"}
    assert "".join(ElementTree.fromstring(left).itertext()) == f"{run!r}{run}"


def test_a_name_cannot_break_the_page() -> None:
    cage = cagepose.Cage([(0, 0, 0)], ["<b>&"])
    held = cagepose.Object([cagepose.Box((1, 1, 1))], pose=cagepose.Pose((0, 0, 1)))
    scene = cagepose.Scene(held, cage, [cagepose.Load("<script>", gravity=(0, 0, -1))], name="<i>")
    for html in (scene._repr_html_(), cagepose.run(scene)._repr_html_()):
        assert ElementTree.fromstring(f"<div>{html}</div>") is not None


def test_no_extra_is_needed() -> None:
    code = f"""
import sys
for name in ("PIL", "matplotlib", "manifold3d", "jinja2", "pandas"):
    sys.modules[name] = None
import cagepose
run = cagepose.run(cagepose.load_scene({str(SCENES[0])!r}))
print(len(run._repr_html_()) > 1000, len(str(run)) > 100)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True True\n"

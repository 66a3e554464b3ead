"""``cagepose insertion``: the page, the document, the picture, and what is refused."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

import cagepose
from cagepose import Scene, insertion, save_scene
from cagepose.cli.app import main
from cagepose.files.units import from_metres
from cagepose.views.insertion_figure import insertion_figure
from cagepose.views.style import figure_bytes
from driven.driven_scenes import jaws, truss
from driven.pins_into_plates import pins_into_a_plate
from our_scenes import SCENES

OURS = {path.stem: str(path) for path in SCENES}


@pytest.fixture
def plate(tmp_path: Path) -> str:
    name = tmp_path / "plate.yaml"
    save_scene(pins_into_a_plate((-40.0, 40.0)), name)
    return str(name)


def printed(capsys: pytest.CaptureFixture[str]) -> list[str]:
    return [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]


def test_one_page_tells_the_drive_and_both_sides_of_each_freedom(
    plate: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["insertion", plate, "--along", "x,yaw"]) == 0
    lines = printed(capsys)
    assert lines[0] == "pins into a plate, press: rests"
    assert "drive complete, 9 mm" in lines
    assert "jam impossible at any friction, at all places checked" in lines
    assert "it cannot jam with these contacts along this path, as long as nothing rubs (friction 0)" in lines
    assert "Permitted misalignment of head, one freedom at a time, and how it fails just outside:" in lines
    assert "x mm -0.8458 0.8458 blocked blocked" in lines
    assert "yaw deg -1.211 1.211 blocked blocked" in lines
    assert len(lines) < 20


def test_what_is_searched_in_vain_is_told_as_at_least(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    save_scene(pins_into_a_plate(), tmp_path / "one.yaml")
    assert main(["insertion", str(tmp_path / "one.yaml"), "--along", "yaw"]) == 0
    assert "yaw deg at least -10 at least 10 not searched not searched" in printed(capsys)


def test_a_drive_that_does_not_get_through_permits_nothing_and_says_where_it_jams(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["insertion", OURS["drawer-jams"]]) == 0
    lines = printed(capsys)
    assert lines[0] == "drawer that jams, push: jams"
    assert "jam possible from 0 mm to 0 mm (it takes a friction of 1.5 or more)" in lines
    assert "the first place to jam, as friction grows, is at 0 mm" in lines
    assert "y mm - - jams jams" in lines
    assert not any("cannot jam" in line for line in lines)


def test_the_document_has_the_same_in_the_units_of_the_scene(plate: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["insertion", plate, "--along", "x,yaw", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    found = insertion(cagepose.load_scene(plate), along=["x", "yaw"])
    assert list(document) == [
        *("version", "scene", "units", "phase", "verdict", "drive", "friction", "cannot_jam"),
        *("least_jam_friction", "least_jam_share", "jam_friction", "out_of_place", "misalignment", "timing_s"),
    ]
    assert document["units"] == {"length": "mm", "force": "N"}
    assert document["out_of_place"] == {"bodies": ["head"], "object": False}
    assert document["drive"]["bodies"]["head"]["travel"] == pytest.approx(9.0)
    assert len(document["jam_friction"]["depth"]) == len(document["drive"]["curve"]["share"])
    assert document["jam_friction"]["depth"] == pytest.approx(from_metres(found.depth_m, "mm"))
    for name, unit in (("x", 1e3), ("yaw", math.degrees(1.0))):
        for side in ("low", "high"):
            end = getattr(found.misalignment[name], side)
            assert document["misalignment"][name][side] == {
                "permitted": pytest.approx(unit * end.permitted),
                "fails_at": pytest.approx(unit * end.fails_at),
                "verdict": "blocked",
            }


def test_a_drive_that_does_not_begin_says_why(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """The object escapes in the phase before: that is a verdict, and so it ends with 0."""
    scene = truss()
    falls = cagepose.Load("fall", gravity=(0.0, 0.0, -9.81))
    save_scene(Scene(scene.object, scene.cage, [falls, *scene.loads], friction_coefficient=0.0), tmp_path / "fall.yaml")
    picture = tmp_path / "fall.svg"
    assert main(["insertion", str(tmp_path / "fall.yaml"), "--along", "x", "--picture", str(picture)]) == 0
    lines = printed(capsys)
    assert "drive it did not start: fall did not come to rest (escapes)" in lines
    assert "x mm - - escapes escapes" in lines
    assert "the drive did not start" in picture.read_text(encoding="utf-8")
    assert main(["insertion", str(tmp_path / "fall.yaml"), "--along", "x", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["drive"], document["least_jam_share"], document["jam_friction"]["least"]) == (None, None, [])


def test_a_run_that_failed_by_name_ends_with_one(plate: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cagepose.Run, "failed", property(lambda _: True))
    assert main(["insertion", plate, "--along", "y", "--json"]) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--along", "x,tilt"], "--along: is 'tilt'; use one of: x, y, z, roll, pitch, yaw"),
        (["--phase", "settle"], "--phase: is 'settle'; use one of: press"),
        (
            ["--picture", "plate.doc"],
            "--picture plate.doc: .doc is no known kind of file; use one of: .png, .svg, .pdf",
        ),
        (["--report", "plate.pdf"], "--report plate.pdf: .pdf is no known kind of file; use one of: .html"),
        (["--set", "loads[0].drive.head.travl=1"], "is no known key"),
    ],
)
def test_bad_input_is_told_with_its_place(
    plate: str, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["insertion", plate, *arguments]) == 2
    told = capsys.readouterr()
    assert message in told.err
    assert told.out == ""


def test_a_scene_that_drives_nothing_is_told_by_its_file(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["insertion", OURS["ladder"]]) == 2
    assert capsys.readouterr().err == (
        f"{OURS['ladder']}: loads: drive no body of the cage, so nothing is inserted; give a phase a drive\n"
    )


def test_the_picture_has_force_jam_friction_and_a_bar_for_each_freedom(plate: str, tmp_path: Path) -> None:
    found = insertion(cagepose.load_scene(plate), along=["y", "yaw"])
    figure = insertion_figure(found)
    force, friction, shifts, turns = figure.axes
    assert force.get_ylabel() == "drive force [N]"
    assert friction.get_xlabel() == "head, travelled [mm]"
    for panel, name, unit in ((shifts, "y", 1e3), (turns, "yaw", math.degrees(1.0))):
        (bar,) = panel.patches
        ends = found.misalignment[name]
        assert bar.get_x() == pytest.approx(unit * ends.low.permitted)
        assert bar.get_x() + bar.get_width() == pytest.approx(unit * ends.high.permitted)
        assert [text.get_text() for text in panel.texts] == ["blocked", "blocked"]
        assert [label.get_text() for label in panel.get_yticklabels()] == [name]
    assert main(["insertion", plate, "--along", "y,yaw", "--picture", str(tmp_path / "plate.svg")]) == 0
    assert (tmp_path / "plate.svg").read_bytes() == figure_bytes(figure, ".svg")


def test_where_it_could_jam_is_shaded_over_force_and_friction() -> None:
    closed = insertion(jaws(), "close", along=())
    force, friction = insertion_figure(closed).axes
    assert closed.drive is not None
    for panel in (force, friction):
        shaded = [patch for patch in panel.patches if patch.get_hatch()]
        assert [(100 * begins, 100 * ends) for begins, ends in closed.drive.jam_possible] == [
            (pytest.approx(patch.get_x()), pytest.approx(patch.get_x() + patch.get_width())) for patch in shaded
        ]
    (line, *_) = friction.lines
    assert line.get_ydata().tolist() == pytest.approx(
        [value if math.isfinite(value) else math.nan for value in closed.jam_friction], nan_ok=True
    )

"""The picture of a drive: its curve is that of the run, and bars stand where elements touch."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import cagepose
from cagepose import Run, Scene, load_run, save_run, save_scene
from cagepose.cli.app import main
from cagepose.views.drive_figure import drive_figure
from cagepose.views.style import figure_bytes
from driven.driven_scenes import ALL, jaws, lever, truss, wedge


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    return {name: cagepose.run(make()) for name, make in ALL.items()}


def curve_of(panel) -> np.ndarray:
    """The points of the force, (n, 2); the first line is zero."""
    return np.column_stack([panel.lines[1].get_xdata(), panel.lines[1].get_ydata()])


def bars_of(panel) -> list[tuple[float, float, float]]:
    """Row, first and last place of each bar."""
    boxes = [path.get_extents() for bar in panel.collections for path in bar.get_paths()]
    return sorted((round(0.5 * (box.y0 + box.y1)), float(box.x0), float(box.x1)) for box in boxes)


def test_the_force_of_a_truss_is_drawn_up_to_where_it_snaps_and_is_zero_beyond(runs) -> None:
    """It meets the block after 1 mm and needs no force from its dead point on, after 31 mm."""
    run = runs["truss"]
    force, touching, way, _ = drive_figure(run).axes
    curve, drive = curve_of(force), run.phases[0].drive
    places = curve[np.isfinite(curve[:, 1])]
    assert places[:, 1].max() == drive.greatest_along
    assert places[places[:, 1].argmax(), 0] == pytest.approx(50.0 * drive.greatest_share)
    assert places[places[:, 0] > 31.01][:, 1] == pytest.approx(0.0)
    assert [text.get_text() for text in touching.get_yticklabels()][-1] == "tip"
    assert bars_of(touching)[-1] == (4, pytest.approx(1.0), pytest.approx(31.0))
    assert way.lines[2].get_ydata()[[0, -1]] == pytest.approx([0.0, -60.0])
    assert force.get_ylabel() == "drive force [N]"
    assert drive_figure(run).axes[3].get_xlabel() == "pusher, travelled [mm]"


def test_several_bodies_and_phases_stand_beside_each_other_over_their_share(runs) -> None:
    figure = drive_figure(runs["jaws"])
    close, lift = (
        next(panel for panel in figure.axes if panel.get_title() == title)
        for title in ("close: blocked", "lift: rests")
    )
    assert curve_of(close)[-1, 0] == pytest.approx(250.0 / 3.0)
    assert curve_of(lift)[-1, 0] == pytest.approx(100.0)
    labels = {panel.get_xlabel() for panel in figure.axes} - {""}
    assert labels == {"close: share of the way [%]", "lift: share of the way [%]"}


def test_moments_are_in_the_unit_of_the_figure(runs) -> None:
    in_mm, in_inches = (drive_figure(runs["lever"], unit).axes[0] for unit in ("mm", "in"))
    assert np.nanmax(curve_of(in_mm)[:, 1]) == pytest.approx(467.067, rel=1e-5)
    assert np.nanmax(curve_of(in_inches)[:, 1]) == pytest.approx(467.067 / 25.4, rel=1e-5)
    assert in_mm.get_ylabel() == "drive force [N], moment [N mm]"


def test_what_no_body_moved_for_has_no_force(runs) -> None:
    """What holds the ramp before it is driven is not known, and not drawn."""
    curve = curve_of(drive_figure(runs["wedge"]).axes[0])
    assert np.isnan(curve[0, 1])
    assert curve[1:, 1] == pytest.approx(runs["wedge"].phases[0].drive.along, rel=1e-9)


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_a_drive_can_be_drawn_into_any_file_always_the_same(runs, suffix: str) -> None:
    content = figure_bytes(drive_figure(runs["jaws"]), suffix)
    assert content == figure_bytes(drive_figure(runs["jaws"]), suffix)
    if suffix == ".png":
        with Image.open(io.BytesIO(content)) as picture:
            assert picture.size[0] == 1500


@pytest.mark.parametrize("make", [wedge, truss, jaws, lever])
def test_a_saved_run_is_drawn_as_the_run(make, tmp_path: Path) -> None:
    run = cagepose.run(make())
    save_run(run, tmp_path / "run.json")
    assert figure_bytes(drive_figure(load_run(tmp_path / "run.json")), ".svg") == figure_bytes(
        drive_figure(run), ".svg"
    )


def test_the_command_draws_a_drive_and_refuses_where_there_is_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = wedge()
    save_scene(scene, tmp_path / "wedge.yaml")
    assert main(["plot", str(tmp_path / "wedge.yaml"), "--out", str(tmp_path / "wedge.png"), "--kind", "drive"]) == 0
    assert capsys.readouterr().out.endswith("rests (quasistatic)\n")
    still = Scene(scene.object, scene.cage, [cagepose.Load("weight", gravity=(0, 0, -1))], friction_coefficient=0.5)
    save_scene(still, tmp_path / "still.yaml")
    out = str(tmp_path / "still.png")
    assert main(["plot", str(tmp_path / "still.yaml"), "--out", out, "--kind", "drive"]) == 2
    assert capsys.readouterr().err == "--kind drive: no phase of the run drives a body of the cage; give another kind\n"
    assert not Path(out).exists()
    with pytest.raises(ValueError, match="no phase of this run has driven a body"):
        drive_figure(cagepose.run(still))

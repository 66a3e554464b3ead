"""``cagepose view``: from a scene or a saved run to a page."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from cagepose.files import extra

Command = Callable[..., Any]


def page_data(name: str) -> Any:
    return json.loads(Path(name).read_text(encoding="utf-8").split('id="data">')[1].split("</script>")[0])


def test_a_scene_becomes_a_page(command: Command, sample: str) -> None:
    answer = command("view", sample, "--export", "page.html", "--method", "stepwise")
    assert (answer.code, answer.out) == (0, "wrote page.html: sample, stable (stepwise)\n")
    assert [phase["verdict"] for phase in page_data("page.html")["phases"]] == ["stable"]


def test_a_saved_run_gives_the_same_page_as_its_scene_but_for_the_time_it_took(command: Command, sample: str) -> None:
    inches = ("--set", "units.length=in", "--set", "tolerances.touch=1e-8")
    command("run", sample, "--out", "run.json", *inches)
    assert command("view", sample, "--export", "scene.html", *inches).code == 0
    assert command("view", "run.json", "--export", "run.html").code == 0
    one, other = page_data("scene.html"), page_data("run.html")
    assert one.pop("solve") and other.pop("solve")  # noqa: PT018 (both are there, and differ)
    assert one == other


@pytest.mark.parametrize(
    ("export", "reason"),
    [
        ("run.gltf", ".gltf is no known kind of file; use one of: .html, .png, .gif, .mp4"),
        ("run", "has no suffix that names its kind; use one of: .html, .png, .gif, .mp4"),
        ("no/run.html", "its folder does not exist; make the folder first"),
    ],
)
def test_an_export_that_cannot_be_is_refused_before_the_run(
    command: Command, sample: str, export: str, reason: str
) -> None:
    assert command("view", sample, "--export", export) == (2, "", f"--export {export}: {reason}\n")


def test_a_picture_and_a_film_are_written_and_may_be_written_again(command: Command, sample: str) -> None:
    for name in ("run.png", "run.gif", "run.mp4") * 2:
        assert command("view", sample, "--export", name, "--method", "stepwise").code == 0
    with Image.open("run.gif") as film:
        assert (film.n_frames, film.size) == (32, (720, 480))


@pytest.mark.parametrize(
    ("module", "export", "need", "name"),
    [
        ("PIL", "run.png", "pictures need Pillow", "view"),
        ("PIL", "run.gif", "pictures need Pillow", "view"),
        ("PIL", "run.mp4", "videos need Pillow", "film"),
        ("av", "run.mp4", "videos need PyAV", "film"),
    ],
)
def test_a_missing_library_is_named_with_its_extra_before_the_run(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch, module: str, export: str, need: str, name: str
) -> None:
    monkeypatch.setattr(extra, "find_spec", lambda name: None if name == module else object())
    told = f"{need}, which is not installed; install the {name} extra: pip install 'cagepose[{name}]'\n"
    assert command("view", sample, "--export", export) == (2, "", told)
    assert command("view", sample, "--export", "run.html").code == 0


def test_our_own_page_is_replaced_and_nobody_elses(command: Command, sample: str) -> None:
    assert command("view", sample, "--export", "page.html").code == 0
    assert command("view", sample, "--export", "page.html").code == 0
    Path("diary.html").write_text("dear diary", encoding="utf-8")
    answer = command("view", sample, "--export", "diary.html")
    assert answer.code == 2
    assert "holds something else than" in answer.err
    assert Path("diary.html").read_text(encoding="utf-8") == "dear diary"

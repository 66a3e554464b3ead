"""``cagepose plot``: from a scene or a saved run to a picture file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from cagepose.files import extra

Command = Callable[..., Any]


@pytest.mark.parametrize("kind", ["pose", "events"])
def test_a_scene_becomes_a_picture(command: Command, sample: str, kind: str) -> None:
    answer = command("plot", sample, "--out", f"{kind}.png", "--kind", kind, "--method", "stepwise")
    assert (answer.code, answer.out) == (0, f"wrote {kind}.png: sample, stable (stepwise)\n")
    with Image.open(f"{kind}.png") as picture:
        picture.load()
        assert picture.size[0] == 1500


def test_a_saved_run_gives_the_same_picture_as_its_scene(command: Command, sample: str) -> None:
    inches = ("--set", "units.length=in", "--set", "tolerances.touch=1e-8")
    command("run", sample, "--method", "stepwise", "--out", "run.json", *inches)
    assert command("plot", sample, "--out", "scene.svg", "--method", "stepwise", *inches).code == 0
    assert command("plot", "run.json", "--out", "run.svg") == (0, "wrote run.svg: sample, stable (stepwise)\n", "")
    assert Path("scene.svg").read_bytes() == Path("run.svg").read_bytes()


def test_our_own_picture_is_replaced_and_nobody_elses(command: Command, sample: str) -> None:
    assert command("plot", sample, "--out", "mine.pdf").code == 0
    assert command("plot", sample, "--out", "mine.pdf", "--kind", "events").code == 0
    Path("photo.png").write_bytes(b"a photo")
    answer = command("plot", sample, "--out", "photo.png")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == (
        "--out photo.png: holds something else than a page or picture that cagepose made; name another file, or"
        " remove it first\n"
    )
    assert Path("photo.png").read_bytes() == b"a photo"


@pytest.mark.parametrize(
    ("out", "reason"),
    [
        ("figure.bmp", ".bmp is no known kind of file; use one of: .png, .svg, .pdf"),
        ("figure", "has no suffix that names its kind; use one of: .png, .svg, .pdf"),
        ("no/figure.png", "its folder does not exist; make the folder first"),
        ("folder.png", "is a directory; name a file in it"),
    ],
)
def test_an_out_that_cannot_be_is_refused_before_the_run(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch, out: str, reason: str
) -> None:
    def never(*_: object) -> None:
        raise AssertionError("nothing may run before all arguments are checked")

    Path("folder.png").mkdir()
    monkeypatch.setattr("cagepose.runs.solve.run", never)
    assert command("plot", sample, "--out", out) == (2, "", f"--out {out}: {reason}\n")


def test_problems_of_all_arguments_come_at_once(command: Command, in_folder: Path) -> None:
    assert in_folder.is_dir()
    answer = command("plot", "nothing.yaml", "--method", "magic", "--out", "x.gif")
    assert answer.code == 2
    lines = answer.err.splitlines()
    assert lines[0] == "nothing.yaml: does not exist; check the name and the folder"
    assert lines[1].startswith("--method magic: is no known method; use one of: ")
    assert lines[2] == "--out x.gif: .gif is no known kind of file; use one of: .png, .svg, .pdf"


@pytest.mark.parametrize("flags", [("--set", "name=other"), ("--method", "stepwise")])
def test_a_saved_run_cannot_be_changed(command: Command, sample: str, flags: tuple[str, str]) -> None:
    command("run", sample, "--out", "run.json")
    answer = command("plot", "run.json", "--out", "x.png", *flags)
    message = f"{flags[0]}: changes a scene, but run.json is a saved run; name the scene file\n"
    assert answer == (2, "", message)
    assert not Path("x.png").exists()


def test_a_damaged_run_is_told(command: Command, in_folder: Path) -> None:
    (in_folder / "run.json").write_text('{"version": 2, "phases": []}', encoding="utf-8")
    answer = command("plot", "run.json", "--out", "x.png")
    assert answer.code == 2
    assert answer.err.startswith("run.json: is what --json prints, without the exact numbers")


def test_a_disk_that_fills_up_is_told(command: Command, sample: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    answer = command("plot", sample, "--out", "x.png")
    assert answer.code == 2
    assert answer.err == "--out x.png: No space left on device\n"
    assert [path.name for path in Path().iterdir()] == ["scene.yaml"]


@pytest.mark.parametrize("arguments", [("plot", "scene.yaml", "--out", "x.png"), ("reproduce",)])
def test_a_missing_matplotlib_is_told_with_its_remedy(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...]
) -> None:
    assert Path(sample).is_file()
    monkeypatch.setattr(extra, "find_spec", {"matplotlib": None}.__getitem__)
    assert command(*arguments) == (
        2,
        "",
        "pictures need matplotlib, which is not installed; install the plot extra: pip install 'cagepose[plot]'\n",
    )
    assert [path.name for path in Path().iterdir()] == ["scene.yaml"]


@pytest.mark.parametrize("name", ["run", "play", "compare"])
def test_what_asks_for_a_scene_says_that_it_got_a_saved_run(command: Command, sample: str, name: str) -> None:
    command("run", sample, "--out", "run.json")
    answer = command(name, "run.json")
    assert answer.code == 2
    assert answer.err.startswith("run.json: is a saved run, not a scene; name its scene file")

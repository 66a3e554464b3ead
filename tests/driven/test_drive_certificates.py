"""Certificates of drives: those that are made are right, and those that were changed are refused."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    CageBody,
    Certificate,
    CertificateError,
    Drive,
    Load,
    Object,
    Pose,
    Run,
    Scene,
    Spring,
    certificate,
    check_certificate,
    load_certificates,
    load_run,
    load_scene,
    run,
    save_run,
)
from cagepose.cli.app import main
from cagepose.files.record import record_of
from cagepose.studies.drive_check import DriveCheck
from driven.driven_scenes import truss
from driven.forged_drives import FORGED
from driven.insertions import LG, Insertion

ROOT = Path(__file__).parents[2]
SCENES = ROOT / "scenes"


@cache
def certified(name: str) -> tuple[Run, Certificate]:
    """Of the last phase of one of our scenes, or of a short insertion."""
    peg = Insertion(5.05, 0.4, 0.0, 0.1)
    a_run = run(peg.scene(3.0, [LG - 6.0]) if name == "peg" else load_scene(SCENES / f"{name}.yaml"))
    found = certificate(a_run)
    assert found is not None
    return a_run, found


def checked(name: str) -> DriveCheck:
    a_run, found = certified(name)
    drive = check_certificate(found, a_run).drive
    assert drive is not None
    return drive


@pytest.mark.parametrize("name", ["insertion", "dock"])
def test_an_insertion_that_cannot_jam_has_a_motion_with_a_margin_at_each_place(name: str) -> None:
    a_run, found = certified(name)
    drive = checked(name)
    assert found.drive is not None
    assert a_run.phases[-1].drive is not None
    assert a_run.phases[-1].drive.jam_possible == ()
    assert (drive.could_jam, drive.stopped) == ((), None)
    assert drive.margin is not None
    assert drive.margin > 0.01
    assert drive.n_places == len(found.drive.places) > 30
    places = {round(place.share, 9) for place in found.drive.places}
    assert {round(event.share, 9) for event in a_run.phases[-1].events} <= places


def test_jaws_are_blocked_where_they_have_closed_and_only_there_could_they_jam() -> None:
    a_run, _ = certified("jaws")
    drive = checked("jaws")
    end = a_run.phases[0].drive
    assert end is not None
    assert (drive.stopped, drive.could_jam) == ("blocked", (end.share,))
    assert drive.speed <= 1e-12
    assert drive.n_free == 4  # along the pads, about the line between them, and up and down with the block


def test_a_drawer_that_jams_has_a_tree_and_without_friction_a_motion() -> None:
    _, found = certified("drawer-jams")
    drive = checked("drawer-jams")
    assert (drive.stopped, drive.could_jam) == ("jams", (0.0,))
    assert drive.n_leaves > 20
    assert drive.speed <= 1e-6
    assert found.drive is not None
    (choice,) = found.drive.choices
    assert choice.tree is not None
    assert choice.tree.twists.shape == (drive.n_leaves, 7)


def test_a_guide_without_play_gives_way_without_a_margin() -> None:
    """Its walls can press against each other, which does no work on the drive: nothing is left over."""
    a_run = run(truss())
    found = certificate(a_run)
    drive = check_certificate(found, a_run).drive
    assert drive is not None
    assert drive.could_jam == ()
    assert drive.margin == pytest.approx(0.0, abs=1e-11)


def test_what_stands_on_a_plate_takes_up_the_growth_of_the_load() -> None:
    """A block on springs is let down on a plate, and on: its contacts stand still, and the springs give way."""
    block = Object([Box((0.02, 0.02, 0.02))], pose=Pose((0.0, 0.0, 0.011)))
    plate = Box((0.1, 0.1, 0.02), Pose((0.0, 0.0, -0.01)), "plate")
    pulls = [Spring((0.0, 0.0, z), (0.0, 0.0, 4.0 * z), 500.0, 20.0, of="hand") for z in (-0.01, 0.01)]
    drive = {"hand": Drive((0.0, 0.0, -0.002))}
    hand = CageBody("hand", pose=Pose((0.0, 0.0, 0.011)))
    a_run = run(Scene(block, Cage(shapes=[plate], bodies=[hand]), [Load("press", springs=pulls, drive=drive)]))
    found = certificate(a_run)
    assert found is not None
    assert found.drive is not None
    checked = check_certificate(found, a_run).drive
    assert checked is not None
    assert [share < 0.5 - 1e-6 for share in checked.could_jam] == [False] * len(checked.could_jam)
    assert len(checked.could_jam) > 5
    for place in found.drive.places:
        (choice,) = place.choices
        assert (choice.taken > 0.0) == (choice.motion is None) == bool(place.contacts)


# forged


@pytest.mark.parametrize(("name", "change", "message"), FORGED, ids=[f"{k}-{one[0]}" for k, one in enumerate(FORGED)])
def test_a_changed_certificate_is_refused(
    name: str, change: Callable[[Certificate], Certificate], message: str
) -> None:
    a_run, found = certified(name)
    with pytest.raises(CertificateError, match=message):
        check_certificate(change(found), a_run)


@pytest.mark.parametrize(("name", "friction"), [("drawer-jams", 1.49), ("drawer-jams", 1.7), ("peg", 5.0)])
def test_a_certificate_is_for_the_friction_of_its_scene(name: str, friction: float) -> None:
    """Also where it tells of the other friction: "cannot jam" is for less, and "could jam" for more."""
    a_run, found = certified(name)
    other = replace(a_run, scene=a_run.scene.changed(friction_coefficient=friction))
    with pytest.raises(CertificateError, match="friction of"):
        check_certificate(found, other)
    assert found.drive is not None
    before = a_run.scene.friction_coefficient
    places = tuple(
        replace(place, friction=np.where(place.friction == before, friction, place.friction))
        for place in found.drive.places
    )
    told = replace(found, uniqueness=None, drive=replace(found.drive, places=places, stopped=None, choices=()))
    if name == "drawer-jams" and friction > 1.6:
        assert check_certificate(told, other).drive is not None
    else:
        with pytest.raises(CertificateError, match=r"leave their friction cones|does not give way to"):
            check_certificate(told, other)


def test_a_certificate_of_a_drive_is_for_a_phase_that_drives() -> None:
    a_run, found = certified("dock")
    with pytest.raises(CertificateError, match="the phase drives nothing"):
        check_certificate(found, a_run, 0)


# saved


@pytest.mark.parametrize("name", ["drawer-jams", "insertion", "jaws"])
def test_certificates_of_drives_are_saved_with_a_run_and_checked_by_the_command(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a_run, found = certified(name)
    path = tmp_path / "run.json"
    save_run(a_run, path)
    (again,) = load_certificates(path)
    assert again is not None
    assert json.dumps(record_of(again)) == json.dumps(record_of(found))
    assert check_certificate(again, load_run(path)) == check_certificate(found, a_run)
    assert main(["check", str(path)]) == 0
    told = capsys.readouterr().out
    assert "drive: only these places are proven, not the way between them" in told
    assert {"jaws": "blocked: normal", "drawer-jams": "jams: in none of", "insertion": "cannot jam at any of"}[
        name
    ] in told
    content = json.loads(path.read_text(encoding="utf-8"))
    place = content["certificates"][0]["drive"]["places"][-1]
    place["drifts"] = [[1.0 + number for number in drift] for drift in place["drifts"]]
    path.write_text(json.dumps(content), encoding="utf-8")
    assert main(["check", str(path)]) == 1
    assert "the certificate is wrong: drive, row" in capsys.readouterr().out


def test_the_command_takes_no_changes_of_a_saved_run_and_none_without_certificates(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a_run, _ = certified("drawer-jams")
    save_run(a_run, tmp_path / "run.json")
    assert main(["check", str(tmp_path / "run.json"), "--set", "friction.coefficient=1"]) == 2
    assert "is a saved run; name the scene file" in capsys.readouterr().err
    content = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    del content["certificates"]
    (tmp_path / "old.json").write_text(json.dumps(content), encoding="utf-8")
    assert main(["check", str(tmp_path / "old.json")]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert "has no certificates" in told.err


def test_a_phase_that_drives_nothing_has_no_drive() -> None:
    """By the paper's rules, too, whose numbers stand where those of drives do."""
    for method in ("quasistatic", "stepwise"):
        a_run = run(load_scene(SCENES / "rail-yaw.yaml"), method)
        assert [phase.drive for phase in a_run.phases] == [None, None]
    assert re.match("<Certificate: strong", repr(certificate(run(load_scene(SCENES / "ladder.yaml")))))


@pytest.mark.parametrize(("name", "said"), [("dock", "cannot jam"), ("drawer-jams", "could jam"), ("jaws", "blocked")])
def test_the_lines_of_the_theory_check_a_saved_run(
    name: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs" / "theory" / "driven.md").read_text(encoding="utf-8")
    (by_hand,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    a_run, _ = certified(name)
    save_run(a_run, tmp_path / "run.json")
    monkeypatch.chdir(tmp_path)
    exec(by_hand, {})
    assert said in capsys.readouterr().out
    text = (tmp_path / "run.json").read_text(encoding="utf-8")
    content = json.loads(text)
    for place in content["certificates"][-1]["drive"]["places"]:
        place["drifts"] = [[-number for number in drift] for drift in place["drifts"]]
        for choice in place["choices"]:
            choice["motion"] = choice["motion"] and [-number for number in choice["motion"]]
    (tmp_path / "run.json").write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(AssertionError):
        exec(by_hand, {})

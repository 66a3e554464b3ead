"""``cagepose run`` and ``cagepose check``: what they print and how they end."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import cagepose.runs.solve
from cagepose import Run, RunFileError, Scene, load_run, load_scene
from cagepose.cli import report
from cagepose.model.methods import METHODS
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.playback import playback

Command = Callable[..., Any]
SCENES = Path(__file__).resolve().parents[2] / "scenes"


def summary(out: str) -> dict[str, str]:
    """The lines ``name  value`` below the table of events."""
    rows = out.split("\n\n")[-1].splitlines()
    return dict(re.split(r"\s{2,}", row, maxsplit=1) for row in rows if not row.startswith("warning: "))


def forces(out: str) -> list[list[str]]:
    """The rows of the tables of forces: names of both sides, and the force of each phase that has one."""
    found, is_table = list[list[str]](), False
    for line in out.splitlines():
        is_table = line.startswith("contact ") or (is_table and line != "")
        if is_table and not line.startswith(("contact ", "─")):
            found.append(re.split(r"\s{2,}", line.strip()))
    return found


def test_the_table_shows_every_event_of_the_sample(command: Command, sample: str) -> None:
    answer = command("run", sample, "--method", "stepwise")
    rows = [re.split(r"\s{2,}", line.strip()) for line in answer.out.splitlines() if re.match(r"\d+  ", line)]
    assert rows == [
        ["1", "gravity", "A-1", "travel", "(0, 0, -1)", "5 mm", "C1"],
        ["2", "gravity", "A-2", "turn", "(0, -1, 0)", "28.955 deg", "C4"],
        ["3", "gravity", "A-3", "turn", "(1, 0, 0)", "51.3178 deg", "C3"],
        ["4", "gravity", "A-4", "stable"],
    ]
    assert answer.code == 0


def test_the_report_names_pose_contacts_verdict_time_and_warnings(command: Command, sample: str) -> None:
    lines = command("run", sample, "--method", "stepwise").out.splitlines()
    assert re.fullmatch(
        r"sample: stable by the paper's rules; by the mechanics it moves on from there  \(stepwise, [0-9.e+]+ ms\)",
        lines[0],
    )
    assert "position           (-0.170615, 1.3406, 2.12922) mm" in lines
    assert "yaw, pitch, roll   (-23.3598, -17.6124, 54.9864) deg" in lines
    assert "centre of gravity  (-0.170615, 1.3406, 2.12922) mm" in lines
    assert "contacts           C1 C3 C4 on box1" in lines
    assert "verdict            gravity: stable" in lines
    warnings = [line for line in lines if line.startswith("warning: ")]
    assert len(warnings) == 3
    assert "tie" in warnings[0]
    assert "45 deg" in warnings[1]
    assert "the mechanics contradicts this verdict: with a friction coefficient of 0.1003" in warnings[2]


def test_a_part_that_falls_over_is_told_in_a_line_of_its_own_and_on_the_page(command: Command, in_folder: Path) -> None:
    """A box on its edge, a hair past it: it falls to its side. And one that turns on the floor has not fallen."""
    floor = "cage: {shapes: [{name: floor, box: {size: [200, 200, 20]}, position: [0, 0, -10]}]}\n"
    part = "object: {boxes: [{size: [20, 20, 60], position: [-10, 0, 30]}], pose: {euler_zyx_deg: [0, 19, 0]}}\n"
    scene = in_folder / "box.yaml"
    scene.write_text(f"name: box\n{part}{floor}loads: [{{name: fall, gravity: [0, 0, -1]}}]\n")
    assert summary(command("run", "box.yaml").out)["turned"] == "fall: 71 deg about y, so it tipped or rolled"
    told = page_data(playback(cagepose.run(load_scene(scene))))
    assert told["turned"] == ["fall: 71 deg about y, so it tipped or rolled"]
    assert any("It turned far in fall" in note for note in told["notes"])
    scene.write_text(scene.read_text().replace("0, 19, 0", "0, 18, 0"))  # atan(20 / 60) is 18.4 deg
    assert "turned" not in summary(command("run", "box.yaml").out)


def test_lengths_are_shown_in_the_scenes_unit(command: Command, sample: str) -> None:
    changes = ("--set", "units.length=in", "--set", "tolerances.touch=1e-8")
    out = command("run", sample, "--method", "stepwise", *changes).out
    assert "5 in" in out
    assert "(-0.170615, 1.3406, 2.12922) in" in out
    assert " mm" not in out


def test_piped_output_has_no_escapes_no_trailing_blanks_and_nothing_cut(
    command: Command, in_folder: Path, sample_text: str
) -> None:
    long_names = sample_text
    for name in ("C1", "C2", "C3", "C4"):
        long_names = long_names.replace(f"{name}:", f"a_very_long_name_for_a_cage_point_of_this_part_{name}:")
    (in_folder / "long.yaml").write_text(long_names, encoding="utf-8")
    out = command("run", "long.yaml", "--method", "stepwise").out
    assert "\x1b" not in out
    assert "…" not in out
    assert " ".join(f"a_very_long_name_for_a_cage_point_of_this_part_{name}" for name in ("C1", "C3", "C4")) in out
    assert all(line == line.rstrip() for line in out.splitlines())


def test_the_usual_table_fits_100_columns(command: Command, sample: str) -> None:
    table = command("run", sample).out.split("position ")[0]
    assert max(len(line) for line in table.splitlines()) <= 100


def test_a_screen_gets_colours_and_wrapped_cells(
    sample: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    report.print_report(cagepose.runs.solve.run(load_scene(sample)), "mm")
    out = capsys.readouterr().out
    assert "\x1b[1;32mrests\x1b[0m" in out
    plain = re.sub(r"\x1b\[[0-9;]*m", "", out)
    assert max(len(line) for line in plain.splitlines()) <= 100


def test_long_names_have_room_on_a_narrow_screen(
    in_folder: Path, sample_text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """No number and no name is broken where a table of one line for each event would break them all."""
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    for key, value in (("COLUMNS", "80"), ("TERM", "dumb")):
        monkeypatch.setenv(key, value)
    text = sample_text
    for name in ("C1", "C2", "C3", "C4"):
        text = text.replace(f"{name}:", f"rest button {name} of the fixture:")
    (in_folder / "long.yaml").write_text(text.replace("name: gravity", "name: weight of the part"), encoding="utf-8")
    report.print_report(cagepose.runs.solve.run(load_scene("long.yaml"), "stepwise"), "mm")
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert max(map(len, lines)) <= 80
    assert "weight of the part:" in lines
    second = lines.index("2  A-2  turn 28.955 deg about (0, -1, 0)")
    assert lines[second + 1] == "        + rest button C4 of the fixture"


def test_names_with_blanks_are_told_apart(command: Command, in_folder: Path, sample_text: str) -> None:
    text = sample_text.replace("C1:", "left pin:").replace("C3:", "right pin:")
    (in_folder / "blanks.yaml").write_text(text, encoding="utf-8")
    out = command("run", "blanks.yaml", "--set", "object.pose.position=[0, 0, 5]").out
    assert "left pin, C2, right pin, C4 on box1" in out
    assert [row[0] for row in forces(out)] == ["left pin", "right pin"]


def test_a_proof_shows_gap_work_and_forces_that_are_not_small() -> None:
    held = cagepose.runs.solve.run(load_scene(SCENES / "slope.yaml"))
    (phase,) = held.phases
    assert (phase.proof.gap_work, phase.proof.largest_force) == (
        pytest.approx(0, abs=1e-15),
        pytest.approx(0.5, abs=0.5),
    )
    for changes, told in (
        ({}, ""),
        ({"gap_work": 2e-10}, ", gap work 2.0e-10"),
        ({"largest_force": 123.4}, ", largest force 123 loads"),
    ):
        shown = report._proof(replace(phase, proof=replace(phase.proof, **changes)))
        assert shown.endswith(f"{told})")
        assert ("gap work" in shown, "largest force" in shown) == ("gap_work" in changes, "largest_force" in changes)


def test_help_lists_the_methods(command: Command) -> None:
    for name in ("run", "plot", "view"):
        text = " ".join(command(name, "--help").out.replace("│", " ").split())
        assert "stepwise or quasistatic; left out: as the scene says" in text


def test_names_with_rich_markup_and_emoji_codes_are_shown_as_they_are(command: Command, sample: str) -> None:
    out = command("run", sample, "--set", "name='[red]:smile:'", "--set", "object.boxes[0].name='[b]'").out
    assert out.startswith("[red]:smile:: rests")
    assert "on [b]" in out


def test_json_is_one_document_and_nothing_else(command: Command, sample: str) -> None:
    answer = command("run", sample, "--json")
    document = json.loads(answer.out)
    assert (document["version"], document["scene"]) == (2, "sample")
    assert (document["method"], document["verdict"]) == ("quasistatic", "rests")
    assert answer.code == 0
    assert answer.err == ""


def test_out_saves_the_run_and_the_table_is_still_printed(command: Command, sample: str) -> None:
    answer = command("run", sample, "--out", "run.json", "--set", "units.length=in")
    assert answer.code == 0
    assert answer.out.startswith("sample: rests")
    assert load_run("run.json").verdict == "rests"
    assert json.loads(Path("run.json").read_text(encoding="utf-8"))["units"]["length"] == "in"


@pytest.mark.parametrize(
    ("out", "reason"),
    [
        ("nowhere/run.json", "its folder does not exist; make the folder first"),
        (".", "is a directory; name a file in it"),
        ("/dev/null", "is not a regular file; name another"),
        ("./scene.yaml", "is the scene file itself; name another"),
        ("scene.yaml/run.json", "its folder does not exist; make the folder first"),
    ],
)
def test_an_out_that_cannot_be_written_is_refused_before_the_run(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch, out: str, reason: str
) -> None:
    monkeypatch.setattr(cagepose.runs.solve, "run", _never)
    assert command("run", sample, "--out", out) == (2, "", f"--out {out}: {reason}\n")


def test_an_out_that_fails_after_the_run_still_leaves_the_table(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    answer = command("run", sample, "--out", "run.json")
    assert answer.code == 2
    assert answer.err.endswith("--out run.json: No space left on device\n")
    assert answer.out.startswith("sample: rests")
    assert not Path("run.json").exists()


def _never(*_: object) -> None:
    raise AssertionError("nothing may run before all arguments are checked")


def test_problems_of_all_arguments_come_at_once(command: Command, in_folder: Path) -> None:
    assert in_folder.is_dir()
    answer = command("run", "nothing.yaml", "--method", "magic", "--out", "no/run.json")
    assert answer == (
        2,
        "",
        "nothing.yaml: does not exist; check the name and the folder\n"
        "--method magic: is no known method; use one of: stepwise, quasistatic\n"
        "--out no/run.json: its folder does not exist; make the folder first\n",
    )


def test_set_changes_the_scene_for_run_and_check(command: Command, sample: str) -> None:
    answer = command("run", sample, "--json", "--set", "object.pose.position[2]=8", "--set", "name=lower")
    document = json.loads(answer.out)
    assert document["scene"] == "lower"
    assert document["phases"][0]["events"][0]["distance"] == pytest.approx(3.0)
    assert command("check", sample, "--set", "name=lower").out.startswith("lower: ")
    assert command("check", sample, "--set", "object.mass=true") == (
        2,
        "",
        "--set object.mass=true: object.mass: is true; give a number\n",
    )


@pytest.mark.parametrize(
    ("scene", "method", "verdict", "code"),
    [
        ("pendulum", "stepwise", "spins", 1),
        ("wedge", "stepwise", "cycling", 1),
        ("wedge", "quasistatic", "may rest", 0),
        ("slope", "quasistatic", "rests", 0),
        ("slope", "stepwise", "stable by the paper's rules; by the mechanics it moves on from there", 0),
    ],
)
def test_failures_by_name_end_with_1_and_verdicts_with_0(
    command: Command, scene: str, method: str, verdict: str, code: int
) -> None:
    answer = command("run", str(SCENES / f"{scene}.yaml"), "--method", method)
    assert answer.code == code
    assert answer.out.startswith(f"{scene}: {verdict}  ({method}, ")
    assert (re.search("\n(proof|mechanics) ", answer.out) is not None) == (
        code == 0
    )  # nothing is held that could be proven


def test_a_run_that_failed_by_name_ends_with_1_and_is_still_printed_and_saved(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve = cagepose.runs.solve.run

    def spinning(scene: Scene, method: str | None = None) -> Run:
        result = solve(scene, method)
        return replace(result, phases=(replace(result.phases[0], verdict="spins"),))

    monkeypatch.setattr(cagepose.runs.solve, "run", spinning)
    answer = command("run", sample, "--out", "run.json")
    assert answer.code == 1
    assert answer.out.startswith("sample: spins")
    assert load_run("run.json").failed
    assert json.loads(command("run", sample, "--json").out)["verdict"] == "spins"


@pytest.mark.parametrize("method", METHODS)
def test_an_escape_is_a_verdict_and_has_no_proof_line(command: Command, sample: str, method: str) -> None:
    answer = command("run", sample, "--method", method, "--set", "loads[0].gravity=[0, 0, 1]")
    assert answer.code == 0
    assert answer.out.startswith("sample: escapes")
    assert "inf" not in answer.out
    below = summary(answer.out)
    angles = "yaw, pitch, roll"
    assert below.keys() == {"pose", "position", angles, "centre of gravity", "contacts", "verdict", "initial motion"}
    assert below["pose"].startswith("where no more contact is ahead")
    rule = "A-1" if method == "stepwise" else "escapes"
    (row,) = [line for line in answer.out.splitlines() if line.startswith("1 ")]
    assert row.split() == ["1", "gravity", rule, "travel", "(0,", "0,", "1)", "no", "contact", "ahead"]
    assert below["initial motion"] == "travel along (0, 0, 1)"


def test_the_default_method_shows_forces_and_proof(command: Command, sample: str) -> None:
    """The wedged cube: C1 and C4 each carry cos 45 deg of the load, since both faces are at 45 deg."""
    answer = command("run", sample)
    below = summary(answer.out)
    assert answer.out.startswith("sample: rests  (quasistatic, ")
    assert forces(answer.out) == [["C1", "box1", "0.7071"], ["C4", "box1", "0.7071"]]
    assert "contact  on    gravity [load]" in answer.out
    assert below["verdict"] == "gravity: rests (unstable)"
    assert re.fullmatch(
        r"rests: the contacts balance the load without friction \(residual \d\.\de-\d+\)", below["proof"]
    )
    assert "initial motion" not in below
    assert "critical friction" not in below
    assert answer.out.splitlines()[-1].startswith("warning: gravity: the equilibrium is unstable")


def test_forces_are_newtons_where_a_mass_is_given(command: Command, sample: str) -> None:
    """2 kg under 9.81 m/s2: each of the two faces at 45 deg carries 19.62 N cos 45 deg = 13.87 N."""
    out = command("run", sample, "--set", "object.mass=2", "--set", "loads[0].gravity=[0, 0, -9.81]").out
    assert forces(out) == [["C1", "box1", "13.87"], ["C4", "box1", "13.87"]]
    assert "contact  on    gravity [N]" in out


def test_sideways_forces_and_sharing_are_named(command: Command) -> None:
    """On the slope of 30 deg the contacts carry cos 30 deg in all across the slope, and sin 30 deg along it."""
    out = command("run", str(SCENES / "slope.yaml"), "--set", "friction.coefficient=0.58").out
    found = re.findall(r"  block  ([0-9.]+) \+ ([0-9.]+) friction$", out, re.MULTILINE)
    assert sum(float(normal) for normal, _ in found) == pytest.approx(0.8660, abs=2e-4)
    assert sum(float(across) for _, across in found) == pytest.approx(0.5, abs=2e-3)
    assert all(float(across) <= 0.58 * float(normal) + 1e-3 for normal, across in found)


def test_forces_of_all_phases_stand_beside_each_other(command: Command) -> None:
    out = command("run", str(SCENES / "rail-pitch.yaml")).out
    rows = {row[0]: row[2:] for row in forces(out)}
    assert rows["C2"] == ["0.0511"]
    assert rows["C13"] == ["0.00721", "1"]
    assert "C6" not in rows  # touches, and bears nothing
    assert "weight: statically indeterminate, one of many solutions is shown for C2 C4 C5 C7\n" in out
    assert "push: statically indeterminate, one of many solutions is shown for C1 C3 C6 C8\n" in out


def test_verbose_shows_what_touches_after_each_event_and_the_end_of_every_phase(command: Command) -> None:
    out = command("run", str(SCENES / "rail-pitch.yaml"), "--verbose").out
    events = [line for line in out.splitlines() if re.match(r" ?\d+  ", line)]
    assert events[2].endswith("  C13                          C2 C4 C5 C7 C13")
    assert ["C6", "right guide", "(91.5016, -31.55, 0.840301)", "0"] in forces(out)
    below = summary(out)
    assert below["position after weight"] == "(0.99981, 0, -0.00720843) mm"
    assert below["proof of weight"].startswith("rests: the contacts balance the load without friction")


def test_what_no_longer_touches_is_told(command: Command) -> None:
    events = command("run", str(SCENES / "rail-pitch.yaml")).out.split("\n\n")[1:3]
    rows = [re.split(r"\s{2,}", line.strip()) for line in "\n".join(events).splitlines()]
    assert ["2", "weight", "sliding", "turn", "(0, 1, 0)", "0.313084 deg", "C2 C4", "C1 C3"] in rows


def test_a_slight_turn_about_an_axis_far_off_is_told_as_the_travel_that_it_looks_like(command: Command) -> None:
    """The bar of the rollers slides sideways by 0.24 mm about an axis that is 434 mm away."""
    scene = str(SCENES / "rollers.yaml")
    row = next(line for line in command("run", scene).out.splitlines() if line.startswith("4  push"))
    assert row.split()[3:12] == ["travel", "(-0.0002749,", "1,", "0)", "0.238479", "mm,", "0.0314973", "deg", "left"]
    event = json.loads(command("run", scene, "--json").out)["phases"][1]["events"][0]
    assert event["motion"] == "turn"


def test_of_many_contacts_the_first_and_the_greatest_are_printed(command: Command, in_folder: Path) -> None:
    points = ", ".join(f"[{x}, {y}, 0]" for x in range(-4, 5) for y in range(-4, 5))
    (in_folder / "many.yaml").write_text(
        f"""name: many
object: {{boxes: [{{size: [10, 10, 10], position: [0, 0, 0]}}], pose: {{position: [0, 0, 6]}}}}
cage: {{points: [{points}]}}
loads: [{{name: weight, gravity: [0, 0, -1]}}]
friction: {{coefficient: 0.3}}
""",
        encoding="utf-8",
    )
    out = command("run", "many.yaml").out
    assert "C1 C2 C3 C4 C5 C6 C7 C8 C9 C10 C11 C12 and 69 more" in out
    assert len(forces(out)) <= 30
    every = command("run", "many.yaml", "--verbose").out
    assert "more" not in every
    assert len(forces(every)) == 81


def test_what_may_rest_names_the_other_onset(command: Command) -> None:
    out = command("run", str(SCENES / "wedge.yaml")).out
    assert out.startswith("wedge: may rest")
    below = summary(out)
    assert below["proof"].startswith("may rest: the contacts can balance the load with friction, but Coulomb's law")
    assert below["initial motion"] == "travel along (0, 0, -1)"
    assert "as in a wedge" in out.splitlines()[-1]


def test_an_onset_that_turns_by_rounding_only_is_a_travel(command: Command) -> None:
    """Between the critical 0.06175 and tan 5 deg / 1.414 = 0.0619 the bar may slide along its groove."""
    out = command("run", str(SCENES / "v-groove.yaml"), "--set", "friction.coefficient=0.0618").out
    assert summary(out)["initial motion"] == "travel along (0, 1, 0)"


def test_a_verdict_that_the_mechanics_contradicts_shows_its_proof_and_onset(command: Command, sample: str) -> None:
    below = summary(command("run", sample, "--method", "stepwise").out)
    assert below["mechanics"].startswith("moves: no contact forces balance the load (residual ")
    assert re.fullmatch(
        r"screw about \(.*\) through \(.*\) mm, [0-9.-]+ mm along it per radian", below["initial motion"]
    )


def test_a_saved_run_is_not_mistaken_for_a_scene(command: Command, sample: str) -> None:
    command("run", sample, "--out", "run.json")
    answer = command("run", "run.json")
    assert answer.code == 2
    assert "is a saved run, not a scene" in answer.err
    with pytest.raises(RunFileError, match="is not JSON"):
        load_run(sample)

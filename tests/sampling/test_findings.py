"""What the report says, against closed forms, SciPy, and counting by hand."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text
from SALib.sample import sobol as design
from scipy import stats
from scipy.stats import qmc

from cagepose import Study, StudyResults, load_scene, run
from cagepose.cli.app import main
from cagepose.files.progress import told_to
from cagepose.model.checks import FloatArray
from cagepose.sampling import contact_table, runner
from cagepose.sampling.figures import draw
from cagepose.sampling.findings import findings_of
from cagepose.sampling.outcome import Outcomes
from cagepose.sampling.runner import Runner
from cagepose.sampling.sensitivity import _indices, saltelli_rows
from cagepose.sampling.statistics import Spread, statistics_of
from cagepose.studies.likelihood import wilson
from our_studies import PEG, RunStudy

RISES = {"cage.pose.position[2]": {"uniform": [-0.1, 0.1]}}
HEIGHTS = {"cage.pose.position[2]": {"normal": {"sigma": 0.1}}, "object.pose.position[0]": {"uniform": [-0.05, 0.05]}}


def tolerance_of(numbers: dict[str, Any], name: str) -> dict[str, Any]:
    (row,) = (row for row in numbers["tolerances"] if row["name"] == name)
    return row  # type: ignore[no-any-return]


def test_the_tilt_of_a_rail_with_normal_gaps_has_the_distribution_of_the_closed_form(
    run_study: RunStudy, scene_with: Callable[..., Path]
) -> None:
    """Under its weight the plate, b thick, tilts between rollers a apart in pairs l apart until a cos t - l sin t = b,
    that is cos t - k sin t = c with k = l/a and c = b/a. The gap at a tilt is so (b + l sin t) / cos t, which grows
    with the tilt: of normal gaps the tilts have this distribution. The overhanging end sinks: a positive pitch.
    """
    rollers = [f"cage.points[{point}][2]=={'-' if point % 2 == 0 else ''}gap/2" for point in range(8)]
    level = ["cage.pose.euler_zyx_deg=[0, 0, 0]", "object.pose.euler_zyx_deg=[0, 0, 0]"]
    scene = scene_with("parameters={gap: 2}", *rollers, *level, "loads=[{name: weight, gravity: [0, 0, -1]}]")
    vary = {"parameters.gap": {"normal": {"sigma": 0.05}}}
    frame = run_study(vary, 3000, scene=scene, method="random", seed=11).to_frame()
    assert (frame["verdict"] == "rests").all()
    thick, apart = 1.0, 183.0

    def share_below(tilt_deg: np.ndarray) -> np.ndarray:
        tilt = np.radians(tilt_deg)
        return stats.norm.cdf((thick + apart * np.sin(tilt)) / np.cos(tilt), 2.0, 0.05)

    assert stats.kstest(frame["pitch_deg"], share_below).pvalue > 0.01
    gaps = frame["parameters.gap"].to_numpy()
    tilts = np.arctan2(gaps, apart) - np.arcsin(thick / np.hypot(gaps, apart))
    assert frame["pitch_deg"].to_numpy() == pytest.approx(np.degrees(tilts), abs=1e-6)
    quantiles = run_study(vary, 3000, scene=scene, folder="sobol").to_frame()["pitch_deg"].quantile([0.1, 0.5, 0.9])
    assert share_below(quantiles.to_numpy()) == pytest.approx([0.1, 0.5, 0.9], abs=2e-3)


def test_statistics_are_those_of_all_rows(run_study: RunStudy, peg: Path) -> None:
    results = run_study(HEIGHTS, 5000, scene=peg, accept="position.z < 0.55")
    found, frame = statistics_of(results), results.to_frame()
    spread, heights = found.spreads["position_z"], frame["position_z"]
    assert (found.n_runs, found.n_accepted) == (5000, int((heights < 0.55).sum()))
    assert dict(found.verdicts) == frame["verdict"].value_counts().to_dict()
    assert (spread.least, spread.greatest) == (heights.min(), heights.max())
    assert (spread.mean, spread.sigma) == pytest.approx((heights.mean(), heights.std(ddof=0)), rel=1e-12)
    for share in (0.01, 0.1, 0.5, 0.99):
        assert spread.quantile(share) == pytest.approx(heights.quantile(share), abs=1e-3)
    assert heights.quantile(0.0008) < spread.three_sigma[0] < heights.quantile(0.002)
    assert found.n_touching["touching_C1"] == int(frame["touching_C1"].sum())


@pytest.mark.usefixtures("small_designs")
def test_where_a_part_goes_that_does_not_come_to_rest_is_no_tolerance(run_study: RunStudy, peg: Path) -> None:
    """Beyond its points the cube tips over; how far it is then is in its row alone."""
    vary = {"object.pose.position[0]": {"uniform": [-0.1, 0.9]}, **RISES}
    results = run_study(vary, 200, scene=peg, sensitivities=True)
    frame, numbers = results.to_frame(), results.report()
    rests, others = frame[frame["verdict"] == "rests"], frame[frame["verdict"] == "escapes"]
    assert len(rests) > 50 < len(others)
    for row in numbers["tolerances"]:
        found, values = row["monte_carlo"], rests[row["name"]]
        assert (found["runs"], found["range"]) == (len(rests), [values.min(), values.max()])
    assert others["pitch_deg"].notna().all()
    assert abs(others["pitch_deg"]).min() > abs(rests["pitch_deg"]).max()
    missing = {one["name"]: one["missing"] for one in numbers["sensitivities"]}
    assert missing["accepted"] is None
    assert "too many runs of the design do not come to rest" in missing["position_x"]


def test_joined_spreads_are_those_of_all_at_once() -> None:
    rng = np.random.default_rng(1)
    values, spread = 1e6 + rng.normal(size=3000), Spread()
    for part in np.split(values, [1, 1, 500, 2999]):
        spread.add(part)
    assert (spread.n, spread.least, spread.greatest) == (3000, values.min(), values.max())
    assert spread.mean == pytest.approx(values.mean(), rel=1e-15)
    assert spread.sigma == pytest.approx(values.std(), rel=1e-9)


def test_the_interval_of_the_yield_is_wilsons() -> None:
    """Its ends are the likelihoods p of which the share is off by 1.96 standard deviations, sqrt(p (1 - p)/n) each."""
    for n_good, n_runs in ((0, 10), (3, 10), (10, 10), (499, 1000), (999_999, 1_000_000)):
        for end in wilson(n_good, n_runs):
            off = stats.norm.ppf(0.975) * math.sqrt(end * (1.0 - end) / n_runs)
            assert abs(n_good / n_runs - end) == pytest.approx(off, abs=1e-12)
    assert wilson(0, 0) == (0.0, 1.0)


def test_the_true_yield_lies_in_its_interval_for_about_95_of_100_seeds(tmp_path: Path, peg: Path) -> None:
    """The cube rests lower than 0.55 m with the likelihood of a normal variable below half a sigma."""
    true_yield, n_inside = stats.norm.cdf(0.5), 0
    for seed in range(100):
        study = Study(peg, HEIGHTS, {"method": "random", "runs": 400, "seed": seed}, accept="position.z < 0.55")
        found = statistics_of(study.run(tmp_path / f"seed-{seed}"))
        low, high = wilson(found.n_accepted, found.n_runs)
        n_inside += low <= true_yield <= high
    assert 90 <= n_inside <= 99


def test_a_linear_case_has_the_tolerances_and_indices_of_theory(run_study: RunStudy, peg: Path) -> None:
    """The height is half an edge more than the sum of two numbers with sigmas of 0.1 and 0.2: indices of 1/5 and 4/5,
    worst cases of three sigmas each, and their root sum square.
    """
    text = PEG.replace(
        "position: [0, 0, 0]}\nloads", 'position: [0, 0, "=a + b"]}\nparameters: {a: 0.0, b: 0.0}\nloads'
    )
    peg.write_text(text, encoding="utf-8")
    vary = {"parameters.a": {"normal": {"sigma": 0.1, "cut": 3}}, "parameters.b": {"normal": {"sigma": 0.2, "cut": 3}}}
    numbers = run_study(vary, 20_000, scene=peg, sensitivities=True).report()
    row = tolerance_of(numbers, "position_z")
    assert row["nominal"] == pytest.approx(0.5)
    assert list(row["derivatives"].values()) == pytest.approx([1.0, 1.0], abs=1e-9)
    assert row["worst_case"] == pytest.approx([0.5 - 0.9, 0.5 + 0.9])
    assert row["root_sum_square"] == pytest.approx([0.5 - 0.3 * math.sqrt(5.0), 0.5 + 0.3 * math.sqrt(5.0)])
    assert row["monte_carlo"]["three_sigma"] == pytest.approx(row["root_sum_square"], abs=0.05)
    assert row["stays_within_worst_case"]
    (found,) = (one for one in numbers["sensitivities"] if one["name"] == "position_z")
    for index, expected in zip(found["indices"], (0.2, 0.8), strict=True):
        assert index["first"] == pytest.approx(expected, abs=0.02)
        assert index["total"] == pytest.approx(expected, abs=0.02)
        assert abs(index["first"] - expected) < index["first_interval"]
    assert next(one for one in numbers["sensitivities"] if one["name"] == "position_x")["missing"] is not None


@pytest.mark.usefixtures("small_designs")
def test_no_row_leaves_a_worst_case_that_is_not_known(run_study: RunStudy, peg: Path, tmp_path: Path) -> None:
    """The cube starts on its points: a step upwards of these would be into it."""
    peg.write_text(PEG.replace("0.02, 3]", "0.02, 0.5]"), encoding="utf-8")
    vary = {"cage.pose.position[2]": {"uniform": [-0.2, 0.1]}}
    numbers = run_study(vary, 20, scene=peg).report()
    row = tolerance_of(numbers, "position_z")
    assert (row["nominal"], row["worst_case"], row["stays_within_worst_case"]) == (0.5, [None, None], None)
    assert row["monte_carlo"]["runs"] == numbers["verdicts"]["rests"]["runs"] < 20
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert 'class="leaves"' not in page
    assert "- to -" not in page


@pytest.mark.usefixtures("small_designs", "no_pictures")
def test_no_step_leaves_the_range_of_a_number(run_study: RunStudy, peg: Path) -> None:
    """A nominal friction of 0, and a cage that can only be lower: on the other side no scene is."""
    peg.write_text(PEG.replace("0.02, 3]", "0.02, 0.5]") + "friction: {coefficient: 0}\n", encoding="utf-8")
    vary = {"friction.coefficient": {"uniform": [0, 0.3]}, "cage.pose.position[2]": {"uniform": [-0.2, 0]}}
    row = tolerance_of(run_study(vary, 20, scene=peg).report(), "position_z")
    assert row["derivatives"] == pytest.approx({"friction.coefficient": 0.0, "cage.pose.position[2]": 1.0}, abs=1e-9)
    assert row["worst_case"] == pytest.approx([0.3, 0.5])


@pytest.mark.usefixtures("small_designs")
def test_a_jump_has_no_derivative(run_study: RunStudy, peg: Path) -> None:
    """The cube stands 0.1 m high on either side of a step in its scene's expression."""
    peg.write_text(
        PEG.replace("position: [0, 0, 0]}\nloads", 'position: [0, 0, "=(a/abs(a))/10"]}\nparameters: {a: 1e-9}\nloads'),
        encoding="utf-8",
    )
    vary = {"parameters.a": {"uniform": [-1, 1]}}
    numbers = run_study(vary, 64, scene=peg).report()
    row = tolerance_of(numbers, "position_z")
    assert (row["nominal"], row["derivatives"], row["worst_case"]) == (0.6, {"parameters.a": None}, [None, None])
    assert tolerance_of(numbers, "position_x")["worst_case"] == [0.0, 0.0]


@pytest.mark.usefixtures("small_designs", "no_pictures")
def test_rounding_is_no_way_out_of_the_worst_case(
    run_study: RunStudy, peg: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The cube starts tilted and settles on its face, to the last digits."""
    peg.write_text(PEG.replace("0.02, 3]", "0.02, 3], euler_zyx_deg: [0, 0, 0]"), encoding="utf-8")
    vary = {"object.pose.euler_zyx_deg[1]": {"uniform": [-3, 3]}, **RISES}
    numbers = run_study(vary, 64, scene=peg).report()
    row = tolerance_of(numbers, "pitch_deg")
    least, greatest = row["monte_carlo"]["range"]
    assert 0.0 < greatest - least < row["resolution"]
    assert row["stays_within_worst_case"]
    assert main(["study", "show", str(tmp_path / "out")]) == 0
    assert "e-1" not in capsys.readouterr().out
    assert not re.findall(r"<td>[^<]*e-1", (tmp_path / "out" / "report.html").read_text(encoding="utf-8"))


@pytest.mark.usefixtures("small_designs", "no_pictures")
def test_good_runs_that_do_not_rest_are_told(
    run_study: RunStudy, peg: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Beyond its points the cube tips over, and where it is then may be where it should be."""
    vary = {"object.pose.position[0]": {"uniform": [-0.1, 0.9]}, **RISES}
    numbers = run_study(vary, 64, scene=peg, accept="abs(position.y) < 100").report()
    escaped = numbers["verdicts"]["escapes"]["runs"]
    assert numbers["good_but_not_at_rest"] == escaped > 10
    told = f"{escaped} of the good runs do not come to rest; write"
    assert told in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert main(["study", "show", str(tmp_path / "out")]) == 0
    assert f"{escaped} good runs do not come to rest; write verdict == 'rests'" in capsys.readouterr().out


@pytest.mark.usefixtures("small_designs", "no_pictures")
def test_a_failed_run_is_never_good_and_is_told(
    run_study: RunStudy, peg: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its pose is where it stopped: that it lies where it should is no answer."""
    ends = Runner.run

    def one_fails(runner: Runner, values: FloatArray, **how: bool) -> Outcomes:
        outcomes = ends(runner, values, **how)
        outcomes.phase_verdicts[7:8, 0] = "limit"
        return outcomes

    monkeypatch.setattr(Runner, "run", one_fails)
    results = run_study(RISES, 64, scene=peg, accept="position.z < 100")
    frame, numbers = results.to_frame(), results.report()
    assert frame["verdict"].tolist() == ["rests"] * 7 + ["limit"] + ["rests"] * 56
    assert frame["accepted"].tolist() == [verdict == "rests" for verdict in frame["verdict"]]
    assert (numbers["yield"]["runs"], numbers["verdicts"]["limit"]["runs"]) == (63, 1)
    assert numbers["failed"] == {"limit": 1}
    assert numbers["contacts"]["forces_of_runs"] <= 63
    assert tolerance_of(numbers, "position_z")["monte_carlo"]["runs"] == 63
    assert numbers["chosen_runs"][0]["run"] == 7
    assert "1 run failed (<code>limit</code>)" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert main(["study", "show", str(tmp_path / "out")]) == 0
    assert "1 failed (limit): they have no result and count as not good" in capsys.readouterr().out


def test_the_design_of_the_indices_is_that_of_salib() -> None:
    problem = {"num_vars": 5, "names": list("abcde"), "bounds": [[0.0, 1.0]] * 5}
    base = qmc.Sobol(10, scramble=False).random(64)
    expected = design.sample(problem, 64, calc_second_order=False, scramble=False)
    assert np.array_equal(saltelli_rows(base), expected)
    assert np.array_equal(np.concatenate([saltelli_rows(base[:7]), saltelli_rows(base[7:])]), expected)


def test_blocks_of_a_design_in_which_a_run_has_no_pose_are_left_out() -> None:
    problem = {"num_vars": 1, "names": ["a"], "bounds": [[0.0, 1.0]]}
    rng = np.random.default_rng(2)
    measured = rng.normal(size=300)
    without = measured.reshape(-1, 3)[1:].ravel().copy()
    measured[1] = np.nan
    found, expected = _indices("q", measured, problem, 1, 0.0), _indices("q", without, problem, 1, 0.0)
    assert (found.n_runs, found.first.tolist()) == (297, expected.first.tolist())
    measured[:200] = np.nan
    assert "too many" in (_indices("q", measured, problem, 1, 0.0).missing or "")


@pytest.mark.parametrize("odd", [0, 1])
def test_what_is_nearly_always_the_same_has_no_indices_of_zero(odd: int) -> None:
    """One run of 300 differs. If it is none of those that the variance is taken of, SALib warns and says zero."""
    problem = {"num_vars": 1, "names": ["a"], "bounds": [[0.0, 1.0]]}
    measured = np.zeros(300)
    measured[odd] = 1.0
    found = _indices("q", measured, problem, 1, 0.0)
    if odd == 0:
        assert (found.missing, found.total.tolist()) == (None, pytest.approx([1.0], abs=0.01))
    else:
        assert found.missing == "is the same in all of them, or in nearly all"


@pytest.mark.usefixtures("small_designs")
def test_a_report_of_one_number_and_one_quantity_has_room_for_its_pictures(
    run_study: RunStudy, peg: Path, tmp_path: Path
) -> None:
    """Or matplotlib warns, which is an error here."""
    asked = {"sensitivities": True, "watch": {"top": {"point": [0, 0, 0.5]}}}
    run_study({"cage.pose.position[2]": {"uniform": [-0.1, 0.1]}}, 20, scene=peg, **asked).report()
    figures = {"sobol", "tornado", "spread"}
    for suffix, pictures in (("svg", figures), ("png", {*figures, "mechanism"})):
        assert {path.stem for path in tmp_path.glob(f"out/*.{suffix}")} == pictures


@pytest.mark.usefixtures("small_designs")
def test_what_the_report_is_at_is_told(run_study: RunStudy, peg: Path) -> None:
    told = list[str]()
    with told_to(told.append):
        findings_of(run_study(HEIGHTS, 20, scene=peg, map={"over": list(HEIGHTS), "count": 8}))
    assert [line for line in told if "capture map" in line]
    assert told[-1] == ""


@pytest.mark.usefixtures("small_designs")
def test_axes_have_the_units_of_the_scene_file(run_study: RunStudy, peg: Path) -> None:
    peg.write_text(PEG.replace("length: m", "length: in"), encoding="utf-8")
    vary = {"cage.pose.position[2]": {"uniform": [-0.1, 0.1]}, "friction.coefficient": {"uniform": [0, 0.1]}}
    asked = {"watch": {"top": {"point": [0, 0, 0.5]}}, "map": {"over": list(vary), "count": 8}}
    figures = draw(findings_of(run_study(vary, 20, scene=peg, **asked)))
    (of_map,) = figures["map"].axes
    assert {of_map.get_xlabel(), of_map.get_ylabel()} == {"cage.pose.position[2] [in]", "friction.coefficient"}
    assert figures["spread"].axes[0].get_xlabel() == "[in]"
    assert figures["tornado"].axes[0].get_xlabel() == "change to either end [in]"
    assert figures["ends"].axes[-1].get_xlabel() == "[in]"


@pytest.mark.usefixtures("small_designs")
def test_long_names_stay_within_their_pictures(run_study: RunStudy, peg: Path) -> None:
    peg.write_text(PEG.replace("0.02, 3]", "0.02, 3], euler_zyx_deg: [0, 0, 0]"), encoding="utf-8")
    watch = {"top_of_the_block_at_its_far_and_front_end": {"point": [0.3, 0, 0.5]}}
    vary = {**HEIGHTS, "object.pose.euler_zyx_deg[0]": {"uniform": [-3, 3]}}
    figures = draw(findings_of(run_study(vary, 20, scene=peg, watch=watch, sensitivities=True)))
    for name in ("sobol", "tornado"):
        FigureCanvasAgg(figures[name]).draw()
        edges = figures[name].bbox
        texts = [text for text in figures[name].findobj(Text) if text.get_text().startswith(tuple(watch))]
        assert len(texts) > 1
        for extent in (text.get_window_extent() for text in texts):
            assert edges.x0 <= extent.x0 < extent.x1 <= edges.x1


@pytest.mark.usefixtures("small_designs", "no_pictures")
def test_chosen_runs_are_scenes_that_run_as_their_rows_do(run_study: RunStudy, tmp_path: Path) -> None:
    vary = {"cage.points.*[2]": {"normal": {"sigma": 0.02}}, "friction.coefficient": {"uniform": [0, 0.2]}}
    results = run_study(vary, 300, accept="verdict == 'rests' and abs(pitch_deg) < 0.215")
    numbers = results.report()
    rows = {row["run"]: row for row in results.table().to_pylist()}
    assert [one["name"] for one in numbers["chosen_runs"]] == ["worst 1", "worst 2", "worst 3", "typical"]
    assert [one["accepted"] for one in numbers["chosen_runs"]] == [False, False, False, True]
    for one in numbers["chosen_runs"]:
        row, ended = rows[one["run"]], run(load_scene(tmp_path / "out" / one["file"]))
        assert (ended.verdict, row["verdict"]) == (one["verdict"], one["verdict"])
        assert math.degrees(ended.pose.euler_zyx[1]) == row["pitch_deg"]
        assert one["values"] == {key: row[key] for key in results.columns.varied}


@pytest.mark.usefixtures("small_designs", "no_pictures")
def test_contacts_say_how_often_and_how_much(run_study: RunStudy) -> None:
    vary = {f"cage.pose.euler_zyx_deg[{axis}]": {"uniform": [-0.1, 0.1]} for axis in range(3)}
    with_forces = run_study(vary, 120, forces=True)
    frame = with_forces.to_frame()
    found = {row["name"]: row for row in with_forces.report()["contacts"]["rows"]}
    asked_again = run_study(vary, 120, folder="again").report()["contacts"]
    assert asked_again["forces_of_runs"] == 120
    assert {row["name"]: row for row in asked_again["rows"]} == found
    for name, row in found.items():
        forces = frame[f"force_{name}"]
        assert row["touches"] == pytest.approx(frame[f"touching_{name}"].mean())
        if (forces > 0.0).any():
            assert row["mean_force"] == pytest.approx(forces[forces > 0.0].mean())
            assert row["greatest_force"] == forces.max()


@pytest.mark.usefixtures("small_designs", "no_pictures")
def test_forces_are_those_of_the_first_rows_at_rest_in_whichever_part(
    run_study: RunStudy, peg: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "ROWS_OF_A_BATCH", 8)
    results = run_study({"object.pose.position[0]": {"uniform": [-0.1, 0.9]}, **RISES}, 64, scene=peg)
    n_at_rest = int((results.to_frame()["verdict"] == "rests").sum())
    assert results.report()["contacts"]["forces_of_runs"] == n_at_rest > 8
    monkeypatch.setattr(contact_table, "MOST_RUNS", 9)
    assert results.report()["contacts"]["forces_of_runs"] == 9


@pytest.mark.usefixtures("small_designs")
@pytest.mark.parametrize(("away", "verdict"), [("position[0]", "escapes"), ("position[2]", "refused")])
def test_where_no_row_rests_there_is_a_report_all_the_same(
    run_study: RunStudy, peg: Path, tmp_path: Path, away: str, verdict: str
) -> None:
    """The cube falls beside its points, or starts on them; each scene is built, by two processes."""
    start = {"position[0]": [2, 3], "position[2]": [0.1, 0.2]}[away]
    results = run_study(
        {"object.mass": {"uniform": [1, 2]}, f"object.pose.{away}": {"uniform": start}}, 6, scene=peg, workers=2
    )
    numbers = results.report(workers=2)
    assert {name: one["runs"] for name, one in numbers["verdicts"].items()} == {verdict: 6}
    assert numbers["contacts"]["forces_of_runs"] == numbers["yield"]["runs"] == 0
    assert "of the runs are good" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


@pytest.mark.usefixtures("small_designs", "no_pictures")
@pytest.mark.parametrize("name", ["force_C1", "force.C1"])
def test_a_run_may_be_judged_by_its_forces(run_study: RunStudy, name: str) -> None:
    """In the rows, and in the runs beside them."""
    vary = {"cage.pose.euler_zyx_deg[1]": {"uniform": [-0.1, 0.1]}, "cage.points[0][2]": {"uniform": [-1.1, -0.9]}}
    asked = {"over": list(vary), "count": 8}
    results = run_study(vary, 100, forces=True, map=asked, accept=f"{name} > 0.05")
    frame, numbers = results.to_frame(), results.report()
    assert frame["accepted"].tolist() == (frame["force_C1"] > 0.05).tolist()
    assert 0.0 < numbers["yield"]["share"] < 1.0
    assert 0 < sum(map(sum, numbers["maps"][0]["accepted_cells"])) < 64


@pytest.mark.usefixtures("no_pictures")
def test_a_report_without_a_map_and_indices_makes_no_runs_for_them(
    run_study: RunStudy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    n_rows, run_rows = list[int](), Runner.run

    def counted(self: Runner, rows: Any, **more: Any) -> Any:
        n_rows.append(len(rows))
        return run_rows(self, rows, **more)

    monkeypatch.setattr(Runner, "run", counted)
    vary = {"cage.pose.euler_zyx_deg[1]": {"uniform": [-0.4, 0.4]}, "friction.coefficient": {"grid": [0.0, 0.1]}}
    numbers = run_study(vary, 20).report()
    assert numbers["maps"] == numbers["sensitivities"] == []
    assert sum(n_rows) < 100
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "Sobol" not in page
    assert "Capture map" not in page


@pytest.mark.usefixtures("small_designs")
def test_the_page_stands_alone_and_holds_the_numbers(run_study: RunStudy, tmp_path: Path) -> None:
    vary = {"cage.pose.euler_zyx_deg[1]": {"uniform": [-0.4, 0.4]}, "friction.coefficient": {"grid": [0.0, 0.1]}}
    asked = {"sensitivities": True, "map": {"over": list(vary), "count": 8}, "watch": {"tip": {"point": [600, 0, 0]}}}
    results = run_study(vary, 200, accept="pitch_deg < 0.1 and 'x' != '<b>'", **asked)
    numbers = results.report()
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert not re.findall(r'(?:src|href)="(?!#|data:|worst|typical)', page)
    assert re.findall("<script[^>]*>", page) == ['<script type="application/json" id="packed">', "<script>"]
    assert "&lt;b&gt;" in page
    assert page.count("<svg") == 5
    reasons = {one["missing"] for one in numbers["sensitivities"]} - {None}
    assert page.count("No indices of") == len(reasons) > 0
    for text in ("Yield", "Tolerances", "Sensitivities", "Capture map", "Contacts", "worst-1.yaml", "tip_z"):
        assert text in page
    assert json.loads((tmp_path / "out" / "report.json").read_text(encoding="utf-8")) == numbers
    assert StudyResults(tmp_path / "out").study.model.accept is not None

"""The loosest value that keeps a wish, against closed forms and trying all; and what its command says and refuses."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

from cagepose import Design, DesignResults, SceneFileError, load_scene, run
from cagepose.cli.app import main
from cagepose.sampling.design import TradeOffPoint
from cagepose.sampling.trade_off import captured_range, trade_off

SCENE = """\
name: peg
units: {length: m}
parameters: {a: 0.0, b: 0.0}
object:
  boxes: [{size: [1, 1, 1], position: [0, 0, 0]}]
  pose: {position: [0.0, 0.02, 3]}
cage:
  points: [[0.4, 0.4, 0], [0.4, -0.4, 0], [-0.4, -0.4, 0], [-0.4, 0.4, 0]]
  pose: {position: [0, 0, "=a + b"]}
loads: [{name: weight, gravity: [0, 0, -1]}]
"""
"""A cube that falls onto four points: its height is a + b + 1/2."""
DESIGN = """\
scene: scene.yaml
change: {parameters.a: [-0.5, 0.5]}
wish: {yield: 0.9}
vary:
  parameters.b: {normal: {sigma: 0.1}}
sample: {runs: 512}
accept: position.z < 0.7
"""
NORMAL, SHIFT = {"parameters.b": {"normal": {"sigma": 0.1}}}, {"parameters.b": {"uniform": [-0.5, 0.5]}}
TENTH = float(stats.norm.ppf(0.9)) * 0.1
"""So far from its mean, 0.1 of b lies above."""


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("scene.yaml").write_text(SCENE, encoding="utf-8")
    Path("design.yaml").write_text(DESIGN, encoding="utf-8")
    return tmp_path / "scene.yaml"


def found(scene: Path, change: list[float], accept: str, wish: Any = None, **sample: Any) -> DesignResults:
    return Design(
        scene, {"parameters.a": change}, wish or {"yield": 0.9}, NORMAL, {"runs": 4096, **sample}, accept=accept
    ).run()


@pytest.mark.parametrize("method", ["sobol", "random"])
def test_the_loosest_shift_of_a_normal_height_is_its_quantile(scene: Path, method: str) -> None:
    results = found(scene, [-0.5, 0.5], "position.z < 0.7", method=method)
    expected, (surely, perhaps) = 0.2 - TENTH, results.trade_off.between
    assert results.loosest == pytest.approx(expected, abs=1e-3 + (0.0 if method == "sobol" else 5e-3))
    assert surely is not None
    assert perhaps is not None
    assert surely < expected < perhaps
    assert surely < results.loosest < perhaps
    assert results.trade_off.is_monotone
    assert results.trade_off.accuracy == pytest.approx(1.0 / 1024.0)
    for point in results.trade_off.points:
        assert point.reached == pytest.approx(stats.norm.cdf((0.2 - point.value) / 0.1), abs=0.02)
    assert results.n_runs == 4096 * len(results.trade_off.points)


def test_the_loose_end_may_be_the_lower_one(scene: Path) -> None:
    results = found(scene, [0.5, -0.5], "position.z > 0.3")
    assert results.loosest == pytest.approx(-0.2 + TENTH, abs=2e-3)
    values = [point.value for point in results.trade_off.points]
    assert values == sorted(values, reverse=True)


def test_a_wish_that_is_kept_everywhere_or_nowhere_is_said_so(scene: Path) -> None:
    everywhere = found(scene, [-0.5, 0.5], "position.z < 9", runs=64)
    assert everywhere.loosest == 0.5
    assert "parameters.a = 0.5, the loose end, still meets yield >= 90.00 %; looser values were not" in str(everywhere)
    nowhere = found(scene, [-0.5, 0.5], "position.z < -9", runs=64)
    assert nowhere.loosest is None
    assert "no parameters.a from -0.5 to 0.5 meets yield >= 90.00 %: at best 0 %, at -0.5" in str(nowhere)
    few = found(scene, [-0.5, 0.5], "position.z < 9", {"yield": 0.99}, runs=64)
    assert few.trade_off.between == (None, 0.5)
    assert "no value does with 95 % confidence in 64 runs: set more runs" in few.sentence()


def test_a_wish_that_tighter_values_do_not_keep_is_said_so(scene: Path) -> None:
    results = found(scene, [-0.5, 0.5], "abs(position.z - 0.5) < 0.2")
    ((tight, loose),) = results.trade_off.kept
    assert (tight, loose) == pytest.approx((-0.2 + TENTH, 0.2 - TENTH), abs=3e-3)
    assert (results.loosest, results.trade_off.is_monotone) == (loose, False)
    assert f"; not all tighter values do: only {tight:.5g} to {loose:.5g}" in results.sentence()


def test_the_capture_range_about_the_nominal_value_is_that_of_the_closed_form(scene: Path) -> None:
    """All heights below 0.7 are good: the range of b ends at 0.2 - a."""
    design = Design(
        scene, {"parameters.a": [-0.1, 0.5]}, {"capture": {"parameters.b": 0.6}}, SHIFT, accept="position.z < 0.7"
    )
    results = design.run()
    assert results.loosest == pytest.approx(0.1, abs=1e-3)
    for point in results.trade_off.points:
        if point.value == pytest.approx(0.2, abs=1e-9):
            continue  # a tie
        expected = 0.7 - point.value if point.value < 0.2 else 0.0  # the nominal run itself is not good
        assert point.low == point.reached == point.high == pytest.approx(expected, abs=2e-4)
    assert "confidence" not in results.sentence()


@pytest.mark.parametrize("windows", [[(0.0, 0.3)], [(0.3, 1.0)], [(0.11, 0.24), (0.4, 0.83)], [(0.0, 1.0)], []])
def test_the_search_finds_all_windows_and_asks_each_value_once(windows: list[tuple[float, float]]) -> None:
    asked: list[float] = []

    def measure(value: float) -> TradeOffPoint:
        asked.append(value)
        reached = float(any(low <= value <= high for low, high in windows))
        return TradeOffPoint(value, reached, reached, reached)

    trade = trade_off(measure, 0.0, 1.0, 0.5)
    assert len(asked) == len(set(asked)) == len(trade.points)
    assert len(trade.kept) == len(windows)
    for kept, (low, high) in zip(trade.kept, windows, strict=True):
        assert low <= kept[0] <= low + trade.accuracy
        assert high - trade.accuracy <= kept[1] <= high
    assert trade.loosest == (trade.kept[-1][1] if windows else None)
    assert trade.is_monotone == (not windows or (len(windows) == 1 and windows[0][0] == 0.0))


def test_the_captured_range_ends_where_the_first_bad_run_is() -> None:
    rng = np.random.default_rng(4)
    for _ in range(50):
        low, bad_below, bad_above, high = np.sort(rng.uniform(-1.0, 1.0, 4))
        nominal = rng.uniform(bad_below, bad_above)

        def good(values: np.ndarray, below: float = bad_below, above: float = bad_above) -> np.ndarray:
            return (values > below) & (values < above)

        width = captured_range(good, nominal, low, high)
        assert bad_above - bad_below - 2.0 * (high - low) / 64**2 <= width <= bad_above - bad_below
        assert captured_range(good, float(high), low, high + 1.0) == 0.0
        assert captured_range(lambda values: values == values, nominal, low, high) == high - low


@pytest.mark.usefixtures("scene")
def test_the_command_prints_and_writes_what_python_finds(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "design.yaml", "--out", "out"]) == 0
    captured, results = capsys.readouterr(), Design.load("design.yaml").run()
    assert captured.out.splitlines()[0] == "peg: yield >= 90.00 %"
    assert results.sentence() in captured.out
    assert captured.err.startswith(f"cagepose: {len(results.trade_off.points)} values, {results.n_runs:,} runs in ")
    numbers = json.loads(Path("out/design.json").read_text(encoding="utf-8"))
    assert {key: value for key, value in numbers.items() if key != "about"} == results.document()
    assert load_scene("out/loosest.yaml").cage.pose_world_cage.position_m[2] == results.loosest
    assert run(load_scene("out/loosest.yaml")).pose.position_m[2] == pytest.approx(results.loosest + 0.5)
    assert Path("out/design.png").read_bytes()[:4] == b"\x89PNG"
    assert b"target: yield" in Path("out/design.svg").read_bytes()
    assert main(["design", "design.yaml", "--out", "out", "--json"]) == 0  # over its own files
    assert json.loads(capsys.readouterr().out) == results.document()
    Path("out/design.svg").write_text("mine", encoding="utf-8")
    assert main(["design", "design.yaml", "--out", "out"]) == 2
    captured = capsys.readouterr()
    assert "holds something else than what cagepose design wrote" in captured.err
    assert results.sentence() in captured.out  # what was found is not lost
    assert main(["design", "design.yaml", "--workers", "0"]) == 2
    assert "--workers is 0; give 1 or more" in capsys.readouterr().err


CHANGE, WISH = "{parameters.a: [-0.5, 0.5]}", "{yield: 0.9}"
EDITS: list[tuple[str, str, str]] = [
    (f"change: {CHANGE}\n", "", "1:1: change: is missing; add it, for example change: {parameters.play: [0.1, 2.0]}"),
    (CHANGE, "{parameters.a: [1, 1]}", "2:24: change.parameters.a: is [1.0, 1.0]; give two different numbers"),
    (CHANGE, "{parameters.a: 1}", "2:24: change.parameters.a: is 1; give a list in brackets"),
    (CHANGE, "{parameters.a: [0, 1], parameters.b: [0, 1]}", "2:9: change: has 2 values; give 1"),
    (CHANGE, "{parameters.c: [0, 1]}", "2:10: change.parameters.c: is no parameter of the scene; use one of: a, b"),
    (CHANGE, "{parameters.b: [0, 1]}", "2:10: change.parameters.b: varies, too; keep one of the two"),
    (CHANGE, "{'cage.points.*[2]': [0, 1]}", "2:10: change.cage.points.*[2]: has a *; make what changes together"),
    (CHANGE, "{'cage.pose.position[2]': [0, 1]}", "2:10: change.cage.pose.position[2]: holds the expression '=a + b'"),
    (WISH, "{}", "3:7: wish: says nothing; give one of: yield, capture"),
    (WISH, "{yield: 99.7}", "3:15: wish.yield: is 99.7; give a number up to 1"),
    (WISH, "{yield: 0.9, capture: {parameters.b: 1}}", "3:7: wish: has both yield and capture; give one of"),
    (WISH, "{cost: 0.9}", "3:8: wish.cost: is no known key; remove it; known keys: yield, capture"),
    (WISH, "{capture: {parameters.a: 1}}", "3:18: wish.capture.parameters.a: does not vary; use one of: parameters.b"),
    (WISH, "{capture: {parameters.b: 1}}", "3:32: wish.capture.parameters.b: is 1, and it varies from -0.3 to 0.3"),
    (f"{WISH}\nvary:\n  parameters.b: {{normal: {{sigma: 0.1}}}}",
     "{capture: {parameters.b: 0.1}}\nvary: {parameters.b: {uniform: [1, 2]}}",
     "3:32: wish.capture.parameters.b: varies from 1 to 2, without its nominal value 0; let it vary about that"),
    ("sample: {runs: 512}\n", "", "1:1: has no sample, which a yield needs; add, for example, sample: {runs: 4096}"),
    ("accept:", "forces: true\naccept:", "7:1: forces: is no known key"),
    ("position.z", "height", "7:9: accept: has the unknown name height"),
]  # fmt: skip


@pytest.mark.usefixtures("scene")
@pytest.mark.parametrize(("old", "new", "line"), EDITS, ids=[line for *_, line in EDITS])
def test_a_broken_design_is_refused_in_place(capsys: pytest.CaptureFixture[str], old: str, new: str, line: str) -> None:
    assert old in DESIGN
    Path("design.yaml").write_text(DESIGN.replace(old, new, 1), encoding="utf-8")
    assert main(["design", "design.yaml", "--out", "out"]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert any(told.startswith(f"design.yaml:{line}") for told in lines), lines
    assert not Path("out").exists()


def test_a_grid_of_samples_leaves_out_what_is_chosen(scene: Path) -> None:
    make: Callable[..., Design] = Design
    vary = {"parameters.b": {"grid": [-0.1, 0.0, 0.1]}}
    results = make(scene, {"parameters.a": [-0.5, 0.5]}, {"yield": 0.6}, vary, {"method": "grid"},
                   accept="position.z < 0.7").run()  # fmt: skip
    assert {round(3 * point.reached) for point in results.trade_off.points} == {0, 1, 2, 3}
    assert results.loosest == pytest.approx(0.2, abs=1e-3)
    assert results.sentence().endswith("no value does with 95 % confidence in 3 runs: set more runs")
    with pytest.raises(SceneFileError, match=r"design: sample: is a Latin hypercube|design:.*sample: is a Latin"):
        make(scene, {"parameters.a": [0, 1]}, {"yield": 0.6}, NORMAL, {"method": "latin hypercube", "runs": 2**30})

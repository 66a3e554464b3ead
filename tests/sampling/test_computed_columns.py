"""Columns that are computed of others: in the table, in the report, and in what is accepted."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cagepose.files.expression import Expression, Formula
from cagepose.sampling.findings import findings_of
from our_studies import RAIL, RunStudy

CLUTCH = RAIL.parent / "studies" / "clutch.yaml"
DIMENSIONS: dict[str, Any] = {
    "parameters.hub": {"normal": {"sigma": 0.0793}},
    "parameters.roller": {"normal": {"sigma": 0.0043}},
    "parameters.ring": {"normal": {"sigma": 0.0793}},
}
ANGLE = {"phi": "degrees(atan2(position_x, position_y))"}


def test_the_angle_of_a_clutch_is_that_of_its_closed_form_in_every_row(run_study: RunStudy) -> None:
    """The centre of the roller is ring/2 - roller/2 from that of the ring, and hub/2 + roller/2 above it."""
    results = run_study(DIMENSIONS, 32, scene=CLUTCH, compute=ANGLE)
    for row in results.table().to_pylist():
        hub, roller, ring = (row[key] for key in DIMENSIONS)
        assert row["phi"] == pytest.approx(math.degrees(math.acos((hub + roller) / (ring - roller))), abs=1e-5)
    assert "phi" in results.columns.quantities


def test_what_is_computed_can_be_accepted_and_computed_with(run_study: RunStudy) -> None:
    compute = {**ANGLE, "beyond": "phi - 7", "twice": "2 * beyond"}
    rows = run_study(DIMENSIONS, 32, scene=CLUTCH, compute=compute, accept="beyond > 0").table().to_pylist()
    assert [row["accepted"] for row in rows] == [row["phi"] - 7 > 0 for row in rows]
    assert len({row["accepted"] for row in rows}) == 2
    assert [row["twice"] for row in rows] == [2 * (row["phi"] - 7) for row in rows]


def test_forces_are_computed_with_where_they_are_asked_for(run_study: RunStudy) -> None:
    compute = {"share": "force_hub / force_ring"}
    rows = run_study(DIMENSIONS, 4, scene=CLUTCH, compute=compute, forces=True).table().to_pylist()
    for row in rows:  # the one force balances the other across the push: N cos phi = H
        assert row["share"] == pytest.approx(
            row["position_y"] / math.hypot(row["position_x"], row["position_y"]), rel=1e-6
        )


def test_a_row_without_an_answer_has_nothing_computed(run_study: RunStudy) -> None:
    varied = {"friction.coefficient": {"grid": [-0.1, 0.1]}}
    refused, found = run_study(varied, method="grid", compute={"angle": "1 + pitch_deg"}).table().to_pylist()
    assert (refused["verdict"], refused["angle"]) == ("refused", None)
    assert found["angle"] == 1 + found["pitch_deg"]


@pytest.mark.usefixtures("no_pictures", "small_designs")
def test_the_tolerance_table_knows_what_is_computed(run_study: RunStudy) -> None:
    findings = findings_of(run_study(DIMENSIONS, 64, scene=CLUTCH, compute=ANGLE))
    (row,) = (row for row in findings.tolerances if row.name == "phi")
    assert row.nominal == pytest.approx(7.0184, abs=1e-4)
    sine, across = math.sin(math.radians(row.nominal)), 101.6 - 22.86
    closed = np.degrees([-1 / across, -(1 + 0.9925070) / across, 0.9925070 / across]) / sine
    assert row.derivatives == pytest.approx(closed, rel=1e-3)


@pytest.mark.parametrize(
    "text", ["sin(a)", "acos(a)", "atan2(a, b)", "hypot(a, b)", "sqrt(b)", "degrees(a)", "tan(a) + cos(b)"]
)
def test_a_function_of_rows_is_that_of_each_to_the_last_bit(text: str) -> None:
    a, b = np.random.default_rng(2).uniform(0.0, 1.0, (2, 50))
    found = Formula(text).value({"a": a, "b": b}).tolist()
    assert found == [
        Formula(text).value({"a": one, "b": other}) for one, other in zip(a.tolist(), b.tolist(), strict=True)
    ]


def test_where_a_function_is_not_known_there_is_no_number_and_no_comparison_is_true() -> None:
    a = np.array([0.5, 2.0, math.nan])
    assert np.isnan(Formula("acos(a)").value({"a": a})).tolist() == [False, True, True]
    assert Formula("not acos(a) < 0").value({"a": a}).tolist()[:2] == [True, False]
    with pytest.raises(ValueError, match=r"comes to no number \(acos in acos\(a\)\)"):
        Formula("acos(a)").value({"a": 2.0})


def test_scenes_have_no_functions_of_columns() -> None:
    with pytest.raises(ValueError, match="calls sin, which no expression may"):
        Expression("sin(1)").value({})


@pytest.mark.usefixtures("no_pictures", "small_designs")
def test_the_report_is_made_where_a_formula_has_a_value_in_some_rows(run_study: RunStudy) -> None:
    results = run_study(DIMENSIONS, 32, scene=CLUTCH, compute={**ANGLE, "beyond": "sqrt(phi - 7)"})
    known = [row["beyond"] for row in results.table().to_pylist() if row["beyond"] is not None]
    spread = findings_of(results).statistics.spreads["beyond"]
    assert 0 < len(known) < 32
    assert (spread.n, spread.least, spread.greatest) == (len(known), min(known), max(known))

"""The paper's numbers: what must come out exactly, and that each row says so."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose.paper import cases, reproduction
from cagepose.paper.planar import zero_is_within_reach
from cagepose.paper.rail import relative_tilt_rad
from cagepose.paper.range_study import permitted, range_study
from cagepose.paper.reproduction import METHODS, reproduce

DEG = math.pi / 180.0


@pytest.fixture(scope="module")
def steps() -> list[str]:
    return []


@pytest.fixture(scope="module")
def result(steps):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cases, "TIMED_RUNS", 3)
        patch.setattr(reproduction, "RANGE_RAD", np.radians([-0.5, -0.25, 0.0, 0.25, 0.5]))
        return reproduce(METHODS, steps.append)


def row(result, quantity):
    (found,) = [row for row in result.rows if row.quantity == quantity]
    return found


def test_the_samples_three_numbers_are_exact_to_1e_9(result):
    """5 mm, acos(7/8) and acos(5/8), in millimetres and degrees."""
    assert row(result, "A-1: travel").found["stepwise"] * 1e3 == pytest.approx(5.0, abs=1e-9)
    assert row(result, "A-2: turn").found["stepwise"] / DEG == pytest.approx(math.acos(7 / 8) / DEG, abs=1e-9)
    assert row(result, "A-3: turn").found["stepwise"] / DEG == pytest.approx(math.acos(5 / 8) / DEG, abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("case", ["pitch", "yaw", "roll"])
def test_each_method_swings_the_rail_through_all_of_its_play(result, method, case):
    """0.313084 deg up under the weight, as much down under the push: 0.626168 deg; and (4.3) to 1e-9 of the angle.

    cos t - 91.5 sin t = 0.5 at t = 0.0054643 rad, worked out in `test_planar`.
    """
    run = getattr(result.runs[method], case)
    before, after = relative_tilt_rad(run, 0), relative_tilt_rad(run, 1)
    assert before / DEG == pytest.approx(0.313084, abs=1e-6)
    assert after / DEG == pytest.approx(-0.313084, abs=1e-6)
    assert (before - after) / DEG == pytest.approx(0.626168, abs=1e-6)
    assert after == pytest.approx(-permitted("pitch"), rel=1e-9)


def test_the_mechanics_ends_where_the_contacts_balance_the_push(result):
    """Relative yaw 0.33220, pitch 0.31308 deg; in the world 0.1 deg is added to the angle that is out of line."""
    runs = result.runs["quasistatic"]
    for run, expected_deg in (
        (runs.pitch, (-0.3322, -0.2131, 0.0012)),
        (runs.yaw, (-0.2322, -0.3131, 0.0018)),
        (runs.roll, (-0.3327, -0.3125, 0.1018)),
    ):
        assert run.verdict == "rests"
        assert np.degrees(run.pose.euler_zyx) == pytest.approx(expected_deg, abs=5e-5)


def test_the_mechanics_has_its_column_where_it_applies(result):
    """The fall is the same; the wedge at -45 deg on C1 and C4 is no stable rest, and no rule A-2 leads there."""
    found = {row.quantity: row.found["quasistatic"] for row in result.rows}
    assert found["A-1: travel"] == pytest.approx(0.005, abs=1e-12)
    assert found["A-1: first contact"] == "C1"
    assert found["A-2: turn"] is None
    assert found["A-4: verdict"] == "rests, unstable"
    assert found["centre of gravity over the triangle C1 C3 C4"] is None
    assert found["range of the relative pitch"] / DEG == pytest.approx(0.626168, abs=1e-6)
    assert found["permitted misalignment in yaw"] / DEG == pytest.approx(0.33220, abs=1e-5)


def test_every_printed_number_has_its_row(result):
    """Section by section, as the paper prints them."""
    assert [row.printed.text for row in result.rows] == [
        *("0.6", "0.01"),
        *("5", "C1", "(0, -1, 0)", "28.96", "0.5054", "C4", "(1, 0, 0)", "51.32", "0.8957", "C3", "stable", "inside"),
        *("0.626", "0.313", "5", "0.392", "-0.168", "-0.560", "40", "0.554"),
        *("0.640", "0.320", "1.91", "0.100", "0.014", "-0.086", "-0.44"),
    ]


def test_each_row_says_how_it_stands(result):
    """Worked out by hand: what rounds to the print, what does not, what the paper leaves out, what is a time."""
    by_status: dict[str, list[str]] = {}
    for found in result.rows:
        by_status.setdefault(found.status, []).append(found.printed.text)
    assert by_status["differs"] == ["0.01", "0.392", "-0.168", "-0.560", "0.640", "0.320"]
    assert by_status["not derivable"] == ["40", "0.014", "-0.086", "-0.44"]
    assert by_status["measured"] == ["0.6", "0.554"]
    assert len(by_status["agrees"]) == 17


def test_differences_are_shown_as_they_are(result):
    """0.4131 - 0.392 = 0.0211; -0.2131 + 0.168 = -0.0451; -0.0659 - 0.014 = -0.0799 deg."""
    for quantity, difference_deg in (
        ("pitch after the weight", 0.0211),
        ("pitch after the push", -0.0451),
        ("yaw after the push", -0.0799),
    ):
        assert row(result, quantity).difference() / DEG == pytest.approx(difference_deg, abs=5e-5)


def test_measured_times_are_those_of_the_runs(result):
    for method, runs in result.runs.items():
        assert 0.0 < runs.pitch_s <= runs.slowest_s
        assert row(result, "time of the run").found[method] == runs.pitch_s


def test_progress_names_each_case_and_the_range(steps, result):
    assert result.methods == METHODS
    assert [step.partition(": ")[2] for step in steps[:4]] == [
        "sample", "rail, yaw 0.1 deg", "rail, pitch 0.1 deg", "rail, roll 0.1 deg",
    ]  # fmt: skip
    assert len(steps) == 5 * len(METHODS)


def test_a_method_with_other_rules_leaves_gaps_and_no_error(result):
    """A method that knows no rule A-2 has nothing to say about its turn; its column shows a gap."""
    from dataclasses import replace

    from cagepose.paper.numbers import number_rows

    def renamed(run):
        phases = [
            replace(phase, events=tuple(replace(event, rule="slide") for event in phase.events)) for phase in run.phases
        ]
        return replace(run, method="other", phases=tuple(phases))

    runs = result.runs["stepwise"]
    other = replace(runs, **{name: renamed(getattr(runs, name)) for name in ("sample", "pitch", "yaw", "roll")})
    values = {row.quantity: row.found["other"] for row in number_rows({"stepwise": runs, "other": other})}
    assert values["A-2: turn"] is None
    assert values["A-1: first contact"] is None
    assert values["A-3: axis"] is None
    assert values["small turn of the stability test"] is None
    assert values["pitch after the push"] == pytest.approx(row(result, "pitch after the push").found["stepwise"])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("pin_y_m", [0.02, -0.02])
def test_pitch_passes_zero_within_the_theorys_range_and_only_there(pin_y_m, method):
    """(6.8): |misalignment| <= 0.3131 deg."""
    misalignments = np.radians([-0.5, -0.32, -0.31, -0.1, 0.1, 0.31, 0.32, 0.5])
    study = range_study("pitch", misalignments, pin_y_m, method)
    expected = [zero_is_within_reach(value, study.permitted_rad).holds for value in misalignments.tolist()]
    assert expected == [False, False, True, True, True, True, False, False]
    assert study.passes_zero().tolist() == expected
    assert study.improved().tolist() == [False, False, False, False, True, True, True, True]
    assert set(study.verdicts) == {"stable" if method == "stepwise" else "rests"}


def test_yaw_passes_zero_at_the_pin_that_touches_first_within_the_theorys_range():
    """(6.8) and (6.7): by the mechanics up to 0.3322 deg to the pin's own side, and not at all to the other."""
    study = range_study("yaw", np.radians([-0.3, -0.1, 0.1, 0.33, 0.335, 0.5]), 0.02, "quasistatic")
    assert study.passes_zero().tolist() == [False, False, True, True, False, False]
    assert study.improved().tolist() == [False, False, False, True, True, True]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("angle", ["yaw", "roll"])
def test_a_rail_that_starts_at_zero_does_not_pass_it(angle, method):
    """Whatever the sign that rounding leaves of its angle after the weight."""
    for pin_y_m in (0.02, -0.02):
        assert not range_study(angle, [0.0], pin_y_m, method).passes_zero().any()


@pytest.mark.parametrize("method", METHODS)
def test_the_two_pins_turn_the_rail_to_opposite_sides(method):
    """Mirror the scene in the xz plane: the other pin, yaw and roll of the other sign, the same pitch."""
    misalignments = np.radians([-0.4, 0.1, 0.3])
    left = range_study("yaw", misalignments, 0.02, method)
    right = range_study("yaw", -misalignments, -0.02, method)
    assert left.after_push_rad == pytest.approx(right.after_push_rad * [-1, 1, -1], abs=1e-12)
    assert left.improved().tolist() == right.improved().tolist()


@pytest.mark.parametrize("method", METHODS)
def test_roll_is_left_as_it_is(method):
    study = range_study("roll", np.radians([-0.5, 0.5]), 0.02, method)
    assert study.permitted_rad is None
    assert not study.improved().any()
    assert not study.passes_zero().any()

"""A grip that is too weak slips: the part stays where it lies, with its weight less what the pads can hold."""

from __future__ import annotations

from pathlib import Path

import pytest

from cagepose import Run, Scene, load_scene, run
from driven.slipping_grips import FORCE_N, GRAVITY, LIFT_M, slipping

SCENES = Path(__file__).parents[2] / "scenes"
RESTS = ("rests", "may rest")


def carried(found: Run, element: str) -> float:
    """Normal force of an element of the cage at the end of the second phase."""
    return sum(one.force_normal_n or 0.0 for one in found.phases[1].contacts if one.point == element)


def gripped(mass_kg: float, friction: float, lift_m: float = LIFT_M) -> Scene:
    up = {f"loads[1].drive.{side} jaw.travel": [0.0, 0.0, lift_m] for side in ("left", "right")}
    given = {"object.mass": mass_kg, "friction.coefficient": friction}
    return load_scene(SCENES / "grip.yaml").changed({**given, **up})


def has_slipped(found: Run, mass_kg: float, friction: float, pads: tuple[str, str]) -> None:
    """Each pad rubs with friction times what it carries: what presses 12 N, and the other one as much but for what the
    table's friction takes; the table has the rest of the weight.
    """
    drive, weight = found.phases[1].drive, mass_kg * GRAVITY
    assert drive is not None
    assert drive.share == 1.0
    assert found.phases[1].verdict in RESTS
    left, right, table = carried(found, pads[0]), carried(found, pads[1]), carried(found, "table")
    assert right == pytest.approx(FORCE_N, rel=1e-6)
    assert drive.along == pytest.approx(friction * (left + right), rel=1e-6)
    assert abs(left - FORCE_N) <= friction * table * (1.0 + 1e-6)
    assert table == pytest.approx(weight - drive.along, rel=1e-6)
    assert found.phases[1].pose.position_m[2] == pytest.approx(found.phases[1].start_pose.position_m[2], abs=1e-9)


@pytest.mark.parametrize("friction", [0.02, 0.08, 0.15, 0.3])
@pytest.mark.parametrize("of_what_is_held", [0.5, 0.98, 1.02, 1.5, 3.0])
def test_a_block_is_lifted_if_both_pads_can_hold_it_and_slips_else(friction: float, of_what_is_held: float):
    """The jaws of the scene turn it flat before, to within rounding, so that not all contacts are without a gap. With
    much more friction, what is too heavy stays askew between them, held by the table.
    """
    mass_kg = of_what_is_held * 2.0 * friction * FORCE_N / GRAVITY
    found = run(gripped(mass_kg, friction))
    assert len(found.phases[0].events) <= 6
    if of_what_is_held > 1.0:
        has_slipped(found, mass_kg, friction, ("left pad", "right pad"))
    else:
        assert found.phases[1].verdict in RESTS
        assert found.phases[1].pose.position_m[2] == pytest.approx(LIFT_M, abs=1e-9)


@pytest.mark.parametrize(("mass_kg", "friction"), [(0.36, 0.16), (0.584, 0.15)])
def test_jaws_that_push_a_flat_block_along_do_so_in_a_few_events(mass_kg: float, friction: float):
    """Contacts that left their cones as forces rose, but do not slip, had the run stop again and again."""
    closed = run(gripped(mass_kg, friction)).phases[0]
    assert closed.verdict in RESTS
    assert len(closed.events) <= 6


def test_pads_that_slip_off_end_the_drive():
    """They reach from 4 mm below the block's middle, whose upper face is 5 mm above it."""
    found = run(gripped(0.5, 0.15, 0.04))
    lifted = found.phases[1]
    assert lifted.verdict == "escapes"
    assert lifted.drive is not None
    assert lifted.drive.share * 0.04 == pytest.approx(0.009, abs=1e-6)
    assert lifted.pose.position_m[2] == pytest.approx(0.0, abs=1e-9)
    assert lifted.drive.greatest_along == pytest.approx(2.0 * 0.15 * FORCE_N, rel=0.01)
    assert any("slipped off the object" in warning for warning in found.warnings)


@pytest.mark.parametrize("off_m", [(0.002, 0.0), (0.0, 0.003)])
def test_pads_off_the_middle_slip_alike(off_m: tuple[float, float]):
    has_slipped(run(slipping(1.0, 0.15, off_m=off_m)), 1.0, 0.15, ("pad 0", "pad 1"))


@pytest.mark.parametrize("friction", [0.05, 0.15, 0.3])
@pytest.mark.parametrize("mass_kg", [0.2, 1.0, 2.0])
def test_a_pad_with_half_the_friction_holds_half_as_much(friction: float, mass_kg: float):
    """The table's friction can press the block on the pad that stands, or away from it."""
    found, held = run(slipping(mass_kg, friction, of_left=0.5 * friction)), 1.5 * friction * FORCE_N
    drive, table = found.phases[1].drive, carried(found, "table")
    assert drive is not None
    assert found.phases[1].verdict in RESTS
    if held > mass_kg * GRAVITY:
        assert drive.along == pytest.approx(mass_kg * GRAVITY, rel=1e-9)
        return
    assert drive.along == pytest.approx(friction * (0.5 * carried(found, "pad 0") + carried(found, "pad 1")), rel=1e-6)
    assert abs(drive.along - held) <= 0.5 * friction * friction * table
    assert table == pytest.approx(mass_kg * GRAVITY - drive.along, rel=1e-6)


@pytest.mark.parametrize("friction", [0.05, 0.15, 0.3])
def test_four_pads_that_press_hold_four_times_the_friction_of_one(friction: float):
    held = 4.0 * friction * FORCE_N
    for mass_kg in (0.9 * held / GRAVITY, 1.1 * held / GRAVITY, 2.0 * held / GRAVITY):
        found = run(slipping(mass_kg, friction, sides=4))
        weight, drive = mass_kg * GRAVITY, found.phases[1].drive
        assert drive is not None
        assert found.phases[1].verdict in RESTS
        assert drive.along == pytest.approx(min(weight, held), rel=1e-6)
        assert found.phases[1].pose.position_m[2] == pytest.approx(LIFT_M if weight < held else 0.0, abs=1e-9)

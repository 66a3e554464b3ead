"""`cagepose.compare`: which variants are run, where they part, and what is said of it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import cagepose
from cagepose import Box, Cage, Load, Object, Pose, Scene, SceneError, compare
from cagepose.kernels.quasistatic import step as quasistatic
from cagepose.kernels.stepwise import run as stepwise
from cagepose.runs.run import FAILURES, STOPPED
from cagepose.studies.comparison import ENDS, GROUNDS, METRICS, Variant, parting_of
from rails import rail_scene

SCENES = Path(__file__).resolve().parents[2] / "scenes"
MM = 1e-3
SQUARE = np.array([(4, 4, 0), (4, -4, 0), (-4, -4, 0), (-4, 4, 0)]) * MM
DOWN = Load("gravity", gravity=(0, 0, -1))


def block(*, height_m: float = 0.01, up_m: float = 0.0) -> Scene:
    """A block right over four points, ``up_m`` above them."""
    held = Object([Box((0.01, 0.01, height_m))], pose=Pose((0, 0, height_m / 2 + up_m)))
    return Scene(held, Cage(SQUARE), [DOWN])


def scene_of(name: str) -> Scene:
    return cagepose.load_scene(SCENES / f"{name}.yaml")


def test_both_metrics_run_without_friction_and_with_that_of_the_papers_rules():
    comparison = compare(block())
    assert [variant.label for variant in comparison.variants] == [
        "stepwise",
        *(f"quasistatic, {how}, friction {mu}" for mu in ("0", "0.1003") for how in ("by inertia", "by drag")),
    ]
    assert [variant.friction for variant in comparison.variants] == pytest.approx(
        [math.tan(0.1), 0, 0] + 2 * [math.tan(0.1)]
    )
    for variant in comparison.variants[1:]:
        assert variant.run.scene.friction_coefficient == variant.friction
        assert variant.label.split(", ")[1] == METRICS[variant.run.scene.metric]


def test_a_scene_without_friction_is_run_once_with_each_metric():
    assert len(compare(block().changed(friction_coefficient=0.0)).variants) == 3
    assert len(compare(block(), [0.0, 0.2, 0.2]).variants) == 5


def test_a_coefficient_below_zero_is_refused():
    with pytest.raises(SceneError, match="friction"):
        compare(block(), [-0.1])


def test_a_block_that_drops_onto_its_points_goes_one_way():
    comparison = compare(block(up_m=0.003))
    assert comparison.partings == ()
    poses = [variant.run.pose.position_m for variant in comparison.variants]
    assert poses == [pytest.approx((0, 0, 0.005), abs=1e-12)] * 5


def test_the_sample_parts_at_its_second_event():
    partings = compare(scene_of("sample")).partings
    assert [(parting.phase, parting.number, parting.first_number) for parting in partings] == [("gravity", 2, 2)] * 4


def test_where_the_rules_end_and_the_mechanics_goes_on_the_ends_are_named():
    (release, _) = compare(scene_of("slope"), [0.5]).partings
    assert (release.number, release.first_number) == (1, None)
    assert release.reason == (
        "stepwise ends: stable (no turn about two of its contacts is free);"
        " quasistatic travels along (0.866, 0, -0.5) (sliding: the contacts do not balance the"
        " load, and those with a force slide)"
    )


def test_where_the_mechanics_ends_its_proof_is_the_ground():
    (release, _) = compare(scene_of("v-groove"), [0.2]).partings
    assert (release.phase, release.number, release.first_number) == ("clamp", None, 1)
    assert release.reason == (
        "stepwise travels along (0, 1, 0) (Slp-2: every normal is more than the friction angle off the load, so it"
        " slips on two faces); quasistatic ends: rests (the contacts balance the load with friction, and every other"
        " contact mode is ruled out)"
    )


def test_a_fall_is_told_as_a_travel_though_rounding_turns_the_object():
    (release, drag) = compare(scene_of("wedge"), [0.18]).partings
    for parting in (release, drag):
        assert "quasistatic travels along (0, 0, -1) (sliding: " in parting.reason


def test_a_balance_on_a_needle_is_not_called_a_turn_that_is_blocked():
    def on_a_needle(beside_m: float) -> Scene:
        cube = Object([Box((0.01, 0.01, 0.01))], (beside_m, 0, 0), pose=Pose((0, 0, 0.005)))
        return Scene(cube, Cage([(0, 0, 0), (0.004, 0, -0.001)]), [DOWN], friction_coefficient=0.5)

    right_over_it = Variant("right over it", 0.5, cagepose.run(on_a_needle(0.0), "stepwise"))
    assert right_over_it.run.verdict == "stable"
    parting = parting_of(right_over_it, Variant("beside it", 0.5, cagepose.run(on_a_needle(1e-3), "quasistatic")))
    assert parting is not None
    assert parting.reason.startswith("stepwise ends: stable (the load passes through its one contact); quasistatic")


def test_two_escapes_from_one_pose_are_one_way():
    start = block(up_m=0.001)
    comparison = compare(Scene(start.object, start.cage, [Load("gravity", gravity=(0, 0, 1))]))
    assert {variant.run.verdict for variant in comparison.variants} == {"escapes"}
    assert comparison.partings == ()


def test_a_rest_and_an_escape_from_one_pose_part_at_the_end():
    resting = Variant("resting", 0.0, cagepose.run(block(), "stepwise"))
    up = Scene(block().object, block().cage, [Load("gravity", gravity=(0, 0, 1))])
    leaving = Variant("leaving", 0.0, cagepose.run(up, "quasistatic"))
    parting = parting_of(resting, leaving)
    assert parting is not None
    assert (parting.label, parting.number, parting.first_number) == ("leaving", None, None)
    assert parting.reason.endswith("; quasistatic ends: escapes (no contact is ahead)")


def test_a_later_phase_is_named_where_only_it_differs():
    """With friction the rail's weight leaves it where the rules do; the push does not."""
    with_friction = [parting for parting in compare(rail_scene(pitch_deg=0.1)).partings if "0.1003" in parting.label]
    assert [parting.phase for parting in with_friction] == ["push", "push"]


def test_every_rule_that_moves_has_its_ground_and_every_failure_its_words():
    moving = {*stepwise.RULE_NAMES, *quasistatic.RULE_NAMES} - {"A-4", "B-4", "held", "stalled"}
    assert set(GROUNDS) == moving
    assert set(ENDS) == FAILURES | STOPPED | {"escapes"}

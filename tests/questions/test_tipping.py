"""How large a force may become until a part tips, slides or lifts off."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    Force,
    Load,
    Object,
    Pose,
    Run,
    Scene,
    Tipping,
    Unanswered,
    load_scene,
    run,
    tipping,
)
from cagepose.cli.app import main
from questions.cones_of_sides import OUTER, greatest_extra
from questions.planar_modes import drawn_block

SCENES = Path(__file__).resolve().parents[2] / "scenes"
A, H = 0.04, 0.03
"""Legs stand at x, y = +-A; the centre of gravity is H above them."""
LEGS = {f"leg {x:+d}{y:+d}": (x * A, y * A, -H) for x in (1, -1) for y in (1, -1)}
WEIGHT = 2.0 * 9.81


def block(friction: float, legs: dict[str, tuple[float, float, float]] = LEGS) -> Run:
    held = Object([Box((0.1, 0.1, 2 * H))], mass_kg=2.0)
    weight = Load("weight", gravity=(0, 0, -9.81))
    return run(Scene(held, Cage(list(legs.values()), list(legs)), [weight], friction_coefficient=friction))


def asked(a_run: Run, force: Force) -> Tipping:
    found = tipping(a_run, force)
    assert isinstance(found, Tipping)
    return found


@pytest.mark.parametrize(("friction", "above"), [(0.1, H), (0.3, 2 * H), (0.5, 2 * H), (0.9, 2 * H), (0.9, 0.0)])
def test_a_block_slides_at_mu_w_or_tips_at_w_b_over_h(friction: float, above: float) -> None:
    """Pushed along x at a height h above the legs: whichever is less."""
    found = asked(block(friction), Force((1, 0, 0), (0, 0, above - H)))
    tips_at = WEIGHT * A / above if above else math.inf
    expected = min(friction * WEIGHT, tips_at)
    assert found.in_newtons
    assert found.force_n == pytest.approx(expected, rel=1e-9)
    assert found.force_n < found.not_at_n <= found.force_n * (1.0 + 1.01e-6)
    assert found.loss is not None
    back = {"leg -1+1", "leg -1-1"}
    if tips_at < friction * WEIGHT:
        assert (found.loss.kind, {one.point for one in found.loss.opens}) == ("tips", back)
        assert {one.point for one in found.loss.sticks} == set(LEGS) - back
    else:
        assert (found.loss.kind, {one.point for one in found.loss.slips}) == ("slides", set(LEGS))
    (no_motion,) = found.no_motion
    assert no_motion.shown_from == 0.0
    assert expected * (1.0 - 1e-4) <= no_motion.shown_to <= expected * (1.0 + 1e-9)


def test_a_force_that_follows_points_along_the_turned_part() -> None:
    """A block that stands turned by 90 deg about z, on legs that are nearer to it along the world's y: 4 : 2."""
    turned = Pose((0, 0, 0), (math.sqrt(0.5), 0, 0, math.sqrt(0.5)))
    legs = [(x, 0.5 * y, z) for x, y, z in LEGS.values()]
    held = Object([Box((0.1, 0.1, 2 * H))], mass_kg=2.0, pose=turned)
    a_run = run(Scene(held, Cage(legs), [Load("weight", gravity=(0, 0, -9.81))], friction_coefficient=2.0))
    for follows, arm in ((False, A), (True, 0.5 * A)):
        found = asked(a_run, Force((1, 0, 0), (0, 0, H), follows=follows))
        assert found.force_n == pytest.approx(WEIGHT * arm / (2 * H), rel=1e-9)


def test_a_leg_that_is_lifted_is_without_force_at_w_over_3_and_opens_at_w_over_2() -> None:
    """Equally stiff, that leg has W / 4 - 3 F / 4. Then the opposite leg presses against F, and the two others carry
    the rest, W - 2 F.
    """
    found = asked(block(0.3), Force((0, 0, 1), (A, A, 0)))
    assert found.force_n == pytest.approx(WEIGHT / 2, rel=1e-9)
    (lifted,) = found.lifts_off
    assert lifted.contact.point == "leg +1+1"
    assert lifted.force_n == pytest.approx(WEIGHT / 3, rel=1e-5)
    assert found.loss is not None
    assert found.loss.kind == "tips"
    assert {one.point for one in found.loss.opens} == {"leg +1+1", "leg +1-1", "leg -1+1"}


def test_a_beam_that_is_lifted_at_its_end_tips_when_half_its_weight_is_lifted() -> None:
    found = asked(block(0.3), Force((0, 0, 1), (A, 0, 0)))
    assert found.force_n == pytest.approx(WEIGHT / 2, rel=1e-9)
    assert found.loss is not None
    assert {one.point for one in found.loss.opens} == {"leg +1+1", "leg +1-1"}
    assert found.loss.motion.axis_world == pytest.approx([0.0, -1.0, 0.0], abs=1e-6)


def test_lifted_in_its_middle_a_block_lifts_off_and_pressed_down_it_never_gives_way() -> None:
    up = asked(block(0.3), Force((0, 0, 1), (0, 0, 0)))
    assert up.force_n == pytest.approx(WEIGHT, rel=1e-9)
    assert up.loss is not None
    assert up.loss.kind == "lifts off"
    down = asked(block(0.3), Force((0, 0, -1), (0, 0, 0)))
    assert (down.force_n, down.not_at_n, down.loss, down.lifts_off) == (math.inf, math.inf, None, ())
    assert down.no_motion[0].shown_to == down.up_to_n


@pytest.mark.parametrize("friction", [0.3, 0.4])
def test_a_person_on_a_ladder(friction: float) -> None:
    """Floor N, wall M, both slip: N = (W + F) / (1 + mu^2), M = mu N. About the foot, of a ladder of length 2 on
    which the person is at 1 + s: 2 M (sin + mu cos) = (W + F (1 + s)) cos.
    """
    s = 0.8
    cos, sin = math.cos(math.radians(60)), math.sin(math.radians(60))
    per_load = friction / (1 + friction**2) * 2.0 * (sin + friction * cos)
    expected = (per_load - cos) / ((1.0 + s) * cos - per_load)
    a_run = run(load_scene(SCENES / "ladder.yaml", [f"friction.coefficient={friction}"]))
    found = asked(a_run, Force((0, 0, -1), (-s * cos, 0, s * sin)))
    assert found.force_n == pytest.approx(expected, rel=1e-8)
    assert found.loss is not None
    assert (found.loss.kind, len(found.loss.slips)) == ("slides", 4)


def test_the_force_is_between_those_of_cones_with_64_sides(cases: Callable[[int, int], int]) -> None:
    """Of leaning planks, a bar in a V-groove, and drawn blocks, with drawn forces."""
    rng = np.random.default_rng(11)
    runs = [run(load_scene(SCENES / f"{name}.yaml")) for name in ("planks", "v-groove")]
    runs += [run(drawn_block(rng).scene()) for _ in range(cases(6, 600))]
    n_asked, n_finite = 0, 0
    for a_run in runs:
        direction, at = rng.normal(size=3), rng.uniform(-0.01, 0.01, 3)
        direction /= np.linalg.norm(direction)
        found = tipping(a_run, Force(direction, at))
        if isinstance(found, Unanswered):
            continue
        friction = a_run.scene.friction_coefficient or 0.0
        inner, outer = (greatest_extra(a_run, direction, at, friction, radius) for radius in (1.0, OUTER))
        n_asked, n_finite = n_asked + 1, n_finite + math.isfinite(outer)
        assert inner * (1.0 - 1e-6) - 1e-8 <= found.force_n <= outer * (1.0 + 1e-6)
        assert math.isinf(outer) or found.force_n < found.not_at_n <= outer * (1.0 + 2e-3)
    assert n_asked >= 4
    assert n_finite >= 2


def test_where_nothing_touches_there_is_no_such_force() -> None:
    falls = Object([Box((0.01, 0.01, 0.01))], pose=Pose((0.1, 0, 0)))
    a_run = run(Scene(falls, Cage([(0.0, 0.0, -0.02)]), [Load("weight", gravity=(0, 0, -1))]))
    found = tipping(a_run, Force((1, 0, 0), (0, 0, 0)))
    assert isinstance(found, Unanswered)
    assert "'escapes'" in found.unanswered


def test_the_command_takes_the_place_in_the_scenes_unit(capsys: pytest.CaptureFixture[str]) -> None:
    path = str(SCENES / "ladder.yaml")
    assert main(["ask", "tipping", path, "--at=-400,0,692.8", "--direction", "0,0,-1", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    found = asked(run(load_scene(path)), Force((0, 0, -1), (-0.4, 0, 0.6928)))
    assert (document["force"], document["loss"]["kind"], document["in_newtons"]) == (found.force_n, "slides", False)
    assert document["loss"]["slips"][0]["at"] == pytest.approx([500.0, -180.0, -866.0254], abs=1e-3)


def test_wrong_triples_are_all_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ask", "tipping", "no.yaml", "--at", "1,2", "--direction", "0,0,0"]) == 2
    told = capsys.readouterr().err.splitlines()
    assert told[0].startswith("--at 1,2: is not three numbers")
    assert told[1].startswith("--direction 0,0,0: is the zero vector")
    assert told[2].startswith("no.yaml")

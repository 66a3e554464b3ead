"""A part that moves goes on as long as Coulomb's law lets it, though friction could hold it: equation (5.62).

A drawer 400 mm long and 300 mm wide slides out from between two walls of its length, pulled beside its middle. By the
statics of two places on opposite walls, a distance L apart along them, it can stay from L = mu w on, w its width, and
slides up to L = 2 mu e, e the distance of the pull from its middle, the play going to zero.
"""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Moment, Object, Pose, Run, Scene, run

MM = 1e-3
LENGTH, WIDTH, PULL_N = 400.0, 300.0, 20.0
PLAY_MM = 1.0


def drawer(
    friction: float, beside_mm: float, play_mm: float, begun_mm: float = 20.0, size: float = 1.0, side: float = 1.0
) -> Scene:
    """The drawer, turned until it touches both walls, and then pulled along x; ``size`` scales all of it."""
    unit = MM * size
    beside = 0.5 * (WIDTH + play_mm) + 5.0
    walls = [
        Box(np.array((2.0 * LENGTH, 10.0, 60.0)) * unit, Pose(np.array((-0.5 * LENGTH, at * beside, 0.0)) * unit), name)
        for at, name in ((1.0, "left"), (-1.0, "right"))
    ]
    held = Object(
        [Box(np.array((LENGTH, WIDTH, 40.0)) * unit, Pose(), "drawer")],
        mass_kg=1.0,
        pose=Pose(np.array((begun_mm, 0.0, 0.0)) * unit),
    )
    at = np.array((0.5 * LENGTH, side * beside_mm, 0.0)) * unit
    loads = [
        Load("turn", moments=[Moment((0.0, 0.0, -side), 1.0)]),
        Load("pull", force=Force((1.0, 0.0, 0.0), at, PULL_N)),
    ]
    return Scene(held, Cage(shapes=walls), loads, friction_coefficient=friction, planar="xy", name="drawer")


def spare_pull(result: Run, friction: float, play_mm: float) -> float:
    """What is left across the pull where two places slip with all of their friction and balance all else, newtons: by
    forces and moments in the plane.
    """
    pose, push = result.pose, result.scene.loads[1].force
    along, across = pose.rotation[:2, 0], pose.rotation[:2, 1]
    corner = pose.transform(np.array((-0.5 * LENGTH, 0.5 * WIDTH, 0.0)) * MM)[:2]  # of the drawer, on the left wall
    end = np.array((0.5 * LENGTH, -0.5 * (WIDTH + play_mm))) * MM  # of the right wall
    at = pose.transform(push.at_object_m)[:2]
    forces = [np.array((-friction, -1.0)), across - friction * along]
    arms = [corner - at, end - at]
    moments = [arm[0] * force[1] - arm[1] * force[0] for arm, force in zip(arms, forces, strict=True)]
    share = -moments[0] / moments[1]  # of the second force for each newton of the first, by the moments about the pull
    net = forces[0] + share * forces[1]
    first_n = -push.magnitude_n / net[0]
    assert first_n > 0.0
    assert share > 0.0
    return abs(net[1] * first_n)


@pytest.mark.parametrize("play_mm", [0.5, PLAY_MM])
@pytest.mark.parametrize(("friction", "beside_mm"), [(0.5, 100.0), (0.7, 60.0), (0.4, 140.0)])
def test_a_drawer_slides_past_where_it_could_stay_to_where_it_must(friction, beside_mm, play_mm):
    """It could stay from L = mu w on, which is larger than 2 mu e, and does not: it stops where the forces of two
    places that slip balance all of the pull. With another friction they do not there.
    """
    result = run(drawer(friction, beside_mm, play_mm))
    assert [phase.verdict for phase in result.phases] == ["rests", "rests"]
    assert spare_pull(result, friction, play_mm) < 1e-4 * PULL_N
    assert spare_pull(result, 0.95 * friction, play_mm) > 1e-3 * PULL_N
    assert LENGTH - result.pose.position_m[0] / MM < friction * WIDTH - 10.0
    assert "could stay" in [event.note for event in result.phases[1].events]
    assert sum(contact.force_normal_n for contact in result.phases[1].contacts) < 50.0 * PULL_N


@pytest.mark.parametrize(("friction", "beside_mm"), [(0.5, 100.0), (0.7, 60.0), (0.4, 140.0), (0.5, 180.0)])
def test_with_hardly_any_play_it_slides_to_the_closed_form(friction, beside_mm):
    """L = 2 mu e, but for the play, and for the 1e-5 sizes by which a motion that could have ended runs on. The end of
    a wall begins at the lower edge of the drawer's side, and still comes off it at its rear.
    """
    result = run(drawer(friction, beside_mm, 1e-3))
    assert result.pose.position_m[0] / MM == pytest.approx(LENGTH - 2.0 * friction * beside_mm, abs=0.03)


def test_a_drawer_that_rests_where_it_could_slide_stays():
    """Begun from rest at L = 130 mm, between 2 mu e = 100 mm and mu w = 150 mm: a phase begins from rest."""
    result = run(drawer(0.5, 100.0, PLAY_MM, begun_mm=270.0))
    assert [phase.verdict for phase in result.phases] == ["rests", "may rest"]
    assert result.pose.position_m == pytest.approx(result.phases[0].pose.position_m, abs=1e-9)
    assert result.pose.position_m[0] / MM == pytest.approx(270.0, abs=1.0)
    assert "could stay" not in [event.note for event in result.phases[1].events]


def test_a_drawer_that_must_stop_before_it_could_stay_says_nothing():
    """e = 180 mm is more than half the width: it stops at about L = 2 mu e = 180 mm, and could stay from 150 mm on."""
    result = run(drawer(0.5, 180.0, PLAY_MM))
    assert spare_pull(result, 0.5, PLAY_MM) < 1e-4 * PULL_N
    assert result.pose.position_m[0] / MM == pytest.approx(LENGTH - 180.0, abs=5.0)
    assert "could stay" not in [event.note for phase in result.phases for event in phase.events]


def test_it_slides_as_far_mirrored_and_at_any_size():
    here = run(drawer(0.5, 100.0, 1.0)).pose.position_m
    mirrored = run(drawer(0.5, 100.0, 1.0, side=-1.0)).pose.position_m
    large = run(drawer(0.5, 100.0, 1.0, size=100.0)).pose.position_m
    assert mirrored == pytest.approx(here * (1, -1, 1), abs=1e-6)
    assert large == pytest.approx(100.0 * here, abs=1e-4)

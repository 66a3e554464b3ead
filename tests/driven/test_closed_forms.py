"""Driven bodies against closed forms: chamfer, wedge, drawer, von Mises truss."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    CageBody,
    Convex,
    Cylinder,
    Drive,
    Force,
    Load,
    Object,
    Pose,
    Run,
    Scene,
    Sphere,
    Spring,
    run,
)
from driven.insertions import MM, on_chamfer

WEIGHT = 9.81
"""Newtons, of one kilogram."""


def prism(corners: Sequence[tuple[float, float]], width: float, name: str) -> Convex:
    """The hull of corners (x, z), so wide along y."""
    return Convex([(x, y, z) for x, z in corners for y in (-0.5 * width, 0.5 * width)], name=name)


# chamfer


@pytest.mark.parametrize("angle_deg", [20.0, 45.0, 60.0])
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.3])
def test_on_a_chamfer_the_forces_are_as_the_tangent_of_both_angles(angle_deg: float, friction: float) -> None:
    """The peg is let down until its tip has slid to 0.2 mm beside the axis."""
    angle = math.radians(angle_deg)
    way = 1.0 + 4.0 / math.tan(angle)
    (phase,) = run(on_chamfer(angle, friction, way)).phases
    assert phase.drive is not None
    half = float(phase.drive.curve.share[np.argmin(np.abs(phase.drive.curve.position_m[:, 0] - 0.2 * MM))])
    (phase,) = run(on_chamfer(angle, friction, half * way)).phases
    assert phase.drive is not None
    assert 0.05 * MM < phase.pose.position_m[0] < 0.39 * MM
    x, y, z = phase.drive.bodies["gripper"].force_n
    assert abs(z / x) == pytest.approx(math.tan(angle + math.atan(friction)), rel=1e-9)
    assert abs(y) < 1e-9 * abs(x)


@pytest.mark.parametrize("angle_deg", [45.0, 60.0])
def test_nothing_goes_in_where_both_angles_are_a_right_one(angle_deg: float) -> None:
    """Where friction holds the peg on the chamfer against any force it stays, however far the gripper comes."""
    angle, limit = math.radians(angle_deg), math.tan(math.radians(90.0 - angle_deg))
    for way in (8.0, 16.0):
        enters, stays = (run(on_chamfer(angle, part * limit, way)) for part in (0.8, 1.001))
        assert enters.pose.position_m[2] < -6.0 * MM
        assert enters.pose.position_m[0] < 0.05 * MM
        assert stays.pose.position_m[2] > -2.0 * MM
        assert stays.pose.position_m[0] == pytest.approx(0.4 * MM, abs=1e-3 * MM)


# wedge


def wedge(friction: float, wall: float, angle_deg: float = 20.0) -> Scene:
    """A block of 1 kg on a ramp that is driven below it, against a wall that is tall enough to carry the moment."""
    slope = math.tan(math.radians(angle_deg))
    foot = [(x, -slope * x) for x in (-0.02, 0.02)]
    block = prism([*foot, (0.02, 0.06), (-0.02, 0.06)], 0.04, "block")
    face = [(x, -slope * x) for x in (-0.08, 0.08)]
    ramp = CageBody("ramp", shapes=[prism([*face, (0.08, -0.08), (-0.08, -0.08)], 0.1, "top")])
    cage = Cage(shapes=[Box((0.02, 0.1, 0.4), Pose((0.03, 0.0, 0.1)), "wall")], bodies=[ramp])
    load = Load("drive", gravity=(0.0, 0.0, -WEIGHT), drive={"ramp": Drive(travel=(0.02, 0.0, 0.0))})
    part = Object(shapes=[block], mass_kg=1.0)
    return Scene(part, cage, [load], friction_coefficient=friction, friction_of={"wall": wall})


@pytest.mark.parametrize(("friction", "wall"), [(0.0, 0.0), (0.2, 0.0), (0.2, 0.3), (0.5, 0.1), (0.1, 0.9)])
def test_a_wedge_lifts_with_the_force_of_both_friction_angles(friction: float, wall: float) -> None:
    (phase,) = run(wedge(friction, wall)).phases
    lever = math.tan(math.radians(20.0) + math.atan(friction))
    assert phase.drive is not None
    assert phase.drive.share == 1.0
    assert phase.drive.along == pytest.approx(WEIGHT * lever / (1.0 - wall * lever), rel=1e-9)
    assert phase.pose.position_m == pytest.approx([0.0, 0.0, 0.02 * math.tan(math.radians(20.0))], abs=1e-11)


@pytest.mark.parametrize("friction", [0.2, 0.5])
def test_a_wedge_jams_from_the_friction_on_at_which_the_force_has_no_bound(friction: float) -> None:
    limit = 1.0 / math.tan(math.radians(20.0) + math.atan(friction))
    (below,), (above,) = (run(wedge(friction, wall)).phases for wall in (0.9 * limit, 1.001 * limit))
    assert below.drive is not None
    assert (below.drive.share, above.verdict) == (1.0, "jams")
    assert below.drive.along == pytest.approx(10.0 * WEIGHT / limit, rel=1e-8)
    assert above.pose.position_m == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


# drawer

APART, BESIDE = 0.06, 0.02
"""Of its two pins, along its way, and of the push from the middle, metres."""


def drawer(friction: float, resistance_n: float, side: float = 1.0) -> Scene:
    """A drawer on a smooth table, guided by two pins, pushed by a smooth finger."""
    pins = [
        Cylinder(0.005, 0.1, Pose((sign * 0.5 * APART, -sign * side * 0.025, 0.01)), name)
        for sign, name in ((-1.0, "rear pin"), (1.0, "front pin"))
    ]
    table = Box((1.0, 1.0, 0.02), Pose((0.0, 0.0, -0.01)), "table")
    finger = CageBody("finger", shapes=[Sphere(0.005, Pose((-0.055, side * BESIDE, 0.01)), "tip")])
    force = Force((-1.0, 0.0, 0.0), (0.05, 0.0, 0.0), resistance_n) if resistance_n else None
    drive = {"finger": Drive(travel=(0.02, 0.0, 0.0))}
    load = Load("push", gravity=(0.0, 0.0, -WEIGHT), force=force, drive=drive)
    part = Object([Box((0.1, 0.04, 0.02), name="drawer")], mass_kg=1.0, pose=Pose((0.0, 0.0, 0.01)))
    smooth = {"tip": 0.0, "table": 0.0}
    return Scene(
        part, Cage(shapes=[*pins, table], bodies=[finger]), [load], friction_coefficient=friction, friction_of=smooth
    )


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("friction", [0.0, 0.3, 1.0, 1.47])
def test_a_drawer_takes_the_force_of_its_lever(friction: float, side: float) -> None:
    (phase,) = run(drawer(friction, 1.0, side)).phases
    assert phase.drive is not None
    assert phase.drive.share == 1.0
    assert phase.drive.along == pytest.approx(1.0 / (1.0 - 2.0 * friction * BESIDE / APART), rel=1e-8)
    assert phase.pose.position_m == pytest.approx([0.02, 0.0, 0.01], abs=1e-10)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("friction", [1.6, 2.0])
def test_a_drawer_jams_beyond_its_limit(friction: float, side: float) -> None:
    (against,) = run(drawer(friction, 1.0, side)).phases
    assert against.verdict == "jams"
    assert against.pose.position_m == pytest.approx([0.0, 0.0, 0.01], abs=1e-12)


def test_a_drawer_that_nothing_resists_goes_on_without_force() -> None:
    (free,) = run(drawer(0.75, 0.0)).phases
    assert free.drive is not None
    assert (free.drive.share, free.drive.along) == (1.0, pytest.approx(0.0, abs=1e-9))


# truss

HIGH, REACH, RATE = 0.03, 0.1, 2000.0
"""Of the slide above the middle, of its springs to each side, metres, and their stiffness, N/m."""
REST = math.hypot(REACH, HIGH)


def truss_force(high: float) -> float:
    return 2.0 * RATE * (REST / math.hypot(REACH, high) - 1.0) * high


def truss_energy(high: float) -> float:
    return RATE * (REST - math.hypot(REACH, high)) ** 2


def truss(way: float) -> Run:
    """A slide in a straight smooth guide between two springs, pushed down from a millimetre above it."""
    walls = [
        Box((0.02, 0.04, 0.4), Pose((0.02, 0.0, 0.0)), "right"),
        Box((0.02, 0.04, 0.4), Pose((-0.02, 0.0, 0.0)), "left"),
        Box((0.1, 0.02, 0.4), Pose((0.0, 0.02, 0.0)), "back"),
        Box((0.1, 0.02, 0.4), Pose((0.0, -0.02, 0.0)), "front"),
    ]
    finger = CageBody("finger", shapes=[Sphere(0.002, Pose((0.0, 0.0, HIGH + 0.013)), "tip")])
    springs = [Spring((0.0, 0.0, 0.0), (sign * REACH, 0.0, 0.0), RATE) for sign in (-1.0, 1.0)]
    load = Load("push", springs=springs, drive={"finger": Drive(travel=(0.0, 0.0, -way))})
    slide = Object([Box((0.02, 0.02, 0.02), name="slide")], mass_kg=0.1, pose=Pose((0.0, 0.0, HIGH)))
    return run(Scene(slide, Cage(shapes=walls, bodies=[finger]), [load]))


def test_a_truss_that_is_pushed_through_has_its_curve_and_snaps_at_its_dead_point() -> None:
    (phase,) = truss(0.05).phases
    drive = phase.drive
    assert drive is not None
    pushed = drive.curve.share < 0.62 - 1e-9  # a millimetre, and 30 from there
    for share, along, position in zip(
        drive.curve.share[pushed], drive.curve.along[pushed], drive.curve.position_m[pushed], strict=True
    ):
        high = HIGH - max(0.0, 0.05 * share - 0.001)
        assert position == pytest.approx([0.0, 0.0, high], abs=1e-12)
        assert along == pytest.approx(truss_force(high), abs=1e-9)
    (snapped,) = (event for event in phase.events if event.rule == "free")
    assert snapped.share == pytest.approx(0.62, abs=1e-11)
    assert phase.pose.position_m == pytest.approx([0.0, 0.0, -HIGH], abs=1e-9)
    assert drive.along == pytest.approx(0.0, abs=1e-12)
    assert phase.verdict == "rests"


@pytest.mark.parametrize("way", [0.012, 0.025, 0.05])
def test_the_work_of_a_drive_is_the_change_of_potential_and_what_snaps(way: float) -> None:
    (phase,) = truss(way).phases
    assert phase.drive is not None
    high = HIGH - (way - 0.001)
    is_through = high < 0.0
    assert phase.drive.work_j == pytest.approx(truss_energy(0.0 if is_through else high), rel=1e-9)
    assert phase.drive.snaps_j == pytest.approx(truss_energy(0.0) if is_through else 0.0, rel=1e-9)
    assert phase.drive.friction_j == 0.0

"""Jaws that close on a polygon turn it to a local least width, and are blocked there (Goldberg 1993)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from cagepose import Box, Cage, CageBody, Convex, Drive, Load, Object, Pose, Run, Scene, run
from cagepose.model.checks import FloatArray

HEIGHT, PAD, APART = 0.02, 0.01, 0.05
"""Of the part; and of the jaws: how thick, and how far their faces are from the middle at the start, metres."""
WAY = 0.045


def closing(corners: FloatArray, angle: float, friction: float = 0.0, table: float = 0.0) -> Run:
    """Jaws that close along x, by ``WAY`` each, on a prism on a table."""
    vertices = [(x, y, z) for x, y in corners for z in (-0.5 * HEIGHT, 0.5 * HEIGHT)]
    middle = Pose((0.0, 0.0, 0.5 * HEIGHT), euler_zyx=(angle, 0.0, 0.0))
    part = Object(shapes=[Convex(vertices, name="part")], mass_kg=1.0, pose=middle)
    below = Box((0.4, 0.4, 0.02), Pose((0.0, 0.0, -0.01)), "table")
    bodies = [
        CageBody(name, shapes=[Box((PAD, 0.3, 0.06), Pose((side * (APART + 0.5 * PAD), 0.0, 0.035)), f"{name} jaw")])
        for name, side in (("left", -1.0), ("right", 1.0))
    ]
    drive = {"left": Drive(travel=(WAY, 0.0, 0.0)), "right": Drive(travel=(-WAY, 0.0, 0.0))}
    load = Load("close", gravity=(0.0, 0.0, -9.81), drive=drive)
    cage = Cage(shapes=[below], bodies=bodies)
    return run(Scene(part, cage, [load], friction_coefficient=friction, friction_of={"table": table}))


def width(corners: FloatArray, angle: float) -> float:
    across = corners @ np.array([math.cos(angle), -math.sin(angle)])
    return float(np.ptp(across))


def least_width_beside(corners: FloatArray, angle: float) -> float:
    """The angle at which the width has the local minimum that lies downhill; there a side is flat on a jaw."""
    sides = np.diff(np.vstack([corners, corners[:1]]), axis=0)
    flat = np.pi / 2.0 - np.arctan2(sides[:, 1], sides[:, 0])  # turned by it, a side is along y
    way = 1.0 if width(corners, angle + 1e-6) < width(corners, angle) else -1.0
    step = 1e-7
    ahead = sorted((way * (one - angle) % math.pi, one) for one in flat)
    for off, _ in ahead:
        if off > step and width(corners, angle + way * (off + step)) > width(corners, angle + way * off):
            return angle + way * off
    raise AssertionError("a width has a minimum")


def assert_closed(found: Run, corners: FloatArray) -> None:
    """Blocked at the least width that lies downhill from where both jaws touched."""
    (phase,) = found.phases
    assert phase.verdict == "blocked"
    assert phase.drive is not None
    touched = next(
        event.pose_world_object.euler_zyx[0]
        for event in phase.events
        if {"left jaw", "right jaw"} <= set(event.contacts)
    )
    end = least_width_beside(corners, touched)
    yaw, pitch, roll = phase.pose.euler_zyx
    assert math.sin(yaw - end) == pytest.approx(0.0, abs=1e-7)
    assert max(abs(pitch), abs(roll)) < 1e-9
    least = width(corners, end)
    assert phase.drive.share * WAY == pytest.approx(APART - 0.5 * least, abs=1e-9)


@pytest.mark.parametrize("angle_deg", [-80.0, -40.0, -15.0, 5.0, 30.0, 60.0, 70.0])
def test_a_rectangle_is_turned_until_it_is_flat(angle_deg: float) -> None:
    """With its thin side across the jaws, or with its long one where the diagonal lies beyond."""
    rectangle = np.array([(-0.01, -0.02), (0.01, -0.02), (0.01, 0.02), (-0.01, 0.02)])
    assert_closed(closing(rectangle, math.radians(angle_deg)), rectangle)


def polygon(random: np.random.Generator) -> FloatArray:
    """The hull of a few points, about its centroid, 20 to 80 mm wide."""
    points = random.normal(size=(int(random.integers(4, 9)), 2))
    corners = points[ConvexHull(points).vertices]
    around = np.roll(corners, -1, axis=0)
    crosses = corners[:, 0] * around[:, 1] - corners[:, 1] * around[:, 0]
    corners = corners - ((corners + around) * crosses[:, None]).sum(axis=0) / (3.0 * crosses.sum())
    corners *= 0.04 / np.linalg.norm(corners, axis=1).max()
    return corners


@pytest.mark.parametrize("number", range(30))
def test_a_polygon_is_turned_to_a_local_least_width(number: int) -> None:
    random = np.random.default_rng(44)
    for _ in range(number + 1):
        corners, angle = polygon(random), float(random.uniform(-math.pi, math.pi))
    assert_closed(closing(corners, angle), corners)


HELD = [(0.1, 61.0), (0.3, -50.0), (0.3, 50.0), (0.3, 61.0), (0.3, 80.0), (0.6, 40.0), (0.6, 61.0), (0.6, 80.0)]
TURNED = [(0.1, 10.0), (0.1, 80.0), (0.3, 10.0), (0.3, 30.0), (0.3, 40.0), (0.6, 30.0)]


@pytest.mark.parametrize(("friction", "angle_deg"), [*HELD, *TURNED])
def test_rough_jaws_hold_a_rectangle_on_two_corners_within_their_friction(friction: float, angle_deg: float) -> None:
    """The table resists a little. Held is what two corners hold whose line is within atan mu of the jaws' normals; all
    else turns until it is flat.
    """
    angle = math.radians(angle_deg)
    outward = np.array([math.cos(angle), -math.sin(angle)])
    rectangle = np.array([(-0.01, -0.02), (0.01, -0.02), (0.01, 0.02), (-0.01, 0.02)])
    touching = rectangle[np.argmax(rectangle @ outward)]
    line = math.atan2(touching @ (math.sin(angle), math.cos(angle)), touching @ outward)
    is_held = abs(line) < math.atan(friction)
    assert is_held == ((friction, angle_deg) in HELD)
    found = closing(rectangle, angle, friction, table=0.1)
    if not is_held:
        assert_closed(found, rectangle)
        return
    (phase,) = found.phases
    assert phase.drive is not None
    assert phase.verdict == "jams"
    assert phase.pose.euler_zyx[0] == pytest.approx(angle, abs=1e-12)
    assert phase.drive.share * WAY == pytest.approx(APART - 0.5 * width(rectangle, angle), abs=1e-12)

"""The rail of the docs with any misalignment, play, spacing and pin: the parametric twin of ``scenes/rail-*.yaml``.

Dimensions: docs/theory, "The rail". All arguments are millimetres and degrees, as in the scene files.
"""

from __future__ import annotations

import math

import numpy as np

from cagepose import Box, Cage, Force, Load, Object, Pose, Run, Scene, Tolerances

MM = 1e-3
SIDE_PLAY_MM = 1.06


def rail_scene(
    *,
    yaw_deg: float = 0.0,
    pitch_deg: float = 0.0,
    roll_deg: float = 0.0,
    play_mm: float = 1.0,
    spacing_mm: float = 183.0,
    cog_y_mm: float = 0.0,
    pin_y_mm: float = 20.0,
    touch: float | None = None,
) -> Scene:
    """Build the scene; the object starts at the cage's pose."""
    boxes = [
        ("left guide", (1200, 4, 1), (0, 32.05, 0)),
        ("right guide", (1200, 4, 1), (0, -32.05, 0)),
        ("body", (1200, 80, 40), (0, 0, -40)),
        ("rack", (20, 10, 30), (0, 0, -5)),
        ("left web", (1200, 0.5, 6), (0, 30.30, 0)),
        ("right web", (1200, 0.5, 6), (0, -30.30, 0)),
    ]
    x, z = spacing_mm / 2.0, 0.5 + play_mm / 2.0
    points = [(sx * x, sy * 31.55, sz * z) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    points += [(sx * x, sy * 29.52, 0.0) for sx in (-1, 1) for sy in (-1, 1)]
    points += [(11.0, 0.0, 0.0), (-11.0, 0.0, 0.0)]
    pose = Pose(euler_zyx=np.radians([yaw_deg, pitch_deg, roll_deg]))
    return Scene(
        Object(
            [Box(np.array(size) * MM, Pose(np.array(at) * MM), name) for name, size, at in boxes],
            np.array([100.0, cog_y_mm, -20.0]) * MM,
            pose=pose,
        ),
        Cage(np.array(points) * MM, pose=pose),
        [
            Load("gravity", gravity=(0, 0, -1)),
            Load("push", force=Force((1, 0, 0), np.array([-600.0, pin_y_mm, -60.747]) * MM)),
        ],
        name="rail",
        tolerances=None if touch is None else Tolerances(touch=touch),
    )


def exact_tilt_deg(play_mm: float, spacing_mm: float) -> float:
    """Tilt at which a plate 1 mm thick touches above and below at rollers ``spacing`` apart.

    The plate has turned by t about the mid-line of the rollers and the drop cancels: with half the gap g/2 = (1 +
    play)/2 and half the spacing l/2, a roller at (l/2, g/2) lies on the face z = 1/2 of the plate if (g/2) cos t -
    (l/2) sin t = 1/2.
    """
    half_gap, half_spacing = (1.0 + play_mm) / 2.0, spacing_mm / 2.0
    radius = math.hypot(half_gap, half_spacing)
    return math.degrees(math.acos(0.5 / radius) - math.atan2(half_spacing, half_gap))


def tilt_deg(run: Run, phase: int) -> float:
    """Angle of the object's z axis in the cage's xz plane, atan2(n_x, n_z), at the end of a phase."""
    axis_world = run.phases[phase].pose.rotation[:, 2]
    n = run.scene.cage.pose_world_cage.rotation.T @ axis_world
    return math.degrees(math.atan2(n[0], n[2]))

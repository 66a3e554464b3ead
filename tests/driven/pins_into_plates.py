"""Pins that are driven down into holes of a plate, which lies loose on a smooth table: all is known by hand.

A pin that stands beside its hole meets the chamfer up to where that ends: the play and the chamfer's width are how far
it may be off. Its plate then slides over, since nothing but the table holds it. Beyond, it stands on the plate, and
the drive is blocked.
"""

from __future__ import annotations

import numpy as np

from cagepose import Box, Cage, CageBody, Chamfer, Cylinder, Drive, Hole, Load, Object, Pose, Scene

MM = 1e-3
RADIUS, PLAY, CHAMFER = 5.0, 0.05, 0.8
"""Of a pin, between it and its hole, and the width of the chamfer, mm."""
DOWN = (0.0, 0.0, -9.81)


def pins_into_a_plate(
    places_mm: tuple[float, ...] = (0.0,),
    *,
    chamfer: float = CHAMFER,
    wall_mm: float | None = None,
    at_mm: tuple[float, float] = (0.0, 0.0),
) -> Scene:
    """Pins at places along x, 1 mm above a plate 20 mm thick and 120 mm long, go 9 mm down. A wall stands beside the
    plate on the side of +y, if it is asked for, so far away. Plate and pins stand elsewhere on the table, if asked to.
    """
    depth, cut = 15.0 * MM, None if chamfer == 0.0 else Chamfer(chamfer * MM, np.pi / 4)
    holes = [
        Hole((RADIUS + PLAY) * MM, depth, cut, ["plate"], Pose(np.array([x, 0.0, 20.0]) * MM), f"hole {x:g}")
        for x in places_mm
    ]
    plate = Object(
        [Box(np.array([120.0, 40.0, 20.0]) * MM, Pose((0.0, 0.0, 10.0 * MM)), "plate")],
        holes=holes,
        mass_kg=1.0,
        pose=Pose(np.array([*at_mm, 0.0]) * MM),
    )
    table = Box(np.array([400.0, 400.0, 20.0]) * MM, Pose((0.0, 0.0, -10.0 * MM)), "table")
    shapes = [table]
    if wall_mm is not None:
        middle = np.array([0.0, 20.0 + wall_mm + 10.0, 20.0]) * MM
        shapes.append(Box(np.array([400.0, 20.0, 40.0]) * MM, Pose(middle), "wall"))
    pins = [Cylinder(RADIUS * MM, 30.0 * MM, Pose(np.array([x, 0.0, 15.0]) * MM), f"pin {x:g}") for x in places_mm]
    head = CageBody("head", shapes=pins, pose=Pose(np.array([*at_mm, 21.0]) * MM))
    load = Load("press", gravity=DOWN, drive={"head": Drive(travel=(0.0, 0.0, -9.0 * MM))})
    return Scene(plate, Cage(shapes=shapes, bodies=[head]), [load], friction_coefficient=0.0, name="pins into a plate")

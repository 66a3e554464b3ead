"""Grips that are too weak: pads that press on a block are driven along it, and slip."""

from __future__ import annotations

import math

from cagepose import Box, Cage, CageBody, Drive, Load, Object, Pose, Press, Scene

GRAVITY = 9.81
FORCE_N = 12.0
LIFT_M = 0.005
"""So far, the pads stay on the block."""


def slipping(
    mass_kg: float,
    friction: float,
    *,
    sides: int = 2,
    slope_deg: float = 0.0,
    off_m: tuple[float, float] = (0.0, 0.0),
    of_left: float | None = None,
    lift_m: float = LIFT_M,
) -> Scene:
    """A block of 20 mm lies on a table, or a slope about y, between pads, each of 12 mm by 16 mm: one stands and one
    presses with 12 N, or each of ``sides`` presses; then all of them are driven along their faces, away from the table.
    """
    up = (math.sin(math.radians(slope_deg)), 0.0, math.cos(math.radians(slope_deg)))
    weight = (-GRAVITY * up[0], 0.0, -GRAVITY * up[2])
    directions = [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0)][:sides]
    bodies, press, lift = [], {}, {}
    for number, (x, y) in enumerate(directions):
        size = (0.01, 0.012, 0.016) if y == 0.0 else (0.012, 0.01, 0.016)
        at = (0.015 * x + off_m[0] * abs(y), 0.015 * y + off_m[0] * abs(x), off_m[1])
        bodies.append(CageBody(f"jaw {number}", shapes=[Box(size, Pose(at), f"pad {number}")]))
        lift[f"jaw {number}"] = Drive((0.0, 0.0, lift_m))
        if number > 0 or sides > 2:
            press[f"jaw {number}"] = Press((-x, -y, 0.0), FORCE_N)
    block = Object(shapes=[Box((0.02, 0.02, 0.02), name="block")], mass_kg=mass_kg)
    table = Box((0.2, 0.2, 0.01), Pose((0.0, 0.0, -0.015)), "table")
    loads = [Load("close", gravity=weight, press=press), Load("lift", gravity=weight, press=press, drive=lift)]
    own = {} if of_left is None else {"pad 0": of_left}
    return Scene(block, Cage(shapes=[table], bodies=bodies), loads, friction_coefficient=friction, friction_of=own)

"""Prisms of boxes between opposite points without play: bars, angles, T-, I- and U-sections, and two bars side by side.

Faces that look at each other, as in a fork or a slot, open to second order where those of a plate close.
"""

from __future__ import annotations

import numpy as np

from audit.draws import MM, Rng
from cagepose import Box, Cage, Load, Object, Pose, Scene

STOP_AHEAD_MM = 3.0
PAIRS, PLACES_TRIED = 3, 60


def prism(rng: Rng) -> Scene:
    """Between one to three pairs, on a slope along the prism: it slides out."""
    return _prism(rng, False, on_edges=False)


def stopped_prism(rng: Rng) -> Scene:
    """The same with two stops 3 mm ahead of its first bar, at which it can come to rest, or turn on."""
    return _prism(rng, True, on_edges=False)


def edge_prism(rng: Rng) -> Scene:
    """With or without stops, and half of the pairs on edges."""
    return _prism(rng, bool(rng.integers(2)), on_edges=True)


def _prism(rng: Rng, is_stopped: bool, *, on_edges: bool) -> Scene:
    section, length = _section(rng), float(rng.choice([60, 80, 100]))
    points = []
    for _ in range(int(rng.integers(1, PAIRS + 1))):
        along = float(rng.choice([0, 10, -10, 20, rng.uniform(-25, 25)]))
        points += [[along, *place] for place in _opposite(rng, section, on_edges)]
    if is_stopped:
        low, high, bottom, top = section[0]
        sides = (0.75 * low + 0.25 * high, 0.25 * low + 0.75 * high)
        points += [[length / 2 + STOP_AHEAD_MM, y, (bottom + top) / 2] for y in sides]
    boxes = [
        Box(np.array([length, high - low, top - bottom]) * MM, Pose(np.array([0, low + high, bottom + top]) / 2 * MM))
        for low, high, bottom, top in section
    ]
    center = [rng.choice([0, 5, 20, -20]), rng.choice([0, 0, 3]), rng.choice([0, 0, -4])]
    across = [[0, -1], [1, 0], [0, 0], list(rng.normal(size=2))][int(rng.integers(4))]
    slopes = [0.02, 0.1, 1.0] if is_stopped else [0.001, 0.02, 0.1, 1.0]  # the least play tips what is stopped by 1e-3
    down = np.array([rng.choice(slopes), *across])
    turn = Pose(rng.uniform(-20, 20, 3) * MM, rng.normal(size=4)) if rng.random() < 0.3 else Pose()
    held = Object(boxes, np.array(center) * MM, pose=turn)
    load = Load("weight", gravity=turn.rotation @ down)
    return Scene(held, Cage(turn.transform(np.array(points) * MM)), [load], friction_coefficient=0.0)


def _section(rng: Rng) -> list[tuple[float, float, float, float]]:
    """Rectangles (low, high, bottom, top) of a section, millimetres."""
    w, h = rng.choice([20.0, 24.0, 30.0, 40.0], 2) / 2
    t = float(rng.choice([4.0, 5.0, 6.0]))
    bottom, left = (-w, w, -h, t - h), (-w, t - w, t - h, h)
    top, right = (-w, w, h - t, h), (w - t, w, t - h, h)
    web = (-t / 2, t / 2, t - h, h - t)
    sections = [
        [(-w, w, -h, h)],
        [bottom, left],
        [top, (-t / 2, t / 2, -h, h - t)],
        [bottom, web, top],
        [bottom, left, right],
        [(-w, -t / 2, -h / 4, h / 4), (t / 2, w, -h / 4, h / 4)],
    ]
    return sections[int(rng.integers(len(sections)))]


def _opposite(rng: Rng, section: list[tuple[float, float, float, float]], on_edges: bool) -> list[tuple[float, float]]:
    """Two places on faces that look opposite ways, of one bar or of two, on one line where that can be."""
    for _ in range(PLACES_TRIED):
        axis = int(rng.integers(2))
        one, other = (section[k] for k in rng.integers(len(section), size=2))
        across = 2 - 2 * axis
        share = float(rng.choice([*([0, 1, 0.5] if on_edges else [0.25, 0.5, 0.75]), rng.uniform(0.1, 0.9)]))
        at = one[across] + share * (one[across + 1] - one[across])
        opposite = at
        if not (other[across] <= at <= other[across + 1] if on_edges else other[across] < at < other[across + 1]):
            opposite = other[across] + share * (other[across + 1] - other[across])
        places = [(one[2 * axis], at, -1.0), (other[2 * axis + 1], opposite, 1.0)]
        found = [(p, q) if axis == 0 else (q, p) for p, q, _ in places]
        outside = [(p + side * 1e-3, q) if axis == 0 else (q, p + side * 1e-3) for p, q, side in places]
        if not any(low < y < high and bottom < z < top for y, z in outside for low, high, bottom, top in section):
            return found
    raise ValueError("a section without opposite faces")

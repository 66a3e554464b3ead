"""Bodies turned from profiles with arcs, as triangles that stand for planes, cylinders, cones, balls and tori."""

from __future__ import annotations

import math

import numpy as np

from boundary.prisms import Corner, _steps, _turn
from cagepose import Facets
from cagepose.model.surfaces import CONE, CYLINDER, PLANE, SPHERE, TORUS, Surface

AROUND = 64
UP = (0.0, 0.0, 1.0)


def turned(profile: list[Corner], name: str = "turned") -> Facets:
    """Return what a profile (rho, z) makes that turns about z. It leads around the material counter-clockwise as rho is
    drawn to the right and z up; one that begins and ends on the axis is closed by that.
    """
    is_open = profile[0].at[0] == 0.0 and profile[-1].at[0] == 0.0
    points, sides, surfaces = list[np.ndarray](), list[int](), list[Surface]()
    for k, corner in enumerate(profile[:-1] if is_open else profile):
        start, end = np.array(corner.at), np.array(profile[(k + 1) % len(profile)].at)
        surfaces.append(_surface(corner, start, end))
        steps = _steps(corner, start, end)
        points += steps
        sides += [k] * len(steps)
    if is_open:
        points.append(np.array(profile[-1].at))
    angles = 2.0 * math.pi * np.arange(AROUND) / AROUND
    vertices, rings = list[tuple[float, float, float]](), list[np.ndarray]()
    for rho, z in points:
        around = angles if rho > 0.0 else angles[:1]
        first = len(vertices)
        vertices += [(float(rho * math.cos(t)), float(rho * math.sin(t)), float(z)) for t in around]
        rings.append(first + np.arange(AROUND) % len(around))
    triangles, on = list[tuple[int, int, int]](), list[int]()
    for k, side in enumerate(sides):
        low, high = rings[k].tolist(), rings[(k + 1) % len(rings)].tolist()
        for t in range(AROUND):
            u = (t + 1) % AROUND
            for corners in ((low[t], low[u], high[u]), (low[t], high[u], high[t])):
                if len(set(corners)) == 3:
                    triangles.append(corners)
                    on.append(side)
    return Facets(np.array(vertices), np.array(triangles), None, None, name, surfaces, on)


def _surface(corner: Corner, start: np.ndarray, end: np.ndarray) -> Surface:
    if corner.center is not None:
        rho, z = corner.center
        radius = math.copysign(math.hypot(*(start - corner.center)), _turn(corner, start, end))
        if rho == 0.0:
            return Surface(SPHERE, (0.0, 0.0, z), (0.0, 0.0, 0.0), radius)
        return Surface(TORUS, (0.0, 0.0, z), UP, radius, core_m=rho)
    along, rise = (end - start).tolist()
    if rise == 0.0:
        return Surface(PLANE, (0.0, 0.0, float(start[1])), (0.0, 0.0, -math.copysign(1.0, along)))
    wide = start if start[0] >= end[0] else end
    radius = math.copysign(float(wide[0]), rise)
    kind = CYLINDER if along == 0.0 else CONE
    return Surface(kind, (0.0, 0.0, float(wide[1])), UP, radius, along / rise)


def rounded_rod(radius: float, length: float, rim: float, name: str = "rod") -> Facets:
    """Return a rod along z, its middle at zero, whose rims are rounded."""
    half, core = length / 2.0, radius - rim
    corners = [
        Corner((0.0, -half)),
        Corner((core, -half), (core, rim - half)),
        Corner((radius, rim - half)),
        Corner((radius, half - rim), (core, half - rim)),
        Corner((core, half)),
        Corner((0.0, half)),
    ]
    return turned(corners, name)


def rounded_hole(radius: float, rim: float, wide: float, thick: float, name: str = "plate") -> Facets:
    """Return a round plate below z = 0 with a hole along z, whose upper mouth is rounded."""
    corners = [
        Corner((radius, -thick)),
        Corner((wide, -thick)),
        Corner((wide, 0.0)),
        Corner((radius + rim, 0.0), (radius + rim, -rim)),
        Corner((radius, -rim)),
    ]
    return turned(corners, name)


def ring(core: float, tube: float, name: str = "ring") -> Facets:
    """Return a whole torus."""
    corners = [
        Corner((core, -tube), (core, 0.0)),
        Corner((core + tube, 0.0), (core, 0.0)),
        Corner((core, tube), (core, 0.0)),
        Corner((core - tube, 0.0), (core, 0.0)),
    ]
    return turned(corners, name)

"""A phase's end seen along its load: the polygon of the contacts, and where the load's line passes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import FloatArray, unit_vector
from cagepose.runs.actions import wrench_at
from cagepose.runs.driven_cage import cage_at_end
from cagepose.runs.drives import displaced_after
from cagepose.runs.run import Run
from cagepose.studies.arcs import places_on_arcs
from cagepose.studies.tolerances import PARALLEL_SINE, ROUNDING_OF_CORNER


@dataclass(frozen=True, eq=False)
class LoadView:
    """What someone sees who looks along the load, in metres.

    Attributes
    ----------
    right_world, up_world
        Unit vectors of the picture's axes, (3,). Under gravity along -z these are x and y: a view from above.
    load_point
        Where the load's line passes, (2,).
    polygon
        Corners of the convex hull of the contacts, counter-clockwise, (n, 2); of arcs along which parts touch, places
        every 3 degrees.
    margin_m
        Distance of the load's line from the hull's outline: above zero inside, below zero outside. A hull without area
        has no inside.
    """

    right_world: FloatArray
    up_world: FloatArray
    load_point: FloatArray
    polygon: FloatArray
    margin_m: float

    def project(self, points_world: FloatArray) -> FloatArray:
        """Return points of the world, (n, 3), in the picture, (n, 2)."""
        return points_world @ np.stack([self.right_world, self.up_world], axis=1)


def load_view(run: Run, phase_index: int) -> LoadView:
    """Look along the load of a phase at the pose where the phase ended.

    Raises
    ------
    ValueError
        The forces of the load cancel, so that it has no direction.
    """
    phase, (direction, through) = run.phases[phase_index], _load_line(run, phase_index)
    # The picture's vertical is y for a vertical load, else z: the world as people draw it.
    vertical = np.array([0.0, 1.0, 0.0]) if abs(direction[2]) > 0.9 else np.array([0.0, 0.0, 1.0])
    up = unit_vector(vertical - (vertical @ direction) * direction, "up")
    right = np.cross(direction, up) + 0.0  # no negative zeros
    axes = np.stack([right, up], axis=1)
    load_point = through @ axes
    names = {contact.point for contact in phase.contacts}
    touching = [index for index, name in enumerate(run.scene.cage.names) if name in names]
    on_shapes = [
        contact.place_world
        for contact in (*phase.contacts, *places_on_arcs(run, phase_index))
        if contact.point not in run.scene.cage.names and contact.place_world is not None
    ]
    points_world = cage_at_end(run, phase_index).points_world
    places = np.concatenate([points_world[touching], np.reshape(on_shapes, (-1, 3))])
    polygon = convex_hull(places @ axes)
    return LoadView(right, up, load_point, polygon, _margin(polygon, load_point))


def _load_line(run: Run, phase_index: int) -> tuple[FloatArray, FloatArray]:
    """Return the direction of the load at the end of a phase, (3,), and a point of its line in the world, metres.

    Of a weight and one force the force counts, as for the stepwise method; else it is the line along which the moment
    of all that acts is least.
    """
    scene, load, pose = run.scene, run.scene.loads[phase_index], run.phases[phase_index].pose
    center = scene.object.center_of_gravity_m
    if load.is_weight_alone:
        assert load.gravity_world is not None
        return unit_vector(load.gravity_world, "gravity"), pose.transform(center)
    push = load.force
    if push is not None and push.at_object_m is not None and not load.needs_newtons and not push.follows:
        return push.direction, pose.transform(push.at_object_m)
    force, moment = wrench_at(scene, phase_index, pose, displaced_after(run, phase_index))
    square = float(force @ force)
    if square == 0.0:
        raise ValueError(f"what acts in phase {load.name!r} has no direction: its forces cancel")
    return force / math.sqrt(square), pose.transform(center) + np.cross(force, moment) / square


def convex_hull(points: FloatArray) -> FloatArray:
    """Return the corners of the convex hull of points in a plane, (n, 2), counter-clockwise (Andrew's algorithm).

    >>> convex_hull(np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 0.5], [1.0, 2.0]])).tolist()
    [[0.0, 0.0], [2.0, 0.0], [1.0, 2.0]]
    """
    ordered = sorted({(x, y) for x, y in points.tolist()})
    if len(ordered) < 3:
        return np.array(ordered).reshape(-1, 2)
    chains = []
    for sequence in (ordered, ordered[::-1]):
        chain: list[tuple[float, float]] = []
        for point in sequence:
            while len(chain) >= 2 and _turns_left(chain[-2], chain[-1], point) <= 0.0:
                chain.pop()
            chain.append(point)
        chains += chain[:-1]
    return np.array(chains)


def polygon_within(normals: FloatArray, heights: FloatArray) -> FloatArray:
    """Return the corners of all points p, (n, 2), with normals p <= heights: those crossings of two lines that no third
    one cuts off, counter-clockwise. ``normals`` are unit vectors, (m, 2).

    >>> polygon_within(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]), np.array([2.0, 1, 0, 0])).tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
    """
    first, second = np.triu_indices(len(normals), 1)
    is_crossing = np.abs(_cross(normals[first], normals[second])) > PARALLEL_SINE
    first, second = first[is_crossing], second[is_crossing]
    pairs = np.stack([normals[first], normals[second]], axis=1)
    crossings = np.linalg.solve(pairs, np.stack([heights[first], heights[second]], axis=1)[:, :, None])[:, :, 0]
    within = (crossings @ normals.T <= heights + ROUNDING_OF_CORNER * np.abs(heights).max()).all(axis=1)
    return without_doubles(convex_hull(crossings[within] + 0.0), 10.0 * ROUNDING_OF_CORNER * np.abs(heights).max())


def without_doubles(corners: FloatArray, distance: float) -> FloatArray:
    """Return the corners of a polygon but those within a distance of the one before them."""
    is_far = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1) > distance
    return corners[is_far] if is_far.any() else corners[:1]


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    crossed: FloatArray = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return crossed


def _turns_left(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _margin(polygon: FloatArray, point: FloatArray) -> float:
    if len(polygon) == 0:
        return -np.inf
    ends = np.roll(polygon, -1, axis=0)
    along, to_point = ends - polygon, point - polygon
    squares = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    fractions = np.clip((along * to_point).sum(axis=1) / squares, 0.0, 1.0)
    distance = float(np.linalg.norm(to_point - fractions[:, None] * along, axis=1).min())
    crossing = along[:, 0] * to_point[:, 1] - along[:, 1] * to_point[:, 0]
    return distance if len(polygon) > 2 and (crossing > 0.0).all() else -distance

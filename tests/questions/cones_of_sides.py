"""Linear programs over forces in friction cones of 64 sides, solved by SciPy's HiGHS: what the contacts of a run can
balance. Shares nothing with the kernels but the contacts.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from cagepose import Run

SIDES = 64
OUTER = 1.0 / math.cos(math.pi / SIDES)
"""Radius of the corners of the sides that are around a circle; inside they are at 1."""


def is_balanced(a_run: Run, friction: float, radius: float) -> bool:
    """Whether forces within cones whose corners are at ``radius`` times the friction balance the load."""
    rays = _rays(a_run, friction * radius)
    found = linprog(np.zeros(len(rays)), A_eq=rays.T, b_eq=-_load(a_run), bounds=(0.0, None))
    return bool(found.status == 0)


def greatest_extra(
    a_run: Run, direction: NDArray[np.float64], at_object_m: NDArray[np.float64], friction: float, radius: float
) -> float:
    """Return the greatest force along a direction, in the load's unit, that they balance beside the load; inf: any."""
    rays = _rays(a_run, friction * radius)
    end = a_run.phases[-1].pose
    extra = _wrench(a_run, direction, end.transform(at_object_m))
    found = linprog(-np.eye(len(rays) + 1)[0], A_eq=np.vstack([extra, rays]).T, b_eq=-_load(a_run), bounds=(0.0, None))
    return math.inf if found.status == 3 else float(-found.fun)


def _rays(a_run: Run, friction: float) -> NDArray[np.float64]:
    rays = []
    for contact in a_run.phases[-1].contacts:
        normal, place = -contact.normal_world, contact.place_world
        assert place is not None
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        for angle in 2.0 * np.pi * np.arange(SIDES) / SIDES:
            across = math.cos(angle) * first + math.sin(angle) * np.cross(normal, first)
            rays.append(_wrench(a_run, normal + friction * across, place))
    return np.array(rays)


def _load(a_run: Run) -> NDArray[np.float64]:
    """Return the load of one force, or of a weight alone, of 1."""
    load, pose = a_run.scene.loads[-1], a_run.phases[-1].pose
    if load.force is None:
        assert load.gravity_world is not None
        return np.append(load.gravity_world / np.linalg.norm(load.gravity_world), np.zeros(3))
    return _wrench(a_run, load.force.direction, pose.transform(load.force.at_object(pose)))


def _wrench(a_run: Run, force: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    center = a_run.phases[-1].pose.transform(a_run.scene.object.center_of_gravity_m)
    return np.concatenate([force, np.cross(place - center, force) / a_run.scene.size_m])

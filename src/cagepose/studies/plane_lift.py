"""A first step away from all that the object touches at its start, in the plane: `lifted`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.runs.run import Motion
from cagepose.studies.cage_verdict import PathStep
from cagepose.studies.plane_cells import Cells
from cagepose.studies.plane_frame import InPlane, PlaneFrame

LONGEST, HALVINGS = 1e-3, 20
"""Of the object's reach: how far it goes at most; and how often it is tried half as far."""
LEAST_RATE = 0.02
"""Of how far the object goes: so fast each contact opens at least."""
ALONG_THE_WAY = 8
"""Places of the step at which it is asked whether nothing touches."""
N_AROUND, N_TURNS = 360, 41
"""Directions of travel that are tried, and with each so many shares of a turn."""


class Lift(NamedTuple):
    """Where the object is free, and the motion that leads there; None: it is free at its start."""

    end: InPlane
    step: PathStep | None


def lifted(cells: Cells) -> Lift | None:
    """Return a pose beside the start at which the object is free; None: none was found, as where it fits exactly.

    The motion is one along which each contact opens at once, and the faster the better; travels are tried first.
    """
    frame, start = cells.frame, cells.frame.start
    touching = cells.touching(start)
    if not len(touching.places_world):
        return Lift(start, None)
    normals, arms = touching.normals_world, touching.places_world - frame.place(start)
    # How fast each contact opens, for a unit travel along either axis, and a unit turn at the object's reach.
    rates = -np.concatenate([normals[:, frame.axes], (np.cross(arms, normals) @ frame.normal)[:, None]], axis=1)
    rates[:, 2] /= frame.reach_m
    around = np.linspace(0.0, 2.0 * math.pi, N_AROUND, endpoint=False)
    travels = np.stack([np.cos(around), np.sin(around), np.zeros(N_AROUND)], axis=1)
    shares = np.linspace(-1.0, 1.0, N_TURNS)[:, None, None]
    screws = np.sqrt(1.0 - shares**2) * travels + shares * np.array((0.0, 0.0, 1.0))
    for ways in (travels, screws.reshape(-1, 3)):
        slowest = (ways @ rates.T).min(axis=1)
        best = int(slowest.argmax())
        if slowest[best] >= LEAST_RATE:
            return _along(cells, ways[best])
    return None


def _along(cells: Cells, way: FloatArray) -> Lift | None:
    """Return where a motion leads at most that opens all contacts; None: something else is too near."""
    frame, distance_m = cells.frame, LONGEST * cells.frame.reach_m
    for _ in range(HALVINGS):
        shares = np.arange(1, ALONG_THE_WAY + 1) / ALONG_THE_WAY
        ends = [_moved(frame, way, share * distance_m) for share in shares.tolist()]
        if all(cells.gap_m(end, distance_m) > 0.0 for end, _ in ends):
            end, motion = ends[-1]
            return Lift(end, PathStep(motion, frame.pose(end)))
        distance_m *= 0.5
    return None


def _moved(frame: PlaneFrame, way: FloatArray, distance_m: float) -> tuple[InPlane, Motion]:
    """Return the pose after a travel, or a turn about a line, that begins along a way, and it."""
    travel, rate = np.zeros(3), float(way[2]) / frame.reach_m
    travel[frame.axes] = way[:2]
    start = frame.place(frame.start)
    if rate == 0.0:
        end = start + distance_m * travel
        return frame.at(end, 0.0), Motion("travel", travel, None, None, distance_m, 0.0)
    through, angle = start + np.cross(frame.normal, travel) / rate, rate * distance_m
    arm = start - through
    end = through + math.cos(angle) * arm + math.sin(angle) * np.cross(frame.normal, arm)
    axis = math.copysign(1.0, rate) * frame.normal
    return frame.at(end, angle), Motion("turn", None, axis, through, 0.0, abs(angle))

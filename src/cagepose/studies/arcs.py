"""Arcs along which parts touch at the end of a phase, as of a rim that lies flat or a ball in a round hole: `Arcs`.

A run lists some places of each. All others are asked of the kernel that it asks itself.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.contact.on_circle import find_deepest_on_arcs, place_on_circle
from cagepose.kernels.native.slots import Slots
from cagepose.model.checks import FloatArray, as_vector
from cagepose.runs.cases import greatest_friction
from cagepose.runs.judge import judged_workspace
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Run

PLACES_AROUND = 128
"""In pictures a whole circle has so many places. A polygon of so many corners is 0.03 % within it."""


class Places(NamedTuple):
    """Places along arcs.

    Attributes
    ----------
    arms
        As seen from the centre of gravity, (n, 3), metres.
    normals
        Outward unit normals of the object, (n, 3).
    friction
        Coefficients, (n,).
    """

    arms: FloatArray
    normals: FloatArray
    friction: FloatArray


class Arcs:
    """The arcs at the end of a phase, in the world.

    Attributes
    ----------
    rows
        Indices of the contacts of the run's problem that are places of an arc, (n,).
    """

    def __init__(self, run: Run, phase: int) -> None:
        scene, pose = run.scene, run.phases[phase].pose
        self._center = pose.transform(scene.object.center_of_gravity_m)
        self.rows: NDArray[np.int64] = np.zeros(0, np.int64)
        if not scene.has_other_shapes:
            return
        of_scene = chosen_method(scene, run.method).friction(scene)
        at, _ = judged_workspace(scene, pose, phase, of_scene)
        self._contacts, self._greatest = at.contacts, greatest_friction(scene, of_scene)
        n_contacts = int(self._contacts.used[0])
        lengths = [self._contacts.bends[row].on_circle.length for row in range(n_contacts)]
        self.rows = np.flatnonzero(np.array(lengths))
        self._slots = Slots(self._contacts)
        self._arms, self._normals = np.zeros((2, n_contacts, 3))

    def deepest(self, velocity: FloatArray, spin: FloatArray) -> Places:
        """Return of each arc the place that resists a motion most, if it is none that is listed.

        Parameters
        ----------
        velocity, spin
            Of the centre of gravity, and angular, (3,), metres and radians for one unit of time.
        """
        if len(self.rows) == 0:
            return Places(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))
        find_deepest_on_arcs(
            self._slots, self._greatest, as_vector(velocity), as_vector(spin), self._arms, self._normals
        )
        rows = self.rows[np.isfinite(self._arms[self.rows, 0])]
        friction = np.array([self._friction(row) for row in rows.tolist()])
        return Places(self._arms[rows], self._normals[rows], friction)

    def _friction(self, row: int) -> float:
        return self._greatest * float(np.linalg.norm(self._contacts.rows[row].directions[1]))

    def places_world(self) -> FloatArray:
        """Return places all along the arcs, (n, 3), metres."""
        found = [np.zeros(3)][:0]
        for row in self.rows.tolist():
            around = self._contacts.bends[row].on_circle
            n_places = 1 + math.ceil((around.before + around.after) * PLACES_AROUND / (2.0 * math.pi))
            for angle in np.linspace(-around.before, around.after, n_places).tolist():
                found.append(self._center + place_on_circle(self._contacts, row, angle)[0])
        return np.reshape(found, (-1, 3))

"""Where the object touches the cage at any moment: `TouchFinder`, for pictures of what goes on in a run."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.boundary.features import body_of, place_boundary
from cagepose.kernels.boundary.geometry import Placement, empty_placement, place_object
from cagepose.kernels.native.slots import Slots
from cagepose.model.checks import FloatArray
from cagepose.model.geometry import placed_bodies
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.driven_cage import CageAt


class PlacesOfContact(NamedTuple):
    """Where n pairs of parts touch.

    Attributes
    ----------
    elements
        Indices of the cage's points and shapes, points first, (n,).
    parts
        Indices of the object's parts, (n,).
    places_world
        Metres, (n, 3).
    normals_world
        Outward unit normals of the object, (n, 3).
    """

    elements: NDArray[np.int64]
    parts: NDArray[np.int64]
    places_world: FloatArray
    normals_world: FloatArray

    def chosen(self, which: NDArray[np.bool_]) -> PlacesOfContact:
        """Return those pairs of which ``which``, (n,), says so."""
        places, normals = self.places_world[which], self.normals_world[which]
        return PlacesOfContact(self.elements[which], self.parts[which], places, normals)


class TouchFinder:
    """Finds contacts of one scene, at pose after pose, in the same memory.

    Attributes
    ----------
    geometry, placement
        What kernels take: the two boundaries, and memory for the object at one pose.
    """

    def __init__(self, scene: Scene) -> None:
        geometry = scene.geometry._replace(placed=placed_bodies(scene.cage, scene.geometry.cage))
        held, cage = np.asarray(geometry.held.features), np.asarray(geometry.cage.own.features)
        self._parts, self._cage_parts = np.array(held["part"]), np.array(cage["part"])
        self._scene, self._placed = scene, geometry
        self._displaced = (Pose(),) * (1 + len(scene.cage.bodies))
        self.geometry = Slots(geometry)
        self._placement: Placement = empty_placement(geometry)
        self.placement = Slots(self._placement)

    def at(self, pose_world_object: Pose, cage: CageAt) -> PlacesOfContact:
        """Return what touches, within the scene's touch tolerance, with the object at a pose and the bodies of the cage
        where they are.
        """
        self._place_bodies(cage)
        place_object(self.geometry, *pose_world_object.as_tuples(), self.placement)
        placement = self._placement
        every: Any = placement.memory.rows
        of_bodies = zip(placement.first_rows.tolist(), placement.counts[:, 0].tolist(), strict=False)
        rows = np.concatenate([every[first : first + max(used, 0)] for first, used in of_bodies])
        # The object's own point; the cage's is within the touch tolerance of it.
        return PlacesOfContact(
            self._cage_parts[rows["cage_feature"]],
            self._parts[rows["feature"]],
            np.array(rows["place"]),
            np.array(rows["normal"]),
        )

    def _place_bodies(self, cage: CageAt) -> None:
        """Place those bodies of the cage that are elsewhere than when they were last asked for."""
        start = self._scene.cage.pose_world_cage
        for body, (before, now) in enumerate(zip(self._displaced, cage.displaced, strict=True)):
            if now is not before:
                placed = body_of(self._placed.cage, self._placed.placed, body)
                place_boundary(placed, *(now @ start).as_tuples())
        self._displaced = cage.displaced

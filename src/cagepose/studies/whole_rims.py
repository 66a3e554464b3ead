"""Rims that lie on a face all around, of which a run lists eight places: `more_places`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.shapes.meeting import SAME_PLACE
from cagepose.kernels.shapes.rims import ARCS
from cagepose.model.checks import FloatArray
from cagepose.model.parts import Object
from cagepose.model.scene import Scene
from cagepose.model.shapes import Turned
from cagepose.runs.run import Contact, PhaseRun

PLACES = 128
"""Of a rim: a polygon of so many corners is 0.03 % within it."""
PROBE = 10.0
"""In touch tolerances: so far below a face is asked whether there is material."""
FLAT = 1e-6
"""Sine of the angle between an axis and the normal of a face that the rim lies on."""


def more_places(scene: Scene, ended: PhaseRun) -> list[Contact]:
    """Return further contacts on rims of which all places that a run lists touch at the end of a phase."""
    found = list[Contact]()
    for contacts in _by_pair(ended.contacts):
        for center, radius, axis, own in _rims(scene, ended, contacts[0]):
            on_rim = [contact for contact in contacts if _is_on(contact, center, radius, axis, scene.touch_m)]
            if len(on_rim) < ARCS:
                continue
            first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
            first *= radius / float(np.linalg.norm(first))
            angles = 2.0 * np.pi * np.arange(PLACES) / PLACES
            places = center + np.outer(np.cos(angles), first) + np.outer(np.sin(angles), np.cross(axis, first))
            on_other = _lie_on_other(scene, ended, on_rim[0], own, places)
            found += [replace(on_rim[0], place_world=place) for place in places[on_other]]
            break
    return found


def _lie_on_other(
    scene: Scene, ended: PhaseRun, contact: Contact, own: str | None, places: FloatArray
) -> NDArray[np.bool_]:
    """Return which places (n, 3) of a rim of the part ``own`` lie on the other part of a contact, and over none of the
    holes: between two places that are listed a face may end.
    """
    within = np.ones(len(places), bool)
    for body, name, pose, side in (
        (scene.object, contact.box, ended.pose, -1.0),
        (scene.cage, contact.point, scene.cage.pose_world_cage, 1.0),
    ):
        probes = pose.inverse_transform(places + side * PROBE * scene.touch_m * contact.normal_world)
        parts = body.parts if isinstance(body, Object) else body.shapes
        for part in parts:
            if part.name == name and name != own:
                within &= part.holds(probes)
        for hole in body.holes:
            if name in hole.in_ and name != own:
                within &= ~hole.holds(probes)
    return within


def _by_pair(contacts: Sequence[Contact]) -> list[list[Contact]]:
    """Return contacts that have a place, those of two parts together."""
    pairs: dict[tuple[str, str], list[Contact]] = {}
    for contact in contacts:
        if contact.place_world is not None:
            pairs.setdefault((contact.point, contact.box), []).append(contact)
    return list(pairs.values())


def _rims(
    scene: Scene, ended: PhaseRun, contact: Contact
) -> Iterator[tuple[FloatArray, float, FloatArray, str | None]]:
    """Yield middle, radius and axis, in the world, of each rim of the two parts of a contact, and the part's name."""
    bodies = (
        (scene.object.shapes, contact.box, ended.pose),
        (scene.cage.shapes, contact.point, scene.cage.pose_world_cage),
    )
    for shapes, name, pose_world_body in bodies:
        for part in shapes:
            if part.name == name and isinstance(part, Turned):
                pose = pose_world_body @ part.pose_body_shape
                for height, radius in part.rims:
                    yield pose.transform((0.0, 0.0, height)), radius, pose.rotation[:, 2], part.name


def _is_on(contact: Contact, center: FloatArray, radius: float, axis: FloatArray, touch_m: float) -> bool:
    """Whether a contact is on a rim, and its normal along the rim's axis."""
    assert contact.place_world is not None
    away = contact.place_world - center
    height = float(away @ axis)
    is_flat = float(np.linalg.norm(np.cross(contact.normal_world, axis))) <= FLAT
    aside = abs(float(np.linalg.norm(away - height * axis)) - radius)
    return is_flat and max(abs(height), aside) <= SAME_PLACE * touch_m

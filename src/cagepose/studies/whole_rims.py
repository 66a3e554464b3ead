"""Circles along which parts touch all around, of which a run lists four or eight places: `more_places`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cagepose.kernels.boundary.touching import SAME_PLACE
from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Turned
from cagepose.runs.run import Contact, PhaseRun
from cagepose.studies.tolerances import DEPTH_OF_PROBE, SAME_NORMAL_SINE

PLACES_OF_CIRCLE = 128
"""A circle has so many places. A polygon of so many corners is 0.03 % within it."""
WIDEST = 0.51 * np.pi
"""Angle between places that are listed, at most, of what touches all around."""


class _Side(NamedTuple):
    """The object's or the cage's side of a contact: the body, its part's name, the body's pose, and which way along the
    normal it is.
    """

    body: Object | Cage
    name: str
    pose: Pose
    sign: float


class _Axis(NamedTuple):
    """A shape of revolution: its pose in the world, z being its axis, and its name."""

    pose: Pose
    name: str | None


def more_places(scene: Scene, ended: PhaseRun) -> list[Contact]:
    """Return further contacts on circles along which parts touch all around at the end of a phase, as of a rim that
    lies flat, a ball in a round hole, a cone in its seat.
    """
    found = list[Contact]()
    for contacts in _by_pair(ended.contacts):
        sides = _sides(scene, ended, contacts[0])
        for axis in _axes(sides):
            circles = list(_circles(contacts, axis, scene.touch_m))
            for circle in circles:
                found += _places(sides, circle[0], axis, DEPTH_OF_PROBE * scene.touch_m)
            if circles:
                break
    return found


def _by_pair(contacts: Sequence[Contact]) -> list[list[Contact]]:
    """Return contacts that have a place, those of two parts together."""
    pairs: dict[tuple[str, str], list[Contact]] = {}
    for contact in contacts:
        if contact.place_world is not None:
            pairs.setdefault((contact.point, contact.box), []).append(contact)
    return list(pairs.values())


def _sides(scene: Scene, ended: PhaseRun, contact: Contact) -> tuple[_Side, _Side]:
    return (
        _Side(scene.object, contact.box, ended.pose, -1.0),
        _Side(scene.cage, contact.point, scene.cage.pose_world_cage, 1.0),
    )


def _axes(sides: Sequence[_Side]) -> Iterator[_Axis]:
    """Yield the parts of a contact that have an axis."""
    for side in sides:
        for part in (*side.body.shapes, *side.body.holes):
            if part.name == side.name and isinstance(part, Turned):
                yield _Axis(side.pose @ part.pose_body_shape, part.name)


class _About(NamedTuple):
    """Where a contact is about an axis, and its normal: outward, around and along the axis."""

    height: float
    radius: float
    angle: float
    normal: FloatArray


def _about(contact: Contact, axis: _Axis) -> _About:
    assert contact.place_world is not None
    x, y, height = axis.pose.inverse_transform(contact.place_world).tolist()
    angle = math.atan2(y, x)
    return _About(height, math.hypot(x, y), angle, _around(angle) @ axis.pose.rotation.T @ contact.normal_world)


def _around(angles: ArrayLike) -> FloatArray:
    """Return unit vectors outward, around and along z at angles about it, (..., 3, 3), rows."""
    cosine, sine, zero, one = np.cos(angles), np.sin(angles), np.zeros_like(angles), np.ones_like(angles)
    rows = [[cosine, sine, zero], [-sine, cosine, zero], [zero, zero, one]]
    return np.moveaxis(np.array(rows, dtype=float), (0, 1), (-2, -1))


def _circles(contacts: Sequence[Contact], axis: _Axis, touch_m: float) -> Iterator[list[Contact]]:
    """Yield the contacts of each circle about an axis that are spread all around it, with normals that are as round."""
    left = [(contact, _about(contact, axis)) for contact in contacts]
    while left:
        first, same, others = left[0][1], list[tuple[Contact, _About]](), list[tuple[Contact, _About]]()
        for contact, about in left:
            apart_m = max(abs(about.height - first.height), abs(about.radius - first.radius))
            is_same = (
                apart_m <= SAME_PLACE * touch_m and np.linalg.norm(about.normal - first.normal) <= SAME_NORMAL_SINE
            )
            (same if is_same else others).append((contact, about))
        angles = np.sort([about.angle for _, about in same])
        gaps = np.diff(angles, append=angles[0] + 2.0 * np.pi)
        if first.radius > SAME_PLACE * touch_m and gaps.max() <= WIDEST:
            yield [contact for contact, _ in same]
        left = others


def _places(sides: Sequence[_Side], listed: Contact, axis: _Axis, probe_m: float) -> Iterator[Contact]:
    """Yield contacts all along the circle of one that is listed, where there is material on both sides: a face may end
    between two places that are listed.
    """
    height, radius, _, normal = _about(listed, axis)
    around = _around(2.0 * np.pi * np.arange(PLACES_OF_CIRCLE) / PLACES_OF_CIRCLE)
    places = axis.pose.transform(np.array((radius, 0.0, height)) @ around)
    normals = normal @ around @ axis.pose.rotation.T
    is_held = np.ones(PLACES_OF_CIRCLE, np.bool_)
    for body, name, pose, sign in sides:
        probes = pose.inverse_transform(places + sign * probe_m * normals)
        of = next((hole.in_ for hole in body.holes if hole.name == name), (name,))
        if of != (axis.name,):  # at its own rim, what is inside is rounding
            parts = body.parts if isinstance(body, Object) else body.shapes
            is_held &= np.any([part.holds(probes) for part in parts if part.name in of], axis=0)
        for hole in body.holes:
            if hole.name != axis.name and set(hole.in_) & set(of):
                is_held &= ~hole.holds(probes)
    for place, there in zip(places[is_held], normals[is_held], strict=True):
        yield replace(listed, place_world=place, normal_world=there)

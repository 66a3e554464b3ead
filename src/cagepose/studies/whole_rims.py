"""Circles along which parts touch all around, of which a run lists four or eight places: `more_places`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

import numpy as np

from cagepose.kernels.shapes.meeting import SAME_PLACE
from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Turned
from cagepose.runs.run import Contact, PhaseRun

PLACES = 128
"""Of a circle: a polygon of so many corners is 0.03 % within it."""
PROBE = 10.0
"""In touch tolerances: so far into either part it is asked whether there is material."""
SAME_WAY = 1e-6
"""Sine of the angle between normals that are one."""
WIDEST = 0.51 * np.pi
"""Angle between places that are listed, at most, of what touches all around."""


class _Axis(NamedTuple):
    """Axis of a shape of revolution: a point and a direction in the world, and the shape's name."""

    middle: FloatArray
    along: FloatArray
    name: str | None


def more_places(scene: Scene, ended: PhaseRun) -> list[Contact]:
    """Return further contacts on circles along which parts touch all around at the end of a phase, as of a rim that
    lies flat, a ball in a round hole, a cone in its seat.
    """
    found = list[Contact]()
    for contacts in _by_pair(ended.contacts):
        for axis in _axes(scene, ended, contacts[0]):
            circles = [_places(scene, ended, circle, axis) for circle in _circles(contacts, axis, scene.touch_m)]
            if circles:
                found += [contact for places in circles for contact in places]
                break
    return found


def _by_pair(contacts: Sequence[Contact]) -> list[list[Contact]]:
    """Return contacts that have a place, those of two parts together."""
    placed = sorted((contact for contact in contacts if contact.place_world is not None), key=_pair)
    return [list(pair) for _, pair in groupby(placed, key=_pair)]


def _pair(contact: Contact) -> tuple[str, str]:
    return contact.point, contact.box


def _axes(scene: Scene, ended: PhaseRun, contact: Contact) -> Iterator[_Axis]:
    """Yield the axes of the two parts of a contact that have one."""
    bodies: tuple[tuple[Object | Cage, str, Pose], ...] = (
        (scene.object, contact.box, ended.pose),
        (scene.cage, contact.point, scene.cage.pose_world_cage),
    )
    for body, name, pose_world_body in bodies:
        for part in (*body.shapes, *body.holes):
            if part.name == name and isinstance(part, Turned):
                pose = pose_world_body @ part.pose_body_shape
                yield _Axis(pose.position_m, pose.rotation[:, 2], part.name)


def _circles(contacts: Sequence[Contact], axis: _Axis, touch_m: float) -> Iterator[list[Contact]]:
    """Yield the contacts of each circle about an axis that are spread all around it, with normals that are as round."""
    left = [(contact, _about(contact, axis)) for contact in contacts]
    while left:
        height, radius, _, normal = left[0][1]
        near = [
            (abs(other[0] - height) <= SAME_PLACE * touch_m and abs(other[1] - radius) <= SAME_PLACE * touch_m)
            and float(np.linalg.norm(other[3] - normal)) <= SAME_WAY
            for _, other in left
        ]
        circle = [one for one, is_near in zip(left, near, strict=True) if is_near]
        left = [one for one, is_near in zip(left, near, strict=True) if not is_near]
        angles = np.sort([other[2] for _, other in circle])
        gaps = np.diff(angles, append=angles[0] + 2.0 * np.pi)
        if radius > SAME_PLACE * touch_m and gaps.max() <= WIDEST:
            yield [contact for contact, _ in circle]


def _about(contact: Contact, axis: _Axis) -> tuple[float, float, float, FloatArray]:
    """Return height, radius and angle of a contact about an axis; and its normal: outward, around, along the axis."""
    assert contact.place_world is not None
    away = contact.place_world - axis.middle
    height = float(away @ axis.along)
    one, two = _across(axis)
    x, y = float(away @ one), float(away @ two)
    radius = float(np.hypot(x, y))
    outward = (x * one + y * two) / (radius or 1.0)
    directions = np.array([outward, np.cross(axis.along, outward), axis.along])
    return height, radius, float(np.arctan2(y, x)), directions @ contact.normal_world


def _across(axis: _Axis) -> tuple[FloatArray, FloatArray]:
    """Return two unit vectors across an axis and each other."""
    one = np.cross(axis.along, np.eye(3)[np.abs(axis.along).argmin()])
    one /= float(np.linalg.norm(one))
    return one, np.cross(axis.along, one)


def _places(scene: Scene, ended: PhaseRun, circle: Sequence[Contact], axis: _Axis) -> Iterator[Contact]:
    """Yield contacts all along a circle where there is material on both sides: a face may end between two places that
    are listed.
    """
    height, radius, _, (out, around, along) = _about(circle[0], axis)
    one, two = _across(axis)
    angles = 2.0 * np.pi * np.arange(PLACES) / PLACES
    outward = np.outer(np.cos(angles), one) + np.outer(np.sin(angles), two)
    places = axis.middle + height * axis.along + radius * outward
    normals = out * outward + around * np.cross(axis.along, outward) + along * axis.along
    is_held = np.ones(len(places), np.bool_)
    bodies: tuple[tuple[Object | Cage, str, Pose, float], ...] = (
        (scene.object, circle[0].box, ended.pose, -1.0),
        (scene.cage, circle[0].point, scene.cage.pose_world_cage, 1.0),
    )
    for body, name, pose, side in bodies:
        probes = pose.inverse_transform(places + side * PROBE * scene.touch_m * normals)
        of = next((hole.in_ for hole in body.holes if hole.name == name), (name,))
        if of != (axis.name,):  # at its own rim, what is inside is rounding
            parts = body.parts if isinstance(body, Object) else body.shapes
            is_held &= np.any([part.holds(probes) for part in parts if part.name in of], axis=0)
        for hole in body.holes:
            if hole.name != axis.name and set(hole.in_) & set(of):
                is_held &= ~hole.holds(probes)
    for place, normal in zip(places[is_held], normals[is_held], strict=True):
        yield replace(circle[0], place_world=place, normal_world=normal)

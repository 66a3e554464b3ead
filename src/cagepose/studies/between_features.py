"""What is measured between a feature of the cage and one of the object at any pose: gaps, angles and distances."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.runs.driven_cage import CageAt
from cagepose.studies.named_features import CageFeature, ObjectFeature


class Instant(NamedTuple):
    """Where the object is, where the cage and its bodies are, and within which distance they touch, metres."""

    pose_world_object: Pose
    cage: CageAt
    touch_m: float


class Measure(Protocol):
    """A number of each instant: metres or radians; NaN: it has none. `cagepose.studies.part_gap.PartGap` is one."""

    def at(self, instant: Instant) -> float:
        """Return it."""


class AxesAngle(NamedTuple):
    """The angle between an axis of the cage and one of the object, as of lines: from 0 to a right angle, radians."""

    of_cage: CageFeature
    of_object: ObjectFeature

    def at(self, instant: Instant) -> float:
        assert self.of_cage.axis is not None
        assert self.of_object.axis is not None
        one = _way(self.of_cage.frame(instant.cage), self.of_cage.axis)
        other = _way(instant.pose_world_object @ self.of_object.pose_object_feature, self.of_object.axis)
        # From the sine, too: the cosine alone has lost half of its digits where axes are nearly parallel.
        return math.atan2(float(np.linalg.norm(np.cross(one, other))), abs(float(one @ other)))


class PlacesDistance(NamedTuple):
    """How far a place of the cage and one of the object are apart, or one of them from an axis of the other, metres."""

    of_cage: CageFeature
    of_object: ObjectFeature

    def at(self, instant: Instant) -> float:
        one = self.of_cage.frame(instant.cage)
        other = instant.pose_world_object @ self.of_object.pose_object_feature
        apart = other.position_m - one.position_m
        for frame, axis in ((one, self.of_cage.axis), (other, self.of_object.axis)):
            if axis is not None:
                apart = np.cross(apart, _way(frame, axis))
        return float(np.linalg.norm(apart))


def _way(frame: Pose, axis: int) -> FloatArray:
    way: FloatArray = frame.rotation[:, axis]
    return way

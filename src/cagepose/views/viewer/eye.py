"""From where a picture is seen: places of the room to pixels, in perspective."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.views.viewer.look import FIELD_DEG, MARGIN

AZIMUTH, ELEVATION = math.radians(-56.0), math.radians(24.0)
LEAST_HALF = 0.02
"""In radii of the scene: half the height of a picture."""
ROUNDS_OF_FIT = 6
"""A fit takes so many rounds. Marks have their size in pixels, so that a fit changes what is fitted."""


class Eye:
    """Places of drawing coordinates to pixels, y down.

    Attributes
    ----------
    axes
        Right, up and towards the viewer, (3, 3).
    target, half
        What is looked at, (3,), and half the height of the picture there, drawing units.
    """

    def __init__(
        self,
        size: tuple[int, int],
        least_distance: float = 0.0,
        *,
        azimuth: float = AZIMUTH,
        elevation: float = ELEVATION,
    ) -> None:
        """``least_distance``: how far the eye keeps from the target, so that a part of a large thing can be seen from
        outside. ``azimuth``, ``elevation``: where it is, radians about z and above the ground.
        """
        self.size = np.array(size, dtype=np.float64)
        sin_a, cos_a, sin_e, cos_e = math.sin(azimuth), math.cos(azimuth), math.sin(elevation), math.cos(elevation)
        back, right = np.array([cos_a * cos_e, sin_a * cos_e, sin_e]), np.array([-sin_a, cos_a, 0.0])
        self.axes: FloatArray = np.stack([right, np.cross(back, right), back])
        self.target, self.half, self.least_distance = np.zeros(3), 1.0, least_distance

    @property
    def distance(self) -> float:
        """From the eye to the target."""
        return max(self.least_distance, self.half / math.tan(math.radians(FIELD_DEG) / 2.0))

    def fit(self, radius: float, content: Callable[[], FloatArray]) -> None:
        """Bring all places (n, 3) that ``content`` returns into the picture; they may follow from where the eye is."""
        self.half = radius
        for _ in range(ROUNDS_OF_FIT):
            seen = self.pixels(content())[:, :2]
            low, high = seen.min(axis=0), seen.max(axis=0)
            off = ((low + high) / 2.0 - self.size / 2.0) * self.pixel()
            self.target = self.target + off[0] * self.axes[0] - off[1] * self.axes[1]
            self.half = max(LEAST_HALF * radius, self.half * float(((high - low) / self.size).max()) / MARGIN)

    def pixel(self, place: FloatArray | None = None) -> float:
        """Return how many drawing units a pixel is wide, at a place or at the target."""
        at_target = 2.0 * self.half / float(self.size[1])
        if place is None:
            return at_target
        return at_target * max(0.05, 1.0 - float(self.axes[2] @ (place - self.target)) / self.distance)

    def pixels(self, places: FloatArray) -> FloatArray:
        """Return where places (..., 3) are drawn: x, y, and how near, in about pixels about the target. That is linear
        along every straight line of the picture.
        """
        seen = (places - self.target) @ self.axes.T
        depth = np.maximum(1.0 - seen[..., 2] / self.distance, 1e-3)
        across = seen[..., :2] * [1.0, -1.0] / (depth * self.pixel())[..., None] + self.size / 2.0
        near = self.distance / self.pixel() / depth
        drawn: FloatArray = np.concatenate([across, near[..., None]], axis=-1)
        return drawn

    def places(self, pixels: FloatArray) -> FloatArray:
        """Return the places (n, 3) that are drawn at x, y and nearness (n, 3)."""
        depth = self.distance / self.pixel() / pixels[:, 2]
        across = (pixels[:, :2] - self.size / 2.0) * [1.0, -1.0] * (depth * self.pixel())[:, None]
        seen = np.concatenate([across, self.distance * (1.0 - depth)[:, None]], axis=1)
        found: FloatArray = seen @ self.axes + self.target
        return found

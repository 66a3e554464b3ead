"""The paper's first example, built in Python: the twin of ``scenes/sample.yaml``, which an installed package lacks."""

from __future__ import annotations

from cagepose.model.cage import Cage
from cagepose.model.load import Load
from cagepose.model.parts import Box, Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene

EDGE_M = 0.010
START_M = (0.002, 0.004, 0.010)
POINT_SPACING_M = 0.008
FACE_DISTANCES_M = (0.007, 0.005)
"""From the first contact to the cube's faces at low x and at low y: they set the two turns, (4.1) and (4.2)."""
DROP_M = START_M[2] - EDGE_M / 2.0
"""From the underside at the start to the points at z = 0."""


def sample_scene() -> Scene:
    """Return the cube over four points (docs/theory, "The sample")."""
    half = POINT_SPACING_M / 2.0
    return Scene(
        Object([Box((EDGE_M, EDGE_M, EDGE_M), name="cube")], (0.0, 0.0, 0.0), pose=Pose(START_M)),
        Cage([(half, half, 0.0), (half, -half, 0.0), (-half, -half, 0.0), (-half, half, 0.0)]),
        [Load("gravity", gravity=(0.0, 0.0, -1.0))],
        name="sample",
    )

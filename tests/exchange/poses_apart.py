"""How far apart two scenes with the same object end."""

from __future__ import annotations

import numpy as np

from cagepose import Scene, run
from cagepose.exchange.crosscheck import surface_points


def apart(one: Scene, other: Scene) -> float:
    """How far poses of two scenes with the same object are apart, in sizes, phase by phase at most."""
    points, ours, theirs = surface_points(one.object), run(one), run(other)
    assert [phase.verdict for phase in ours.phases] == [phase.verdict for phase in theirs.phases]
    gaps = [
        np.linalg.norm(a.pose.transform(points) - b.pose.transform(points), axis=1).max()
        for a, b in zip(ours.phases, theirs.phases, strict=True)
    ]
    return max(gaps) / one.size_m

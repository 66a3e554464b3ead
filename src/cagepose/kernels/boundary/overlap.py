"""temporary stub until the helper's lands"""
from __future__ import annotations

from typing import NamedTuple

from cagepose.kernels.boundary.features import PlacedBoundary
from cagepose.kernels.boundary.touching import Meetings
from cagepose.kernels.native.kernel import kernel


class Overlap(NamedTuple):
    feature: int
    cage_feature: int
    depth_m: float


@kernel
def find_overlap(held: PlacedBoundary, cage: PlacedBoundary, touch_m: float, meetings: Meetings) -> Overlap:
    found = Overlap(-1, -1, 0.0)
    for at in range(meetings.used[0]):
        if meetings.rows[at].group != at:
            continue
        best = at
        for other in range(at, meetings.used[0]):
            if meetings.rows[other].group == at and meetings.rows[other].gap > meetings.rows[best].gap:
                best = other
        row = meetings.rows[best]
        if row.gap < -touch_m and -row.gap > found.depth_m:
            found = Overlap(row.feature, row.cage_feature, -row.gap)
    return found

"""Which contacts count one at a time, and which never do? Found anew from points and boxes, by (2.4)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from audit.case import Answer
from audit.geometry import SAME_NORMAL, Touch, are_one, touches, touches_are_clear
from cagepose import PhaseRun, Run


def groups(run: Run) -> Answer:
    """Faces of one box that a point touches are a group; flush faces of a later box, all of whose faces there are
    listed, are none. A group is told by the place of its first contact. Not asked of two points at one place, of which
    either may be told.
    """
    found, asked = [], False
    for phase in run.phases:
        listed = touches(run.scene, phase.pose)
        if phase.contacts and touches_are_clear(run.scene, phase.pose) and not _has_twins(listed, run.scene.touch_m):
            asked = True
            expected = expected_groups(listed)
            told = _told_groups(run, phase)
            if told != expected:
                found.append(f"{phase.name}: groups of contacts are {told}, not {expected}")
    return found if asked else None


Group = tuple[int, int, int]
"""Point, box, and number of faces."""


def _has_twins(found: Sequence[Touch], touch_m: float) -> bool:
    return any(one.point != other.point and are_one(one, other, touch_m) for one, other in combinations(found, 2))


def expected_groups(found: Sequence[Touch]) -> list[Group]:
    """Return the groups of what touches, sorted."""
    expected = list[Group]()
    for point in sorted({touch.point for touch in found}):
        listed = list[np.ndarray]()
        of_point = [touch for touch in found if touch.point == point]
        for box in sorted({touch.box for touch in of_point}):
            normals = [touch.normal for touch in of_point if touch.box == box]
            is_new = not all(any(np.linalg.norm(n - other) <= SAME_NORMAL for other in listed) for n in normals)
            if is_new:
                expected.append((point, box, len(normals)))
                listed += normals
    return expected


def _told_groups(run: Run, phase: PhaseRun) -> list[Group]:
    """Return the groups that a run tells, sorted; one whose number is not its first contact's place has no faces."""
    names, boxes = run.scene.cage.names, [box.name for box in run.scene.object.boxes]
    members = dict[tuple[int, int, int | None], list[int]]()
    for place, contact in enumerate(phase.contacts):
        pair = names.index(contact.point), boxes.index(contact.box)
        members.setdefault((*pair, contact.group), []).append(place)
    return sorted(
        (point, box, len(places) if group == places[0] else 0) for (point, box, group), places in members.items()
    )

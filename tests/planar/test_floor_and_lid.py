"""A scene in the plane beside the same one between a floor and a lid, with all six freedoms."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import run
from cagepose.runs.run import AT_REST
from planar.floor_and_lid import drawn_pair

SEEDS = (1, 2, 4, 5, 9, 14, 17, 19, 21, 22, 23, 24, 30, 31)
SAME = 1e-9
"""In sizes of the scene, radians and loads."""
SAME_WAY = 1e-3
"""The same where friction holds the plate on its way, which two runs follow by different steps."""


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_plate_in_the_plane_does_as_between_a_floor_and_a_lid(seed, friction):
    pair = drawn_pair(seed, friction)
    one, other = run(pair.planar), run(pair.between_walls)
    assert [phase.verdict for phase in one.phases] == [phase.verdict for phase in other.phases]
    for phase, same in zip(one.phases, other.phases, strict=True):
        assert phase.pose.position_m[1] == 0.0
        assert phase.proof.stability == same.proof.stability
        if phase.verdict not in AT_REST:
            continue
        allowed = SAME_WAY if phase.proof.needs_friction else SAME
        away = np.abs(phase.pose.position_m - same.pose.position_m).max() / one.scene.size_m
        assert away <= allowed
        assert np.abs(phase.pose.quaternion_wxyz - same.pose.quaternion_wxyz).max() <= allowed
        theirs = {contact.point: contact for contact in same.contacts if contact.point not in ("floor", "lid")}
        ours = {contact.point: contact for contact in phase.contacts}
        assert set(ours) == set(theirs)
        for name, contact in ours.items():
            assert contact.force_normal_n == pytest.approx(theirs[name].force_normal_n, abs=100.0 * allowed)

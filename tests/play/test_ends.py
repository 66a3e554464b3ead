"""Ends of the play against an oracle of its own: no point inside, stationary, none passed by what is known to go on."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from audit.caged_families import GRAVITY
from audit.families import drawn_scenes, make_case
from cagepose import Box, Cage, Object, Play, Scene, play
from cagepose.studies import cage_verdict, free_motions
from cagepose.studies.cage_verdict import search_way_out
from cagepose.studies.play_frame import FREEDOMS, PlayFrame
from cagepose.studies.play_result import PlayEnd
from end_oracle import Start, missing

MM = 1e-3
STATIONARY = 1e-4
"""Fraction of the slope."""
TRIES = 2000
"""Motions that a tree tries, as many on any machine."""
FAMILIES = ("near-contact", "grid", "needle", "wedge", "twins", "block", "slot", "stopped-plate")


def scenes(n_each: int) -> Iterator[Scene]:
    """Caged scenes, scenes with points at edges, and loose, symmetric, slim, wedged and pinched ones."""
    for family in ("caged", "caged-seams"):
        yield from drawn_scenes(family, n_each, 21)
    for family in FAMILIES:
        for index in range(n_each):
            yield make_case(family, index, 21).scene


def ends_of(found: Play) -> Iterator[tuple[str, float, PlayEnd]]:
    for name, ends in found.freedoms.items():
        yield name, -1.0, ends.low
        yield name, 1.0, ends.high


def test_what_is_called_an_end_is_outside_and_stationary_and_the_start_lies_between_ends(cases):
    n_ends = Counter[str]()
    for scene in scenes(cases(10, 60)):
        found, start = play(scene, search_s=0.0), Start(scene)
        deepest = min(0.0, float(start.gaps(start.pose)[0].max(axis=1).min()))
        for name, sign, end in ends_of(found):
            n_ends[end.status] += 1
            assert (end.exact is not None) == (end.status in ("local", "proven"))
            if end.reached is None:
                assert end.status == "open"
                continue
            assert sign * end.reached >= 0.0
            assert end.pose_world_object is not None
            value, slope = start.value(end.pose_world_object, name)
            assert start.unit(name) * value == pytest.approx(end.reached, abs=1e-9 * start.unit(name))
            gaps, rows = start.gaps(end.pose_world_object)
            assert gaps.max(axis=1).min() >= deepest - 1e-11
            if end.exact is not None:
                assert missing(gaps, rows, sign * slope) < STATIONARY, (name, end)
    assert n_ends["local"] + n_ends["proven"] > 8 * n_ends["not converged"]


def test_no_end_is_nearer_than_the_pose_of_another():
    """Each is searched for from the farthest of the others, too."""
    for scene in scenes(6):
        found, start = play(scene, search_s=0.0), Start(scene)
        poses = [end.pose_world_object for *_, end in ends_of(found) if end.pose_world_object is not None]
        for name, sign, end in ends_of(found):
            if end.reached is not None:
                farthest = max(sign * start.value(pose, name)[0] for pose in poses)
                assert farthest <= sign * end.reached / start.unit(name) + 2e-8 or end.status == "not converged"


def test_trees_of_free_motions_pass_no_proven_end_and_few_local_ones(cases, monkeypatch):
    """A proven end is passed by a hundredth at most; that any local one is passed at all is why they are so named."""
    monkeypatch.setattr(cage_verdict, "perf_counter", itertools.count().__next__)  # one for each batch of tries
    n_ends, n_passed = Counter[str](), Counter[str]()
    for scene in scenes(cases(8, 60)):
        found, frame = play(scene, search_s=0.0), PlayFrame(scene)
        stations, n_stations, _, _ = search_way_out(scene, frame, TRIES / free_motions.MOTIONS_OF_BATCH)
        positions, turns = stations["position"][:n_stations], stations["quaternion"][:n_stations, [1, 2, 3, 0]]
        turned = Rotation.from_quat(turns)
        origin = np.array(frame.pose_frame_object.position_m)
        shifts = turned.apply(origin) + frame.length_m * positions - origin
        yaw, pitch, roll = turned.as_euler("ZYX").T
        values = dict(zip(FREEDOMS, (*shifts.T, roll, pitch, yaw), strict=True))
        for name, sign, end in ends_of(found):
            if end.reached is None:
                continue
            farthest, known = float((sign * values[name]).max()), sign * end.reached
            n_ends[end.status] += 1
            n_passed[end.status] += farthest > 1.001 * known + 1e-9
            if end.certified is not None:
                assert farthest <= sign * end.certified
                assert (end.status == "proven") == (sign * end.certified <= 1.01 * known)
    assert n_ends["proven"] > 20
    assert n_passed["proven"] == 0
    assert n_passed["local"] < 0.02 * n_ends["local"]


def test_a_point_at_an_edge_lets_the_object_by_on_either_side():
    """A cube of 20 mm with 1 mm of play all around, and one more point on its edge at x = y = 10: by hand, it may go
    1 mm along x past the face that looks along y, and 1 mm along y past the other, not both."""
    offsets = [(i, j) for i in (-8.0, 8.0) for j in (-8.0, 8.0)]
    around = [np.roll((side * 11.0, *offset), axis) for axis in range(3) for side in (-1, 1) for offset in offsets]
    cube = Object([Box(np.full(3, 20 * MM))])
    found = play(Scene(cube, Cage(np.array([*around, (10.0, 10.0, 0.0)]) * MM), GRAVITY), search_s=0.0)
    for name in ("x", "y"):
        assert found.freedoms[name].high.exact == pytest.approx(1 * MM, rel=1e-3)
        assert found.freedoms[name].low.exact == pytest.approx(-1 * MM, rel=1e-3)

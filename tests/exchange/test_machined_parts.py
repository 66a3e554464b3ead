"""Machined parts that Open CASCADE builds and writes as STEP and STL come to rest where they have to, without going
through what holds them.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from cagepose import Run, Scene, run
from cagepose.files.step.open_cascade import moments_of
from cagepose.model.boundary.inexact import exact_faces
from cagepose.model.shape_moments import shape_moments
from exchange import machined_parts, machined_rims, machined_truths
from exchange.cad_parts import Part
from exchange.machined_case import CASES, Case, Reader, cases_of
from exchange.path_oracle import Between, part_of
from exchange.poses_apart import apart

pytest.importorskip("OCP")

EXACT = 1e-9
"""Of the size: how far STEP is from the truth at most."""
SINGLE = 1e-6
"""Of the size: what is left of single precision in STL, in corners, and in planes and radii that go through these."""
AT_EVENTS, ON_MOTIONS = 1e-11, 1e-4
"""Of the size: how deep points may be in the other body, and between events, where a contact strays by the square of
the way until it is put back."""
TIMES_TOLD = 2.0
"""Of what both bodies are told to be off: how far an end may be from the truth."""


@cache
def case_of(name: str) -> Case:
    return CASES[name]()


def twin(part: Part):
    return part.twin


@cache
def run_of_twin(name: str) -> tuple[Scene, Run]:
    scene = case_of(name).scene(twin)
    return scene, run(scene)


def off_told(case: Case, name: str, done: Run) -> list[float]:
    """Return how far the end is from what has to be, millimetres."""
    found = []
    for point, way, height in case.told:
        ends = [each.phases[-1].pose for each in ([done] if height is not None else [done, run_of_twin(name)[1]])]
        heights = [float(np.dot(1e3 * end.transform(1e-3 * np.array([point]))[0], way)) for end in ends]
        found.append(heights[0] - (height if height is not None else heights[1]))
    return found


RUNS_DOWN, SHARED_BY_RIMS = 1e-6, {"plate with a slot and a hole on pins 2"}
"""In sizes. The rim of its hole rubs on a floor at eight places, of which each model has its own: the ways of twin and
facets are 1e-9 apart, and 3.3e-7 where the motion slowly comes to its end.
"""


def check_exactly(name: str, reader: Reader) -> None:
    case = case_of(name)
    scene = case.scene(reader)
    size, done = 1e3 * scene.size_m, run(scene)
    assert reader.error <= max(case.off, EXACT * size)
    allowed = max(EXACT * size, TIMES_TOLD * reader.error if case.off else 0.0)
    if case.has_twin:
        assert [phase.verdict for phase in done.phases] == [phase.verdict for phase in run_of_twin(name)[1].phases]
    else:
        assert {phase.verdict for phase in done.phases} == {"rests"}
    if case.told:
        assert np.abs(off_told(case, name, done)).max() <= allowed
    else:
        differs = reader.to == "facets" and name in SHARED_BY_RIMS
        assert apart(run_of_twin(name)[0], scene) <= (RUNS_DOWN if differs else EXACT)


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", CASES)
def test_step_ends_where_it_has_to(name, tmp_path):
    """As it is imported: as our primitives where it is a few of them, else as facets that stand for its surfaces."""
    check_exactly(name, Reader(tmp_path, "step"))


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", cases_of(machined_rims))
def test_rounded_rims_are_tori(name, tmp_path):
    """Read back from a file they are as Open CASCADE has them, to a thousand-millionth."""
    case, reader, kinds = case_of(name), Reader(tmp_path, "step"), set[str]()
    for part in (case.held, *case.cage):
        if isinstance(part, Part):
            (shape,) = reader(part)
            assert exact_faces(shape).n_facets == 0
            kinds |= exact_faces(shape).of_kinds.keys()
            assert shape_moments(shape).volume_m3 == pytest.approx(1e-9 * moments_of(part.solid).Mass(), rel=1e-9)
            assert reader.error <= 1e-9 * float(np.ptp(1e3 * shape.vertices_m))
    assert "torus" in kinds


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", cases_of(machined_parts))
def test_facets_that_stand_for_surfaces_end_where_primitives_do(name, tmp_path):
    """Whether or not they are a few of our primitives."""
    check_exactly(name, Reader(tmp_path, "facets"))


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", [*cases_of(machined_parts), *cases_of(machined_truths)])
def test_stl_ends_within_what_it_is_told_to_be_off(name, tmp_path):
    """What the loads decide first: chords of circles leave the rest open by as much as they are wide."""
    case, reader = case_of(name), Reader(tmp_path, "stl")
    scene = case.scene(reader)
    done = run(scene)
    assert done.verdict in ("rests", "may rest")
    if case.has_twin:
        assert [phase.verdict for phase in done.phases] == [phase.verdict for phase in run_of_twin(name)[1].phases]
    if case.told:
        off = abs(off_told(case, name, done)[0])
    else:
        heights = [
            float(1e3 * each.pose.transform(each.scene.object.center_of_gravity_m[None])[0, 2])
            for each in (done, run_of_twin(name)[1])
        ]
        off = abs(heights[0] - heights[1])
    assert off <= SINGLE * 1e3 * scene.size_m + TIMES_TOLD * reader.error


ON_THE_WAY = (
    "block with cross holes hangs on a pin 2",
    "cap screw in a counterbore 2",
    "chamfered pin in a chamfered hole 2",
    "clevis on a bolt 2",
    "half round bar rocks level 2",
    "hexagon head turns in its pocket 2",
    "hub hangs by its keyway 2",
    "key in a milled groove 2",
    "keyed shaft on the floor 2",
    "link with round ends hangs 2",
    "nut falls over 2",
    "plate hangs by the round end of its slot 2",
    "plate with a slot and a hole on pins 2",
    "roller in a cradle 2",
    "saddle on a bar 2",
    "socket screw turned on its key 2",
    "split ring on a pin 2",
    "t nut pulled up in its slot 2",
)
SHARES = (1 / 3, 2 / 3)
"""Of a motion: poses between two events."""
STEP = 0.05
"""Millimetres. So far beside its end it is asked whether a part could lie lower."""
SAMPLED = 0.1
"""Of `STEP`: what its points leave open, as they do not lie close on what is round."""


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", ON_THE_WAY)
def test_nothing_goes_through_what_holds_it_and_nothing_that_rests_could_lie_lower(name, tmp_path):
    case = case_of(name)
    bodies = [(case.held,) if isinstance(case.held, Part) else case.held, case.cage]
    between = Between(*([one if isinstance(one, Part) else part_of(one) for one in body] for body in bodies))
    done = run(case.scene(Reader(tmp_path, "step")))
    size = 1e3 * done.scene.size_m
    for index, phase in enumerate(done.phases):
        for event in phase.events:
            assert between.depth(event.pose_world_object) <= AT_EVENTS * size
        moving = [number for number, event in enumerate(phase.events) if event.motion is not None]
        ways = [done.frame_at(index, number, share).pose_world_object for number in moving for share in SHARES]
        assert max((between.depth(pose) for pose in ways), default=0.0) <= ON_MOTIONS * size
    if case.friction == 0.0 and [load.name for load in case.loads] == ["weight"] and case.loads[0].gravity_world[2] < 0:
        center = done.scene.object.center_of_gravity_m
        assert between.lowest_beside(done.pose, center, STEP, 40) >= -SAMPLED * STEP

"""The least friction that lets a drive jam, place by place: closed forms, and the kernels' search beside it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq

import cagepose
from cagepose import Box, Cage, CageBody, Drive, Force, Load, Object, Pose, Scene, Sphere, insertion, run
from cagepose.studies.could_jam import JamQuestion, jam_friction_along, least_jam_friction
from cagepose.studies.driven_contacts import DriveContacts
from driven.driven_scenes import RAMP, lever, truss, wedge
from driven.insertions import Insertion
from driven.jam_oracles import least_friction, wider
from driven.pins_into_plates import pins_into_a_plate
from our_scenes import SCENES

OURS = {path.stem: path for path in SCENES}
KERNELS_FALL_SHORT = pytest.mark.xfail(
    strict=True, reason="near the limit the kernels' motion is long, and its rounding counts as a force that stands"
)
"""A wedge could jam from 0.9699824 on (8.8), and its run says 0.9698."""


def least(scene: Scene) -> np.ndarray:
    found = run(scene)
    (phase,) = [number for number, ended in enumerate(found.phases) if ended.drive is not None]
    return jam_friction_along(found, phase)


def test_a_drawer_jams_from_its_length_over_twice_the_offset_on() -> None:
    assert least(cagepose.load_scene(OURS["drawer-jams"])).min() == pytest.approx(1.5, rel=2e-5)


def test_a_drawer_that_is_pulled_aside_says_where_it_probably_jams() -> None:
    """A drawer of 400 by 300 mm between sides 2 mm farther apart, pulled at a handle 120 mm aside of its middle."""
    places = {
        "drawer": (0, 0, 50),
        "left stem": (95, -162, 50),
        "right stem": (145, -162, 50),
        "handle": (120, -177, 50),
    }
    sizes = {"drawer": (400, 300, 100), "left stem": (4, 24, 6), "right stem": (4, 24, 6), "handle": (60, 6, 20)}
    drawer = Object([block(sizes[name], places[name], name) for name in sizes], mass_kg=5.0)
    around = [
        block((500, 900, 20), (0, 0, -10), "floor"),
        block((20, 300, 150), (-211, 0, 75), "left side"),
        block((20, 300, 150), (211, 0, 75), "right side"),
    ]
    hand = CageBody("hand", (), None, Pose((0.12, -0.168, 0.05)), [Sphere(0.004, name="finger")])
    pull = Load(
        "pull",
        gravity=(0, 0, -9.81),
        force=Force((0, 1, 0), (0, 0, 0.05), 5.0),
        drive={"hand": Drive((0, -0.25, 0))},
    )
    frictionless = {"floor": 0.0, "finger": 0.0}
    scene = Scene(
        drawer, Cage(shapes=around, bodies=[hand]), [pull], friction_coefficient=0.3, friction_of=frictionless
    )
    ended = run(scene)
    drive = ended.phases[0].drive
    assert drive is not None
    assert ended.verdict in ("jams", "stalled")
    # 2 mu e = 72 mm of it are left between the sides then, but for its turn; the finger comes to the handle after 2 mm.
    assert drive.share * 250.0 == pytest.approx(300.0 - 72.0 + 2.0, abs=3.0)
    if ended.verdict == "stalled":
        told = f"it probably jams here, at {100.0 * drive.share:.4g} % of the drive"
        assert any(told in warning for warning in ended.warnings)


def block(size: tuple[float, float, float], place: tuple[float, float, float], name: str) -> Box:
    return Box(np.array(size) / 1e3, Pose(np.array(place) / 1e3), name)


@pytest.mark.parametrize(("table", "exact"), [(1.0, math.tan(math.pi / 8)), (0.0, 1.0)])
def test_a_plate_between_a_chamfer_and_its_table_jams_by_the_angles_of_both(table: float, exact: float) -> None:
    """A pin on a slope of 45 deg: the angles of friction of slope and table make up that to 90 deg."""
    plain = pins_into_a_plate()
    (head,) = plain.cage.bodies
    off = CageBody("head", shapes=head.shapes, pose=Pose((0.0, 0.5e-3, 0.021)))
    cage = Cage(shapes=plain.cage.standing.shapes, bodies=[off])
    scene = Scene(plain.object, cage, plain.loads, friction_coefficient=0.1, friction_of={"table": 0.1 * table})
    assert least(scene).min() == pytest.approx(exact, rel=2e-5)


@pytest.mark.parametrize("part", [0.25, 0.5, 1.0])
def test_a_wedge_jams_where_ramp_and_wall_press_along_one_line(part: float) -> None:
    """By (8.8), the wall's coefficient being a part of the ramp's; along the whole way."""
    exact = brentq(
        lambda mu: part * mu * math.tan(RAMP + math.atan(mu)) - 1.0, 1e-3, math.tan(math.pi / 2 - RAMP) - 1e-6
    )
    found = least(wedge(friction=0.2, wall_friction=part * 0.2))
    touches = np.isfinite(found)
    assert touches.all()
    np.testing.assert_allclose(found, exact, rtol=2e-5)


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(wedge, marks=KERNELS_FALL_SHORT),
        lever,
        lambda: Insertion(5.01, 0.3, math.radians(0.5), 0.1).scene(9.0, [28.0]),
        *(lambda name=name: cagepose.load_scene(OURS[name]) for name in ("dock", "jaws", "insertion")),
    ],
    ids=["wedge", "lever", "two points", "dock", "jaws", "insertion"],
)
def test_the_least_of_all_places_is_that_of_the_run(scene: Callable[[], Scene]) -> None:
    """The kernels ask the cones for it along the run, and halve; here planes cut them at the poses of the curve."""
    found = run(scene())
    phase = next(number for number, ended in enumerate(found.phases) if ended.drive is not None)
    drive = found.phases[phase].drive
    assert drive is not None
    expected = math.inf if drive.critical_jam_friction is None else drive.critical_jam_friction
    assert jam_friction_along(found, phase).min() == pytest.approx(expected, rel=5e-5, abs=1e-6)


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (lambda: cagepose.load_scene(OURS["jaws"]), 15),
        (lambda: Insertion(5.0078093483104595, 0.06692768770222697, 0.009894046750572136, 0.35).scene(2.0, [32.72]), 1),
    ],
    ids=["jaws", "two points"],
)
def test_it_lies_between_that_of_pyramids_inside_and_outside_of_the_cones(
    scene: Callable[[], Scene], expected: int
) -> None:
    """Place by place; both with equal coefficients all over."""
    found = run(scene())
    known, n_compared = DriveContacts(found, 0), 0
    along = jam_friction_along(found, 0)
    for row in known.rows():
        contacts = known.at_row(row)
        parts = np.ones(len(contacts.problem.faces))
        if math.isfinite(along[row]) and along[row] > 0.0:
            assert least_friction(contacts, wider(parts), 10.0) * (1.0 - 2e-5) <= along[row]
            assert along[row] <= least_friction(contacts, parts, 10.0) * (1.0 + 2e-5)
            n_compared += 1
    assert n_compared >= expected


def test_surfaces_that_are_parallel_jam_with_any_friction() -> None:
    """A block in a straight guide: opposite walls press against each other."""
    found = least(truss())
    assert found.min() == 0.0
    assert insertion(truss(), along=()).least_jam_friction == pytest.approx(0.0, abs=1e-8)


def facing(friction: float, drift: float) -> JamQuestion:
    """Two contacts face each other, which the drive closes on the one side, and drags along on the other."""
    columns = np.zeros((2, 3, 6))
    for row, sign in enumerate((1.0, -1.0)):
        columns[row, 0, 0], columns[row, 1, 1], columns[row, 2, 2] = sign, 1.0, 1.0
    drifts = np.array([[drift, 0.0, 0.0], [0.0, 0.0, 0.0]])
    return JamQuestion(columns, drifts, np.array([1.0, friction]), np.zeros(6), 1.0)


def test_what_is_closed_from_both_sides_jams_without_friction_and_what_is_opened_never() -> None:
    assert least_jam_friction(facing(1.0, 1.0)) == 0.0
    assert least_jam_friction(facing(1.0, -1.0)) == math.inf


def test_an_insertion_says_where_the_least_friction_is_needed_and_that_it_cannot_jam() -> None:
    found = insertion(cagepose.load_scene(OURS["dock"]), along=())
    assert found.cannot_jam
    assert found.misalignment == {}
    assert found.least_jam_friction == pytest.approx(found.jam_friction.min(), rel=5e-5)
    assert found.least_jam_share is not None
    assert found.least_jam_share > 0.95
    np.testing.assert_allclose(found.depth_m, 0.03 * found.drive.curve.share, rtol=1e-7)


def test_a_drive_that_jams_where_it_begins_could_jam() -> None:
    found = insertion(cagepose.load_scene(OURS["drawer-jams"]), along=())
    assert (found.verdict, found.cannot_jam, found.least_jam_share) == ("jams", False, 0.0)


def test_where_the_drive_does_not_begin_nothing_is_said_of_jams() -> None:
    """The object falls past the cage in the phase before."""
    scene = truss()
    falls = cagepose.Load("fall", gravity=(0.0, 0.0, -9.81))
    dropped = Scene(scene.object, scene.cage, [falls, *scene.loads], friction_coefficient=0.0)
    found = insertion(dropped, along=["x"])
    assert (found.verdict, found.drive, found.ended) == ("escapes", None, None)
    assert len(found.jam_friction) == len(found.depth_m) == 0
    assert not found.cannot_jam
    assert found.misalignment["x"].low.verdict == "escapes"

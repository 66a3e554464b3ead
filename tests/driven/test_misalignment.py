"""How far a drive may be out of place: closed forms of pins and chamfers, what ends a side, and how it is searched."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest

import cagepose
from cagepose import Cage, Drive, Load, Misalignment, Object, Pose, Scene, Spring, insertion, run
from cagepose.runs.drives import displaced_by
from cagepose.runs.misaligned import Misaligned, Reached
from cagepose.runs.misaligned_scene import misaligned_scene
from cagepose.studies import misalignment as module
from cagepose.studies.misalignment import permitted_misalignment
from driven.driven_scenes import jaws, lever
from driven.insertions import MM, Insertion, on_chamfer
from driven.pins_into_plates import CHAMFER, PLAY, pins_into_a_plate

CLOSE = 1e-3
"""To which fraction ends are asked for here."""


def asked(scene: Scene, *along: str) -> dict[str, Misalignment]:
    return permitted_misalignment(scene, 0, along, CLOSE)


def check_ends(found: Misalignment, low: float, high: float, verdict: str = "blocked") -> None:
    """Both ends lie between the last good place and the first bad one, which are as near as was asked."""
    for end, exact in ((found.low, low), (found.high, high)):
        assert end.permitted is not None
        assert end.fails_at is not None
        assert end.verdict == verdict
        assert abs(end.permitted) <= abs(exact) * (1 + 1e-9)
        assert abs(end.fails_at) >= abs(exact) * (1 - 1e-9)
        assert end.permitted == pytest.approx(exact, rel=1.1 * CLOSE)


@pytest.mark.parametrize("chamfer", [0.0, 0.3, CHAMFER])
def test_a_pin_may_be_off_by_its_play_and_the_chamfer(chamfer: float) -> None:
    found = asked(pins_into_a_plate(chamfer=chamfer), "x", "y")
    for name in ("x", "y"):
        check_ends(found[name], -(PLAY + chamfer) * MM, (PLAY + chamfer) * MM)


def test_a_wall_beside_the_plate_leaves_its_distance_and_the_play_on_that_side() -> None:
    """The plate cannot slide farther than to the wall; the pin then stands on the chamfer."""
    found = asked(pins_into_a_plate(wall_mm=0.2), "y")["y"]
    check_ends(found, -(PLAY + CHAMFER) * MM, (PLAY + 0.2) * MM)


@pytest.mark.parametrize("apart", [60.0, 80.0])
def test_two_pins_may_be_turned_until_one_is_off_by_its_play_and_the_chamfer(apart: float) -> None:
    """About the middle between the holes each pin goes along a chord; the plate turns after them."""
    yaw = 2.0 * math.asin((PLAY + CHAMFER) / apart)
    check_ends(asked(pins_into_a_plate((-apart / 2, apart / 2)), "yaw")["yaw"], -yaw, yaw)


@pytest.mark.parametrize("at_mm", [(0.0, 0.0), (60.0, -35.0)])
def test_turns_go_through_the_origin_of_the_object_wherever_it_stands(at_mm: tuple[float, float]) -> None:
    """There one pin may be turned as far as is searched; of two the second one goes along a chord about the first."""
    found = asked(pins_into_a_plate(at_mm=at_mm), "yaw")["yaw"]
    for end in (found.low, found.high):
        assert (end.fails_at, end.verdict) == (None, None)
        assert end.permitted is not None
        assert abs(end.permitted) == math.radians(10.0)
    yaw = 2.0 * math.asin((PLAY + CHAMFER) / 2.0 / 50.0)
    check_ends(asked(pins_into_a_plate((0.0, 50.0), at_mm=at_mm), "yaw")["yaw"], -yaw, yaw)


def test_shifts_are_along_the_axes_of_the_cage_as_it_lies_in_the_world() -> None:
    """A wall stands beside the plate on the side of the cage's +y."""
    scene, moved = pins_into_a_plate(wall_mm=0.2), Pose((0.3, -0.2, 0.1), euler_zyx=(0.5, 0.0, 0.0))
    held, cage = scene.object, scene.cage
    elsewhere = Scene(
        Object(held.boxes, holes=held.holes, mass_kg=held.mass_kg, pose=moved @ held.pose_world_object),
        Cage(shapes=cage.standing.shapes, bodies=cage.bodies, pose=moved),
        scene.loads,
        friction_coefficient=0.0,
    )
    check_ends(asked(elsewhere, "y")["y"], -(PLAY + CHAMFER) * MM, (PLAY + 0.2) * MM)


@pytest.mark.parametrize(
    "leg",
    [
        Drive((0.01, 0.02, -0.03)),
        Drive(about=(0, 1, 0), through=(0.1, 0, 0.2), angle=0.4),
        Drive((0, 0, 0.02), (0, 0, 1), (0.05, 0.1, 0), -0.3),
    ],
    ids=["travel", "turn", "screw"],
)
def test_a_way_that_is_moved_is_seen_from_there_as_before(leg: Drive) -> None:
    moved = Pose((0.03, -0.02, 0.01), euler_zyx=(0.3, -0.2, 0.1))
    for share in (0.3, 1.0):
        found, seen = displaced_by([leg.moved(moved)], share), moved @ displaced_by([leg], share) @ moved.inverse()
        np.testing.assert_allclose(found.position_m, seen.position_m, atol=1e-15)
        np.testing.assert_allclose(found.quaternion_wxyz, seen.quaternion_wxyz, atol=1e-15)


@pytest.mark.parametrize(("friction", "permitted", "verdict"), [(0.3, PLAY + CHAMFER, "blocked"), (0.43, PLAY, "jams")])
def test_a_rough_pin_on_a_chamfer_of_45_deg_jams_from_tan_22_5_deg_on(
    friction: float, permitted: float, verdict: str
) -> None:
    """Pin and table press on the plate along one line where the chamfer's slope is twice the angle of friction."""
    scene = pins_into_a_plate()
    rough = Scene(scene.object, scene.cage, scene.loads, friction_coefficient=friction)
    check_ends(asked(rough, "y")["y"], -permitted * MM, permitted * MM, verdict)


def test_a_limit_of_force_permits_the_play_alone_where_sliding_takes_more() -> None:
    scene = pins_into_a_plate()
    (load,) = scene.loads
    limited = Load(load.name, gravity=load.gravity_world, drive=load.drive, stop_at=0.5)
    rough = Scene(scene.object, scene.cage, [limited], friction_coefficient=0.3)
    check_ends(asked(rough, "y")["y"], -PLAY * MM, PLAY * MM, "stops")


def test_a_peg_that_stays_on_the_face_falls_short_though_the_drive_gets_to_its_end() -> None:
    """Springs alone carry it: 3 mm off, beyond a chamfer 2 mm wide, it stands on the block and they give way."""
    misaligned = Misaligned(on_chamfer(math.pi / 4, 0.0, 20.0, aside=0.0), 0)
    nominal, far = misaligned.run([Pose(), Pose((0.003, 0.0, 0.0))])
    assert (nominal.is_end, far.is_end) == (True, True)
    assert nominal.advance_m == pytest.approx(0.020, abs=1e-6)
    assert far.advance_m == pytest.approx(0.001, abs=1e-4)
    assert module._fault(far, nominal) == "falls short"
    assert module._fault(nominal, nominal) is None


def test_a_peg_that_starts_in_its_hole_overlaps_it_beyond_the_play() -> None:
    """It goes along with its gripper, which has neither points nor shapes."""
    scene = Insertion(5.05, 0.3, 0.0, 0.0).scene(5.0, [30.0])
    misaligned = Misaligned(scene, 0)
    assert misaligned.takes_object
    inside, beyond = misaligned.run([Pose((0.0, 0.0499e-3, 0.0)), Pose((0.0, 0.0501e-3, 0.0))])
    assert inside.verdict != "overlaps"
    assert beyond.verdict == "overlaps"
    assert module._fault(beyond, inside) == "overlaps"


def test_where_the_scene_itself_does_not_get_to_its_end_nothing_is_permitted() -> None:
    found = asked(jaws(), "y")["y"]
    assert found.low == found.high
    assert (found.low.permitted, found.low.fails_at, found.low.verdict) == (None, 0.0, "blocked")


@pytest.mark.parametrize(
    ("scene", "takes_object", "turned"),
    [
        (on_chamfer(math.pi / 4, 0.1, 6.0, aside=0.4), True, (0.004, 0.002, -0.003)),
        (pins_into_a_plate((-40.0, 40.0)), False, (0.004, 0.0, 0.0)),
        (lever(), False, (0.004, 0.002, -0.003)),
    ],
    ids=["on springs", "shapes", "turn and travel"],
)
def test_a_drive_out_of_place_is_that_of_a_scene_drawn_so(
    scene: Scene, takes_object: bool, turned: tuple[float, float, float]
) -> None:
    """Shifted and turned, with its way: the same verdict, and together they come as far to 1e-9 m."""
    turn = Pose((0.0, 0.0, 0.0), euler_zyx=turned)
    moved = Pose((0.1e-3, -0.05e-3, 0.02e-3), turn.quaternion_wxyz)
    misaligned = Misaligned(scene, 0)
    assert misaligned.takes_object == takes_object
    (reached,) = misaligned.run([moved])
    by_hand = misaligned_scene(scene, 0, moved)
    (phase,) = run(by_hand).phases
    assert reached.is_end
    assert phase.verdict in ("rests", "may rest")
    legs = next(iter(by_hand.loads[0].drive.values()))
    way = sum((leg.travel_m for leg in legs if leg.travel_m is not None), np.zeros(3))
    whole, center = float(np.linalg.norm(way)), by_hand.object.center_of_gravity_m
    went = phase.pose.transform(center) - by_hand.object.pose_world_object.transform(center)
    along = float(went @ way) / whole
    assert reached.advance_m == pytest.approx(along if takes_object else whole - along, abs=1e-9)


def test_a_spring_to_what_is_out_of_place_keeps_its_length_without_a_load() -> None:
    scene = pins_into_a_plate()
    spring, (load,) = Spring((0.04, 0.0, 0.01), (0.09, 0.03, 0.0), 400.0, 0.3, of="head"), scene.loads
    pulled = Load(load.name, gravity=load.gravity_world, springs=[spring], drive=load.drive)
    scene = Scene(scene.object, scene.cage, [pulled], friction_coefficient=0.0)

    def slack_m(one: Scene) -> float:
        (spring,) = one.loads[0].springs
        ends = one.cage.spring_end_world(spring), one.object.pose_world_object.transform(spring.at_object_m)
        return float(np.linalg.norm(ends[0] - ends[1])) - spring.preload_n / spring.stiffness_n_per_m

    assert slack_m(misaligned_scene(scene, 0, Pose((0.0003, 0.0, 0.0)))) == pytest.approx(slack_m(scene), abs=1e-15)


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[Misalignment, list[float]]]:
    """The search along x with answers that are played to it; and which places it has tried."""

    def play(answer: Callable[[float], Reached]) -> tuple[Misalignment, list[float]]:
        tried = list[float]()

        class Played:
            def __init__(self, scene: Scene, phase: int) -> None:
                pass

            def run(self, moved: Sequence[Pose]) -> list[Reached]:
                places = [float(pose.position_m[0]) for pose in moved]
                tried.extend(places)
                return [answer(place) for place in places]

        monkeypatch.setattr(module, "Misaligned", Played)
        return asked(pins_into_a_plate(), "x")["x"], tried

    return play


GOOD = Reached("rests", True, 1.0)


@pytest.mark.parametrize("verdict", ["stalled", "limit", "escapes", "jams", "stops", "overlaps"])
def test_any_other_end_than_a_rest_ends_a_side_and_is_named(played, verdict: str) -> None:
    found, _ = played(lambda place: GOOD if place < 1e-3 else Reached(verdict, False, math.nan))
    assert found.high.verdict == verdict
    assert found.high.permitted == pytest.approx(1e-3, rel=2 * CLOSE)
    assert found.high.is_failure == (verdict in ("stalled", "limit"))
    assert found.low.fails_at is None


def test_the_first_place_outwards_that_is_bad_ends_a_side(played) -> None:
    """Good places farther out do not count, and are not tried."""
    found, tried = played(lambda place: GOOD if not 1e-3 < place < 4e-3 else Reached("blocked", False, math.nan))
    assert found.high.permitted == pytest.approx(1e-3, rel=2 * CLOSE)
    assert max(tried) < 4e-3


def test_nine_tenths_of_the_way_are_as_far(played) -> None:
    found, _ = played(lambda place: replace_advance(1.0 - abs(place) / 10e-3))
    assert found.high.permitted == pytest.approx(1e-3, rel=2 * CLOSE)
    assert found.high.verdict == "falls short"


def replace_advance(advance: float) -> Reached:
    return GOOD._replace(advance_m=advance)


def test_a_way_of_turns_alone_has_no_depth_that_could_be_short(played) -> None:
    found, _ = played(lambda _: replace_advance(math.nan))
    assert found.low.fails_at is None
    assert found.high.fails_at is None


def test_an_end_may_be_asked_for_as_near_as_one_likes() -> None:
    coarse, fine = (insertion(pins_into_a_plate(), along=["x"], within=within) for within in (0.1, 1e-4))
    ends = [found.misalignment["x"].high for found in (coarse, fine)]
    gaps = [end.fails_at - end.permitted for end in ends if end.fails_at is not None and end.permitted is not None]
    assert gaps[0] > 50 * gaps[1]
    assert gaps[1] < 1e-4 * 0.85e-3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"along": ["x", "tilt"]}, "along: is 'tilt'; use one of: x, y, z, roll, pitch, yaw"),
        ({"phase": "settle"}, "phase: is 'settle'; use one of: press"),
        ({"within": 0.0}, "within: is 0.0; give a fraction above zero, such as 0.01"),
        ({"within": math.nan}, "within: is nan; give a fraction above zero, such as 0.01"),
    ],
)
def test_what_cannot_be_asked_is_told(arguments: dict, message: str) -> None:
    with pytest.raises(cagepose.SceneError, match=r"^" + message.replace(".", r"\.")):
        insertion(pins_into_a_plate(), **arguments)


def test_which_phase_is_asked_where_several_drive_and_refused_where_none_does() -> None:
    scene = jaws()
    with pytest.raises(cagepose.SceneError, match="phase: is needed, since several drive a body; give one of: close"):
        insertion(scene)
    assert insertion(scene, "lift", along=()).phase == 1
    still = Scene(scene.object, scene.cage, [Load("weight", gravity=(0, 0, -9.81))])
    with pytest.raises(cagepose.SceneError, match="loads: drive no body of the cage"):
        insertion(still)


def test_across_the_way_is_asked_if_nothing_is_named() -> None:
    assert list(insertion(pins_into_a_plate()).misalignment) == ["x", "y", "roll", "pitch"]

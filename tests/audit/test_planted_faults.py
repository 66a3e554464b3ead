"""Every oracle of the audit finds the fault that is planted in a right run, and nothing in the run itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from audit import balance, certified, goes_on, groups, inside, order, robustness, stability, uniqueness, way
from audit.case import Case
from audit.families import FAMILIES, make_case
from audit.geometry import acting
from audit.oracles import ENDING, ORACLES, TIME, examine
from audit.scene_yaml import scene_yaml
from cagepose import (
    Box,
    Cage,
    Capsule,
    Cone,
    Force,
    Hole,
    Load,
    Moment,
    Object,
    Pose,
    Scene,
    Sphere,
    Spring,
    load_scene,
    run,
)

FLOOR = [(x, y, 0.0) for x, y in ((-0.04, -0.03), (0.04, -0.03), (0.0, 0.04))]
WEIGHT = Load("weight", gravity=(0, 0, -1))


def block_on(points, *, friction=0.0, height=0.02, loads=(WEIGHT,), center=(0, 0, 0)):
    held = Object([Box((0.1, 0.1, 0.02), name="block")], center, pose=Pose((0, 0, height)))
    return Scene(held, Cage(points), loads, friction_coefficient=friction)


def dropped(**changes):
    return run(block_on(FLOOR, **changes))


def with_phase(one, **changes):
    return replace(one, phases=(*one.phases[:-1], replace(one.phases[-1], **changes)))


def moved_end(one, position, euler_zyx=(0, 0, 0)):
    """The same events, the last of them at another pose."""
    phase = one.phases[-1]
    events = (*phase.events[:-1], replace(phase.events[-1], pose_world_object=Pose(position, euler_zyx=euler_zyx)))
    return with_phase(one, events=events)


def with_force(one, **changes):
    phase = one.phases[-1]
    return with_phase(one, contacts=(replace(phase.contacts[0], **changes), *phase.contacts[1:]))


def test_a_right_run_passes_all_oracles():
    for scene in (block_on(FLOOR), block_on(FLOOR, friction=0.2)):
        finding = examine(Case("floor", 0, 0, scene, "rests"))
        assert not finding.failures
        assert {ENDING, TIME, "balance", "forces", "contacts", "groups", "depth", "falls", "batch"} <= set(
            finding.asked
        )


def test_a_rest_beside_its_supports_is_not_balanced():
    one = dropped()
    assert balance.balance(one) == []
    (text,) = balance.balance(moved_end(one, (0.06, 0, 0.01)))
    assert "unbalanced" in text


def test_balance_by_forces_of_a_hundred_million_loads_is_none():
    """Two opposite points a hair apart hold the moment of a plate by that lever alone."""
    points = [(0.02, 0, -0.005), (0.02 + 1e-11, 0, 0.005), (0.02, 0.01, -0.005), (0.02, -0.01, -0.005)]
    held = Object([Box((0.08, 0.04, 0.01), name="plate")], (0.01, 0, 0))
    scene = Scene(held, Cage(points), [WEIGHT])
    contacts = balance.touches(scene, Pose())
    acts = acting(scene, WEIGHT)
    assert len(contacts) == 4
    assert balance.least_imbalance(scene, Pose(), contacts, acts, outside=True) > balance.REST


def test_a_motion_from_a_balanced_pose_is_found():
    one = dropped()
    held, last = one.phases[-1].events[-2:]
    away = replace(last, rule="slide", motion=held.motion, pose_world_object=Pose((0.01, 0, 0.01)))
    assert balance.unbalance(one) in ([], None)
    (text,) = balance.unbalance(with_phase(one, events=(*one.phases[-1].events[:-1], away)))
    assert "balance the load" in text


def block_that_goes_on():
    """A run, and the places of the phase and of the event in it where friction could hold the block."""
    one = run(make_case("block", 30).scene.changed(friction_coefficient=0.1))
    return one, *next(
        (phase, event)
        for phase in range(len(one.phases))
        for event in range(len(one.phases[phase].events))
        if one.phases[phase].events[event].note == goes_on.COULD_STAY
    )


def with_event(one, phase, event, **changes):
    old = one.phases[phase]
    events = (*old.events[:event], replace(old.events[event], **changes), *old.events[event + 1 :])
    return replace(one, phases=(*one.phases[:phase], replace(old, events=events), *one.phases[phase + 1 :]))


def test_a_motion_that_goes_on_against_coulombs_law_is_found():
    one, phase, event = block_that_goes_on()
    assert goes_on.goes_on(one) == []
    path = one.phases[phase].events[event].path
    ways = [np.array((0.0, 0.0, k * 1e-4)) for k in range(len(path))]
    aside = [Pose(pose.position_m + way, pose.quaternion_wxyz) for pose, way in zip(path, ways, strict=True)]
    for wrong in (path[::-1], tuple(aside)):
        (text,) = goes_on.goes_on(with_event(one, phase, event, path=wrong))
        assert "Coulomb's law leaves" in text


def test_a_motion_from_a_balance_that_does_not_say_so_is_found():
    one, phase, event = block_that_goes_on()
    assert balance.unbalance(one) == []
    (text,) = balance.unbalance(with_event(one, phase, event, note=None))
    assert "balance the load" in text


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"force_normal_n": 0.3}, "leave"),
        ({"force_normal_n": -0.3}, "outside its cone"),
        ({"force_tangential_n": np.array([0.2, 0.0, 0.0])}, "outside its cone"),
        ({"force_normal_n": 1e7}, "a reported force"),
        ({"gap_m": 1e-6}, "fall"),
        ({"force_normal_n": None}, "without the force"),
    ],
)
def test_falsified_forces_are_found(changes, said):
    one = dropped(friction=0.1)
    assert balance.forces(one) == []
    assert any(said in text for text in balance.forces(with_force(one, **changes)))


def test_a_balance_with_springs_moments_and_following_forces_is_asked_too():
    """A thousandth of a newton more on one foot is found, and a spring, a force or a moment that is another one."""
    spring = Spring((0, 0, 0.01), (0.0, 0.02, 0.3), 100.0, 2.0)
    follower = Force((0, 0.1, -1), (0.01, 0, 0.01), 3.0, follows=True)
    moment = Moment((1, 0, 0), 0.01, follows=True)

    def loads(spring, follower, moment):
        return [Load("all", gravity=(0, 0, -9.81), forces=[follower], springs=[spring], moments=[moment])]

    held = block_on(FLOOR).object
    heavy = Object(held.boxes, mass_kg=1.0, pose=held.pose_world_object)
    one = run(Scene(heavy, Cage(FLOOR), loads(spring, follower, moment), friction_coefficient=0.5))
    phase = one.phases[-1]
    assert one.verdict in balance.AT_REST
    assert balance.imbalance(one.scene, phase) < 1e-8
    more = with_force(one, force_normal_n=phase.contacts[0].force_normal_n + 1e-3).phases[-1]
    assert balance.imbalance(one.scene, more) > 1e-5
    for others in (
        (Spring((0, 0, 0.01), (0.0, 0.02, 0.3), 100.0, 2.1), follower, moment),
        (spring, Force((0, 0.1, -1), (0.01, 0, 0.01), 3.1, follows=True), moment),
        (spring, follower, Moment((1, 0, 0), 0.011, follows=True)),
    ):
        wrong = Scene(heavy, Cage(FLOOR), loads(*others), friction_coefficient=0.5)
        assert balance.imbalance(wrong, phase) > 1e-4


def test_a_contact_that_is_missing_is_found():
    one = dropped()
    assert balance.contacts(one) == []
    assert balance.contacts(with_phase(one, contacts=one.contacts[1:]))


@pytest.mark.parametrize(
    "told", [(0, 1, 2, 3, 4), (0, 1, 2, 3, 3), (0, 1, 2, 3, -1), (0, 1, 2, 4, 4), (0, 1, 2, 3, None)]
)
def test_a_contact_in_another_group_is_found(told):
    """The last point is on an edge, so that its two contacts are one group."""
    one = run(block_on([*FLOOR, (0.05, 0.0, 0.0)], height=0.01))
    assert groups.groups(one) == []
    phase = one.phases[-1]
    assert [contact.group for contact in phase.contacts] == [0, 1, 2, 3, 3]
    planted = [replace(contact, group=group) for contact, group in zip(phase.contacts, told, strict=True)]
    assert bool(groups.groups(with_phase(one, contacts=tuple(planted)))) == (told != (0, 1, 2, 3, 3))


def test_a_stable_rest_that_a_disturbance_ends_is_found():
    """A plate clamped between two opposite points by friction alone: it falls when they open."""
    held = Object([Box((0.02, 0.1, 0.1), name="plate")])
    scene = Scene(held, Cage([(-0.01, 0, 0), (0.01, 0, 0)]), [WEIGHT], friction_coefficient=0.5)
    one = dropped(friction=0.2)
    assert robustness.robustness(one) == []
    clamped = run(scene)
    proof = replace(one.phases[0].proof, verdict="rests", stability="stable")
    found = robustness.robustness(with_phase(clamped, verdict="rests", proof=proof))
    assert "escapes" in found[0]


@pytest.mark.parametrize(("family", "index", "phase", "word"), [("rail", 0, 0, "unstable"), ("rail", 0, 1, "stable")])
def test_a_saddle_that_is_called_a_valley_is_found_and_the_reverse(family, index, phase, word):
    """Under its weight the smooth rail rests on a saddle: it leans on a stop, and is free to turn and to shift there.
    Under the push it rests in a valley.
    """
    one = run(make_case(family, index).scene)
    end = one.phases[phase]
    alone = replace(one, phases=(end,))
    assert (end.verdict, end.proof.stability) == ("rests", word)
    assert stability.stability(alone) == []
    other = replace(end.proof, stability={"stable": "unstable", "unstable": "stable"}[word])
    assert stability.stability(with_phase(alone, proof=other))


def test_onsets_beside_rest_are_found():
    """Blocks that may rest, and for which another motion is named, are said to rest: most of them are found."""
    runs = (run(make_case("block", index).scene) for index in range(60))
    ambiguous = [one for one in runs if one.verdict == "may rest" and one.phases[-1].proof.motion is not None]
    found = []
    for one in ambiguous:
        proof = replace(one.phases[-1].proof, verdict="rests", needs_friction=True)
        found += uniqueness.uniqueness(with_phase(one, verdict="rests", proof=proof)) or []
    assert len(ambiguous) >= 3
    assert len(found) >= len(ambiguous) / 3
    assert all("allows an onset" in text for text in found)


def test_a_rest_that_is_called_by_another_word_is_found():
    one = dropped()
    assert certified.certified(one) == []
    other = run(block_on([(0.2, 0, 0)])).phases[-1].proof.motion
    proof = replace(one.phases[-1].proof, verdict="may rest", motion=other)
    (text,) = certified.certified(with_phase(one, verdict="may rest", proof=proof))
    assert "weak, and strong when it is asked again" in text


def test_a_certificate_at_a_pose_that_rests_on_other_points_is_found(monkeypatch):
    one = dropped()
    given = certified.certificate(one)
    monkeypatch.setattr(certified, "certificate", lambda *_: given)
    (text,) = certified.certified(moved_end(one, (0, 0, 0.0101)))
    assert "does not touch at this pose" in text


def test_an_onset_that_breaks_coulombs_law_does_not_count():
    rows = np.zeros((1, 3, 6))
    rows[0, :, :3] = np.eye(3)
    b = np.array([1.0, 0.5, 0, 0, 0, 0]) / np.sqrt(1.25)
    right = np.array([[b[0], 0.2 * b[0], 0.0]])
    assert uniqueness.violation(rows, b, np.full(len(rows), 0.2), right) < 1e-15
    for wrong in ([[b[0], 0.1 * b[0], 0.0]], [[0.5 * b[0], 0.0, 0.0]], [[b[0], 0.3 * b[0], 0.0]]):
        assert uniqueness.violation(rows, b, np.full(len(rows), 0.2), np.array(wrong)) > 1e-2


def test_faults_count_in_lengths_of_a_slow_motion():
    """A load of which friction leaves a millionth: a force out of its cone by as little is all of the motion."""
    rows = np.zeros((1, 3, 6))
    rows[0, :, :3] = np.eye(3)
    b, mus = np.array([1.0, 0.2 + 1e-6, 0, 0, 0, 0]), np.array([0.2])
    assert uniqueness.violation(rows, b, mus, np.array([[1.0, 0.2, 0.0]])) < 1e-9
    for wrong in ([1.0, 0.2 + 2e-6, 0.0], [1.0, 0.2 - 1e-6, 0.0], [1.0 + 1e-6, 0.2, 0.0]):
        assert uniqueness.violation(rows, b, mus, np.array([wrong])) > 0.1


def test_a_way_uphill_is_found():
    one = dropped()
    assert way.potential_falls(one) == []
    assert way.potential_falls(moved_end(one, (0, 0, 0.0101)))


def test_a_pose_inside_is_found():
    one = dropped()
    assert way.depth(one) == []
    assert way.depth(moved_end(one, (0, 0, 0.0099)))


def test_an_event_through_a_point_is_found():
    """The block falls from above its floor to below it."""
    one = dropped()
    event = one.phases[0].events[0]
    assert way.passes(one) == []
    through = replace(event.motion, distance_m=0.05)
    below = Pose((0, 0, -0.03))
    phase = replace(one.phases[0], events=(replace(event, motion=through, pose_world_object=below, path=(below,)),))
    (text,) = way.passes(replace(one, phases=(phase,)))
    assert "through the part" in text


def test_an_escape_towards_a_point_is_found():
    one = run(block_on([(0.2, 0, 0)]))
    assert one.verdict == "escapes"
    assert way.escape(one) == []
    assert way.escape(replace(one, scene=block_on([(0.04, 0, -0.5)])))


def test_another_answer_after_renumbering_is_found():
    one = dropped()
    assert order.order_of_verdicts(one) == []
    assert order.order_of_poses(one) == []
    assert order.order_of_verdicts(with_phase(one, verdict="stalled"))
    assert order.order_of_poses(moved_end(one, (1e-6, 0, 0.01)))


def test_a_row_that_differs_in_the_last_bit_is_found():
    one = dropped()
    assert order.batch(one) == []
    assert order.batch(moved_end(one, (0, 0, np.nextafter(one.pose.position_m[2], 1.0))))
    assert order.batch(with_phase(one, verdict="escapes"))


def test_a_wrong_end_is_found():
    finding = examine(Case("floor", 0, 0, block_on(FLOOR), "escapes"))
    assert [failure.oracle for failure in finding.failures] == [ENDING]


def test_an_exception_is_a_failure(monkeypatch):
    monkeypatch.setitem(ORACLES, "falls", lambda _: 1 / 0)
    finding = examine(Case("floor", 0, 0, block_on(FLOOR)))
    assert [failure.text for failure in finding.failures] == ["ZeroDivisionError: division by zero"]


@pytest.mark.parametrize("family", FAMILIES)
def test_a_case_comes_back_from_its_index_and_from_its_file(family, tmp_path):
    for index in range(3):
        scene = make_case(family, index).scene
        path = tmp_path / f"{index}.yaml"
        path.write_text(scene_yaml(scene, f"{family} {index}", ["a remark"]), encoding="utf-8")
        for again in (make_case(family, index).scene, load_scene(path)):
            assert again.cage.points_world() == pytest.approx(scene.cage.points_world(), abs=1e-15 * scene.size_m)
            assert again.size_m == pytest.approx(scene.size_m, rel=1e-14)
            assert (again.friction_coefficient or 0.0) == (scene.friction_coefficient or 0.0)
            assert [load.name for load in again.loads] == [load.name for load in scene.loads]


def test_loads_are_weighed_as_the_theory_says():
    push = Force((1, 0, 0), (0, 0, 0))
    scene = block_on(FLOOR, loads=[Load("both", gravity=(0, 0, -9.81), force=push)])
    assert [np.linalg.norm(act.force) for act in acting(scene, scene.loads[0])] == pytest.approx([1.0, 1e-6])
    heavy = Scene(
        Object(scene.object.boxes, mass_kg=2.0, pose=scene.object.pose_world_object),
        scene.cage,
        [Load("both", gravity=(0, 0, -10), force=Force((1, 0, 0), (0, 0, 0), 3.0))],
    )
    assert [np.linalg.norm(act.force) for act in acting(heavy, heavy.loads[0])] == pytest.approx([3.0, 20.0])


def pin_over_hole(beside):
    """A tapered pin of radius 4 to 8 mm that falls into a sharp hole of radius 5 mm."""
    plate = Box((0.06, 0.06, 0.03), Pose((0, 0, -0.015)), "plate")
    pin = Object(shapes=[Cone(0.004, 0.008, 0.04, Pose((0, 0, 0.02)), "pin")], pose=Pose((beside, 0, 0.002)))
    cage = Cage(shapes=[plate], holes=[Hole(0.005, 0.03, in_=("plate",))])
    return Scene(pin, cage, [WEIGHT], friction_coefficient=0.0)


def held_block():
    """A block that comes to rest on a round bar and a ball."""
    shapes = [Capsule(0.01, 0.2, Pose((-0.03, 0, 0), euler_zyx=(0, 0, np.pi / 2)))]
    shapes += [Sphere(0.01, Pose((0.03, y, 0))) for y in (-0.02, 0.02)]
    block = Object([Box((0.1, 0.1, 0.02))], pose=Pose((0, 0, 0.03)))
    return Scene(block, Cage(shapes=shapes), [WEIGHT], friction_coefficient=0.0)


def lowered(one, drop_m):
    """The last event of a run, its poses that much lower."""
    phase = one.phases[-1]
    event = phase.events[-1]

    def down(pose):
        return Pose(pose.position_m - (0, 0, drop_m), pose.quaternion_wxyz)

    path = tuple(map(down, event.path))
    event = replace(event, pose_world_object=down(event.pose_world_object), path=path)
    return with_phase(one, events=(*phase.events[:-1], event))


@pytest.mark.parametrize(
    ("scene", "lever"),
    [(pin_over_hole(0.0), np.sqrt(101.0)), (held_block(), 1.0), (block_on(FLOOR), 1.0)],
    ids=["pin", "block", "points"],
)
def test_a_path_that_is_lower_by_a_little_more_than_the_error_is_found(scene, lever):
    """The pin's surface is steep, 1 in 10: lowered by the root of 101, it is one deeper in the rim."""
    one = run(scene)
    error_m = inside.error_m(one, is_told=True)
    assert inside.inside(one) == []
    assert inside.inside(lowered(one, 0.9 * lever * error_m)) == []
    (text,) = inside.inside(lowered(one, 1.1 * lever * error_m))
    assert "sizes in the cage" in text


def test_a_way_between_its_poses_through_a_ball_is_found():
    """A block jumps from one side of its three supports to the other, without a pose between."""
    one = run(held_block())
    event = one.phases[0].events[0]
    below = Pose((0, 0, -0.05))
    through = replace(event, motion=replace(event.motion, distance_m=0.08), pose_world_object=below, path=())
    (text,) = inside.inside(with_phase(one, events=(through,)))
    assert "event 1 (free)" in text


def test_an_escape_with_something_in_its_way_is_found():
    one = run(block_on([(0.2, 0, 0)]))
    assert one.verdict == "escapes"
    assert inside.inside(one) == []
    (text,) = inside.inside(replace(one, scene=block_on([(0.04, 0, -0.1)])))
    assert "(escapes)" in text


def test_a_depth_is_that_of_arithmetic():
    """At z = -11 mm the pin has radius 5.1 mm at the mouth, whose sharp rim is (5.1 - 5) 10 / sqrt(101) mm in it."""
    one = run(pin_over_hole(0.0))
    (depth,) = inside.deepest(lowered(one, 0.001))
    assert one.pose.position_m[2] == pytest.approx(-0.01, abs=1e-9)
    assert depth.depth_m == pytest.approx(0.1e-3 * 10 / np.sqrt(101), rel=1e-6)
    assert np.hypot(*depth.place_world[:2]) == pytest.approx(0.005, abs=1e-6)
    assert depth.place_world[2] == pytest.approx(0.0, abs=1e-6)

"""The margin of a rest: what its contacts balance beside the load, how they share it, and how far they may."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import (
    Box,
    Cage,
    Chamfer,
    Cylinder,
    Hole,
    Load,
    Margin,
    Object,
    Pose,
    Run,
    Scene,
    Sphere,
    Spring,
    load_scene,
    margin,
    run,
)
from cagepose.files.document import run_document
from cagepose.studies import contact_cones as cones_module
from cagepose.studies.contact_cones import ConeProgram, ContactCones, contact_cones
from cagepose.studies.equal_stiffness import equally_stiff_forces
from cagepose.studies.extra_load import ExtraLoad, least_extra_load

A, H = 0.04, 0.03
"""The legs stand at x, y = +-A; the centre of gravity is H above them."""
LEGS = {f"leg {x:+d}{y:+d}": (x * A, y * A, -H) for x in (1, -1) for y in (1, -1)}
SCENES = Path(__file__).parents[2] / "scenes"


def cage_of(points) -> Cage:
    return Cage(list(points.values()), list(points))


def block(points, friction=0.0, height=H, cog_x=0.0, half_x=0.05, **of_object) -> Run:
    """A block whose bottom is ``height`` below its centre, at rest on what stands there."""
    held = Object([Box((2 * half_x, 0.1, 2 * height))], (cog_x, 0, 0), **of_object)
    return run(Scene(held, cage_of(points), [Load("weight", gravity=(0, 0, -9.81))], friction_coefficient=friction))


def margin_of(a_run: Run) -> Margin:
    found = margin(a_run)
    assert found is not None
    return found


def column(found: Margin, name: str) -> list[float]:
    return [getattr(contact, name) for contact in found.contacts]


def test_four_legs_carry_a_quarter_each_and_up_to_a_half() -> None:
    """Two legs on a diagonal can carry a block alone."""
    found = margin_of(block(LEGS))
    assert_allclose(column(found, "equally_stiff_n"), 0.25, rtol=1e-12)
    assert_allclose(column(found, "least_n"), 0.0, atol=1e-12)
    assert_allclose(column(found, "greatest_n"), 0.5, rtol=1e-12)
    assert (found.force_n, found.moment_nm) == (0.0, 0.0)  # nothing holds it sideways


def test_off_centre_the_lever_rule_shares_the_weight() -> None:
    """Least squares: 1/4 (1 + c x / A^2). With R = (1 + c/A) / 2 on the right pair, and L on the left, what one leg of
    a diagonal takes the other diagonal gives: a right leg has (R - L) / 2 to 1/2, a left one 0 to L.
    """
    c = 0.25 * A
    found = margin_of(block(LEGS, cog_x=c))
    x = np.array([LEGS[contact.point][0] for contact in found.contacts])
    assert_allclose(column(found, "equally_stiff_n"), 0.25 * (1 + c * x / A**2), rtol=1e-12)
    assert_allclose(column(found, "least_n"), np.where(x > 0, 0.5 * c / A, 0.0), atol=1e-12)
    assert_allclose(column(found, "greatest_n"), np.where(x > 0, 0.5, 0.5 * (1 - c / A)), rtol=1e-12)


@pytest.mark.parametrize("friction", [0.1, 0.3, 3.0])
def test_a_block_slides_or_tips_by_the_least_force(friction: float) -> None:
    """Weight 1 and a force u: it slides from |u_t| = mu (1 - u_z) on, and tips from |u_x| H = (1 - u_z) A on. From
    u = 0 these planes are s / sqrt(1 + s^2) away, with the slope s = mu or A / H.
    """
    found = margin_of(block(LEGS, friction))
    slope = min(friction, A / H)
    expected = slope / math.hypot(1.0, slope)
    assert expected * (1 - 1e-3) <= found.force_n <= expected * (1 + 1e-9)
    assert found.force_below_n == pytest.approx(expected, rel=1e-5)
    assert found.force_direction_world[2] == pytest.approx(expected, rel=1e-4)  # along the plane's normal
    assert found.moment_nm <= min(A, math.sqrt(2) * A * friction) * (
        1 + 1e-9
    )  # tipping; turning about the upright axis
    assert_allclose(column(found, "equally_stiff_n"), 0.25, rtol=1e-9)


def test_with_a_mass_the_margin_is_in_newtons() -> None:
    of_one, of_two = margin_of(block(LEGS, 0.3)), margin_of(block(LEGS, 0.3, mass_kg=2.0))
    assert (of_one.in_newtons, of_two.in_newtons) == (False, True)
    weight = 2.0 * 9.81
    assert of_two.force_n == pytest.approx(weight * of_one.force_n, rel=1e-9)
    assert of_two.moment_nm == pytest.approx(weight * of_one.moment_nm, rel=1e-9)
    assert_allclose(column(of_two, "equally_stiff_n"), 0.25 * weight, rtol=1e-9)


def test_a_ladder_gives_way_to_a_force_across_the_line_to_where_its_friction_ends() -> None:
    """At the limit both contacts slip, and the three forces meet in the corner c of the two friction cones. Between a
    foot (1, 0) / 2 and a head (0, 1) / 2 of that triangle it is found by hand; the load's line through the centre of
    gravity may turn until it passes there: weight and extra force u then point along c, and the least u is |c_x| / |c|.
    """
    mu, foot, head = 0.28, np.array([0.5, -math.sqrt(0.75)]), np.array([-0.5, math.sqrt(0.75)])
    along = np.linalg.solve(np.array([[-mu, -1.0], [1.0, -mu]]), head - foot)
    corner = foot + along[0] * np.array([-mu, 1.0])
    expected = abs(corner[0]) / math.hypot(*corner)
    found = margin_of(run(load_scene(SCENES / "ladder.yaml")))
    assert found.force_n == pytest.approx(expected, rel=1e-3)
    assert found.force_n <= expected * (1 + 1e-9)
    assert found.force_below_n == pytest.approx(expected, rel=1e-5)
    left, right = column(found, "equally_stiff_n")[::2], column(found, "equally_stiff_n")[1::2]
    assert_allclose(left, right, rtol=1e-9)  # the ladder is symmetric


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_jaws_can_press_without_end(friction: float) -> None:
    jaws = {"jaw left": (-0.05, 0, 0), "jaw right": (0.05, 0, 0)}
    found = {contact.point: contact for contact in margin_of(block(LEGS | jaws, friction)).contacts}
    assert found["jaw left"].greatest_n == found["jaw right"].greatest_n == math.inf
    assert found["jaw left"].least_n == 0.0
    assert math.isinf(found["leg +1+1"].greatest_n) == (friction > 0.0)  # the jaws can push it down by friction


def test_a_wedged_block_takes_any_force() -> None:
    """Four points hold it by friction alone: they balance whatever comes, if they press hard enough."""
    found = margin_of(run(load_scene(SCENES / "wedge.yaml")))
    assert found.force_n == found.moment_nm == math.inf
    assert column(found, "greatest_n") == [math.inf] * 4
    forces = np.array(column(found, "equally_stiff_tangential_n"))
    assert_allclose(forces.sum(axis=0), (0, 0, 1), atol=1e-12)


def test_at_an_edge_one_face_counts_at_a_time() -> None:
    """Points under the right edge, at x = B, touch bottom and side. With the side the block tips over its right legs: a
    push u_x at the height h; the legs push back by mu N, so that the points carry P = u_x + mu N beside, and lift it by
    mu P. With the upright balance N + mu P = 1 - u_z, and moments about the centre of gravity, which is A - c from the
    legs: u_x (h - k) = (1 - u_z) (A - c + mu k), k = mu (B - A) / (1 + mu^2). With the bottom it would tip over the
    edge, at (B - c) / h.
    """
    b, c, h, mu = 0.05, 0.5 * A, 0.2, 0.3
    points = {name: (x, y, -h) for name, (x, y, _) in LEGS.items()} | {"one": (b, A, -h), "other": (b, -A, -h)}
    found = margin_of(block(points, mu, height=h, cog_x=c))
    k = mu * (b - A) / (1 + mu**2)
    slope = (A - c + mu * k) / (h - k)
    assert slope < (b - c) / h
    assert found.force_n == pytest.approx(slope / math.hypot(1.0, slope), rel=1e-3)


def test_flush_faces_count_once() -> None:
    boxes = [Box((0.1, 0.1, 2 * H)), Box((0.1, 0.1, H), Pose((0, 0, -H / 2)))]
    scene = Scene(Object(boxes, (0, 0, 0)), cage_of(LEGS), [Load("weight", gravity=(0, 0, -1))])
    assert_allclose(column(margin_of(run(scene)), "equally_stiff_n"), 0.25, rtol=1e-12)


def test_the_order_of_points_changes_nothing() -> None:
    scene = load_scene(SCENES / "connector.yaml")
    names = scene.cage.names
    turned = Scene(
        scene.object,
        Cage(scene.cage.points_cage[::-1], names[::-1]),
        scene.loads,
        friction_coefficient=scene.friction_coefficient,
    )
    one, other = margin_of(run(scene)), margin_of(run(turned))
    by_name = {contact.point: contact for contact in other.contacts}
    for contact in one.contacts:
        same = by_name[contact.point]
        assert same.equally_stiff_n == pytest.approx(contact.equally_stiff_n, abs=1e-9)
        assert_allclose(same.equally_stiff_tangential_n, contact.equally_stiff_tangential_n, atol=1e-9)
        assert (same.least_n, same.greatest_n) == pytest.approx((contact.least_n, contact.greatest_n), abs=1e-6)
    assert other.force_n == pytest.approx(one.force_n, rel=2e-3)


def test_only_a_rest_has_a_margin() -> None:
    falls = run(Scene(Object([Box((1, 1, 1))]), Cage([(0, 0, 2.0)]), [Load("weight", gravity=(0, 0, -1))]))
    assert falls.verdict == "escapes"
    assert margin(falls) is None
    with pytest.raises(IndexError):
        margin(falls, 1)


def test_forces_without_bound_have_no_margin() -> None:
    """A plate between two opposite points, its weight beside them: they carry it to second order alone."""
    points = [(0, 0, -0.005), (0, 0, 0.005), (0.053, -0.02, 0), (0.053, 0.02, 0)]
    plate = Object([Box((0.1, 0.08, 0.01))], (0, 0.01, 0))
    held = run(Scene(plate, Cage(points), [Load("weight", gravity=(0.1, 0, -1))]))
    assert held.verdict == "rests"
    assert "to second order" in held.phases[0].proof.reason
    assert margin(held) is None


def test_the_document_has_the_margin_where_it_was_asked_for() -> None:
    held = block(LEGS, 0.3)
    assert "margin" not in run_document(held)["phases"][0]["proof"]
    found = run_document(held, "mm", [margin(held)])["phases"][0]["proof"]["margin"]
    json.dumps(found, allow_nan=False)
    assert found["moment"]["certain"] == pytest.approx(1000 * margin_of(held).moment_nm)
    assert [contact["equally_stiff_normal"] for contact in found["contacts"]] == pytest.approx([0.25] * 4)
    wedged = run(load_scene(SCENES / "wedge.yaml"))
    found = run_document(wedged, "mm", [margin(wedged)])["phases"][0]["proof"]["margin"]
    assert found["force"] == {"certain": "unbounded", "below": "unbounded", "direction": None}
    assert found["contacts"][0]["greatest"] == "unbounded"
    lost = run_document(replace(held, warnings=()), "mm", [None])["phases"][0]["proof"]
    assert lost["margin"] is None


def random_cones(rng: np.random.Generator, friction: float) -> tuple[ContactCones, np.ndarray]:
    """Contacts that can balance a load, of length 1."""
    n = rng.integers(4, 14)
    normals = rng.normal(size=(n, 3))
    cones = contact_cones(
        normals / np.linalg.norm(normals, axis=1)[:, None], rng.normal(size=(n, 3)), np.full(n, friction)
    )
    forces = np.abs(rng.normal(size=(n, 1))) * np.append(np.ones((n, 1)), friction * rng.uniform(-0.6, 0.6, (n, 2)), 1)
    load = cones.wrench(forces)
    return cones, load / np.linalg.norm(load)


def left_of(cones: ContactCones, load: np.ndarray) -> float:
    return float(np.linalg.norm(load - cones.wrench(equally_stiff_forces(cones, load))))


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.6])
@pytest.mark.parametrize("axes", [slice(0, 3), slice(3, 6)])
def test_all_extra_loads_inside_are_balanced_and_one_just_outside_is_not(friction: float, axes: slice) -> None:
    """Asked of another method: Newton's, for the forces themselves."""
    rng = np.random.default_rng(7)
    n_finite = 0
    for _ in range(25):
        cones, load = random_cones(rng, friction)
        program, counts = ConeProgram(cones, 1e-6), np.zeros(len(cones.columns))
        found = least_extra_load(program, load, counts, axes, math.inf)
        if math.isinf(found.certain) or found.certain == 0.0:
            continue
        n_finite += 1
        assert found.found <= 1.002 * found.certain
        for direction in [found.direction, *rng.normal(size=(6, 3))]:
            extra = np.zeros(6)
            extra[axes] = direction / np.linalg.norm(direction)
            assert left_of(cones, load - 0.9999 * found.certain * extra) < 1e-8
        extra[axes] = found.direction
        assert left_of(cones, load - 1.01 * found.found * extra) > 1e-8
    assert n_finite >= 4


def test_memory_for_rays_grows_as_they_come_in(monkeypatch: pytest.MonkeyPatch) -> None:
    """With room for the first rays alone the answers are the same, as closely as they are told."""
    found = list[ExtraLoad]()
    for room in (cones_module.ROOM, 1):
        monkeypatch.setattr(cones_module, "ROOM", room)
        cones, load = random_cones(np.random.default_rng(14), 0.4)
        program = ConeProgram(cones, 1e-6)
        before = len(program.work.contacts)
        found.append(least_extra_load(program, load, np.zeros(len(cones.columns)), slice(0, 3), math.inf))
    assert len(program.work.contacts) > before
    assert found[0].certain == pytest.approx(found[1].certain, rel=1e-3)
    assert found[0].found == pytest.approx(found[1].found, rel=1e-3)
    assert found[0].certain > 0.0


def test_a_part_that_nothing_touches_has_no_margin_and_one_under_a_spring_has_its_pull() -> None:
    """A cube on four legs, pressed down by 7 N at its middle beside its weight of 3 N: a quarter of both on each."""
    spring = Spring((0.0, 0.0, 0.0), (0.0, 0.0, -0.05), 100.0, 7.0)
    held = Object([Box((0.02, 0.02, 0.02))], mass_kg=3.0 / 9.81)
    load = Load("hold", gravity=(0.0, 0.0, -9.81), springs=[spring])
    legs = [(x, y, -0.01) for x in (-0.008, 0.008) for y in (-0.008, 0.008)]
    found = margin(run(Scene(held, Cage(legs), [load], friction_coefficient=0.3)))
    assert found is not None
    assert found.in_newtons
    assert [contact.equally_stiff_n for contact in found.contacts] == pytest.approx([2.5] * 4, rel=1e-9)
    hung = Load("hang", gravity=(0.0, 0.0, -9.81), springs=[Spring((0, 0, 0.01), (0, 0, 0.1), 100.0)])
    assert margin(run(Scene(held, Cage([(0.5, 0.5, 0.5)]), [hung]))) is None


@pytest.mark.parametrize("turn", [0.0, 0.13])
def test_a_can_tips_over_any_point_of_its_rim(turn: float) -> None:
    """Weight W on a rim of radius r, the centre of gravity h above it: a force of W sin(atan(r / h)) tips it, at right
    angles to the way from the rim to the centre, and so does a moment of W r. A run lists eight places of the rim,
    within which this would be 8 % less."""
    radius, height = 0.03, 0.1
    upright = Pose((0, 0, height), (math.cos(turn), 0, 0, math.sin(turn)))
    can = Object(shapes=[Cylinder(radius, 2 * height)], pose=upright)
    floor = Cage(shapes=[Box((0.4, 0.4, 0.02), Pose((0, 0, -0.01)), "floor")])
    found = margin_of(run(Scene(can, floor, [Load("weight", gravity=(0, 0, -9.81))], friction_coefficient=2.0)))
    assert len(found.contacts) == 8
    tips = math.sin(math.atan(radius / height))
    assert 0.998 * tips <= found.force_n <= tips
    assert found.force_n <= found.force_below_n <= tips * (1 + 1e-5)
    assert 0.998 * radius <= found.moment_nm <= radius * (1 + 1e-9)


def test_places_of_a_rim_that_lie_beside_a_face_do_not_count() -> None:
    """A can of radius r on a square stand of half width b, r cos(45 deg) < b < r: eight places of its rim lie on it,
    those between them beside its sides. By hand it tips over a side at a moment of W b."""
    radius, half = 0.01, 0.0093
    turn = (math.cos(math.pi / 16), 0, 0, math.sin(math.pi / 16))
    can = Object(shapes=[Cylinder(radius, 0.04)], pose=Pose((0, 0, 0.02), turn))
    stand = Cage(shapes=[Box((2 * half, 2 * half, 0.02), Pose((0, 0, -0.01)), "stand")])
    found = margin_of(run(Scene(can, stand, [Load("weight", gravity=(0, 0, -9.81))], friction_coefficient=5.0)))
    assert found.moment_nm <= half * (1 + 1e-9)


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize("chamfer_deg", [None, 30.0, 45.0])
def test_a_ball_leaves_a_round_seat_over_any_place_of_it(chamfer_deg: float | None, turn: float) -> None:
    """Smooth contacts all around give the forces within a cone: a weight W is in its middle, W sin a from its side, a
    the angle of the normals with the axis. Of four places it would be the cosine of 45 deg of that."""
    radius, mouth = 0.01, 0.006
    chamfer = None if chamfer_deg is None else Chamfer(0.004, math.radians(chamfer_deg))
    aslant = math.asin(mouth / radius) if chamfer_deg is None else math.radians(90.0 - chamfer_deg)
    block = Box((0.08, 0.08, 0.04), Pose((0, 0, -0.02), (math.cos(turn), 0, 0, math.sin(turn))), name="block")
    ball = Object(shapes=[Sphere(radius)], pose=Pose((0, 0, 0.02)))
    seat = Cage(shapes=[block], holes=[Hole(mouth, 0.02, chamfer, in_=["block"])])
    found = margin_of(run(Scene(ball, seat, [Load("weight", gravity=(0, 0, -9.81))])))
    assert 0.998 * math.sin(aslant) <= found.force_n <= found.force_below_n <= math.sin(aslant) * (1 + 1e-5)

"""Bodies of round parts, boxes and holes that are in each other: only what is on the surface of all touches.

The oracle asks the shapes and holes whether places are material; of bodies without holes, a first contact is the first
one with any of their parts alone.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from boundary.asked import Asked
from boundary.motions import after
from boundary.union_oracle import BODIES, first_material, is_material, peg, random_part, stack, tiles
from cagepose import Box, Pose
from cagepose.kernels.algebra.motion import Motion
from cagepose.kernels.boundary.features import FACE
from cagepose.model.boundary.features import boundary_of
from cagepose.model.hole import Hole
from cagepose.model.shapes import Convex, Cylinder, Shape, Sphere

TOUCH_M = 1e-9
BESIDE_M = 1e-6
"""How far from a contact it is asked for material."""
AGREES_M = 1e-6
POINT, NO_AXIS = np.zeros(3), (0.0, 0.0, 0.0)
KINDS = ("box", "cylinder", "cone", "sphere", "capsule", "hull")
AROUND = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)], np.float64)
DOWN, UP, LEFT, RIGHT = (0.0, 0.0, -1.0), (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)
LEDGE = [Box((1.0, 1.0, 1.0), Pose((0, 0, -0.5)), name="ledge"), Cylinder(0.25, 1.0, Pose((0, 0, 0.2)), name="post")]


def normals_at(held: Shape | np.ndarray, cage: list[Shape], position: tuple[float, float, float]) -> set[tuple]:
    """Return the normals of what touches, rounded."""
    found = Asked([held], cage, TOUCH_M).place(Pose(position))
    return {tuple(np.round(normal, 9) + 0.0) for normal in found.rows["normal"][: found.used[0]].tolist()}


@pytest.mark.parametrize(
    ("place", "normals"),
    [
        ((0.3, 0.0, 0.0), {UP, LEFT}),  # in the corner under the head
        ((0.1, 0.0, 0.0), set()),  # on the seam
        ((0.3, 0.0, -0.5), {LEFT}),
        ((0.45, 0.0, 0.0), {UP}),
    ],
)
def test_a_point_under_the_head_of_a_peg(place, normals):
    assert normals_at(POINT, peg(), place) == normals


def test_a_ball_under_the_head_of_a_peg_touches_both_and_no_rim():
    assert normals_at(Sphere(0.05), peg(), (0.35, 0.0, -0.05)) == {UP, LEFT}


def needle(way: tuple[float, float, float]) -> Convex:
    """A slender tetrahedron from its tip at the origin along a direction in the plane of x and z."""
    along = np.array(way) / np.linalg.norm(way)
    beside = np.array([(0, 0.02, 0), 0.02 * np.cross(along, (0, 1, 0)), (0, -0.02, 0)], np.float64)
    return Convex(np.stack([np.zeros(3), *(0.1 * along + beside)]))


def test_the_rim_of_a_pin_counts_only_for_normals_that_do_not_lead_into_its_head():
    """A needle in the corner under the head: its tip is on pin and head, its edges on no rim there."""
    assert normals_at(needle((1.0, 0.0, -1.0)), peg(), (0.3, 0.0, 0.0)) == {UP, LEFT}


def test_the_rim_of_a_plug_in_a_hole_that_it_fits_touches_nothing():
    """A needle in the corner between the plug and the wall of the hole."""
    block, hole = Box((2.0, 2.0, 0.8), Pose((0, 0, -0.4)), name="block"), Hole(0.3, 0.5, in_=("block",))
    plug = Cylinder(0.3, 0.4, Pose((0, 0, -0.3)), name="plug")
    assert normals_at(needle((-1.0, 0.0, 1.0)), [block, hole, plug], (0.3, 0.0, -0.1)) == {DOWN, RIGHT}


@pytest.mark.parametrize(
    ("place", "normals"),
    [
        ((0.25, 0.0, 0.0), {DOWN, LEFT}),
        ((0.2, 0.0, 0.0), set()),
        ((0.3, 0.0, 0.0), {DOWN}),
        ((0.25, 0.0, -0.2), set()),  # of the post, in the ledge
    ],
)
def test_a_point_beside_a_post_that_is_sunk_in_a_ledge(place, normals):
    assert normals_at(POINT, LEDGE, place) == normals


def test_the_corner_of_a_box_in_a_cylinder_touches_nothing():
    corner = [Box((1.0, 1.0, 1.0), Pose((-0.5, -0.5, -0.5))), Cylinder(0.25, 1.0, Pose((0, 0, -0.5)))]
    assert normals_at(POINT, corner, (0.0, 0.0, 0.0)) == {DOWN}  # of the flush tops alone
    assert normals_at(Sphere(0.1), corner, (0.1, 0.0, -0.5)) == set()


@pytest.mark.parametrize("degrees", [1.0, 10.0, 40.0])
def test_the_seam_of_two_flush_cylinders_sticks_out_nowhere(degrees):
    """The corner of a box on it touches their sides alone: no edge of the box meets a rim there."""
    pair = [Cylinder(0.3, 1.0, Pose((0, 0, -0.5))), Cylinder(0.3, 1.0, Pose((0, 0, 0.5)))]
    turn = Pose((0.0, 0.0, 0.0), euler_zyx=(-math.pi / 4, math.radians(degrees), 0.0))
    corner = Box((0.2, 0.2, 0.2), turn @ Pose((0.1, 0.1, 0.1)))
    assert normals_at(corner, pair, (0.3, 0.0, 0.0)) == {LEFT}


@pytest.mark.parametrize("name", BODIES)
def test_a_hole_has_no_contact_where_it_is_open_and_one_where_it_is_closed(name):
    """Points let go over the middles of holes fall to where there is material."""
    body = BODIES[name]()
    asked = Asked([POINT], body, TOUCH_M)
    for hole in (part for part in body if isinstance(part, Hole)):
        start = hole.pose_body_shape.transform(np.array((0.01, 0.02, 0.5)))
        asked.place(Pose(start))
        amount = asked.first(Motion(tuple(start), DOWN, 0.0, NO_AXIS), 3.0).amount
        depth = first_material(body, start, np.array(DOWN), 3.0)
        assert amount == depth or amount == pytest.approx(depth, abs=1e-8)


def test_a_hole_across_a_seam_has_its_wall_in_both_boxes():
    ball, hole = Sphere(0.1), tiles()[2].pose_body_shape.position_m
    for angle in np.linspace(0.0, 2.0 * math.pi, 25):
        out = np.array((math.cos(angle), math.sin(angle), 0.0))
        wall = normals_at(ball, tiles(), tuple(hole + 0.15 * out - (0, 0, 0.3)))
        assert wall == {tuple(np.round(out, 9) + 0.0)}


def test_a_countersink_that_ends_in_the_lower_plate_has_no_contact_at_their_seam():
    for depth in (0.1, 0.2, 0.25):
        wide = 0.5 - depth
        found = normals_at(POINT, stack(), (wide, 0.0, -depth))
        assert found == {tuple(np.round((math.sqrt(0.5), 0.0, -math.sqrt(0.5)), 9))}


def test_only_what_is_near_another_part_has_covers():
    apart = [Box((1.0, 1.0, 1.0)), Cylinder(0.2, 1.0, Pose((2, 0, 0))), Box((1.0, 1.0, 1.0), Pose((0.5, 0, 0)))]
    made = boundary_of(apart, TOUCH_M)
    assert not made.covers.size
    assert (made.features["first_cover"] == made.features["last_cover"]).all()
    made = boundary_of([*apart, Cylinder(0.1, 1.0, Pose((0, 0, 1.0)))], TOUCH_M)
    has = made.features["first_cover"] < made.features["last_cover"]
    low = made.features["point"][:, 2] < -0.4
    assert has.any()
    assert not has[low & (made.features["kind"] == FACE)].any()


def grazes(body: list[Shape], place: np.ndarray) -> bool:
    """Whether there is material within a few touch tolerances."""
    return bool(is_material(body, place + 3.0 * TOUCH_M * AROUND).any())


@pytest.mark.parametrize("name", BODIES)
def test_points_first_touch_where_there_is_material(name, cases, say):
    rng, body = np.random.default_rng(1), BODIES[name]()
    asked, wrong, met = Asked([POINT], body, TOUCH_M), [], 0
    n_cases = cases(20, 2000)
    for _ in range(n_cases):
        way = rng.normal(size=3) if rng.random() < 0.7 else np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
        way /= np.linalg.norm(way)
        aim = rng.uniform(-0.9, 0.9, 3)
        start = (aim if rng.random() < 0.7 else np.round(aim / 0.1) * 0.1) - 2.2 * way
        if is_material(body, start[None])[0]:
            continue
        asked.place(Pose(start))
        amount = min(asked.first(Motion(tuple(start), tuple(way), 0.0, NO_AXIS), 4.4).amount, 4.4)
        until = min(first_material(body, start, way, 4.4), 4.4)
        met += amount < 4.4
        if abs(amount - until) > AGREES_M and not (amount < until and grazes(body, start + amount * way)):
            wrong.append((start, way, amount, until))
    say(f"{n_cases} points dropped on {name}, {met} met: {len(wrong)} wrong")
    assert not wrong, wrong[:3]


def test_bodies_of_solids_first_touch_with_one_of_their_parts(cases, say):
    rng, wrong, met = np.random.default_rng(2), [], 0
    n_cases = cases(15, 400)
    for _ in range(n_cases):
        body = [random_part(rng, f"part{number}", KINDS) for number in range(rng.integers(2, 4))]
        held, pose, motion = random_approach(rng)
        for is_cage in (True, False):
            of_all = [body, *([part] for part in body)]
            asked = [([held], each) if is_cage else (each, [held]) for each in of_all]
            amounts = [first_amount(*bodies, pose, motion) for bodies in asked]
            met += min(amounts[1:]) < END
            if abs(amounts[0] - min(amounts[1:])) > 10.0 * TOUCH_M:
                wrong.append((body, held, pose, motion, amounts))
    say(f"first contacts of {2 * n_cases} bodies of two or three solids, {met} met: {len(wrong)} unlike their parts")
    assert not wrong, wrong[:2]


END = 5.0


def random_approach(rng: np.random.Generator) -> tuple[Shape, Pose, Motion]:
    """A part, where it begins, and a motion towards the origin."""
    way = rng.normal(size=3) if rng.random() < 0.7 else np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    way /= np.linalg.norm(way)
    pose = Pose(-2.5 * way, rng.normal(size=4) if rng.random() < 0.6 else (1.0, 0.0, 0.0, 0.0))
    axis = rng.normal(size=3)
    rate = float(rng.choice([0.0, 0.0, 0.5, 2.0]))
    motion = Motion(tuple(-2.5 * way), tuple(way), rate, tuple(axis / np.linalg.norm(axis)))
    return random_part(rng, "held", KINDS), pose, motion


def first_amount(held: list[Shape], cage: list[Shape], pose: Pose, motion: Motion) -> float:
    asked = Asked(held, cage, TOUCH_M)
    asked.place(pose)
    return min(asked.first(motion, END).amount, END)


@pytest.mark.parametrize("name", BODIES)
def test_contacts_are_on_the_surface_and_none_is_passed_over(name, cases, say):
    """At first contact there is a contact that is gone into; around each there is material, but none along its normal;
    and no place of the body has been in the part before.
    """
    rng, body, wrong, n_contacts, met = np.random.default_rng(3), BODIES[name](), [], 0, 0
    places = rng.uniform(-1.1, 1.1, (4_000, 3))
    places = places[is_material(body, places)]
    n_cases = cases(15, 400)
    for _ in range(n_cases):
        held, pose, motion = random_approach(rng)
        asked = Asked([held], body, TOUCH_M)
        asked.place(pose)
        hit = asked.first(motion, END)
        for amount in np.arange(0.05, min(hit.amount - 1e-6, END), 0.05):
            if held.holds(after(motion, pose, amount).inverse_transform(places)).any():
                wrong.append(("passed over", held, pose, motion, hit, amount))
                break
        if hit.amount > END:
            continue
        met += 1
        found = asked.place(after(motion, pose, hit.amount))
        rows = found.rows[: found.used[0]]
        arms = rows["place"] - np.array(motion.center)
        speeds = np.array(motion.velocity) + motion.rate * np.cross(motion.axis, arms)
        if not (np.einsum("ij,ij->i", speeds, rows["normal"]) > 0.0).any():
            wrong.append(("no contact at first contact", held, pose, motion, hit))
        n_contacts += len(rows)
        for row in rows:
            beside = row["place"] + BESIDE_M * AROUND
            over = row["place"] - BESIDE_M * row["normal"] + 0.01 * BESIDE_M * AROUND
            if not is_material(body, beside).any() or is_material(body, over).all():
                wrong.append(("not on the surface", held, pose, motion, hit, row["place"], row["normal"]))
    say(f"{n_contacts} contacts at {met} first contacts with {name} of {n_cases} motions: {len(wrong)} wrong")
    assert not wrong, wrong[:2]

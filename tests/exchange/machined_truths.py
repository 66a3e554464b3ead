"""Machined parts that none of our primitives make: where they end is known by hand."""

from __future__ import annotations

import math

from cagepose import Capsule, Cylinder, Force, Load, Moment, Pose, Sphere
from exchange.cad_parts import Part, ball, bar, box, cone, hexagon, prism
from exchange.machined_case import FLOOR, Case, Draw, Told, machined, pose, push, weight
from exchange.machined_parts import BELOW, CENTER, X, Y, Z, block, pin

FACING_X = (0.0, math.pi / 2, 0.0)


def roller(radius: float, length: float) -> tuple[Cylinder]:
    return (Cylinder(1e-3 * radius, 1e-3 * length, Pose(euler_zyx=FACING_X), "roller"),)


def around(radius: float) -> tuple[Sphere]:
    return (Sphere(1e-3 * radius, None, "ball"),)


def cradle(radius: float) -> Part:
    """A block whose top is hollow: half of a bore along x, its axis in the top."""
    return box((-20, -15, -15), (20, 15, 0)) - bar((-30, 0, 0), X, radius, 60)


# round grooves


@machined(2)
def roller_in_a_cradle(draw: Draw) -> Case:
    """It lies R - r below the axis."""
    wide, radius = draw(8, 12), draw(4, 7)
    told = (Told((-15, 0, 0), Z, radius - wide), Told((15, 0, 0), Z, radius - wide), Told(CENTER, Y, 0.0))
    return Case(
        roller(radius, 30), (cradle(wide),), pose((0, 0.5, 0.3), draw.angle(1), draw.angle(1)), (weight(),), told
    )


@machined(2)
def saddle_on_a_bar(draw: Draw) -> Case:
    """A cradle upside down, pressed onto a bar through its axis, hangs R - r below that."""
    wide, radius = draw(8, 12), draw(6, 7)
    told = (Told(CENTER, Z, radius - wide), Told(CENTER, Y, 0.0))
    start = pose((0, 0.4, radius - wide + 1), 0, 0, 180 + draw.angle(1))
    press = Load("press", force=Force(BELOW, CENTER, 1.0))
    return Case(cradle(wide), (pin(CENTER, X, radius, 80, "bar"),), start, (press,), told)


@machined(1)
def ball_in_a_cup(draw: Draw) -> Case:
    """A ball of radius r in a hollow of radius R lies R - r below its middle."""
    wide, radius = draw(10, 14), draw(4, 7)
    cup = box((-20, -20, -20), (20, 20, 0)) - ball(CENTER, wide)
    told = (Told(CENTER, Z, radius - wide), Told(CENTER, X, 0.0), Told(CENTER, Y, 0.0))
    return Case(around(radius), (cup,), pose((0.7, -0.4, -0.5)), (weight(),), told, off=0.02)


@machined(1)
def post_in_a_cup(draw: Draw) -> Case:
    """A post with a sharp rim of radius a stands sqrt(R^2 - a^2) below the middle of a hollow of radius R."""
    wide, radius = draw(12, 16), draw(5, 8)
    cup = box((-20, -20, -20), (20, 20, 0)) - ball(CENTER, wide)
    post = bar(CENTER, Z, radius, 6)
    height = -math.sqrt(wide**2 - radius**2)
    told = (Told(CENTER, Z, height), Told((radius, 0, 0), Z, height), Told((0, radius, 0), Z, height))
    return Case(post, (cup,), pose((0.2, 0.1, height + 1), 0, 2 + draw.angle(1)), (weight(),), told, off=0.02)


@machined(1)
def roller_over_a_hole_in_its_groove(draw: Draw) -> Case:
    """A hole from below through the bottom of a round groove does not touch a long roller."""
    wide, radius = draw(8, 12), draw(4, 7)
    plate = cradle(wide) - bar((0, 0, -20), Z, 3, 20)
    told = (Told((-15, 0, 0), Z, radius - wide), Told((15, 0, 0), Z, radius - wide))
    return Case(roller(radius, 30), (plate,), pose((0, 0.3, 0.3)), (weight(),), told, off=5e-3)


@machined(1)
def roller_in_crossing_grooves(draw: Draw) -> Case:
    wide, radius = draw(7, 9), draw(4, 6)
    plate = box((-20, -20, -15), (20, 20, 0)) - bar((-30, 0, 0), X, wide, 60) - bar((0, -30, 0), Y, wide, 60)
    told = (Told((-15, 0, 0), Z, radius - wide), Told((15, 0, 0), Z, radius - wide))
    return Case(roller(radius, 36), (plate,), pose((0, 0.3, 0.3)), (weight(),), told, off=5e-3)


@machined(1)
def ball_in_a_conical_seat(draw: Draw) -> Case:
    """A ball of radius r in a cone of half-angle a lies r / sin(a) above its tip, which is left out here."""
    radius, slope = draw(5, 7), draw(0.6, 1.4)
    seat = box((-20, -20, -20), (20, 20, 0)) - cone((0, 0, -10), Z, 1, 1 + 10 * slope, 10)
    angle = math.atan(slope)
    told = (Told(CENTER, Z, -10 - 1 / slope + radius / math.sin(angle)), Told(CENTER, X, 0.0), Told(CENTER, Y, 0.0))
    return Case(around(radius), (seat,), pose((0.4, 0.3, 4)), (weight(),), told)


# slots


def slotted(half: float, ends: float, high: float = 5) -> Part:
    """A plate with a slot along x, round at both ends."""
    cutter = (
        bar((-ends, 0, -5), Z, half, 20) + bar((ends, 0, -5), Z, half, 20) + box((-ends, -half, -5), (ends, half, 15))
    )
    return box((-30, -14, 0), (30, 14, high)) - cutter


@machined(2)
def plate_hangs_by_the_round_end_of_its_slot(draw: Draw) -> Case:
    """Upright, on a pin across its slot: the middle of the round end hangs R - r below the pin's axis."""
    half, radius, ends = draw(4, 6), draw(2, 3), draw(8, 12)
    told = (Told((ends, 0, 0), X, radius - half), Told((ends, 0, 0), Y, 0.0), Told((-30, 0, 0), Y, 0.0))
    to_left = weight("weight", (-9.81, 0, 0))
    wall = block((-60, -60, -10), (60, 60, 0), "wall")
    start = pose((-ends, 0.4, 0), draw.angle(3))
    return Case(slotted(half, ends), (pin((0, 0, 2), Z, radius, 20, "pin"), wall), start, (to_left,), told)


@machined(1)
def pin_pushed_into_the_round_end_of_a_slot(draw: Draw) -> Case:
    """A flanged pin in a slot that stands still is pushed along it."""
    half, radius, ends = draw(4, 6), draw(2, 3), draw(8, 12)
    held = bar((0, 0, -5), Z, radius, 5) + bar(CENTER, Z, half + 4, 3)
    told = (Told(CENTER, X, ends + half - radius), Told(CENTER, Y, 0.0), Told(CENTER, Z, 5.0))
    loads = (weight(), push(X, CENTER, 0.3))
    return Case(held, (slotted(half, ends),), pose((1, 0.3, 5.5), 0, draw.angle(0.3)), loads, told)


@machined(1)
def ball_on_a_slot(draw: Draw) -> Case:
    """Both edges of a slot hold a ball with its middle sqrt(r^2 - h^2) above them."""
    half, radius = draw(3, 4), draw(6, 9)
    told = (Told(CENTER, Z, 5 + math.sqrt(radius**2 - half**2)), Told(CENTER, Y, 0.0))
    return Case(around(radius), (slotted(half, 10),), pose((1, 0.6, 15)), (weight(),), told)


@machined(2)
def keyed_shaft_on_the_floor(draw: Draw) -> Case:
    """With its keyway down it stands on the two edges of that."""
    radius, half = draw(9, 12), draw(2, 3)
    shaft = bar((-25, 0, 0), X, radius, 50) - box((-30, -half, -radius - 5), (30, half, 3 - radius))
    height = math.sqrt(radius**2 - half**2)
    told = (Told((-25, 0, 0), Z, height), Told((25, 0, 0), Z, height), Told((0, 1, 0), Z, height))
    return Case(shaft, (FLOOR,), pose((0, 0, 14), 20 + draw.angle(10), draw.angle(3), 3), (weight(),), told, 0.3)


@machined(1)
def keyed_shaft_over_a_key(draw: Draw) -> Case:
    """A key that is higher than the keyway is deep lifts the shaft off the floor."""
    radius, half, deep = draw(9, 12), draw(3, 4), draw(3, 4)
    shaft = bar((-25, 0, 0), X, radius, 50) - box((-30, -half, -radius - 5), (30, half, deep - radius))
    key = block((-60, 0.2 - half, -10), (60, half - 0.2, 6), "key")
    height = 6 + radius - deep
    told = (Told((-25, 0, 0), Z, height), Told((25, 0, 0), Z, height), Told((0, 1, 0), Z, height))
    return Case(shaft, (key, FLOOR), pose((0, 0, height + 0.5), draw.angle(0.2)), (weight(),), told)


@machined(2)
def shaft_with_a_flat(draw: Draw) -> Case:
    """It rolls onto its flat, which is f from the axis."""
    radius, flat = draw(9, 12), draw(5, 7)
    shaft = bar((-25, 0, 0), X, radius, 50) - box((-30, -20, -20), (30, 20, -flat))
    told = (Told((-25, 0, 0), Z, flat), Told((25, 0, 0), Z, flat), Told((0, 1, 0), Z, flat))
    return Case(
        shaft,
        (FLOOR,),
        pose((0, 0, 15), 10 + draw.angle(10), draw.angle(2), 25 + draw.angle(10)),
        (weight(),),
        told,
        0.4,
    )


@machined(2)
def half_round_bar_rocks_level(draw: Draw) -> Case:
    """Let go aslant it comes to lie with its flat side level, R above the floor."""
    radius = draw(9, 12)
    part = bar((-15, 0, 0), X, radius, 30) & box((-30, -20, -20), (30, 20, 0))
    told = (Told(CENTER, Z, radius), Told((0, 1, 0), Z, radius), Told((10, 0, 0), Z, radius))
    return Case(part, (FLOOR,), pose((0, 0, 16), 0, draw.angle(1), 20 + draw.angle(10)), (weight(),), told)


# bores


def hub(bore: float, half: float) -> Part:
    """A ring along y with a keyway at its top, h to each side."""
    return bar((0, -5, 0), Y, bore + 8, 10) - bar((0, -10, 0), Y, bore, 20) - box((-half, -10, 0), (half, 10, bore + 4))


@machined(2)
def hub_hangs_by_its_keyway(draw: Draw) -> Case:
    """A pin under a keyway touches both of its edges."""
    bore, half, radius = draw(10, 12), draw(2, 3), draw(5, 7)
    drop = math.sqrt(bore**2 - half**2) - math.sqrt(radius**2 - half**2)
    told = (Told(CENTER, Z, -drop), Told(CENTER, X, 0.0), Told((0, 0, 10), X, 0.0))
    start = pose((0.3, 0, 0.2), 0, 2 + draw.angle(1))
    return Case(hub(bore, half), (pin(CENTER, Y, radius, 40, "pin"),), start, (weight(),), told)


@machined(1)
def hub_hangs_by_its_bore(draw: Draw) -> Case:
    """With a keyway to either side it hangs by its bore, R - r down."""
    bore, radius = draw(10, 12), draw(5, 7)
    whole = bar((0, -5, 0), Y, bore + 8, 10) - bar((0, -10, 0), Y, bore, 20)
    part = whole - box((-bore - 4, -10, -2), (bore + 4, 10, 2))
    told = (Told(CENTER, Z, radius - bore), Told(CENTER, X, 0.0))
    return Case(part, (pin(CENTER, Y, radius, 40, "pin"),), pose((0.4, 0, 0)), (weight(),), told)


@machined(2)
def split_ring_on_a_pin(draw: Draw) -> Case:
    """The gap of a ring is its light side, and turns up: the pin touches both ends of the bore."""
    bore, half, radius = draw(10, 12), draw(2, 3), draw(5, 7)
    ring = bar((0, -3, 0), Y, bore + 3, 6) - bar((0, -10, 0), Y, bore, 20) - box((-half, -10, 0), (half, 10, bore + 9))
    drop = math.sqrt(bore**2 - half**2) - math.sqrt(radius**2 - half**2)
    told = (Told(CENTER, Z, -drop), Told(CENTER, X, 0.0), Told((0, 0, 10), X, 0.0))
    start = pose((0.3, 0, 0.2), 0, 5 + draw.angle(2))
    return Case(ring, (pin(CENTER, Y, radius, 40, "pin"),), start, (weight(),), told)


# cross holes in what is round


@machined(2)
def shaft_hangs_by_its_cross_hole(draw: Draw) -> Case:
    """A pin through a cross hole: the hole's axis is R - r below the pin's."""
    outer, hole, radius = draw(8, 10), draw(3, 4), draw(1.5, 2.5)
    shaft = bar((0, 0, -50), Z, outer, 60) - bar((0, -20, 0), Y, hole, 40)
    told = (Told(CENTER, Z, radius - hole), Told(CENTER, X, 0.0), Told((0, 0, -50), X, 0.0))
    start = pose(CENTER, 0, 10 + draw.angle(5))
    return Case(shaft, (pin(CENTER, Y, radius, 60, "pin"),), start, (weight(),), told, off=2e-3)


@machined(1)
def shaft_with_a_cross_hole_on_the_floor(draw: Draw) -> Case:
    outer, hole = draw(8, 10), draw(3, 4)
    shaft = bar((-25, 0, 0), X, outer, 50) - bar((0, -20, 0), Y, hole, 40)
    told = (Told((-25, 0, 0), Z, outer), Told((25, 0, 0), Z, outer))
    start = pose((0, 0, 12), 20 + draw.angle(10), 3, 30 + draw.angle(20))
    return Case(shaft, (FLOOR,), start, (weight(),), told, 0.2, off=2e-3)


@machined(1)
def ball_on_the_rim_of_a_cross_hole(draw: Draw) -> Case:
    """The rim is highest along the shaft: there, a to each side, it holds a ball at R + sqrt(r^2 - a^2), if that is
    flat enough across.
    """
    outer, hole, radius = draw(14, 16), draw(4, 5), draw(6, 7)
    shaft = bar((-25, 0, 0), X, outer, 50) - bar((0, 0, 0), Z, hole, 30)
    told = (Told(CENTER, Z, outer + math.sqrt(radius**2 - hole**2)),)
    return Case(around(radius), (shaft,), pose((0.3, 0, outer + radius + 1)), (weight(),), told, off=5e-3)


# fillets inside and outside


@machined(2)
def ball_in_a_fillet(draw: Draw) -> Case:
    """A ball of radius r lies in a hollow rounding of radius R, pulled into the corner."""
    wide, radius = draw(8, 12), draw(3, 6)
    whole = box((-20, -20, -8), (20, 20, 0)) + box((-20, 15, -8), (20, 20, 30))
    corner = Part(whole.rounded(wide, lambda middle: middle[1] == 15 and middle[2] == 0), (), whole.level)
    place = (wide - radius) / math.sqrt(2)
    told = (Told(CENTER, Y, 15 - wide + place), Told(CENTER, Z, wide - place))
    diagonal = weight("weight", (0, 9.81, -9.81))
    return Case(around(radius), (corner,), pose((0, 15 - wide, wide + 1)), (diagonal,), told)


@machined(1)
def ball_too_large_for_its_fillet(draw: Draw) -> Case:
    """It touches wall and floor, and not the rounding."""
    wide, radius = draw(2, 4), draw(6, 9)
    whole = box((-20, -20, -8), (20, 20, 0)) + box((-20, 15, -8), (20, 20, 30))
    corner = Part(whole.rounded(wide, lambda middle: middle[1] == 15 and middle[2] == 0), (), whole.level)
    told = (Told(CENTER, Y, 15 - radius), Told(CENTER, Z, radius))
    return Case(around(radius), (corner,), pose((0, 0, 12)), (weight("weight", (0, 5, -9.81)),), told)


@machined(2)
def roller_in_a_filleted_pocket(draw: Draw) -> Case:
    """A milled pocket with round corners: a post is pushed into one of them."""
    corner, radius = draw(6, 8), draw(3, 5)
    inner = box((-20, -12, -8), (20, 12, 5))
    cutter = Part(inner.rounded(corner, lambda at: abs(at[0]) == 20 and abs(at[1]) == 12), (), inner.level)
    post, place = bar(CENTER, Z, radius, 12), (corner - radius) / math.sqrt(2)
    diagonal = (math.sqrt(0.5), math.sqrt(0.5), 0.0)
    told = (
        Told(CENTER, diagonal, (32 - 2 * corner + 2 * place) / math.sqrt(2)),
        Told(CENTER, X, 20 - corner + place),
        Told(CENTER, Z, -8.0),
    )
    loads = (weight(), push((1, 1, 0), (0, 0, 1), 0.2))
    return Case(post, (box((-30, -20, -12), (30, 20, 0)) - cutter,), pose((0, 0, -7), 0, draw.angle(0.2)), loads, told)


@machined(1)
def rounded_edge_against_a_step(draw: Draw) -> Case:
    """A block with one round edge is pushed along the floor against a step that is lower than the rounding."""
    radius, step = draw(4, 6), draw(1, 2)
    sharp = box((-20, -15, 0), (20, 15, 20))
    part = Part(sharp.rounded(radius, lambda middle: middle[0] == 20 and middle[2] == 0), (), sharp.level)
    gap = radius - math.sqrt(radius**2 - (radius - step) ** 2)
    told = (Told(CENTER, X, 5 + gap), Told(CENTER, Z, 0.0), Told((20, 0, 20), X, 25 + gap))
    stop = block((25, -40, -5), (50, 40, step), "step")
    return Case(part, (stop, FLOOR), pose((0, 0, 0.5)), (weight(), push(X, (0, 0, 5), 0.1)), told)


@machined(1)
def stepped_shaft_with_a_fillet_on_the_floor(draw: Draw) -> Case:
    """A rounding between two diameters is a torus, which stays facets: it touches nothing here."""
    thick, thin = draw(10, 12), draw(6, 7)
    whole = bar((-25, 0, 0), X, thick, 25) + bar(CENTER, X, thin, 20) + bar((20, 0, 0), X, thick, 10)
    solid = whole.rounded(1.5, lambda at: at[0] == 0 and abs(math.hypot(at[1], at[2]) - thin) < 1e-3)
    told = (Told((-25, 0, 0), Z, thick), Told((30, 0, 0), Z, thick))
    shaft = Part(solid, (), whole.level)
    return Case(shaft, (FLOOR,), pose((0, 0, 14), 10, 3), (weight(),), told, 0.2, off=0.05)


# hexagons, forks, domes


@machined(2)
def socket_screw_turned_on_its_key(draw: Draw) -> Case:
    """A hexagon pocket in a round head, upside down on a key: a moment turns it until corners meet flats."""
    flats, play = draw(8, 10), draw(0.2, 0.5)
    screw = (bar(CENTER, Z, 9, 10) + bar((0, 0, 10), Z, 5, 25)) - prism(hexagon(flats), -5, 6)
    key = prism(hexagon(flats - play), -30, 5)
    turn = math.pi / 6 - math.acos(math.sqrt(3) / 2 * flats / (flats - play))
    turned = Load("turn", gravity=(0, 0, -9.81), moments=[Moment(Z, 0.003)])
    told = (Told((10, 0, 0), Y, 10 * math.sin(turn)), Told(CENTER, Z, -1.0), Told(CENTER, X, 0.0), Told(CENTER, Y, 0.0))
    return Case(screw, (key,), pose((0, 0, -0.5)), (weight(), turned), told)


@machined(2)
def roller_in_a_fork_with_a_round_bottom(draw: Draw) -> Case:
    wide, radius = draw(6, 9), draw(4, 5)
    fork = box((-6, -15, -20), (6, 15, 15)) - bar((-20, 0, 0), X, wide, 40) - box((-20, -wide, 0), (20, wide, 30))
    told = (Told((-15, 0, 0), Z, radius - wide), Told((15, 0, 0), Z, radius - wide), Told(CENTER, Y, 0.0))
    return Case(roller(radius, 40), (fork,), pose((0, 0.5, 8), 0, draw.angle(1)), (weight(),), told)


@machined(1)
def link_with_round_ends_hangs(draw: Draw) -> Case:
    """A link, round at both ends, with a hole in each, turns down on a pin."""
    half, hole, radius = draw(8, 10), draw(4, 5), draw(2, 3)
    link = bar((0, -3, 0), Y, half, 6) + bar((0, -3, -40), Y, half, 6) + box((-half, -3, -40), (half, 3, 0))
    link = link - bar((0, -10, 0), Y, hole, 20) - bar((0, -10, -40), Y, hole, 20)
    told = (Told(CENTER, Z, radius - hole), Told(CENTER, X, 0.0), Told((0, 0, -40), X, 0.0))
    return Case(link, (pin(CENTER, Y, radius, 40, "pin"),), pose(CENTER, 0, 20 + draw.angle(10)), (weight(),), told)


@machined(2)
def button_rocks_on_its_dome(draw: Draw) -> Case:
    """A cut ball stands on its round side: the flat one comes to be level."""
    radius, flat = draw(12, 15), draw(4, 6)
    part = ball(CENTER, radius) & box((-20, -20, -20), (20, 20, -flat))
    told = (Told((0, 0, -flat), Z, radius - flat), Told((5, 0, 0), Z, radius), Told((0, 5, 0), Z, radius))
    return Case(part, (FLOOR,), pose((0, 0, radius + 2), 0, 12 + draw.angle(5), 5), (weight(),), told, 0.3)


@machined(1)
def bar_with_a_ball_end_on_a_taper(draw: Draw) -> Case:
    """A stud with a round end, cut from a ball, stands in a cone."""
    radius = draw(6, 8)
    stud = (ball(CENTER, radius) & box((-20, -20, -20), (20, 20, 0))) + bar(CENTER, Z, radius, 4)
    seat = box((-20, -20, -20), (20, 20, 0)) - cone((0, 0, -10), Z, 1, 11, 10)
    told = (Told(CENTER, Z, -11 + radius * math.sqrt(2)), Told(CENTER, X, 0.0), Told(CENTER, Y, 0.0))
    guide = Capsule(0.001, 0.02, Pose((0.05, 0, 0)), "aside")
    return Case(stud, (seat, guide), pose((0.3, 0.2, 2)), (weight(),), told)

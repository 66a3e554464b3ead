"""Machined parts that are a few of our primitives together: those say where they end."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from cagepose import Box, Cone, Convex, Cylinder, Load, Moment, Pose
from exchange.cad_parts import Part, Vector, ball, bar, box, cone, hexagon, prism
from exchange.machined_case import FLOOR, Case, Draw, Told, machined, pose, push, weight

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
BACK, BELOW = (-1.0, 0.0, 0.0), (0.0, 0.0, -1.0)
CENTER = (0.0, 0.0, 0.0)


def block(low: Vector, high: Vector, name: str) -> Box:
    """Return a box of a cage that is no part."""
    bottom, top = np.array(low), np.array(high)
    return Box(1e-3 * (top - bottom), Pose(1e-3 * (top + bottom) / 2.0), name)


def pin(at: Vector, along: Vector, radius: float, length: float, name: str) -> Cylinder:
    """Return a pin of a cage that is no part, by its middle."""
    turned = {X: (0, math.pi / 2, 0), Y: (0, 0, -math.pi / 2), Z: (0, 0, 0)}[along]
    return Cylinder(1e-3 * radius, 1e-3 * length, Pose(1e-3 * np.array(at), euler_zyx=turned), name)


# grooves


@machined(1)
def grooved_shaft_on_two_plates(draw: Draw) -> Case:
    """A shaft lies with the bottom of its two grooves on two plates, and is pushed along until a flank stops it."""
    outer, inner, half, plate = draw(9, 12), draw(6, 8), draw(4, 7) / 2, draw(2, 3) / 2
    ends = [-40, -20 - half, -20 + half, 20 - half, 20 + half, 40]
    shaft = bar((ends[0], 0, 0), X, outer, ends[1] - ends[0])
    for k, radius in enumerate((inner, outer, inner, outer), 1):
        shaft = shaft + bar((ends[k], 0, 0), X, radius, ends[k + 1] - ends[k])
    plates = [block((x - plate, -30, -30), (x + plate, 30, 0), f"plate at {x}") for x in (-20, 20)]
    told = (Told(CENTER, X, half - plate), Told((-40, 0, 0), Z, inner), Told((40, 0, 0), Z, inner))
    start = pose((0.1, 0, inner + 2), 0, draw.angle(0.5))
    return Case(shaft, tuple(plates), start, (weight(), push(X, CENTER, 0.4)), told, 0.1)


@machined(1)
def key_in_a_milled_groove(draw: Draw) -> Case:
    wide, deep, play = draw(8, 12), draw(4, 6), draw(0.1, 0.5)
    plate = box((-30, -20, -10), (30, 20, 0)) - box((-40, -wide / 2, -deep), (40, wide / 2, 5))
    plate = plate.as_twin(
        box((-30, -20, -10), (30, 20, -deep)),
        box((-30, -20, -deep), (30, -wide / 2, 0)),
        box((-30, wide / 2, -deep), (30, 20, 0)),
    )
    key = box((-12, -wide / 2 + play, 0), (12, wide / 2 - play, 8))
    start = pose((0, play / 3, 1), draw.angle(0.3), draw.angle(2), draw.angle(2))
    return Case(key, (plate,), start, (weight(), push(Y, (8, 0, 4), 0.3)), (), 0.1)


@machined(2)
def bar_in_a_v_groove(draw: Draw) -> Case:
    """A bar of radius r in a groove of 90 degrees lies r sqrt(2) above its bottom."""
    radius, deep = draw(5, 7), 12.0
    plate = box((-30, -25, -20), (30, 25, 0)) - prism([(-deep, 0), (0, -deep), (deep, 0)], -40, 40, axis=0)
    sides = [
        [(-25, -20), (0, -20), (0, -deep), (-deep, 0), (-25, 0)],
        [(25, 0), (deep, 0), (0, -deep), (0, -20), (25, -20)],
    ]
    plate = plate.as_twin(*(prism(side, -30, 30, axis=0) for side in sides))
    rod = bar((-20, 0, 0), X, radius, 40)
    height = radius * math.sqrt(2) - deep
    told = (Told((-20, 0, 0), Z, height), Told((20, 0, 0), Z, height), Told((20, 0, 0), Y, 0.0))
    start = pose((0, draw.angle(1), 4), 0, draw.angle(3))
    return Case(rod, (plate,), start, (weight(),), told)


@machined(1)
def tube_in_a_ring_groove(draw: Draw) -> Case:
    """A tube stands in a groove around a boss, and is pushed against its wall."""
    inner, outer, deep, play = draw(8, 11), draw(16, 19), draw(3, 5), draw(0.2, 0.6)
    plate = bar((0, 0, -12), Z, 25, 12) - (bar((0, 0, -deep), Z, outer, 10) - bar((0, 0, -deep), Z, inner, 10))
    ring = bar((0, 0, -deep), Z, 25, deep).bored(CENTER, BELOW, outer, deep)
    plate = plate.as_twin(bar((0, 0, -12), Z, 25, 12 - deep), ring, bar((0, 0, -deep), Z, inner, deep))
    tube = bar(CENTER, Z, outer - play, 20).bored((0, 0, 20), BELOW, inner + play, 20)
    start = pose((play / 4, 0, 0.5), 0, draw.angle(0.5))
    told = (Told(CENTER, Z, -deep), Told(CENTER, X, play))
    return Case(tube, (plate,), start, (weight(), push(X, (0, 0, 0.5), 0.2)), told)


@machined(1)
def dovetail_slide(draw: Draw) -> Case:
    wide, deep, play = draw(12, 16) / 2, draw(5, 7), draw(0.2, 0.6)
    mouth = wide - deep / math.sqrt(3)
    plate = box((-30, -25, -20), (30, 25, 0)) - prism(
        [(mouth, 0), (wide, -deep), (-wide, -deep), (-mouth, 0)][::-1], -40, 40, axis=0
    )
    plate = plate.as_twin(
        box((-30, -25, -20), (30, 25, -deep)),
        prism([(-25, -deep), (-wide, -deep), (-mouth, 0), (-25, 0)], -30, 30, axis=0),
        prism([(25, 0), (mouth, 0), (wide, -deep), (25, -deep)], -30, 30, axis=0),
    )
    tail = [(-wide + play, 0), (wide - play, 0), (mouth - play, deep), (-mouth + play, deep)]
    slide = prism(tail, -15, 15, axis=0)
    start = pose((0, 0, -deep + play / 8), draw.angle(0.1))
    loads = (weight(), push(Y, (3, 0, 2), 0.4), push(Z, (5, 1, 2), 3.0, "pull"))
    return Case(slide, (plate,), start, loads)


# cross holes


@machined(2)
def block_with_cross_holes_hangs_on_a_pin(draw: Draw) -> Case:
    """Two holes pass each other in a block, which hangs on a pin in one of them, R - r below."""
    radius, held = draw(5, 7), draw(3, 4)
    part = box((-15, -10, -40), (15, 10, 10)).bored((0, -10, 0), Y, radius, 20).bored((-15, 0, -25), X, 4, 30)
    start = pose((0, 0, 0), 0, draw.angle(20))
    told = (Told(CENTER, Z, held - radius), Told((0, 0, -40), X, 0.0), Told(CENTER, X, 0.0))
    return Case(part, (pin(CENTER, Y, held, 60, "pin"),), start, (weight(),), told)


@machined(2)
def clevis_on_a_bolt(draw: Draw) -> Case:
    """A fork with a hole across both tines turns down from where it is let go."""
    radius, held, tine = draw(4, 6), draw(2, 3), draw(4, 6)
    whole = box((-10, -15, -40), (10, 15, 10)) - box((-20, -15 + tine, -30), (20, 15 - tine, 20))
    part = whole - bar((0, -30, 0), Y, radius, 60)
    near = box((-10, -15, -30), (10, -15 + tine, 10)).bored((0, -15, 0), Y, radius, tine)
    far = box((-10, 15 - tine, -30), (10, 15, 10)).bored((0, 15 - tine, 0), Y, radius, tine)
    part = part.as_twin(near, far, box((-10, -15, -40), (10, 15, -30)))
    told = (Told(CENTER, Z, held - radius), Told((0, 0, -40), X, 0.0), Told(CENTER, X, 0.0))
    start = pose((0, 0, 0), 0, 25 + draw.angle(10))
    return Case(part, (pin(CENTER, Y, held, 60, "bolt"),), start, (weight(),), told)


# slots


@machined(2)
def plate_with_a_slot_and_a_hole_on_pins(draw: Draw) -> Case:
    wide, radius, play = draw(5, 7), draw(4, 5), draw(0.1, 0.4)
    part = box((-30, -15, 0), (30, 15, 5)) - box((-24, -wide / 2, -5), (-10, wide / 2, 10))
    part = part.as_twin(
        box((-30, -15, 0), (-24, 15, 5)),
        box((-24, -15, 0), (-10, -wide / 2, 5)),
        box((-24, wide / 2, 0), (-10, 15, 5)),
        box((-10, -15, 0), (0, 15, 5)),
        box((0, -15, 0), (30, 15, 5)).bored((15, 0, 5), BELOW, radius, 5),
    )
    part = replace(part - bar((15, 0, -5), Z, radius, 20), twin=part.twin)
    pins = pin((-17, 0, 5), Z, wide / 2 - play, 10, "slot pin"), pin((15, 0, 5), Z, radius - play, 10, "hole pin")
    start = pose((0, 0, 0.5), draw.angle(0.1))
    loads = (weight(), push(Y, (28, 0, 2), 0.5), push(X, (0, -10, 2), 0.5, "aside"))
    return Case(part, (*pins, FLOOR), start, loads, (), 0.1)


# counterbores


def counterbored(shank: float, head: float, deep: float) -> Part:
    plate = box((-20, -20, -15), (20, 20, 0)) - bar((0, 0, -deep), Z, head, 20) - bar((0, 0, -20), Z, shank, 30)
    lower = box((-20, -20, -15), (20, 20, -deep)).bored((0, 0, -deep), BELOW, shank, 15 - deep)
    return plate.as_twin(lower, box((-20, -20, -deep), (20, 20, 0)).bored(CENTER, BELOW, head, deep))


@machined(2)
def cap_screw_in_a_counterbore(draw: Draw) -> Case:
    """The head lands on the shoulder, and the shank is pushed against the bore."""
    shank, head, deep, play = draw(4, 6), draw(9, 11), draw(5, 7), draw(0.2, 0.6)
    screw = bar((0, 0, -20), Z, shank - play, 20) + bar(CENTER, Z, head - 2 * play, 5)
    start = pose((0, 0, 1), 0, draw.angle(0.2))
    told = (Told(CENTER, Z, -deep), Told(CENTER, X, play), Told((0, 0, 5), X, play))
    loads = (weight(), push(X, (0, 0, -0.5), 0.2))
    return Case(screw, (counterbored(shank, head, deep),), start, loads, told)


@machined(1)
def counterbored_plate_on_a_stepped_post(draw: Draw) -> Case:
    """Upside down, it hangs with its shoulder on the post."""
    shank, head, deep, play = draw(4, 6), draw(9, 11), draw(5, 7), draw(0.2, 0.6)
    thick = pin((0, 0, -25), Z, head - play, 50, "post")
    thin = pin((0, 0, 5), Z, shank - play / 2, 10, "tip")
    start = pose((0, 0, -deep + 0.5), 0, draw.angle(0.3), 180)
    told = tuple(Told(at, Z, -deep) for at in (CENTER, (10, 0, 0), (0, 10, 0)))
    return Case(counterbored(shank, head, deep), (thick, thin), start, (weight(),), told, 0.1)


@machined(2)
def countersunk_screw(draw: Draw) -> Case:
    """Its cone centres itself in the cone of the hole."""
    shank, wide = draw(3, 4), draw(3, 5)
    play = draw(0.2, 0.6)
    plate = box((-20, -20, -15), (20, 20, 0)).bored(CENTER, BELOW, shank, 15, (wide, math.radians(45)))
    screw = cone(CENTER, Z, shank - play, shank + wide - play, wide) + bar((0, 0, -8), Z, shank - play, 8)
    start = pose((0.02, 0, 0.5 - wide), 0, draw.angle(0.2))
    return Case(screw, (plate,), start, (weight(),), (Told(CENTER, Z, -wide - play),))


# fillets outside, and chamfers


@machined(1)
def block_with_round_edges_falls_on_the_floor(draw: Draw) -> Case:
    a, b, c, radius = draw(8, 12), draw(6, 9), draw(4, 5), draw(1, 3)
    sharp = box((-a, -b, -c), (a, b, c))
    core = [
        (x, y, z) for x in (radius - a, a - radius) for y in (radius - b, b - radius) for z in (radius - c, c - radius)
    ]
    part = Part(sharp.rounded(radius), (Convex(1e-3 * np.array(core), 1e-3 * radius, None, "0"),), sharp.level)
    start = pose((0, 0, 20), 20, 25 + draw.angle(5), 12 + draw.angle(5))
    return Case(part, (FLOOR,), start, (weight(),), (), 0.5 if draw.random is None else 0.2)


@machined(1)
def plate_with_round_corners_in_a_corner(draw: Draw) -> Case:
    """Its upright edges alone are round: two blocks and four cylinders."""
    a, b, radius = draw(14, 18), draw(9, 12), draw(3, 5)
    sharp = box((-a, -b, 0), (a, b, 6))
    solid = sharp.rounded(radius, lambda middle: abs(middle[0]) == a and abs(middle[1]) == b)
    rounds = [bar((x, y, 0), Z, radius, 6) for x in (radius - a, a - radius) for y in (radius - b, b - radius)]
    part = Part(solid, (), sharp.level).as_twin(
        box((radius - a, -b, 0), (a - radius, b, 6)), box((-a, radius - b, 0), (a, b - radius, 6)), *rounds
    )
    walls = block((30, -50, -5), (40, 50, 20), "wall"), block((-50, 30, -5), (50, 40, 20), "other wall")
    start = pose((8, 10, 1), 30 + draw.angle(8))
    return Case(part, (FLOOR, *walls), start, (weight(), push((1, 0.5, 0), (0, 0, 3), 0.6)))


@machined(1)
def chamfered_block_in_a_corner(draw: Draw) -> Case:
    a, b, width = draw(10, 12), draw(8, 9), draw(2, 4)
    sharp = box((-a, -b, 0), (a, b, 10))
    corners = [(a, width - b), (a, b - width), (a - width, b), (width - a, b)]
    part = Part(
        sharp.chamfered(width, lambda middle: abs(middle[0]) == a and abs(middle[1]) == b),
        prism([*corners, *(-np.array(corners))], 0, 10).twin,
        sharp.level,
    )
    walls = block((20, -50, -5), (30, 50, 20), "wall"), block((-50, 20, -5), (50, 30, 20), "other wall")
    start = pose((2, 3, 0.5), 40 + draw.angle(10), draw.angle(1))
    return Case(part, (FLOOR, *walls), start, (weight(), push((1, 1, 0), (1, 0, 5), 0.5)), (), 0.2)


@machined(2)
def chamfered_pin_in_a_chamfered_hole(draw: Draw) -> Case:
    """A little beside the hole and aslant, it finds in, and stands on the bottom."""
    radius, width, play = draw(5, 6), draw(1, 2), draw(0.1, 0.5)
    plate = box((-20, -20, -20), (20, 20, 0)).bored(CENTER, BELOW, radius, 15, (width, math.radians(45)))
    thin = radius - play
    shaft = cone(CENTER, Z, thin - width, thin, width) + bar((0, 0, width), Z, thin, 30)
    start = pose((play + width / 2, 0, 0.5), 0, draw.angle(0.2))
    return Case(shaft, (plate,), start, (weight(),), (Told(CENTER, Z, -15.0),))


@machined(1)
def ball_in_a_countersink(draw: Draw) -> Case:
    """A ball of radius r in a cone of half-angle a lies with its middle r / sin(a) above the tip."""
    radius, hole, angle = draw(6, 8), draw(2, 3), math.radians(draw(40, 50))
    width = 9 - hole
    plate = box((-20, -20, -20), (20, 20, 0)).bored(CENTER, BELOW, hole, 20, (width, angle))
    tip = -(hole + width) / math.tan(angle)
    told = (Told(CENTER, Z, tip + radius / math.sin(angle)), Told(CENTER, X, 0.0), Told(CENTER, Y, 0.0))
    return Case(ball(CENTER, radius), (plate,), pose((1 + draw.angle(1), 0.5, 9)), (weight(),), told)


# threads as cylinders, and nuts


@machined(2)
def bolt_with_a_drawn_thread(draw: Draw) -> Case:
    """Head, shank, relief and thread of a bolt that stands in a plate's hole and is pushed at its head."""
    shank, flats, play = draw(4, 5), draw(13, 16), draw(0.2, 0.6)
    bolt = prism(hexagon(flats), 0, 6) + bar((0, 0, -15), Z, shank, 15) + bar((0, 0, -18), Z, shank - 1, 3)
    bolt = bolt + bar((0, 0, -30), Z, shank - 0.4, 12)
    plate = box((-25, -25, -25), (25, 25, 0)).bored(CENTER, BELOW, shank + play, 25)
    start = pose((0, 0, 0.5), 10, draw.angle(0.2))
    told = (Told(CENTER, Z, 0.0), Told(CENTER, X, play))
    return Case(bolt, (plate,), start, (weight(), push(X, (0, 0, 0.2), 0.2)), told)


@machined(1)
def stud_leans_in_its_hole(draw: Draw) -> Case:
    core, thread, play = draw(3, 4), draw(4.2, 5), draw(0.2, 0.5)
    stud = bar(CENTER, Z, thread, 12) + bar((0, 0, 12), Z, core, 4) + bar((0, 0, 16), Z, thread, 25)
    plate = box((-25, -25, -20), (25, 25, 0)).bored(CENTER, BELOW, thread + play, 14)
    start = pose((play / 2, 0, -10), draw.angle(5))
    return Case(stud, (plate,), start, (weight(), push(X, (0, 0, 38), 0.3)), (), 0.1)


def nut(flats: float, radius: float, high: float) -> Part:
    return prism(hexagon(flats), 0, high).bored((0, 0, high), BELOW, radius, high, (0.5, math.radians(45)))


@machined(2)
def nut_over_a_stud(draw: Draw) -> Case:
    """It drops over a stud, lands on the plate, and is pushed against the stud: flat, as its face is wide."""
    radius, flats, play = draw(4, 5), draw(14, 17), draw(0.3, 0.7)
    stud = pin((0, 0, 10), Z, radius - play, 20, "stud")
    start = pose((play / 3, 0, 9), 15, draw.angle(1))
    told = (Told(CENTER, Z, 0.0), Told(CENTER, X, play))
    return Case(nut(flats, radius, 7), (stud, FLOOR), start, (weight(), push(X, (0, 0, 1), 0.3)), told)


@machined(2)
def nut_falls_over(draw: Draw) -> Case:
    """It stands on one of its edges and falls onto a flat, or lies down."""
    flats, high = draw(14, 17), draw(7, 9)
    start = pose((0, 0, 12), 0, 90 + 12 + draw.angle(8), 0)
    return Case(nut(flats, 4, high), (FLOOR,), start, (weight(),), (), 0.4)


@machined(1)
def nut_in_a_v_block(draw: Draw) -> Case:
    """Two of its flats lie on a groove of 120 degrees."""
    flats = draw(14, 17)
    sides = [[(-25, -20), (0, -20), (0, -12), (-12 * math.sqrt(3), 0), (-25, 0)]]
    sides.append([(-y, z) for y, z in sides[0]][::-1])
    groove = prism([(-12 * math.sqrt(3), 0), (0, -12), (12 * math.sqrt(3), 0)], -40, 40, axis=0)
    plate = (box((-30, -25, -20), (30, 25, 0)) - groove).as_twin(*(prism(side, -30, 30, axis=0) for side in sides))
    return Case(nut(flats, 4, 8), (plate,), pose((0, 0.4, 3), 0, 90, 8), (weight(),), (), 0.1)


@machined(1)
def flange_nut_on_a_stud(draw: Draw) -> Case:
    radius, play = draw(4, 5), draw(0.3, 0.7)
    part = (bar(CENTER, Z, 12, 2) + prism(hexagon(15), 2, 9)) - bar((0, 0, -5), Z, radius, 30)
    part = part.as_twin(
        bar(CENTER, Z, 12, 2).bored((0, 0, 2), BELOW, radius, 2),
        prism(hexagon(15), 2, 9).bored((0, 0, 9), BELOW, radius, 7),
    )
    stud = pin((0, 0, 10), Z, radius - play, 20, "stud")
    told = (Told(CENTER, Z, 0.0), Told(CENTER, X, play))
    return Case(part, (stud, FLOOR), pose((0, 0, 5), 15, 1), (weight(), push(X, (0, 0, 1), 0.2)), told)


@machined(1)
def square_nut_in_a_channel(draw: Draw) -> Case:
    half, play = draw(8, 10), draw(0.2, 0.6)
    part = box((-half, -half, 0), (half, half, 8)).bored((0, 0, 8), BELOW, 4, 8)
    walls = [
        block((-50, side * (half + play) - 5 + 5 * side, -5), (50, side * (half + play) + 5 + 5 * side, 20), f"{side}")
        for side in (-1, 1)
    ]
    return Case(part, (FLOOR, *walls), pose((0, 0, 1), 1.0, 1), (weight(), push((1, 4, 0), (half, 0, 4), 0.5)), (), 0.3)


# hexagon pockets


def pocket(flats: float, outer: float, deep: float) -> Part:
    """A hexagon block with a hexagon pocket: a floor, and six wedges around."""
    whole = prism(hexagon(outer), -deep - 5, 0) - prism(hexagon(flats), -deep, 5)
    inner, wide = hexagon(flats), hexagon(outer)
    walls = [prism([inner[k], wide[k], wide[(k + 1) % 6], inner[(k + 1) % 6]], -deep, 0) for k in range(6)]
    return whole.as_twin(prism(hexagon(outer), -deep - 5, -deep), *walls)


@machined(2)
def hexagon_head_turns_in_its_pocket(draw: Draw) -> Case:
    """Corners meet flats: cos(30 deg - turn) is the ratio of widths across flats, times sqrt(3) / 2."""
    flats, play = draw(14, 18), draw(0.3, 0.8)
    head = prism(hexagon(flats - play), 0, 6) + bar((0, 0, 6), Z, 4, 20)
    turn = math.pi / 6 - math.acos(math.sqrt(3) / 2 * flats / (flats - play))
    turned = Load("turn", gravity=(0, 0, -9.81), moments=[Moment(Z, 0.004)])
    told = (Told((10, 0, 0), Y, 10 * math.sin(turn)), Told(CENTER, X, 0.0), Told(CENTER, Y, 0.0), Told(CENTER, Z, -5.0))
    return Case(head, (pocket(flats, 28, 5),), pose((0, 0, -4)), (weight(), turned), told)


@machined(1)
def nut_in_a_hexagon_pocket(draw: Draw) -> Case:
    flats, play = draw(14, 16), draw(0.3, 0.8)
    start = pose((0, 0, -4), draw.angle(1), 0.5)
    loads = (weight(), push(X, (0, 5, 2), 0.5), push((0, 0, 1), (4, 0, 5), 0.4, "lift"))
    return Case(nut(flats - play, 4, 7), (pocket(flats, 28, 5),), start, loads)


# T-slots


def t_slot(neck: float, wide: float, deep: float, high: float) -> Part:
    """A plate with a T-slot along x: half its neck and its width, how deep it begins below the top, and how high."""
    whole = box((-40, -30, -30), (40, 30, 0)) - box((-50, -neck, -deep - 1), (50, neck, 5))
    whole = whole - box((-50, -wide, -deep - high), (50, wide, -deep))
    return whole.as_twin(
        box((-40, -30, -30), (40, 30, -deep - high)),
        *(box((-40, min(s * wide, s * 30), -deep - high), (40, max(s * wide, s * 30), -deep)) for s in (-1, 1)),
        *(box((-40, min(s * neck, s * 30), -deep), (40, max(s * neck, s * 30), 0)) for s in (-1, 1)),
    )


@machined(2)
def t_nut_pulled_up_in_its_slot(draw: Draw) -> Case:
    neck, wide, play = draw(4, 6), draw(9, 12), draw(0.2, 0.6)
    part = box((-12, play - wide, 0), (12, wide - play, 5)) + box((-12, play - neck, 5), (12, neck - play, 14))
    loads = (weight(), push(Z, (3, 1, 10), 2.5, "pull"), push((0, 1, 0.2), (-6, 0, 10), 1.5, "aside"))
    return Case(part, (t_slot(neck, wide, 8, 6),), pose((0, 0, -13.5), draw.angle(0.3)), loads, (), 0.1)


@machined(1)
def hexagon_bolt_in_a_t_slot(draw: Draw) -> Case:
    """A moment on the bolt turns its head against the sides of the slot."""
    flats, play = draw(14, 16), draw(0.2, 0.8)
    bolt = prism(hexagon(flats)[:, ::-1][::-1], 0, 5) + bar((0, 0, 5), Z, 4, 25)
    wide = flats / 2 + play
    turn = math.pi / 6 - math.acos(wide * math.sqrt(3) / flats)
    turned = Load("turn", gravity=(0, 0, -9.81), moments=[Moment(Z, 0.004)])
    told = (Told((10, 0, 0), Y, 10 * math.sin(turn)), Told(CENTER, Y, 0.0), Told(CENTER, Z, -14.0))
    return Case(bolt, (t_slot(5, wide, 8, 6),), pose((0, 0, -13.5)), (weight(), turned), told)


# rings


@machined(2)
def ring_hangs_on_a_pin(draw: Draw) -> Case:
    inner, held, wide = draw(8, 11), draw(3, 5), draw(4, 7)
    ring = bar((0, -wide / 2, 0), Y, inner + 4, wide).bored((0, -wide / 2, 0), Y, inner, wide)
    told = (Told(CENTER, Z, held - inner), Told(CENTER, X, 0.0), Told((0, wide / 2, 0), Z, held - inner))
    return Case(ring, (pin(CENTER, Y, held, 60, "pin"),), pose((1 + draw.angle(1), 0, 0)), (weight(),), told)


@machined(2)
def ring_on_a_taper(draw: Draw) -> Case:
    """It stops where the cone is as wide as its bore."""
    inner, high = draw(7, 9), draw(4, 6)
    ring = bar(CENTER, Z, inner + 5, high).bored((0, 0, high), BELOW, inner, high)
    taper = Cone(0.012, 0.004, 0.032, Pose((0, 0, 0.016)), "taper")
    start = pose((0.05, 0, 24), 0, draw.angle(1))
    return Case(ring, (taper,), start, (weight(),), (Told(CENTER, Z, 4 * (12 - inner)),))


@machined(1)
def washer_falls_flat(draw: Draw) -> Case:
    inner, outer, high = draw(4, 6), draw(10, 13), draw(2, 3)
    washer = bar(CENTER, Z, outer, high).bored((0, 0, high), BELOW, inner, high)
    start = pose((0, 0, 14), 20 + draw.angle(20), 50 + draw.angle(20), 0)
    return Case(
        washer,
        (FLOOR,),
        start,
        (weight(),),
        (Told(CENTER, Z, 0.0), Told((outer, 0, 0), Z, 0.0), Told((0, outer, 0), Z, 0.0)),
    )


@machined(1)
def bush_in_a_bore(draw: Draw) -> Case:
    """A flanged bush sits in a bored plate on its flange."""
    bore, play = draw(8, 10), draw(0.2, 0.6)
    bush = (bar((0, 0, -10), Z, bore - play, 10) + bar(CENTER, Z, bore + 4, 3)) - bar((0, 0, -20), Z, 5, 40)
    bush = bush.as_twin(
        bar((0, 0, -10), Z, bore - play, 10).bored(CENTER, BELOW, 5, 10),
        bar(CENTER, Z, bore + 4, 3).bored((0, 0, 3), BELOW, 5, 3),
    )
    plate = box((-25, -25, -15), (25, 25, 0)).bored(CENTER, BELOW, bore, 15)
    told = (Told(CENTER, Z, 0.0), Told(CENTER, Y, play))
    start = pose((0, 0, 0.5), 0, draw.angle(0.2))
    return Case(bush, (plate,), start, (weight(), push(Y, CENTER, 0.3)), told)


# forks


@machined(1)
def block_on_a_lift_fork(draw: Draw) -> Case:
    """A fork of a cage, with a mast: its load slides off the mast's side until it leans there."""
    apart, tine = draw(8, 12), draw(5, 8)
    fork = box((-5, -25, 0), (0, 25, 40))
    for side in (-1, 1):
        low, high = sorted((side * apart, side * (apart + tine)))
        fork = fork + box((-5, low, 0), (50, high, 4))
    held = box((0, -30, 0), (30, 30, 20))
    start = pose((4, draw.angle(2), 4.5), draw.angle(2), draw.angle(1))
    told = (Told(CENTER, X, 0.0), Told((0, 10, 0), X, 0.0), Told(CENTER, Z, 4.0), Told((0, 10, 0), Z, 4.0))
    return Case(held, (fork,), start, (weight(), push(BACK, (0, 3, 8), 0.4)), told, 0.1)


@machined(1)
def fork_stands_over_a_square_bar(draw: Draw) -> Case:
    wide, play, tine = draw(8, 12), draw(0.5, 1.5), draw(4, 6)
    fork = box((-8, -wide / 2 - tine, 0), (8, wide / 2 + tine, 40)) - box((-20, -wide / 2, -5), (20, wide / 2, 25))
    fork = fork.as_twin(
        box((-8, -wide / 2 - tine, 25), (8, wide / 2 + tine, 40)),
        box((-8, -wide / 2 - tine, 0), (8, -wide / 2, 25)),
        box((-8, wide / 2, 0), (8, wide / 2 + tine, 25)),
    )
    rail = block((-60, play - wide / 2, -30), (60, wide / 2 - play, 0), "bar")
    return Case(fork, (rail,), pose((0, 0, -24), draw.angle(0.2), 0, 1 + draw.angle(0.5)), (weight(),), (), 0.3)

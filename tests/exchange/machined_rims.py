"""Machined parts whose rims and mouths are rounded outwards: tori, in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from cagepose import Box
from exchange.cad_parts import Part, bar, box, prism
from exchange.machined_case import FLOOR, Case, Draw, Told, machined, pose, push, weight
from exchange.machined_parts import BELOW, CENTER, X, Y, Z
from exchange.machined_truths import around


def rounded(part: Part, radius: float, is_meant: Callable[[np.ndarray], bool]) -> Part:
    return Part(part.rounded(radius, is_meant), (), part.level)


@machined(2)
def rod_with_rounded_rims_in_a_v_groove(draw: Draw) -> Case:
    """Rounded by more than half its radius, or less, it lies r sqrt(2) above the bottom."""
    radius, share, deep = draw(5, 7), draw(0.2, 0.9), 12.0
    rod = rounded(bar((-20, 0, 0), X, radius, 40), share * radius, lambda at: abs(at[0]) == 20)
    plate = box((-30, -25, -20), (30, 25, 0)) - prism([(-deep, 0), (0, -deep), (deep, 0)], -40, 40, axis=0)
    height = radius * math.sqrt(2) - deep
    told = (Told((-20, 0, 0), Z, height), Told((20, 0, 0), Z, height), Told((20, 0, 0), Y, 0.0))
    return Case(rod, (plate,), pose((0, draw.angle(1), 4), 0, draw.angle(3)), (weight(),), told)


def with_rounded_mouth(hole: float, rim: float, deep: float) -> Part:
    plate = box((-20, -20, -20), (20, 20, 0)) - bar(CENTER, BELOW, hole, deep)
    return rounded(plate, rim, lambda at: at[2] == 0 and math.hypot(at[0], at[1]) < hole + 0.01)


@machined(2)
def ball_on_a_rounded_mouth(draw: Draw) -> Case:
    hole, rim, radius = draw(3, 4), draw(0.5, 2), draw(6, 8)
    height = math.sqrt((radius + rim) ** 2 - (hole + rim) ** 2) - rim
    told = (Told(CENTER, Z, height), Told(CENTER, X, 0.0), Told(CENTER, Y, 0.0))
    plate = with_rounded_mouth(hole, rim, 15)
    return Case(around(radius), (plate,), pose((draw.angle(1), 0.5, radius + 3)), (weight(),), told)


@machined(2)
def rounded_pin_in_a_rounded_hole(draw: Draw) -> Case:
    """A little beside the hole and aslant, it finds in, and stands on the bottom."""
    hole, rim, play, nose = draw(4, 5), draw(1, 2), draw(0.1, 0.5), draw(0.5, 2)
    shaft = rounded(bar(CENTER, Z, hole - play, 30), nose, lambda at: at[2] == 0 and at[0] != 0)
    start = pose((play + rim / 2, 0, 0.5), 0, draw.angle(0.2))
    return Case(shaft, (with_rounded_mouth(hole, rim, 15),), start, (weight(),), (Told(CENTER, Z, -15.0),))


@machined(2)
def collar_with_a_rounded_rim_on_a_rounded_mouth(draw: Draw) -> Case:
    """Its rim lies on the mouth all around: their two circles are as far apart as both rounding radii together. It is
    so flat that it does not tip.
    """
    hole, rim, wide, nose = draw(4, 5), draw(1, 2), draw(0.3, 0.7), draw(1, 1.5)
    collar = rounded(bar(CENTER, Z, hole + wide, 3), nose, lambda at: at[2] == 0 and at[0] != 0)
    core, mouth = hole + wide - nose, hole + rim
    height = math.sqrt((rim + nose) ** 2 - (mouth - core) ** 2) - rim - nose
    told = (Told(CENTER, Z, height), Told(CENTER, X, 0.0), Told(CENTER, Y, 0.0))
    plate = with_rounded_mouth(hole, rim, 15)
    return Case(collar, (plate,), pose((draw.angle(0.1), 0.1, 2), 0, draw.angle(0.5)), (weight(),), told)


@machined(2)
def boss_with_a_rounded_rim_stands_on_it(draw: Draw) -> Case:
    radius, rim, high = draw(6, 8), draw(0.5, 3), draw(4, 6)
    part = box((-12, -12, -4), (12, 12, 0)) + bar((0, 0, -1), Z, radius, high + 1)
    part = rounded(part, rim, lambda at: abs(at[2] - high) < 1e-6)
    start = pose((0, 0, high + 2), 0, draw.angle(2), 180)
    return Case(part, (FLOOR,), start, (weight(),), (Told(CENTER, Z, high), Told((5, 0, 0), Z, high)), 0.1)


def slotted(half: float, rim: float) -> Part:
    """A plate with a slot along x, whose rim is rounded all around."""
    plate = box((-30, -20, -10), (30, 20, 0)) - box((-10, -half, -20), (10, half, 10))
    plate = plate - bar((-10, 0, -20), Z, half, 40) - bar((10, 0, -20), Z, half, 40)
    return rounded(plate, rim, lambda at: at[2] == 0 and abs(at[0]) < 25 and abs(at[1]) < 15)


@machined(2)
def ball_pushed_along_a_slot_with_a_rounded_rim(draw: Draw) -> Case:
    """It lies on both straight edges, and at the end on all of the round one, over the axis of that."""
    half, rim, radius = draw(3, 4), draw(0.5, 1.5), draw(5, 6)
    height = math.sqrt((radius + rim) ** 2 - (half + rim) ** 2) - rim
    told = (Told(CENTER, Z, height), Told(CENTER, Y, 0.0), Told(CENTER, X, 10.0))
    start = pose((-3, 0.2, radius + 2))
    return Case(around(radius), (slotted(half, rim),), start, (weight(), push(X, CENTER, 0.05)), told, 0.3)


@machined(2)
def plank_tips_over_the_rounded_edge_of_a_slot(draw: Draw) -> Case:
    """Its flat side lies on the end of a straight edge, where a round one begins, until it lies on the plate, too."""
    half, rim, thin = draw(5, 6), draw(1, 2), draw(2, 3)
    plank = (Box((0.03, 0.05, 1e-3 * thin), None, "plank"),)
    start = pose((0, 12, 12), 0, 0, 20 + draw.angle(5))
    return Case(plank, (slotted(half, rim),), start, (weight(),), (Told(CENTER, Z, thin / 2),), 0.2)

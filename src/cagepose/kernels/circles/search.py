"""All roots of the equation of `equation`: no root is passed over.

Sections of the circle are decided one after the other. In one half as wide as w around an angle with values F and F',
and with |F''| at most B, there is no root if |F| > |F'| w + B w^2 / 2, and one root at most if |F'| > B w. Any other
one is halved, until it is narrower than what can be told apart.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.circles.equation import Equation, bend_within, expanded, slope_within
from cagepose.kernels.circles.places import FLAT, GREATEST, LEAST, Place, within_turn, write_place
from cagepose.kernels.native.kernel import kernel

BEGIN = -3.1
"""Of the search, radians: beside all places that parts have by symmetry."""
FIRST_WIDTH, FINEST = 1.0, 1e-7
"""Of a section, radians: the first one; half of one that is left undecided."""
JOINED = 1e-2
"""Radians: a flat place so close behind another one is the same."""
ITERATIONS, LAST_STEP = 80, 2e-16
"""Of the search for one root, radians."""


class Section(NamedTuple):
    """What is known of the roots in a section.

    Attributes
    ----------
    has_none, has_one_at_most
        See above.
    is_zero
        F is zero to rounding in all of it.
    is_below
        Whether F is below zero in its middle.
    """

    has_none: bool
    has_one_at_most: bool
    is_zero: bool
    is_below: bool


@kernel
def is_below(equation: Equation, angle: float) -> bool:
    return expanded(equation, angle).value < 0.0


@kernel
def decide(equation: Equation, angle: float, half_width: float) -> Section:
    """Return what is known of the section around an angle."""
    at = expanded(equation, angle)
    bend, size = bend_within(equation, at, half_width), abs(at.value)
    change = slope_within(equation, at, half_width) * half_width
    if bend < math.inf:
        change = (abs(at.slope) + 0.5 * bend * half_width) * half_width
    has_one_at_most, is_zero = abs(at.slope) > bend * half_width, size + change <= at.rounding
    return Section(size > change + at.rounding, has_one_at_most, is_zero, at.value < 0.0)


@kernel
def search(equation: Equation, is_near: bool, n_places: int, places: Rows[Place]) -> int:
    """Write all roots behind ``n_places`` that are written already; return how many there are now.

    F rises through zero where the distance is least. Sections that stay undecided are joined: where F has one sign at
    both ends of them, it is flat there.
    """
    low, width, since, is_open = BEGIN, FIRST_WIDTH, BEGIN, False
    end = BEGIN + 2.0 * math.pi
    began_below = was_below = is_below(equation, BEGIN)
    while low < end:
        half = 0.5 * min(width, end - low)
        high = low + 2.0 * half
        section = decide(equation, low + half, half)
        is_decided = section.has_none or section.has_one_at_most
        if not (is_decided or section.is_zero) and half > FINEST:
            width = half
            continue
        if is_decided:
            starts_below, ends_below = section.is_below, section.is_below
            if not section.has_none:
                starts_below = is_below(equation, low) if is_open else was_below
                ends_below = is_below(equation, high)
            if is_open or starts_below != was_below:
                n_places = note_root(equation, since, low, was_below, starts_below, is_near, n_places, places)
            if ends_below != starts_below:
                n_places = note_root(equation, low, high, starts_below, ends_below, is_near, n_places, places)
            since, was_below = high, ends_below
        is_open = not is_decided
        low, width = high, 4.0 * half
    if is_open or was_below != began_below:
        n_places = note_root(equation, since, end, was_below, began_below, is_near, n_places, places)
    return n_places


@kernel
def note_root(
    equation: Equation,
    low: float,
    high: float,
    starts_below: bool,
    ends_below: bool,
    is_near: bool,
    n_places: int,
    places: Rows[Place],
) -> int:
    """Write the root between two angles, given the signs of F there; return how many places there are.

    Flat places that rounding has parted are one.
    """
    angle, kind = 0.5 * (low + high), FLAT
    if n_places == len(places) or is_joined(equation, low, starts_below == ends_below, n_places, places):
        return n_places
    if starts_below != ends_below:
        angle, kind = root_between(equation, low, high, starts_below), LEAST if starts_below else GREATEST
    write_place(places[n_places], angle + equation.ellipse.start, 0.0, kind, is_near)
    return n_places + 1


@kernel
def is_joined(equation: Equation, low: float, is_flat: bool, n_places: int, places: Rows[Place]) -> bool:
    """Whether a flat place follows close behind another one."""
    if not is_flat or n_places == 0 or places[n_places - 1].kind != FLAT:
        return False
    return abs(within_turn(low + equation.ellipse.start - places[n_places - 1].angle)) < JOINED


@kernel
def root_between(equation: Equation, low: float, high: float, starts_below: bool) -> float:
    """Return the one root between two angles, by Newton's steps, or halves where those lead out."""
    angle = 0.5 * (low + high)
    for _ in range(ITERATIONS):
        at = expanded(equation, angle)
        step = at.value / at.slope if at.slope != 0.0 else math.inf
        if abs(step) <= LAST_STEP or high - low <= LAST_STEP:
            break
        if (at.value < 0.0) == starts_below:
            low = angle
        else:
            high = angle
        angle -= step
        if not low < angle < high:
            angle = 0.5 * (low + high)
    return angle


@kernel
def find_least_near(equation: Equation, angle: float, places: Rows[Place]) -> bool:
    """Write the place that is nearest to an angle, where the distance is least, if a step of Newton's method tells so;
    False: it does not. As far as it leads, and to the other side, there often is one root, which is the nearest then.
    """
    start = angle - equation.ellipse.start
    at = expanded(equation, start)
    if at.slope <= 0.0:
        return False
    half = 2.0 * abs(at.value / at.slope) + FINEST
    if not decide(equation, start, half).has_one_at_most:
        return False
    if not is_below(equation, start - half) or is_below(equation, start + half):
        return False
    return note_root(equation, start - half, start + half, True, False, True, 0, places) == 1

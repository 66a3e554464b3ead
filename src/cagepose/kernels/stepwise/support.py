"""Turning about contacts, and the pairwise stability test: rules R1 to R3 of docs/theory.

A contact carries an axis through itself, two contacts the axis through both, three or more every pair's. The load
turns the object about each axis in the sense of its moment.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, row, scaled
from cagepose.kernels.collision.boxes import BoxesAndPoints, PlacedBoxes
from cagepose.kernels.collision.first_contact import first_contact_turn, turn_is_blocked_at_once
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import BALANCED, NONE, PLAIN, SMALL_TURN, TIE, TURN
from cagepose.kernels.stepwise.step import Step


class PointLoad(NamedTuple):
    """A unit force along ``direction`` that acts at ``point``, both in the world."""

    direction: Vector
    point: Vector


class SupportRules(NamedTuple):
    """Numbers of the stability test.

    Attributes
    ----------
    least_moment
        An axis counts if the load's moment about it is at least this fraction of force times distance (R3). No unit.
    blocked_key
        Key of the angle within which a contact blocks an axis (R3).
    unseen_key
        Key of the angle that moves nothing by more than the touch tolerance: a turn that ends within it is none.
    equal_distance_m
        Distances that differ by less are equal, so the lowest point indices win, metres.
    """

    least_moment: float
    blocked_key: float
    unseen_key: float
    equal_distance_m: float


@kernel
def moment_about(axis: Vector, through: Vector, load: PointLoad) -> float:
    """Return the load's moment about an axis, for a unit force: metres."""
    return dot(cross(minus(load.point, through), load.direction), axis)


@kernel
def held(rule: int, note: int) -> Step:
    """Return the step that does not move."""
    zero = (0.0, 0.0, 0.0)
    return Step(rule, NONE, zero, zero, 0.0, -1, note)


@kernel
def turn_about_one(
    geometry: BoxesAndPoints,
    placement: PlacedBoxes,
    contact: int,
    load: PointLoad,
    turn_rule: int,
    held_rule: int,
    tolerances: KernelTolerances,
) -> Step:
    """R1: turn about the axis (p_f - p_T1) x f; held if the load's line passes through the contact."""
    through = row(geometry.points_world, contact)
    arm = minus(load.point, through)
    moment = cross(arm, load.direction)
    length = norm(moment)
    if length <= tolerances.tie * norm(arm):
        return held(held_rule, BALANCED)
    axis = scaled(moment, 1.0 / length)
    key, hit_point = first_contact_turn(geometry, placement, through, axis, tolerances)
    return Step(turn_rule, TURN, axis, through, key, hit_point, PLAIN)


@kernel
def driven_axis(one: Vector, other: Vector, load: PointLoad, tie: float) -> tuple[Vector, float]:
    """Return the unit axis through two points in the sense that the load turns, and |moment| / (force times distance).

    The distance is the larger one of the two points from the load. At a tie (no moment) the axis runs from ``other`` to
    ``one``.
    """
    difference = minus(one, other)
    axis = scaled(difference, 1.0 / norm(difference))
    distance = max(norm(minus(load.point, one)), norm(minus(load.point, other)))
    relative_moment = moment_about(axis, one, load) / distance
    if relative_moment < -tie:
        return scaled(axis, -1.0), -relative_moment
    return axis, abs(relative_moment)


@kernel
def turn_about_two(
    geometry: BoxesAndPoints,
    placement: PlacedBoxes,
    first: int,
    second: int,
    load: PointLoad,
    turn_rule: int,
    tolerances: KernelTolerances,
) -> Step:
    """R2: turn about the line through two contacts; a tie keeps the axis p_T1 - p_T2 and is told."""
    one = row(geometry.points_world, first)
    other = row(geometry.points_world, second)
    axis, relative_moment = driven_axis(one, other, load, tolerances.tie)
    key, hit_point = first_contact_turn(geometry, placement, one, axis, tolerances)
    note = TIE if relative_moment <= tolerances.tie else PLAIN
    return Step(turn_rule, TURN, axis, one, key, hit_point, note)


@kernel
def pairwise_stability(
    geometry: BoxesAndPoints,
    placement: PlacedBoxes,
    contacts: NDArray[np.int64],
    n_contacts: int,
    load: PointLoad,
    turn_rule: int,
    held_rule: int,
    rules: SupportRules,
    tolerances: KernelTolerances,
) -> Step:
    """R3: held if every driven axis through two contacts is blocked; else turn about the free one farthest out.

    Farthest: the largest sum of the distances from the load's point to the two contacts; among equal sums the lowest
    point indices. Held with a note if a driven turn was free, but for less than the angle that counts.
    """
    best = held(held_rule, PLAIN)
    best_sum = -math.inf
    best_low, best_high = -1, -1
    for i in range(n_contacts):
        for j in range(i + 1, n_contacts):
            low, high = min(contacts[i], contacts[j]), max(contacts[i], contacts[j])
            one = row(geometry.points_world, low)
            other = row(geometry.points_world, high)
            distance_sum = norm(minus(load.point, one)) + norm(minus(load.point, other))
            is_farther = distance_sum > best_sum + rules.equal_distance_m
            is_equal = not is_farther and distance_sum >= best_sum - rules.equal_distance_m
            is_lower = low < best_low or (low == best_low and high < best_high)
            if not (is_farther or (is_equal and is_lower)):
                continue
            axis, relative_moment = driven_axis(one, other, load, tolerances.tie)
            if relative_moment < rules.least_moment:
                continue
            if turn_is_blocked_at_once(geometry, placement, contacts, n_contacts, one, axis, tolerances):
                continue
            key, hit_point = first_contact_turn(geometry, placement, one, axis, tolerances)
            if key >= rules.blocked_key:
                best = Step(turn_rule, TURN, axis, one, key, hit_point, PLAIN)
                best_sum, best_low, best_high = distance_sum, low, high
            elif key > rules.unseen_key and best.motion == NONE:
                best = held(held_rule, SMALL_TURN)
    return best

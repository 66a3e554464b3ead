"""Slip at the contacts of a push: rules R4 to R7 of docs/theory.

A contact is judged by the angle alpha between its outward normal and the push: no-slip (steep), slip, or contactless
(the push moves the object away from it). If all that touch slip, their independent normals say which freedom is left.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, row, scaled
from cagepose.kernels.collision.boxes import BoxesAndPoints, PlacedBoxes
from cagepose.kernels.collision.first_contact import first_contact_travel, first_contact_turn
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import PLAIN, TRAVEL, TURN
from cagepose.kernels.stepwise.step import Step
from cagepose.kernels.stepwise.support import PointLoad, held, moment_about

SLP_1, SLP_2 = 8, 9
"""Rule codes: after the four of phase A and the four of phase B."""


class SlipRules(NamedTuple):
    """Angles that judge a contact, radians.

    Attributes
    ----------
    no_slip_angle_rad
        Below it a contact does not slip: the friction angle (R4).
    contactless_angle_rad
        Above it a contact is none: a right angle and the grazing band (R5).
    parallel_sine
        Normals are dependent if the sine of the angle between them (or between one and the plane of two) is at most
        this. A turn by this angle moves no point of the object by more than the least play that a cage can have in
        practice.
    equal_distance_m
        Distances that differ by less are equal, so the lowest point index wins, metres.
    """

    no_slip_angle_rad: float
    contactless_angle_rad: float
    parallel_sine: float
    equal_distance_m: float


@kernel
def independent_normals(
    contacts: NDArray[np.int64], n_contacts: int, normals: FloatArray, parallel_sine: float
) -> tuple[int, Vector]:
    """Return how many directions the normals span (n and -n being one), and for two the unit vector across both."""
    first = row(normals, contacts[0])
    across = (0.0, 0.0, 0.0)
    widest = 0.0
    for i in range(1, n_contacts):
        product = cross(first, row(normals, contacts[i]))
        sine = norm(product)
        if sine > widest:
            widest, across = sine, scaled(product, 1.0 / sine)
    if widest <= parallel_sine:
        return 1, across
    for i in range(n_contacts):
        if abs(dot(across, row(normals, contacts[i]))) > parallel_sine:
            return 3, across
    return 2, across


@kernel
def turn_on_face(
    geometry: BoxesAndPoints,
    placement: PlacedBoxes,
    contacts: NDArray[np.int64],
    n_contacts: int,
    normals: FloatArray,
    load: PointLoad,
    equal_distance_m: float,
    tolerances: KernelTolerances,
) -> Step:
    """R6 (Slp-1): turn about the common normal through the farthest contact whose turn the load drives and nothing
    blocks.

    Farthest from the load's point; among equal distances the lowest point index. Held if there is none.
    """
    best = held(SLP_1, PLAIN)
    best_distance = -math.inf
    best_contact = -1
    for i in range(n_contacts):
        contact = contacts[i]
        through = row(geometry.points_world, contact)
        distance = norm(minus(load.point, through))
        is_farther = distance > best_distance + equal_distance_m
        is_equal = not is_farther and distance >= best_distance - equal_distance_m
        if not (is_farther or (is_equal and contact < best_contact)):
            continue
        normal = row(normals, contact)
        moment = moment_about(normal, through, load)
        if abs(moment) <= tolerances.tie * distance:
            continue
        axis = normal if moment > 0.0 else scaled(normal, -1.0)
        key, hit_point = first_contact_turn(geometry, placement, through, axis, tolerances)
        if key > -math.inf:
            best = Step(SLP_1, TURN, axis, through, key, hit_point, PLAIN)
            best_distance, best_contact = distance, contact
    return best


@kernel
def travel_between_faces(
    geometry: BoxesAndPoints, placement: PlacedBoxes, across: Vector, load: PointLoad, tolerances: KernelTolerances
) -> Step:
    """R7 (Slp-2): travel along n1 x n2 in the sense in which the load does work; held if it does none or is blocked."""
    work = dot(across, load.direction)
    if abs(work) <= tolerances.tie:
        return held(SLP_2, PLAIN)
    direction = across if work > 0.0 else scaled(across, -1.0)
    distance, hit_point, _ = first_contact_travel(geometry, placement, direction, -math.inf, tolerances)
    if distance <= 0.0:
        return held(SLP_2, PLAIN)
    return Step(SLP_2, TRAVEL, direction, (0.0, 0.0, 0.0), distance, hit_point, PLAIN)


@kernel
def slip_step(
    geometry: BoxesAndPoints,
    placement: PlacedBoxes,
    contacts: NDArray[np.int64],
    n_contacts: int,
    alphas: FloatArray,
    normals: FloatArray,
    load: PointLoad,
    rules: SlipRules,
    tolerances: KernelTolerances,
) -> Step:
    """B-5: slide if all contacts slip and their normals leave a freedom (Slp-1, Slp-2); held otherwise.

    Held also means Slp-3, a sliding that the load does not drive, or one that is blocked at once.
    """
    for i in range(n_contacts):
        if alphas[contacts[i]] < rules.no_slip_angle_rad:
            return held(SLP_1, PLAIN)
    n_directions, across = independent_normals(contacts, n_contacts, normals, rules.parallel_sine)
    if n_directions == 1:
        return turn_on_face(
            geometry, placement, contacts, n_contacts, normals, load, rules.equal_distance_m, tolerances
        )
    if n_directions == 2:
        return travel_between_faces(geometry, placement, across, load, tolerances)
    return held(SLP_2, PLAIN)

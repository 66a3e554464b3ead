"""When a circle touches another feature first, or a line the side of a cone: conservative advancement, then Newton's
method on the gap, equation (2.14).

The gap at any place of a circle falls no faster than the one moves toward the other, so a step by the least gap over
this speed jumps over no contact: a place that comes up on the way has been no nearer than those that were there. Where
a gap is within the touch tolerance, Newton's method gives the digits.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.record import IntArray, Rows
from cagepose.kernels.algebra.vector import dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.along_motion import BEHIND, LEAST_STEP, between_segments, gone_on
from cagepose.kernels.boundary.circle import circle_of, outward_at
from cagepose.kernels.boundary.circle_ahead import SAME_ANGLE, clear_ahead
from cagepose.kernels.boundary.circle_meeting import meet_all_around, write_place_on
from cagepose.kernels.boundary.closing import closing_of, surely_clear
from cagepose.kernels.boundary.features import Feature, PlacedBoundary
from cagepose.kernels.boundary.first_touch import place_after
from cagepose.kernels.boundary.hollow_end import reach_in_hollow
from cagepose.kernels.boundary.meetings import PLACES_AROUND, find_circle_places, find_places_near, meeting_at
from cagepose.kernels.circles.places import (
    GREATEST,
    SADDLE,
    WHOLE,
    Kept,
    Place,
    on_circle,
    within_turn,
)
from cagepose.kernels.native.kernel import kernel

ADVANCES = 2000
"""Steps for one pair of features; only where they graze each other more than some tens are taken."""
COARSE_STEPS = 8
"""After so many steps by a speed they graze, and it is worth the while to ask how each gap closes and bends; where that
told no more, again after twice as many steps as before."""
NEWTON_STEPS = 12
ROOT_OF_TOUCH, CONVERGES = 1e-3, 0.5
"""Of the touch tolerance: a gap that is less is a root; and of such a gap: a step that leaves more no longer helps."""
KEPT_STEP, LONGER, FOLLOWED = 1.0 / 32.0, 2.0, 0.1
"""In amounts of the whole motion: the first step where places that touch are followed; how many times as long the next
one is at most; and radians that such a place should go along its circle in a step.
"""


@kernel
def place_touches(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    place: Place,
    motion: Motion,
    depth_m: float,
    slack: float,
    touch_m: float,
    reach_m: float,
    waiting: IntArray,
) -> bool:
    """Whether two features, as they are placed, reach where they meet at a place and come nearer."""
    met = meeting_at(a, i, b, j, place)
    if met.gap < -depth_m - reach_m or dot(met.normal, velocity_at(motion, met.place)) <= 0.0:
        return False
    return reach_in_hollow(a, i, b, j, met, slack, touch_m, reach_m, waiting)


@kernel
def place_near(one: Feature, other: Feature, angle: float, farthest: float, touch_m: float, places: Rows[Place]) -> int:
    """Write the places of two features and return which of them is nearest to an angle; -1: none is nearer than
    ``farthest``, radians.
    """
    n_places = find_places_near(one, other, angle, touch_m, places)
    nearest, least = -1, farthest
    if n_places == WHOLE:
        write_place_on(one, other, angle, places[0])
        return 0
    for k in range(n_places):
        away = abs(within_turn(places[k].angle - angle))
        if places[k].kind not in (GREATEST, SADDLE) and away < least:
            nearest, least = k, away
    return nearest


class Root(NamedTuple):
    """Where the gap of a place is zero: the amount, inf: nowhere; and the angle of the place there."""

    amount: float
    angle: float


@kernel
def root_of_gap(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    motion: Motion,
    amount: float,
    angle: float,
    depth_m: float,
    touch_m: float,
    moved: PlacedBoundary,
    places: Rows[Place],
) -> Root:
    """Return where Newton's method leads on the gap, to a depth, at the place of a circle that is near an angle."""
    root, least = Root(math.inf, angle), ROOT_OF_TOUCH * touch_m / CONVERGES
    for _ in range(NEWTON_STEPS):
        place_after(a, i, motion, amount, moved)
        at = place_near(moved.features[i], b.features[j], angle, SAME_ANGLE, touch_m, places)
        if at < 0:
            break
        angle = places[at].angle
        met = meeting_at(moved, i, b, j, places[at])
        closing = dot(met.normal, velocity_at(motion, met.place))
        if not met.is_one or closing <= 0.0:
            break
        left = abs(met.gap + depth_m)
        if left <= ROOT_OF_TOUCH * touch_m:
            if left >= CONVERGES * least:
                break
            root, least = Root(amount, angle), left
        amount += (met.gap + depth_m) / closing
    return root


class Reached(NamedTuple):
    """Where two features touch first.

    Attributes
    ----------
    amount
        Of the motion; inf: they do not touch.
    angle
        Of the place on the object's circle, or else on the cage's, radians; zero: there is none.
    n_steps
        How many were taken.
    is_open
        All of them are used up: what comes behind the amount is not known, and nothing is before it.
    """

    amount: float
    angle: float
    n_steps: int
    is_open: bool


@kernel
def first_touch_of_curved(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    motion: Motion,
    end: float,
    slack: float,
    reach_m: float,
    touch_m: float,
    moved: PlacedBoundary,
    places: Rows[Place],
    waiting: IntArray,
    kept: Rows[Kept],
    n_kept: int,
) -> Reached:
    """Return where two curved features touch first, up to an end.

    Parameters
    ----------
    a, i, b, j
        The features, placed in the world.
    motion, end
        That of the object; the end is finite.
    slack, reach_m
        How far beyond its end a feature still counts: the sine of an angle, and, where that is hollow, metres.
    touch_m
        What is this close touches, and how far beyond another end it counts, metres.
    moved, places, waiting
        Memory.
    kept, n_kept
        Places that touch now. They are written over.
    """
    amount, before, behind, kept_step = 0.0, 0.0, BEHIND * end, KEPT_STEP * end
    asks_at, waits = COARSE_STEPS, 1
    for n_steps in range(ADVANCES):
        place_after(a, i, motion, amount, moved)
        one, other = moved.features[i], b.features[j]
        closing = closing_of(one, other, motion)
        n_places = find_circle_places(one, other, touch_m, places)
        is_around = n_places == WHOLE
        least, is_past, nearest, facing, turned = math.inf, False, 0, (0.0, 0.0, 0.0), 0.0
        if is_around and not meet_all_around(one, other):
            least, n_places = circles_apart(one, other), 0
            is_past, is_around = least <= touch_m, False
        has_kept = n_kept > 0
        for k in range(PLACES_AROUND if is_around else n_places):
            place = places[k]
            if place.kind in (GREATEST, SADDLE):
                continue
            met = meeting_at(moved, i, b, j, place)
            if met.gap == math.inf:  # lines without a common normal
                least = min(least, max(lines_apart(one, other), 0.0))
                continue
            at, depth = kept_at(place.angle, kept, n_kept), 0.0
            if at >= 0:
                # One that touched: it is followed until it is apart.
                turned = max(turned, abs(within_turn(kept[at].angle - place.angle)))
                kept[at].angle, kept[at].other_angle = place.angle, place.other_angle
                if kept[at].is_held:
                    continue
                depth = kept[at].depth_m
                # what goes through the zone in which it touches, and does not count there, may meet just behind it
                rate = abs(dot(met.normal, velocity_at(motion, met.place)))
                across = touch_m * closing.speed / rate if rate > 0.0 else math.inf
                if kept[at].is_grazing:
                    if -depth <= met.gap <= touch_m:
                        least = min(least, across)
                        continue
                    n_kept, at = dropped(kept, n_kept, at), -1
                elif met.gap > touch_m and (met.gap > depth or depth == math.inf):
                    n_kept, depth = dropped(kept, n_kept, at), 0.0
                elif depth == math.inf:
                    least = min(least, abs(met.gap) if abs(met.gap) > touch_m else across)
                    continue
            gap = met.gap + depth
            # Where places are kept, all of a circle may come on at one moment: the nearest place is a new one then.
            is_through = has_kept and gap < -ROOT_OF_TOUCH * touch_m
            if is_through and at >= 0:  # counts again once apart
                kept[at].depth_m = math.inf
            if is_through or -ROOT_OF_TOUCH * touch_m <= gap <= touch_m:
                root = root_of_gap(a, i, b, j, motion, amount, place.angle, depth, touch_m, moved, places)
                reached = max(root.amount, before if is_through else amount)
                if reached <= end:
                    place_after(a, i, motion, reached, moved)
                    at_root = place_near(moved.features[i], b.features[j], root.angle, SAME_ANGLE, touch_m, places)
                    if at_root >= 0:
                        at_place = places[at_root]
                        if place_touches(moved, i, b, j, at_place, motion, depth, slack, touch_m, reach_m, waiting):
                            return Reached(reached, at_place.angle, n_steps, False)
                if at < 0 and abs(met.gap) <= touch_m and n_kept < len(kept):  # they may graze so for long
                    row = kept[n_kept]
                    row.angle, row.other_angle, row.depth_m = place.angle, place.other_angle, touch_m
                    row.is_held, row.is_grazing = False, True
                    n_kept += 1
                is_past = True
                place_after(a, i, motion, amount, moved)
                find_circle_places(moved.features[i], b.features[j], touch_m, places)
            if abs(gap) < least:
                least, nearest, facing = abs(gap), k, scaled(met.normal, math.copysign(1.0, gap))
        step = surely_clear(closing, least)
        if step < end - amount and n_steps >= asks_at:
            found = places[nearest]
            ahead = clear_ahead(one, other, motion, touch_m, found, facing, kept, n_kept, step, end - amount)
            waits = 1 if ahead > step else 2 * waits
            step, asks_at = ahead, n_steps + waits
        if is_past and closing.speed > 0.0:  # a root that is no contact: on so short a way none is hidden that counts
            step = max(step, touch_m / closing.speed)
        if n_kept > 0:
            went = amount - before
            if went > 0.0:
                kept_step *= LONGER
            if turned * kept_step > FOLLOWED * went:
                kept_step = max(KEPT_STEP * end, FOLLOWED * went / turned)
            step = min(step, kept_step)
        if step >= end - amount:
            return Reached(math.inf, 0.0, n_steps, False)
        before = amount
        if step > LEAST_STEP * end:
            amount += step
        else:
            amount, behind = gone_on(amount, step, end, behind)
    return Reached(amount, 0.0, ADVANCES, True)


@kernel
def circles_apart(one: Feature, other: Feature) -> float:
    """Return how far a place of a circle is from another one."""
    point = on_circle(circle_of(one), 0.0).point
    nearest = plus(vector_from(other.point), scaled(outward_at(other, point), other.length))
    return max(0.0, norm(minus(point, nearest)) - one.radius - other.radius)


@kernel
def lines_apart(one: Feature, other: Feature) -> float:
    """Return how far two lines are apart at least, as far as they reach."""
    p, u, q, w = (
        vector_from(one.point),
        vector_from(one.direction),
        vector_from(other.point),
        vector_from(other.direction),
    )
    return between_segments(p, u, one.length, q, w, other.length) - one.radius - other.radius


@kernel
def kept_at(angle: float, kept: Rows[Kept], n_kept: int) -> int:
    """Return which of the places that touched is near an angle; -1: none."""
    for k in range(n_kept):
        if abs(within_turn(kept[k].angle - angle)) < SAME_ANGLE:
            return k
    return -1


@kernel
def dropped(kept: Rows[Kept], n_kept: int, at: int) -> int:
    """Drop a place from those that touched; return how many are left."""
    last = kept[n_kept - 1]
    kept[at].angle, kept[at].other_angle = last.angle, last.other_angle
    kept[at].depth_m, kept[at].is_held, kept[at].is_grazing = last.depth_m, last.is_held, last.is_grazing
    return n_kept - 1

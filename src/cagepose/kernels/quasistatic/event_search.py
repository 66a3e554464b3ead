"""The first event of a step: one search along its path for the first guard that falls through zero."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, norm
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.metric import frame_at, twist_between, twist_of
from cagepose.kernels.contact.on_circle import is_kept
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.edge_crossing import edge_crossing
from cagepose.kernels.quasistatic.first_contact import NO_HIT, Hit, Twist, first_contact
from cagepose.kernels.quasistatic.guards import (
    BEGINS_TO_TIP,
    CONTACT_ENDS,
    GAP_CLOSES,
    POWER_ENDS,
    Guard,
    power_left,
    value_of,
)
from cagepose.kernels.quasistatic.path import Path, gap_of, is_guided, speed_along, step_to
from cagepose.kernels.quasistatic.projection import ON_FACE
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.straying import STRAYED, strayed
from cagepose.kernels.quasistatic.tipping import find_all_carried
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace

TRIALS = 80
"""How many poses a search asks at most."""
SLANTED, NEAR_END = 8.0, 0.01
"""Times what contacts stray, that an event may be off along the way; and, in touch tolerances, how near to it the end
of a contact is looked for.
"""
LATE = 4.0
"""In what an event may be off along the way. What is reached later is not what comes first."""
CLOSER = 0.1
"""Of two numbers one after the other. Where the second one is less than so much of the first, a straight line through
both is followed.
"""
HALVINGS = 40
"""How often a step is halved that a contact, or the potential, does not let end."""
TURNED_BACK = 0.1
"""Share of the power at the start of a step. A step to a balance that goes too far by less is as good."""
RUN_DOWN = 1e-5
"""In sizes of the scene: so far a motion that could have ended before runs on where it ends."""
NEAR_TIP = 1e-7
"""Fraction of a step: so near it is found where the object begins to tip."""
BEFORE_END = 4.0
"""In touch tolerances: so far before its end a travel is asked, where what it reaches does not touch yet, and what it
runs off does.
"""
FARTHER, TIMES = 4.0, 8
"""How many times as far before its end, and how often, where what carries has ended there."""


@kernel
def first_past(
    setting: Setting,
    path: Path,
    guard: Guard,
    begun: float,
    guess: float,
    spread: float,
    enough: tuple[float, float],
    work: QuasistaticWorkspace,
) -> float:
    """Return the amount of a path after which a guard falls through zero; inf: it does not, up to its end. Of a gap
    that does not close near the guess, where it is least.

    Parameters
    ----------
    setting, path, guard
        See there.
    begun
        Its number at the start, above zero.
    guess, spread
        Where it may be, and how far off.
    enough
        How near to zero the number is to come, or how near the two sides: in its unit, and in amounts.
    work
        Contacts are those at the start.
    """
    end = path.twist.end
    low, high, at_low, at_high = 0.0, math.inf, begun, -math.inf
    before, at_before, trial = 0.0, begun, min(guess, end)
    was_low, best, least = True, math.inf, math.inf
    for k in range(TRIALS):
        value = value_of(setting, path, guard, trial, work)
        if abs(value) <= enough[0]:
            return trial
        if guard.kind == GAP_CLOSES and abs(value) < least:
            best, least = trial, abs(value)
        if value > 0.0:
            at_high *= 0.5 if was_low else 1.0
            low, at_low, was_low = trial, value, True
        else:
            at_low *= 1.0 if was_low else 0.5
            high, at_high, was_low = trial, value, False

        # Where a straight line through the last two numbers leads, if they fall so fast that it says something.
        ahead, slope = math.inf, (value - at_before) / (trial - before) if trial != before else 0.0
        if abs(value) < CLOSER * abs(at_before) < math.inf and slope < 0.0:
            ahead = trial - value / slope
        before, at_before = trial, value

        if high == math.inf:  # not there yet
            if low == end or end == math.inf:
                return best
            if not low < ahead <= end:
                ahead = min(guess + spread, end) if k == 0 and spread > 0.0 else end
        elif low == 0.0 and not 0.0 < ahead < high:
            if k == 0 and 0.0 < spread < guess:
                ahead = guess - spread
            elif guard.kind == GAP_CLOSES and begun <= setting.tolerances.touch_m:  # it touched before, and comes again
                return best
        if high < math.inf:
            if high - low <= enough[1]:
                return high
            if not low < ahead < high:
                ahead = 0.5 * (low + high)
                if at_low < math.inf and at_high > -math.inf:  # by false position (Illinois)
                    ahead = low + (high - low) * at_low / (at_low - at_high)
            if not low < ahead < high:
                ahead = 0.5 * (low + high)
            if not low < ahead < high:
                return high
        trial = ahead
    return high


@kernel
def hit_on_path(setting: Setting, path: Path, hit: Hit, spread: float, work: QuasistaticWorkspace) -> Hit:
    """Return what is hit, after the amount of the path where it is reached; or as it was, where it is not or was. Where
    it is reached much later, something else may come first: the path goes to where it seemed to be hit, and is asked
    again.

    A gap that is closed by the projection afterwards would turn an object aside that reaches two things at once.
    """
    begun = gap_of(setting, hit, path.position, path.quaternion, work)
    if not 0.0 < begun < math.inf:
        return hit
    guard, enough = Guard(GAP_CLOSES, hit, -1, 0.0), (ON_FACE * setting.size_m, 0.0)
    amount = first_past(setting, path, guard, begun, hit.amount, spread, enough, work)
    if amount == math.inf:
        return hit
    if amount > hit.amount + LATE * spread:
        return Hit(hit.amount, -1, -1, 0.0)
    return Hit(amount, hit.feature, hit.cage_feature, hit.angle)


@kernel
def passed_before(
    setting: Setting,
    path: Path,
    amount: float,
    end: Vector,
    turned: Quaternion,
    reach_m: float,
    work: QuasistaticWorkspace,
) -> Hit:
    """Return what a step goes through before its end, after an amount of the path; `NO_HIT`: nothing.

    Along the path things are reached in another order than along its screw. The screw from the step's start to its very
    end meets all that is passed. The placement is that of the start.
    """
    place_object(setting.geometry, path.position, path.quaternion, work.placement)
    velocity, spin = twist_between(path.position, path.quaternion, end, turned)
    screw = Twist(velocity, spin, 1.0)
    met = first_contact(setting, work.placement, work.contacts, path.position, path.quaternion, screw, reach_m)
    if met.feature < 0 or gap_of(setting, met, end, turned, work) >= -setting.tolerances.touch_m:
        return NO_HIT
    return Hit(met.amount * amount, met.feature, met.cage_feature, met.angle)


@kernel
def strayed_at_most(setting: Setting, path: Path, work: QuasistaticWorkspace) -> float:
    """Return about how far the contacts that stay on their faces leave them on a path's screw at most, metres."""
    farthest, twist = 0.0, path.twist
    for amount in (0.5 * twist.end, twist.end):
        away = strayed(
            setting.geometry,
            work.placement,
            work.contacts,
            path.position,
            path.quaternion,
            twist.velocity,
            twist.spin,
            amount,
            0.0,
        )
        farthest = max(farthest, away)
    return farthest


@kernel
def furthest_step(setting: Setting, path: Path, work: QuasistaticWorkspace) -> tuple[float, bool, Vector, Quaternion]:
    """Go along a path, from `along_faces`, to its end, the first contact or the end of a contact, or less if need be.
    Of each contact it is asked whether it ends before what has been found so far does.

    Return (amount, whether it went as far as it should, position, quaternion); amount 0: it could not move; inf:
    nothing is ahead. The placement is that of the pose.
    """
    twist, contacts, placement, speed = path.twist, work.contacts, work.placement, speed_along(setting, path)
    is_curved, reach_m, touch_m = is_guided(work) and twist.end < math.inf, 0.0, setting.tolerances.touch_m
    if is_curved:
        reach_m = STRAYED * strayed_at_most(setting, path, work)
    spread = SLANTED * reach_m / speed
    hit = first_contact(setting, placement, contacts, path.position, path.quaternion, twist, reach_m)
    if hit.feature >= 0 and is_guided(work):
        hit = hit_on_path(setting, path, hit, spread, work)
    amount = min(hit.amount, twist.end)
    for i in range(contacts.used[0]):
        if not is_kept(contacts, i):
            continue
        crossing = edge_crossing(
            setting.geometry,
            placement,
            contacts,
            i,
            path.position,
            path.quaternion,
            twist.velocity,
            twist.spin,
            amount,
            reach_m,
            touch_m,
        )
        if crossing < math.inf and is_curved:
            guard, enough = Guard(CONTACT_ENDS, NO_HIT, i, 0.0), (NEAR_END * touch_m, NEAR_END * touch_m / speed)
            crossing = first_past(setting, path, guard, math.inf, crossing, spread, enough, work)
        amount = min(amount, crossing)
    if amount == math.inf:
        return amount, True, path.position, path.quaternion
    if amount < hit.amount:
        hit = NO_HIT
    as_planned = True
    for _ in range(HALVINGS):
        done, end, turned = step_to(setting, path, amount, hit, work)
        if done and not (is_curved and amount < twist.end):
            return amount, as_planned and amount > 0.0, end, turned
        if done:
            passed = passed_before(setting, path, amount, end, turned, reach_m, work)
            if passed.feature < 0:
                place_object(setting.geometry, end, turned, placement)
                return amount, as_planned and amount > 0.0, end, turned
            hit = hit_on_path(setting, path, passed, spread, work)
            if hit.amount < amount:
                amount = hit.amount
                continue
        amount, hit, as_planned = 0.5 * amount, NO_HIT, False
    return 0.0, False, path.position, path.quaternion


@kernel
def power_ends(
    setting: Setting,
    path: Path,
    amount: float,
    end: tuple[Vector, Quaternion],
    begun: float,
    work: QuasistaticWorkspace,
) -> tuple[bool, bool, float, tuple[Vector, Quaternion]]:
    """Return whether the object is held on a step, or would turn back, whether it could stay before, and the amount of
    the step, and its pose, after which it first is; else those of its end. The placement is that of the pose there.
    ``begun`` is the power of the motion at the start.
    """
    power, could_stay = power_left(setting, end[0], end[1], path.twist, work)
    if power >= -TURNED_BACK * max(begun, 0.0):
        return False, could_stay, amount, end
    at_start = math.inf
    if power > -math.inf:  # a sign at the end says something if that at the start is the other one
        place_object(setting.geometry, path.position, path.quaternion, work.placement)
        at_start, _ = power_left(setting, path.position, path.quaternion, path.twist, work)
    if at_start > 0.0:
        guard = Guard(POWER_ENDS, NO_HIT, -1, 0.0)
        first = first_past(setting, path, guard, at_start, amount, 0.0, (0.0, 0.0), work)
        if first < amount:
            could_stay, last = run_down(setting, path, first, work)
            done, position, quaternion = step_to(setting, path, last, NO_HIT, work)
            if not done and last > first:
                last = first
                done, position, quaternion = step_to(setting, path, last, NO_HIT, work)
            if done:
                return True, could_stay, last, (position, quaternion)
    place_object(setting.geometry, end[0], end[1], work.placement)
    return False, False, amount, end


@kernel
def run_down(setting: Setting, path: Path, first: float, work: QuasistaticWorkspace) -> tuple[bool, float]:
    """Return whether an object that friction holds after an amount of a path could stay before, and the amount after
    which it stands. At the very end of such a motion any slow one is nearly another onset, so that nothing could be
    said of its rest: it runs on a little.
    """
    little = RUN_DOWN * setting.size_m / speed_along(setting, path)
    before = max(first - little, 0.5 * first)
    done, position, quaternion = step_to(setting, path, before, NO_HIT, work)
    could_stay = done and power_left(setting, position, quaternion, path.twist, work)[1]
    return could_stay, first + little if could_stay else first


@kernel
def begins_to_tip(
    setting: Setting, path: Path, amount: float, end: tuple[Vector, Quaternion], work: QuasistaticWorkspace
) -> tuple[bool, float, tuple[Vector, Quaternion]]:
    """Return whether the object begins to tip on a step, or is held there, and after which amount and where; else those
    of its end. The placement is that of the pose, and the motion from rest at the start is in the solver.
    """
    velocity, spin = twist_of(work.scratch[0].solver.y, frame_at(setting.body, path.quaternion))
    spin_each_m = norm(spin) / norm(velocity) if norm(velocity) > 0.0 else math.inf
    before_end = BEFORE_END * setting.tolerances.touch_m / norm(path.twist.velocity)
    guard, value, last = Guard(BEGINS_TO_TIP, NO_HIT, -1, spin_each_m), math.inf, 0.0
    for _ in range(TIMES):
        last = amount - before_end
        if last <= 0.0:
            break
        done, there, turned = step_to(setting, path, last, NO_HIT, work)
        if done and find_all_carried(setting, there, turned, work):
            value = value_of(setting, path, guard, last, work)
            break
        before_end *= FARTHER
    if value < 0.0:
        first = first_past(setting, path, guard, math.inf, last, 0.0, (0.0, NEAR_TIP * last), work)
        done, there, turned = step_to(setting, path, min(first, last), NO_HIT, work)
        if done:
            return True, min(first, last), (there, turned)
    place_object(setting.geometry, end[0], end[1], work.placement)
    return False, amount, end

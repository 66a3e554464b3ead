"""One step along a drive: as far as the mode of the contacts lasts, up to the first of its guards."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.vector import Vector, norm
from cagepose.kernels.boundary.features import number_of_bodies
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.metric import twist_between
from cagepose.kernels.contact.pressing import Pressing, copy_pressing
from cagepose.kernels.driven.bodies import move_bodies, place_bodies, seen_from_body
from cagepose.kernels.driven.snap import is_inside
from cagepose.kernels.driven.trial import LITTLE, try_share, write_guards
from cagepose.kernels.driven.workspace import HITS_LIMIT, DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.first_contact import NO_HIT, Hit, Twist, first_with_body

TRIALS = 60
"""How many places one event is looked for at."""
SAME_SHARE = 1e-14
"""So near is an event found, in shares of the drive."""
SMALL = 1e-3
"""Of a step: so far a mode that was found has to last; or as far as it has been tried."""
AT_ZERO = 4e-12
"""A guard that is so near to zero has got there."""
HALVINGS = 30
"""How often a step is halved that would end inside."""
CHORDS = 12
"""How often what is met is looked for along a straight way between two rests."""


@kernel
def next_trial(low: float, high: float, by_low: float, by_high: float, work: DriveWorkspace) -> float:
    """Return where the first of the guards that fall through zero between two shares does, by false position, with the
    guards of each side taken to be so many times what they are.
    """
    nearest = high
    for k in range(len(work.low)):
        at_low, at_high = by_low * max(work.low[k], 0.0), by_high * work.high[k]
        if at_high < 0.0 and at_low < math.inf:
            nearest = min(nearest, low + (high - low) * at_low / (at_low - at_high))
    return nearest


@kernel
def has_got_there(work: DriveWorkspace) -> bool:
    """Whether one of the guards that are below zero on the upper side is at zero on the lower one."""
    found = False
    for k in range(len(work.low)):
        found = found or (work.high[k] < 0.0 and work.low[k] <= AT_ZERO)
    return found


@kernel
def last_of_mode(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, to_share: float, work: DriveWorkspace
) -> float:
    """Return the share, up to another one, at which the first guard of the mode reaches zero, or the rest is lost."""
    found, end, turned = try_share(drive, position, quaternion, share, to_share, work)
    least = write_guards(drive, end, turned, to_share, work, work.high) if found else -math.inf
    if found and least >= 0.0:
        return to_share
    # A guard may be at zero where the step begins: what it does from there shows a little ahead.
    low, high, by_low, by_high, was_low = share, to_share, 1.0, 1.0, False
    for ahead in (SMALL, LITTLE, 0.0):
        low = share + ahead * (to_share - share)
        begun, end, turned = try_share(drive, position, quaternion, share, low, work)
        if begun and write_guards(drive, end, turned, low, work, work.low) >= 0.0:
            break
    else:
        return share
    for trial in range(TRIALS):
        if high - low <= SAME_SHARE or (found and has_got_there(work)):
            break
        middle = next_trial(low, high, by_low, by_high, work) if found else 0.5 * (low + high)
        if not low < middle < high or trial % 8 == 7:
            middle = 0.5 * (low + high)
        solved, end, turned = try_share(drive, position, quaternion, share, middle, work)
        if not solved:
            high, found = middle, False
            continue
        least = write_guards(drive, end, turned, middle, work, work.middle)
        if least >= 0.0:
            copy_guards(work.middle, work.low)
            low, by_high = middle, 0.5 * by_high if was_low else 1.0
            by_low, was_low = 1.0, True
        else:
            copy_guards(work.middle, work.high)
            high, by_low = middle, 0.5 * by_low if not was_low else 1.0
            by_high, was_low, found = 1.0, False, True
    return low


@kernel
def copy_guards(guards: FloatArray, out: FloatArray) -> None:
    for k in range(len(out)):
        out[k] = guards[k]


@kernel
def met_on_chord(
    drive: DriveSetting,
    position: Vector,
    quaternion: Quaternion,
    share: float,
    end: Vector,
    turned: Quaternion,
    to_share: float,
    begun: Rows[Pressing],
    work: DriveWorkspace,
) -> Hit:
    """Return what the object meets first on the straight way between two rests, as each body sees it, but for what
    touches already, after a part of the way. The bodies are where they are at the first rest, what presses where it had
    ``begun``, and the object is placed; the second rest is the one tried last.
    """
    setting, first = drive.setting, NO_HIT
    for body in range(number_of_bodies(setting.geometry.cage)):
        there, there_turned = seen_from_body(work.memory, begun, body, (share, to_share), end, turned)
        velocity, spin = twist_between(position, quaternion, there, there_turned)
        if norm(velocity) + norm(spin) == 0.0:
            continue
        twist = Twist(velocity, spin, min(1.0, first.amount))
        placement, contacts = work.run.placement, work.run.contacts
        hit = first_with_body(setting, body, placement, contacts, position, quaternion, twist, 0.0)
        if hit.amount < first.amount:
            first = hit
    return first


@kernel
def note_hit(hit: Hit, work: DriveWorkspace) -> bool:
    """Let the gap of what may be met be a guard; False: it is one already, or there is no room."""
    scratch = work.scratch[0]
    for which in range(scratch.n_hits):
        same = scratch.hit_features[which, 0] == hit.feature and scratch.hit_features[which, 1] == hit.cage_feature
        if same and abs(scratch.hit_angles[which] - hit.angle) < 1e-3:
            return False
    if scratch.n_hits == HITS_LIMIT:
        return False
    scratch.hit_features[scratch.n_hits, 0] = hit.feature
    scratch.hit_features[scratch.n_hits, 1] = hit.cage_feature
    scratch.hit_angles[scratch.n_hits] = hit.angle
    scratch.n_hits += 1
    return True


@kernel
def furthest_share(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, to_share: float, work: DriveWorkspace
) -> tuple[float, Vector, Quaternion]:
    """Return (share, position, quaternion): how far the mode of ``work.run.contacts`` lasts, up to another share.
    ``work.run.ahead`` holds the contacts there; the bodies are where they are there.
    """
    scratch, setting = work.scratch[0], drive.setting
    scratch.n_hits = 0
    begun = work.run.turned.pressing
    copy_pressing(work.memory.pressing, begun)
    last = last_of_mode(drive, position, quaternion, share, to_share, work)
    from_share, begin, begin_turned = share, position, quaternion
    end, turned = position, quaternion
    for _ in range(CHORDS):
        if last <= share:
            break
        found, end, turned = try_share(drive, position, quaternion, share, last, work)
        if not found:
            return share, position, quaternion
        place_bodies(setting.geometry, drive.phase, from_share, work.memory, begun)
        place_object(setting.geometry, begin, begin_turned, work.run.placement)
        hit = met_on_chord(drive, begin, begin_turned, from_share, end, turned, last, begun, work)
        if hit.amount == math.inf:
            break
        if hit.feature >= 0 and note_hit(hit, work):
            last = last_of_mode(drive, position, quaternion, share, last, work)
            continue
        # It is not met after all: what is met behind it is looked for from there.
        from_share += max(hit.amount, 0.05) * (last - from_share)
        found, begin, begin_turned = try_share(drive, position, quaternion, share, from_share, work)
        copy_pressing(work.memory.tried, begun)
        if not found or from_share >= last - SAME_SHARE:
            break
    for _ in range(HALVINGS):
        if last <= share:
            break
        found, end, turned = try_share(drive, position, quaternion, share, last, work)
        if found and not is_inside(drive, end, turned, work):
            return last, end, turned
        last = share + 0.5 * (last - share)  # something was passed over
    move_bodies(setting.geometry, drive.phase, share, work.memory)
    return share, position, quaternion

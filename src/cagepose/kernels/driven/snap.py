"""Where the rest is lost along a drive, the object snaps: the bodies stand still, and it moves to the next rest."""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import length
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, norm, scaled
from cagepose.kernels.boundary.features import place_boundary
from cagepose.kernels.boundary.geometry import deepest_overlap, held_at, place_object
from cagepose.kernels.contact.curvature import write_curvature
from cagepose.kernels.contact.loads import write_load
from cagepose.kernels.contact.metric import Frame, frame_at, moved_along_twist, twist_of, way_between
from cagepose.kernels.driven.bodies import move_bodies, write_drift
from cagepose.kernels.driven.forces_jump import go_with_all
from cagepose.kernels.driven.rest_of_mode import list_carrying
from cagepose.kernels.driven.stiffness import hold_carried, least_stiffness
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import ESCAPES, LIMIT, RESTS
from cagepose.kernels.quasistatic.first_contact import Twist, first_contact
from cagepose.kernels.quasistatic.path import Path, on_faces
from cagepose.kernels.quasistatic.pushing_out import allow_depths, constrain_contacts
from cagepose.kernels.quasistatic.run import steps_from
from cagepose.kernels.quasistatic.state import State, at_rest
from cagepose.kernels.quasistatic.step import stand_at

PUSHES = (0.0, 1e-5, 1e-4, 1e-3, 1e-2)
"""In sizes of the scene: how far an object is pushed out of a balance that is lost, one after the other."""
OPENED = 1e-3
"""In sizes of the scene: how far an object goes where that opens its contacts to second order."""
AHEAD = (1e-4, 1e-3, 1e-2)
"""Of a step: how far bodies go on, one after the other, where no mode is found with which the object follows."""
CARRIES = 1e-9
"""In greatest forces: what carries less is let go."""
MOVED = 1e-9
"""In sizes of the scene: an object that is no farther away has not moved."""
SNAP_STEPS = 1000
"""An object that has not come to rest after so many steps is pushed on."""
STAYS = 4.0
"""In pushes: an object that comes to rest no farther away has not snapped."""


@kernel
def is_inside(drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> bool:
    """Whether the object at a pose and the cage are in each other by more than the touch tolerance."""
    geometry, run = drive.setting.geometry, work.run
    place_boundary(held_at(geometry, run.placement), position, quaternion)
    return deepest_overlap(geometry, run.placement, run.cage.overlap).feature >= 0


@kernel
def softest_twist(frame: Frame, work: DriveWorkspace) -> tuple[Vector, Vector]:
    """Return (velocity, angular velocity) of the first of the vectors in the scratch."""
    scratch = work.scratch[0]
    for k in range(work.run.contacts.n_freedoms):
        scratch.load[k] = scratch.vectors[k, 0]
    return twist_of(scratch.load, frame)


@kernel
def opened_pose(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace
) -> tuple[bool, Vector, Quaternion]:
    """Return a pose a little along the first of the vectors in the scratch, to one side or the other, where nothing is
    inside; False: there is none.
    """
    setting = drive.setting
    velocity, spin = softest_twist(frame_at(setting.body, quaternion), work)
    speed = norm(velocity) + setting.body.reach_m * norm(spin)
    for side in (1.0, -1.0):
        amount = side * OPENED * setting.size_m / speed
        end, turned = moved_along_twist(position, quaternion, velocity, spin, amount)
        if not is_inside(drive, end, turned, work):
            return True, end, turned
    return False, position, quaternion


@kernel
def find_softest(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, frame: Frame, work: DriveWorkspace
) -> None:
    """Write the motion with the least stiffness, of what contacts that carry leave free, into the first of the vectors
    in the scratch. What carries next to nothing holds nothing.
    """
    setting, contacts, rest = drive.setting, work.run.contacts, work.scratch[0].rest
    greatest, n = 0.0, contacts.n_freedoms
    for i in range(contacts.used[0]):
        greatest = max(greatest, contacts.states[i].forces[0] * length(contacts.rows[i].columns[0], n))
    greatest = max(greatest, write_load(setting.load, position, quaternion, frame, rest.load))
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        state.counts = state.counts and state.forces[0] * length(contacts.rows[i].columns[0], n) > CARRIES * greatest
    list_carrying(contacts, setting.friction.greatest, rest)
    for place in range(rest.newton.n_carrying):
        for which in range(2):
            rest.slips[place, which] = contacts.states[rest.newton.contacts[place]].forces[1 + which]
    write_curvature(contacts, setting.load, position, quaternion, frame, False, rest.curvature)
    hold_carried(contacts, work)
    least_stiffness(drive, contacts, rest.curvature, work)


@kernel
def snaps(
    drive: DriveSetting, state: State, first_step: int, step_limit: int, work: DriveWorkspace
) -> tuple[int, int, State]:
    """Let the object go where the bodies stand, from a rest that is lost; return (verdict code, number of all steps,
    state at the end). It stays where it is, and nothing is written, if no push takes it elsewhere.

    It is pushed along what has the least stiffness, both ways, at first by nothing, then more and more.
    """
    setting, run = drive.setting, work.run
    frame = frame_at(setting.body, state.quaternion)
    find_softest(drive, state.position, state.quaternion, frame, work)
    velocity, spin = softest_twist(frame, work)
    speed = norm(velocity) + setting.body.reach_m * norm(spin)
    most = min(step_limit, first_step + SNAP_STEPS)
    for push in PUSHES:
        push_m = push * setting.size_m
        for side in (1.0, -1.0):
            begin, turned = state.position, state.quaternion
            if push > 0.0 and speed > 0.0:
                if not stand_at(setting, begin, turned, run):
                    continue
                along = Twist(scaled(velocity, side / speed), scaled(spin, side / speed), push_m)
                allow_depths(setting.geometry, run.placement, setting.tolerances, run.path)
                constrain_contacts(run.contacts, setting.tolerances.rounding_m, run.path.constraints)
                met = first_contact(setting, run.placement, run.contacts, begin, turned, along, 0.0)
                if met.feature >= 0:  # a push may not lead through a wall
                    continue
                done, begin, turned = on_faces(setting, Path(begin, turned, along), push_m, run)
                if not done or is_inside(drive, begin, turned, work):
                    continue
            elif push > 0.0 or side < 0.0:
                continue
            pushed = at_rest(begin, turned, state.turn_step_rad, 0)
            verdict, step, after = steps_from(setting, pushed, first_step, most, run)
            if verdict == LIMIT and most < step_limit:
                continue
            away = way_between(state.position, state.quaternion, after.position, after.quaternion, setting.body.reach_m)
            lets_go = verdict == ESCAPES and push == 0.0  # a push may lead over what held it
            if lets_go or away > max(STAYS * push_m, MOVED * setting.size_m):
                return verdict, step, after
    place_object(setting.geometry, state.position, state.quaternion, run.placement)
    return RESTS, first_step, state


@kernel
def rests_ahead(
    drive: DriveSetting,
    state: State,
    share: float,
    to_share: float,
    first_step: int,
    step_limit: int,
    may_stay: bool,
    work: DriveWorkspace,
) -> tuple[int, int, State, float]:
    """Let the bodies go on a little, the object with what carries it, and then go where it goes; return (verdict code,
    number of all steps, state at the end, share). Nothing happens if it goes nowhere, but if it ``may_stay``.
    """
    setting, run, scratch, reach_m = drive.setting, work.run, work.scratch[0], drive.setting.body.reach_m
    for i in range(run.contacts.used[0]):
        write_drift(run.contacts, i, state.position, share, work.memory)
    go_with_all(work)
    velocity, spin = twist_of(scratch.way, frame_at(setting.body, state.quaternion))
    most = min(step_limit, first_step + SNAP_STEPS)
    for part in AHEAD:
        ahead = part * (to_share - share)
        move_bodies(setting.geometry, drive.phase, share + ahead, work.memory)
        begin, turned = state.position, state.quaternion
        if norm(velocity) + norm(spin) > 0.0:
            begin, turned = moved_along_twist(begin, turned, velocity, spin, ahead)
        if is_inside(drive, begin, turned, work):
            break
        begun = at_rest(begin, turned, state.turn_step_rad, 0)
        verdict, step, after = steps_from(setting, begun, first_step, most, run)
        if verdict == LIMIT and most < step_limit:
            continue
        with_bodies = way_between(state.position, state.quaternion, begin, turned, reach_m)
        away = way_between(begin, turned, after.position, after.quaternion, reach_m)
        goes = verdict == ESCAPES or away > max(STAYS * with_bodies, MOVED * setting.size_m)
        if goes or (verdict == RESTS and may_stay):
            return verdict, step, after, share + ahead
    move_bodies(setting.geometry, drive.phase, share, work.memory)
    place_object(setting.geometry, state.position, state.quaternion, run.placement)
    return RESTS, first_step, state, share

"""The history of a drive: its steps, with the forces of the drivers, their work, and where the object could jam."""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.contact.loads import total_load, work_done
from cagepose.kernels.driven.bodies import (
    energy_of_riding,
    move_bodies,
    write_drivers,
)
from cagepose.kernels.driven.could_jam import note_jams
from cagepose.kernels.driven.rate import APART
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import NONE, PLAIN, RESTS, SCREW
from cagepose.kernels.quasistatic.state import State
from cagepose.kernels.quasistatic.step import DRIVEN, write_step

JUMP = 1e-6
"""Of the drivers' force and the load: a greater change at one place is told. The force is that a little ahead."""


@kernel
def keep_greatest(share: float, driving: float, work: DriveWorkspace) -> None:
    """Keep the drivers' force of a place if it is the greatest so far."""
    scratch = work.scratch[0]
    if driving > scratch.greatest:
        scratch.greatest, scratch.greatest_at = driving, share


@kernel
def write_driven(
    drive: DriveSetting,
    step: int,
    share: float,
    position: Vector,
    quaternion: Quaternion,
    moved: bool,
    work: DriveWorkspace,
) -> None:
    """Write a step of a drive, with what the contacts carry after it."""
    run = work.run
    write_step(run, step, DRIVEN, SCREW if moved else NONE, False, position, quaternion)
    record = run.trace.rows[step]
    record.share = share
    for body in range(len(work.memory.pressing)):
        one = work.memory.pressing[body]
        if one.freedom > 0:
            record.pressed[one.freedom - WRENCH] = one.gone
    record.driving = write_drivers(
        run.contacts, position, quaternion, drive.setting.load, share - APART, work.memory, work.drivers
    )
    record.could_jam = note_jams(drive, position, quaternion, share, work)
    keep_greatest(share, record.driving, work)


@kernel
def write_jump(
    drive: DriveSetting, step: int, share: float, position: Vector, quaternion: Quaternion, work: DriveWorkspace
) -> int:
    """Write a step in which nothing moves, if the drivers' force jumps as contacts begin to do something else; return
    the number of steps.
    """
    load, rows = drive.setting.load, work.run.trace.rows
    before = rows[step - 1].driving
    after = write_drivers(work.run.ahead, position, quaternion, load, share, work.memory, work.drivers)
    size = total_load(load, position, quaternion, drive.setting.size_m)
    if abs(after - before) <= JUMP * (abs(before) + abs(after) + size):
        return step
    rows[step] = rows[step - 1]  # type: ignore[index]
    for element in range(len(work.run.touched)):
        work.run.trace.touching[step, element] = work.run.trace.touching[step - 1, element]
        work.run.trace.hit[step, element] = False
    row = rows[step]
    row.rule, row.motion, row.note, row.share, row.driving = DRIVEN, NONE, PLAIN, share, after
    row.could_jam = note_jams(drive, position, quaternion, share, work)
    keep_greatest(share, after, work)
    return step + 1


@kernel
def add_work(
    drive: DriveSetting,
    position: Vector,
    quaternion: Quaternion,
    share: float,
    end: Vector,
    turned: Quaternion,
    to_share: float,
    work: DriveWorkspace,
) -> None:
    """Add the work of the drivers in a step, which is what the potential rises and friction takes, the latter with the
    mean of the forces before and after it. ``work.run.ahead`` is at its end.
    """
    geometry, load, memory, scratch = drive.setting.geometry, drive.setting.load, work.memory, work.scratch[0]
    rest, before, after = scratch.rest, work.run.contacts, work.run.ahead
    move_bodies(geometry, drive.phase, share, memory)
    at_start = energy_of_riding(load, position, quaternion)
    move_bodies(geometry, drive.phase, to_share, memory)
    rises = energy_of_riding(load, position, quaternion) - at_start
    rises -= work_done(load, position, quaternion, end, turned)
    for body in range(len(memory.pressing)):
        was, now = memory.pressing[body], memory.tried[body]
        rises -= 0.5 * (was.force + now.force) * (now.gone - was.gone)
    rubbed = 0.0
    for place in range(rest.newton.n_carrying):
        i = rest.newton.contacts[place]
        for which in range(2):
            force = 0.5 * (before.states[i].forces[1 + which] + after.states[i].forces[1 + which])
            rubbed += force * rest.slips[place, which]
    scratch.rubbed += rubbed
    scratch.work += rises + rubbed


@kernel
def note_snap(
    drive: DriveSetting,
    state: State,
    after: State,
    first: int,
    last: int,
    share: float,
    reached: float,
    verdict: int,
    work: DriveWorkspace,
) -> None:
    """Note in the steps ``first`` up to, without, ``last`` at which share the object has snapped, with which forces of
    the drivers before and after it, and what was lost.
    """
    load, rows, scratch = drive.setting.load, work.run.trace.rows, work.scratch[0]
    for step in range(first, last):
        rows[step].share = reached
        rows[step].driving = rows[first - 1].driving if step < last - 1 else 0.0
    if last == first or verdict != RESTS:
        return
    rows[last - 1].driving = write_drivers(
        work.run.contacts, after.position, after.quaternion, load, reached, work.memory, work.drivers
    )
    move_bodies(drive.setting.geometry, drive.phase, share, work.memory)
    before = energy_of_riding(load, state.position, state.quaternion)
    move_bodies(drive.setting.geometry, drive.phase, reached, work.memory)
    scratch.work += energy_of_riding(load, state.position, state.quaternion) - before
    scratch.lost += work_done(load, state.position, state.quaternion, after.position, after.quaternion)

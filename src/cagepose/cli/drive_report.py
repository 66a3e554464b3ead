"""What came of the drives of a run, and of what presses, as lines of its report: how far, with which force and work."""

from __future__ import annotations

from collections.abc import Iterator

from cagepose.files.words import LengthWords
from cagepose.model.load import Load
from cagepose.model.wording import short
from cagepose.runs.actions import load_size
from cagepose.runs.driven import BodyRun, DriveRun
from cagepose.runs.drives import displaced_after, turns_alone
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.run import FAILURES, PhaseRun, Run
from cagepose.views.drive_words import STOPS

LEAST_FORCE, LEAST_WORK = 1e-12, 1e-8
"""In loads, and in loads over the scene's size: less is written as zero. Bodies that push with none still find contacts
anew within the touch tolerance, and that looks like work.
"""


def drive_lines(run: Run, words: LengthWords) -> list[tuple[str, str]]:
    """Return the lines of all phases that drive bodies of the cage, or let them press."""
    driven = [place for place, load in enumerate(run.scene.loads[: len(run.phases)]) if load.drive]
    lines = [line for place in driven for line in lines_of_phase(run, place, words, is_alone=len(driven) == 1)]
    presses = [(phase.name, phase.press) for phase in run.phases if phase.press is not None]
    for name, press in presses:
        of_phase = "" if len(presses) == 1 else f" of {name}"
        lines += [(f"press{of_phase}", "; ".join(_pressed(*body, words) for body in press.bodies.items()))]
    return lines


def _pressed(name: str, body: BodyRun, words: LengthWords) -> str:
    """Return ``pad moved by 3.5 mm and presses with 12 N``; what is not at rest does not press."""
    way = words.lengths([abs(body.travel_m)])
    went = "was pushed back by" if body.travel_m < 0.0 else "moved by"
    told = f"{name} does not move" if way == "0" else f"{name} {went} {way} {words.unit}"
    return f"{told} and presses with {short(body.along, 6, 1e-12)} N" if body.force_n.any() else told


def lines_of_phase(run: Run, place: int, words: LengthWords, *, is_alone: bool) -> Iterator[tuple[str, str]]:
    """Yield the lines of one phase, which names itself in the first one if others drive something, too."""
    phase, load = run.phases[place], run.scene.loads[place]
    of_phase = "" if is_alone else f" of {phase.name}"
    drive, why = phase.drive, _why(phase)
    if drive is None:
        yield f"drive{of_phase}", f"it did not start{why}"
        return
    yield f"drive{of_phase}", f"{_way(phase, load, words)}{why}"
    unit = "N" if force_unit(run.scene, load) == "N" else "load"
    size = load_size(run.scene, place, phase.pose, displaced_after(run, place))

    def along(value: float, share: float) -> str:
        if turns_alone(load, share):
            return f"{words.scaled(value, LEAST_FORCE * size * run.scene.size_m)} {unit} {words.unit}"
        return f"{short(value, 6, LEAST_FORCE * size)} {unit}"

    at_end, most = along(drive.along, drive.share), along(drive.greatest_along, drive.greatest_share)
    where = f"the greatest is {most} at {words.depth(load, drive.greatest_share)}"
    yield "drive force", f"{at_end} at the end, {'which is the greatest' if most == at_end else where}"
    least = LEAST_WORK * size * run.scene.size_m
    works = [words.scaled(work, least) for work in (drive.work_j, drive.friction_j, drive.snaps_j)]
    yield "work", f"{works[0]} {unit} {words.unit} (friction {works[1]}, snaps {works[2]})"
    yield "jam", _jam(drive, load, words)


def _jam(drive: DriveRun, load: Load, words: LengthWords) -> str:
    """Return between which depths it could jam, and with how much friction."""
    least = drive.critical_jam_friction
    if least is None:
        return "impossible at any friction, at all places checked"
    friction = f"it takes a friction of {short(least, 4, 1e-9)} or more"
    if not drive.jam_possible:
        return f"impossible at this friction, at all places checked ({friction})"
    ways = ", ".join(f"{words.depth(load, begins)} to {words.depth(load, ends)}" for begins, ends in drive.jam_possible)
    return f"possible from {ways} ({friction})"


def _why(phase: PhaseRun) -> str:
    if phase.verdict in STOPS:
        return f"; {phase.verdict}: {STOPS[phase.verdict]}"
    return f"; {phase.verdict}" if phase.verdict in FAILURES else ""


def _way(phase: PhaseRun, load: Load, words: LengthWords) -> str:
    """Return ``12.5 mm of 25 mm (50 %)``, or ``complete, 25 mm``; of several bodies how far each got."""
    assert phase.drive is not None
    share = phase.drive.share
    if len(load.drive) == 1:
        whole = words.depth(load, 1.0)
        return f"complete, {whole}" if share == 1.0 else f"{words.depth(load, share)} of {whole} ({_percent(share)})"
    ways = ", ".join(f"{name} {words.way(legs, share)}" for name, legs in load.drive.items())
    return f"complete ({ways})" if share == 1.0 else f"{_percent(share)} of the way ({ways})"


def _percent(share: float) -> str:
    return f"{short(100.0 * share, 4, 1e-10)} %"

"""From the outcome of a run, as kernels write it, to what came of its drives, and of what presses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import BLOCKED, JAMS, RESTS, STOPS
from cagepose.kernels.quasistatic.step import DRIVEN
from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import body_numbers, cage_middle
from cagepose.runs.driven import BodyRun, Curve, DriveRun, PressRun
from cagepose.runs.drives import pressing_forces, way_of


def read_drives(scene: Scene, outcome: Outcome) -> list[DriveRun | None]:
    """Return what came of the drive of each phase that was run; None: nothing was driven."""
    records: Any = outcome.phases
    steps: Any = outcome.steps
    found, first = list[DriveRun | None](), 0
    for phase, (load, record) in enumerate(zip(scene.loads, records, strict=False)):
        last, own = int(record["n_steps"]), slice(first, int(record["n_steps"]))
        is_driven = steps["rule"][own] == DRIVEN
        if load.drive and (is_driven.any() or record["verdict"] in (BLOCKED, JAMS, STOPS)):
            begins = first + int(np.argmax(is_driven)) - 1 if is_driven.any() else last - 1
            rows = slice(begins, last)
            curve = _curve(steps, outcome.path, rows)
            jams = _jams(curve.share, steps["could_jam"][rows])
            found.append(_drive(record, curve, _bodies(scene, load, outcome, phase), jams))
        else:
            found.append(None)
        first = last
    return found


def _curve(steps: Any, path: FloatArray, rows: slice) -> Curve:
    return Curve(steps["share"][rows].copy(), steps["driving"][rows].copy(), path[rows, :3], path[rows, 3:])


def _jams(shares: FloatArray, could_jam: NDArray[np.bool_]) -> tuple[tuple[float, float], ...]:
    """Return from where to where it could jam: each place that could stands for the way to it, too."""
    found = list[tuple[float, float]]()
    for place in np.flatnonzero(could_jam).tolist():
        begins, ends = float(shares[max(place - 1, 0)]), float(shares[place])
        if found and begins <= found[-1][1]:
            found[-1] = (found[-1][0], ends)
        else:
            found.append((begins, ends))
    return tuple(found)


def _drive(record: Any, curve: Curve, bodies: dict[str, BodyRun], jams: tuple[tuple[float, float], ...]) -> DriveRun:
    return DriveRun(
        float(record["share"]),
        float(record["driving"]),
        float(record["greatest"]),
        float(record["greatest_at"]),
        float(record["work"]),
        float(record["rubbed"]),
        float(record["lost"]),
        bodies,
        curve,
        jams,
        float(record["least_jam"]) if record["least_jam"] < np.inf else None,
    )


def _bodies(scene: Scene, load: Load, outcome: Outcome, phase: int) -> dict[str, BodyRun]:
    """Return how each body that a phase drives ends."""
    share, bodies = float(outcome.phases[phase].share), scene.cage.bodies
    return {
        body.name: _body(scene, outcome, phase, number, *way_of(load.drive[body.name], share))
        for number, body in enumerate(bodies, start=1)
        if body.name in load.drive
    }


def _body(scene: Scene, outcome: Outcome, phase: int, number: int, travel_m: float, angle_rad: float) -> BodyRun:
    """Return where a body ends that got so far, and what drives it. Kernels tell moments about the cage's middle."""
    displaced, driver = outcome.displaced[phase, number], outcome.drivers[phase, number]
    pose = Pose(displaced[:3], displaced[3:]) @ scene.cage.bodies[number - 1].pose_cage_body
    arm = cage_middle(scene) - scene.cage.pose_world_cage.transform(pose.position_m)
    moment = driver[3:6] + np.cross(arm, driver[:3])
    return BodyRun(pose, travel_m, angle_rad, driver[:3].copy(), moment, float(driver[6]))


def read_presses(scene: Scene, outcome: Outcome) -> list[PressRun | None]:
    """Return what the bodies did that press in each phase that was run; None: none does."""
    steps: Any = outcome.steps
    phases: Any = outcome.phases
    found, numbers, shares = list[PressRun | None](), body_numbers(scene), shares_of_steps(scene, outcome)
    for phase, (load, rows) in enumerate(zip(scene.loads, _steps_of_phases(outcome), strict=False)):
        travels = steps["pressed"][rows, : len(load.press)].copy()
        forces = dict.fromkeys(load.press, 0.0)
        if phases[phase]["verdict"] in (RESTS, BLOCKED, JAMS, STOPS):
            forces = pressing_forces(scene, phase, outcome.displaced[phase])
        bodies = {
            name: replace(_body(scene, outcome, phase, numbers[name], float(travels[-1, place]), 0.0), along=force)
            for place, (name, force) in enumerate(forces.items())
        }
        found.append(PressRun(bodies, np.array(shares[rows]), travels) if bodies else None)
    return found


def shares_of_steps(scene: Scene, outcome: Outcome) -> list[float]:
    """Return how much of the phase's drive, or of all ways of what presses, is done after each step."""
    steps: Any = outcome.steps
    records: Any = outcome.phases
    found, ends = steps["share"].copy(), records["share"].tolist()
    for load, rows, end in zip(scene.loads, _steps_of_phases(outcome), ends, strict=False):
        if load.press and not load.drive and end > 0.0:
            found[rows] /= end
    shares: list[float] = found.tolist()
    return shares


def _steps_of_phases(outcome: Outcome) -> Iterator[slice]:
    records: Any = outcome.phases
    lasts = records["n_steps"].tolist()
    yield from map(slice, [0, *lasts], lasts)

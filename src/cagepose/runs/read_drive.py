"""From the outcome of a run, as kernels write it, to what came of its drives."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import BLOCKED, JAMS, STOPS
from cagepose.kernels.quasistatic.step import DRIVEN
from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import cage_middle
from cagepose.runs.driven import BodyRun, Curve, DriveRun
from cagepose.runs.drives import way_of


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
    """Return how each body that a phase drives ends. Kernels tell moments about the middle of the cage."""
    found, cage, record = dict[str, BodyRun](), scene.cage, outcome.phases[phase]
    middle = cage_middle(scene)
    for number, body in enumerate(cage.bodies, start=1):
        if body.name not in load.drive:
            continue
        legs, displaced, driver = (
            load.drive[body.name],
            outcome.displaced[phase, number],
            outcome.drivers[phase, number],
        )
        pose = Pose(displaced[:3], displaced[3:]) @ body.pose_cage_body
        origin = cage.pose_world_cage.transform(pose.position_m)
        found[body.name] = BodyRun(
            pose,
            *way_of(legs, float(record.share)),
            driver[:3].copy(),
            driver[3:6] + np.cross(middle - origin, driver[:3]),
            float(driver[6]),
        )
    return found

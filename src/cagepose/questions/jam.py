"""From which friction on a part jams, however hard it is driven or pushed: `jam`.

A drive could jam where forces of the contacts stand against it, (8.7), and a push where such forces take it up alone.
Both are one question, asked at each place of the way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.model.pose import Pose
from cagepose.questions.ends import phase_asked
from cagepose.questions.unanswered import Unanswered
from cagepose.runs.cases import greatest_friction
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Run
from cagepose.studies.could_jam import jam_friction_along
from cagepose.studies.pushed_jam import push_jam_friction


@dataclass(frozen=True, eq=False)
class Jam:
    """From which coefficient of friction on a part can jam along the way that it goes with the friction that it has.

    Where points, boxes or shapes have coefficients of their own, it is the greatest of all, and the others keep their
    proportion to it.

    Attributes
    ----------
    phase, verdict
        The phase's name, and how it ended.
    is_driven
        Whether bodies of the cage are driven; else forces push.
    present, has_several
        The coefficient of the scene, and whether some have coefficients of their own.
    friction
        The least with which it can jam, however hard it is driven or pushed, to 1e-5 of itself; infinite: none up to
        10. Below it, it does not at any place that was asked. Zero: with any friction above it, as without play.
    pose_world_object
        Where the object is then; None: nowhere.
    share
        After which share of the drive; None: nothing is driven, or nowhere.
    n_asked
        At how many places of the way it was asked.
    n_stopped
        At how many of these contacts hold a push without friction, as at the end of the way: they do not count.
    n_open
        At how many more touches than can be asked.
    """

    phase: str
    verdict: str
    is_driven: bool
    present: float
    has_several: bool
    friction: float
    pose_world_object: Pose | None
    share: float | None
    n_asked: int
    n_stopped: int
    n_open: int


def jam(run: Run, phase: str | None = None) -> Jam | Unanswered:
    """Say from which coefficient of friction on the object can jam, however hard the phase drives or pushes it.

    Parameters
    ----------
    run
        By the quasistatic method, where the phase drives something; else of either.
    phase
        Name of the phase; None: the last.

    Raises
    ------
    SceneError
        The run has no such phase.
    """
    number = phase_asked(run, phase)
    load, ended = run.scene.loads[number], run.phases[number]
    if load.press:
        return Unanswered(f"bodies press in {load.name}, and it is asked for drives and forces alone")
    if load.drive and ended.drive is None:
        return Unanswered(f"the drive of {load.name} did not start: it ends as {ended.verdict!r}")
    if not (load.drive or load.pushes):
        return Unanswered(f"{load.name} neither drives nor pushes anything; name a phase with a drive or a force")
    if run.scene.planar is not None:
        return Unanswered("it is asked of all six freedoms, of which this scene's plane holds three")
    curve = None if ended.drive is None else ended.drive.curve
    if curve is not None:
        poses = [Pose.from_unit(*place) for place in zip(curve.position_m, curve.quaternion_wxyz, strict=True)]
        least, stopped = jam_friction_along(run, number), np.zeros(len(poses), bool)
    else:
        poses, least, stopped = push_jam_friction(run, number)
    is_open = np.isnan(least)
    if is_open.all():
        return Unanswered("at no place of the way could it be asked: too much touches, or the forces cancel each other")
    counts = np.where(is_open | stopped, np.inf, least)
    place = int(counts.argmin())
    is_found = bool(np.isfinite(counts[place]))
    return Jam(
        load.name,
        ended.verdict,
        curve is not None,
        greatest_friction(run.scene, chosen_method(run.scene, run.method).friction(run.scene)),
        bool(run.scene.friction_of),
        float(counts[place]),
        poses[place] if is_found else None,
        float(curve.share[place]) if is_found and curve is not None else None,
        len(poses),
        int(stopped.sum()),
        int(is_open.sum()),
    )

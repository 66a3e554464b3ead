"""The hand in the live viewer: somebody pulls at the object, and its run goes on from where it is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from cagepose.errors import SceneError
from cagepose.files.units import LengthUnit, from_metres, to_metres
from cagepose.files.words import LengthWords
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.wording import short
from cagepose.runs.further import GOES_ON, METHOD, Place, further, way_of
from cagepose.runs.pull import measure, pulled_load
from cagepose.runs.run import Run
from cagepose.studies.comparison import same_pose
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.playback import Playback, playback_led_on
from cagepose.views.viewer.stage import Stage

HAND, LET_GO = "hand", "let go"
"""Names of the phase in which somebody pulls, and of that after it; with an apostrophe if the scene has one of it."""
MOST_PLACES = 64
"""A way on which somebody has led the object is told by so many places; of a longer one every other place is left out.
"""
WITHIN_S = 2.0
"""Who pulls waits no longer than this for a rest."""
MOST_TIMES = 1e6
"""A pull is at most so many times the greatest force that acts beside it."""
N_POSE = 7
"""Numbers of a pose: position in metres and quaternion."""


class Grip(NamedTuple):
    """What a page asks.

    Attributes
    ----------
    phase
        Number of the phase from whose end the object has been led on.
    way
        So far; empty: it is there.
    at_object_m
        Where the hand holds it, (3,), in the object's frame.
    force
        With which the hand pulls, (3,), in the unit of the phase; zero: it lets go.
    """

    phase: int
    way: list[Place]
    at_object_m: FloatArray
    force: FloatArray


def grips(run: Run) -> list[dict[str, Any]]:
    """Return for each phase of a run what a pull from its end on compares to, or why nobody can pull there."""
    return [_grip(run, phase) for phase in range(len(run.phases))]


def _grip(run: Run, phase: int) -> dict[str, Any]:
    ended = run.phases[phase]
    if run.method != METHOD:
        return {"refused": f"The {run.method} method takes a single force; to pull by hand, choose {METHOD}."}
    if ended.verdict not in GOES_ON:
        return {"refused": f"To pull by hand the part must be at rest; {ended.name} ended with “{ended.verdict}”."}
    found = measure(run, phase)
    if found is None:
        return {"refused": f"Nothing acts on the part in {ended.name}, so it would not come to rest when you let go."}
    return {"greatest": found.greatest, "unit": found.unit, "of": found.of}


def grip_of(question: object, run: Run, length_unit: LengthUnit) -> Grip:
    """Return what a page asks, checked.

    Raises
    ------
    ValueError
        Something is missing, or is no number where one should be; or nobody can pull there.
    """
    if not isinstance(question, dict):
        raise ValueError("the pull is no mapping")
    phase = question.get("phase")
    if not isinstance(phase, int) or not 0 <= phase < len(run.phases):
        raise ValueError("the pull is in a phase that was not run")
    can = _grip(run, phase)
    if "refused" in can:
        raise ValueError(can["refused"])
    names = list(run.scene.loads[phase].press)
    rows = _numbers(question.get("way") or np.zeros((0, N_POSE + len(names))), (-1, N_POSE + len(names)), "way")
    force = _numbers(question.get("force"), (3,), "force")
    if len(rows) > MOST_PLACES or np.linalg.norm(force) > MOST_TIMES * can["greatest"]:
        raise ValueError("the pull is too large, or its way too long")
    try:
        poses = [Pose(row[:3], row[3:N_POSE]) for row in rows]
    except SceneError as error:
        raise ValueError(f"the way of the pull {error}") from None
    gone = [dict(zip(names, row[N_POSE:].tolist(), strict=True)) for row in rows]
    way = [Place(*place) for place in zip(poses, gone, strict=True)]
    return Grip(phase, way, to_metres(_numbers(question.get("at"), (3,), "at"), length_unit), force)


def _numbers(given: object, shape: tuple[int, ...], name: str) -> FloatArray:
    try:
        found = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} of the pull is no list of numbers") from None
    if found.ndim != len(shape) or found.shape[-1] != shape[-1] or not np.isfinite(found).all():
        raise ValueError(f"{name} of the pull has another number of finite numbers")
    return found


def pulled(shown: Playback, stage: Stage, grip: Grip) -> dict[str, Any]:
    """Return the data of a page on which the run of a playback, with its stage, has gone on by a pull; beside it where
    the object has been led to, and what came of it in words.

    A rest is gone on from. Of what is none, only words and picture tell: the next pull begins where this one did.

    Raises
    ------
    SceneError
        Nothing acts any more.
    TimeoutError
        No end was found in good time.
    """
    run, names = shown.run, [load.name for load in shown.run.scene.loads]
    name = HAND if grip.force.any() else LET_GO
    while name in names:
        name += "'"
    load = pulled_load(run.scene, grip.phase, name, grip.force, grip.at_object_m)
    found = further(run, grip.phase, load, grip.way, WITHIN_S)
    film = playback_led_on(shown, found)
    way = _thinned(way_of(found)) if found.verdict in GOES_ON else grip.way
    says = _words(found, grip, shown.length_unit)
    after = Stage(film, stage)
    last_rest = (grip.way[-1].pose if grip.way else run.phases[grip.phase].pose).transform(after.center_object_m)
    led = {
        "phase": grip.phase,
        "way": [_row(place) for place in way],
        "says": says,
        "rests": found.verdict in GOES_ON,
        "from": after.place(last_rest).tolist(),
    }
    return {**page_data(film, after), "led": led}


def _row(place: Place) -> list[float]:
    """Return a place as `grip_of` takes it: to the last digit, so that it is the same again."""
    return [*place.pose.position_m.tolist(), *place.pose.quaternion_wxyz.tolist(), *place.gone.values()]


def _thinned(way: Sequence[Place]) -> list[Place]:
    """Return a way with at most `MOST_PLACES` places, the last of them kept."""
    step = max(1, math.ceil(len(way) / MOST_PLACES))
    return list(way[::-step][::-1])


def _words(found: Run, grip: Grip, length_unit: LengthUnit) -> str:
    last, is_pulled = found.phases[-1], bool(grip.force.any())
    if last.verdict == "escapes":
        return "escapes; let go, and it is back at its last rest" if is_pulled else "escapes under its own loads"
    if last.verdict not in GOES_ON:
        return f"no rest found ({last.verdict}); the next pull begins at its last rest"
    if is_pulled:
        return last.verdict
    scene, before, name = found.scene, found.phases[-2].events[-1], found.phases[-2].name
    if same_pose(scene, last.events[-1], before):
        return f"it is back where {name} has left it"
    center = scene.object.center_of_gravity_m
    way_m = float(np.linalg.norm(last.pose.transform(center) - before.pose_world_object.transform(center)))
    turned = 2.0 * math.acos(min(1.0, abs(float(last.pose.quaternion_wxyz @ before.pose_world_object.quaternion_wxyz))))
    words = LengthWords(length_unit, scene.size_m)
    length, angle = short(float(from_metres(way_m, length_unit)), 3, words.noise), short(math.degrees(turned), 3, 1e-6)
    return f"it stays, {length} {length_unit} and {angle} deg from where {name} has left it"

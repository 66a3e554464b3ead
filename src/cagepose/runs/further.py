"""A run with one more phase, which begins where a phase has ended, or where such phases have led since: `further`.

The phases of one scene do the same: kernels go on from a pose of their own, and nobody asks again whether the object is
inside the cage there. So a run can be led on for as long as one likes.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.driven import PressRun
from cagepose.runs.drives import PhaseWay, displaced_at, way_in
from cagepose.runs.methods import REGISTRY
from cagepose.runs.run import AT_REST, STOPPED, Event, PhaseRun, Run, Verdict, motion_between
from cagepose.runs.solve import run_with
from cagepose.runs.warnings_of_runs import proof_warnings

GOES_ON: frozenset[Verdict] = AT_REST | STOPPED
"""After these verdicts another phase can begin."""
METHOD = "quasistatic"
"""The paper's rules know one force alone."""
LED = "moved"
"""The rule of the event that tells all of the way on which the object was led."""


class Place(NamedTuple):
    """Where the object has been led to.

    Attributes
    ----------
    pose
        Of the object, in the world.
    gone
        How far each body that presses has gone since the phase ended from which all this began, metres, by name.
    """

    pose: Pose
    gone: Mapping[str, float]


def further(run: Run, phase: int, load: Load, way: Sequence[Place] = (), within_s: float = math.inf) -> Run:
    """Return the first phases of a run, up to one that ended at rest, and then one under another load.

    It begins at the last place of ``way``, at which a run that was led on from the same phase has ended; of an empty
    one, where the phase ended. The bodies of the cage stand where that phase has left them. All of the way, and what
    comes to it, is one event; the finding at its end is another. What presses in the load is what presses in the phase.

    Raises
    ------
    ValueError
        The phase is none after which another can begin, or the run is one by the paper's rules.
    TimeoutError
        After ``within_s`` seconds there was no end.
    """
    if not 0 <= phase < len(run.phases) or run.phases[phase].verdict not in GOES_ON or run.method != METHOD:
        raise ValueError("no phase can begin there")
    scene, ended = run.scene, run.phases[: phase + 1]
    begin = way[-1] if way else Place(ended[-1].pose, dict.fromkeys(load.press, 0.0))
    both = (*scene.loads[: phase + 1], load), (load,)
    whole, alone = (scene.but_for(loads=loads, method=METHOD, adjustable=()) for loads in both)
    displaced = displaced_at(whole, [*map(way_in, ended), PhaseWay(0.0, begin.gone)])
    found = _run_within(within_s, alone, (begin.pose, displaced))
    last = _whole_way(found.phases[0], ended[-1], way, begin, scene)
    warnings = tuple(proof_warnings([last], REGISTRY[METHOD].friction(scene)))
    return Run(whole, METHOD, (*ended, last), warnings, found.solve_s)


def way_of(run: Run) -> list[Place]:
    """Return the way that the last phase of a run by `further` tells, to be gone on from."""
    phase = run.phases[-1]
    path = next((event.path for event in phase.events if event.rule == LED), ())
    rows, names = list[list[float]]([] for _ in path), list[str]()
    if phase.press is not None:
        rows, names = phase.press.travels_m.tolist(), list(phase.press.bodies)
    return [Place(pose, dict(zip(names, row, strict=True))) for pose, row in zip(path, rows, strict=False)]


def _run_within(seconds: float, scene: Scene, begun: tuple[Pose, np.ndarray]) -> Run:
    method, stop = REGISTRY[METHOD], np.zeros(1, np.int64)
    clock = threading.Timer(min(seconds, threading.TIMEOUT_MAX), stop.fill, (1,))
    clock.start()
    try:
        return run_with(scene, method, method.rules(scene), begun, stop)
    except KeyboardInterrupt:
        if stop[0]:
            raise TimeoutError(f"no rest was found within {seconds:g} s") from None
        raise
    finally:
        clock.cancel()


def _whole_way(found: PhaseRun, before: PhaseRun, way: Sequence[Place], begin: Place, scene: Scene) -> PhaseRun:
    """Return what a phase has found as the end of a whole way since the phase before."""
    *others, last = found.events
    is_finding = last.motion is None or math.isinf(last.motion.distance_m)
    ended = others[-1] if is_finding and others else last
    places = [*way, *_new_places(found, begin)]
    if not places:
        return replace(found, start_pose=before.pose)
    pose, share = places[-1].pose, 1.0 if found.press else 0.0
    touched = {contact.point for contact in before.contacts}
    led = Event(
        LED,
        motion_between(before.pose, pose, scene.object.center_of_gravity_m, scene.size_m),
        tuple(name for name in ended.contacts if name not in touched),
        ended.contacts,
        pose,
        None,
        tuple(place.pose for place in places),
        share,
    )
    events = (led, replace(last, path=(), share=share)) if is_finding else (led,)
    press = None if found.press is None else _press(found.press, places, begin)
    return replace(found, start_pose=before.pose, events=events, press=press)


def _new_places(found: PhaseRun, begin: Place) -> Iterator[Place]:
    """Yield where the steps of a phase lead to, but for those at which nothing has moved."""
    names = [] if found.press is None else list(found.press.bodies)
    rows = iter([] if found.press is None else found.press.travels_m.tolist())
    before = begin
    for event in found.events:
        for pose in event.path:
            gone = {name: begin.gone[name] + way for name, way in zip(names, next(rows, ()), strict=True)}
            if event.motion is not None and math.isinf(event.motion.distance_m):
                continue
            if gone != before.gone or _differ(pose, before.pose):
                before = Place(pose, gone)
                yield before


def _differ(one: Pose, other: Pose) -> bool:
    return not np.array_equal(one.position_m, other.position_m) or not np.array_equal(
        one.quaternion_wxyz, other.quaternion_wxyz
    )


def _press(found: PressRun, places: Sequence[Place], begin: Place) -> PressRun:
    bodies = {name: replace(body, travel_m=body.travel_m + begin.gone[name]) for name, body in found.bodies.items()}
    travels = np.array([[place.gone[name] for name in bodies] for place in places])
    return PressRun(bodies, np.arange(1, len(places) + 1) / len(places), travels)

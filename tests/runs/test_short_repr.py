"""Whatever a user looks at in a console is one short line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import cagepose
from cagepose.studies.play_rest import play_rests

SCENES = Path(__file__).resolve().parents[2] / "scenes"
LONGEST = 160


def everything(thing: object, seen: set[int]) -> Iterator[object]:
    """Yield a result and all of ours that can be reached from it, but what is for kernels."""
    if id(thing) in seen:
        return
    seen.add(id(thing))
    if isinstance(thing, tuple | list):
        for item in thing:
            yield from everything(item, seen)
    elif isinstance(thing, dict):
        yield from everything(list(thing.values()), seen)
    elif type(thing).__module__.startswith("cagepose.") and "kernels" not in type(thing).__module__:
        yield thing
        for name in getattr(type(thing), "__annotations__", {}):
            if not name.startswith("_") and hasattr(thing, name):
                yield from everything(getattr(thing, name), seen)


@pytest.mark.parametrize("name", ["rail-pitch", "drawer", "ladder", "planks"])
def test_all_that_a_run_and_its_studies_hold_is_shown_in_a_line(name: str) -> None:
    scene = cagepose.load_scene(SCENES / f"{name}.yaml")
    run = cagepose.run(scene)
    runs = cagepose.run_many(scene, cagepose.Variation(friction_coefficient=np.linspace(0.0, 1.0, 5)))
    things: list[object] = [scene, run, runs, cagepose.margin(run), list(run.frames()), cagepose.Variation()]
    if not scene.has_other_shapes:
        proof = cagepose.certificate(run)
        play = cagepose.play(scene, [(0.0, 0.0, 0.0)])
        things += [proof, cagepose.compare(scene), play, play_rests(scene)]
        things += [end.clearances for range_ in play.freedoms.values() for end in (range_.low, range_.high)]
    found = list(everything(things, set()))
    assert len(found) > 20
    for thing in found:
        text = repr(thing)
        assert len(text) <= LONGEST, (type(thing), text)
        assert "\n" not in text
        assert "array(" not in text


SHOWN = {
    "<Box 'lid': 0.1 x 0.2 x 0.03 m>": cagepose.Box((0.1, 0.2, 0.03), name="lid"),
    "<Sphere: radius 0.003 m>": cagepose.Sphere(0.003),
    "<Capsule 'pin': radius 0.003 m, length 0.02 m>": cagepose.Capsule(0.003, 0.02, name="pin"),
    "<Cone: radius bottom 0.003 m, radius top 0 m, length 0.02 m>": cagepose.Cone(0.003, 0.0, 0.02),
    "<Convex: 2 vertices, radius 0.001 m>": cagepose.Convex([(0, 0, 0), (0, 0, 1)], 0.001),
    "<Hole: radius 0.003 m, depth 0.01 m>": cagepose.Hole(0.003, 0.01),
    "<Pose (0, 0, 0.01) m>": cagepose.Pose((0, 0, 0.01)),
    "<Pose (0, 0, 0) m, yaw pitch roll (0, 30, 0) deg>": cagepose.Pose(euler_zyx=(0, np.pi / 6, 0)),
    "<Force 25 N along (1, 0, 0) at (0.21, 0, 0) m>": cagepose.Force((2, 0, 0), (0.21, 0, 0), 25),
    "<Force along (0.7071, 0.7071, 0) at (0, 0, 0) m, follows>": cagepose.Force((1, 1, 0), (0, 0, 0), follows=True),
    "<Moment 0.05 N m about (0, 0, 1)>": cagepose.Moment((0, 0, 1), 0.05),
    "<Spring (0, 0, 0) m to (0, 0, 0.05) m: 500 N/m, preload 2 N>": cagepose.Spring((0, 0, 0), (0, 0, 0.05), 500, 2),
    "<Load 'both': gravity (0, 0, -9.81), 1 moment>": cagepose.Load(
        "both", gravity=(0, 0, -9.81), moments=[cagepose.Moment((0, 0, 1), 1)]
    ),
    "<Object: 2 boxes, 0.5 kg>": cagepose.Object([cagepose.Box((1, 1, 1))] * 2, mass_kg=0.5),
    "<Cage: 1 point, 1 shape>": cagepose.Cage([(0, 0, 0)], shapes=[cagepose.Sphere(1.0)]),
    "<Scene 'scene': 1 shape in a cage of 1 hole, load weight>": cagepose.Scene(
        cagepose.Object(shapes=[cagepose.Sphere(0.1)], pose=cagepose.Pose((0, 0, 1))),
        cagepose.Cage(holes=[cagepose.Hole(0.2, 0.3)]),
        [cagepose.Load("weight", gravity=(0, 0, -1))],
    ),
    "<Variation of friction_coefficient (3,)>": cagepose.Variation(friction_coefficient=[0, 1, 2]),
}


@pytest.mark.parametrize(("text", "thing"), SHOWN.items(), ids=[type(thing).__name__ for thing in SHOWN.values()])
def test_what_is_shown_are_the_numbers_that_were_given(text: str, thing: object) -> None:
    assert repr(thing) == text


def test_results_say_how_it_ended() -> None:
    scene = cagepose.load_scene(SCENES / "rail-pitch.yaml")
    run = cagepose.run(scene)
    first = run.phases[0]
    assert repr(scene) == "<Scene 'rail, pitch 0.1 deg': 6 boxes in a cage of 14 points, loads weight, push>"
    assert repr(first.events[1]) == "<Event 'slide': turn, hits C2, C4; 4 touching>"
    assert repr(first.events[1].motion) == "<Motion: turn 0.00546434 rad about (0, 1, 0)>"
    assert repr(run.phases[1]) == "<PhaseRun 'push': rests; 6 events, 7 contacts>"
    assert repr(run.contacts[-1]) == "<Contact of 'C13' with 'rack': normal force 1>"

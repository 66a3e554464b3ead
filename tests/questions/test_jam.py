"""From which friction on a guided part jams, driven or pushed."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from cagepose import (
    Box,
    Cage,
    Cylinder,
    Force,
    Hole,
    Jam,
    Load,
    Object,
    Pose,
    Run,
    Scene,
    Unanswered,
    jam,
    load_scene,
    run,
)
from cagepose.cli.app import main
from cagepose.files.answers.jam import lines
from cagepose.files.words import LengthWords
from questions.cones_of_sides import OUTER, is_balanced

SCENES = Path(__file__).resolve().parents[2] / "scenes"
TWO_TO_ONE = ["cage.shapes[1].position[0]=-5", "cage.shapes[2].position[0]=5", "friction.coefficient=0.2"]
WIDTH = 0.02


def asked(a_run: Run, phase: str | None = None) -> Jam:
    found = jam(a_run, phase)
    assert isinstance(found, Jam)
    return found


def guided(length: float, offset: float, friction: float, **of_points: float) -> Scene:
    """A bar between two points, on both sides and ``length`` apart, that is pushed along x beside its middle."""
    bar = Object([Box((4 * length, WIDTH, WIDTH))])
    points = {"rear": (-0.5 * length, 0.5 * WIDTH, 0.0), "front": (0.5 * length, -0.5 * WIDTH, 0.0)}
    push = Load("push", force=Force((1, 0, 0), (0, offset, 0)))
    cage = Cage(list(points.values()), list(points))
    return Scene(bar, cage, [push], friction_coefficient=friction, friction_of=of_points)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("part", [0.8, 1.2])
def test_a_guide_that_is_pushed_jams_from_its_length_over_twice_the_offset_on(ratio: float, part: float) -> None:
    """Be it that it slides as it is, or that it jams."""
    length = 0.06
    expected = 0.5 / ratio
    a_run = run(guided(length, ratio * length, part * expected))
    found = asked(a_run)
    assert found.friction == pytest.approx(expected, rel=1e-5)
    assert found.verdict == ("escapes" if part < 1.0 else "rests")
    assert not found.is_driven
    assert (found.n_stopped, found.n_open) == (0, 0)


def test_two_ends_that_rub_differently_jam_as_their_moments_say() -> None:
    """N at both ends; F = (a + b) mu N, and e F = L N + (a - b) mu N D / 2. The greatest coefficient is mu times 1."""
    length, offset, rear, front = 0.06, 0.09, 0.4, 1.0
    expected = length / (offset * (rear + front) - (rear - front) * 0.5 * WIDTH)
    found = asked(run(guided(length, offset, 0.0, rear=0.1 * rear, front=0.1 * front)))
    assert (found.has_several, found.present) == (True, 0.1)
    assert found.friction == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("play", [2e-5, 2e-6])
def test_a_round_pin_in_its_hole_comes_to_that_as_the_play_vanishes(play: float) -> None:
    """Leaning by play over length, its arms are longer by about D / 2 times that. A stop ends its way while it is all
    through the hole: it is guided over less and less as its end goes in, and jams there.
    """
    radius, length, offset = 0.005, 0.02, 0.04
    pin = Object(shapes=[Cylinder(radius, 6 * length)], pose=Pose((0, 0, 0)))
    plate = [Box((0.06, 0.06, length), Pose((0, 0, 0)), "plate")]
    stop = Box((0.06, 0.06, 0.01), Pose((0, 0, -4 * length - 0.005)), "stop")
    hole = Hole(radius + 0.5 * play, length, None, ["plate"], Pose((0, 0, 0.5 * length)), "hole")
    push = Load("push", force=Force((0, 0, -1), (offset, 0, 0)))
    found = asked(run(Scene(pin, Cage(shapes=[*plate, stop], holes=[hole]), [push], friction_coefficient=0.2)))
    assert found.friction == pytest.approx(length / (2 * offset), rel=5 * play / length)
    through = run(Scene(pin, Cage(shapes=plate, holes=[hole]), [push], friction_coefficient=0.2))
    left = 3 * length + through.pose.position_m[2] + 0.5 * length
    assert left == pytest.approx(0.2 * 2 * offset, abs=10.0 * play)


def test_a_guide_that_is_driven_jams_alike_while_it_still_slides() -> None:
    """Pins 60 mm apart, pushed 20 mm beside: 1.5, and it jams with 1.6; 10 mm apart it is the 2:1 rule: 0.25."""
    jams = asked(run(load_scene(SCENES / "drawer-jams.yaml")))
    assert (jams.verdict, jams.is_driven) == ("jams", True)
    assert jams.friction == pytest.approx(1.5, rel=1e-5)
    slides = asked(run(load_scene(SCENES / "drawer-jams.yaml", TWO_TO_ONE)))
    assert (slides.verdict, slides.present) == ("rests", 0.2)
    assert slides.friction == pytest.approx(0.25, rel=1e-5)


def test_what_a_drawer_is_pulled_with_is_between_cones_with_64_sides() -> None:
    """Where it stands its pull alone, however great, is balanced from there on, and not below."""
    a_run = run(load_scene(SCENES / "drawer.yaml"))
    found = asked(a_run)
    assert found.n_asked == 1
    assert is_balanced(a_run, found.friction * OUTER * (1.0 + 1e-4), 1.0)
    assert not is_balanced(a_run, found.friction * (1.0 - 1e-4), 1.0)
    assert not is_balanced(a_run, found.friction / OUTER * (1.0 - 1e-4), OUTER)


def test_a_stop_that_holds_a_part_without_friction_is_no_jam() -> None:
    """A block slides on its feet up to a wall."""
    feet = [(x, y, -0.01) for x in (-0.01, 0.01) for y in (-0.01, 0.01)]
    wall = [(0.02, y, z) for y in (-0.005, 0.005) for z in (-0.005, 0.005)]
    push = Load("push", gravity=(0, 0, -9.81), force=Force((1, 0, 0), (0, 0, 0), 5.0))
    block = Object([Box((0.03, 0.03, 0.02))], mass_kg=0.1)
    found = asked(run(Scene(block, Cage(feet + wall), [push], friction_coefficient=0.1)))
    assert found.friction == math.inf
    assert found.pose_world_object is None
    assert (found.n_stopped, found.n_asked) == (1, 2)


def slider(length: float, offset: float, play: float, friction: float) -> Scene:
    """A block between two rails with some play, pushed beside them at an arm that leans it onto the floor."""
    half, high = 0.005, 0.005
    rails = [
        Box((0.4, 0.002, 0.01), Pose((0.0, side * (half + 0.5 * play + 0.001), 0.0)), name)
        for side, name in ((1.0, "left"), (-1.0, "right"))
    ]
    floor = Box((0.4, 0.008, 0.01), Pose((0.0, 0.0, -0.01)), "floor")
    block = [
        Box((length, 2.0 * half, 2.0 * high)),
        Box((0.002, 0.002, 0.016), Pose((0.0, 0.0, 0.012))),
        Box((0.002, offset, 0.002), Pose((0.0, 0.5 * offset, 0.02))),
        Box((0.002, 0.002, 0.022), Pose((0.0, offset, 0.01))),
    ]
    push = Load("push", force=Force((1, 0, 0), (0.0, offset, 0.0)))
    cage = Cage(shapes=[*rails, floor])
    return Scene(Object(block), cage, [push], friction_coefficient=friction, friction_of={"floor": 0.0})


@pytest.mark.parametrize(("length", "offset"), [(0.016, 0.012), (0.02, 0.08), (0.025, 0.1)])
def test_a_block_that_also_leans_on_a_floor_without_friction_jams_from_there_on(length: float, offset: float) -> None:
    """Where the motions that give way are long, each to a contact of its own, none was found within rounding."""
    half = 0.5 * length / offset
    found = asked(run(slider(length, offset, 2e-5, 1.3 * half)))
    assert found.friction == pytest.approx(half, rel=3e-3)


def test_a_block_without_play_jams_with_any_friction() -> None:
    """Its rails can press on it as hard as need be; without friction it would slide, so they are no stop."""
    a_run = run(slider(0.02, 0.02, 0.0, 0.25))
    found = asked(a_run)
    assert a_run.phases[0].verdict == "may rest"
    assert (found.friction, found.n_stopped) == (0.0, 0)
    told = dict(lines(found, LengthWords("mm", a_run.scene.size_m)))
    assert told["jam"] == "with any friction it can jam, however hard it is pushed"
    assert told["here"] == "with 0.25 it can jam"


def test_what_nothing_pushes_does_not_jam() -> None:
    found = jam(run(load_scene(SCENES / "ladder.yaml")))
    assert isinstance(found, Unanswered)
    assert found.unanswered == "weight neither drives nor pushes anything; name a phase with a drive or a force"


def test_the_document_has_the_same_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    changes = [f"--set={change}" for change in TWO_TO_ONE]
    assert main(["ask", "jam", str(SCENES / "drawer-jams.yaml"), *changes, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["friction"] == pytest.approx(0.25, rel=1e-5)
    assert (document["phase"], document["is_driven"], document["share"]) == ("push", True, 0.0)

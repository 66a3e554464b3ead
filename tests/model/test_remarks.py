"""What is remarked of a scene that can be run, and what is not."""

from __future__ import annotations

from pathlib import Path

import pytest

import cagepose
from boundary.prisms import cradle
from cagepose import Box, Cage, Cylinder, Force, Hole, Load, Object, Pose, Scene
from cagepose.model.remarks import remarks

SCENES = sorted((Path(__file__).resolve().parents[2] / "scenes").glob("*.yaml"))
DOWN = Load("weight", gravity=(0, 0, -1))
POINTS = [(0.004, 0.004, 0), (-0.004, 0.004, 0), (0, -0.004, 0)]


def scene(*boxes: Box, scale: float = 1.0, **options: object) -> Scene:
    parts = boxes or (Box((0.01 * scale,) * 3, name="cube"),)
    center = options.pop("center", None)
    held = Object(parts, center, mass_kg=options.pop("mass", None), pose=Pose((0, 0, 0.007 * scale)))
    points = [[scale * value for value in point] for point in POINTS]
    return Scene(held, Cage(points), options.pop("loads", [DOWN]), **options)


def box(x: float, name: str) -> Box:
    return Box((0.01, 0.01, 0.01), Pose((x, 0, 0)), name)


@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_of_our_scenes_there_is_nothing_to_remark(path: Path) -> None:
    assert list(remarks(cagepose.load_scene(path))) == []


REMARKED = {
    "parts of the source that are left out": (
        scene(left_out=["terrain", "finger"]),
        "the source of this scene also has terrain, finger, which is left out here: where it would touch the object,"
        " the result is wrong",
    ),
    "friction above what there is": (
        scene(friction_coefficient=3.0),
        "friction: a coefficient of 3 is more than dry surfaces have (rubber about 1); an angle is given as angle_deg",
    ),
    "friction of one point": (
        scene(friction_of={"C1": 20}),
        "friction of C1: a coefficient of 20 is more than dry surfaces have (rubber about 1); an angle is given as"
        " angle_deg",
    ),
    "boxes apart": (
        scene(box(0, "base"), box(0.01, "next"), box(0.04, "far"), box(0.05, "farther")),
        "far, farther lie apart from base, and move with it as one body; check positions and sizes",
    ),
    "a centre of gravity far outside": (
        scene(center=(1, 0, 0)),
        "the centre of gravity lies 995 mm outside the object; check center_of_gravity, which is given in the object's"
        " frame",
    ),
    "gravity in millimetres": (
        scene(mass=0.1, loads=[Load(name, gravity=(0, 0, -9810)) for name in ("fall", "settle")]),
        "fall, settle: a gravity of 9810 m/s² is 1000 times the Earth's; it is given in m/s², whatever the unit of"
        " length (9.81 on Earth)",
    ),
    "a pin as wide as its hole": (
        Scene(
            Object(shapes=[Cylinder(0.005, 0.02, name="pin")], pose=Pose((0, 0, 0.011))),
            Cage(
                shapes=[Box((0.06, 0.06, 0.01), Pose((0, 0, -0.005)), "plate")],
                holes=[Hole(0.005, 0.01, None, "plate")],
            ),
            [DOWN],
        ),
        "pin and the hole hole1 have the same radius, so that rounding decides whether one goes into the other; give"
        " them the clearance of the real parts",
    ),
    "millimetres in the place of metres": (
        scene(scale=1000.0),
        "the scene is 17320.5 mm across; check the unit (units.length of a file, which is mm if left out; metres in"
        " Python)",
    ),
    "metres in the place of millimetres": (
        scene(scale=0.001),
        "the scene is 0.0173205 mm across; check the unit (units.length of a file, which is mm if left out; metres in"
        " Python)",
    ),
}


@pytest.mark.parametrize(("given", "told"), REMARKED.values(), ids=REMARKED)
def test_a_likely_slip_is_remarked_and_run_all_the_same(given: Scene, told: str) -> None:
    assert list(remarks(given)) == [told]
    assert told in cagepose.run(given).warnings
    if not (given.friction_of or given.cage.shapes):  # which the stepwise method does not run
        assert told in cagepose.run(given, "stepwise").warnings


def test_what_is_unusual_and_right_is_not_remarked() -> None:
    for given in (
        scene(friction_coefficient=2.0),
        scene(box(0, "base"), box(0.011, "a hair apart")),
        scene(center=(0, 0, 0.02)),
        scene(loads=[Load("down", gravity=(0, 0, -9810))]),  # without a mass its direction alone counts
        scene(mass=0.1, loads=[Load("shock", gravity=(0, 0, -250))]),
        scene(box(0, "one"), box(0.02, "two"), box(0.01, "between")),
        Scene(Object([Box((1, 1, 1), Pose((0, 0, 0.5)))]), Cage(shapes=[Box((30, 30, 1), Pose((0, 0, -0.5)))]), [DOWN]),
    ):
        assert list(remarks(given)) == []


def test_a_weight_that_a_later_phase_drops_is_told() -> None:
    push = Load("push", force=Force((0, 0, -1), (0, 0, 0)))
    (told,) = [warning for warning in cagepose.run(scene(loads=[DOWN, push])).warnings if "weight" in warning]
    assert told == "push: the weight of the phase before no longer acts (give gravity in this phase to keep it)"


def test_round_surfaces_that_joined_facets_lose_are_named() -> None:
    groove = cradle()
    beside = Box((0.01, 0.04, 0.01), Pose((0.024, 0.0, -0.005)), "foot")
    held = Object(shapes=[Box((0.002, 0.002, 0.002), name="cube")], pose=Pose((0.0, 0.0, 0.02)))
    for shapes, n_said in (([groove], 0), ([groove, beside], 1), ([groove, beside.moved(Pose((0.06, 0, 0)))], 0)):
        scene = Scene(held, Cage(shapes=shapes), [Load("weight", gravity=(0.0, 0.0, -9.81))])
        said = [remark for remark in remarks(scene) if remark.startswith("cradle: joined with other parts")]
        assert len(said) == n_said

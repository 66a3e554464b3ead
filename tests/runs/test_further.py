"""A run that is led on is what a scene with one more phase gives, and no pull gets the part through a wall."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bench.pulls_table import depth_of_size
from cagepose import Force, Load, Run, Scene, load_scene, run
from cagepose.runs.further import GOES_ON, Place, further, way_of
from cagepose.runs.pull import measure, pulled_load

SCENES = Path(__file__).resolve().parents[2] / "scenes"


def without_last_phase(scene: Scene) -> Scene:
    return Scene(
        scene.object, scene.cage, scene.loads[:-1], friction_coefficient=scene.friction_coefficient,
        friction_of=scene.friction_of,
    )  # fmt: skip


def pulled(found: Run, way: list[Place], force: np.ndarray, at: np.ndarray, within_s: float = 5.0) -> Run:
    last = len(found.phases) - 1
    return further(found, last, pulled_load(found.scene, last, "hand", force, at), way, within_s)


@pytest.mark.parametrize("name", ["drawer", "grip", "plate-on-pins", "rail-pitch"])
def test_a_phase_that_is_run_further_is_that_of_the_scene_which_has_it(name: str) -> None:
    """Of what was driven and presses, too."""
    scene = load_scene(SCENES / f"{name}.yaml")
    whole, first = run(scene), run(without_last_phase(scene))
    found = further(first, len(first.phases) - 1, scene.loads[-1])
    assert [phase.verdict for phase in found.phases] == [phase.verdict for phase in whole.phases]
    assert found.pose.position_m == pytest.approx(whole.pose.position_m, abs=1e-10 * scene.size_m)
    assert found.pose.quaternion_wxyz == pytest.approx(whole.pose.quaternion_wxyz, abs=1e-10)
    forces, wanted = ({(c.point, c.box): c.force_normal_n for c in of.contacts} for of in (found, whole))
    assert forces == pytest.approx(wanted, rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("name", ["dock", "grip", "insertion", "latch", "peg-in-hole", "v-groove"])
def test_what_rests_stays_when_nothing_new_acts(name: str) -> None:
    """Springs that ride on what was driven pull as they did; a weight without a mass weighs as much as it did."""
    found = run(load_scene(SCENES / f"{name}.yaml"))
    again = pulled(found, [], np.zeros(3), np.zeros(3))
    assert again.pose.position_m == pytest.approx(found.pose.position_m, abs=1e-9 * found.scene.size_m)
    assert again.pose.quaternion_wxyz == pytest.approx(found.pose.quaternion_wxyz, abs=1e-9)


@pytest.mark.parametrize("name", ["dock", "phone-dock", "rail-pitch", "rollers"])
def test_no_pull_gets_the_part_into_its_cage_and_each_goes_on_from_the_one_before(name: str) -> None:
    """Signed distances that share no code with the kernels; where points hold, the scene made anew asks the kernels."""
    found = run(load_scene(SCENES / f"{name}.yaml"))
    held, last = found.scene.object, len(found.phases) - 1
    compared = measure(found, last)
    assert compared is not None
    draw, way, rests = np.random.default_rng(7), list[Place](), 0
    for _ in range(12):
        force = compared.greatest * draw.uniform(0.1, 3.0) * unit(draw.normal(size=3))
        led = pulled(found, way, force, held.center_of_gravity_m + 0.3 * held.reach_m * draw.uniform(-1.0, 1.0, 3))
        if led.verdict in GOES_ON:
            rests += 1
            assert [place.pose for place in way_of(led)[: len(way)]] == [place.pose for place in way]
            way = way_of(led)
            row = [*led.pose.position_m, *led.pose.quaternion_wxyz]
            assert depth_of_size(found, last, row) <= 2.0 * found.scene.tolerances.touch
    assert rests >= 4


def test_a_pull_goes_beside_a_force_that_stays_where_it_is_in_the_world() -> None:
    scene = load_scene(SCENES / "drawer.yaml")
    belt = Load(
        "belt", gravity=(0.0, 0.0, -9.81), force=Force((0.0, 0.0, -1.0), at_world_m=(0.0, 0.0, 0.0), magnitude_n=1.0)
    )
    with_belt = Scene(scene.object, scene.cage, [belt], friction_coefficient=scene.friction_coefficient)
    found = run(with_belt)
    again = pulled(found, [], np.array((0.0, 0.0, -0.1)), np.zeros(3))
    assert again.phases[-1].verdict == found.phases[-1].verdict
    total = -sum(contact.force_normal_n or 0.0 for contact in again.contacts)
    assert total < -sum(contact.force_normal_n or 0.0 for contact in found.contacts)


def test_a_pull_beside_a_weight_without_mass_is_told_in_parts_of_it() -> None:
    """A rail of weight 1 is lifted off its lower rollers by a pull of more than that, and not by one of less."""
    found = run(without_last_phase(load_scene(SCENES / "rail-pitch.yaml")))
    compared, center = measure(found, 0), found.scene.object.center_of_gravity_m
    assert compared == (pytest.approx(1.0), "load", ("weight", pytest.approx(1.0)))
    ends = [pulled(found, [], np.array([0.0, 0.0, share]), center).pose for share in (0.99, 1.01)]
    less, more = (end.transform(center)[2] - found.pose.transform(center)[2] for end in ends)
    assert less == pytest.approx(0.0, abs=1e-9)
    assert more > 5e-4


def test_a_run_without_a_rest_to_go_on_from_is_refused_and_one_without_an_end_is_given_up() -> None:
    fallen = run(without_last_phase(load_scene(SCENES / "drawer.yaml")), "quasistatic")
    with pytest.raises(ValueError, match="no phase can begin there"):
        further(fallen, 1, Load("more", gravity=(0, 0, -1)))
    gripped = run(load_scene(SCENES / "grip.yaml"))
    with pytest.raises(TimeoutError, match="no rest was found within"):
        pulled(gripped, [], np.array([13.0, 0.0, 0.0]), np.zeros(3), within_s=0.01)


def unit(vector: np.ndarray) -> np.ndarray:
    return np.asarray(vector / np.linalg.norm(vector))

"""Random scenes with springs against independent oracles: SLSQP on the potential, sums of forces, Hessians."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from audit.balance import imbalance
from audit.geometry import deepest, farthest_move
from cagepose import Box, Cage, Contact, Load, Object, Pose, Scene, Spring, run
from cagepose.files.scene_file import parse_scene
from quasistatic.paths import RESTS, path_of, potential
from quasistatic.test_end_poses import came_back, is_isolated
from sprung_scenes import cube, sprung

UNBALANCED = 1e-7
"""Fraction of the load. A balance with friction leaves up to 1e-9 of its terms, and a spring's are more than its
tension."""


def test_the_potential_never_rises_and_nothing_goes_in(say, cases):
    random = np.random.default_rng(8)
    verdicts, greatest, inside = Counter(), -1.0, 0.0
    for number in range(cases(100, 1000)):
        scene = sprung(random, friction=(0.0, 0.2)[number % 2])
        result = run(scene)
        verdicts[result.verdict] += 1
        values = [potential(scene, scene.loads[0], pose) for pose in path_of(result.phases[0])]
        greatest = max(greatest, float(np.diff(values).max(initial=-1.0)))
        inside = max(inside, *(deepest(scene, pose) for pose in path_of(result.phases[0])))
        if result.verdict in RESTS:
            assert imbalance(scene, result.phases[0]) <= UNBALANCED, f"scene {number}"
            assert all(is_in_cone(contact, scene.friction_coefficient or 0.0) for contact in result.contacts)
    say(f"springs: {dict(verdicts)}; the potential rose by {greatest:.1e} of load times size, points {inside:.1e} deep")
    assert greatest <= 1e-12
    assert inside <= 2e-9
    assert verdicts["escapes"] == 0
    assert verdicts["limit"] + verdicts["stalled"] == 0


def is_in_cone(contact: Contact, friction: float) -> bool:
    normal, tangential = contact.force_normal_n, contact.force_tangential_n
    assert normal is not None
    assert tangential is not None
    return normal >= 0.0 and float(np.linalg.norm(tangential)) <= friction * normal + 1e-9


def test_slsqp_finds_no_lower_pose_beside_a_rest_on_springs(say, cases):
    random = np.random.default_rng(9)
    n_compared, n_gave_up, worst = 0, 0, 0.0
    for number in range(cases(30, 200)):
        scene = sprung(random)
        result = run(scene)
        assert is_isolated(result), f"scene {number}"
        back = came_back(scene, scene.loads[0], result.pose, random)
        if back is None:
            n_gave_up += 1
            continue
        n_compared += 1
        worst = max(worst, farthest_move(scene, back[0], result.pose))
    say(f"SLSQP on springs: {n_compared} rests, {n_gave_up} given up; poses within {worst:.1e} of the size")
    assert worst <= 1e-6
    assert n_gave_up <= 0.2 * n_compared


def test_what_turns_and_follows_is_in_balance_where_it_rests(say, cases):
    random = np.random.default_rng(10)
    verdicts, stabilities = Counter(), Counter()
    for number in range(cases(60, 600)):
        scene = sprung(random, friction=(0.0, 0.3)[number % 2], turned=True)
        result = run(scene)
        verdicts[result.verdict] += 1
        if result.verdict in RESTS:
            stabilities[result.phases[0].proof.stability] += 1
            assert imbalance(scene, result.phases[0]) <= UNBALANCED, f"scene {number}"
    say(f"moments and following forces: {dict(verdicts)}, {dict(stabilities)}")
    assert verdicts["rests"] + verdicts["may rest"] >= 0.9 * sum(verdicts.values())


def test_a_part_held_by_springs_alone_rests_where_their_hessian_is_positive(say, cases):
    """The Hessian by differences of the potential, in coordinates about the rest."""
    random, n_stable = np.random.default_rng(11), 0
    for number in range(cases(30, 300)):
        n_springs = int(random.integers(4, 7))
        springs = [
            Spring(
                random.uniform(-0.02, 0.02, 3), random.normal(size=3), 10 ** random.uniform(1, 2), random.uniform(0, 20)
            )
            for _ in range(n_springs)
        ]
        scene = Scene(cube(), Cage([(2.0, 2.0, 2.0)]), [Load("hang", gravity=(0, 0, -9.81), springs=springs)])
        result = run(scene)
        assert (result.verdict, result.contacts) == ("rests", ()), f"scene {number}"
        assert imbalance(scene, result.phases[0]) <= 1e-8
        least = float(np.linalg.eigvalsh(hessian(scene, result.pose)).min())
        assert (least > 0.0) == (result.phases[0].proof.stability == "stable") or abs(least) < 1e-6, f"scene {number}"
        n_stable += least > 0.0
    say(f"held by springs alone: {n_stable} of {number + 1} stable")


def hessian(scene: Scene, pose: Pose, step: float = 1e-4) -> np.ndarray:
    """Second differences of the potential with travel and turning vector, in sizes and radians, (6, 6)."""

    def value(z: np.ndarray) -> float:
        angle = float(np.linalg.norm(z[3:]))
        axis = z[3:] / angle if angle else np.zeros(3)
        turn = Pose(quaternion_wxyz=(np.cos(angle / 2.0), *(np.sin(angle / 2.0) * axis)))
        turned = Pose(
            pose.position_m + scene.size_m * z[:3], (turn @ Pose(quaternion_wxyz=pose.quaternion_wxyz)).quaternion_wxyz
        )
        return potential(scene, scene.loads[0], turned)

    found = np.zeros((6, 6))
    for j, one in enumerate(step * np.eye(6)):
        for k, other in enumerate(step * np.eye(6)):
            found[j, k] = (value(one + other) - value(one - other) - value(other - one) + value(-one - other)) / (
                4.0 * step**2
            )
    return found


@pytest.mark.parametrize("chamfer_mm", [0.0, 1.0, 3.0])
def test_a_hole_in_the_cage_leaves_the_far_ends_of_springs_where_they_are(chamfer_mm):
    """Hand answer: 1 kg hangs in balance at the start (preload 9.81 N), so it stays, whatever the floor's hole is like.

    A chamfered hole has three circles, and the mean of their middles was taken for the hole's own middle.
    """
    chamfer = f", chamfer: {{width: {chamfer_mm}, angle_deg: 45}}" if chamfer_mm else ""
    scene = parse_scene(f"""
name: a block on a spring above a hole
object: {{mass: 1, shapes: [{{name: block, box: {{size: [20, 20, 20]}}}}], pose: {{position: [0, 0, 40]}}}}
cage:
  shapes:
    - {{name: floor, box: {{size: [100, 100, 20]}}, position: [0, 0, -10]}}
    - {{name: hole, hole: {{radius: 5, depth: 20, in: [floor]{chamfer}}}}}
loads:
  - {{name: hang, gravity: [0, 0, -9.81], springs: [{{at: [0, 0, 10], to: [0, 0, 100], stiffness: 1, preload: 9.81}}]}}
""")
    result = run(scene)
    assert result.verdict == "rests"
    assert result.pose.position_m == pytest.approx([0.0, 0.0, 0.04], abs=1e-12)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_where_the_ends_of_a_spring_have_met_nothing_is_said_to_rest(friction):
    """A cube falls by 2 mm on a tray, where the ends of its spring meet that still pushes by 4 N then: in no direction.
    Held 2 um higher, which is no rounding any more, it pushes the cube down.
    """
    cube_2_mm_up = [Box((0.01, 0.01, 0.01), name="cube")]
    held = Object(cube_2_mm_up, pose=Pose((0.0, 0.0, 0.002)), mass_kg=0.02)
    tray = Box((0.05, 0.05, 0.01), Pose((0.0, 0.0, -0.01)), name="tray")
    weight = Load("weight", gravity=(0.0, 0.0, -9.81))
    verdicts = []
    for higher_m in (0.0, 2e-6):
        tension_at_start = -4.0 + 100.0 * (0.002 - higher_m)
        spring = Spring((0.0, 0.0, 0.002), (0.0, 0.0, 0.002 + higher_m), 100.0, tension_at_start)
        pull = Load("spring", gravity=(0.0, 0.0, -9.81), springs=[spring])
        result = run(Scene(held, Cage(shapes=[tray]), [weight, pull], friction_coefficient=friction))
        verdicts.append(result.phases[-1].verdict)
        assert result.phases[0].verdict == "rests"
        assert any("have met, where its pull has no direction" in warning for warning in result.warnings) == (
            higher_m == 0.0
        )
        assert result.failed == (higher_m == 0.0)
    assert verdicts == ["stalled", "rests"]

"""Certificates of rest: those that are made are right, those that were changed are refused, and none need trust us."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from audit.caged_families import caged_seams, pushed_block
from cagepose import (
    Box,
    Cage,
    Certificate,
    CertificateError,
    Cylinder,
    Force,
    Hole,
    Load,
    ModeTree,
    Object,
    Pose,
    Run,
    RunFileError,
    Scene,
    certificate,
    check_certificate,
    load_certificates,
    load_run,
    load_scene,
    run,
    save_run,
)
from cagepose.files.record import record_of
from cagepose.model.shapes import AnyShape
from cagepose.studies.certificate_check import CertificateCheck
from cagepose.studies.contact_problem import contact_problem
from our_scenes import CASES
from shapes.shape_scenes import random_problem, scene_of

ROOT = Path(__file__).parents[2]
WEDGE = ROOT / "scenes" / "wedge.yaml"


def certified(a_run: Run, phase: int = -1) -> tuple[Certificate, CertificateCheck]:
    found = certificate(a_run, phase)
    assert found is not None
    return found, check_certificate(found, a_run, phase)


@pytest.mark.parametrize(("path", "method"), CASES, ids=[f"{path.stem}-{method}" for path, method in CASES])
def test_each_rest_of_our_scenes_has_a_certificate_that_is_right(path: Path, method: str) -> None:
    a_run = run(load_scene(path), method)
    for number, phase in enumerate(a_run.phases):
        if phase.proof.verdict == "moves":
            assert certificate(a_run, number) is None
            continue
        found, checked = certified(a_run, number)
        assert found.uniqueness == checked.uniqueness == phase.proof.uniqueness
        assert checked.residual <= 1e-8
        assert checked.speed > 1e-6 if found.uniqueness == "weak" else checked.speed <= 2e-6


def test_certificates_of_random_blocks_and_unions_agree_with_the_verdicts(cases, say) -> None:
    """Points near edges and seams: contacts that the checker finds by itself are those of the kernels, each time.
    Blocks mostly slide on to where they must rest; wedges begin where they may.
    """
    random, n, seen = np.random.default_rng(40), cases(60, 1500), {"strong": 0, "weak": 0, "not shown": 0, None: 0}
    n_leaves, without = 0, 0
    for index in range(n):
        scene = caged_seams(random) if index % 2 else pushed_block(random, float(random.choice([0.1, 0.3])))
        if index % 10 == 9:
            scene = load_scene(WEDGE, [f"friction.coefficient={random.uniform(0.3, 0.6)!r}"])
        a_run = run(scene)
        proof = a_run.phases[-1].proof
        found = certificate(a_run)
        if found is None:
            without += proof.verdict != "moves"
            continue
        checked = check_certificate(found, a_run)
        n_leaves += checked.n_leaves
        seen[found.uniqueness] += 1
        assert found.uniqueness == proof.uniqueness
    say(f"{n} certificates: {seen}, {n_leaves} leaves; {without} rests to second order or with many edges")
    assert seen["strong"] > n // 2
    assert seen["weak"] > 0
    assert without <= n // 20


def test_certificates_of_random_shapes_agree_with_the_verdicts(cases, say) -> None:
    """And their contacts are where the parts touch: the planes through them have the parts on their two sides."""
    random, n, seen = np.random.default_rng(41), cases(150, 3000), {"strong": 0, "weak": 0, "not shown": 0}
    n_contacts, n_without, deepest = 0, 0, 0.0
    for _ in range(n):
        scene = scene_of(*random_problem(random))
        a_run = run(scene)
        if a_run.verdict not in ("rests", "may rest"):
            continue
        found = certificate(a_run)
        if found is None:
            n_without += 1
            continue
        assert found.uniqueness == check_certificate(found, a_run).uniqueness == a_run.phases[-1].proof.uniqueness
        seen[found.uniqueness] += 1
        n_contacts += len(found.contacts)
        deepest = max(deepest, farthest_beyond(found, a_run) / scene.touch_m)
    say(f"{n} scenes, {seen}, {n_without} without; {n_contacts} contacts, {deepest:.1e} tolerances past their planes")
    assert seen["strong"] > n // 50
    assert seen["weak"] > 0
    assert n_without <= n // 50
    assert deepest <= 1.0


def farthest_beyond(found: Certificate, a_run: Run) -> float:
    """How far the parts that touch reach over the planes of their contacts, metres, by their support functions."""
    scene, pose = a_run.scene, a_run.pose
    held = dict(zip(scene.object.element_names, scene.object.parts, strict=True))
    cage = dict(zip(scene.cage.element_names, (*scene.cage.points_world(), *scene.cage.shapes), strict=True))
    most = 0.0
    for face, place, (normal, *_) in zip(found.contacts, found.places_world, found.directions_world, strict=True):
        most = max(most, height(held[face.box], pose, normal) - float(normal @ place))
        most = max(most, height(cage[face.point], scene.cage.pose_world_cage, -normal) + float(normal @ place))
    return most


def height(part: Box | AnyShape | np.ndarray, pose: Pose, normal_world: np.ndarray) -> float:
    if isinstance(part, np.ndarray):
        return float(part @ normal_world)
    direction = pose.rotation.T @ normal_world
    return float(part.heights_m(direction[None])[0] + pose.position_m @ normal_world)


def slope(friction: float = 0.5, lean: float = 0.6) -> Scene:
    """A block on four feet, on a slope of a part of the friction angle: its rest needs friction."""
    turned = Pose(euler_zyx=(0, math.atan(friction * lean), 0))
    feet = [(x, y, 0) for x in (-0.04, 0.04) for y in (-0.03, 0.03)]
    held = Object([Box((0.1, 0.08, 0.04))], pose=turned @ Pose((0, 0, 0.02)))
    return Scene(held, Cage(feet, pose=turned), [Load("weight", gravity=(0, 0, -1))], friction_coefficient=friction)


@pytest.fixture(scope="module")
def rest() -> tuple[Run, Certificate]:
    a_run = run(slope())
    found, checked = certified(a_run)
    assert checked.n_leaves > 10
    return a_run, found


def with_tree(given: Certificate, **changes: object) -> Certificate:
    choice = given.choices[0]
    assert choice.tree is not None
    return replace(given, choices=(replace(choice, tree=replace(choice.tree, **changes)),))  # type: ignore[arg-type]


def tree_of(given: Certificate) -> ModeTree:
    tree = given.choices[0].tree
    assert tree is not None
    return tree


def changed_twist(given: Certificate) -> Certificate:
    twists = tree_of(given).twists.copy()
    twists[-1] += 1e-4
    return with_tree(given, twists=twists)


def changed_pressure(given: Certificate) -> Certificate:
    pressures = tree_of(given).pressures.copy()
    pressures[3, np.abs(pressures[3]).sum(axis=1).argmax()] *= 1.001
    return with_tree(given, pressures=pressures)


def pulling(given: Certificate) -> Certificate:
    """Another way to make the same wrench: by four feet of which two pull, in a case that does not keep them closed."""
    tree = tree_of(given)
    pressures = tree.pressures.copy()
    pressures[:, :, 0] += 10.0 * np.array([1.0, -1.0, -1.0, 1.0])
    return with_tree(given, pressures=pressures)


def dropped_child(given: Certificate) -> Certificate:
    """Take the last node out, a leaf, with all that is said of it."""
    tree = tree_of(given)
    assert tree.leaves()[-1] == len(tree.parents) - 1
    return with_tree(given, **{field.name: getattr(tree, field.name)[:-1] for field in fields(ModeTree)})


def shrunk_sector(given: Certificate) -> Certificate:
    tree = tree_of(given)
    widths = tree.widths_rad.copy()
    widths[tree.decisions.index("slips")] *= 0.99
    return with_tree(given, widths_rad=widths)


def turned_sector(given: Certificate) -> Certificate:
    tree = tree_of(given)
    starts = tree.starts_rad.copy()
    starts[tree.decisions.index("slips")] += 0.01
    return with_tree(given, starts_rad=starts)


def twice_the_same_sector(given: Certificate) -> Certificate:
    tree = tree_of(given)
    starts = tree.starts_rad.copy()
    first, second = [node for node, decision in enumerate(tree.decisions) if decision == "slips"][:2]
    starts[second] = starts[first]
    return with_tree(given, starts_rad=starts)


def all_stick(given: Certificate) -> Certificate:
    decisions = tuple("sticks" if word == "slips" else word for word in tree_of(given).decisions)
    return with_tree(given, decisions=decisions)


def root_alone(given: Certificate) -> Certificate:
    """As if no friction were needed."""
    return with_tree(
        given, parents=(-1,), contacts=(-1,), decisions=("none",), starts_rad=np.zeros(1), widths_rad=np.zeros(1),
        twists=np.zeros((1, 6)), pressures=given.choices[0].forces[None],
    )  # fmt: skip


def with_forces(given: Certificate, change: Callable[[np.ndarray], np.ndarray]) -> Certificate:
    choice = given.choices[0]
    return replace(given, choices=(replace(choice, forces=change(choice.forces)),))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (changed_twist, "leaf "),
        (changed_pressure, "leaf 3"),
        (pulling, "leaf 0"),
        (dropped_child, "are not all that a contact may do|leave out"),
        (shrunk_sector, "leave out .* rad of the slips"),
        (turned_sector, "leave out .* rad of the slips"),
        (twice_the_same_sector, "leave out .* rad of the slips"),
        (all_stick, "are not all that a contact may do"),
        (root_alone, "leaf 0 (node 0)"),
        (lambda given: with_tree(given, twists=tree_of(given).twists * math.nan), "not finite"),
        (lambda given: with_tree(given, twists=tree_of(given).twists[:-1]), "not one twist"),
        (lambda given: with_tree(given, parents=tree_of(given).parents[:-1]), "different lengths"),
        (lambda given: with_tree(given, parents=(-1, 5, *tree_of(given).parents[2:])), "does not come before it"),
        (lambda given: with_forces(given, lambda forces: 1.001 * forces), "of the load"),
        (lambda given: with_forces(given, lambda forces: forces * (1, 9, 1)), "leave their friction cones"),
        (lambda given: with_forces(given, lambda forces: forces * math.nan), "are not three numbers"),
        (lambda given: replace(given, friction=0.8 * given.friction), "friction of C1 on -z of box1 is 0.4, and the"),
        (lambda given: replace(given, friction=given.friction[:2]), "has 2 coefficients for 4 contacts"),
        (lambda given: replace(given, contacts=given.contacts[:-1]), "contacts leave out C4 on -z of box1"),
        (lambda given: replace(given, contacts=(replace(given.contacts[0], side="+z"), *given.contacts[1:])),
         "contacts name C1 on +z of box1, which does not touch"),
        (lambda given: replace(given, places_world=given.places_world + 1e-7), "places_world of C1 on -z of box1"),
        (lambda given: replace(given, places_world=given.places_world[1:]), "places_world has 3 entries for 4 contact"),
        (lambda given: replace(given, directions_world=given.directions_world * math.nan), "directions_world of C1 on"),
        (lambda given: replace(given, directions_world=given.directions_world[:, [0, 2, 1]]), "directions_world of C1"),
        (lambda given: replace(given, choices=()), "choices leave out the one with C1 on -z of box1, C2"),
        (lambda given: replace(given, choices=(replace(given.choices[0], contacts=(0, 1, 2, 9)),)), "name contact 9"),
        (lambda given: replace(given, choices=(replace(given.choices[0], tree=None),)), "has no tree"),
        (lambda given: replace(given, uniqueness="weak"), "onset is missing"),
    ],
)  # fmt: skip
def test_a_changed_certificate_is_refused(
    rest: tuple[Run, Certificate], change: Callable[[Certificate], Certificate], message: str
) -> None:
    a_run, found = rest
    with pytest.raises(CertificateError, match=message.replace("(", r"\(").replace(")", r"\)").replace("+", r"\+")):
        check_certificate(change(found), a_run)


@pytest.mark.parametrize("friction", [0.31, 0.45, 0.55, 0.9])
def test_a_certificate_is_for_one_coefficient_of_friction(rest: tuple[Run, Certificate], friction: float) -> None:
    """More friction makes other motions possible, and less no balance; one that tells the new coefficient is wrong."""
    a_run, found = rest
    other = replace(a_run, scene=a_run.scene.changed(friction_coefficient=friction))
    with pytest.raises(CertificateError):
        check_certificate(replace(found, friction=np.full(4, friction)), other)


def test_a_certificate_is_for_one_pose_and_load(rest: tuple[Run, Certificate]) -> None:
    a_run, found = rest
    lighter_on_one_side = run(slope(lean=0.61))
    with pytest.raises(CertificateError):
        check_certificate(found, lighter_on_one_side)
    with pytest.raises(CertificateError, match="contacts leave out C5"):
        check_certificate(found, run(_with_a_point_more(a_run.scene, (0.0, 0.0, 0.0))))


def _with_a_point_more(scene: Scene, point_cage: tuple[float, float, float]) -> Scene:
    cage = scene.cage
    return Scene(
        scene.object, Cage([*cage.points_cage, point_cage], pose=cage.pose_world_cage), scene.loads,
        friction_coefficient=scene.friction_coefficient,
    )  # fmt: skip


def test_another_onset_is_checked_by_coulombs_law() -> None:
    a_run = run(load_scene(ROOT / "scenes" / "wedge.yaml"))
    found, checked = certified(a_run)
    assert (found.uniqueness, checked.uniqueness) == ("weak", "weak")
    onset = found.onset
    assert onset is not None
    for more in ((1e-3, 0, 0), (0, 1e-3, 0), (-1e-3, 0, 0)):
        with pytest.raises(CertificateError, match="onset"):
            check_certificate(replace(found, onset=replace(onset, forces=onset.forces + np.array(more))), a_run)
    rest_itself = replace(onset, forces=found.choices[0].forces)
    with pytest.raises(CertificateError, match="is no motion that the load drives"):
        check_certificate(replace(found, onset=rest_itself), a_run)
    with pytest.raises(CertificateError, match="has no tree"):
        check_certificate(replace(found, uniqueness="strong"), a_run)


def test_no_other_onset_goes_into_a_rim_between_its_points(cases, say) -> None:
    """Pegs that stand in bores, pushed: as another onset begins, no point of the flat end goes into the bottom."""
    rng, n_weak, deepest = np.random.default_rng(5), 0, 0.0
    for _ in range(cases(20, 200)):
        radius, friction, around = float(rng.uniform(0.005, 0.02)), float(rng.uniform(0.2, 0.9)), rng.uniform(0.0, 6.28)
        length = radius * float(rng.uniform(1.0, 6.0))
        depth, play = length * float(rng.uniform(0.2, 0.8)), radius * 10.0 ** float(rng.uniform(-2.5, -0.7))
        push = Force(
            (math.cos(around), math.sin(around), -float(rng.uniform(0.1, 2.0))),
            (*rng.uniform(-radius, radius, 2), length * float(rng.uniform(-0.5, 0.5))),
        )
        peg = Object(shapes=[Cylinder(radius, length)], pose=Pose((0, 0, length / 2 - depth)))
        block = Box((8 * radius, 8 * radius, 2 * depth), Pose((0, 0, -depth)), "block")
        bore = Cage(shapes=[block], holes=[Hole(radius + play, depth, in_=["block"])])
        loads = [Load("weight", gravity=(0, 0, -1)), Load("push", forces=[push])]
        a_run = run(Scene(peg, bore, loads, friction_coefficient=friction))
        if a_run.phases[-1].proof.uniqueness != "weak" or (found := certificate(a_run)) is None:
            continue
        assert found.onset is not None
        problem, pose = contact_problem(a_run, 1), a_run.pose
        pushed = np.einsum("ij,ijk->k", found.onset.forces, problem.wrenches[list(found.onset.contacts)])
        twist = problem.scale.T @ problem.scale @ (problem.load - pushed)
        angles = np.linspace(0.0, 2.0 * math.pi, 3600)
        rim = np.stack([radius * np.cos(angles), radius * np.sin(angles), 0.0 * angles - length / 2], axis=1)
        speeds = twist[:3] + np.cross(twist[3:], rim @ pose.rotation.T)
        is_on_bottom = abs(pose.position_m[2] - length / 2 + depth) + radius * np.hypot(*pose.rotation[:2, 2]) < 1e-9
        if is_on_bottom:
            n_weak += 1
            deepest = max(deepest, -float(speeds[:, 2].min()) / float(np.abs(speeds).max()))
    assert n_weak > 0
    assert deepest < 1e-9
    say(f"{n_weak} other onsets of pegs: rims go in with at most {deepest:.1e} of the motion")


def test_points_on_edges_have_a_tree_for_each_choice_of_faces() -> None:
    """A block between walls that meet its upper edge: either face of it may count."""
    points = [(-0.04, 0.03, 0), (0.04, 0.03, 0), (0.04, -0.03, 0), (-0.04, -0.03, 0), (0.05, 0, 0.0), (-0.05, 0, 0.0)]
    held = Object([Box((0.1, 0.08, 0.04), Pose((0, 0, 0.02)))], (0, 0, 0.02))
    a_run = run(Scene(held, Cage(points), [Load("weight", gravity=(0.1, 0, -1))], friction_coefficient=0.4))
    found, checked = certified(a_run)
    assert (found.uniqueness, len(found.choices)) == ("strong", 4)
    assert checked.n_leaves >= 4
    with pytest.raises(CertificateError, match="choices leave out the one with"):
        check_certificate(replace(found, choices=found.choices[1:]), a_run)


def test_contacts_may_have_coefficients_of_their_own() -> None:
    """A block on a slope, with one foot less rough than the others and a smooth pin behind; and with a smooth foot."""
    scene = _with_a_point_more(slope(0.6, 0.5), (-0.05, 0.0, 0.02))
    own = _with_friction_of(scene, {"C5": 0.0, "C2": 0.45})
    a_run = run(own)
    found, checked = certified(a_run)
    assert (found.uniqueness, found.friction.tolist()) == ("strong", [0.6, 0.45, 0.6, 0.6, 0.0])
    assert checked.n_leaves > 10
    assert np.abs(found.choices[0].forces[4, 1:]).max() == 0.0
    with pytest.raises(CertificateError, match=r"friction of C2 on -z of box1 is 0.45, and the scene's is 0.6"):
        check_certificate(found, replace(a_run, scene=scene))
    with pytest.raises(CertificateError, match=r"leaf|friction cones"):
        check_certificate(replace(found, friction=np.full(5, 0.6)), replace(a_run, scene=scene))
    slides, speed = certified(run(_with_friction_of(scene, {"C5": 0.0, "C2": 0.0})))
    assert slides.uniqueness == "weak"
    assert speed.speed > 0.01


def _with_friction_of(scene: Scene, friction_of: dict[str, float]) -> Scene:
    return Scene(
        scene.object, scene.cage, scene.loads,
        friction_coefficient=scene.friction_coefficient, friction_of=friction_of,
    )  # fmt: skip


def test_without_friction_the_forces_are_the_certificate() -> None:
    a_run = run(load_scene(ROOT / "scenes" / "rail-pitch.yaml"))
    found, _ = certified(a_run)
    (choice,) = found.choices
    tree = tree_of(found)
    assert (len(tree.parents), tree.twists.any()) == (1, False)
    assert np.array_equal(tree.pressures[0], choice.forces)


def test_certificates_are_saved_with_a_run_and_come_back(rest: tuple[Run, Certificate], tmp_path: Path) -> None:
    a_run, found = rest
    save_run(a_run, tmp_path / "run.json")
    (again,) = load_certificates(tmp_path / "run.json")
    assert again is not None
    assert json.dumps(record_of(again)) == json.dumps(record_of(found))
    check_certificate(again, load_run(tmp_path / "run.json"))
    n_leaves = len(tree_of(found).leaves())
    assert len(json.dumps(record_of(again))) < 1500 + 450 * n_leaves


def test_a_saved_run_without_certificates_says_so(rest: tuple[Run, Certificate], tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    save_run(rest[0], path)
    content = json.loads(path.read_text(encoding="utf-8"))
    damaged = {**content, "certificates": [{**content["certificates"][0], "friction": "much"}]}
    del content["certificates"]
    path.write_text(json.dumps(content), encoding="utf-8")
    assert load_run(path).verdict == "rests"
    with pytest.raises(RunFileError, match=re.escape("has no certificates; save its run again")):
        load_certificates(path)
    path.write_text(json.dumps(damaged), encoding="utf-8")
    with pytest.raises(RunFileError, match=re.escape("is damaged: certificates[0].friction: ")):
        load_certificates(path)


def test_what_nothing_touches_and_nothing_drives_rests_without_one(tmp_path: Path) -> None:
    """Weight and push cancel. With a point below the certificate says that no force is needed."""
    push = Force((0, 0, 1), (0, 0, 0), 9.81)
    for z, has_one in ((-0.03, False), (-0.02, True)):
        held = Object([Box((0.1, 0.08, 0.04))], mass_kg=1.0)
        a_run = run(Scene(held, Cage([(0, 0, z)]), [Load("both", gravity=(0, 0, -9.81), force=push)]))
        save_run(a_run, tmp_path / f"{z}.json")
        (found,) = load_certificates(tmp_path / f"{z}.json")
        assert (found is not None) == (has_one and a_run.phases[-1].proof.verdict == "rests")
        if found is not None:
            assert check_certificate(found, a_run).residual == 0.0


def test_a_phase_that_moves_has_none(tmp_path: Path) -> None:
    a_run = run(load_scene(ROOT / "scenes" / "connector.yaml"), "stepwise")
    save_run(a_run, tmp_path / "run.json")
    certificates = load_certificates(tmp_path / "run.json")
    assert [found is None for found in certificates] == [phase.proof.verdict == "moves" for phase in a_run.phases]
    assert certificates[-1] is None
    with pytest.raises(IndexError):
        certificate(a_run, 7)


@pytest.mark.parametrize("name", ["ladder", "phone-dock", "planks"])
def test_the_thirty_lines_of_the_theory_check_a_saved_run(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs" / "theory" / "certificate.md").read_text(encoding="utf-8")
    (by_hand,) = [text for text in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "import numpy" in text]
    save_run(run(load_scene(ROOT / "scenes" / f"{name}.yaml")), tmp_path / "run.json")
    monkeypatch.chdir(tmp_path)
    exec(by_hand, {})
    assert "leaves: no motion begins" in capsys.readouterr().out

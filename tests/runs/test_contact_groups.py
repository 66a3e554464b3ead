"""Contacts of which one counts at a time, as a run tells them: `Contact.group`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from audit.families import FAMILIES, WITH_SHAPES, make_case
from audit.groups import groups
from cagepose import Box, Cage, Load, Object, Pose, Run, Scene, load_run, load_scene, margin, run, save_run

SCENES = Path(__file__).resolve().parents[2] / "scenes"
WEIGHT = Load("weight", gravity=(0, 0, -1))
FEET = [(-0.04, -0.03, 0.0), (0.03, -0.03, 0.0), (0.0, 0.04, 0.0)]


def resting(points: list[tuple[float, float, float]], *boxes: Box) -> Run:
    held = Object(boxes, (0, 0, 0), pose=Pose((0, 0, 0.01)))
    return run(Scene(held, Cage(points), [WEIGHT], friction_coefficient=0.2))


def groups_of(found: Run) -> list[tuple[str, str, int | None]]:
    return [(contact.point, contact.box, contact.group) for contact in found.contacts]


def without_groups(found: Run) -> Run:
    """A run as an earlier version has saved it."""
    return replace(
        found,
        phases=tuple(
            replace(phase, contacts=tuple(replace(contact, group=None) for contact in phase.contacts))
            for phase in found.phases
        ),
    )


def test_faces_at_the_edge_that_a_point_is_on_are_one_group() -> None:
    """Beside three feet one point is on the edge of floor and side, and one on the corner of three faces."""
    block = Box((0.1, 0.1, 0.02), name="block")
    found = resting([(0.05, -0.03, 0.0), (-0.05, -0.05, 0.0), *FEET], block)
    assert groups_of(found) == [
        *[("C1", "block", 0)] * 2,
        *[("C2", "block", 2)] * 3,
        *[(f"C{foot}", "block", foot + 2) for foot in (3, 4, 5)],
    ]


def test_a_flush_face_of_another_box_is_not_listed_and_a_face_beside_it_is() -> None:
    """Both boxes end at the floor: the second says nothing new of a point that is under both, and holds the third."""
    left, right = (Box((0.1, 0.1, 0.02), Pose((x, 0, 0)), name=name) for x, name in ((0.0, "left"), (0.04, "right")))
    found = resting([*FEET, (0.08, 0.0, 0.0)], left, right)
    assert groups_of(found) == [
        ("C1", "left", 0),
        ("C2", "left", 1),
        ("C3", "left", 2),
        ("C4", "right", 3),
    ]


def test_groups_come_back_from_a_file(tmp_path: Path) -> None:
    found = run(load_scene(SCENES / "rail-pitch.yaml"), "quasistatic")
    save_run(found, tmp_path / "run.json")
    assert groups_of(load_run(tmp_path / "run.json")) == groups_of(found)


@pytest.mark.parametrize("name", ["rail-pitch", "phone-dock", "planks", "plate-on-pins"])
def test_the_margin_of_a_run_that_tells_no_groups_is_that_of_one_that_does(name: str) -> None:
    found = run(load_scene(SCENES / f"{name}.yaml"), "quasistatic")
    older = without_groups(found)
    for phase in range(len(found.phases)):
        one, other = margin(found, phase), margin(older, phase)
        assert (one is None) == (other is None)
        if one is not None and other is not None:
            assert one.force_n == pytest.approx(other.force_n, rel=1e-9)
            assert [c.point for c in one.contacts] == [c.point for c in other.contacts]


@pytest.mark.parametrize("family", sorted(set(FAMILIES) - set(WITH_SHAPES)))
def test_groups_are_those_that_are_found_anew(family: str, cases) -> None:  # type: ignore[no-untyped-def]
    answers = [groups(run(make_case(family, index, 1).scene)) for index in range(cases(4, 60))]
    assert [answer for answer in answers if answer] == []

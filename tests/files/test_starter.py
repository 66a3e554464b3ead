"""The scene that ``cagepose init`` writes is good, complete, and ends at rest."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cagepose import play, run
from cagepose.files.scene_file import parse_scene
from cagepose.files.schema import scene_json_schema
from cagepose.files.schema_shapes import KINDS
from cagepose.files.starter import starter_text, write_starter


def test_the_starter_runs_through_all_its_phases_and_ends_in_a_proven_rest() -> None:
    result = run(parse_scene(starter_text("mine")))
    assert (result.scene.name, result.method) == ("mine", "quasistatic")
    assert [phase.verdict for phase in result.phases] == ["rests", "rests"]
    assert [(phase.proof.verdict, phase.proof.needs_friction) for phase in result.phases] == [("rests", False)] * 2
    assert result.phases[-1].proof.stability == "stable"
    assert [warning.split(" (")[0] for warning in result.warnings] == [
        "clamp: the weight of the phase before no longer acts"
    ]


def test_the_first_play_says_that_the_starter_is_caged_and_how_loose_it_is() -> None:
    found = play(parse_scene(starter_text("mine")))
    assert found.verdict == "caged"
    assert all(end.certified is not None for ends in found.freedoms.values() for end in (ends.low, ends.high))
    assert found.freedoms["z"].high.exact == pytest.approx(0.5e-3)


def test_the_rules_of_the_paper_hold_the_starter_before_its_last_stop() -> None:
    """At side1 and end1; side2 is not reached, and the mechanics says that the clamp would turn it on."""
    result = run(parse_scene(starter_text("mine")), "stepwise")
    assert [phase.verdict for phase in result.phases] == ["stable", "stable"]
    assert {event.rule for phase in result.phases for event in phase.events} >= {"A-1", "A-4", "Slp-1", "Slp-2", "B-4"}
    assert {contact.point for contact in result.contacts} == {"pin1", "pin2", "pin3", "side1", "end1"}
    (warning,) = result.warnings
    assert warning.startswith("clamp: the mechanics contradicts this verdict")


SEVERAL_LOADS = {"forces", "moments", "springs", "follows", "to", "stiffness", "preload"}
DRIVEN = {"bodies", "drive", "stop_at", "travel", "turn", "about", "through", "moment", "press", "along", "spring"}
IMPORTED = {"left_out", "surfaces", "on", "plane", "point", "normal", "center", "axis", "slope", "hollow"}
IMPORTED |= {"solid", "fillets", "torus", "tube"}
ROUND = {
    "shapes",
    "radius",
    "radius_bottom",
    "radius_top",
    "vertices",
    "triangles",
    "flat",
    "depth",
    "chamfer",
    "width",
    "in",
    *KINDS,
}
"""Keys that a first scene has no use for."""


def test_the_starter_names_every_key_of_the_schema_but_those_of_several_loads_shapes_and_drives() -> None:
    schema = scene_json_schema()
    text = starter_text("x")
    for part in (schema, *schema["$defs"].values()):
        for key in part["properties"].keys() - SEVERAL_LOADS - ROUND - DRIVEN - IMPORTED:
            assert re.search(rf"\b{key}\b", text), key


def test_every_option_of_the_starter_works_when_its_hash_is_removed() -> None:
    text = re.sub(r"(?m)^(\s*)# ([a-z_]+: )", r"\1\2", starter_text("x"))
    scene = parse_scene(text)
    assert scene.object.mass_kg is not None
    assert scene.object.inertia_kg_m2 is not None
    assert (scene.method, scene.metric) == ("quasistatic", "release")
    assert scene.adjustable[0].key == "cage.points.end1[0]"
    assert len(text.splitlines()) == len(starter_text("x").splitlines())
    assert run(scene).verdict == "rests"


def test_the_hole_that_the_starter_shows_goes_into_its_shapes() -> None:
    text = re.sub(r"(?m)^(\s*)# (shapes: )", r"\1\2", starter_text("x"))
    (hole,) = re.findall(r"a round hole: (\{.*\})", text)
    scene = parse_scene(re.sub(r"(shapes: \[.*)\]( +#)", rf"\1, {hole}]\2", text))
    assert [found.name for found in scene.cage.holes] == ["bore"]


@pytest.mark.parametrize("holes", [False, True])
def test_the_change_that_the_starter_proposes_works(holes: bool) -> None:
    text = starter_text("x", holes=holes)
    (change,) = re.findall(r"--set (\S+)", text)
    assert run(parse_scene(text, set_values=[change])).verdict == "rests"


def test_the_starter_with_a_hole_rests_by_its_forces_and_with_all_its_options() -> None:
    text = starter_text("pin", holes=True)
    plain, whole = (parse_scene(one) for one in (text, re.sub(r"(?m)^(\s*)# ([a-z_]+: |- \{)", r"\1\2", text)))
    assert (plain.name, [hole.chamfer for hole in plain.cage.holes]) == ("pin", [None])
    assert [phase.proof.stability for phase in run(plain).phases] == ["stable", "stable"]
    assert [shape.name for shape in (*whole.object.shapes, *whole.cage.shapes)] == [
        "shank",
        "head",
        "tip",
        "plate",
        "stop",
    ]
    assert whole.cage.holes[0].chamfer is not None
    assert run(whole).verdict == "rests"


@pytest.mark.parametrize("name", ["null", "True", "fixture-2", "Größe", "a_b"])
def test_any_good_name_gives_a_scene_of_that_name(tmp_path: Path, name: str) -> None:
    path = write_starter(name, tmp_path)
    assert path == tmp_path / f"{name}.yaml"
    assert parse_scene(path.read_text(encoding="utf-8")).name == name


def test_a_name_with_its_ending_is_understood(tmp_path: Path) -> None:
    assert write_starter("mine.yaml", tmp_path) == tmp_path / "mine.yaml"


def test_an_existing_file_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("precious", encoding="utf-8")
    with pytest.raises(FileExistsError):
        write_starter("mine", tmp_path)
    assert (tmp_path / "mine.yaml").read_text(encoding="utf-8") == "precious"


@pytest.mark.parametrize("name", ["", ".yaml", "../up", "a/b", "2nd", "-x", "a b", "a\nb", "x" * 101])
def test_a_name_that_is_no_plain_file_name_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="start with a letter and use letters, digits, - and _ only"):
        write_starter(name, tmp_path)
    assert list(tmp_path.iterdir()) == []

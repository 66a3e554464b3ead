"""``import cagepose`` is quick, complete, and the same to type checkers as to Python."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import cagepose

SOURCE = Path(cagepose.__file__)
PUBLIC = """
Adjustable Box Cage CageBody CageposeError Capsule Certificate certificate CertificateCheck CertificateError Chamfer
check_certificate ChosenFaces compare Comparison Cone Contact ContactFace ContactMargin Convex Cylinder Design
DesignResults Disc Drive DriveCheck DrivenPlace DriveProof Event Facets Force Frame FreeMotion Hole Insertion
insertion JamChoice KernelsError Load load_certificates load_run load_scene Margin margin Misalignment MisalignmentEnd
MissingExtraError ModeTree Moment Motion Object OtherOnset Parting PhaseRun Play play Pose Press press_limits Problem
Proof Run run run_many RunFileError Runs save_run save_scene Scene SceneError SceneFileError Shape Sphere Spring
StopChoice Study StudyFolderError StudyResults Tolerances Variant __version__
Variation with_critical_friction
FrictionLimits friction_limits Jam jam LiftOff Loss NoMotion Tipping tipping Unanswered
RestingPose RestingPoses resting_poses
CageRest CageRests cage_rests EscapeEnergy escape_energy CriticalGap critical_gap
"""


def test_all_names_every_public_class_and_function_once() -> None:
    assert sorted(set(cagepose.__all__)) == sorted(cagepose.__all__)
    assert set(cagepose.__all__) == set(PUBLIC.split())
    assert dir(cagepose) == sorted(cagepose.__all__)


@pytest.mark.parametrize("name", cagepose.__all__)
def test_every_public_name_resolves_and_has_a_docstring(name: str) -> None:
    value = getattr(cagepose, name)
    assert name in dir(cagepose)
    if name != "__version__":
        assert value.__name__ == name
        assert value.__doc__


def test_type_checkers_see_every_name_from_the_module_that_python_takes_it_from() -> None:
    (block,) = [
        node
        for node in ast.parse(SOURCE.read_text(encoding="utf-8")).body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    ]
    seen = {}
    for node in block.body:
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                assert alias.asname == alias.name  # re-exported, as type checkers ask for
                seen[alias.name] = node.module
        elif isinstance(node, ast.AnnAssign):
            seen[ast.unparse(node.target)] = None
    assert set(seen) == set(cagepose.__all__)
    assert {name: module for name, module in seen.items() if module} == cagepose._HOME


def test_the_package_says_that_it_is_typed() -> None:
    assert (SOURCE.parent / "py.typed").is_file()


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'cagepose' has no attribute 'Cube'"):
        cagepose.Cube  # noqa: B018


def test_importing_the_package_loads_nothing_heavy() -> None:
    code = "import sys, cagepose; print([name for name in ('numpy', 'pydantic') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"

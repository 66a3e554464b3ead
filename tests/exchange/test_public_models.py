"""Models that packages bring with them are read.

Gymnasium (MIT) is among our development packages. dm_control (Apache-2.0) is not, as it needs compiled packages that
our lock has no other use for: `pip install dm_control` runs its tests, too.
"""

from __future__ import annotations

import shutil
from importlib.util import find_spec
from pathlib import Path

import pytest

from cagepose import Facets, load_scene, run
from cagepose.cli.app import main
from cagepose.files.meshes.mesh_file import read_mesh

pytest.importorskip("mujoco")


def model(package: str, name: str) -> Path:
    found = find_spec(package)
    if found is None or found.origin is None:
        pytest.skip(f"{package} is not installed")
    return Path(found.origin).parent / name


MODELS = [
    ("gymnasium", "envs/mujoco/assets/ant.xml", [], 13, "marginal"),
    ("gymnasium", "envs/mujoco/assets/humanoid.xml", [], 17, "stable"),
    ("dm_control", "suite/fish.xml", [], 3, "stable"),
    ("dm_control", "suite/quadruped.xml", ["--object", "ball"], 1, "marginal"),
]


@pytest.mark.parametrize(("package", "name", "chosen", "n_parts", "stability"), MODELS)
def test_a_public_model_becomes_a_scene_that_comes_to_rest(package, name, chosen, n_parts, stability, tmp_path, capsys):
    scene = tmp_path / "scene.yaml"
    assert main(["import", str(model(package, name)), *chosen, "-o", str(scene)]) == 0, capsys.readouterr().err
    found = run(load_scene(scene))
    assert len(found.scene.object.parts) == n_parts
    assert (found.verdict, found.phases[-1].proof.stability) == ("rests", stability)


def test_a_bone_of_a_public_model_is_facets(tmp_path):
    bone = model("dm_control", "suite/dog_assets/BONEPhalanx_media_digiti_IV_L.stl")
    shutil.copy(bone, tmp_path / "bone.stl")
    found = read_mesh(tmp_path / "bone.stl", "m", "m", "bone")
    assert [type(shape) for shape in found.shapes] == [Facets]
    assert found.error == 0.0

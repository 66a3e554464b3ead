"""A convex mesh is a convex shape or a box; what is no body is refused, and hostile files do no harm."""

from __future__ import annotations

import io
import json
import os
import struct
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    Facets,
    Load,
    MissingExtraError,
    Object,
    Pose,
    Scene,
    SceneFileError,
    load_scene,
    run,
    save_scene,
)
from cagepose.cli.app import main
from cagepose.files.meshes import crossings, mesh_file, run_trimesh
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.run_trimesh import MOST_SOLIDS, surfaces_here
from cagepose.model.volume import BOX_SIGNS

trimesh = pytest.importorskip("trimesh")

CORNERS = np.array(
    [(-20, -15, 0), (20, -15, 0), (20, 15, 0), (-20, 15, 0), (-8, -5, 24), (9, -5, 24), (0, 11, 24)], float
)
SCENE = """\
name: part on three points
object:
  shapes: [{{{shape}}}]
  mass: 1
  pose: {{position: [0, 0, 40], euler_zyx_deg: [0, 5, 8]}}
cage:
  points: [[12, 9, 0], [-14, 8, 0], [-3, -12, 0]]
loads: [{{name: weight, gravity: [0, 0, -9.81]}}]
"""


def part():
    return trimesh.convex.convex_hull(CORNERS)


def written(folder: Path, mesh, name: str) -> str:
    content = mesh.export(file_type=name.rpartition(".")[2])
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return name


def scene_of(folder: Path, shape: str):
    (folder / "scene.yaml").write_text(SCENE.format(shape=shape))
    return load_scene(folder / "scene.yaml")


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "glb"])
def test_a_convex_mesh_is_the_convex_shape_of_its_corners(suffix, tmp_path):
    name = written(tmp_path, part(), f"part.{suffix}")
    meshed = scene_of(tmp_path, f"mesh: {{file: {name}, unit: mm}}")
    plain = scene_of(tmp_path, f"convex: {{vertices: {CORNERS.tolist()}}}")
    (shape,) = meshed.object.shapes
    assert sorted(shape.vertices_m.tolist()) == sorted((CORNERS / 1e3).tolist())
    ours, theirs = run(meshed), run(plain)
    assert ours.verdict == theirs.verdict == "rests"
    assert ours.pose.position_m == pytest.approx(theirs.pose.position_m, abs=1e-12)
    assert ours.pose.quaternion_wxyz == pytest.approx(theirs.pose.quaternion_wxyz, abs=1e-11)


@pytest.mark.usefixtures("in_this_process")
def test_units_are_those_given_else_of_the_scene_else_metres_of_glb(tmp_path):
    stl, glb = (written(tmp_path, part(), f"part.{suffix}") for suffix in ("stl", "glb"))

    def size(shape: str) -> float:
        return float(np.ptp(scene_of(tmp_path, shape).object.shapes[0].vertices_m, axis=0).max())

    assert size(f"mesh: {{file: {stl}}}") == pytest.approx(0.04)
    assert size(f"mesh: {{file: {stl}, unit: in}}") == pytest.approx(40 * 0.0254)
    assert size(f"mesh: {{file: {glb}}}") == pytest.approx(40.0)


@pytest.mark.usefixtures("in_this_process")
def test_corners_within_faces_and_edges_are_none(tmp_path):
    name = written(tmp_path, part().subdivide().subdivide(), "fine.stl")
    (shape,) = scene_of(tmp_path, f"mesh: {{file: {name}}}").object.shapes
    assert len(shape.hull.vertices_m) == len(CORNERS)


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize(
    "angles_deg", [(0, 0, 0), (10, 20, 30), (90, 0, 0), (45, 35.264389682754654, 45), (180, 90, 0)]
)
def test_a_box_becomes_a_box(angles_deg, tmp_path):
    """Which the paper's rules and play know, too."""
    turn, size = Pose((0.001, 0.002, 0.003), euler_zyx=np.radians(angles_deg)), np.array((0.03, 0.02, 0.01))
    corners = turn.transform(BOX_SIGNS * size / 2.0) * 1e3
    random = np.random.default_rng(7)
    mesh = trimesh.convex.convex_hull(corners[random.permutation(8)]).subdivide()
    (box,) = scene_of(tmp_path, f"mesh: {{file: {written(tmp_path, mesh, 'box.stl')}}}").object.boxes
    assert sorted(box.size_m) == pytest.approx(sorted(size), rel=1e-6)
    found = box.corners_object() * 1e3
    assert np.linalg.norm(found[:, None] - corners, axis=2).min(axis=1).max() < 1e-5
    if angles_deg == (0, 0, 0):
        assert box.pose_object_box.quaternion_wxyz.tolist() == [1, 0, 0, 0]


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("by", [1e-4, 1.0])
def test_what_is_nearly_a_box_is_none(by, tmp_path):
    corners = BOX_SIGNS * (15.0, 10.0, 5.0)
    for changed in (
        corners + by * (corners[:, [2]] > 0) * (1, 0, 0),
        corners * (1 + by * (corners[:, [2]] > 0) / 15.0),
    ):
        name = written(tmp_path, trimesh.convex.convex_hull(changed), "box.stl")
        os.utime(tmp_path / name, ns=(1, int(1e6 * by)))
        assert scene_of(tmp_path, f"mesh: {{file: {name}}}").object.boxes == ()


@pytest.mark.usefixtures("in_this_process")
def test_a_saved_scene_holds_the_corners_itself(tmp_path):
    written(tmp_path, part(), "part.stl")
    scene = scene_of(tmp_path, "mesh: {file: part.stl}, name: part")
    save_scene(scene, tmp_path / "saved.yaml")
    (tmp_path / "part.stl").unlink()
    again = load_scene(tmp_path / "saved.yaml")
    assert run(again).pose.position_m.tolist() == run(scene).pose.position_m.tolist()


@pytest.mark.usefixtures("in_this_process")
def test_a_mesh_that_changes_is_read_again(tmp_path):
    written(tmp_path, part(), "part.stl")
    first = scene_of(tmp_path, "mesh: {file: part.stl}")
    larger = part()
    larger.apply_scale(1.5)
    written(tmp_path, larger, "part.stl")
    os.utime(tmp_path / "part.stl", ns=(1, 1))
    second = scene_of(tmp_path, "mesh: {file: part.stl}")
    assert second.object.reach_m == pytest.approx(1.5 * first.object.reach_m)


def open_mesh():
    mesh = part()
    mesh.update_faces(np.arange(len(mesh.faces)) > 0)
    return mesh


def eight():
    """A bar whose middle goes along an eight, and so through itself."""
    turns, around = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False), np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    middles = np.stack([np.sin(turns), np.sin(turns) * np.cos(turns), 0.0 * turns], axis=1)
    along = np.roll(middles, -1, axis=0) - np.roll(middles, 1, axis=0)
    beside = np.cross(along / np.linalg.norm(along, axis=1, keepdims=True), (0.0, 0.0, 1.0))
    rings = beside[:, None] * np.cos(around)[:, None] + np.sin(around)[:, None] * np.array((0.0, 0.0, 1.0))
    here = np.arange(60 * 12).reshape(60, 12)
    over, next_ring = np.roll(here, -1, axis=1), np.roll(here, -1, axis=0)
    beyond = np.roll(over, -1, axis=0)
    faces = [np.stack([here, over, beyond], axis=2), np.stack([here, beyond, next_ring], axis=2)]
    vertices = (middles[:, None] + 0.1 * rings).reshape(-1, 3)
    mesh = trimesh.Trimesh(vertices, np.concatenate(faces).reshape(-1, 3), process=False)
    assert mesh.is_watertight
    return mesh


def glb_of_nothing() -> bytes:
    """Two thousand million points, of which the file holds none: the standard has them zero then."""
    points = {"componentType": 5126, "count": 2_000_000_000, "type": "VEC3"}
    content = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [points],
        "bufferViews": [{"buffer": 0, "byteLength": 4}],
        "buffers": [{"byteLength": 4}],
    }
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<IIII", 2, 32 + len(text), len(text), 0x4E4F534A)
    return b"glTF" + head + text + struct.pack("<III", 4, 0x004E4942, 0)


def glb_of_one(index: bytes) -> bytes:
    """A triangle whose last corner has an index."""
    corners, indices = np.eye(3, dtype="<f4").tobytes(), bytes(4) + b"\x01\0\0\0" + index
    content = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 12},
        ],
        "buffers": [{"byteLength": 48}],
    }
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<IIII", 2, 28 + len(text) + 48, len(text), 0x4E4F534A)
    return b"glTF" + head + text + struct.pack("<II", 48, 0x004E4942) + corners + indices


def of_size(size: str, away: int = 0) -> bytes:
    """A tetrahedron."""
    corners = [f"{away} 0 0", f"{away} 0 {size}", f"{away} {size} 0", f"{away + float(size)} 0 0"]
    return "".join([*(f"v {corner}\n" for corner in corners), "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n"]).encode()


HOSTILE = {
    "open.stl": (open_mesh, "is open at ("),
    "crossing.stl": (eight, "crosses itself by "),
    "flat.stl": (lambda: trimesh.Trimesh(CORNERS[:4] * (1, 1, 0), [(0, 1, 2), (0, 2, 3)]), "encloses no volume"),
    "zero.stl": (
        lambda: trimesh.Trimesh(np.zeros((3, 3)), [(0, 1, 2)], process=False),
        "holds no triangles with an area",
    ),
}
BYTES = {
    "empty.stl": (b"", "is empty; copy or export it again"),
    "cut-text.stl": (
        trimesh.creation.box().export(file_type="stl_ascii").encode()[:800],
        "is truncated: its last line is no endsolid",
    ),
    "no-numbers.stl": (
        trimesh.creation.box().export(file_type="stl_ascii").replace("0.5", "nan").encode(),
        "holds points that are no numbers",
    ),
    "eight-gigabytes.glb": (glb_of_nothing(), "cannot be read as a mesh (Unable to allocate"),
    "no-header.stl": (b" " * 50, "is truncated: 84 bytes expected, 50 found"),
    "no-triangles.stl": (bytes(84), "holds no triangles"),
    "no-triangles-in-text.stl": (b"solid facet\nendsolid\n", "holds no triangles"),
    "garbage.glb": (bytes(range(256)) * 40, "cannot be read as a mesh"),
    "text.ply": (b"ply\nformat ascii 1.0\nelement vertex 999999999\nend_header\n", "cannot be read as a mesh"),
    "claims.stl": (
        b" " * 80 + b"\xff\xff\xff\x7f" + bytes(500),
        "is truncated: 107,374,182,434 bytes expected, 584 found",
    ),
    "huge.obj": (of_size("1e308"), "has a corner at 1e+308, more than 1e+09; check its unit"),
    "tiny.obj": (of_size("1e-300"), "is 1e-300 long, less than 1e-09; check its unit"),
    "far.obj": (
        of_size("1", 10**8),
        "is 1e+08 times its size away from the origin; move both bodies there",
    ),
    "no-corner.glb": (glb_of_one(b"\x07\0\0\0"), "has a triangle whose corner is not there; export it again"),
    "part.3mf": (b"PK", "has the suffix '.3mf'; give a file of one of: .step, .stp, .stl, .obj, .ply, .glb"),
}
ASK_FOR_MUCH = ("eight-gigabytes.glb", "text.ply", "garbage.glb")
"""Of which memory and processor time must be limited."""


def refusal(folder: Path, name: str) -> str:
    began = time.monotonic()
    with pytest.raises(SceneFileError) as caught:
        scene_of(folder, f"mesh: {{file: {name}}}")
    assert time.monotonic() - began < 10.0
    (problem,) = caught.value.problems
    assert (problem.path, problem.line, problem.column) == (("object", "shapes", 0, "mesh", "file"), 3, 26)
    return problem.message.removeprefix(f"{folder / name} ")


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", HOSTILE)
def test_meshes_that_cannot_be_shapes_say_why_and_what_to_do(name, tmp_path):
    make, message = HOSTILE[name]
    written(tmp_path, make(), name)
    assert refusal(tmp_path, name).startswith(message)


@pytest.mark.parametrize("name", BYTES)
def test_damaged_files_are_clear_errors(name, tmp_path, request):
    if name not in ASK_FOR_MUCH:
        request.getfixturevalue("in_this_process")
    content, message = BYTES[name]
    (tmp_path / name).write_bytes(content)
    assert refusal(tmp_path, name).startswith(message)


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("share", [0.3, 0.9])
def test_truncated_files_are_clear_errors(share, tmp_path):
    for suffix in ("stl", "ply", "glb"):
        name = written(tmp_path, part().subdivide(), f"whole.{suffix}")
        content = (tmp_path / name).read_bytes()
        (tmp_path / f"cut.{suffix}").write_bytes(content[: int(share * len(content))])
        told = refusal(tmp_path, f"cut.{suffix}")
        assert suffix != "stl" or told.startswith(f"is truncated: {len(content):,} bytes expected, ")


def test_a_name_with_a_null_character_is_no_name(tmp_path):
    assert refusal(tmp_path, '"a\\0.stl"').endswith("is not a file name; remove the unprintable character")


def test_missing_and_huge_files(tmp_path, monkeypatch):
    assert refusal(tmp_path, "none.stl") == "is no file; check the name and the folder"
    written(tmp_path, part(), "part.stl")
    monkeypatch.setattr(mesh_file, "MAX_MESH_BYTES", 100)
    assert "simplify it" in refusal(tmp_path, "part.stl")


def test_other_files_that_a_mesh_names_are_not_opened(tmp_path):
    """An OBJ may name a library of materials, and that textures."""
    text = io.StringIO()
    text.write("mtllib /etc/passwd\nusemtl root\n" + part().export(file_type="obj"))
    (tmp_path / "part.obj").write_text(text.getvalue())
    opened = []
    sys.addaudithook(lambda event, args: opened.append(str(args[0])) if event == "open" else None)
    with (tmp_path / "part.obj").open("rb") as stream:
        surfaces_here(stream.read(), ".obj", split=True)
    assert any(name.endswith("part.obj") for name in opened)
    assert "/etc/passwd" not in opened


def test_bodies_of_a_file_are_counted():
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "".join(f"o {number}\nf 1 2 3\n" for number in range(MOST_SOLIDS + 1))
    with pytest.raises(ValueError, match=r"holds 1,001 bodies, more than 1,000; export those that touch alone"):
        surfaces_here(text.encode(), ".obj", split=True)


def test_solids_of_a_text_stl_are_one_body_where_none_is_asked_for_by_name():
    """Some programs make a solid of each triangle, of which trimesh reads 100,000 in half a minute."""
    text = trimesh.creation.box().subdivide().subdivide().subdivide().export(file_type="stl_ascii")
    facets = text.replace("endfacet", "endfacet\nendsolid one \r\nSolid another")
    n_solids = facets.count("endsolid")
    assert n_solids == 769
    (mesh,) = surfaces_here(facets.encode(), ".stl", split=False).values()
    assert len(mesh.faces) == 768
    assert mesh.body().volume() == pytest.approx(1.0)
    assert len(surfaces_here(facets.encode(), ".stl", split=True)) == 768
    with pytest.raises(ValueError, match=r"holds 1,538 bodies, more than 1,000; export those that touch alone"):
        surfaces_here(2 * facets.encode(), ".stl", split=True)


def of_objects(*objects) -> str:
    """Return an OBJ file of meshes by their names, each with corners of its own."""
    lines, n_before = [], 1
    for name, mesh in objects:
        lines += [f"o {name}", *(f"v {x} {y} {z}" for x, y, z in mesh.vertices.tolist())]
        lines += [f"f {a} {b} {c}" for a, b, c in (mesh.faces + n_before).tolist()]
        n_before += len(mesh.vertices)
    return "\n".join(lines)


@pytest.mark.usefixtures("in_this_process")
def test_objects_that_are_sides_of_one_surface_are_one_body(tmp_path):
    """As in the pegs of IsaacGymEnvs, whose two ends, wall and roundings are objects of their own."""
    box = trimesh.creation.box()
    sides = [(f"mesh{k}", box.submesh([faces], append=True)) for k, faces in enumerate((range(5), range(5, 12)))]
    apart = trimesh.creation.box((1, 1, 2)).apply_translation((3, 0, 0))
    (tmp_path / "box.obj").write_text(of_objects(*sides, ("post", apart), ("on it", box.copy())))
    found = mesh_file.read_solids(tmp_path / "box.obj")
    assert {name: mesh.body().volume() for name, mesh in found.items()} == pytest.approx(
        {"mesh0": 1.0, "on it": 1.0, "post": 2.0}
    )


def test_small_facets_are_saved_and_read_again(tmp_path):
    corners = 1e-5 * np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
    shape = Facets(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    floor = Box((1e-4, 1e-4, 1e-5), Pose((0.0, 0.0, -1e-5)))
    save_scene(
        Scene(Object(shapes=[shape]), Cage(shapes=[floor]), [Load("weight", gravity=(0, 0, -1))]),
        tmp_path / "s.yaml",
        "m",
    )
    assert load_scene(tmp_path / "s.yaml").object.parts[0].flat_m == pytest.approx(1e-14)


def test_a_reader_that_takes_too_long_is_stopped(tmp_path, monkeypatch):
    written(tmp_path, part(), "slow.obj")
    monkeypatch.setattr(run_trimesh, "WALL_SECONDS", 0.1)
    assert refusal(tmp_path, "slow.obj").startswith("takes trimesh more than 0.1 s; simplify it")


def test_what_is_seen_from_within_is_not_searched_for_crossings(monkeypatch):
    """What is round is a little hollow between its facets, as programs for CAD divide it."""
    mesh = trimesh.creation.icosphere(3)
    mesh.vertices *= 1.0 + 0.01 * np.random.default_rng(3).random((len(mesh.vertices), 1))
    monkeypatch.setattr(crossings, "near_pairs", None)
    assert crossings.deepest_crossing(Triangles(np.array(mesh.vertices), np.array(mesh.faces))) is None


def test_a_surface_that_goes_around_twice_crosses_itself():
    """Its triangles are all seen from within, but they cover the view twice: a ball whose skin winds about an axis."""
    turns, levels = np.linspace(0.0, 4.0 * np.pi, 63, endpoint=False), np.linspace(0.0, np.pi, 17)[1:-1]
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    rows = [np.column_stack([np.sin(level) * ring, np.full(63, np.cos(level))]) for level in levels]
    vertices = np.concatenate([*rows, [(0, 0, 1), (0, 0, -1)]])
    here = np.arange(63)
    beside = np.roll(here, -1)
    faces = [np.stack([here, beside, np.full(63, len(vertices) - 2)], axis=1)[:, [2, 0, 1]]]
    for row in range(len(levels) - 1):
        above, below = 63 * row, 63 * (row + 1)
        faces += [np.stack([above + here, below + here, below + beside], axis=1)]
        faces += [np.stack([above + here, below + beside, above + beside], axis=1)]
    last = 63 * (len(levels) - 1)
    faces += [np.stack([last + beside, last + here, np.full(63, len(vertices) - 1)], axis=1)]
    mesh = Triangles(vertices, np.concatenate(faces))
    assert mesh.body().volume() == pytest.approx(2 * 4 / 3 * np.pi, rel=0.05)
    assert crossings.deepest_crossing(mesh) is not None


def test_a_missing_extra_is_named(tmp_path, monkeypatch, capsys):
    written(tmp_path, part(), "new.obj")
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(MissingExtraError, match=r"meshes need trimesh.*pip install 'cagepose\[files\]'"):
        scene_of(tmp_path, "mesh: {file: new.obj}")
    assert main(["run", str(tmp_path / "scene.yaml")]) == 2
    assert "pip install 'cagepose[files]'" in capsys.readouterr().err

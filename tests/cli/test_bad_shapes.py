"""Each broken shape in a scene file is refused in one line, like everything else; exit code 2."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

SCENE = """\
name: round
object:
  shapes:
    - {{{}}}
  pose: {{position: [0, 0, 50]}}
cage:
  shapes:
    - {{{}}}
loads:
  - name: gravity
    gravity: [0, 0, -1]
"""
PIN = "cylinder: {radius: 5, length: 20}"
FLOOR = "box: {size: [90, 90, 10]}"
SHAPES = "box, sphere, capsule, cylinder, cone, convex, mesh, facets, disc, hole"
KNOWN = f"known shapes: {SHAPES}; known keys beside them: position, euler_zyx_deg, name, friction"

# What is broken, the object's shape, the cage's shape, and the whole line that must come out.
BROKEN = [
    ("negative radius", "sphere: {radius: -3}", FLOOR,
     "4:25: object.shapes[0].sphere.radius: is -3; give a number above 0"),
    ("zero radius", "sphere: {radius: 0}", FLOOR,
     "4:25: object.shapes[0].sphere.radius: is 0; give a number above 0"),
    ("text for a radius", "sphere: {radius: wide}", FLOOR,
     "4:25: object.shapes[0].sphere.radius: is text 'wide'; give a number"),
    ("infinite radius", "sphere: {radius: .inf}", FLOOR,
     "4:25: object.shapes[0].sphere.radius: is infinite; give a finite number"),
    ("radius missing", "sphere: {}", FLOOR,
     "4:16: object.shapes[0].sphere.radius: is missing; add it, for example radius: 3"),
    ("number for a sphere", "sphere: 3", FLOOR,
     "4:16: object.shapes[0].sphere: is 3; give keys with values"),
    ("empty sphere", "sphere: ", FLOOR,
     "4:7: object.shapes[0]: has an empty sphere; give its numbers, or remove the key"),
    ("unknown key in a sphere", "sphere: {radius: 3, diameter: 6}", FLOOR,
     "4:28: object.shapes[0].sphere.diameter: is no known key; give half of it as radius; known keys: radius"),
    ("length missing", "cylinder: {radius: 3}", FLOOR,
     "4:18: object.shapes[0].cylinder.length: is missing; add it, for example length: 20"),
    ("zero length", "capsule: {radius: 3, length: 0}", FLOOR,
     "4:37: object.shapes[0].capsule.length: is 0; give a number above 0"),
    ("tiny radius", "disc: {radius: 1e-13}", FLOOR,
     "4:23: object.shapes[0].disc.radius: is 1e-13; give a number of at least 1e-12, or another unit"),
    ("cone that inverts", "cone: {radius_bottom: 5, radius_top: -1, length: 9}", FLOOR,
     "4:45: object.shapes[0].cone.radius_top: is -1; give a number from 0 upwards"),
    ("cone without radii", "cone: {radius_bottom: 0, radius_top: 0, length: 9}", FLOOR,
     "4:30: object.shapes[0].cone.radius_bottom: is zero like radius_top, which leaves a line; give one of"
     " them above zero"),
    ("no vertices", "convex: {vertices: []}", FLOOR,
     "4:27: object.shapes[0].convex.vertices: is empty; give at least one"),
    ("flat vertex", "convex: {vertices: [[0, 0, 0], [1, 0]]}", FLOOR,
     "4:39: object.shapes[0].convex.vertices[1]: has 2 values; give 3"),
    ("single vertex", "convex: {vertices: [[1, 2, 3]]}", FLOOR,
     "4:27: object.shapes[0].convex.vertices: are a single point, which has no volume; add a vertex elsewhere,"
     " or give the shape a radius"),
    ("vertices on a line", "convex: {vertices: [[0, 0, 0], [1, 1, 1], [2, 2, 2]]}", FLOOR,
     "4:27: object.shapes[0].convex.vertices: lie on one line, so they have no volume; add a vertex elsewhere,"
     " or give the shape a radius"),
    ("flat hull", "convex: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}", FLOOR,
     "4:27: object.shapes[0].convex.vertices: lie in one plane, so they have no volume; add a vertex"
     " elsewhere, or give the shape a radius"),
    ("flat hull in the cage", PIN, "convex: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}",
     "8:27: cage.shapes[0].convex.vertices: lie in one plane, so they have no volume; add a vertex elsewhere,"
     " or give the shape a radius"),
    ("negative radius of edges", "convex: {vertices: [[0, 0, 0], [1, 1, 1]], radius: -1}", FLOOR,
     "4:59: object.shapes[0].convex.radius: is -1; give a number from 0 upwards"),
    ("mistyped shape", "cylindr: {radius: 3, length: 5}", FLOOR,
     f"4:8: object.shapes[0].cylindr: is no known shape; did you mean cylinder? {KNOWN}"),
    ("unknown shape", "torus: {radius: 3}", FLOOR,
     f"4:8: object.shapes[0].torus: is no known shape; remove it; {KNOWN}"),
    ("key of the shape beside it", "radius: 3", FLOOR,
     "4:8: object.shapes[0].radius: is no known shape; it belongs within sphere or capsule or cylinder or"
     f" convex or disc or others; {KNOWN}"),
    ("no kind", "name: pin, position: [0, 0, 0]", FLOOR,
     f"4:7: object.shapes[0]: does not say which shape it is; add one of: {SHAPES}"),
    ("two kinds", "sphere: {radius: 3}, disc: {radius: 3}", FLOOR,
     "4:7: object.shapes[0]: is sphere and disc at once; make each a shape of its own"),
    ("two values for a position", "sphere: {radius: 3}, position: [1, 2]", FLOOR,
     "4:39: object.shapes[0].position: has 2 values; give 3"),
    ("friction below zero", PIN + ", friction: -0.1", FLOOR,
     "4:53: object.shapes[0].friction: is -0.1; give a number from 0 upwards"),
    ("friction as text", PIN + ", friction: low", FLOOR,
     "4:53: object.shapes[0].friction: is text 'low'; give a coefficient, or coefficient: or angle_deg: with a"
     " number"),
    ("two frictions", PIN + ", friction: {coefficient: 0.1, angle_deg: 5}", FLOOR,
     "4:53: object.shapes[0].friction: has both of coefficient and angle_deg; give one of them"),
    ("no friction in friction", PIN + ", friction: {}", FLOOR,
     "4:53: object.shapes[0].friction: has neither of coefficient and angle_deg; give one of them"),
    ("friction of all in that of one", PIN + ", friction: {of: {a: 1}}", FLOOR,
     "4:54: object.shapes[0].friction.of: is no known key; it belongs to loads[i].springs[i] or friction; known keys:"
     " coefficient, angle_deg"),
    ("friction of a shared name", PIN + ", name: a, friction: 0.1", FLOOR + ", name: a",
     "4:62: object.shapes[0].friction: is that of 'a', a name in the cage and in the object; rename one of the"
     " two"),
    ("one name in the object", PIN + ", name: a}\n    - {sphere: {radius: 1}, name: a", FLOOR,
     "5:35: object.shapes[1].name: 'a' is already the name of shapes[0]; rename one"),
    ("one name in the cage", PIN, FLOOR + ", name: a}\n    - {sphere: {radius: 1}, name: a",
     "9:35: cage.shapes[1].name: 'a' is already the name of shapes[0]; rename one"),
    ("disc without mass", "disc: {radius: 3}", FLOOR,
     "2:1: object: has no volume, as discs and holes have none; give its center_of_gravity, mass and inertia, or add a"
     " part with a volume"),
    ("foil", PIN, "box: {size: [90, 90, 1e-7]}",
     "8:29: cage.shapes[0].box.size[2]: is 1e-07 mm, too thin to tell its two faces apart (at least"
     " 1.27279e-06 mm, ten times the touch tolerance); thicken the box or lower tolerances.touch"),
    ("short pin", "cylinder: {radius: 5, length: 1e-7}", FLOOR,
     "4:38: object.shapes[0].cylinder.length: is 1e-07 mm, too thin to tell its two faces apart (at least"
     " 1.27671e-06 mm, ten times the touch tolerance); thicken the cylinder or lower tolerances.touch"),
    ("hole without depth", "hole: {radius: 3}", FLOOR,
     "4:14: object.shapes[0].hole.depth: is missing; add it, for example depth: 10"),
    ("negative depth", "hole: {radius: 3, depth: -5}", FLOOR,
     "4:33: object.shapes[0].hole.depth: is -5; give a number above 0"),
    ("chamfer of 90 deg", "hole: {radius: 3, depth: 5, chamfer: {width: 1, angle_deg: 90}}", FLOOR,
     "4:67: object.shapes[0].hole.chamfer.angle_deg: is 90; give a number below 90"),
    ("chamfer without width", "hole: {radius: 3, depth: 5, chamfer: {angle_deg: 45}}", FLOOR,
     "4:45: object.shapes[0].hole.chamfer.width: is missing; add it, for example width: 0.5"),
    ("chamfer as deep as the hole", PIN, "hole: {radius: 3, depth: 5, chamfer: {width: 5, angle_deg: 45}}",
     "8:45: cage.shapes[0].hole.chamfer: reaches the bottom; make it narrower or flatter, or the hole deeper"),
    ("hole in nothing", PIN, "hole: {radius: 3, depth: 5, in: []}",
     "8:40: cage.shapes[0].hole.in: is empty; give at least one"),
    ("hole in what is unknown", PIN, FLOOR + ", name: a}\n    - {hole: {radius: 3, depth: 5, in: [b]}",
     "9:41: cage.shapes[1].hole.in[0]: is 'b', no box or shape of this body; name one of its own: a"),
    ("hole in itself", PIN, "name: a, hole: {radius: 3, depth: 5, in: [a]}",
     "8:50: cage.shapes[0].hole.in[0]: is 'a', no box or shape of this body; name one of its own, which has"
     " none: leave in out"),
    ("hole in the other body", PIN, "hole: {radius: 3, depth: 5, in: [cylinder1]}",
     "8:41: cage.shapes[0].hole.in[0]: is 'cylinder1', no box or shape of this body; name one of its own,"
     " which has none: leave in out"),
    ("hole off the face", PIN, FLOOR + "}\n    - {hole: {radius: 3, depth: 5, in: [box1]}, position: [43, 0, 5]",
     "9:14: cage.shapes[1].hole: is cut out of box1, but its mouth is not all on a face there; move it there"
     " (its axis z points out of the part), or make it smaller"),
    ("hole within the part", PIN, FLOOR + "}\n    - {hole: {radius: 3, depth: 2, in: [box1]}, position: [0, 0, 1]",
     "9:14: cage.shapes[1].hole: has its mouth inside box1; move it to the face (its axis z points out of the"
     " part)"),
    ("hole above the part", PIN, FLOOR + "}\n    - {hole: {radius: 3, depth: 2, in: [box1]}, position: [0, 0, 9]",
     "9:14: cage.shapes[1].hole: is cut out of box1, but its mouth is not all on a face there; move it there"
     " (its axis z points out of the part), or make it smaller"),
    ("nothing but a hole", "hole: {radius: 3, depth: 5}", FLOOR,
     "2:1: object: has no volume, as discs and holes have none; give its center_of_gravity, mass and inertia,"
     " or add a part with a volume"),
]  # fmt: skip

# The same for whole bodies: what to replace, by what, and the line.
BODIES = [
    ("neither boxes nor shapes", "  shapes:\n    - {cylinder: {radius: 5, length: 20}}\n  pose", "  pose",
     "2:1: object: has neither boxes nor shapes; give at least one of them"),
    ("neither points nor shapes", "  shapes:\n    - {box: {size: [90, 90, 10]}}\n", "  pose: {}\n",
     "6:1: cage: has neither points nor shapes; give at least one of them"),
    ("no shapes", "  shapes:\n    - {box: {size: [90, 90, 10]}}\n", "  shapes: []\n",
     "7:11: cage.shapes: is empty; give at least one"),
    ("shapes by name", "  shapes:\n    - {box: {size: [90, 90, 10]}}\n", "  shapes: {floor: {radius: 3}}\n",
     "7:11: cage.shapes: is keys with values; make it a list, each with its own - and name"),
    ("name of a box", "  shapes:\n    - {cyl", "  boxes: [{size: [1, 1, 1], position: [0, 0, 9], name: a}]\n"
     "  shapes:\n    - {name: a, cyl", "5:14: object.shapes[0].name: 'a' is already the name of boxes[0]; rename one"),
    ("name of a point", "  shapes:\n    - {box", "  points: {a: [0, 0, 70]}\n  shapes:\n    - {name: a, box",
     "9:14: cage.shapes[0].name: 'a' is already the name of points.a; rename one"),
    ("friction at two places", "    - {cyl", "    - {friction: 0.1, cyl", "4:18: object.shapes[0].friction:"
     " stands in friction.of.cylinder1, too; keep one of the two"),
    ("friction of nothing", "of: {cylinder1: 0.2}", "of: {cylinder2: 0.2}", "12:28: friction.of.cylinder2:"
     " is neither in the cage nor in the object; give the name of a point, a box or a shape"),
]  # fmt: skip


@pytest.mark.parametrize(("held", "cage", "line"), [case[1:] for case in BROKEN], ids=[case[0] for case in BROKEN])
def test_a_broken_shape_is_refused_in_one_line_with_place_key_and_remedy(
    command: Callable[..., Any], in_folder: Path, held: str, cage: str, line: str
) -> None:
    (in_folder / "scene.yaml").write_text(SCENE.format(held, cage), encoding="utf-8")
    assert command("check", "scene.yaml") == (2, "", f"scene.yaml:{line}\n")


@pytest.mark.parametrize(("old", "new", "line"), [case[1:] for case in BODIES], ids=[case[0] for case in BODIES])
def test_a_broken_body_is_refused_in_one_line(
    command: Callable[..., Any], in_folder: Path, old: str, new: str, line: str
) -> None:
    text = SCENE.format(PIN, FLOOR) + "friction: {of: {cylinder1: 0.2}}\n"
    assert old in text
    (in_folder / "scene.yaml").write_text(text.replace(old, new, 1), encoding="utf-8")
    answer = command("check", "scene.yaml")
    assert (answer.code, answer.out) == (2, "")
    assert f"scene.yaml:{line}\n" in answer.err  # with others, where a shape that is named elsewhere is gone


def test_a_point_within_a_box_among_the_shapes_is_told_where_the_box_stands(
    command: Callable[..., Any], in_folder: Path
) -> None:
    text = SCENE.format("box: {size: [9, 9, 9]}", FLOOR).replace("cage:\n", "cage:\n  points: [[0, 0, 51]]\n")
    (in_folder / "scene.yaml").write_text(text, encoding="utf-8")
    line = "7:12: cage.points.C1: starts 3.5 mm inside object.shapes[0] (box1); move the point out or move the object's"
    assert command("check", "scene.yaml") == (2, "", f"scene.yaml:{line} start pose\n")


def test_check_says_what_a_scene_of_shapes_holds(command: Callable[..., Any], in_folder: Path) -> None:
    bar = "capsule: {radius: 5, length: 10}, position: [1, 2, 10], euler_zyx_deg: [0, 90, 0]"
    held = f"{bar}}}\n    - {{sphere: {{radius: 7}}, position: [0, 0, 13]"
    (in_folder / "scene.yaml").write_text(SCENE.format(held, FLOOR))
    answer = command("check", "scene.yaml")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.splitlines() == [
        "round: 2 shapes, 1 cage shape, 1 load (gravity), method quasistatic",
        "object 20 x 14 x 15 mm: x -9 to 11, y -7 to 7, z 5 to 20",
        "cage 90 x 90 x 10 mm: x -45 to 45, y -45 to 45, z -5 to 5",
        "size 127.671 mm, touch tolerance 1.28e-07 mm; no problems found",
    ]


def test_check_counts_holes_and_those_that_stand_alone(command: Callable[..., Any], in_folder: Path) -> None:
    held = "capsule: {radius: 2, length: 10}, position: [0, 0, 10]"
    (in_folder / "scene.yaml").write_text(SCENE.format(held, "hole: {radius: 5, depth: 10}"))
    answer = command("check", "scene.yaml")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.splitlines()[0] == "round: 1 shape, 1 cage hole, 1 load (gravity), method quasistatic"
    assert answer.out.splitlines()[2].startswith("cage 10 x 10 x 10 mm: ")


@pytest.mark.parametrize(("word", "meant"), [("roller", "capsule"), ("Ball", "sphere"), ("wall", "box")])
def test_other_words_lead_to_ours(command: Callable[..., Any], in_folder: Path, word: str, meant: str) -> None:
    (in_folder / "scene.yaml").write_text(SCENE.format(f"{word}: {{radius: 3}}", FLOOR))
    assert f"{word}: is no known shape; did you mean {meant}? " in command("check", "scene.yaml").err


@pytest.mark.parametrize(
    ("hole", "says"),
    [
        ("hole: {radius: 3, depth: 9, in: [wedge]}, position: [0, 0, 5]", "comes out aslant, which no method runs"),
        ("hole: {radius: 3, depth: 2, in: [wedge]}, position: [0, 0, 5]", None),
    ],
)
def test_a_hole_that_no_method_runs_is_told_by_name(
    command: Callable[..., Any], in_folder: Path, hole: str, says: str | None
) -> None:
    wedge = (
        "{name: wedge, convex: {vertices: [[-9, -9, 5], [9, -9, 5], [-9, 9, 5], [9, 9, 5], [-9, -9, -5], [-9, 9, -5]]}}"
    )
    text = SCENE.format("sphere: {radius: 5}, position: [0, 0, 30]", f"{wedge[1:-1]}}}\n    - {{{hole}")
    (in_folder / "scene.yaml").write_text(text)
    for asked in ("check", "run"):
        answer = command(asked, "scene.yaml")
        assert answer.code == (0 if says is None else 2), answer.err
        assert (says or "") in answer.err
        assert (re.match(r"scene\.yaml:\d+:\d+: cage\.shapes\[1\]: ", answer.err) is None) == (says is None)


def test_a_bore_that_is_wider_than_its_shank_is_told_so(command: Callable[..., Any], in_folder: Path) -> None:
    ball = "sphere: {radius: 5}, position: [0, 0, 30]"
    parts = (
        "name: shank, cylinder: {radius: 5, length: 10}, position: [0, 0, -5]}\n"
        "    - {name: flange, cylinder: {radius: 9, length: 4}, position: [0, 0, 2]}\n"
        "    - {name: bore, hole: {radius: 6, depth: 14, in: [shank, flange]}, position: [0, 0, 4]"
    )
    (in_folder / "scene.yaml").write_text(SCENE.format(ball, parts))
    assert "(bore) that is wider than shank, flange somewhere below its mouth" in command("run", "scene.yaml").err


@pytest.mark.parametrize(
    ("block", "beside", "is_run"),
    [
        ("[20, 40, 20]}, position: [-10, 0, -6]", "box: {size: [20, 40, 20]}, position: [10, 0, -6]", False),
        ("[20, 40, 20]}, position: [-6.5, 0, -6]", "box: {size: [20, 40, 20]}, position: [13.5, 0, -6]", False),
        ("[40, 40, 20]}, position: [0, 0, -6]", "cylinder: {radius: 20, length: 20}, position: [18, 0, -6]", False),
        ("[40, 40, 6]}, position: [0, 0, 1]", "box: {size: [20, 20, 14]}, position: [0, 0, -9]", True),
        ("[40, 40, 6]}, position: [0, 0, 1]", "cylinder: {radius: 8, length: 20}, position: [0, 0, -6]", True),
    ],
    ids=["over the seam", "only the chamfer is over it", "overlapping", "stacked", "one in the other"],
)
def test_a_hole_along_the_side_of_one_of_its_parts_is_refused(
    command: Callable[..., Any], in_folder: Path, block: str, beside: str, is_run: bool
) -> None:
    parts = (
        f"name: block, box: {{size: {block}}}\n    - {{name: beside, {beside}}}\n"
        "    - {name: seat, hole: {radius: 3, depth: 12, chamfer: {width: 1, angle_deg: 60}, in: [block, beside]}"
        ", position: [0, 0, 4]"
    )
    (in_folder / "scene.yaml").write_text(SCENE.format("sphere: {radius: 2}, position: [0, 0, 30]", parts))
    answer = command("run", "scene.yaml")
    assert answer.code == (0 if is_run else 2), answer
    assert ("along which the side of" in answer.err) != is_run, answer.err


def test_a_hole_in_two_thin_covers_side_by_side_is_refused(command: Callable[..., Any], in_folder: Path) -> None:
    covers = "".join(
        f"    - {{name: {name}, box: {{size: [20, 40, 0.3]}}, position: [{x}, 0, 4.15]}}\n"
        for name, x in (("left", -10), ("right", 10))
    )
    parts = (
        f"name: block, box: {{size: [40, 40, 20]}}, position: [0, 0, -6]}}\n{covers}"
        "    - {name: bore, hole: {radius: 3, depth: 12, in: [block, left, right]}, position: [0, 0, 4.3]"
    )
    (in_folder / "scene.yaml").write_text(SCENE.format("sphere: {radius: 2}, position: [0, 0, 30]", parts))
    answer = command("run", "scene.yaml")
    assert answer.code == 2
    assert "(bore) along which the side of left and of right runs" in answer.err


def test_a_part_that_starts_in_a_plate_beside_its_hole_is_refused(command: Callable[..., Any], in_folder: Path) -> None:
    hole = "hole: {radius: 6, depth: 9, in: [plate]}, position: [0, 0, 5]"
    plate = "name: plate, box: {size: [90, 90, 10]}"
    for across, code in ((0.5, 0), (1.5, 2)):
        peg = f"cylinder: {{radius: 5, length: 20}}, position: [{across}, 0, -42]"
        (in_folder / "scene.yaml").write_text(SCENE.format(peg, f"{plate}}}\n    - {{{hole}"))
        answer = command("check", "scene.yaml")
        assert answer.code == code, answer.err
        assert ("plate starts 0.5 mm inside object.shapes[0]" in answer.err) == (code == 2)

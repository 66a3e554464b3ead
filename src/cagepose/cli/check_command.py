"""``cagepose check``: is this scene file right, or are the proofs of this saved run?"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from cagepose.cli.options import SetOption
from cagepose.cli.run_source import RunOrSceneArgument

if TYPE_CHECKING:
    from cagepose.files.units import LengthUnit
    from cagepose.model.checks import FloatArray
    from cagepose.model.scene import Scene


def check_command(run_or_scene: RunOrSceneArgument, /, *, set_values: SetOption = ()) -> int:
    """Print a summary of a scene, or every problem found in it; of a saved run, what its certificates prove."""
    from cagepose.errors import printable
    from cagepose.files.read import looks_like_run
    from cagepose.files.scene_file import read_scene_file
    from cagepose.files.units import from_metres
    from cagepose.model.geometry import body_limits
    from cagepose.model.remarks import remarks
    from cagepose.model.wording import counted
    from cagepose.runs.methods import chosen_method

    if looks_like_run(run_or_scene):
        return _check_run(run_or_scene, set_values)
    scene_file = read_scene_file(run_or_scene, set_values)
    found, unit = scene_file.scene, scene_file.length_unit
    size = float(from_metres(found.size_m, unit))
    touch = float(from_metres(found.touch_m, unit))
    held, cage = found.object, found.cage
    alone = [hole for hole in cage.holes if not hole.in_]
    counts = counted(
        (len(held.boxes), "box", "boxes"),
        (len(held.shapes), "shape", "shapes"),
        (len(held.holes), "hole", "holes"),
        (len(cage.names), "cage point", "cage points"),
        (len(cage.shapes), "cage shape", "cage shapes"),
        (len(cage.holes), "cage hole", "cage holes"),
        (len(cage.bodies), "cage body", "cage bodies"),
        (len(found.loads), "load", "loads"),
    )
    sys.stdout.write(
        f"{found.name}: {counts} ({', '.join(load.name for load in found.loads)}),"
        f" method {chosen_method(found).name}\n"
        f"object {_extent(body_limits(held.parts), unit)}\n"
        f"cage {_extent(body_limits((*cage.shapes, *alone), cage.points_cage), unit)}\n"
        f"{_depths(found, unit)}"
        f"size {size:.6g} {unit}, touch tolerance {touch:.3g} {unit}; no problems found\n"
    )
    sys.stdout.write("".join(printable(f"note: {note}") + "\n" for note in scene_file.notes))
    for remark in remarks(found):
        sys.stdout.write(printable(f"remark: {remark}") + "\n")
    return 0


def _check_run(path: str, set_values: tuple[str, ...]) -> int:
    from cagepose.cli.proof_report import check_saved_run
    from cagepose.errors import printable

    if set_values:
        message = f"--set: changes a scene, but {path} is a saved run; name the scene file"
        sys.stderr.write(printable(message) + "\n")
        return 2
    return check_saved_run(path)


def _extent(limits_m: FloatArray, unit: LengthUnit) -> str:
    """``10 x 20 x 5 mm: x -5 to 5, ...`` in the body's frame: a mistaken unit is seen at once."""
    from cagepose.files.units import from_metres
    from cagepose.model.tolerances import SHOWN_AS_ZERO
    from cagepose.model.wording import short

    low, high = from_metres(limits_m, unit).tolist()
    noise = SHOWN_AS_ZERO * max(abs(value) for value in (*low, *high))
    sides = [
        f"{axis} {short(one, 6, noise)} to {short(other, 6, noise)}"
        for axis, one, other in zip("xyz", low, high, strict=True)
    ]
    edges = " x ".join(short(other - one, 6, noise) for one, other in zip(low, high, strict=True))
    return f"{edges} {unit}: {', '.join(sides)}"


def _depths(scene: Scene, unit: LengthUnit) -> str:
    """``holes: bore through 24 mm, pocket 5 mm deep``: one that is given deeper than its part is thick runs through."""
    from cagepose.errors import printable
    from cagepose.files.words import LengthWords
    from cagepose.model.wording import few

    words, told = LengthWords(unit, scene.size_m), list[str]()
    for parts, holes in ((scene.object.parts, scene.object.holes), (scene.cage.shapes, scene.cage.holes)):
        named = {part.name: part for part in parts}
        for hole in holes:
            depth_m, is_open = hole.run_through([named[name] for name in hole.in_])
            depth = f"{words.lengths([depth_m])} {unit}"
            told.append(f"{hole.name} through {depth}" if is_open else f"{hole.name} {depth} deep")
    return printable(f"holes: {few(told)}") + "\n" if told else ""

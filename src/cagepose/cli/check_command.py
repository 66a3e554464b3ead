"""``cagepose check``: is this scene file right?"""

from __future__ import annotations

import sys

from cagepose.cli.options import SceneArgument, SetOption


def check_command(scene: SceneArgument, /, *, set_values: SetOption = ()) -> int:
    """Print what the scene holds, or every problem found."""
    from cagepose.files.scene_file import read_scene_file
    from cagepose.files.units import from_metres
    from cagepose.runs.methods import chosen_method

    scene_file = read_scene_file(scene, set_values)
    found, unit = scene_file.scene, scene_file.length_unit
    size = float(from_metres(found.size_m, unit))
    touch = float(from_metres(found.touch_m, unit))
    sys.stdout.write(
        f"{found.name}: {_count(len(found.object.boxes), 'box', 'boxes')},"
        f" {_count(len(found.cage.names), 'cage point')},"
        f" {_count(len(found.loads), 'load')} ({', '.join(load.name for load in found.loads)}),"
        f" method {chosen_method(found).name}\n"
        f"size {size:.6g} {unit}, touch tolerance {touch:.3g} {unit}; no problems found\n"
    )
    return 0


def _count(number: int, one: str, many: str | None = None) -> str:
    return f"{number} {one if number == 1 else many or one + 's'}"

"""``cagepose crosscheck``: does another program end at the same poses?"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from cagepose.cli.options import MethodOption, SceneArgument, SetOption, Switch, unknown_method

if TYPE_CHECKING:
    from cagepose.exchange.crosscheck import Crosscheck
    from cagepose.files.units import LengthUnit


def crosscheck_command(
    scene: SceneArgument,
    /,
    *,
    engine: Annotated[Literal["mujoco"], Parameter(help="The other program.")] = "mujoco",
    method: MethodOption = None,
    set_values: SetOption = (),
    json: Annotated[bool, Switch, Parameter(help="Print one JSON document instead of the table.")] = False,
) -> int:
    """Compare final poses phase by phase; return 0 if they agree, 1 if not."""
    from cagepose.errors import SceneError
    from cagepose.exchange.crosscheck import crosscheck
    from cagepose.exchange.extra import mujoco
    from cagepose.files.scene_file import read_scene_file
    from cagepose.runs.solve import run

    mujoco()
    scene_file = read_scene_file(scene, set_values)
    if problems := unknown_method(method):
        sys.stderr.write(problems[0] + "\n")
        return 2
    try:
        found = crosscheck(run(scene_file.scene, method))
    except SceneError as error:
        sys.stderr.write("".join(f"{scene}: {problem}\n" for problem in error.problems))
        return 2
    if json:
        from cagepose.exchange.crosscheck_document import crosscheck_document
        from cagepose.files.write import json_text

        sys.stdout.write(json_text(crosscheck_document(found, scene_file.length_unit)))
    else:
        _print(found, scene_file.length_unit, engine)
    return 0 if found.agrees else 1


def _print(found: Crosscheck, unit: LengthUnit, engine: str) -> None:
    import math

    from rich.text import Text

    from cagepose.cli.console import print_all
    from cagepose.cli.styles import plain_table, verdict_style
    from cagepose.files.units import from_metres

    def length(metres: float) -> str:
        return f"{float(from_metres(metres, unit)):.2g} {unit}"

    run = found.run
    table = plain_table("phase", "cagepose", engine, "difference", "tolerance", "penetration", "")
    lines = list[str]()
    for phase in found.phases:
        there = phase.mujoco
        table.add_row(
            phase.phase.name,
            Text(phase.phase.verdict, verdict_style(phase.phase.verdict)),
            "at rest" if there.settled.is_quiet else "moves",
            f"{length(phase.distance_m)}, {math.degrees(phase.angle_rad):.2g} deg",
            length(phase.allowed_m),
            length(there.penetration_m),
            Text("agrees", "bold green") if phase.agrees else Text("differs", "bold red"),
        )
        lines += [f"{phase.phase.name}: {reason}" for reason in phase.reasons]
    lines += [f"note: {note}" for note in found.notes]
    verdict = Text("agrees", "bold green") if found.agrees else Text("differs", "bold red")
    print_all(Text.assemble(f"{run.scene.name}: ", verdict, f"  ({run.method} beside {engine})"), "", table)
    if lines:
        print_all("", Text("\n".join(lines)))
